//! What walls do to the density of water that leaves them, beside values by hand.

use crate::Fluid;
use halfstep_role::role::Role;
use halfstep_scene as scene;
use halfstep_sph::lane::{Isa, LANES};
use halfstep_sph::neighbours::PADDING;
use std::path::Path;

/// Least and largest density rate, kg/(m³ s), of water without pressure that fills a tank's foot and moves as a whole.
fn density_rates(velocity: [f64; 2], separation: &str) -> (f64, f64) {
    let text = format!(
        "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, 0.0]\n[fluid]\ndensity = 1000.0\nsound_speed = 20.0\n\
         [effects]\nwall-separation = \"{separation}\"\n\
         [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [0.2, 0.1] }}\n\
         velocity = [{}, {}]\n\
         [[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
         tank = {{ min = [0.0, 0.0], max = [0.4, 0.2], open = [\"top\"] }}\n",
        velocity[0], velocity[1]
    );
    let rates = rates_of(&text).into_iter();
    rates.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), rate| (low.min(rate), high.max(rate)))
}

/// The density rates of a scene's fluid at its start, kg/(m³ s).
fn rates_of(text: &str) -> Vec<f64> {
    let scene = scene::parse(text, Path::new("water.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
    let mut fluid = Fluid::<2>::new(&scene, Isa::detect()).expect("a scene with fluid");
    fluid.own_sums();
    let real = (0..fluid.columns.slots()).filter(|&s| fluid.columns.id[s] != PADDING);
    real.map(|s| fluid.sums[s / LANES].density_rate.0[s % LANES]).collect()
}

/// All water has the velocity v~ = v that walls then show continuity: no pair approaches or recedes.
#[test]
fn water_that_leaves_as_a_whole_keeps_its_density() {
    // From the floor; from the left wall; out of the corner.
    for velocity in [[0.0, 0.3], [0.3, 0.0], [0.3, 0.3]] {
        let (low, high) = density_rates(velocity, "on");
        assert!(low.abs() < 1e-9 && high.abs() < 1e-9, "{velocity:?}: {low} {high}");
        // 2 v of receding over about a spacing: -rho0 v / dx.
        let (low, _) = density_rates(velocity, "off");
        assert!(low < -0.5 * 1000.0 * 0.3 / 0.01, "{velocity:?}: {low}");
    }
}

#[test]
fn water_that_arrives_is_compressed_as_without() {
    for velocity in [[0.0, -0.3], [-0.3, 0.0], [-0.3, -0.3]] {
        let with = density_rates(velocity, "on");
        assert!(with.1 > 0.5 * 1000.0 * 0.3 / 0.01, "{velocity:?}: {with:?}");
        assert_eq!(with, density_rates(velocity, "off"), "{velocity:?}");
    }
}

/// Density rates, kg/(m³ s), of water without pressure that moves along a slope without slip as a whole, 0.3 m/s. The
/// slope's rows are not the water's.
fn rates_along_a_slope(continuity: &str) -> Vec<f64> {
    let text = format!(
        "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, 0.0]\n[fluid]\ndensity = 1000.0\nsound_speed = 20.0\n\
         [effects]\nno-slip-continuity = \"{continuity}\"\n\
         [[shape]]\nname = \"water\"\nphase = \"fluid\"\nvelocity = [0.24, 0.18]\n\
         polygon = [[0.0, 0.0], [0.16, 0.12], [0.112, 0.184], [-0.048, 0.064]]\n\
         [[shape]]\nname = \"slope\"\nphase = \"wall\"\nslip = \"none\"\n\
         polygon = [[-0.13, -0.16], [0.35, 0.2], [0.32, 0.24], [-0.16, -0.12]]\n"
    );
    rates_of(&text)
}

#[test]
fn water_along_a_wall_without_slip_keeps_its_density() {
    let largest = |rates: Vec<f64>| rates.into_iter().map(f64::abs).fold(0.0, f64::max);
    let with = largest(rates_along_a_slope("auto"));
    assert!(with < 1e-9, "{with}");
    // 0.02 rho0 v / dx.
    let without = largest(rates_along_a_slope("off"));
    assert!(without > 0.02 * 1000.0 * 0.3 / 0.01, "{without}");
}
