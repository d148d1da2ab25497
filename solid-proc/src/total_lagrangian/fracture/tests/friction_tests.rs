//! Friction between fragments, and between them and walls.

use super::Run;
use crate::model::{Load, SolidModel};
use crate::probes::Measured;
use halfstep_scene::EnergyPart;
use halfstep_wire::half_step::HalfStep;
use halfstep_wire::state::State;

/// A soft solid that takes 0.1 MPa to break: what rubs stays whole.
fn tough(gravity: [f64; 2], friction: f64) -> String {
    format!(
        "resolution = 0.005\nend_time = 1.0\ngravity = {gravity:?}\n[solid]\ndensity = 1000.0\nyoungs_modulus = 1e6\n\
         poissons_ratio = 0.3\nfracture = {{ strength = 1e5, energy = 90.0, friction = {friction} }}\n"
    )
}

fn block(name: &str, at: [f64; 2], size: [f64; 2], velocity: [f64; 2]) -> String {
    format!(
        "[[shape]]\nname = \"{name}\"\nphase = \"solid\"\nbox = {{ min = {at:?}, max = [{}, {}] }}\n\
         velocity = {velocity:?}\n",
        at[0] + size[0],
        at[1] + size[1]
    )
}

const FLOOR: &str = "[[shape]]\nname = \"floor\"\nphase = \"wall\"\nbox = { min = [-0.1, -0.02], max = [1.0, 0.0] }\n\
                     contact = true\n";

/// Mean place and velocity of the first particles of a run, as many as asked for.
fn mean(run: &Run<2>, count: usize) -> [[f64; 2]; 2] {
    let p = run.model.particles();
    [p.position, p.velocity].map(|column| {
        std::array::from_fn(|d| column[..count].iter().map(|x| x[d]).sum::<f64>() / count as f64)
    })
}

/// Two fragments of 100 mm x 50 mm that meet on their long sides at 0.5 m/s, sliding with 2 m/s.
fn fragments(friction: f64) -> Run<2> {
    let text = tough([0.0, 0.0], friction)
        + &block("upper", [0.0, 0.051], [0.1, 0.05], [2.0, -0.5])
        + &block("lower", [0.0, 0.0], [0.1, 0.05], [0.0, 0.0]);
    Run::of(&text)
}

/// Steps on, and gives what friction took, J.
fn rub_on(run: &mut Run<2>, until: f64) -> f64 {
    let mut taken = 0.0;
    while run.time < until {
        let mut see =
            |part, joules: f64| taken -= if part == EnergyPart::FragmentFriction { joules } else { 0.0 };
        run.step_and_see(&mut see).expect("within bounds");
    }
    taken
}

/// While fragments slide, what their surfaces do along themselves is mu times what they do across, to half a per cent;
/// without friction they do nothing along themselves.
#[test]
fn an_impact_of_fragments_that_slide_takes_mu_times_its_impulse() {
    let ratio = |friction: f64| {
        let mut run = fragments(friction);
        let taken = rub_on(&mut run, 0.02);
        let [_, v] = mean(&run, 200);
        println!(
            "mu {friction}: {taken} J/m taken, rest {:e} of {} J/m, momentum {:?}",
            run.rest(),
            run.start,
            run.momentum()
        );
        assert!(v[1] > -0.15 && v[0] > 1.7, "they have met, and slide: {v:?}");
        let p = run.momentum();
        assert!((p[0] - 10.0).abs() < 1e-13 && (p[1] + 2.5).abs() < 1e-13, "{p:?}");
        // 1.0e-4 measured.
        assert!(run.rest().abs() < 2e-4 * run.start, "{} of {}", run.rest(), run.start);
        let takes = [(0.0, 0.0), (0.05, 0.209), (0.1, 0.405), (0.2, 0.763), (0.4, 1.347)];
        let takes = takes.iter().find(|(of, _)| *of == friction).expect("a case").1;
        assert!((taken - takes).abs() < 0.003, "{friction}: {taken}");
        (2.0 - v[0]) / (v[1] + 0.5)
    };
    let without = ratio(0.0);
    // -0.0022 measured.
    assert!(without.abs() < 3e-3, "{without}");
    for friction in [0.05, 0.1, 0.2, 0.4] {
        let of = (ratio(friction) - without) / friction;
        println!("{friction}: {of}");
        // 0.995 to 0.999 measured.
        assert!((0.994..1.001).contains(&of), "{friction}: {of}");
    }
}

