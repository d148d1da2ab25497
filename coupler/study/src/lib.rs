//! `halfstep study`: what accuracy costs. Runs a scene over a ladder of settings, measures errors and costs, and picks
//! settings for a wanted error or budget.

mod adapted;
pub mod candidate;
mod chart;
pub mod choose;
pub mod command;
pub mod compare;
pub mod compare_command;
pub mod convergence;
pub mod error;
pub mod fit;
pub mod ladder;
pub mod measure;
mod named;
pub mod pareto;
pub mod pictures;
pub mod program;
pub mod reference;
pub mod report;
pub mod result;
pub mod runs;
pub mod sweep;
pub mod target;

use choose::Surprise;
use error::StudyError;
use halfstep_coupling::say;
use halfstep_coupling::supervise::StopFlags;
use halfstep_output::RunReport;
use halfstep_output::run_json::RunStatus;
use halfstep_scene::{Metric, Scene};
use ladder::{Setting, Vary};
use program::Program;
use report::Study;
use result::{Against, MetricResult, Row};
use runs::Job;
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

/// What to study.
#[derive(Clone, Debug)]
pub struct Options {
    /// The scene's file.
    pub scene: PathBuf,
    /// Overrides of every run.
    pub base: Vec<String>,
    /// The ladder; empty: the default one.
    pub vary: Vec<Vary>,
    /// Commands of external solids, `[NAME=]COMMAND`, of every run.
    pub solids: Vec<String>,
    /// All combinations instead of one change at a time.
    pub full: bool,
    /// Runs of each setting.
    pub repeat: u32,
    /// Runs at a time.
    pub jobs: usize,
    /// Folder; `None`: `out/study-SCENE`.
    pub out: Option<PathBuf>,
    /// What errors are against.
    pub against: Option<Against>,
    /// No progress.
    pub quiet: bool,
}

/// A study under way.
pub struct Session<'s> {
    options: &'s Options,
    program: Program,
    stop: &'s StopFlags,
    folder: PathBuf,
    scene: Scene,
    metrics: Vec<Metric>,
    left_out: Vec<String>,
    repeated: Vec<[String; 2]>,
    rows: Vec<Row>,
    /// Held as long as the session lives: two studies in one folder would remove each other's runs.
    _claim: File,
}

impl<'s> Session<'s> {
    /// Loads the scene and makes the folder.
    ///
    /// # Errors
    /// The scene is not valid, or has no metric that its run is long enough for.
    pub fn new(options: &'s Options, stop: &'s StopFlags) -> Result<Self, StudyError> {
        let scene = Setting::load(&options.scene, &options.base, &[])?.scene;
        let (metrics, left_out): (Vec<Metric>, Vec<Metric>) =
            scene.metrics.iter().cloned().partition(|m| m.needs() <= scene.end_time);
        if metrics.is_empty() {
            let reason = if left_out.is_empty() { "has no [[metric]]" } else { "ends before its metrics" };
            return Err(StudyError::Usage(format!("{} {reason}: nothing to compare", scene.name)));
        }
        let folder =
            options.out.clone().unwrap_or_else(|| PathBuf::from("out").join(format!("study-{}", scene.name)));
        std::fs::create_dir_all(&folder).map_err(StudyError::system(folder.display()))?;
        let claim = claim(&folder)?;
        let left_out = left_out.into_iter().map(|m| m.name).collect();
        let (program, unknown) = Program::own()?.with_solids(&options.solids);
        if let (Some(why), true) = (unknown.first(), folder.join("runs").is_dir()) {
            say::warn(format_args!("warning: runs that are there are not used again: {why}"));
        }
        Ok(Self {
            options,
            program,
            stop,
            folder,
            scene,
            metrics,
            left_out,
            repeated: Vec::new(),
            rows: Vec::new(),
            _claim: claim,
        })
    }

    /// Where everything goes.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Runs the ladder; false where somebody stopped it.
    ///
    /// # Errors
    /// A setting is no valid scene, or a run cannot be started.
    pub fn ladder(&mut self) -> Result<bool, StudyError> {
        let Options { scene, base, vary, full, .. } = self.options;
        let default = || ladder::default_ladder(scene, base).map(|vary| vec![vary]);
        let vary = if vary.is_empty() { default()? } else { vary.clone() };
        let settings = ladder::settings(scene, base, &vary, *full)?;
        self.repeated = settings.repeated;
        self.run(&settings.runs, false)
    }

