//! A simulation as a value of a program: put together, stepped, looked into.

use crate::checkpoint::Checkpoint;
use crate::error::Error;
use crate::options::{Launcher, RunOptions, known_solid};
use crate::{course, effects, run};
use halfstep_coupling::error::RunError;
use halfstep_coupling::local::LocalRun;
use halfstep_coupling::recorder::Recorder;
use halfstep_coupling::roles;
use halfstep_coupling::supervise::StopFlags;
use halfstep_fluid::Fluid;
use halfstep_fluid::effects::FluidEffect;
use halfstep_output::{Frame, RunDirectory, RunReport};
use halfstep_role::role::Role;
use halfstep_scene::{Decision, Phase, Scene, geometry};
use halfstep_solid::{Solid, SolidModel};
use halfstep_sph::lane::Isa;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Looks at a run after each of its steps, and may end it.
type Observer<const D: usize> = Box<dyn FnMut(&Running<D>) -> ControlFlow<()>>;

/// Makes the owner of a scene's fluid; `None` without one.
type MakeFluid = Box<dyn FnOnce(&Scene, Isa) -> Option<Box<dyn Role>>>;

/// An effect on the fluid that halfstep does not have itself.
struct OwnEffect {
    name: &'static str,
    decide: fn(&Scene) -> Decision,
    /// The fluid with it. Here and not in [`Simulation`], so that only who brings an effect compiles the fluid anew.
    fluid: MakeFluid,
}

/// A simulation of a scene that has not begun, in `D` dimensions.
///
/// Everything runs in the calling thread, with a pool of worker threads of its own for the sums over neighbours; the
/// bits are those of the same scene run as processes. Nothing else of the process is touched: no signal handler, no
/// log, and no file without [`Self::folder`].
pub struct Simulation<const D: usize = 2> {
    scene: Scene,
    effect: Option<OwnEffect>,
    solids: Vec<(String, Box<dyn SolidModel<D>>)>,
    observers: Vec<Observer<D>>,
    folder: Option<PathBuf>,
    replace: bool,
    threads: Option<usize>,
    stop: Arc<AtomicBool>,
}

impl Simulation {
    /// Of a scene, as it says.
    pub fn new(scene: Scene) -> Self {
        Self {
            scene,
            effect: None,
            solids: Vec::new(),
            observers: Vec::new(),
            folder: None,
            replace: false,
            threads: None,
            stop: Arc::default(),
        }
    }

    /// Of the scene in a file, with some keys changed (`KEY=VALUE`, dotted, as after `--set`).
    ///
    /// # Errors
    /// Everything that is wrong with the scene at once, each with its place.
    pub fn load(path: impl AsRef<Path>, changes: &[&str]) -> Result<Self, Error> {
        let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        Ok(Self::new(halfstep_scene::load(path.as_ref(), &changes)?))
    }

    /// Runs the scene as processes of a launcher's program, as `halfstep run` does, to its end. Needs a folder.
    ///
    /// # Errors
    /// Nothing could be started or written, or the run failed.
    pub fn launch(self, launcher: Launcher) -> Result<RunReport, Error> {
        if !self.solids.is_empty() || !self.observers.is_empty() {
            let reason =
                "own solids and observers live in this process; the launcher's program does not know them";
            return Err(Error::Setup(reason.into()));
        }
        let folder = self.folder.ok_or_else(|| Error::Setup("processes need a folder to meet in".into()))?;
        let options = RunOptions {
            launcher: Some(launcher),
            threads: self.threads,
            force: self.replace,
            stop: StopFlags { stop: self.stop, ..StopFlags::default() },
            ..RunOptions::new(folder)
        };
        match run::run(&self.scene, &options)? {
            (_, Some(error)) => Err(error.into()),
            (report, None) => Ok(report),
        }
    }
}

impl<const D: usize> Simulation<D> {
    /// With one more effect on the fluid, whose complete law is compiled with it. It takes part where its
    /// [`FluidEffect::decide`] says so; its name is a key of `[effects]` in a scene read by
    /// [`halfstep_scene::load_with`].
    #[must_use]
    pub fn effect<E: FluidEffect<D>>(mut self, effect: E) -> Self {
        let fluid = |scene: &Scene, isa: Isa| -> Option<Box<dyn Role>> {
            Some(Box::new(Fluid::<D, E>::with_effect(scene, isa, effect)?))
        };
        self.effect = Some(OwnEffect { name: E::NAME, decide: E::decide, fluid: Box::new(fluid) });
        self
    }

    /// With a model of one's own for a solid of the scene. Its material in the scene decides what the fluid takes it
    /// for (density, stiffness); the number of its particles is its own.
    ///
    /// # Errors
    /// The scene has no solid of this name.
    pub fn solid(mut self, name: &str, model: Box<dyn SolidModel<D>>) -> Result<Self, Error> {
        known_solid(&self.scene, name).map_err(Error::Setup)?;
        if self.scene.interface.treatment == halfstep_scene::Treatment::PhaseBlind {
            let reason = "phase-blind coupling asks for the stress of one's own model in every particle: use moving-wall";
            return Err(Error::Setup(reason.into()));
        }
        self.solids.retain(|(known, _)| known != name);
        self.solids.push((name.to_owned(), model));
        Ok(self)
    }

