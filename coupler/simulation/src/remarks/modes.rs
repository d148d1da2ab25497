//! Remarks on the bending mode that a cantilever begins with.

use super::beams;
use super::shapes::length;
use halfstep_scene::Scene;

/// Part of the free length by which root and length of the mode may differ from it: the clamp's face may lie some rows
/// beside.
const ABOUT: f64 = 0.05;

/// Modes of another length than the free part of their plate, or with another root.
pub(super) fn cantilevers(scene: &Scene, all: &mut Vec<String>) {
    for shape in &scene.shapes {
        let Some(mode) = shape.cantilever_mode else { continue };
        let Some([root, tip]) = beams::free_along_x(scene, shape) else { continue };
        let free = tip - root;
        let off = (mode.root - root).abs().max((mode.length - free).abs());
        if off > ABOUT * free.abs() + scene.spacing(shape) {
            let remedy = match free > 0.0 {
                true => format!("root = {}, length = {} fit it", length(root), length(free)),
                false => "a mode has its root at the left, and the clamp is at the right".to_owned(),
            };
            all.push(format!(
                "the cantilever_mode of `{}` goes from x = {} to {} m, and the plate is free from {} to {} m: it \
                 begins with other modes as well ({remedy})",
                shape.name,
                length(mode.root),
                length(mode.root + mode.length),
                length(root),
                length(tip)
            ));
        }
    }
}
