//! What a scene means that its author may not: every shape as it is computed, and remarks on what differs from what
//! was asked, on bodies and clamps, on water and on magnitudes. A run says them at its start, `halfstep check` as well,
//! and `run.json` keeps them.

mod beach;
mod beams;
mod bodies;
mod clamp_faces;
mod contacts;
mod corners;
mod cracks;
mod curves;
mod cuts;
mod domain;
mod dry;
mod enclosed;
mod fields;
mod frame;
mod gaps;
mod hollows;
mod idle;
mod joined;
mod joints;
mod jolts;
mod lines;
mod loaded;
mod loads;
mod lost;
mod magnitudes;
mod makers;
mod modes;
mod moving;
mod nodal;
mod outcome;
mod passages;
mod probed;
mod reached;
mod rigid;
mod settings;
mod shapes;
mod solid_keys;
mod spills;
mod tanks;
mod thickness;
mod turning;
mod unheld;
mod units;
mod wall_faces;
mod walls;
mod water;

pub(crate) use bodies::{MOST_LISTED, listed as bodies_listed};
pub(crate) use contacts::bodies_of;
pub(crate) use joined::{Joined, Massive, joined, massive};
pub(crate) use loads::{Loaded, listed as loaded};
pub use outcome::outcome;
pub(crate) use outcome::{DEEP, jerked};
pub(crate) use probed::{Probed, probed};
pub(crate) use shapes::{Placed, placed};

use halfstep_scene::geometry::{self, Layout};
use halfstep_scene::{Block, Scene, dispatch};

/// Whether two boxes have a place in common, be it a point.
fn meet(a: &Block, b: &Block, scene: &Scene) -> bool {
    (0..scene.dimension).all(|d| a.min[d] <= b.max[d] && b.min[d] <= a.max[d])
}

/// Whether two boxes have more in common than a face: half a spacing in each direction.
fn overlap(a: &Block, b: &Block, scene: &Scene) -> bool {
    let common = |k: usize| a.max[k].min(b.max[k]) - a.min[k].max(b.min[k]);
    (0..scene.dimension).all(|k| common(k) > 0.5 * scene.resolution)
}

/// Whether two places are nearer to each other than `reach`.
fn near<const D: usize>(a: &[f64; D], b: &[f64; D], reach: f64) -> bool {
    (0..D).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>() < reach * reach
}

/// The remarks on a scene, most telling first.
pub fn remarks(scene: &Scene) -> Vec<String> {
    let all = dispatch!(scene.dimension, D => {
        let layout = geometry::layout::<D>(scene);
        on(scene, &layout, &placed(scene, &layout))
    });
    all.unwrap_or_default()
}

