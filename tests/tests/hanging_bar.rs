//! A bar that gravity pulls along itself: stress, strain, velocity and displacement by hand, whatever its model and
//! however its lattice lies; and what frames and run.json say of it.

use halfstep_output::Frame;
use halfstep_tests::Finished;
use halfstep_tests::run::scene_at;

const LENGTH: f64 = 0.1;
const E: f64 = 1e6;
const DENSITY: f64 = 1000.0;
const G: f64 = 10.0;

/// 40 x 8 particles are free, 4 x 8 are held. `modulus` is that of a wide or a narrow bar, Pa: four periods are run.
fn bar(solid: &str, shape: &str, modulus: f64) -> Finished {
    let end = 16.0 * LENGTH * (DENSITY / modulus).sqrt();
    let text = format!(
        "resolution = 0.0025\nend_time = {end}\ngravity = [{G}, 0.0]\n[solid]\ndensity = {DENSITY}\n\
         youngs_modulus = {E}\npoissons_ratio = 0.3\n{solid}\n[output]\nframe_interval = {}\n[[shape]]\nname = \"bar\"\n\
         phase = \"solid\"\nbox = {{ min = [-0.01, 0.0], max = [{LENGTH}, 0.02] }}\n{shape}\n\
         clamp = {{ min = [-0.02, -0.01], max = [0.0, 0.03] }}\n\
         [[probe]]\nname = \"tip\"\nkind = \"displacement\"\nat = [{LENGTH}, 0.01]\n\
         [[probe]]\nname = \"tip-v\"\nkind = \"solid-velocity\"\nat = [{LENGTH}, 0.01]\n\
         [[probe]]\nname = \"strain\"\nkind = \"strain\"\nat = [0.05, 0.01]\n\
         [[probe]]\nname = \"stress\"\nkind = \"cauchy-stress\"\nat = [0.05, 0.01]\n\
         [[probe]]\nname = \"mean-strain\"\nkind = \"strain\"\nbody = \"bar\"\n\
         [[probe]]\nname = \"mean-stress\"\nkind = \"cauchy-stress\"\nbody = \"bar\"\n",
        end / 4.0
    );
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("bar.toml");
    std::fs::write(&path, text).expect("a scene");
    scene_at(&path).run()
}

/// Means over four periods are those at rest: in the middle the stress rho g L / 2; over the bar the same, and u / L.
/// Bands: the wave's period is that of the scheme and not quite the window's, a half of it would be 6 %.
fn holds(run: &Finished, modulus: f64, held: f64, tolerance: f64) {
    let mean = |name: &str| run.curve(name).mean();
    let near = |what: &str, found: f64, expected: f64| {
        println!("{what}: {found:.4e} of {expected:.4e}");
        assert!((found / expected - 1.0).abs() < tolerance, "{what}: {found} of {expected}");
    };
    let middle = 0.5 * DENSITY * G * LENGTH;
    near("stress", mean("stress.xx"), middle);
    near("strain", mean("strain.xx"), middle / modulus);
    near("tip", mean("tip.x"), middle * LENGTH / modulus);
    // What is held has its share in the mean.
    let free = 1.0 - held;
    near("mean stress", mean("mean-stress.xx"), middle * free);
    near("mean strain", mean("mean-strain.xx"), mean("tip.x") / LENGTH * free);
    // The way is the velocity's sum.
    let [x, v] = ["tip.x", "tip-v.x"].map(|name| run.curve(name));
    let steps = v.times.windows(2).zip(v.values.windows(2)).map(|(t, v)| 0.5 * (t[1] - t[0]) * (v[0] + v[1]));
    let (way, last) = (steps.sum::<f64>(), x.values[x.values.len() - 1]);
    assert!((way - last).abs() < 1e-3 * x.peak().1, "{way} {last}");
    assert!(mean("stress.xy").abs() < 1e-3 * middle && mean("strain.xy").abs() < 1e-3 * middle / modulus);
}

