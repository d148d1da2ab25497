//! Remarks on effects and values that have nothing to act on, or cost much for nothing.

use super::shapes::length;
use halfstep_scene::geometry::Layout;
use halfstep_scene::{Phase, Scene, Switch, artificial_viscosity, auto_sound_speed, viscosity};

/// Sound speed over that of `"auto"` from which on its price is remarked: impacts have up to two and a half times it.
const FASTER: f64 = 3.0;

/// Effects that are switched on and take no part.
pub(super) fn effects<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let on: Vec<&str> = (scene.effects.iter().map(|(effect, switch)| (effect.name(), switch)))
        .chain(scene.own_effects.iter().map(|(name, switch)| (name.as_str(), switch)))
        .filter(|(_, switch)| **switch == Switch::On)
        .map(|(name, _)| name)
        .collect();
    // A preset switches on what only some of its scenes have.
    if on.is_empty() || scene.preset.is_some() {
        return;
    }
    let rows = crate::effects::reports(scene, &layout.counts());
    for name in on {
        let mut own = rows.iter().filter(|row| row.name == name).peekable();
        let why =
            own.peek().map_or("the scene has no phase that it acts on", |row| row.why.as_str()).to_owned();
        if own.all(|row| !row.on) {
            all.push(format!("effects.{name} is \"on\" and does nothing: {why}"));
        }
    }
}

/// Walls without slip in a fluid without viscosity.
pub(super) fn sticking(scene: &Scene, all: &mut Vec<String>) {
    let Some(fluid) = &scene.fluid else { return };
    let sticky = scene.shapes.iter().find(|shape| shape.phase == Phase::Wall && !shape.free_slip);
    let Some(wall) = sticky.filter(|_| !viscosity(scene).on) else { return };
    let drag = match artificial_viscosity(scene).on {
        false => "nothing drags the fluid there".to_owned(),
        true => {
            let worth = fluid
                .artificial_viscosity
                .kinematic(scene.smoothing_ratio * scene.resolution, fluid.sound_speed);
            format!(
                "what drags there is the artificial one, worth {} m²/s, which goes with the spacing",
                length(worth)
            )
        }
    };
    all.push(format!(
        "`{}` has slip = \"none\", and the fluid has no viscosity: {drag} (`fluid.viscosity`)",
        wall.name
    ));
}

/// Belts that nothing feels.
pub(super) fn belts(scene: &Scene, all: &mut Vec<String>) {
    let touched = |wall: &halfstep_scene::Shape| wall.contact && !scene.solids.is_empty();
    for wall in scene.shapes.iter().filter(|shape| shape.phase == Phase::Wall && shape.velocity != [0.0; 3]) {
        if wall.free_slip && !touched(wall) {
            all.push(format!(
                "the `velocity` of `{}` is that of a belt, and nothing feels it: fluid slips along it (slip = \"none\" \
                 drags it along), and no solid touches it",
                wall.name
            ));
        }
    }
}

/// A sound speed far above what the fluid's speed asks for.
pub(super) fn sound_speed(scene: &Scene, all: &mut Vec<String>) {
    let Some(fluid) = &scene.fluid else { return };
    let auto = auto_sound_speed(scene);
    let times = fluid.sound_speed / auto;
    if auto > 0.0 && times >= FASTER {
        all.push(format!(
            "fluid.sound_speed = {} m/s is {times:.1} times what \"auto\" would give, {} m/s: the run takes as many \
             times more steps, and its fluid is stiff enough for {} m/s without",
            length(fluid.sound_speed),
            length(auto),
            length(0.1 * auto)
        ));
    }
}
