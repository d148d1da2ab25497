//! Rigid bodies where solvers of contact and rotation lose their way.

use super::*;

/// A heavy box between two light ones, each of 0.2 x 0.1 m, on a floor: mass ratio 1000 in a stack.
#[test]
fn a_heavy_box_between_two_light_ones_stays() {
    let boxes: String = [10.0, 10_000.0, 10.0]
        .into_iter()
        .enumerate()
        .map(|(k, density)| {
            let (low, high) = (0.1 * k as f64, 0.1 * (k + 1) as f64);
            format!(
                "[[shape]]\nname = \"b{k}\"\nphase = \"solid\"\ndensity = {density}\n\
                 box = {{ min = [0.0, {low}], max = [0.2, {high}] }}\n"
            )
        })
        .collect();
    let own_step = build::<2>(&scene("contact = { friction = 0.4 }", &(boxes.clone() + FLOOR)));
    let own_step = own_step.sub_step_limit();
    assert!(own_step > 6e-3, "{own_step} s");
    for dt in [1e-3, own_step] {
        let mut model = build::<2>(&scene("contact = { friction = 0.4 }", &(boxes.clone() + FLOOR)));
        let load = free(&model);
        let mut off = 0.0_f64;
        run(&mut model, 2.0, dt, &load, |_, model| {
            for (k, state) in model.states.iter().enumerate() {
                let right = [0.1, 0.05 + 0.1 * k as f64];
                off = off.max((state.center[0] - right[0]).abs()).max((state.center[1] - right[1]).abs());
            }
        });
        println!("steps of {dt:.1e} s: at most {off:.2e} m off their places");
        // Measured: 1e-15 m; in own steps 5e-11 m: rounding makes the boxes rock, by a third more in each of these,
        // until after ten seconds they have come 6e-10 m and stand to the last bit.
        assert!(off < 1e-10, "{off:e} m");
        assert!(model.states.iter().all(|state| state.kinetic_energy < 1e-12), "{:?}", model.states);
        // The light one below carries 2 kg/m³ x 0.02 m² of its own kind and the heavy one.
        let carried = model.states[1].contact_force[1];
        assert!((carried / (200.0 * G) - 1.0).abs() < 1e-6, "{carried} N/m");
    }
}

/// On a slope, gravity turned instead: a tower of the width b and the height h tips beyond b / h, about its foot's edge
/// with phi'' = (h/2 g sin(a + phi) - b/2 g cos(a + phi)) / ((b² + h²) / 3), and so do five loose blocks of the same
/// size, since friction (0.5) holds them. Below it both stand.
#[test]
fn a_tower_tips_beyond_its_width_over_its_height() {
    let [b, h] = [0.04, 0.2];
    let one =
        "[[shape]]\nname = \"tower\"\nphase = \"solid\"\nbox = { min = [0.0, 0.0], max = [0.04, 0.2] }\n";
    let loose: String = (0..5)
        .map(|k| {
            let (low, high) = (0.04 * f64::from(k), 0.04 * f64::from(k + 1));
            format!(
                "[[shape]]\nname = \"b{k}\"\nphase = \"solid\"\nbox = {{ min = [0.0, {low}], max = [0.04, {high}] }}\n"
            )
        })
        .collect();
    for (name, boxes) in [("one", one.to_owned()), ("loose", loose)] {
        for tangent in [0.19, 0.21] {
            let angle = f64::atan(tangent);
            let mut scene = scene("contact = { friction = 0.5 }", &(boxes.clone() + FLOOR));
            scene.gravity = [G * angle.sin(), -G * angle.cos(), 0.0];
            let mut model = build::<2>(&scene);
            let load = free(&model);
            // Linear in phi: phi'' = rate + growth² phi.
            let [sin, cos] = [angle.sin(), angle.cos()].map(|part| 0.5 * G * part / ((b * b + h * h) / 3.0));
            let (rate, growth, end) = (h * sin - b * cos, (h * cos + b * sin).sqrt(), 0.2);
            run(&mut model, end, 1e-3, &load, |_, _| {});
            let (turned, right) =
                (-model.states[0].angle[2], rate / growth.powi(2) * ((growth * end).cosh() - 1.0));
            println!("{name}, {tangent}: turned by {turned:.3e} rad of {right:.3e}");
            match tangent < b / h {
                // Loose blocks settle in the first steps.
                true => assert!(turned.abs() < 3e-4, "{name}: {turned}"),
                // The formula is linear in phi.
                false => assert!((turned / right - 1.0).abs() < 2e-3, "{name}: {turned} of {right}"),
            }
        }
    }
}

