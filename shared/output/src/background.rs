//! A thread that writes what the computation hands it, and the error that it ends with.

use super::OutputError;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

/// Jobs on their way to a thread of their own. Dropping it waits for them; an error is only logged then.
#[derive(Debug)]
pub(crate) struct Background<T> {
    folder: PathBuf,
    stem: String,
    /// `None` once finished.
    jobs: Option<SyncSender<T>>,
    thread: Option<JoinHandle<Result<(), OutputError>>>,
}

impl<T: Send + 'static> Background<T> {
    /// Starts a thread for what `stem` writes to a folder. So many jobs may wait; `kind` is part of the thread's name.
    pub(crate) fn start(
        folder: &Path,
        stem: &str,
        kind: &str,
        waiting: usize,
        work: impl FnOnce(Receiver<T>) -> Result<(), OutputError> + Send + 'static,
    ) -> Result<Self, OutputError> {
        let (jobs, to_do) = sync_channel(waiting);
        let thread = std::thread::Builder::new()
            .name(format!("{stem} {kind}"))
            .spawn(move || work(to_do))
            .map_err(OutputError::io("start a thread for", folder))?;
        Ok(Self { folder: folder.into(), stem: stem.into(), jobs: Some(jobs), thread: Some(thread) })
    }
}

impl<T> Background<T> {
    /// Hands a job over; waits while too many are under way. Fails with what went wrong with an earlier one.
    pub(crate) fn send(&mut self, job: T) -> Result<(), OutputError> {
        match self.jobs.as_ref().map(|jobs| jobs.send(job)) {
            Some(Ok(())) => Ok(()),
            _ => Err(self.failure()),
        }
    }

    /// Waits until every job is done.
    pub(crate) fn finish(&mut self) -> Result<(), OutputError> {
        self.join().unwrap_or_else(|| Err(self.stopped()))
    }

    /// Why the thread has ended before it was told to.
    pub(crate) fn failure(&mut self) -> OutputError {
        match self.join() {
            Some(Err(error)) => error,
            _ => self.stopped(),
        }
    }

    fn join(&mut self) -> Option<Result<(), OutputError>> {
        self.jobs = None;
        self.thread.take()?.join().ok()
    }

    fn stopped(&self) -> OutputError {
        OutputError::WriterStopped { dir: self.folder.clone(), stem: self.stem.clone() }
    }
}

impl<T> Drop for Background<T> {
    fn drop(&mut self) {
        if let Some(Err(error)) = self.join() {
            tracing::error!("{error}");
        }
    }
}
