//! Solid shapes that are plates: how many particles they have across, and which way their faces look.

use super::polygon::{Edges, Polygon, in_space};
use super::{Moved, Spacing, points};
use crate::{Block, EffectName, Geometry, Lattice, Phase, Scene, Shape, Switch, Treatment};

/// A box, ring or polygon that is longer than thick.
#[derive(Clone, Debug, PartialEq)]
pub struct Plate<const D: usize> {
    /// Name of its shape.
    pub name: String,
    /// Rows of particles across; a ring's walls may hold a fraction more.
    pub rows: f64,
    /// Its thickness over the scene's resolution: `rows` where the plate has no spacing of its own.
    pub thickness: f64,
    kind: Kind<D>,
    /// Half the spacing, m: how far a particle may stand beyond the shape's surface.
    margin: f64,
}

#[derive(Clone, Debug, PartialEq)]
enum Kind<const D: usize> {
    Box {
        low: [f64; D],
        high: [f64; D],
        across: usize,
    },
    Ring {
        center: [f64; D],
        inner: f64,
        outer: f64,
    },
    /// Where it is thinner than `limit`, m.
    Polygon {
        edges: Box<Edges>,
        limit: f64,
    },
    Moved {
        moved: Moved,
        plate: Box<Plate<D>>,
    },
}

impl<const D: usize> Plate<D> {
    /// The plate that a shape is; `None` for other phases and for what is not at least twice as long as thick.
    pub fn of(scene: &Scene, shape: &Shape) -> Option<Self> {
        if shape.phase != Phase::Solid {
            return None;
        }
        Self::of_geometry(scene, shape, &shape.geometry)
    }

    fn of_geometry(scene: &Scene, shape: &Shape, geometry: &Geometry) -> Option<Self> {
        let spacing = Spacing::of(scene, shape);
        let (kind, rows) = match geometry {
            Geometry::Box(_) => {
                let block = joined(scene, shape, geometry)?;
                let extent = |a: usize| block.max[a] - block.min[a];
                let across = (0..D).min_by(|&a, &b| extent(a).total_cmp(&extent(b)))?;
                let longest = (0..D).map(extent).fold(0.0, f64::max);
                if longest < 2.0 * extent(across) {
                    return None;
                }
                // Where the lattice ends, which a rounded extent is not.
                let low: [f64; D] = std::array::from_fn(|a| block.min[a]);
                if spacing.turn != 0.0 {
                    let high = std::array::from_fn(|a| block.max[a]);
                    (Kind::Box { low, high, across }, extent(across) / spacing.dx)
                } else {
                    let cells = |a: usize| spacing.cells(extent(a)) as f64 * spacing.dx;
                    let high = std::array::from_fn(|a| low[a] + cells(a));
                    (Kind::Box { low, high, across }, spacing.expected(extent(across), 0.0))
                }
            }
            Geometry::Ring { center, inner, outer } if *inner > 0.5 * (outer - inner) => {
                let center = std::array::from_fn(|a| center[a]);
                (Kind::Ring { center, inner: *inner, outer: *outer }, (outer - inner) / spacing.dx)
            }
            Geometry::Polygon(polygon) => {
                let (thickness, _) = polygon.facing()?;
                let edges = Box::new(Edges::new(polygon));
                let longest = (0..2).map(|a| edges.high[a] - edges.low[a]).fold(0.0, f64::max);
                if longest < 2.0 * thickness {
                    return None;
                }
                // Fluid on both faces is within the support of particles between.
                let limit = 4.0 * scene.smoothing_ratio * scene.resolution - scene.resolution;
                (Kind::Polygon { edges, limit }, thickness / spacing.dx)
            }
            Geometry::Moved(moved) => {
                let plate = Self::of_geometry(scene, shape, &moved.geometry)?;
                let rows = plate.rows;
                (Kind::Moved { moved: moved.clone(), plate: Box::new(plate) }, rows)
            }
            _ => return None,
        };
        let thickness = rows * (spacing.dx / scene.resolution);
        Some(Self { name: shape.name.clone(), rows, thickness, kind, margin: 0.5 * spacing.dx })
    }

