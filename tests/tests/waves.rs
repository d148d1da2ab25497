//! Waves that paddles make, and the beach that absorbs them.

use halfstep_tests::scene;

/// Three particles high: the height is held to a band, and the celerity to sqrt(g (d + H)), as near as levels that go
/// by whole particles tell when a crest passes: 0.03 s at each gauge, 8 % together. sqrt(g d) is 12 % less.
#[test]
fn a_solitary_wave_has_its_height_and_celerity() {
    let run = scene("solitary-wave-wall")
        .set("resolution", 0.02)
        .set("probe.gauge.x", "[1.0, 2.0, 3.0]")
        .until(3.0)
        .run();
    let gauges = ["gauge.level-1", "gauge.level-2"].map(|name| run.curve(name));
    let heights = gauges.each_ref().map(|gauge| gauge.peak().1);
    // When the crest passes: the mean time of what rises by more than a third of the wave. Peaks are flat.
    let passes = gauges.each_ref().map(|gauge| {
        let above = gauge.values.iter().map(|level| (level - 0.22).max(0.0));
        let moment: f64 = above.clone().zip(&gauge.times).map(|(rise, time)| rise * time).sum();
        moment / above.sum::<f64>()
    });
    let celerity = 1.0 / (passes[1] - passes[0]);
    let theory = (9.81 * 0.26_f64).sqrt();
    println!("celerity {celerity:.3} of {theory:.3} m/s, crests at {heights:?} of 0.26 m");
    assert!((celerity / theory - 1.0).abs() < 0.08, "{celerity}");
    for level in heights {
        assert!((level - 0.26).abs() < 0.2 * 0.06, "{level}");
    }
}

/// With the decay sigma everywhere, a standing wave's amplitude goes with exp(-sigma t / 2): half of its energy is
/// kinetic. The frequency changes by (sigma / 2 omega)² / 2, less than a thousandth.
#[test]
fn a_beach_takes_what_it_says() {
    let sigma = 0.5;
    let wave = || scene("standing-wave").set("resolution", 0.04).set("end_time", 2.4).until(2.4);
    let kinetic = |run: halfstep_tests::Finished| run.curve("water.energy").between(1.2, 2.4).mean();
    let free = kinetic(wave().run());
    // Strongest from its end on: it is as strong in the whole tank.
    let beach = wave()
        .set("fluid.beach", format!("{{ from = -0.04, to = -0.02, rate = {sigma} }}"))
        .set("probe.left", "{ name = \"left\", kind = \"energy\", phase = \"fluid\" }")
        .run();
    // What is kinetic decays by 2 sigma: the ledger has it.
    let energy = beach.curve("water.energy");
    let lengths = energy.times.windows(2).map(|t| t[1] - t[0]);
    let means = energy.values.windows(2).map(|e| 0.5 * (e[0] + e[1]));
    let taken: f64 = lengths.zip(means).map(|(dt, mean)| 2.0 * sigma * dt * mean).sum();
    let ledger = beach.curve("left.beach").at(2.4);
    println!("the beach took {taken:.4} J/m, in the ledger {ledger:.4} J/m");
    assert!((ledger / taken + 1.0).abs() < 0.01, "{ledger} {taken}");
    let damped = kinetic(beach);
    // The mean of exp(-sigma t) over the window, in which the wave goes once round.
    let decay = |t: f64| (-sigma * t).exp();
    let expected = (decay(1.2) - decay(2.4)) / (sigma * 1.2);
    println!("kinetic energy {:.4} of {expected:.4}", damped / free);
    assert!((damped / free / expected - 1.0).abs() < 0.03, "{damped} {free} {expected}");
}
