//! Boundaries that no lattice fits: they hold water as boxes do, and float as boxes do.

use halfstep_fluid::Fluid;
use halfstep_output::Frame;
use halfstep_role::role::Role;
use halfstep_scene::geometry::layout;
use halfstep_scene::{self as scene, Scene};
use halfstep_solid::total_lagrangian::TotalLagrangian;
use halfstep_solid::{Load, SolidModel};
use halfstep_sph::lane::Isa;
use halfstep_tests::fluid_alone::go_on;
use halfstep_tests::run;
use halfstep_wire::half_step::HalfStep;
use std::path::Path;

const GRAVITY: f64 = 9.81;
const DEPTH: f64 = 0.2;

/// Still water on a beach of 30 degrees whose foot is at x = 0.5 m; it goes on below the floor, where water does not
/// see how thin its tip is.
const BEACH: &str = "[[shape]]\nname = \"beach\"\nphase = \"wall\"\n\
    polygon = [[0.3267949192431123, -0.1], [1.2, -0.1], [1.2, 0.4041451884327381]]\n\
    [[shape]]\nname = \"tank\"\nphase = \"wall\"\ntank = { min = [0.0, 0.0], max = [1.2, 0.5], open = [\"top\"] }\n\
    [[shape]]\nname = \"water\"\nphase = \"fluid\"\npressure = \"hydrostatic\"\n\
    box = { min = [0.0, 0.0], max = [1.2, 0.2] }\n";

/// Still water over the upper end of a beach of 15 degrees that stands on the floor and leans on the side wall; turned
/// and shifted to where it is.
const LEANING: &str = "[[shape]]\nname = \"beach\"\nphase = \"wall\"\n\
    polygon = [[0.0, 0.0], [-0.6, 0.0], [-0.6, -0.1607695]]\nrotate = { angle = 180.0, about = [0.0, 0.0] }\n\
    translate = [0.2, 0.0]\n\
    [[shape]]\nname = \"tank\"\nphase = \"wall\"\ntank = { min = [0.0, 0.0], max = [0.8, 0.5], open = [\"top\"] }\n\
    [[shape]]\nname = \"water\"\nphase = \"fluid\"\npressure = \"hydrostatic\"\n\
    box = { min = [0.0, 0.0], max = [0.8, 0.25] }\n";

