//! Remarks on where clamps hold a lattice.

use super::shapes::length;
use halfstep_scene::geometry::{Layout, Plate, SolidPoint};
use halfstep_scene::{Block, EffectName, Geometry, Lattice, Scene, Shape, SolidModelName, Switch};
use std::collections::BTreeMap;

/// Part of a spacing by which a face may miss the boundary between two rows.
const MISS: f64 = 0.05;

/// Faces of clamps that cut a row of particles: a clamped particle carries no stress in the half of its cell that the
/// clamp does not hold, a free one does so in the part that it holds.
pub(super) fn clamp_faces(scene: &Scene, all: &mut Vec<String>) {
    if scene.switch(EffectName::ClampFace) == Switch::Off {
        return;
    }
    for shape in &scene.shapes {
        // Turned rows are cut by every face.
        if is_turned(shape) {
            if !shape.clamp.is_empty() && breaks(scene, shape) {
                all.push(format!(
                    "the clamp of `{}` crosses the rows of its lattice: it breaks there at 0.7 to 0.85 of the load \
                     that it bears where rows lie along the clamp",
                    shape.name
                ));
            }
            continue;
        }
        let model = shape.solid.and_then(|k| scene.solids.get(k)).map(|solid| solid.model.name());
        let Geometry::Box(body) = &shape.geometry else { continue };
        let elements = model == Some(SolidModelName::FiniteElement);
        if !elements && model != Some(SolidModelName::TotalLagrangian) {
            continue;
        }
        for clamp in &shape.clamp {
            for axis in 0..scene.dimension {
                let inside = |face: &f64| *face > body.min[axis] && *face < body.max[axis];
                for face in [clamp.min[axis], clamp.max[axis]].into_iter().filter(inside) {
                    all.extend(cut(scene, shape, axis, body.min[axis], face, elements));
                }
            }
        }
    }
}

/// Rows of the shape's lattice are not along the axes, as faces of clamps are.
fn is_turned(shape: &Shape) -> bool {
    let by = match &shape.geometry {
        Geometry::Moved(moved) => moved.angle,
        _ => 0.0,
    };
    (shape.lattice_angle + by) % 90.0 != 0.0
}

/// The shape is of a solid that can break.
fn breaks(scene: &Scene, shape: &Shape) -> bool {
    shape.solid.is_some_and(|solid| scene.fracture(solid).is_some())
}

fn cut(scene: &Scene, shape: &Shape, axis: usize, first: f64, face: f64, elements: bool) -> Option<String> {
    let dx = scene.spacing(shape);
    // Boundaries between rows lie at whole numbers of spacings, `nodal` half a spacing beside.
    let shift = if scene.numerics.lattice == Lattice::Nodal { 0.5 } else { 0.0 };
    let rows = (face - first) / dx - shift;
    if (rows - rows.round()).abs() <= MISS {
        return None;
    }
    let at = |rows: f64| length(first + (rows + shift) * dx);
    let held = match elements {
        true => "its elements are held as a whole where their middle is in the clamp",
        false => "it is held more softly than there",
    };
    let early = if !elements && breaks(scene, shape) {
        ", and breaks there at as little as 0.6 of the load"
    } else {
        ""
    };
    Some(format!(
        "a face of the clamp of `{}`, at {} = {} m, cuts a row of its particles: {held}{early}. Between rows are {} and \
         {} m",
        shape.name,
        ["x", "y", "z"][axis],
        length(face),
        at(rows.floor()),
        at(rows.ceil())
    ))
}

/// Clamps that hold a plate by a part of its section, across which it bends and turns where it should be held.
pub(super) fn sections<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    for (index, shape) in scene.shapes.iter().enumerate().filter(|(_, shape)| !shape.clamp.is_empty()) {
        let Geometry::Box(body) = shape.geometry.unmoved() else { continue };
        // What a clamp pushes by a motion of its own may be a part; blocks are held by their feet.
        if shape.motion.is_some() || Plate::<D>::of(scene, shape).is_none() {
            continue;
        }
        let worst = (0..shape.geometry.copies()).find_map(|copy| {
            let own = layout.solid.iter().filter(|p| p.body as usize == index && p.copy == copy);
            held_in_part(scene, shape, body, &own.collect::<Vec<_>>())
        });
        if let Some([held, across]) = worst {
            let remedy = match shape.geometry {
                Geometry::Moved(_) => "`translate`, `rotate` and `repeat` do not take the clamp's box along",
                _ => "a box over the whole section holds it",
            };
            all.push(format!(
                "the clamp of `{}` holds {held} of the {across} particles of a section, and no section as a whole: \
                 there the plate bends and turns about what is held ({remedy})",
                shape.name
            ));
        }
    }
}