/// 0.2 rad a step: far beyond what a step limit would let it take, and still exact in the plane.
#[test]
fn a_bar_that_spins_fast_turns_evenly() {
    let said = "bodies = [{ name = \"bar\", angular_velocity = 200.0 }]";
    let bar = "[[shape]]\nname = \"bar\"\nphase = \"solid\"\nbox = { min = [0.0, 0.0], max = [0.4, 0.02] }\n";
    let mut scene = scene(said, bar);
    scene.gravity = [0.0; 3];
    let mut model = build::<2>(&scene);
    let load = free(&model);
    let before = model.states[0].kinetic_energy;
    run(&mut model, 2.0, 1e-3, &load, |_, _| {});
    let state = &model.states[0];
    let energy = state.kinetic_energy / before - 1.0;
    println!("{:.2e} rad off 400 rad, energy changed by {energy:.1e}", state.angle[2] - 400.0);
    // 2000 sums, each rounded by at most half of 5.7e-14.
    assert!((state.angle[2] - 400.0).abs() < 6e-11, "{}", state.angle[2]);
    assert!(energy.abs() < 1e-13 && (state.center[0] - 0.2).abs() < 1e-12, "{state:?}");
}

/// A disc meets a box off its centre, with friction and restitution: the whole angular momentum stays, that of the
/// cells about their own middles among it.
#[test]
fn an_impact_off_the_centre_keeps_angular_momentum() {
    let disc = "[[shape]]\nname = \"disc\"\nphase = \"solid\"\ndisc = { center = [0.18, 0.2], radius = 0.05 }\n\
                velocity = [0.3, -2.0]\n";
    for contact in ["", "contact = { friction = 0.4, restitution = 0.5 }"] {
        let mut scene = scene(contact, &(BOX.to_owned() + disc));
        scene.gravity = [0.0; 3];
        let mut model = build::<2>(&scene);
        let load = free(&model);
        let momentum = |model: &Rigid<2>| -> f64 {
            let of = |(body, pose): (&super::super::body::Body, &super::super::body::Pose)| {
                pose.spin[2] + body.mass * pose.center.cross(&pose.velocity)[2]
            };
            model.system.bodies.iter().zip(&model.system.poses).take(2).map(of).sum()
        };
        let start = momentum(&model);
        run(&mut model, 0.1, 1e-3, &load, |_, _| {});
        let (turns, lost) = (model.states[0].angular_velocity[2], momentum(&model) / start - 1.0);
        println!("{contact}: the box turns with {turns:.3} rad/s, angular momentum to {lost:.1e}");
        assert!(turns < -1.0, "it was hit off its centre: {turns}");
        // Impulses act at one place on both; what overlaps after the impact is moved apart with the velocity it has.
        assert!(lost.abs() < 1e-5, "{lost:e}");
    }
}

/// What lies on an edge of a polygon is pushed across that edge: g (sin - mu cos) t² / 2 down a ramp.
#[test]
fn a_block_slides_down_a_polygon() {
    for (degrees, dt) in [(20.0_f64, 5e-4), (30.0, 5e-3), (37.0, 5e-4)] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let drop = sin / cos;
        let ramp = format!(
            "[[shape]]\nname = \"ramp\"\nphase = \"wall\"\npolygon = [[-1.0, {drop}], [-1.0, -2.0], [1.0, -2.0], \
             [1.0, -{drop}]]\n"
        );
        let block = format!("{BOX}rotate = {{ angle = -{degrees}, about = [0.0, 0.0] }}\n{ramp}");
        let friction = 0.9 * drop;
        let mut model = build::<2>(&scene(&format!("contact = {{ friction = {friction} }}"), &block));
        let load = free(&model);
        let start = model.states[0].center;
        run(&mut model, 0.5, dt, &load, |_, _| {});
        let way = [0, 1].map(|d| model.states[0].center[d] - start[d]);
        let (along, off) = (way[0] * cos - way[1] * sin, way[0] * sin + way[1] * cos);
        let right = 0.5 * 0.1 * G * sin * 0.25;
        println!("{degrees} degrees: {along:.6} m, by hand {right:.6} m, off {off:e}");
        assert!((along / right - 1.0).abs() < 1e-6 && off.abs() < 1e-9, "{along} {right} {off}");
    }
}