/// A block that begins to slide on a floor at 1 m/s.
fn slid(friction: f64, until: f64) -> (Run<2>, f64) {
    let text = tough([0.0, -9.81], friction) + FLOOR + &block("block", [0.0, 0.0], [0.1, 0.05], [1.0, 0.0]);
    let mut run = Run::<2>::of(&text);
    let taken = rub_on(&mut run, until);
    (run, taken)
}

/// After v² / (2 mu g), 85 and 170 mm. With mu = 0.6 it chatters, and goes 3 % farther.
#[test]
fn a_block_that_slides_on_a_floor_stops() {
    for (friction, until, goes, takes) in [(0.6, 0.3, 1.028, 2.409), (0.3, 0.6, 1.002, 2.470)] {
        let (run, taken) = slid(friction, until);
        let [x, v] = mean(&run, 200);
        let way = (x[0] - 0.05) / (1.0 / (2.0 * friction * 9.81));
        // What lies still takes nothing: 5 kg/m are 24.5 mm above the floor in the end.
        let rest = run.rest() + 5.0 * 9.81 * (x[1] - 0.025);
        println!("mu {friction}: way {way}, v {v:?}, taken {taken}, rest {rest}");
        assert!((way - goes).abs() < 0.005 && v[0].abs() < 0.01, "{friction}: {way} {v:?}");
        // Of the 2.5 J/m that it begins with.
        assert!((taken - takes).abs() < 0.01 && rest.abs() < 2e-3, "{friction}: {taken} {rest}");
    }
}

/// What probes have of contact, with its friction: mu of what the floor carries, and as much back from the other
/// fragment.
#[test]
fn forces_of_contact_have_their_friction() {
    let (mut run, _) = slid(0.3, 0.05);
    let mut sum = [0.0; 2];
    for k in 1..=50 {
        rub_on(&mut run, 0.05 + 0.001 * f64::from(k));
        let load = Load::none(0);
        let probed = Measured { model: &run.model, load: &load, ledger: None, contact: &[] };
        let forces = probed.contact_forces();
        forces.iter().for_each(|force| (0..2).for_each(|d| sum[d] += force[d] / 50.0));
    }
    // 5 kg/m.
    assert!(
        (sum[1] / (5.0 * 9.81) - 1.0).abs() < 0.02 && (sum[0] / (-0.3 * sum[1]) - 1.0).abs() < 0.01,
        "{sum:?}"
    );
    let mut run = fragments(0.2);
    let mut rubbed = 0.0_f64;
    for k in 1..=40 {
        rub_on(&mut run, 5e-5 * f64::from(k));
        let mut forces = [[0.0; 2]; 2];
        run.model.contact_forces(&mut |p, force| {
            (0..2).for_each(|d| forces[usize::from(p >= 200)][d] += force[d]);
        });
        let [upper, lower] = forces;
        assert!((0..2).all(|d| (upper[d] + lower[d]).abs() < 1e-9 * upper[1].abs().max(1.0)), "{forces:?}");
        rubbed = rubbed.max(-upper[0] / upper[1].max(1.0));
    }
    assert!((rubbed - 0.2).abs() < 0.01, "{rubbed}");
}

/// A floor is a surface: contact pair by pair with its particles would brake by 0.75 m/s².
#[test]
fn nothing_but_friction_brakes_a_block_on_a_floor() {
    let (run, taken) = slid(0.0, 0.3);
    let [_, v] = mean(&run, 200);
    let brakes = (1.0 - v[0]) / 0.3;
    println!("{brakes} m/s²");
    assert!(taken == 0.0 && brakes.abs() < 1e-12, "{brakes} {taken}");
}

/// A slab of weak concrete that slides on a floor at 1 m/s under its weight alone. Where pairs of particles push it
/// climbs from row to row, strikes, and 156 of its 160 particles are single after 0.1 s.
#[test]
fn a_brittle_slab_slides_in_one_piece() {
    let text = "resolution = 0.005\nend_time = 1.0\ngravity = [0.0, -9.81]\n[solid]\ndensity = 2400.0\n\
                youngs_modulus = 1.5e9\npoissons_ratio = 0.2\nfracture = { strength = 1.2e5, energy = 0.25 }\n";
    let mut run =
        Run::<2>::of(&(text.to_owned() + FLOOR + &block("slab", [0.0, 0.0], [0.1, 0.04], [1.0, 0.0])));
    run.until(0.02);
    let summary = run.model.summary();
    assert!(summary.bodies == 1 && summary.energy == 0.0, "{summary:?}");
    let [x, v] = mean(&run, 160);
    assert!((x[0] - 0.07).abs() < 1e-6 && (v[0] - 1.0).abs() < 1e-5, "{x:?} {v:?}");
}

