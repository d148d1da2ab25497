//! What a scene asks for, before anything is run.

mod limits;

use crate::forecast::{self, Forecast, megabytes};
use crate::remarks::{Joined, Loaded, Massive, Placed, Probed};
use crate::step_cost::step_cost;
use crate::{effects, remarks};
use halfstep_coupling::roles;
use halfstep_output::run_json::EffectReport;
use halfstep_role::role::Role;
use halfstep_scene::geometry::{self, Counts};
use halfstep_scene::{self as scene, Phase, Scene, TimeStep, dispatch};
use halfstep_solid::SubStepping;
use halfstep_sph::lane::Isa;
use serde::Serialize;
use std::fmt::{self, Display};
use std::path::Path;

/// s.
const DAY: f64 = 86_400.0;

/// Counts, time steps, memory and an estimate of the run time of a scene; `Display` is the text of `halfstep check`.
#[derive(Clone, Debug, Serialize)]
pub struct Check {
    /// Name of the scene.
    pub scene: String,
    /// Its file.
    pub path: String,
    /// Spacing of fluid and walls, m.
    resolution: f64,
    /// h / dx of the water's kernel.
    smoothing_ratio: f64,
    /// What the water's defaults are chosen for.
    water_meets: &'static str,
    particles: Particles,
    shapes: Vec<Placed>,
    bodies: Vec<Body>,
    rigid_bodies: Vec<Massive>,
    joints: Vec<Joined>,
    loads: Vec<Loaded>,
    probes: Vec<Probed>,
    /// Between rows of the probes, s.
    probe_interval: f64,
    solids: Vec<Solid>,
    /// How fast sound and, at most, fluid are expected to be.
    speeds: Option<Speeds>,
    /// Largest stable step of the fluid, s.
    fluid_dt_limit: Option<f64>,
    /// Largest stable step of contact between solids, and with walls in the coupler, s; `None` where there is none.
    contact_dt_limit: Option<f64>,
    /// First time step, s.
    pub time_step: f64,
    /// Steps to the end with it.
    pub steps: u64,
    end_time: f64,
    memory_bytes: u64,
    /// 0: nothing is exchanged.
    shared_memory_bytes: u64,
    disk_bytes: u64,
    /// Where the command is given; `None`: the system does not say.
    disk_free_bytes: Option<u64>,
    frames: u64,
    /// Sums of a few half-steps of each participant, timed on one thread, times the steps, s: a run whose particles
    /// spread out takes longer. `None`: the first steps leave their bounds.
    pub expected_seconds: Option<f64>,
    instruction_set: &'static str,
    effects: Vec<EffectReport>,
    /// Where the scene means something else than its author may think.
    pub warnings: Vec<String>,
    /// Pairs of solids, and whether they touch.
    #[serde(skip)]
    pairs: Option<String>,
    #[serde(skip)]
    bodies_listed: Option<String>,
}

/// m/s.
#[derive(Clone, Debug, Serialize)]
struct Speeds {
    sound: f64,
    fastest: f64,
}

#[derive(Clone, Debug, Serialize)]
struct Particles {
    fluid: u64,
    solid: u64,
    wall: u64,
}

#[derive(Clone, Debug, Serialize)]
struct Body {
    shapes: Vec<String>,
    particles: usize,
    clamped: usize,
}

/// A solid of the scene.
#[derive(Clone, Debug, Serialize)]
struct Solid {
    name: String,
    particles: u64,
    /// m.
    spacing: f64,
    /// Largest stable step of the whole, with its most sub-steps, s.
    dt_limit: f64,
    #[serde(skip)]
    stable_to: f64,
    /// With a fluid alone.
    sub_steps: Option<SubSteps>,
}

#[derive(Clone, Debug, Serialize)]
struct SubSteps {
    count: u32,
    /// Largest stable one, s.
    stable_to: f64,
}

impl Check {
    /// Largest stable sub-step of the solid of that index in its first state, s.
    pub fn stable_step(&self, solid: usize) -> Option<f64> {
        self.solids.get(solid).map(|solid| solid.stable_to)
    }
}

/// Checks a valid scene, with the instruction set that the estimate of time is made with; `None`: of a dimension that
/// is not available.
pub fn check(scene: &Scene, isa: Isa) -> Option<Check> {
    dispatch!(scene.dimension, D => check_in::<D>(scene, isa))
}