    /// Whether a particle that begins there belongs to it.
    pub fn holds(&self, x: &[f64; D]) -> bool {
        let m = self.margin;
        match &self.kind {
            Kind::Box { low, high, .. } => (0..D).all(|a| low[a] - m <= x[a] && x[a] <= high[a] + m),
            Kind::Ring { center, inner, outer } => {
                let r = length(&std::array::from_fn::<_, D, _>(|a| x[a] - center[a]));
                inner - m <= r && r <= outer + m
            }
            Kind::Polygon { edges, limit } => {
                let thickness = Polygon::across(edges, &[x[0], x[1]]).map(|(_, [a, b])| a + b);
                edges.contains(&[x[0], x[1]], 0.0) && thickness.is_some_and(|thickness| thickness < *limit)
            }
            Kind::Moved { moved, plate } => moved.copies().any(|copy| plate.holds(&moved.back(copy, *x))),
        }
    }

    /// Unit normal there, and how far before the plate's middle along it, m.
    pub fn across(&self, x: &[f64; D]) -> ([f64; D], f64) {
        match &self.kind {
            Kind::Box { low, high, across } => {
                let normal = std::array::from_fn(|a| f64::from(u8::from(a == *across)));
                (normal, x[*across] - 0.5 * (low[*across] + high[*across]))
            }
            Kind::Ring { center, inner, outer } => {
                let from: [f64; D] = std::array::from_fn(|a| x[a] - center[a]);
                let r = length(&from);
                (from.map(|x| x / r), r - 0.5 * (inner + outer))
            }
            Kind::Polygon { edges, .. } => match Polygon::across(edges, &[x[0], x[1]]) {
                Some((normal, [before, behind])) => (in_space(normal), 0.5 * (behind - before)),
                None => ([0.0; D], 0.0),
            },
            Kind::Moved { moved, plate } => {
                let within = |copy: &u32| plate.holds(&moved.back(*copy, *x));
                let copy = moved.copies().find(within).unwrap_or(0);
                let (normal, before) = plate.across(&moved.back(copy, *x));
                (moved.turned(normal), before)
            }
        }
    }
}

/// The box that a geometry of a shape is, grown by the boxes of the shape's body that lie beside it or over it across
/// its thin side and are at least as long and as wide: there they are one plate, or none, as ballast in a hull.
/// `None` of another geometry.
pub(crate) fn joined(scene: &Scene, shape: &Shape, geometry: &Geometry) -> Option<Block> {
    let Geometry::Box(block) = geometry else { return None };
    let mut block = *block;
    // In the nodal lattice there is a gap between two boxes.
    let alone =
        shape.phase != Phase::Solid || shape.body.is_empty() || scene.numerics.lattice == Lattice::Nodal;
    if alone || shape.geometry != *geometry {
        return Some(block);
    }
    let axes = || 0..scene.dimension;
    let extent = |a: usize| block.max[a] - block.min[a];
    let across = axes().min_by(|&a, &b| extent(a).total_cmp(&extent(b)))?;
    // One without room for a particle adds none: it is refused as it is.
    let has_room = |b: &Block| b.max[across] - b.min[across] >= scene.spacing(shape) * (1.0 - 1e-9);
    if !has_room(&block) {
        return Some(block);
    }
    let rounding = 1e-6 * scene.spacing(shape);
    let of_body = |other: &&Shape| {
        let alike = other.phase == Phase::Solid && other.solid == shape.solid && other.body == shape.body;
        alike && scene.spacing(other) == scene.spacing(shape)
    };
    let mut others: Vec<Block> = scene.shapes.iter().filter(of_body).filter_map(Shape::block).collect();
    others.retain(|b| {
        let along = |a: usize| b.min[a] < block.min[a] + rounding && b.max[a] > block.max[a] - rounding;
        has_room(b) && axes().filter(|&a| a != across).all(along)
    });
    let mut grown = true;
    while std::mem::take(&mut grown) {
        for b in &others {
            let meets =
                b.min[across] < block.max[across] + rounding && b.max[across] > block.min[across] - rounding;
            if meets && b.max[across] > block.max[across] + rounding {
                (block.max[across], grown) = (b.max[across], true);
            }
            if meets && b.min[across] < block.min[across] - rounding {
                (block.min[across], grown) = (b.min[across], true);
            }
        }
    }
    Some(block)
}

