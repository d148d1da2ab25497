//! A document's keys as a scene: names, kinds and ranges of single values. What concerns several is in `check`.

use super::document::{Node, Value};
use super::error::{Report, listed, nearest};
use super::preset::Defaults;
use super::read_motion::Around;
use super::section::{Range, Section};
use super::support::Company;
use super::*;
use super::{read_contact, read_metric, read_motion, read_probe, read_shape, read_solid};
use std::path::Path;

/// What a scene's file holds, before the sound speed `auto` is resolved.
pub(super) struct Draft {
    pub(super) scene: Scene,
    /// The fluid's sound speed is to be found.
    pub(super) sound_speed_auto: bool,
    /// The fluid's A is the default, of which its own viscosity is to be taken off.
    pub(super) linear_auto: bool,
    /// Whether each shape says its `contact`.
    pub(super) contact_said: Vec<bool>,
}

pub(crate) const SMOOTHING: Range = Range::at_least(1.0)
    .up_to(2.5)
    .why("below, neighbours are too few; above, they are too many to resolve anything at this spacing");
// Ends beyond any material, within which no formula overflows.
pub(crate) const DENSITY: Range = Range::at_least(1e-6).up_to(1e9);
/// Most worker threads of a process.
pub(crate) const MAX_THREADS: u32 = 1024;
pub(crate) const COEFFICIENT: Range = Range::at_least(0.0).up_to(100.0);
pub(crate) const REACH: Range = Range::at_least(0.5)
    .up_to(5.0)
    .why("below, particles pass each other before f_i is whole; no kernel reaches farther than 5 spacings");

pub(crate) const PRESETS: [(&str, Preset); 2] = [("kayaki", Preset::Kayaki), ("waves", Preset::Waves)];
pub(crate) const DIFFUSIONS: [(&str, DensityDiffusion); 4] = [
    ("delta-sph", DensityDiffusion::DeltaSph),
    ("simple", DensityDiffusion::Simple),
    ("hydrostatic", DensityDiffusion::Hydrostatic),
    ("none", DensityDiffusion::None),
];
pub(crate) const INTEGRATIONS: [(&str, FluidIntegration); 2] =
    [("midpoint", FluidIntegration::Midpoint), ("verlet", FluidIntegration::Verlet)];
pub(crate) const TREATMENTS: [(&str, Treatment); 2] =
    [("moving-wall", Treatment::MovingWall), ("phase-blind", Treatment::PhaseBlind)];
pub(crate) const KERNELS: [(&str, KernelName); 2] =
    [("cubic-spline", KernelName::CubicSpline), ("wendland-c2", KernelName::WendlandC2)];
pub(crate) const PRECISIONS: [(&str, Precision); 2] =
    [("double", Precision::Double), ("mixed", Precision::Mixed)];
pub(crate) const LATTICES: [(&str, Lattice); 2] = [("centred", Lattice::Centred), ("nodal", Lattice::Nodal)];
pub(crate) const SWITCHES: [(&str, Switch); 3] =
    [("auto", Switch::Auto), ("on", Switch::On), ("off", Switch::Off)];

