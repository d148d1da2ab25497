//! A loop over a parameter: how long a plate takes to its first turning point, over its stiffness.
//!
//! Any key of a scene can be changed; a scene that becomes wrong is refused with the same messages as a file.

use halfstep::{Error, Simulation};

/// When the shipped plate's tip first turns back, s, for a Young's modulus, Pa: a quarter of its period.
fn first_turn(youngs_modulus: f64) -> Result<f64, Error> {
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/oscillating-plate.toml");
    let modulus = format!("solid.youngs_modulus={youngs_modulus}");
    let mut run = Simulation::load(scene, &[&modulus, "resolution=0.004"])?.begin()?;
    let (mut farthest, mut turn) = (0.0, 0.0);
    while run.step()? {
        let y = run.probe("tip.y").unwrap_or(f64::NAN);
        if y > farthest {
            (farthest, turn) = (y, run.time());
        } else if y < 0.5 * farthest {
            break;
        }
    }
    Ok(turn)
}

fn main() -> Result<(), Error> {
    println!("E [Pa]      first turning point [ms]");
    for youngs_modulus in [1e6, 2e6, 4e6, 8e6] {
        println!("{youngs_modulus:8.1e}    {:.2}", 1e3 * first_turn(youngs_modulus)?);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The frequency goes with the square root of the stiffness.
    #[test]
    fn four_times_the_stiffness_takes_half_of_the_time() {
        let (soft, stiff) = (first_turn(2e6).unwrap(), first_turn(8e6).unwrap());
        assert!((soft / stiff - 2.0).abs() < 0.04, "{soft} s, {stiff} s");
    }

    #[test]
    fn a_wrong_value_is_told_with_its_key() {
        let message = format!("{}", first_turn(-1.0).unwrap_err());
        assert!(message.contains("solid.youngs_modulus=-1"), "{message}");
    }
}