/// Still water in a square tank that stands on its corner.
const ON_ITS_CORNER: &str = "[[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
    tank = { min = [0.0, 0.0], max = [0.4, 0.4], open = [\"top\"] }\nrotate = { angle = 45.0, about = [0.0, 0.0] }\n\
    [[shape]]\nname = \"water\"\nphase = \"fluid\"\npressure = \"hydrostatic\"\n\
    polygon = [[0.0, 0.0], [0.2, 0.2], [-0.2, 0.2]]\n";

fn still_water(shapes: &str, dx: f64) -> Scene {
    let text = format!(
        "resolution = {dx}\nend_time = 10.0\ngravity = [0.0, -{GRAVITY}]\n[fluid]\ndensity = 1000.0\n{shapes}"
    );
    scene::parse(&text, Path::new("still.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"))
}

/// What the water has done.
struct Rest {
    /// Mass that left the domain, kg/m.
    lost: f64,
    /// Root of the mean square of the velocity over the second half of the time, over sqrt(g d).
    creep: f64,
    /// Largest distance of a particle into a wall, m.
    deepest: f64,
}

fn rest(scene: &Scene, until: f64, into_wall: impl Fn([f64; 2]) -> f64) -> Rest {
    let mut fluid = Fluid::<2>::new(scene, Isa::detect()).expect("a fluid");
    let (mut square, mut rows, mut deepest) = (0.0, 0, 0.0_f64);
    let mut frame = Frame::default();
    let (mass, count) = (fluid.audit().mass, layout::<2>(scene).fluid.len());
    go_on(&mut fluid, until, |fluid, step, t| {
        if step % 50 != 0 {
            return;
        }
        fluid.set_time(t);
        frame.clear();
        fluid.fill_frame(t, &mut frame);
        let water = fluid.audit();
        if t > 0.5 * until {
            square += 2.0 * water.kinetic_energy / water.mass;
            rows += 1;
        }
        // Water comes before walls.
        let places = frame.points.iter().take(count).map(|p| [f64::from(p[0]), f64::from(p[1])]);
        deepest = places.map(&into_wall).fold(deepest, f64::max);
    });
    let creep = (square / f64::from(rows)).sqrt() / (GRAVITY * DEPTH).sqrt();
    Rest { lost: mass - fluid.audit().mass, creep, deepest }
}

/// How far below the beach's surface a place is, m.
fn below_beach([x, y]: [f64; 2]) -> f64 {
    0.5 * (x - 0.5) - 0.75_f64.sqrt() * y
}

/// How far below the leaning beach's surface or behind the side wall a place is, m.
fn behind_leaning([x, y]: [f64; 2]) -> f64 {
    let (sin, cos) = 15.0_f64.to_radians().sin_cos();
    (sin * (x - 0.2) - cos * y).max(x - 0.8)
}

/// How far outside of the turned tank's two sides a place is, m.
fn outside_corner([x, y]: [f64; 2]) -> f64 {
    (x.abs() - y) * 0.5_f64.sqrt()
}

fn holds(rest: &Rest, dx: f64) {
    assert_eq!(rest.lost, 0.0, "kg/m left");
    assert!(rest.creep < 0.01, "creep of {} sqrt(g d)", rest.creep);
    // The first row of the wall lies dx / 2 behind its surface.
    assert!(rest.deepest < 0.5 * dx, "a particle is {} m in the wall", rest.deepest);
}

/// 2 s.
#[test]
fn a_beach_and_a_tank_on_its_corner_hold_water() {
    let dx = 0.02;
    holds(&rest(&still_water(BEACH, dx), 4.0, below_beach), dx);
    holds(&rest(&still_water(ON_ITS_CORNER, dx), 4.0, outside_corner), dx);
}

/// A beach that is turned and shifted to where it leans on a side wall: beside its tip, which was not set into the
/// floor, a particle came to rest 0.24 dx behind the surface. Seconds.
#[test]
fn a_beach_that_leans_on_a_side_wall_holds_water() {
    let dx = 0.01;
    let rest = rest(&still_water(LEANING, dx), 1.5, behind_leaning);
    println!("creep {:.2e} sqrt(g d), deepest {:.2} dx", rest.creep, rest.deepest / dx);
    holds(&rest, dx);
    assert!(rest.deepest < 0.1 * dx, "a particle is {} m in the wall", rest.deepest);
}

#[test]
#[ignore = "a minute: make validate"]
fn a_fine_beach_holds_water_for_ten_seconds() {
    let dx = 0.01;
    for (name, shapes, wall) in
        [("beach", BEACH, below_beach as fn([f64; 2]) -> f64), ("corner", ON_ITS_CORNER, outside_corner)]
    {
        let rest = rest(&still_water(shapes, dx), 10.0, wall);
        eprintln!("{name}: creep {:.2e} sqrt(g d), deepest {:.2} dx", rest.creep, rest.deepest / dx);
        holds(&rest, dx);
    }
}

/// A box of half the water's density floats half immersed, whichever way it stands.
#[test]
#[ignore = "a minute: make validate"]
fn a_box_on_its_corner_floats_as_an_upright_one_does() {
    let upright = "box = { min = [0.3, 0.2], max = [0.5, 0.4] }\n";
    let turned = format!("{upright}rotate = {{ angle = 45.0 }}\n");
    for (shape, exact) in [(upright, 0.1), (turned.as_str(), 0.1 * 2.0_f64.sqrt())] {
        let text = format!(
            "resolution = 0.01\nend_time = 3.0\n[fluid]\ndensity = 1000.0\nartificial_viscosity.linear = 0.3\n\
             [solid]\ndensity = 500.0\nyoungs_modulus = 1e6\npoissons_ratio = 0.3\n[[shape]]\nname = \"box\"\n\
             phase = \"solid\"\n{shape}[[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
             tank = {{ min = [0.0, 0.0], max = [0.8, 0.6], open = [\"top\"] }}\n[[shape]]\nname = \"water\"\n\
             phase = \"fluid\"\npressure = \"hydrostatic\"\nbox = {{ min = [0.0, 0.0], max = [0.8, 0.3] }}\n\
             [[probe]]\nname = \"box\"\nkind = \"centroid\"\nphase = \"solid\"\n\
             [[probe]]\nname = \"level\"\nkind = \"water-level\"\nx = 0.1\n"
        );
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("float.toml");
        std::fs::write(&path, text).expect("a scene");
        let run = run::scene_at(&path).run();
        let late = |name: &str| run.curve(name).between(1.5, 3.0).mean();
        // The depth of the lowest point below the water's level.
        let draught = late("level.level") - late("box.y") + exact;
        println!("draught {draught} m, exact {exact} m");
        assert!((draught / exact - 1.0).abs() < 0.02, "draught {draught} m, exact {exact} m");
    }
}

/// A block that stands on a slab, and gravity that points upward: 10 m/s² for 0.1 s is 50 mm.
#[test]
fn bodies_that_touch_part_unless_they_are_one() {
    let block = |body: &str| {
        let text = format!(
            "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, 10.0]\n[solid]\ndensity = 1000.0\n\
             youngs_modulus = 1e6\npoissons_ratio = 0.3\n[[shape]]\nname = \"slab\"\nphase = \"solid\"\n\
             box = {{ min = [0.0, 0.0], max = [0.2, 0.04] }}\nclamp = {{ min = [0.0, 0.0], max = [0.2, 0.04] }}\n\
             [[shape]]\nname = \"block\"\nphase = \"solid\"\n{body}\
             box = {{ min = [0.05, 0.04], max = [0.15, 0.1] }}\n"
        );
        let scene = scene::parse(&text, Path::new("block.toml"), &[]).expect("a right scene");
        let mut model = TotalLagrangian::<2>::new(&scene, 0, Isa::detect()).expect("a solid");
        let dt = 0.1 / (0.2 / model.sub_step_limit()).ceil();
        let none = Load::none(model.particles().len());
        for step in 0..(0.1 / dt).round() as u64 {
            for half_step in HalfStep::begin(step, step as f64 * dt).lasting(dt).both() {
                model.advance(&half_step, 1, &none).expect("within bounds");
            }
        }
        let now = model.particles();
        let of_block = || now.position.iter().zip(now.reference).filter(|(_, x0)| x0[1] > 0.04);
        of_block().map(|(x, x0)| x[1] - x0[1]).sum::<f64>() / of_block().count() as f64
    };
    let free = block("");
    assert!((free - 0.05).abs() < 1e-4, "{free}");
    let held = block("body = \"slab\"\n");
    assert!(held.abs() < 1e-3, "{held}");
}
