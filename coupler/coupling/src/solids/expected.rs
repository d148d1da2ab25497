//! What the scene has for a solid that another program computes, to compare its first message with.

use halfstep_output::{FirstMessage, IN_FLUID};
use halfstep_scene::geometry::{Cells, Layout, SolidPoint};
use halfstep_scene::{RigidBody, Scene};
use halfstep_wire::protocol::StateRecord;
use halfstep_wire::wide;

/// Most particles whose distance is measured exactly where none of the scene's places is near.
const MOST_MEASURED: usize = 1000;

/// How far from the nearest place of a lattice a point of the material may be, in spacings: half the diagonal of a
/// cell, and a little more. A particle beside the outline, in line with a row, is that far where it lies a quarter of a
/// spacing outside.
fn near<const D: usize>() -> f64 {
    0.5 * (D as f64).sqrt() + 0.04
}

/// Particles of the scene.
pub(crate) struct Expected<const D: usize> {
    name: String,
    /// Their spacing, m.
    dx: f64,
    places: Vec<[f64; D]>,
    /// With what velocity each begins, m/s.
    velocities: Vec<[f64; D]>,
    /// Centre of their mass, and of that of the outer ones, m.
    centres: [[f64; D]; 2],
    /// The solid's density, and the mean of its shapes', kg/m³.
    densities: [f64; 2],
    sound_speed: f64,
    /// Those that the fluid's kernel reaches: a solid need not publish the others.
    outer: Vec<bool>,
    /// Of all, as the scene says.
    mass: f64,
    right_mass: [f64; 2],
    /// The fluid's, m.
    fluid: Vec<[f64; D]>,
    /// Mean of the fluid's and the solid's, m.
    between: f64,
}

/// Square of a distance, m².
fn squared<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|d| (a[d] - b[d]).powi(2)).sum()
}

/// Places in cells of a side, m, which no question exceeds.
fn in_cells<const D: usize>(places: &[[f64; D]], side: f64) -> Cells<[f64; D], D> {
    let mut cells = Cells::new(side);
    places.iter().for_each(|place| cells.add(place, *place));
    cells
}

fn is_near<const D: usize>(cells: &Cells<[f64; D], D>, place: &[f64; D], reach: f64) -> bool {
    cells.around(place).any(|other| squared(other, place) <= reach * reach)
}

/// Centre of places with weights.
fn centre<const D: usize>(weighted: impl Iterator<Item = ([f64; D], f64)>) -> [f64; D] {
    let (mut sum, mut whole) = ([0.0; D], 0.0);
    for (x, weight) in weighted {
        (0..D).for_each(|d| sum[d] += weight * x[d]);
        whole += weight;
    }
    sum.map(|x| x / whole)
}

/// Whether each place is within a reach, m, of one that lacks neighbours on its lattice.
fn outer<const D: usize>(places: &[[f64; D]], dx: f64, reach: f64) -> Vec<bool> {
    let ring = (D as f64).sqrt() * 1.05 * dx;
    let near = in_cells(places, ring);
    let lacks = |place: &&[f64; D]| {
        let neighbours = near.around(place).filter(|other| squared(other, place) <= ring * ring);
        neighbours.count() < 3_usize.pow(D as u32)
    };
    let surface: Vec<[f64; D]> = places.iter().filter(lacks).copied().collect();
    let surface = in_cells(&surface, reach);
    places.iter().map(|place| is_near(&surface, place, reach)).collect()
}

