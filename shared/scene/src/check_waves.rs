//! Wave makers beside the rest of the scene.

use super::check::Check;
use super::*;

impl Check<'_> {
    /// A beach is where the fluid may be, and no step overshoots its decay.
    pub(super) fn beach(&self) {
        let Some(beach) = self.scene.fluid.as_ref().and_then(|fluid| fluid.beach) else { return };
        if self.report.has_any(&["fluid", "resolution", "dimension", "shape", "end_time"]) {
            return;
        }
        let domain = geometry::domain(self.scene);
        for (key, x) in [("fluid.beach.from", beach.from), ("fluid.beach.to", beach.to)] {
            if x < domain.min[0] || x > domain.max[0] {
                self.wrong(key, "is outside the domain: no fluid gets there");
            }
        }
        // Gravity moves a particle by its spacing in about that time.
        let g = self.scene.gravity_magnitude();
        let most = if g > 0.0 { (g / self.scene.resolution).sqrt() } else { f64::MAX };
        if beach.rate > most {
            let reason = format!(
                "must be at most sqrt(g / dx), {most:.4} 1/s: beyond, velocities decay within the time in which gravity \
                 moves a particle by its spacing, and the beach is a wall"
            );
            self.wrong("fluid.beach.rate", reason);
        }
    }

    /// A paddle goes through less than half of the water.
    pub(super) fn wave_makers(&self) {
        if self.report.has_any(&["resolution", "dimension", "shape"]) {
            return;
        }
        let Some(water) = geometry::around(geometry::fluid_boxes(self.scene)) else { return };
        let long = water.max[0] - water.min[0];
        for (index, shape) in self.scene.shapes.iter().enumerate() {
            let Some(makes) = shape.motion.as_ref().and_then(Motion::makes) else { continue };
            if makes.stroke <= 0.5 * long {
                continue;
            }
            self.place(
                &format!("{}.motion", self.shape_key(index)),
                format!(
                    "the paddle's stroke is {:.3} m, and the water {:.3} m long: at most half of it, since theory knows \
                     no tank; a lower `height` has a shorter stroke",
                    makes.stroke, long
                ),
            );
        }
    }
}