/// With its own steps a block that rubs on a floor which swings goes to and fro as with short ones to 7 %, where the
/// floor turns round with 16 g, and to 1 % with 0.16 g.
#[test]
fn a_swinging_floor_takes_enough_steps() {
    for (period, most) in [(0.05, 0.08), (0.5, 0.01)] {
        let floor = format!("{FLOOR}motion = {{ amplitude = [0.01, 0.0], period = {period} }}\n");
        let scene = scene("contact = { friction = 0.3 }", &format!("{BOX}{floor}"));
        let range = |dt: f64| {
            let mut model = build::<2>(&scene);
            let load = free(&model);
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            run(&mut model, 4.0 * period, dt, &load, |_, model| {
                let x = model.states[0].center[0];
                (low, high) = (low.min(x), high.max(x));
            });
            high - low
        };
        let own = build::<2>(&scene).sub_step_limit();
        let [found, right] = [own, period / 2e4].map(range);
        println!("{period} s: steps of {own:e} s, {found:.6} m, short steps {right:.6} m");
        assert!((found / right - 1.0).abs() < most, "{found} {right}");
    }
}

/// A block of 0.22 m on a wall that ends under it, with points 20 mm apart: it stands while its centre is over the
/// wall, and tips beyond.
#[test]
fn a_block_stands_to_the_edge_of_its_wall() {
    for (over, stands) in [(-8e-3, true), (-1e-3, true), (1e-3, false)] {
        let edge = 0.11 - over;
        let shapes = format!(
            "[[shape]]\nname = \"box\"\nphase = \"solid\"\nbox = {{ min = [0.0, 0.0], max = [0.22, 0.1] }}\n\
             [[shape]]\nname = \"wall\"\nphase = \"wall\"\nbox = {{ min = [-1.0, -0.5], max = [{edge}, 0.0] }}\n"
        );
        let mut scene = scene("contact = { friction = 0.5 }", &shapes);
        scene.resolution = 0.02;
        let mut model = build::<2>(&scene);
        let load = free(&model);
        run(&mut model, 0.2, 1e-3, &load, |_, _| {});
        let turned = -model.states[0].angle[2];
        println!("centre {over} m beyond the edge: turned by {turned:.2e} rad");
        // phi'' = g (over + h/2 phi) / (l² / 12 + h² / 3) about the edge, with sin phi = phi.
        let inertia = 0.22_f64.powi(2) / 12.0 + 0.1_f64.powi(2) / 3.0;
        let right = over / 0.05 * ((G * 0.05 / inertia).sqrt() * 0.2).cosh() - over / 0.05;
        let holds = if stands { turned.abs() < 1e-9 } else { (turned / right - 1.0).abs() < 0.01 };
        assert!(holds, "{over}: {turned} of {right}");
    }
}

/// A block that falls on a post between two of its points stays on its top, and one that slides against a stop stays
/// upright.
#[test]
fn posts_and_ridges_are_touched_between_points() {
    let block = |low: [f64; 2], keys: &str| {
        format!(
            "[[shape]]\nname = \"box\"\nphase = \"solid\"\nbox = {{ min = [{}, {}], max = [{}, {}] }}\n{keys}",
            low[0],
            low[1],
            low[0] + 0.2,
            low[1] + 0.1
        )
    };
    let wall =
        |name: &str, geometry: &str| format!("[[shape]]\nname = \"{name}\"\nphase = \"wall\"\n{geometry}\n");
    let post = wall("post", "box = { min = [0.104, -0.5], max = [0.116, 0.0] }");
    let disc = wall("post", "disc = { center = [0.11, -0.01], radius = 0.01 }");
    let ridge = wall("post", "polygon = [[0.08, -0.1], [0.14, -0.1], [0.11, 0.0]]");
    for (name, under) in [("post", post), ("disc", disc), ("ridge", ridge)] {
        let mut scene = scene("contact = { friction = 0.5 }", &(block([0.01, 0.02], "") + &under));
        scene.resolution = 0.04;
        let mut model = build::<2>(&scene);
        let load = free(&model);
        let start = model.states[0].center;
        run(&mut model, 0.3, 1e-3, &load, |_, _| {});
        let [x, y] = model.states[0].center;
        let off = [x - start[0], y - start[1] + 0.02];
        println!("{name}: off by {off:?}");
        assert!(off.iter().all(|off| off.abs() < 1e-6), "{name}: {off:?}");
    }
    // Its corners above and below the centre: one point of the block's face alone would let that turn.
    let stop = wall("stop", "box = { min = [0.5, 0.03], max = [0.6, 0.07] }");
    let mut scene = scene("", &(block([0.0, 0.0], "velocity = [1.0, 0.0]\n") + FLOOR + &stop));
    scene.resolution = 0.05;
    let mut model = build::<2>(&scene);
    let load = free(&model);
    run(&mut model, 0.6, 1e-3, &load, |_, _| {});
    let [x, y] = model.states[0].center;
    assert!((x - 0.4).abs() < 1e-4 && (y - 0.05).abs() < 1e-4, "{x}, {y}");
}