/// The same with its particles and shapes at hand.
pub(crate) fn on<const D: usize>(scene: &Scene, layout: &Layout<D>, placed: &[Placed]) -> Vec<String> {
    let whole = scene.whole.map(|end_time| Scene { end_time, ..scene.clone() });
    let scene = whole.as_ref().unwrap_or(scene);
    let mut all = Vec::new();
    moving::clamps(scene, &mut all);
    moving::clamps_that_leave(scene, layout, &mut all);
    moving::joints(scene, &mut all);
    moving::walls(scene, &mut all);
    moving::forgotten(scene, &mut all);
    moving::apart(scene, &mut all);
    moving::probes(scene, &mut all);
    moving::displacements(scene, &mut all);
    let bodies = scene.bodies_of(layout);
    moving::gauges_at_bodies(scene, layout, &bodies, placed, &mut all);
    unheld::sunk(scene, layout, &bodies, &mut all);
    bodies::free(scene, &bodies, &mut all);
    unheld::beside_walls(scene, &bodies, &mut all);
    rigid::given(scene, layout, &mut all);
    joints::angles(scene, &mut all);
    joints::springs(scene, layout, &mut all);
    joints::locks(scene, &mut all);
    joints::starts(scene, layout, &mut all);
    joints::idle(scene, &mut all);
    joints::still(scene, &mut all);
    joints::far(scene, &mut all);
    joints::left_behind(scene, &mut all);
    bodies::held_in_part(scene, &bodies, &mut all);
    bodies::parted(scene, &bodies, &mut all);
    bodies::voids::<D>(scene, &mut all);
    bodies::idle_voids::<D>(scene, &mut all);
    hollows::hollows(scene, layout, &mut all);
    bodies::held_altogether(scene, &bodies, &mut all);
    bodies::not_repeated(scene, layout, &mut all);
    cracks::cracks(scene, layout, &mut all);
    loads::tractions(scene, layout, &mut all);
    loaded::empty(scene, layout, &mut all);
    loaded::in_clamps(scene, layout, &mut all);
    loaded::partial(scene, layout, &mut all);
    loaded::points(scene, layout, &mut all);
    loads::left_behind(scene, layout, &mut all);
    loads::ramps(scene, &mut all);
    modes::cantilevers(scene, &mut all);
    solid_keys::arms(scene, &mut all);
    solid_keys::arrangements(scene, layout, &mut all);
    solid_keys::side_friction(scene, &mut all);
    solid_keys::untouched(scene, &mut all);
    bodies::touching(scene, layout, &bodies, &mut all);
    bodies::standing(scene, layout, &bodies, &mut all);
    contacts::overlaps(scene, layout, &mut all);
    contacts::face_to_face(scene, layout, &mut all);
    contacts::unsaid(scene, &mut all);
    contacts::of_walls(scene, &bodies, &mut all);
    contacts::debris(scene, &mut all);
    contacts::soft_restitutions(scene, &mut all);
    clamp_faces::clamp_faces(scene, &mut all);
    clamp_faces::sections(scene, layout, &mut all);
    shapes::sizes(scene, placed, &mut all);
    shapes::free_lengths(scene, placed, &mut all);
    cuts::cuts(scene, placed, &mut all);
    nodal::mass(scene, placed, &mut all);
    nodal::touching(scene, layout, &bodies, &mut all);
    lost::overlaps::<D>(scene, placed, &mut all);
    lost::copies(scene, layout, &mut all);
    shapes::locking(scene, placed, &mut all);
    thickness::thin(scene, placed, &mut all);
    lines::lines(scene, layout, &mut all);
    walls::thin(scene, layout, &mut all);
    walls::across(scene, layout, &mut all);
    wall_faces::faces(scene, layout, &mut all);
    wall_faces::openings::<D>(scene, &mut all);
    corners::corners(scene, layout, &mut all);
    domain::domain(scene, layout, &mut all);
    spills::spills(scene, layout, &mut all);
    gaps::over::<D>(scene, &mut all);
    gaps::narrow(scene, layout, &mut all);
    gaps::beside(scene, layout, &mut all);
    tanks::overlapping(scene, &mut all);
    tanks::copies_outside(scene, &mut all);
    tanks::hidden(scene, &mut all);
    water::hanging(scene, layout, &mut all);
    water::outside(scene, layout, &mut all);
    water::stacked(scene, layout, &mut all);
    enclosed::enclosed(scene, layout, &mut all);
    enclosed::in_walls(scene, layout, &mut all);
    settings::background_pressure(scene, layout, &mut all);
    water::expected_speed(scene, &mut all);
    water::viscous_stress(scene, &mut all);
    water::wave_makers(scene, &mut all);
    makers::makers(scene, &mut all);
    makers::windows(scene, &mut all);
    fields::fields(scene, layout, &mut all);
    fields::steps(scene, layout, &mut all);
    fields::unpressed(scene, layout, &mut all);
    units::columns(scene, &mut all);
    magnitudes::axes(scene, &mut all);
    passages::passages(scene, &mut all);
    turning::passages(scene, layout, &mut all);
    settings::motions(scene, &mut all);
    frame::twice(scene, &mut all);
    frame::frame(scene, &mut all);
    jolts::pushed(scene, layout, &mut all);
    jolts::cut_off(scene, &mut all);
    settings::solitary_waves(scene, &mut all);
    beach::beach(scene, &mut all);
    idle::effects(scene, layout, &mut all);
    idle::sticking(scene, &mut all);
    idle::belts(scene, &mut all);
    idle::sound_speed(scene, &mut all);
    settings::checkpoints(scene, &mut all);
    settings::probes(scene, &mut all);
    dry::walled(scene, layout, &mut all);
    dry::driven::<D>(scene, &mut all);
    settings::fluxes(scene, &mut all);
    settings::thin_gauges(scene, placed, &mut all);
    settings::dry_gauges(scene, layout, &mut all);
    magnitudes::materials(scene, &mut all);
    magnitudes::gravity(scene, &mut all);
    magnitudes::viscosity(scene, &mut all);
    magnitudes::lengths(scene, &mut all);
    magnitudes::pivots(scene, &mut all);
    magnitudes::motions(scene, &mut all);
    units::degrees(scene, &mut all);
    curves::intervals(scene, &mut all);
    curves::references(scene, &mut all);
    curves::windows(scene, &mut all);
    curves::levels(scene, layout, &mut all);
    beams::bent(scene, placed, &mut all);
    magnitudes::parameters(scene, &mut all);
    all
}

#[cfg(test)]
mod angle_tests;
#[cfg(test)]
mod beam_tests;
#[cfg(test)]
mod body_tests;
#[cfg(test)]
mod contact_tests;
#[cfg(test)]
mod curve_tests;
#[cfg(test)]
mod gap_tests;
#[cfg(test)]
mod joint_tests;
#[cfg(test)]
mod load_tests;
#[cfg(test)]
mod meaning_tests;
#[cfg(test)]
mod motion_tests;
#[cfg(test)]
mod probe_tests;
#[cfg(test)]
mod silence_tests;
#[cfg(test)]
mod size_tests;
#[cfg(test)]
mod start_tests;
#[cfg(test)]
mod tank_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod trap_tests;
#[cfg(test)]
mod wall_tests;
#[cfg(test)]
mod wave_tests;