impl<const D: usize> Expected<D> {
    /// Of the solid of that index.
    pub(crate) fn of(scene: &Scene, layout: &Layout<D>, solid: usize) -> Self {
        let dx = scene.solid_spacing(solid);
        let own = |point: &&SolidPoint<D>| scene.shapes[point.body as usize].solid == Some(solid);
        let own: Vec<&SolidPoint<D>> = layout.solid.iter().filter(own).collect();
        let places: Vec<[f64; D]> = own.iter().map(|point| point.position).collect();
        // Half a spacing less than the support: nobody shall be told of what rounding decides.
        let outer = outer(&places, dx, (2.0 * scene.smoothing_ratio * scene.resolution - 0.5 * dx).max(dx));
        let cell = dx.powi(D as i32);
        let density = scene.solids[solid].density;
        let own_density =
            |point: &&SolidPoint<D>| scene.shapes[point.body as usize].density.unwrap_or(density);
        let mass = given_mass(scene, solid, &own, |point| own_density(&point) * cell);
        // The table of particles has the solid's density everywhere: a record's mass is what water it displaces.
        let told = density * cell * own.len() as f64;
        let part = outer.iter().filter(|outer| **outer).count() as f64 / own.len().max(1) as f64;
        let outer_ones = places.iter().zip(&outer).filter(|(_, outer)| **outer);
        Self {
            name: scene.solids[solid].name.clone(),
            dx,
            velocities: own.iter().map(|point| point.velocity).collect(),
            centres: [
                centre(places.iter().map(|place| (*place, 1.0))),
                centre(outer_ones.map(|(place, _)| (*place, 1.0))),
            ],
            densities: [density, own.iter().map(own_density).sum::<f64>() / own.len().max(1) as f64],
            sound_speed: scene.fluid.as_ref().map_or(f64::MAX, |fluid| fluid.sound_speed),
            right_mass: [told * part, told],
            mass,
            places,
            outer,
            fluid: layout.fluid.iter().map(|point| point.position).collect(),
            between: scene.interface_spacing(solid),
        }
    }

    /// Compares the solid's first positions, m, and the masses of its records with it.
    pub(crate) fn compare(&self, first: &[[f64; 3]], records: &[StateRecord]) -> FirstMessage {
        let reach = near::<D>() * self.dx;
        let published: Vec<[f64; D]> = first.iter().map(|x| std::array::from_fn(|d| x[d])).collect();
        let places = in_cells(&self.places, reach);
        let away: Vec<&[f64; D]> = published.iter().filter(|x| !is_near(&places, x, reach)).collect();
        let distance = |x: &&[f64; D]| {
            self.places.iter().map(|place| squared(place, x)).fold(f64::INFINITY, f64::min).sqrt()
        };
        let measured = away.iter().take(MOST_MEASURED).map(|x| (distance(x), **x));
        let farthest = measured.max_by(|a, b| a.0.total_cmp(&b.0));
        let filled = in_cells(&published, reach);
        let outer =
            || self.places.iter().zip(&self.outer).filter(|(_, outer)| **outer).map(|(place, _)| place);
        let empty: Vec<&[f64; D]> = outer().filter(|place| !is_near(&filled, place, reach)).collect();
        let mut moving = Cells::new(reach);
        self.places.iter().zip(&self.velocities).for_each(|(at, v)| moving.add(at, (*at, *v)));
        let apart = records.iter().filter_map(|record| {
            let [at, velocity] = [record.position, record.velocity].map(|x| std::array::from_fn(|d| x[d]));
            let near = moving.around(&at).filter(|(x, _)| squared(x, &at) <= reach * reach);
            let differences = near.map(|(_, told)| squared(told, &velocity).sqrt());
            differences.reduce(f64::min)
        });
        let middle = centre(records.iter().map(|r| (std::array::from_fn(|d| r.position[d]), r.mass)));
        let off_centre = self.centres.map(|told| squared(&told, &middle).sqrt());
        let density = records.iter().map(|r| r.density).sum::<f64>() / records.len().max(1) as f64;
        let [one, other] = self.densities;
        let close = IN_FLUID * self.between;
        let solid = in_cells(&published, close);
        FirstMessage {
            name: self.name.clone(),
            particles: published.len() as u64,
            mass: records.iter().map(|record| record.mass).sum(),
            scene_particles: self.places.len() as u64,
            scene_mass: self.mass,
            outer_particles: outer().count() as u64,
            right_mass: self.right_mass,
            empty: empty.len() as u64,
            first_empty: empty.first().map(|place| wide(**place)),
            misplaced: away.len() as u64,
            farthest: farthest.map_or(0.0, |(distance, _)| distance),
            farthest_at: farthest.map(|(_, at)| wide(at)),
            off_velocity: apart.fold(0.0, f64::max),
            sound_speed: self.sound_speed,
            off_centre: off_centre[0].min(off_centre[1]) / self.dx,
            density,
            scene_density: if (density - one).abs() < (density - other).abs() { one } else { other },
            in_fluid: self.fluid.iter().filter(|x| is_near(&solid, x, close)).count() as u64,
        }
    }
}