pub(super) fn scene(root: &Node, path: &Path, report: &Report, own_effects: &[&str]) -> Draft {
    let top = Section::root(root, report);
    let preset = top.node("preset").and_then(|n| top.as_choice("preset", n, &PRESETS));
    let dimension = dimension(&top);
    let defaults = Defaults::of(preset, dimension);
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let end_time = top.number("end_time", None);
    let mut numerics = numerics(top.section("numerics"), dimension, &defaults);
    let interface_section = top.section("interface");
    let treatment = interface_section
        .choice("treatment", Some(defaults.treatment), &TREATMENTS)
        .unwrap_or(defaults.treatment);
    let solids = read_solid::solids(&top, defaults.with_treatment(treatment), &numerics);
    let short = solids.len() > 1 || solids.iter().any(|solid| solid.rigid().is_none());
    let usual =
        defaults.integration.unwrap_or(FluidIntegration::usual(short || treatment == Treatment::PhaseBlind));
    let integration =
        top.section("fluid").choice("time_integration", Some(usual), &INTEGRATIONS).unwrap_or(usual);
    if top.section("numerics").node("cfl").is_none() {
        numerics.cfl = integration.courant_number(short);
    }
    let names: Vec<&str> = solids.iter().map(|s| s.name.as_str()).collect();
    let tables = top.tables("shape");
    let folder = path.parent().unwrap_or(Path::new(""));
    let gravity = top.vector("gravity", dimension, Some([0.0, -9.81, 0.0]));
    let around = Around { dimension, folder, gravity, end_time };
    let (mut shapes, mut voids, mut contact_said) = (Vec::new(), Vec::new(), Vec::new());
    for table in tables {
        if read_shape::is_void(&table) {
            voids.push(read_shape::void(table, dimension, shapes.len(), folder));
            continue;
        }
        contact_said.push(table.node("contact").is_some());
        shapes.push(read_shape::shape(table, &around, &names, numerics.lattice));
    }
    let company = Company::of(&shapes, &solids, treatment);
    let smoothing_ratio = top.number("smoothing_ratio", Some(defaults.smoothing_ratio(company)));
    let defaults = defaults.suited(smoothing_ratio, company, treatment);
    let interface = interface(interface_section, treatment, &defaults);
    let linear_auto = defaults.own_viscosity_counts && {
        let table = top.section("fluid").section("artificial_viscosity");
        table.node("linear").is_none()
    };
    let (fluid, sound_speed_auto) = match top.section("fluid") {
        section if section.is_present() => {
            let (fluid, auto) = fluid(section, &defaults, integration);
            (Some(fluid), auto)
        }
        _ => (None, false),
    };
    let probe = |p| read_probe::probe(p, dimension, &names, &shapes);
    let probes = top.tables("probe").into_iter().filter_map(probe).collect();
    let contact = |table| read_contact::contact(table, &names);
    let pair_contacts = top.tables("contact").into_iter().filter_map(contact).collect();
    let (effects, own_effects) = effects(&top, &defaults, own_effects);
    let mut scene = Scene {
        name: stem,
        // A path that is no Unicode could not be written to JSON.
        path: path.to_string_lossy().into_owned().into(),
        preset,
        dimension,
        resolution: top.number("resolution", None),
        smoothing_ratio,
        end_time,
        whole: None,
        time_step: match top.number_or_auto("time_step", fixed(defaults.time_step)) {
            Some(dt) => TimeStep::Fixed(dt),
            None => TimeStep::Auto,
        },
        gravity,
        frame: frame(top.section("frame"), &around),
        fluid,
        solids,
        interface,
        pair_contacts,
        output: output(top.section("output"), end_time),
        shapes,
        voids,
        probes,
        references: top
            .tables("reference")
            .into_iter()
            .filter_map(|r| read_probe::reference(r, folder))
            .collect(),
        metrics: top.tables("metric").into_iter().filter_map(read_metric::metric).collect(),
        effects,
        own_effects,
        numerics,
        doubtful: Doubtful::default(),
    };
    scene.share_spacings();
    // Its values stand where formulas were.
    top.node("parameters");
    top.finish();
    Draft { scene, sound_speed_auto, linear_auto, contact_said }
}

/// `[frame]`.
fn frame(section: Section<'_>, around: &Around<'_>) -> Option<Frame> {
    if !section.is_present() {
        return None;
    }
    if section.node("motion").is_none() {
        section.missing("motion");
    }
    let motion = read_motion::motion(&section, around);
    section.finish();
    Some(Frame { motion: motion? })
}

fn fixed(step: TimeStep) -> Option<f64> {
    match step {
        TimeStep::Auto => None,
        TimeStep::Fixed(dt) => Some(dt),
    }
}

/// The dimension that vectors are read with: a wrong one is noted here, and not again at every vector.
fn dimension(top: &Section<'_>) -> usize {
    match top.node("dimension") {
        None => 2,
        Some(node) => match node.value {
            Value::Integer(2) => 2,
            Value::Integer(3) => {
                top.wrong("dimension", node, "must be 2: three dimensions are not available yet");
                2
            }
            _ => {
                top.wrong("dimension", node, "must be 2, the number of space dimensions");
                2
            }
        },
    }
}

fn fluid(section: Section<'_>, defaults: &Defaults, time_integration: FluidIntegration) -> (Fluid, bool) {
    let sound_speed = section.number_or_auto("sound_speed", None);
    let fluid = Fluid {
        density: section.number("density", None),
        viscosity: section.number("viscosity", Some(0.0)),
        sound_speed: sound_speed.unwrap_or(f64::NAN),
        artificial_viscosity: viscosity(&section, defaults.fluid_viscosity),
        density_diffusion: section
            .choice("density_diffusion", Some(defaults.density_diffusion), &DIFFUSIONS)
            .unwrap_or(defaults.density_diffusion),
        density_diffusion_coefficient: section
            .number("density_diffusion_coefficient", Some(defaults.density_diffusion_coefficient)),
        background_pressure: section.number("background_pressure", Some(0.0)),
        time_integration,
        beach: beach(section.section("beach")),
    };
    // Read before, with the Courant number.
    section.node("time_integration");
    section.finish();
    (fluid, sound_speed.is_none())
}