    /// Calls `observer` after each step; `Break` ends the run in order.
    #[must_use]
    pub fn observe(mut self, observer: impl FnMut(&Running<D>) -> ControlFlow<()> + 'static) -> Self {
        self.observers.push(Box::new(observer));
        self
    }

    /// Writes what `halfstep run` writes (frames, probes, report, checkpoints, pictures) to a folder, which holds no
    /// earlier run.
    #[must_use]
    pub fn folder(mut self, folder: impl Into<PathBuf>) -> Self {
        self.folder = Some(folder.into());
        self
    }

    /// An earlier run in the folder is removed.
    #[must_use]
    pub fn replace(mut self) -> Self {
        self.replace = true;
        self
    }

    /// Worker threads; without it as many as the scene gives the fluid.
    #[must_use]
    pub fn threads(mut self, threads: usize) -> Self {
        self.threads = Some(threads.max(1));
        self
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Begins at the scene's first state.
    ///
    /// # Errors
    /// Something could not be made.
    pub fn begin(self) -> Result<Running<D>, Error> {
        let folder = self.folder.as_deref().map(|dir| RunDirectory::create(dir, self.replace)).transpose()?;
        self.begin_from(folder, None)
    }

    /// Begins at the newest checkpoint in the folder, to the same bits as if the run had never been interrupted.
    ///
    /// # Errors
    /// There is no folder, or no checkpoint of this scene in it.
    pub fn resume(self) -> Result<Running<D>, Error> {
        let dir =
            self.folder.clone().ok_or_else(|| Error::Setup("there is no folder to resume from".into()))?;
        let folder = RunDirectory::reopen(&dir)?;
        let checkpoint = Checkpoint::newest(&dir, &self.scene, Isa::detect())?;
        self.begin_from(Some(folder), Some(checkpoint))
    }

    /// Runs to the end and tells how it went.
    ///
    /// # Errors
    /// Something could not be made or written, or the run diverged.
    pub fn run(mut self) -> Result<RunReport, Error> {
        let mut observers = std::mem::take(&mut self.observers);
        let mut running = self.begin()?;
        while running.step()? {
            if observers.iter_mut().any(|observer| observer(&running).is_break()) {
                running.stop();
            }
        }
        running.finish()
    }

    fn begin_from(self, folder: Option<RunDirectory>, from: Option<Checkpoint>) -> Result<Running<D>, Error> {
        let Self { scene, effect, solids, threads, stop, .. } = self;
        if scene.dimension != D {
            return Err(Error::Setup(format!(
                "the scene has {} dimensions, the simulation {D}",
                scene.dimension
            )));
        }
        let isa = Isa::detect();
        let threads = run::threads(&scene, threads);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(|e| Error::Setup(format!("cannot start {threads} threads: {e}")))?;
        let names: Vec<String> = solids.iter().map(|(name, _)| name.clone()).collect();
        let known = effect.as_ref().map(|own| own.name);
        if let Some(stranger) = scene.own_effects.keys().find(|name| known != Some(name.as_str())) {
            return Err(Error::Setup(format!("effects.{stranger}: the simulation has no such effect")));
        }
        let own_effect = effect.as_ref().filter(|_| scene.fluid.is_some()).map(|own| (own.decide)(&scene));
        let own = owners(&scene, effect, solids, isa)?;
        let path = folder.as_ref().map(RunDirectory::path);
        let at = from.as_ref().map(|from| from.folder.as_path());
        // Before the writers of frames look at what is there.
        let course = course::begin(&scene, folder.as_ref(), from.as_ref(), Arc::clone(&stop), isa, true)?;
        let members = own.into_iter().map(|role| roles::equip(role, path, at)).collect::<Result<_, _>>()?;
        let coupler = from.as_ref().map(|from| &from.coupler);
        let run = pool.install(|| LocalRun::new(members, &scene, course, isa, coupler))?;
        Ok(Running {
            run,
            pool,
            scene,
            folder,
            own_solids: names,
            own_effect,
            stop,
            isa,
            more: true,
            failed: false,
        })
    }
}

/// Owners of the particles, in the scene's order.
fn owners<const D: usize>(
    scene: &Scene,
    mut effect: Option<OwnEffect>,
    mut solids: Vec<(String, Box<dyn SolidModel<D>>)>,
    isa: Isa,
) -> Result<Vec<Box<dyn Role>>, Error> {
    let participants = scene.participants();
    let missing = |name: &str| Error::Setup(format!("the participant {name} cannot be made"));
    let owner = |place: usize| -> Result<Box<dyn Role>, Error> {
        let participant = &participants[place];
        if let (Phase::Fluid, Some(own)) = (participant.phase, effect.take()) {
            return (own.fluid)(scene, isa).ok_or_else(|| missing(&participant.name));
        }
        match solids.iter().position(|(name, _)| *name == participant.name) {
            Some(k) => {
                let index = place - usize::from(scene.fluid.is_some());
                Ok(Box::new(Solid::with_model(scene, index, isa, solids.swap_remove(k).1)))
            }
            None => roles::build(place, scene, isa).ok_or_else(|| missing(&participant.name)),
        }
    };
    (0..participants.len()).map(owner).collect()
}

/// A run in this process.
pub struct Running<const D: usize = 2> {
    run: LocalRun<D>,
    pool: rayon::ThreadPool,
    scene: Scene,
    folder: Option<RunDirectory>,
    own_solids: Vec<String>,
    own_effect: Option<Decision>,
    stop: Arc<AtomicBool>,
    isa: Isa,
    more: bool,
    failed: bool,
}

/// What a run says that is used after its failure.
const FAILED: &str = "the run has failed before: it has no end";

impl<const D: usize> Running<D> {
    /// One step; returns whether there is another one. The end is reached with a last call that takes no step.
    ///
    /// # Errors
    /// The run diverged, or something could not be written. What was written before is whole, and the report in the
    /// folder, if there is one, tells of it.
    pub fn step(&mut self) -> Result<bool, Error> {
        if self.more {
            let Self { run, pool, .. } = self;
            self.more = match pool.install(|| run.step()) {
                Ok(more) => more,
                Err(error) => return Err(self.fail(error)),
            };
        }
        Ok(self.more)
    }