fn check_in<const D: usize>(scene: &Scene, isa: Isa) -> Check {
    let layout = geometry::layout::<D>(scene);
    let counts @ Counts { fluid, solid, wall } = layout.counts();
    let shapes = remarks::placed(scene, &layout);
    let bodies = scene.bodies_of(&layout);
    let mut built: Vec<_> =
        (0..scene.participants().len()).filter_map(|place| roles::build(place, scene, isa)).collect();
    let contact = roles::contact_asks(scene, &mut built);
    let of_contact = contact.limit.map(|limit| ("contact".to_owned(), limit));
    let limits: Vec<(String, f64)> =
        built.iter().map(|role| (role.name().to_string(), role.dt_limit())).chain(of_contact).collect();
    let limit = limits.iter().map(|(_, limit)| *limit).fold(f64::INFINITY, f64::min);
    let time_step = match scene.time_step {
        TimeStep::Auto => limit,
        TimeStep::Fixed(dt) => dt,
    };
    let of_solids = built.iter().filter(|role| role.phase() == Phase::Solid).map(|role| role.dt_limit());
    let solids = of_solids.zip(layout.solid_counts(scene)).enumerate().map(|(k, (dt_limit, particles))| {
        let stepping = SubStepping::of(scene, k);
        let stable_to = dt_limit / f64::from(stepping.most());
        let sub_steps = SubSteps { count: stepping.choose(time_step, stable_to), stable_to };
        Solid {
            name: scene.solids[k].name.clone(),
            particles,
            spacing: scene.solid_spacing(k),
            dt_limit,
            stable_to,
            sub_steps: scene.fluid.as_ref().map(|_| sub_steps),
        }
    });
    let solids = solids.collect();
    let Forecast { shared, disk, frames } = Forecast::of(scene, &layout, &[]);
    let fluid_role = built.iter().find(|role| role.phase() == Phase::Fluid);
    let fluid_dt_limit = fluid_role.map(|role| role.dt_limit());
    let mut warnings = remarks::on(scene, &layout, &shapes);
    warnings.extend(limits::too_long(scene, &limits));
    warnings.extend(limits::too_soft(scene, &contact));
    for role in &built {
        warnings.extend(remarks::jerked(&role.name().to_string(), &role.jerked_joints()));
    }
    let steps = (scene.end_time / time_step).ceil() as u64;
    let expected_seconds = expected_seconds(built, time_step, scene.end_time);
    warnings.extend(limits::takes_days(scene, expected_seconds, steps, &limits));
    warnings.extend(limits::too_many_frames(scene, frames, disk));
    Check {
        scene: scene.name.clone(),
        path: scene.path.display().to_string(),
        resolution: scene.resolution,
        smoothing_ratio: scene.smoothing_ratio,
        water_meets: scene.water_meets(),
        particles: Particles { fluid, solid, wall },
        bodies_listed: (solid > 0).then(|| remarks::bodies_listed(scene, &bodies)),
        bodies: bodies.iter().map(|body| named(scene, body)).collect(),
        rigid_bodies: remarks::massive(scene, &layout),
        joints: remarks::joined(scene),
        loads: remarks::loaded(scene, &layout),
        probes: remarks::probed(scene, &layout),
        probe_interval: scene.output.probe_interval,
        solids,
        speeds: scene
            .fluid
            .as_ref()
            .map(|fluid| Speeds { sound: fluid.sound_speed, fastest: scene::expected_speed_of_fluid(scene) }),
        fluid_dt_limit,
        contact_dt_limit: contact.limit,
        pairs: pairs(scene),
        time_step,
        steps,
        end_time: scene.end_time,
        memory_bytes: scene::memory_needed(&counts),
        shared_memory_bytes: shared,
        disk_bytes: disk,
        disk_free_bytes: forecast::free_disk(Path::new(".")),
        frames,
        expected_seconds,
        instruction_set: isa.bits_name(),
        effects: effects::reports(scene, &counts),
        warnings,
        shapes,
    }
}

fn named(scene: &Scene, body: &scene::Body) -> Body {
    let shapes = body.shapes.iter().map(|&shape| scene.shapes[shape].name.clone()).collect();
    Body { shapes, particles: body.particles, clamped: body.clamped }
}

/// Which solids touch, and which pass through each other; `None` where there are not two.
fn pairs(scene: &Scene) -> Option<String> {
    let touching = scene.contacts();
    let names = |[a, b]: [usize; 2]| format!("{} and {}", scene.solids[a].name, scene.solids[b].name);
    let count = scene.solids.len();
    let all = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
    let (touch, pass): (Vec<_>, Vec<_>) =
        all.partition(|pair| touching.iter().any(|contact| contact.solids == *pair));
    let say = |list: Vec<[usize; 2]>, what: &str| {
        let named: Vec<String> = list.into_iter().map(names).collect();
        (!named.is_empty()).then(|| format!("{} {what}", named.join(", ")))
    };
    let both = [say(touch, "touch"), say(pass, "pass through each other where they meet")];
    let text: Vec<String> = both.into_iter().flatten().collect();
    (!text.is_empty()).then(|| text.join("; "))
}

fn expected_seconds(roles: Vec<Box<dyn Role>>, dt: f64, end: f64) -> Option<f64> {
    let costs: Option<Vec<f64>> = roles.into_iter().map(|role| step_cost(role, dt)).collect();
    costs.map(|costs| costs.into_iter().fold(0.0, f64::max) * end / dt)
}

