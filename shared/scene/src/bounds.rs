//! Within which bounds a simulation makes sense: what lies outside is an instability, not physics.
//!
//! Flow speed U: the largest of all initial velocities, free fall through the domain, and a tenth of the fluid's sound
//! speed.
//!
//! | phase | density | speed |
//! |---|---|---|
//! | fluid | rho0 to 30 %: Tait's pressure is then 0.75 rho0 c0² | the larger of c0 and 3 U |
//! | solid | rho0 to 50 %: far beyond a law that is linear in the density | c_P / 4 + 3 U |
//!
//! A solid model may have bounds of its own instead of those of the density.
//!
//! Particles of the shipped scenes stay within 14 % and 0.19 c0 (fluid), 21 % and 0.11 c_P (solid).

use crate::geometry;
use crate::{Block, JointKind, RigidBody, Scene};
use halfstep_sph::quantity::Quantity;

/// Bounds of a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Reference density rho0, kg/m³.
    pub density: f64,
    /// Largest |rho / rho0 - 1|.
    pub density_change: f64,
    /// Largest speed, m/s.
    pub speed: f64,
}

/// A quantity that is out of bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excess {
    /// Which.
    pub quantity: Quantity,
    /// Value of the quantity.
    pub value: f64,
    /// Deviation over the allowed one; infinite where the value is NaN.
    pub ratio: f64,
}

impl Bounds {
    /// Of a scene's fluid.
    pub fn of_fluid(scene: &Scene) -> Option<Self> {
        let fluid = scene.fluid.as_ref()?;
        let speed = fluid.sound_speed.max(3.0 * flow_speed(scene));
        Some(Self { density: fluid.density, density_change: 0.3, speed })
    }

    /// Of the scene's solid of that index.
    pub fn of_solid(scene: &Scene, solid: usize) -> Option<Self> {
        let solid = scene.solids.get(solid)?;
        let speed = 0.25 * solid.pressure_wave_speed() + 3.0 * flow_speed(scene);
        Some(Self { density: solid.density, density_change: 0.5, speed })
    }

    /// What is out of bounds, if anything: of two quantities the one that is farther out.
    pub fn excess(&self, density: f64, speed: f64) -> Option<Excess> {
        let of_density = worst_if_nan((density / self.density - 1.0).abs() / self.density_change);
        let of_speed = worst_if_nan(speed / self.speed);
        let (quantity, value, ratio) = if of_density >= of_speed {
            (Quantity::Density, density, of_density)
        } else {
            (Quantity::Speed, speed, of_speed)
        };
        (ratio > 1.0).then_some(Excess { quantity, value, ratio })
    }
}

fn worst_if_nan(x: f64) -> f64 {
    if x.is_nan() { f64::INFINITY } else { x }
}

/// Rigid bodies that turn at the start: index of the solid, what it says of the body, the box around its shapes, and
/// the hinges about one of which it turns, else about its middle.
pub(crate) fn turning(scene: &Scene) -> impl Iterator<Item = (usize, &RigidBody, Block, Vec<[f64; 3]>)> {
    let rigid = scene.solids.iter().enumerate().filter_map(|(k, solid)| Some((k, solid.rigid()?)));
    rigid.flat_map(move |(solid, keys)| {
        let turns = keys.bodies.iter().filter(|body| body.angular_velocity != [0.0; 3]);
        turns.filter_map(move |body| {
            let own = scene.shapes.iter().filter(|s| s.solid == Some(solid) && s.body() == body.name);
            let around = geometry::around(own.map(|s| geometry::bounding_box(s, scene)))?;
            let hinges = keys.joints.iter().filter_map(|joint| match joint.kind {
                JointKind::Hinge { at, .. } if joint.body == body.name => Some(at),
                _ => None,
            });
            Some((solid, body, around, hinges.collect()))
        })
    })
}