    /// Runs settings that have not been run, and adds their rows.
    ///
    /// # Errors
    /// A run cannot be started.
    pub fn run(&mut self, settings: &[Setting], chosen: bool) -> Result<bool, StudyError> {
        let jobs: Vec<(&Setting, Job)> = settings
            .iter()
            .flat_map(|s| (1..=self.options.repeat).map(move |r| (s, r)))
            .map(|(s, repeat)| (s, Job::new(&self.folder, s, repeat, &self.options.solids)))
            .collect();
        let open = |(s, job): &&(&Setting, Job)| runs::reusable(&job.dir, s, &self.program).is_none();
        let to_run: Vec<Job> = jobs.iter().filter(open).map(|(_, job)| job.clone()).collect();
        let Options { jobs: at_a_time, quiet, .. } = *self.options;
        if to_run.len() < jobs.len() && !quiet {
            say::warn(format_args!("{} of {} runs are there already", jobs.len() - to_run.len(), jobs.len()));
        }
        if !runs::execute(&to_run, at_a_time, quiet, &self.program, self.stop)? {
            return Ok(false);
        }
        for setting in settings {
            let of_setting = jobs.iter().filter(|(s, _)| std::ptr::eq(*s, setting));
            let reports = of_setting.map(|(_, job)| (job.dir.clone(), report_of(job))).collect();
            self.rows.push(Row::new(setting, &self.metrics, reports, chosen));
        }
        Ok(true)
    }

    /// How wrong the coarser rows were about the finest, each with the limits that were known then.
    fn surprise(&self, study: &Study, metric: usize) -> Option<Surprise> {
        let finest = study.rows.iter().map(|r| r.resolution).fold(f64::INFINITY, f64::min);
        let before: Vec<Row> =
            study.rows.iter().filter(|r| r.resolution > finest * (1.0 + 1e-9)).cloned().collect();
        let against = Some(study.metrics[metric].against);
        let seen = MetricResult::new(&self.scene, &self.metrics, metric, &before, against);
        Surprise::new(&study.rows, &study.metrics[metric], &before, &seen)
    }

    /// The rows so far, compared.
    pub fn study(&self) -> Study {
        let of_metric =
            |k| MetricResult::new(&self.scene, &self.metrics, k, &self.rows, self.options.against);
        Study {
            scene: self.scene.name.clone(),
            end_time: self.scene.end_time,
            program: self.program.clone(),
            jobs: self.options.jobs,
            rows: self.rows.clone(),
            metrics: (0..self.metrics.len()).map(of_metric).collect(),
            left_out: self.left_out.clone(),
            repeated: self.repeated.clone(),
        }
    }
}

/// Takes the folder for one study; the system gives it back when that ends.
fn claim(folder: &Path) -> Result<File, StudyError> {
    let path = folder.join("study.lock");
    let file = File::create(&path).map_err(StudyError::system(path.display()))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => {
            Err(StudyError::Usage(format!("another study is under way in {}", folder.display())))
        }
        Err(TryLockError::Error(e)) => Err(StudyError::system(path.display())(e)),
    }
}

/// The report of a run that has ended, whatever it left.
fn report_of(job: &Job) -> RunReport {
    RunReport::read(&job.dir.join("run.json")).unwrap_or_else(|_| {
        let said = std::fs::read_to_string(job.dir.join(runs::MESSAGES)).unwrap_or_default();
        RunReport {
            status: Some(RunStatus::Failed),
            error: Some(format!("left no report: {}", said.trim())),
            ..RunReport::default()
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_holds_one_study_at_a_time() {
        let dir = tempfile::tempdir().unwrap();
        let first = claim(dir.path()).unwrap();
        let refused = claim(dir.path()).unwrap_err().to_string();
        assert!(refused.starts_with("another study is under way in "), "{refused}");
        drop(first);
        assert!(claim(dir.path()).is_ok());
    }
}