/// By how much a plate may miss a rectangle whose second moment is asked for.
const STRAIGHT: f64 = 0.05;

/// Second moment of area of a straight plate in the plane about its middle, per width, asked and of its particles, m³:
/// that of their distances across and of their cells, over the plate's length. `None` of what is no rectangle.
pub fn second_moments<const D: usize>(scene: &Scene, shape: &Shape) -> Option<[f64; 2]> {
    let spacing = Spacing::of(scene, shape);
    let geometry = shape.geometry.unmoved();
    let corners: Vec<[f64; 2]> = match geometry {
        Geometry::Box(Block { min, max }) => {
            vec![[min[0], min[1]], [max[0], min[1]], [max[0], max[1]], [min[0], max[1]]]
        }
        Geometry::Polygon(polygon) => polygon.outline.clone(),
        _ => return None,
    };
    let polygon = Polygon { outline: corners, holes: Vec::new() };
    let area = match geometry {
        Geometry::Polygon(whole) => whole.area(),
        _ => polygon.area(),
    };
    let along = Edges::new(&polygon).longest().direction();
    let at = |p: &[f64; 2]| [p[0] * along[0] + p[1] * along[1], p[1] * along[0] - p[0] * along[1]];
    let extents = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let start = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        let of =
            points.fold(start, |of, p| std::array::from_fn(|a| [of[a][0].min(p[a]), of[a][1].max(p[a])]));
        of.map(|[low, high]| high - low)
    };
    let [length, thickness] = extents(&mut polygon.outline.iter().map(at));
    if length < 2.0 * thickness || area < (1.0 - STRAIGHT) * length * thickness {
        return None;
    }
    let points = points::of_shape::<D>(geometry, spacing);
    let places: Vec<[f64; 2]> =
        points.iter().map(|point| at(&[point.position[0], point.position[1]])).collect();
    // Whole columns of an unturned lattice are as long as they are, which is no matter of stiffness.
    let length = match spacing.turn == 0.0 {
        true => extents(&mut places.iter().copied())[0] + spacing.dx,
        false => length,
    };
    let middle = places.iter().map(|p| p[1]).sum::<f64>() / places.len() as f64;
    let cell = spacing.dx.powi(2);
    let moment: f64 = places.iter().map(|p| cell * ((p[1] - middle).powi(2) + cell / 12.0)).sum();
    Some([thickness.powi(3) / 12.0, moment / length])
}