/// Of the section of a plate of which a clamp holds most: the particles that it holds, and all; `None` where it holds
/// all of one, of a row along it, or of what its box cuts.
fn held_in_part<const D: usize>(
    scene: &Scene,
    shape: &Shape,
    body: &Block,
    own: &[&SolidPoint<D>],
) -> Option<[usize; 2]> {
    let dx = scene.spacing(shape);
    let reach = 1e-6 * dx;
    let holds = |clamp: &&Block| {
        let inside = |p: &&SolidPoint<D>| {
            (0..D).all(|a| clamp.min[a] - reach <= p.position[a] && p.position[a] <= clamp.max[a] + reach)
        };
        own.iter().copied().any(|p| inside(&p))
    };
    // Several are supports, as of a beam in bending.
    if shape.clamp.iter().filter(holds).count() != 1 {
        return None;
    }
    let held = || own.iter().filter(|p| p.clamped);
    let cut_whole = (0..D).any(|a| {
        let ends = held()
            .map(|p| p.position[a])
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
        let beside = |p: &&&SolidPoint<D>| (ends[0] - reach..=ends[1] + reach).contains(&p.position[a]);
        own.iter().filter(beside).all(|p| p.clamped)
    });
    if cut_whole {
        return None;
    }
    // Where they are in the lattice, however it is turned.
    let place = |p: &SolidPoint<D>| match &shape.geometry {
        Geometry::Moved(moved) => moved.back(p.copy, p.position),
        _ => p.position,
    };
    let rows = |axis: usize| {
        let mut rows: BTreeMap<i64, [usize; 2]> = BTreeMap::new();
        for p in own {
            let row = rows.entry(((place(p)[axis] - body.min[axis]) / dx - 0.25).round() as i64).or_default();
            *row = [row[0] + usize::from(p.clamped), row[1] + 1];
        }
        rows
    };
    if (0..D).any(|axis| rows(axis).values().any(|[held, all]| held == all)) {
        return None;
    }
    let extent = |a: &usize| body.max[*a] - body.min[*a];
    let along = (0..D).max_by(|a, b| extent(a).total_cmp(&extent(b)))?;
    rows(along).into_values().max_by_key(|[held, _]| *held)
}

#[cfg(test)]
mod tests {
    use crate::remarks::remarks;
    use crate::remarks::tests::{PLATE, TANK, WATER, plain};
    use halfstep_scene::parse;
    use std::path::Path;

    /// Rows of 5 mm from 0: the face of a clamp at 12.5 mm runs through the middle of one, at 10 mm between two.
    #[test]
    fn the_face_of_a_clamp_that_cuts_a_row() {
        let cut = PLATE.replace("max = [0.22, 0.01]", "max = [0.22, 0.0125]");
        let found = plain(&[TANK, WATER, &cut]);
        assert_eq!(
            found,
            [
                "a face of the clamp of `plate`, at y = 0.0125 m, cuts a row of its particles: it is held more softly \
                 than there. Between rows are 0.01 and 0.015 m"
            ]
        );
        // Nodal rows lie at whole spacings, so the boundaries between them do not.
        let nodal = "[numerics]\nlattice = \"nodal\"\n";
        let cuts = |parts: &[&str]| plain(parts).iter().filter(|text| text.contains("cuts a row")).count();
        assert_eq!(cuts(&[TANK, WATER, &cut, nodal]), 0);
        assert_eq!(cuts(&[TANK, WATER, PLATE, nodal]), 1);
        assert_eq!(plain(&[TANK, WATER, &cut, "[effects]\nclamp-face = \"off\"\n"]), [""; 0]);
    }

    /// Tests of bars in `solid-proc` measure the loads.
    #[test]
    fn where_a_breakable_solid_breaks_early_beside_its_clamp() {
        let of = |plate: &str, more: &str| {
            let head = "resolution = 0.005\nend_time = 1.0\n[solid]\ndensity = 1100.0\nyoungs_modulus = 12e6\n\
                        poissons_ratio = 0.4\nfracture = { strength = 1e5, energy = 10.0 }\n";
            let scene = parse(&format!("{head}{plate}{more}"), Path::new("x.toml"), &[]);
            let all = remarks(&scene.unwrap_or_else(|e| panic!("{e:?}")));
            all.into_iter().filter(|text| text.contains("of the load")).collect::<Vec<_>>()
        };
        let off = "[effects]\nfracture = \"off\"\n";
        let cut = PLATE.replace("max = [0.22, 0.01]", "max = [0.22, 0.0125]");
        assert_eq!(of(PLATE, ""), [""; 0]);
        assert_eq!(of(&cut, off), [""; 0]);
        let told = of(&cut, "");
        assert!(
            told.len() == 1 && told[0].contains("than there, and breaks there at as little as 0.6"),
            "{told:?}"
        );
        let turned = format!("{PLATE}lattice_angle = 30\n");
        assert_eq!(of(&turned, off), [""; 0]);
        let told = of(&turned, "");
        assert!(told.len() == 1 && told[0].starts_with("the clamp of `plate` crosses the rows"), "{told:?}");
        // A turned shape takes its lattice along, and not its clamp.
        let rotate = "rotate = { angle = 30.0, about = [0.21, 0.005] }\n";
        let told = of(&format!("{PLATE}{rotate}"), "");
        assert!(told.len() == 1 && told[0].starts_with("the clamp of `plate` crosses the rows"), "{told:?}");
        assert_eq!(of(&format!("{PLATE}lattice_angle = 90\n"), ""), [""; 0]);
        // Turned one way with the shape, and back by itself.
        assert_eq!(of(&format!("{PLATE}{rotate}lattice_angle = -30\n"), ""), [""; 0]);
    }
}
