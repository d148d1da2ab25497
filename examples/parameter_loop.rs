//! A loop over a parameter: how far the tip of a plate swings, over its stiffness.
//!
//! Any key of a scene can be changed; a scene that becomes wrong is refused with the same messages as a file.

use halfstep::{Error, Simulation};

/// Largest displacement of the shipped plate's tip within its first swing, m, for a Young's modulus, Pa.
fn largest_swing(youngs_modulus: f64) -> Result<f64, Error> {
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/oscillating-plate.toml");
    let modulus = format!("solid.youngs_modulus={youngs_modulus}");
    let mut run = Simulation::load(scene, &[&modulus, "end_time=0.05"])?.begin()?;
    let mut largest = 0.0_f64;
    while run.step()? {
        largest = largest.max(run.probe("tip.y").unwrap_or(f64::NAN).abs());
    }
    Ok(largest)
}

fn main() -> Result<(), Error> {
    println!("E [Pa]      largest |y| until 0.05 s [mm]");
    for youngs_modulus in [1e6, 2e6, 4e6, 8e6] {
        println!("{youngs_modulus:8.1e}    {:.3}", 1e3 * largest_swing(youngs_modulus)?);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stiffer_plate_swings_less() {
        let (soft, stiff) = (largest_swing(2e6).unwrap(), largest_swing(8e6).unwrap());
        assert!(stiff > 0.0 && stiff < soft, "{stiff} m, {soft} m");
    }

    #[test]
    fn a_wrong_value_is_told_with_its_key() {
        let message = format!("{}", largest_swing(-1.0).unwrap_err());
        assert!(message.contains("youngs_modulus"), "{message}");
    }
}
