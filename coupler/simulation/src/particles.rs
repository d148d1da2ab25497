//! What a solid of another program is told of its particles: those that the program itself would give it.

use halfstep_scene::Scene;
use halfstep_scene::geometry::{self, Layout};
use std::fmt::Write;

/// Environment variable with the path of the file.
pub(crate) const PARTICLES_VARIABLE: &str = "HALFSTEP_PARTICLES";

/// First line of the file.
const COLUMNS: &str =
    "x [m],y [m],z [m],vx [m/s],vy [m/s],vz [m/s],mass [kg],density [kg/m3],clamped,body,shape";

/// Name of the file in the run's folder.
pub(crate) fn file_name(solid: &str) -> String {
    format!("particles-{solid}.csv")
}

/// The particles of the solid at that place in [`Scene::solids`], a line for each in the order of their numbers. Every
/// number reads back bit for bit. In two dimensions the mass is per metre of depth, kg/m.
pub(crate) fn table<const D: usize>(scene: &Scene, layout: &Layout<D>, solid: usize) -> String {
    let density = scene.solids[solid].density;
    let mass = density * scene.solid_spacing(solid).powi(D as i32);
    let mut own: Layout<D> = Layout { solid: layout.solid.clone(), ..Layout::default() };
    own = own.with_solid(scene, solid);
    let mut text = format!("{COLUMNS}\n");
    for (point, piece) in own.solid.iter().zip(geometry::pieces(scene, &own)) {
        for vector in [point.position, point.velocity] {
            for axis in 0..3 {
                let _ = write!(text, "{:e},", vector.get(axis).copied().unwrap_or(0.0));
            }
        }
        let clamped = u8::from(point.clamped);
        let _ = writeln!(text, "{mass:e},{density:e},{clamped},{piece},{}", point.body);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_solid_is_told_its_own_particles_alone() {
        let text = "resolution = 0.1\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n\
            [[solid]]\nname = \"a\"\ndensity = 1100.0\nyoungs_modulus = 1e6\npoissons_ratio = 0.3\n\
            [[solid]]\nname = \"b\"\ndensity = 1200.0\nyoungs_modulus = 1e6\npoissons_ratio = 0.3\n\
            [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [1.0, 0.5] }\n\
            [[shape]]\nname = \"one\"\nphase = \"solid\"\nsolid = \"a\"\n\
            box = { min = [2.0, 0.0], max = [2.4, 0.4] }\nclamp = { min = [2.0, 0.0], max = [2.4, 0.1] }\n\
            [[shape]]\nname = \"two\"\nphase = \"solid\"\nsolid = \"b\"\nvelocity = [0.5, 0.0]\n\
            box = { min = [3.0, 0.0], max = [3.4, 0.4] }\n";
        let scene = halfstep_scene::parse(text, "two.toml".as_ref(), &[]).unwrap();
        let layout = geometry::layout::<2>(&scene);
        let [a, b] = [0, 1].map(|solid| table(&scene, &layout, solid));
        let rows = |table: &str| -> Vec<Vec<f64>> {
            let row = |line: &str| line.split(',').map(|cell| cell.parse().unwrap()).collect();
            table.lines().skip(1).map(row).collect()
        };
        assert!(a.starts_with(COLUMNS) && rows(&a).len() == 16 && rows(&b).len() == 16, "{a}");
        let own = layout.solid.iter().map(|p| p.position);
        for (row, position) in rows(&a).iter().chain(&rows(&b)).zip(own) {
            assert_eq!(row[..2], position, "bit for bit");
        }
        assert_eq!(rows(&a).iter().filter(|row| row[8] == 1.0).count(), 4);
        let row = &rows(&b)[5];
        assert_eq!([&row[3..6], &row[7..]].concat(), [0.5, 0.0, 0.0, 1200.0, 0.0, 0.0, 2.0]);
        assert!((row[6] - 1200.0 * 0.1 * 0.1).abs() < 1e-12, "density times volume: {} kg/m", row[6]);
    }
}