/// A time in the unit in which it is a number of at most a few hundreds, s.
fn duration(seconds: f64) -> String {
    let hour = 3600.0;
    match seconds {
        s if s < 10.0 => format!("{s:.1} s"),
        s if s < 600.0 => format!("{s:.0} s"),
        s if s < 2.0 * hour => format!("{:.0} min", s / 60.0),
        s if s < 10.0 * DAY => format!("{:.0} h", s / hour),
        s => format!("{:.0} days", s / DAY),
    }
}

impl Display for Check {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut line = |name: &str, value: &dyn Display| writeln!(f, "{name:<15} {value}");
        let Particles { fluid, solid, wall } = self.particles;
        line("scene", &format_args!("{} ({})", self.scene, self.path))?;
        line("particles", &format_args!("{fluid} fluid, {solid} solid, {wall} wall"))?;
        for shape in &self.shapes {
            line(&format!("  {}", shape.name), shape)?;
        }
        self.bodies_listed.iter().try_for_each(|bodies| line("bodies", bodies))?;
        for body in self.rigid_bodies.iter().take(remarks::MOST_LISTED) {
            line(&format!("  {}", body.body), body)?;
        }
        if !self.joints.is_empty() {
            line("joints", &self.joints.len())?;
        }
        self.joints.iter().try_for_each(|joint| line(&format!("  {}", joint.name), joint))?;
        if !self.loads.is_empty() {
            line("loads", &self.loads.len())?;
        }
        self.loads.iter().try_for_each(|load| line(&format!("  {}", load.shape), load))?;
        if !self.probes.is_empty() {
            line("probes", &format_args!("{}, a row each {} s", self.probes.len(), self.probe_interval))?;
        }
        self.probes.iter().try_for_each(|probe| line(&format!("  {}", probe.name), probe))?;
        for solid in &self.solids {
            if solid.spacing != self.resolution {
                let [own, other] = [solid.spacing, self.resolution];
                let text = format_args!("{own:.4e} m, of the fluid and walls {other:.4e} m");
                line(&format!("{} spacing", solid.name), &text)?;
            }
        }
        if self.fluid_dt_limit.is_some() {
            let Self { smoothing_ratio, water_meets, .. } = self;
            line("water's kernel", &format_args!("h / dx = {smoothing_ratio}"))?;
            line("water's defaults", &format_args!("for water that meets {water_meets}"))?;
        }
        if let Some(Speeds { sound, fastest }) = self.speeds {
            let mach = fastest / sound;
            let text =
                format_args!("{sound:.3} m/s; the fluid is expected below {fastest:.3} m/s, Mach {mach:.2}");
            line("sound", &text)?;
        }
        let limits = self.fluid_dt_limit.map(|limit| ("fluid", limit)).into_iter();
        for (name, limit) in limits.chain(self.solids.iter().map(|solid| (&*solid.name, solid.dt_limit))) {
            line(&format!("{name} dt limit"), &format_args!("{limit:.3e} s"))?;
        }
        if let Some(limit) = self.contact_dt_limit {
            line("contact limit", &format_args!("{limit:.3e} s"))?;
        }
        let steps = format_args!("{:.3e} s: {} steps to t = {} s", self.time_step, self.steps, self.end_time);
        line("time step", &steps)?;
        for Solid { name, sub_steps, .. } in &self.solids {
            if let Some(SubSteps { count, stable_to }) = sub_steps {
                let text = format_args!("{count} (one is stable to {stable_to:.3e} s)");
                line(&format!("{name} sub-steps"), &text)?;
            }
        }
        if let Some(pairs) = &self.pairs {
            line("between solids", pairs)?;
            for solid in &self.solids {
                line(&solid.name, &format_args!("{} particles", solid.particles))?;
            }
        }
        line("memory", &format_args!("about {:.1} MB", self.memory_bytes as f64 / 1e6))?;
        if self.shared_memory_bytes > 0 {
            line("shared memory", &megabytes(self.shared_memory_bytes))?;
        }
        let free = self.disk_free_bytes.map(|free| format!(", {} are free here", megabytes(free)));
        let (disk, free) = (megabytes(self.disk_bytes), free.unwrap_or_default());
        line("disk", &format_args!("about {disk}, {} frames{free}", self.frames))?;
        let isa = self.instruction_set;
        match self.expected_seconds {
            Some(seconds) => {
                let (time, steps) = (duration(seconds), self.steps);
                line(
                    "expected time",
                    &format_args!("about {time} for {steps} steps, one thread a role ({isa})"),
                )?;
            }
            None => line("expected time", &"unknown: the first steps leave their bounds")?,
        }
        writeln!(f)?;
        for EffectReport { name, on, why, .. } in &self.effects {
            writeln!(f, "{name:<28}{:<5}{why}", if *on { "on" } else { "off" })?;
        }
        for (k, warning) in self.warnings.iter().enumerate() {
            writeln!(f, "{}warning: {warning}", if k == 0 { "\n" } else { "" })?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