/// A plate that falls on three teeth of one wall between two of its own points stays on top of the middle one, which is
/// higher.
#[test]
fn the_highest_of_three_teeth_carries() {
    let plate = "[[shape]]\nname = \"plate\"\nphase = \"solid\"\nvelocity = [0.0, -2.0]\n\
                 box = { min = [-0.375, 0.003], max = [0.375, 0.253] }\n";
    let teeth = "[[shape]]\nname = \"teeth\"\nphase = \"wall\"\npolygon = [[-0.09, -0.5], [0.09, -0.5], \
                 [0.06, -5e-4], [0.03, -0.05], [0.0, 0.0], [-0.03, -0.05], [-0.06, -5e-4]]\n";
    let mut scene = scene("", &(plate.to_owned() + teeth));
    scene.resolution = 0.25;
    let mut model = build::<2>(&scene);
    let load = free(&model);
    let mut lowest = f64::INFINITY;
    run(&mut model, 0.3, 1e-3, &load, |_, model| lowest = lowest.min(model.states[0].center[1] - 0.125));
    let last = model.states[0].center[1] - 0.125;
    println!("the plate lies at {last:.2e} m, {lowest:.2e} m at least");
    assert!(lowest > -2.5e-5 && last.abs() < 2.5e-5, "{lowest} {last}");
}

/// A block slides level off its table, over a floor of two flush walls, and over a table's edge with a seam between its
/// two shapes: slowly, so that it comes within the tolerance of each corner.
#[test]
fn what_slides_level_stumbles_over_nothing() {
    let wall = |name: &str, from: f64, to: f64| {
        format!(
            "[[shape]]\nname = \"{name}\"\nphase = \"wall\"\nbox = {{ min = [{from}, -0.5], max = [{to}, 0.0] }}\n"
        )
    };
    let part = |name: &str, from: f64, to: f64| {
        format!(
            "[[shape]]\nname = \"{name}\"\nphase = \"solid\"\nbody = \"block\"\nvelocity = [1e-3, 0.0]\n\
             box = {{ min = [{from}, 0.0], max = [{to}, 0.1] }}\n"
        )
    };
    // The leading face is a tenth of a millimetre before the edge or the seam.
    let whole = part("block", 0.7999, 0.9999);
    let joined = part("left", 0.8499, 0.9999) + &part("right", 0.9999, 1.0499);
    let table = wall("table", -1.0, 1.0);
    let floor = wall("near", -1.0, 1.0) + &wall("far", 1.0, 2.0);
    for (name, shapes) in
        [("off", whole.clone() + &table), ("seam", whole + &floor), ("joined", joined + &table)]
    {
        let mut scene = scene("", &shapes);
        scene.resolution = 0.02;
        let mut model = build::<2>(&scene);
        let start = model.states[0].center[0];
        let load = free(&model);
        let mut slowest = f64::INFINITY;
        run(&mut model, 0.3, 1e-3, &load, |_, model| slowest = slowest.min(model.states[0].velocity[0]));
        let (way, turned) = (model.states[0].center[0] - start, model.states[0].angle[2]);
        println!("{name}: {way:.6e} m, {slowest:.6e} m/s at least, turned by {turned:.1e} rad");
        assert!((way - 3e-4).abs() < 1e-9 && (slowest - 1e-3).abs() < 1e-9 && turned.abs() < 1e-9, "{name}");
    }
}