/// Where waves are absorbed.
fn beach(section: Section<'_>) -> Option<Beach> {
    if !section.is_present() {
        return None;
    }
    let beach = Beach {
        from: section.number("from", None),
        to: section.number("to", None),
        rate: section.number("rate", Some(10.0)),
    };
    if let (true, Some(node)) = (beach.from == beach.to, section.node("to")) {
        section.wrong("to", node, "must be another place than `from`: waves run from there to it");
    }
    section.finish();
    Some(beach)
}

pub(super) fn viscosity(section: &Section<'_>, default: ArtificialViscosity) -> ArtificialViscosity {
    let table = section.section("artificial_viscosity");
    let viscosity = ArtificialViscosity {
        linear: table.number("linear", Some(default.linear)),
        quadratic: table.number("quadratic", Some(default.quadratic)),
    };
    table.finish();
    viscosity
}

fn interface(section: Section<'_>, treatment: Treatment, defaults: &Defaults) -> Interface {
    let near = section.number("cross_viscosity", Some(defaults.cross_viscosity));
    let range = Range::at_least(0.0).up_to(if near.is_finite() { near } else { f64::MAX });
    let range = range
        .why("f_i keeps particles apart: it acts between near ones at least as much as between far ones");
    let far = defaults.cross_viscosity_far * near;
    let interface = Interface {
        treatment,
        cross_viscosity: near,
        cross_viscosity_far: section.number_within("cross_viscosity_far", Some(far), range),
        cross_viscosity_reach: section.number("cross_viscosity_reach", Some(defaults.cross_viscosity_reach)),
    };
    section.finish();
    interface
}

fn output(section: Section<'_>, end_time: f64) -> Output {
    let output = Output {
        frame_interval: section.number("frame_interval", Some(end_time / 50.0)),
        probe_interval: section.number("probe_interval", Some(end_time / 2000.0)),
        checkpoint_interval: section.number("checkpoint_interval", Some(0.0)),
    };
    section.finish();
    output
}

/// The switches of the effects of the list, and of those that only the calling program has.
fn effects(
    top: &Section<'_>,
    defaults: &Defaults,
    own: &[&str],
) -> (BTreeMap<EffectName, Switch>, BTreeMap<String, Switch>) {
    let mut effects: BTreeMap<_, _> = defaults.effects.iter().copied().collect();
    let mut own_effects = BTreeMap::new();
    let section = top.section("effects");
    let Some(table) = top.node("effects").and_then(Node::table) else { return (effects, own_effects) };
    for (key, entry) in table {
        if own.contains(&key.as_str()) {
            let switch = section.as_choice(key, &entry.node, &SWITCHES);
            own_effects.extend(switch.map(|switch| (key.clone(), switch)));
            continue;
        }
        match EffectName::ALL.iter().find(|effect| effect.name() == key) {
            Some(effect) => {
                if let Some(switch) = section.as_choice(key, &entry.node, &SWITCHES) {
                    effects.insert(*effect, switch);
                }
            }
            None => {
                let known = || EffectName::ALL.iter().map(|effect| effect.name()).chain(own.iter().copied());
                let note = top.report.place(&section.path_of(key), entry.key, "unknown effect");
                match nearest(key, known()) {
                    Some(near) => note.help(format!("did you mean `{near}`?")),
                    None => note.help(format!("the effects are {}", listed(known(), "and"))),
                }
            }
        }
    }
    (effects, own_effects)
}

fn numerics(section: Section<'_>, dimension: usize, defaults: &Defaults) -> Numerics {
    let threads = section.section("threads");
    let numerics = Numerics {
        kernel: section.choice("kernel", Some(defaults.kernel), &KERNELS).unwrap_or(defaults.kernel),
        precision: section.choice("precision", Some(Precision::Double), &PRECISIONS).unwrap_or_default(),
        cfl: section.number("cfl", Some(FluidIntegration::Midpoint.courant_number(true))),
        solid_cfl: section.number("solid_cfl", Some(0.6)),
        max_sub_steps: section.integer("max_sub_steps", 200),
        interface_capacity: section.optional_integer("interface_capacity"),
        threads: Threads {
            fluid: threads.integer("fluid", 2) as usize,
            solid: threads.integer("solid", 1) as usize,
        },
        lattice: section.choice("lattice", Some(defaults.lattice), &LATTICES).unwrap_or(defaults.lattice),
        domain: match section.section("domain") {
            domain if domain.is_present() => Some(domain.whole_block(dimension)),
            _ => None,
        },
    };
    threads.finish();
    section.finish();
    numerics
}
