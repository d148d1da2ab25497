//! A solid in a program of its own, here a rigid block on a spring along x: `joined-solid STIFFNESS` (N/m).
//!
//! `halfstep run scenes/spring-block.toml --solid 'target/release/joined-solid 20000'`

use halfstep_client::{Contact, Particles, Run};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let told = std::env::args().nth(1).and_then(|text| text.parse().ok()).filter(|&k| k > 0.0);
    let stiffness: f64 = told.ok_or("usage: joined-solid STIFFNESS")?;
    let rest = Particles::of_scene()?;
    let mass: f64 = rest.mass.iter().sum();

    // Displacement and velocity at n, and at the stage that was published. A run with a checkpoint goes on from there.
    let mut run = Run::of_environment()?;
    let mut at_n = run.saved("state").map_or((0.0, 0.0), |state| (state[0], state[1]));
    let mut now = at_n;
    run.keep("state", &[at_n.0, at_n.1])?;
    let mut first = rest.clone();
    first.position.iter_mut().for_each(|x| x[0] += now.0);
    first.velocity.fill([now.1, 0.0, 0.0]);
    // It slides along the floor on a rail, so walls are its own business.
    let mut solid = run.join(&first, Contact::Own)?;
    let mut position = first.position;
    while let Some(step) = solid.wait()? {
        let load: f64 = solid.forces().iter().map(|force| force[0]).sum();
        // The midpoint rule: both stages go from n, with the rates of the stage.
        let acceleration = (load - stiffness * now.0) / mass;
        now = (at_n.0 + step.span * now.1, at_n.1 + step.span * acceleration);
        if step.stage == 1 {
            at_n = now;
            solid.keep("state", &[at_n.0, at_n.1])?;
        }
        for (x, rest) in position.iter_mut().zip(&rest.position) {
            x[0] = rest[0] + now.0;
        }
        solid.publish(&position, &vec![[now.1, 0.0, 0.0]; rest.count()])?;
    }
    Ok(())
}