/// A block without friction on a fixed body, flush with its right or left edge, in its middle with points upon points,
/// and on a block as wide as itself, pulled to either side: it slides as on a wall, by half of a t².
#[test]
fn blocks_on_bodies_slide_where_points_and_edges_coincide() {
    let part = |name: &str, low: [f64; 2], high: [f64; 2]| {
        format!(
            "[[shape]]\nname = \"{name}\"\nphase = \"solid\"\nbox = {{ min = [{}, {}], max = [{}, {}] }}\n",
            low[0], low[1], high[0], high[1]
        )
    };
    let fixed = "joints = [{ name = \"fix\", kind = \"fixed\", body = \"base\" }]\n";
    for (left, base) in [(0.3, [0.0, 0.4]), (0.0, [0.0, 0.4]), (0.15, [0.0, 0.4]), (0.0, [0.0, 0.1])] {
        for pull in [0.3, -0.3] {
            let shapes = part("base", [base[0], 0.0], [base[1], 0.04])
                + &part("top", [left, 0.04], [left + 0.1, 0.08]);
            let mut scene = scene(fixed, &shapes);
            scene.resolution = 0.01;
            scene.gravity = [pull, -G, 0.0];
            let mut model = build::<2>(&scene);
            let load = free(&model);
            let start = model.states[1].center;
            run(&mut model, 0.3, 2e-4, &load, |_, _| {});
            let state = &model.states[1];
            let (way, fallen) = (state.center[0] - start[0], state.center[1] - start[1]);
            let right = 0.5 * pull * 0.3 * 0.3;
            let name = format!("from {left} on {base:?} by {pull}");
            assert!(
                (way - right).abs() < 1e-6 && (state.velocity[0] - 0.3 * pull).abs() < 1e-6,
                "{name}: {state:?}"
            );
            assert!(fallen.abs() < 1e-6 && state.angle[2].abs() < 1e-6, "{name}: {state:?}");
        }
    }
}

/// A block without friction slides over the seam of two fixed bodies: from a tenth of a millimetre before it, slowly,
/// and in steps of which one ends on the seam.
#[test]
fn a_seam_of_two_bodies_holds_nothing() {
    let part = |name: &str, low: [f64; 2], high: [f64; 2], keys: &str| {
        format!(
            "[[shape]]\nname = \"{name}\"\nphase = \"solid\"\n{keys}\
             box = {{ min = [{}, {}], max = [{}, {}] }}\n",
            low[0], low[1], high[0], high[1]
        )
    };
    let fixed = |name: &str| format!("{{ name = \"{name}\", kind = \"fixed\", body = \"{name}\" }}");
    let joints = format!("joints = [{}, {}]\n", fixed("near"), fixed("far"));
    for (speed, before) in [(1e-3, 1e-4), (0.1, 1e-4), (0.1, 0.02), (1.0, 0.02), (1.0, 0.0)] {
        let shapes = part("near", [-1.0, -0.5], [1.0, 0.0], "")
            + &part("far", [1.0, -0.5], [2.0, 0.0], "")
            + &part(
                "block",
                [0.8 - before, 0.0],
                [1.0 - before, 0.1],
                &format!("velocity = [{speed}, 0.0]\n"),
            );
        let mut scene = scene(&joints, &shapes);
        scene.resolution = 0.02;
        let mut model = build::<2>(&scene);
        let load = free(&model);
        run(&mut model, 0.3, 1e-3, &load, |_, model| {
            let state = &model.states[2];
            let kept =
                (state.velocity[0] / speed - 1.0).abs() < 1e-7 && (state.center[1] - 0.05).abs() < 1e-9;
            assert!(kept, "{speed} m/s, {before} m before: {state:?}");
        });
    }
}

/// A pin of a wall inside of a flap that hangs from it, without a word of the joint that the two are tied; and beside.
#[test]
fn a_pin_in_a_body_does_not_touch_it() {
    for (x, corners) in [(0.0, 0), (0.1, 4)] {
        let shapes = format!(
            "[[shape]]\nname = \"flap\"\nphase = \"solid\"\nbox = {{ min = [-0.02, -0.2], max = [0.02, 0.02] }}\n\
             [[shape]]\nname = \"pin\"\nphase = \"wall\"\ncontact = true\n\
             box = {{ min = [{}, -0.005], max = [{}, 0.005] }}\n",
            x - 0.005,
            x + 0.005
        );
        let keys = "joints = [{ name = \"pin\", kind = \"hinge\", body = \"flap\", at = [0.0, 0.0] }]\n";
        let model = build::<2>(&scene(keys, &shapes));
        let walls = &model.system.bodies[model.system.real..];
        assert_eq!(walls.iter().map(|wall| wall.balls.len()).sum::<usize>(), corners);
    }
}
