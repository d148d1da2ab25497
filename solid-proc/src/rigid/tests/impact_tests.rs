//! Impacts: what bounces keeps its energy, wherever in a step surfaces meet and whatever else acts.

use super::*;

/// Steps of the program's own length to `end`, s, or while `see` says so.
fn run_own(model: &mut Rigid<2>, end: f64, mut see: impl FnMut(f64, &Rigid<2>) -> bool) {
    let load = free(model);
    let (mut time, mut step) = (0.0, 0);
    while time < end && see(time, model) {
        let dt = model.sub_step_limit().min(end - time);
        for stage in HalfStep::begin(step, time).lasting(dt).both() {
            model.advance(&stage, 1, &load).expect("within bounds");
        }
        (time, step) = (time + dt, step + 1);
    }
}

/// Largest relative change of kinetic and potential energy until `end`, s, and how often the first body turned back.
fn energy_kept(keys: &str, shapes: &str, end: f64, about: f64) -> (f64, usize) {
    let mut scene = scene(&format!("contact = {{ restitution = 1.0 }}\n{keys}"), shapes);
    scene.resolution = 0.02;
    let mut model = build::<2>(&scene);
    let energy = |model: &Rigid<2>| -> f64 {
        model
            .states
            .iter()
            .map(|state| state.kinetic_energy + state.mass * G * (state.center[1] - about))
            .sum()
    };
    let first = energy(&model);
    let (mut worst, mut turns, mut last) = (0.0_f64, 0, [0.0; 3]);
    run_own(&mut model, end, |_, model| {
        let state = &model.states[0];
        let now = [state.velocity[0], state.velocity[1], state.angular_velocity[2]];
        turns += usize::from(now.iter().zip(&last).any(|(now, last)| now * last < 0.0));
        last = now;
        worst = worst.max((energy(model) / first - 1.0).abs());
        true
    });
    (worst, turns)
}

/// A disc and a box fall on a floor without loss, in the program's own steps: ten bounces of 1 m, and of e^2 of that
/// with e = 0.8. Where in a step they land is another place each time.
#[test]
fn what_bounces_keeps_its_height() {
    let disc = "disc = { center = [0.0, 1.1], radius = 0.1 }";
    let block = "box = { min = [-0.1, 1.0], max = [0.1, 1.2] }";
    for (geometry, restitution) in [(disc, 1.0), (block, 1.0), (disc, 0.8_f64)] {
        let shapes = format!("[[shape]]\nname = \"body\"\nphase = \"solid\"\n{geometry}\n{FLOOR}");
        let mut scene = scene(&format!("contact = {{ restitution = {restitution} }}"), &shapes);
        scene.resolution = 0.02;
        let mut model = build::<2>(&scene);
        let (mut rising, mut tops, mut top) = (false, Vec::new(), 0.0_f64);
        run_own(&mut model, 60.0, |_, model| {
            let state = &model.states[0];
            let up = state.velocity[1] > 0.0;
            if rising && !up {
                tops.push(top);
            }
            top = state.center[1] - 0.1 + state.velocity[1].powi(2) / (2.0 * G);
            rising = up;
            tops.len() < 10
        });
        assert_eq!(tops.len(), 10);
        let height = |k: usize| restitution.powi(2 * (k as i32 + 1));
        let off: Vec<f64> = tops.iter().enumerate().map(|(k, top)| top - height(k)).collect();
        println!("{geometry}, {restitution}: {off:?}");
        assert!(off.iter().all(|off| off.abs() < 1e-4), "{geometry}, {restitution}: {off:?}");
    }
}

/// A ceiling, from which weight pulls away; a rail across its weight onto a floor and onto a wall; a plank on a hinge
/// whose tip falls on a floor: the reaction is another part of the weight each time.
#[test]
fn what_is_held_or_pulled_away_keeps_its_energy() {
    let body = |geometry: &str, keys: &str| {
        format!("[[shape]]\nname = \"body\"\nphase = \"solid\"\n{geometry}\n{keys}\n")
    };
    // Without the key walls do not touch what joints hold.
    let wall = |name: &str, min: [f64; 2], max: [f64; 2]| {
        format!(
            "[[shape]]\nname = \"{name}\"\nphase = \"wall\"\ncontact = true\nbox = {{ min = {min:?}, max = {max:?} }}\n"
        )
    };
    let rail = "joints = [{ name = \"rail\", kind = \"rail\", body = \"body\", at = [0.0, 0.5], axis = [1.0, -1.0] }]";
    let hinge = "joints = [{ name = \"pin\", kind = \"hinge\", body = \"body\", at = [0.0, 0.0] }]";
    let disc = |y: f64| format!("disc = {{ center = [0.0, {y}], radius = 0.1 }}");
    let floor = wall("floor", [-5.0, -1.0], [9.0, 0.0]);
    let ceiling = wall("ceiling", [-1.0, 0.8], [1.0, 1.0]);
    let cases = [
        ("ceiling", "", body(&disc(0.4), "velocity = [0.0, 4.0]") + &floor + &ceiling, 20.0, 0.1),
        ("rail to the floor", rail, body(&disc(0.5), "") + &floor, 20.0, 0.1),
        ("rail to a wall", rail, body(&disc(0.5), "") + &wall("stop", [0.4, -9.0], [0.6, 9.0]), 20.0, 0.2),
        (
            "plank",
            hinge,
            body("box = { min = [-0.02, -0.02], max = [0.98, 0.02] }", "")
                + &wall("post", [0.8, -1.0], [0.9, -0.4]),
            20.0,
            -0.4,
        ),
    ];
    for (name, keys, shapes, end, about) in cases {
        let (worst, turns) = energy_kept(keys, &shapes, end, about);
        println!("{name}: energy to {worst:.1e}, {turns} times back");
        assert!(turns > 20 && worst < 2e-3, "{name}: {worst:e} {turns}");
    }
}

/// m x'' = -c x' between two walls, without weight: the speed is v exp(-c t / m) however often it turns.
#[test]
fn a_damper_on_a_rail_gives_nothing_to_what_bounces() {
    let shapes = "[[shape]]\nname = \"body\"\nphase = \"solid\"\nvelocity = [4.0, 0.0]\n\
                  box = { min = [0.0, 0.0], max = [0.2, 0.1] }\n[[shape]]\nname = \"left\"\nphase = \"wall\"\ncontact = true\n\
                  box = { min = [-0.4, -1.0], max = [-0.1, 1.0] }\n[[shape]]\nname = \"right\"\nphase = \"wall\"\ncontact = true\n\
                  box = { min = [0.3, -1.0], max = [0.6, 1.0] }\n";
    // m = 10 kg/m.
    let keys = "contact = { restitution = 1.0 }\njoints = [{ name = \"rail\", kind = \"rail\", body = \"body\", \
                at = [0.1, 0.05], axis = [1.0, 0.0], damping = 5.0 }]";
    let mut scene = scene(keys, shapes);
    (scene.resolution, scene.gravity) = (0.02, [0.0; 3]);
    let mut model = build::<2>(&scene);
    let (mut worst, mut turns, mut last) = (0.0_f64, 0, 4.0);
    run_own(&mut model, 3.0, |time, model| {
        let velocity = model.states[0].velocity[0];
        turns += usize::from(velocity * last < 0.0);
        last = velocity;
        worst = worst.max((velocity.abs() / (4.0 * (-0.5 * time).exp()) - 1.0).abs());
        true
    });
    println!("speed to {worst:.1e}, {turns} times back");
    assert!(turns > 20 && worst < 1e-5, "{worst:e} {turns}");
}