fn length<const D: usize>(x: &[f64; D]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Relative tolerance of lengths.
const TOLERANCE: f64 = 1e-9;

/// Least thickness of a plate as the fluid's moving wall, in spacings of the fluid: a thinner one does not hold water.
/// `None` where that is not asked for.
pub fn least_thickness(scene: &Scene) -> Option<f64> {
    let asked = scene.fluid.is_some()
        && !scene.solids.is_empty()
        && scene.interface.treatment == Treatment::MovingWall
        && scene.switch(EffectName::ThinPlateScreen) != Switch::Off;
    asked.then(|| (2.0 * scene.smoothing_ratio * (1.0 - TOLERANCE) - 1.0).ceil().max(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parse;
    use std::path::Path;

    fn plate(geometry: &str) -> Option<Plate<2>> {
        let text = format!(
            "resolution = 0.01\nend_time = 1.0\n[solid]\nmodel = \"hypoelastic\"\ndensity = 1000.0\n\
             youngs_modulus = 1e6\npoissons_ratio = 0.3\n[[shape]]\nname = \"s\"\nphase = \"solid\"\n{geometry}\n"
        );
        let scene = parse(&text, Path::new("s.toml"), &[]).unwrap();
        Plate::of(&scene, &scene.shapes[0])
    }

    #[test]
    fn a_box_looks_along_its_thin_side() {
        let wall = plate("box = { min = [0.1, 0.0], max = [0.13, 0.2] }").unwrap();
        assert_eq!(wall.rows, 3.0);
        let (normal, before) = wall.across(&[0.125, 0.05]);
        assert_eq!(normal, [1.0, 0.0]);
        assert!((before - 0.01).abs() < 1e-15);
        assert!(wall.holds(&[0.105, 0.195]) && !wall.holds(&[0.14, 0.1]));
        let floor = plate("box = { min = [0.0, 0.0], max = [0.2, 0.02] }").unwrap();
        assert_eq!((floor.rows, floor.across(&[0.1, 0.005]).0), (2.0, [0.0, 1.0]));
        assert_eq!(plate("box = { min = [0.0, 0.0], max = [0.03, 0.05] }"), None, "a block");
    }

    /// Half of a plate beside its other half: of a body that both name they are one plate.
    #[test]
    fn boxes_of_one_body_side_by_side_are_one_plate() {
        let beside = |to: f64, body: &str| {
            plate(&format!(
                "body = \"b\"\nbox = {{ min = [0.1, 0.0], max = [0.12, 0.2] }}\n[[shape]]\nname = \"t\"\n\
                 phase = \"solid\"\nbody = \"{body}\"\nbox = {{ min = [0.12, 0.0], max = [0.14, {to}] }}"
            ))
        };
        let whole = beside(0.2, "b").unwrap();
        assert_eq!(whole.rows, 4.0);
        let (_, before) = whole.across(&[0.125, 0.1]);
        assert!((before - 0.005).abs() < 1e-15 && whole.holds(&[0.135, 0.1]), "{before}");
        // A longer one counts as far as it lies beside, and one that lies over it, too.
        let over = plate(
            "body = \"b\"\nbox = { min = [0.1, 0.0], max = [0.12, 0.2] }\n[[shape]]\nname = \"t\"\nphase = \"solid\"\n\
             body = \"b\"\nbox = { min = [0.1, -0.1], max = [0.13, 0.2] }",
        );
        assert_eq!([beside(0.3, "b"), over].map(|plate| plate.unwrap().rows), [4.0, 3.0]);
        // Ballast of one row in a hull is no plate.
        let hull = "[[shape]]\nname = \"hull\"\nphase = \"solid\"\nbody = \"b\"\n\
                    box = { min = [0.0, 0.1], max = [0.2, 0.3] }";
        assert_eq!(
            plate(&format!("body = \"b\"\nbox = {{ min = [0.02, 0.2], max = [0.18, 0.21] }}\n{hull}")),
            None
        );
        // A shorter one, and another body's.
        assert_eq!([beside(0.15, "b"), beside(0.2, "c")].map(|plate| plate.unwrap().rows), [2.0; 2]);
    }

    #[test]
    fn a_ring_looks_outward() {
        let ring = plate("ring = { center = [0.0, 0.0], inner = 0.05, outer = 0.07 }").unwrap();
        assert!((ring.rows - 2.0).abs() < 1e-12);
        let (normal, before) = ring.across(&[-0.065, 0.0]);
        assert_eq!(normal, [-1.0, 0.0]);
        assert!((before - 0.005).abs() < 1e-15);
        assert!(ring.holds(&[0.0, 0.055]) && !ring.holds(&[0.0, 0.0]));
        assert_eq!(plate("disc = { center = [0.0, 0.0], radius = 0.05 }"), None);
    }

    #[test]
    fn a_turned_plate_looks_across_itself() {
        // 0.2 m by 0.03 m about its middle, (0.2, 0.115): at 30 degrees its normal is (-1, sqrt 3) / 2.
        let turned =
            plate("box = { min = [0.1, 0.1], max = [0.3, 0.13] }\nrotate = { angle = 30.0 }").unwrap();
        let (sin, cos) = (0.5, 0.75_f64.sqrt());
        let at =
            |along: f64, before: f64| [0.2 + cos * along - sin * before, 0.115 + sin * along + cos * before];
        // The same as a polygon, where the normal may look either way.
        let corners = [[-0.1, -0.015], [0.1, -0.015], [0.1, 0.015], [-0.1, 0.015]].map(|[s, n]| at(s, n));
        let polygon = plate(&format!("polygon = {corners:?}")).unwrap();
        for (plate, tolerance) in [(turned, 1e-12), (polygon, 1e-9)] {
            assert!((plate.rows - 3.0).abs() < 1e-9, "{}", plate.rows);
            for (along, before) in [(0.0, 0.01), (0.095, -0.01), (-0.095, 0.0)] {
                let x = at(along, before);
                assert!(plate.holds(&x));
                let (normal, found) = plate.across(&x);
                let side = (normal[1] * cos - normal[0] * sin).signum();
                assert!(
                    (normal[0] * side + sin).abs() + (normal[1] * side - cos).abs() < tolerance,
                    "{normal:?}"
                );
                assert!((found * side - before).abs() < tolerance, "{found} at {along}, {before}");
            }
            assert!(!plate.holds(&at(0.0, 0.03)));
        }
    }

    /// 5 mm at 1.4 mm are four rows, 0.7 and 2.1 mm off the middle: (5.6 mm)³ / 12, whichever way the plate lies. A
    /// wedge is no plate whose second moment is one number.
    #[test]
    fn second_moments_by_hand() {
        let moments = |dx: f64, geometry: &str| {
            let text = format!(
                "resolution = {dx}\nend_time = 1.0\n[solid]\nmodel = \"hypoelastic\"\ndensity = 1000.0\n\
                 youngs_modulus = 1e6\npoissons_ratio = 0.3\n[[shape]]\nname = \"s\"\nphase = \"solid\"\n{geometry}\n"
            );
            let scene = parse(&text, Path::new("s.toml"), &[]).unwrap();
            second_moments::<2>(&scene, &scene.shapes[0]).map(|moments| moments.map(|moment| 12.0 * moment))
        };
        let upright = "polygon = [[0.0, 0.0], [0.005, 0.0], [0.005, 0.1], [0.0, 0.1]]";
        // Along (3, 4) / 5.
        let inclined = "polygon = [[0.0, 0.0], [0.06, 0.08], [0.056, 0.083], [-0.004, 0.003]]";
        for geometry in [upright, inclined, "box = { min = [0.0, 0.0], max = [0.1, 0.005] }"] {
            let [asked, computed] = moments(0.0014, geometry).unwrap();
            assert!((asked / 0.005_f64.powi(3) - 1.0).abs() < 1e-9, "{geometry}: {asked}");
            assert!((computed / 0.0056_f64.powi(3) - 1.0).abs() < 1e-9, "{geometry}: {computed}");
        }
        // Of a turned lattice the rough edges of the plate: 16 spacings across and 160 along.
        let turned = "box = { min = [0.0, 0.0], max = [0.2, 0.02] }\nlattice_angle = 30";
        let [asked, computed] = moments(0.00125, turned).unwrap();
        assert!((computed / asked - 1.0).abs() < 0.02, "{}", computed / asked);
        assert_eq!(moments(0.001, "polygon = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.01], [0.0, 0.005]]"), None);
    }

    #[test]
    fn a_polygon_is_a_plate_where_it_is_thin() {
        // A block of 0.1 m with a fin of 0.02 m: h = 1.5 dx, and 4h - dx = 0.05 m.
        let fin = plate(
            "polygon = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.04], [0.3, 0.04], [0.3, 0.06], [0.1, 0.06], [0.1, 0.1], \
             [0.0, 0.1]]",
        );
        let fin = fin.unwrap();
        assert!((fin.rows - 2.0).abs() < 1e-9);
        assert!(fin.holds(&[0.2, 0.045]) && !fin.holds(&[0.05, 0.05]));
        assert_eq!(plate("polygon = [[0.0, 0.0], [0.1, 0.0], [0.0, 0.1]]"), None);
    }
}