/// On a slope below mu it stays where it is, but for the way that it leans.
#[test]
fn a_block_on_a_slope_below_the_angle_of_friction_stays() {
    let (sine, cosine) = (0.31_f64.atan().sin(), 0.31_f64.atan().cos());
    let gravity = [9.81 * sine, -9.81 * cosine];
    let way = |friction: f64| {
        let text = tough(gravity, friction) + FLOOR + &block("block", [0.0, 0.0], [0.1, 0.05], [0.0, 0.0]);
        let mut run = Run::<2>::of(&text);
        run.until(0.25);
        mean(&run, 200)[0][0] - 0.05
    };
    let (held, free) = (way(0.6), way(0.0));
    println!("{held} {free}");
    assert!(held < 2e-4 && free > 0.02, "{held} {free}");
}

#[test]
fn a_run_goes_on_from_a_checkpoint_while_fragments_rub() {
    let text = |friction| {
        tough([0.0, -9.81], friction)
            + FLOOR
            + &block("upper", [0.0, 0.05], [0.1, 0.05], [2.0, -0.5])
            + &block("lower", [0.0, 0.0], [0.1, 0.05], [0.0, 0.0])
    };
    let mut run = Run::<2>::of(&text(0.3));
    run.until(0.01);
    let mut again = Run::<2>::of(&text(0.3));
    again.model.load(&run.model.save()).expect("its own state");
    (again.time, again.steps) = (run.time, run.steps);
    // A first stage that is taken back leaves nothing.
    let [first, _] = HalfStep::begin(again.steps, again.time).lasting(run.model.sub_step_limit()).both();
    again.model.advance(&first, 1, &again.none).expect("within bounds");
    again.model.load(&run.model.save()).expect("its own state");
    for _ in 0..200 {
        run.step();
        again.step();
    }
    assert!(run.bits() == again.bits());
    let mut smooth = Run::<2>::of(&text(0.0));
    smooth.until(run.time);
    assert!((mean(&run, 200)[1][0] - mean(&smooth, 200)[1][0]).abs() > 1e-2, "they rub");
}

/// A clamped ram meets a block at 0.5 m/s: what its clamp gives is what the block gets, by the springs between bodies
/// and by friction. Of the energy that the ledger does not explain less than a thousandth is left.
#[test]
fn what_a_clamp_gives_through_contact_is_booked() {
    let ram = block("ram", [0.0, 0.0], [0.05, 0.05], [0.0, 0.0])
        + "clamp = { min = [0.0, 0.0], max = [0.05, 0.05] }\n\
           motion = { velocity = [0.5, 0.2], start = 0.0, end = 1.0 }\n";
    let mut run = Run::<2>::of(
        &(tough([0.0, 0.0], 0.3) + &ram + &block("block", [0.052, 0.01], [0.1, 0.05], [0.0; 2])),
    );
    run.until(0.05);
    let held = run.model.strain_energy() + run.model.particles().kinetic_energy();
    assert!(held - run.start > 0.5, "the block flies: {held}");
    assert!(run.rest().abs() < 1e-3 * (held - run.start), "{} of {}", run.rest(), held - run.start);
}

/// A clamp holds all of the block against a wall that moves into it: that does no work.
#[test]
fn a_wall_that_moves_against_a_clamp_gives_nothing() {
    let text = tough([0.0, 0.0], 0.0)
        + &block("block", [0.0, 0.0], [0.1, 0.05], [0.0; 2])
        + "clamp = { min = [0.0, 0.0], max = [0.1, 0.05] }\n\
           [[shape]]\nname = \"ram\"\nphase = \"wall\"\nbox = { min = [0.0, -0.02], max = [0.1, 0.0] }\n\
           contact = true\nmotion = { velocity = [0.0, 0.1], start = 0.0, end = 1.0 }\n";
    let mut run = Run::<2>::of(&text);
    for _ in 0..200 {
        let mut see = |part, joules| assert_eq!(joules, 0.0, "{part:?}");
        run.step_and_see(&mut see).expect("within bounds");
    }
}