/// U: the speed that a scene's flow is expected to reach, m/s, see above.
pub fn flow_speed(scene: &Scene) -> f64 {
    let length = |v: &[f64; 3]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
    let domain = geometry::domain(scene);
    let fall: f64 = (0..3).map(|a| scene.gravity[a].abs() * (domain.max[a] - domain.min[a])).sum();
    let sound = scene.fluid.as_ref().map_or(0.0, |f| 0.1 * f.sound_speed);
    let moving =
        |s: &crate::Shape| s.motion.as_ref().map_or(0.0, |m| m.fastest(&geometry::bounding_box(s, scene)));
    let swings = scene.shapes.iter().filter_map(|shape| {
        let (mode, solid) = (shape.cantilever_mode?, scene.solids.get(shape.solid?)?);
        Some(solid.sound_speed() * mode.fraction.abs())
    });
    let spins = turning(scene).map(|(_, body, around, hinges)| {
        let hinges = hinges.into_iter().map(|at| Block { min: at, max: at });
        let around = geometry::around(std::iter::once(around).chain(hinges));
        let across = around.map_or([0.0; 3], |b| std::array::from_fn(|d| b.max[d] - b.min[d]));
        length(&body.angular_velocity) * length(&across)
    });
    let swing = swings.chain(spins).fold(0.0, f64::max);
    // What stays behind a frame that moves is that fast in it.
    let swing = swing + scene.frame.as_ref().map_or(0.0, |frame| frame.motion.fastest(&domain));
    scene
        .shapes
        .iter()
        .map(|s| length(&s.velocity) + moving(s) + swing)
        .fold((2.0 * fall).sqrt().max(sound), f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: Bounds = Bounds { density: 1000.0, density_change: 0.3, speed: 20.0 };

    #[test]
    fn the_quantity_farthest_out_is_named() {
        assert_eq!(BOUNDS.excess(1000.0, 0.0), None);
        assert_eq!(BOUNDS.excess(1299.0, 19.9), None);
        let excess = BOUNDS.excess(600.0, 22.0).unwrap();
        assert_eq!((excess.quantity, excess.value), (Quantity::Density, 600.0));
        assert!((excess.ratio - 4.0 / 3.0).abs() < 1e-12);
        assert_eq!(BOUNDS.excess(1400.0, 40.0).unwrap().quantity, Quantity::Speed);
    }

    #[test]
    fn nan_is_out_of_bounds() {
        let excess = BOUNDS.excess(f64::NAN, 1.0).unwrap();
        assert_eq!((excess.quantity, excess.ratio), (Quantity::Density, f64::INFINITY));
        assert_eq!(BOUNDS.excess(1000.0, f64::NAN).unwrap().quantity, Quantity::Speed);
        assert!(BOUNDS.excess(f64::INFINITY, 1.0).is_some());
    }

    #[test]
    fn bounds_follow_stiffness_and_flow() {
        let path = std::path::Path::new("scenes/ring.toml");
        let scene = |modulus: f64| {
            let text = format!(
                "resolution = 0.001\nend_time = 1.0\ngravity = [0.0, 0.0]\n[solid]\ndensity = 1000.0\n\
                 youngs_modulus = {modulus}\npoissons_ratio = 0.0\n[[shape]]\nname = \"ring\"\nphase = \"solid\"\n\
                 disc = {{ center = [0.0, 0.0], radius = 0.01 }}\nvelocity = [3.0, 4.0]\n"
            );
            crate::parse(&text, path, &[]).unwrap()
        };
        // nu = 0: c_P = sqrt(E / rho); U = 5 m/s.
        let stiff = Bounds::of_solid(&scene(1.6e7), 0).unwrap();
        assert!((stiff.speed - (0.25 * 126.491_106 + 15.0)).abs() < 1e-5, "{stiff:?}");
        let soft = Bounds::of_solid(&scene(1e3), 0).unwrap();
        assert!((soft.speed - 15.25).abs() < 1e-9, "as fast as it started it may go: {soft:?}");
        assert_eq!(Bounds::of_fluid(&scene(1e3)), None);
    }
}