    /// What the report says of the scene and of the program's own effect.
    fn begin_report(&self) -> Result<RunReport, Error> {
        let (mut report, _) = run::begin_report(&self.scene, &geometry::layout::<D>(&self.scene), self.isa)?;
        report.effects.extend(self.own_effect.clone().map(effects::row));
        Ok(report)
    }

    /// Writes what a run leaves that has failed.
    fn fail(&mut self, error: RunError) -> Error {
        (self.more, self.failed) = (false, true);
        let report = match self.begin_report() {
            Ok(report) => report,
            Err(unknown) => return unknown,
        };
        let Self { run, scene, folder, .. } = self;
        let (_, error) = course::end(run.course_mut(), Err(error), scene, &[], folder.as_ref(), report);
        error.map_or_else(|| Error::Setup(FAILED.into()), Error::from)
    }

    /// Lets the next call of [`Self::step`] be the last: the state that it finds is written as the end of a run is.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Time of the present state, s.
    pub fn time(&self) -> f64 {
        self.run.participants().time()
    }

    /// Number of steps so far.
    pub fn steps(&self) -> u64 {
        self.run.course().clock.step()
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// All probes on the present state: names as in the columns of `probes.csv` (`tip.x [m]`), and values.
    pub fn probes(&self) -> Vec<(String, f64)> {
        let of_role = |role: &dyn Role| {
            let mut own = Vec::new();
            role.probes(&mut own);
            own
        };
        let own: Vec<Vec<f64>> = self.run.participants().roles().map(of_role).collect();
        let own: Vec<&[f64]> = own.iter().map(Vec::as_slice).collect();
        let mut values = Vec::new();
        self.run.course().recorder.arrange(&own, &mut values);
        Recorder::columns(&self.scene).into_iter().zip(values).collect()
    }

    /// A probe's component on the present state, by its column with or without unit (`tip.x`); `None`: there is none.
    pub fn probe(&self, name: &str) -> Option<f64> {
        let mut all = self.probes().into_iter();
        all.find(|(column, _)| column == name || halfstep_output::probes::split_unit(column).0 == name)
            .map(|(_, value)| value)
    }

    /// The particles of a participant (`fluid` with its walls, or a solid by its name) in the present state, in single
    /// precision as in a file; `None`: there is none.
    pub fn particles(&self, participant: &str) -> Option<Frame> {
        let role = self.run.participants().roles().find(|role| role.name().as_str() == participant)?;
        let mut frame = Frame::default();
        role.fill_frame(self.time(), &mut frame);
        Some(frame)
    }

    /// Ends the run where it is, writes what a run leaves, and tells how it went.
    ///
    /// # Errors
    /// The run diverged, or something could not be written.
    pub fn finish(mut self) -> Result<RunReport, Error> {
        if self.failed {
            return Err(Error::Setup(FAILED.into()));
        }
        if self.more {
            self.stop();
            self.step()?;
        }
        let mut report = self.begin_report()?;
        let Self { mut run, scene, folder, own_solids, .. } = self;
        let result = run.end().map(|ended| course::report_local(&scene, &[], ended, &mut report));
        for own in report.participants.iter_mut().filter(|own| own_solids.contains(&own.name)) {
            own.model = Some("own".into());
        }
        let mut course = run.into_course();
        let ended = course::end(&mut course, result, &scene, &[], folder.as_ref(), report);
        match ended {
            (report, None) => Ok(report),
            (_, Some(error)) => Err(error.into()),
        }
    }
}