#[test]
fn stress_and_strain_of_every_model_are_those_by_hand() {
    // 4 of 44 columns are held and carry nothing.
    let held = 4.0 / 44.0;
    let narrow = bar("plane = \"stress\"", "", E);
    holds(&narrow, E, held, 0.03);
    let across = narrow.curve("stress.zz").peak().1;
    assert!(across < 1e-9, "{across} Pa in plane stress");
    holds(&bar("model = \"finite-element\"\nplane = \"stress\"", "", E), E, held, 0.03);
    // In plane strain a bar is stiffer, and nu times its stress acts across.
    let wide = E / (1.0 - 0.3 * 0.3);
    let run = bar("", "", wide);
    holds(&run, wide, held, 0.03);
    let across = run.curve("stress.zz").mean() / run.curve("stress.xx").mean();
    assert!((across - 0.3).abs() < 0.003, "{across}");
    columns_and_extremes(&run);
}

/// The hypoelastic solid is soft at its surfaces, but stress and strain belong together: E / (1 - nu²), with the strain
/// of nine particles.
#[test]
fn neighbours_tell_the_strain_of_a_model_without_a_gradient() {
    let wide = E / (1.0 - 0.3 * 0.3);
    let run = bar("model = \"hypoelastic\"", "", wide);
    let modulus = run.curve("stress.xx").mean() / run.curve("strain.xx").mean();
    println!("modulus {modulus:.4e} of {wide:.4e}");
    assert!((modulus / wide - 1.0).abs() < 0.03, "{modulus}");
}

/// Places of a lattice about the middle of the bar that lie in it, counted apart from this program. The modulus that
/// the tip tells lacks what rough edges do not carry: it is first order in the spacing, and least along the diagonal.
#[test]
fn a_lattice_that_is_turned_has_its_count_and_its_modulus() {
    for (angle, finer, count, band) in [
        (45.0, 1.0, 346, 0.97..0.99),
        (20.0, 1.0, 354, 0.88..0.905),
        (-70.0, 1.0, 354, 0.88..0.905),
        (20.0, 2.0, 1414, 0.935..0.955),
    ] {
        let dx = 0.0025 / finer;
        let run = bar("plane = \"stress\"", &format!("lattice_angle = {angle}\nspacing = {dx}"), E);
        assert_eq!(run.report.particles.solid, count, "{angle}");
        let mass = run.report.participants[0].mass;
        assert!((mass / (DENSITY * dx * dx * count as f64) - 1.0).abs() < 1e-12, "{mass}");
        let modulus = 0.5 * DENSITY * G * LENGTH * LENGTH / run.curve("tip.x").mean();
        println!("{angle} degrees, {dx} m: modulus {:.4} of E", modulus / E);
        assert!(band.contains(&(modulus / E)), "{angle}, {dx} m: {modulus}");
    }
}

/// Displacements are those of the points, von Mises stresses those of the stresses, and the end of each column of
/// probes.csv and its extremes stand in run.json.
fn columns_and_extremes(run: &Finished) {
    let frames: Vec<Frame> = run.outcome.frames("solid");
    let (first, last) = (&frames[0], &frames[frames.len() - 1]);
    assert_eq!((first.len(), last.body.iter().max()), (352, Some(&0)));
    for (k, id) in last.id.iter().enumerate() {
        let at_first = first.id.iter().position(|other| other == id).expect("the same particles");
        for d in 0..3 {
            let gone = last.points[k][d] - first.points[at_first][d];
            assert!((gone - last.displacement[k][d]).abs() < 2e-8, "{gone} {:?}", last.displacement[k]);
        }
        let [xx, yy, zz, xy, _, _] = last.stress[k].map(f64::from);
        let squares = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
        let von_mises = (0.5 * squares + 3.0 * xy * xy).sqrt();
        assert!((von_mises - f64::from(last.von_mises[k])).abs() < 1e-3, "{von_mises} {}", last.von_mises[k]);
    }
    let table = run.outcome.probes();
    assert_eq!(run.report.probes.len() + 1, table.columns.len());
    for (k, report) in run.report.probes.iter().enumerate() {
        assert_eq!(format!("{} [{}]", report.name, report.unit), table.columns[k + 1]);
        let values: Vec<f64> = table.rows.iter().map(|row| row[k + 1]).collect();
        assert_eq!(report.end, values.last().copied());
        assert_eq!(report.max, values.iter().copied().reduce(f64::max));
        assert_eq!(report.min, values.iter().copied().reduce(f64::min));
    }
}