/// Mass of particles, each of `mass` but for those of rigid bodies whose mass the scene says, kg (2D: kg/m).
fn given_mass<const D: usize>(
    scene: &Scene,
    solid: usize,
    own: &[&SolidPoint<D>],
    mass: impl Fn(&SolidPoint<D>) -> f64,
) -> f64 {
    let bodies = scene.solids[solid].rigid().map_or(&[][..], |keys| &keys.bodies);
    let body = |point: &SolidPoint<D>| scene.shapes[point.body as usize].body();
    let given =
        |body: &RigidBody| body.mass.filter(|_| own.iter().any(|point| self::is_of(scene, point, body)));
    let free = own.iter().filter(|point| {
        let said = bodies.iter().find(|said| said.name == body(point));
        said.is_none_or(|said| said.mass.is_none())
    });
    free.map(|point| mass(point)).sum::<f64>() + bodies.iter().filter_map(given).sum::<f64>()
}

fn is_of<const D: usize>(scene: &Scene, point: &SolidPoint<D>, body: &RigidBody) -> bool {
    scene.shapes[point.body as usize].body() == body.name
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfstep_scene::geometry;

    const DX: f64 = 0.005;

    /// Water of 0.2 m by 0.1 m that leans on a block of 8 by 28 particles of 0.2 kg/m.
    fn block(more: &str) -> Expected<2> {
        let text = format!(
            "resolution = {DX}\nend_time = 1.0\nsmoothing_ratio = 1.5\n[fluid]\ndensity = 1000.0\n[solid]\nmodel = \"rigid\"\ndensity = 8000.0\n\
             {more}[[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [0.2, 0.1] }}\n\
             [[shape]]\nname = \"block\"\nphase = \"solid\"\nbox = {{ min = [0.2, 0.0], max = [0.24, 0.14] }}\n"
        );
        let scene = halfstep_scene::parse(&text, "x.toml".as_ref(), &[]).unwrap_or_else(|e| panic!("{e:?}"));
        Expected::of(&scene, &geometry::layout::<2>(&scene), 0)
    }

    /// A lattice of that spacing in the block, each particle of that mass, shifted along x.
    fn lattice(dx: f64, mass: f64, shift: f64) -> (Vec<[f64; 3]>, Vec<StateRecord>) {
        let count = |extent: f64| (extent / dx).round() as usize;
        let row = |j: usize| {
            (0..count(0.04)).map(move |i| [0.2 + (i as f64 + 0.5) * dx + shift, (j as f64 + 0.5) * dx, 0.0])
        };
        let positions: Vec<[f64; 3]> = (0..count(0.14)).flat_map(row).collect();
        let record = |position: &[f64; 3]| StateRecord {
            mass,
            density: 8000.0,
            position: *position,
            ..StateRecord::default()
        };
        let records = positions.iter().map(record).collect();
        (positions, records)
    }

    fn compare((positions, records): (Vec<[f64; 3]>, Vec<StateRecord>)) -> FirstMessage {
        block("").compare(&positions, &records)
    }

    #[test]
    fn the_scenes_own_particles_are_as_expected() {
        let first = compare(lattice(DX, 0.2, 0.0));
        assert_eq!((first.particles, first.scene_particles), (224, 224));
        // The support is 15 mm, three rows: 2 x 22 are inside.
        assert_eq!(first.outer_particles, 224 - 2 * 22);
        assert!((first.mass - 44.8).abs() < 1e-9 && (first.scene_mass - 44.8).abs() < 1e-9, "{first:?}");
        assert_eq!((first.empty, first.misplaced, first.in_fluid), (0, 0, 0));
        assert_eq!(first.remarks(2), [""; 0]);
        // Without what the water does not reach.
        let (positions, records) = lattice(DX, 0.2, 0.0);
        let inside = |x: &[f64; 3]| (0.215..0.225).contains(&x[0]) && (0.015..0.125).contains(&x[1]);
        let kept: Vec<usize> = (0..positions.len()).filter(|&k| !inside(&positions[k])).collect();
        let first = compare((
            kept.iter().map(|&k| positions[k]).collect(),
            kept.iter().map(|&k| records[k]).collect(),
        ));
        assert_eq!(first.particles, 180);
        assert_eq!(first.remarks(2), [""; 0]);
        // The points of a mesh of 7 by 25 cells.
        assert_eq!(compare(lattice(0.0056, 44.8 / 175.0, 0.0)).misplaced, 0);
    }

    #[test]
    fn a_block_without_its_lower_rows() {
        let (positions, records) = lattice(DX, 0.2, 0.0);
        let first = compare((positions[48..].to_vec(), records[48..].to_vec()));
        // Six rows, of which the water does not reach two columns from the fourth on.
        assert_eq!((first.particles, first.empty), (176, 48 - 3 * 2));
        let remarks = first.remarks(2);
        assert!(remarks.iter().any(|text| text.contains("42 of 180 places")), "{remarks:?}");
        assert!(remarks.iter().any(|text| text.contains("the first at [0.2025, 0.0025]")), "{remarks:?}");
    }

    #[test]
    fn a_block_at_half_the_spacing_and_of_tenfold_mass() {
        let first = compare(lattice(0.5 * DX, 0.2, 0.0));
        assert_eq!(first.particles, 896);
        let remarks = first.remarks(2);
        let [count, mass] = &remarks[..] else { panic!("{first:?}") };
        assert!(count.contains("publishes 896 particles, and its shapes have 224"), "{count}");
        assert!(
            mass.contains("a mass of 179.2000 kg/m, and the table of its particles 44.8000 kg/m"),
            "{mass}"
        );
        // Of the right mass.
        assert_eq!(compare(lattice(0.5 * DX, 0.05, 0.0)).remarks(2).len(), 1);
        let heavy = compare(lattice(DX, 2.0, 0.0)).remarks(2);
        assert!(heavy.len() == 1 && heavy[0].contains("a mass of 448.0000 kg/m"), "{heavy:?}");
    }

    #[test]
    fn a_block_that_moves_and_one_that_is_heavy_above() {
        let (positions, mut records) = lattice(DX, 0.2, 0.0);
        records[7].velocity = [0.3, 0.4, 0.0];
        let first = compare((positions.clone(), records.clone()));
        assert!((first.off_velocity - 0.5).abs() < 1e-12, "{first:?}");
        // Masses from 0 to 0.4 kg/m over 28 rows: their centre is 28 (28^2 - 1) / 12 / (28 * 27 / 2) rows above the
        // middle, 4.833.
        let rows = |k: usize| (k / 8) as f64;
        records.iter_mut().enumerate().for_each(|(k, r)| r.mass = 0.4 * rows(k) / 27.0);
        records[7].velocity = [0.0; 3];
        let first = compare((positions, records));
        assert!((first.off_centre - 4.8333333).abs() < 1e-6 && first.off_velocity == 0.0, "{first:?}");
        let remarks = first.remarks(2);
        assert!(remarks.len() == 1 && remarks[0].contains("4.8 spacings"), "{remarks:?}");
    }

    /// 28 particles are a spacing left of the outline, 20 of them where water is.
    #[test]
    fn a_block_in_the_water() {
        let first = compare(lattice(DX, 0.2, -DX));
        assert_eq!((first.misplaced, first.in_fluid, first.empty), (28, 20, 28));
        assert!((first.farthest - DX).abs() < 1e-12, "{first:?}");
    }

    /// 30 of 44.8 kg/m: the body's own mass is its solver's matter. Records of that mass would displace two thirds of
    /// the water that the block does.
    #[test]
    fn records_have_the_mass_of_the_table_where_a_body_has_its_own() {
        let given = block("bodies = [{ name = \"block\", mass = 30.0 }]\n");
        let remarks = |mass: f64| {
            let (positions, records) = lattice(DX, mass, 0.0);
            given.compare(&positions, &records).remarks(2)
        };
        assert_eq!(remarks(0.2), [""; 0]);
        let own = remarks(30.0 / 224.0);
        assert!(
            own.len() == 1 && own[0].contains("30.0000 kg/m, and the table of its particles 44.8000"),
            "{own:?}"
        );
    }
}
