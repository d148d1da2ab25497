//! Writing frames beside the computation.
//!
//! A thread of its own takes filled frames, writes them and hands the memory back. Two frames circulate: while one
//! is on its way to the disk the next can be filled, and [`FrameWriter::submit`] waits when both are under way.

use super::{Frame, OutputError, series, vtkhdf};
use halfstep_wire::frame::{FrameSink, SinkError};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

/// Frames that circulate between the computation and the disk.
const IN_FLIGHT: usize = 2;

/// Writes the frames of one process.
#[derive(Debug)]
pub struct FrameWriter {
    folder: PathBuf,
    stem: String,
    /// Frames on their way to the disk. `None` once finished.
    filled: Option<SyncSender<(u32, Frame)>>,
    /// Frames that may be filled.
    free: Receiver<Frame>,
    safe: Arc<AtomicU32>,
    thread: Option<JoinHandle<Result<(), OutputError>>>,
}

impl FrameWriter {
    /// Starts the writer of `dir/frames/STEM_NNNNNN.hdf` and of their index; `dir` is the run's folder and `stem` is
    /// `fluid` or `solid`. An index that is there already is continued: see [`Self::submit`].
    pub fn start(dir: &Path, stem: &str) -> Result<Self, OutputError> {
        let folder = series::frames_folder(dir);
        std::fs::create_dir_all(&folder).map_err(OutputError::io("create", &folder))?;
        let index = folder.join(series::index_name(stem));
        let listed = match index.try_exists().map_err(OutputError::io("read", &index))? {
            true => series::Series::read(&index)?,
            false => series::Series::default(),
        };
        let (filled, to_write) = sync_channel(IN_FLIGHT);
        let (written, free) = sync_channel(IN_FLIGHT);
        for _ in 0..IN_FLIGHT {
            // The receiver is right here and there is room for all of them.
            let _ = written.send(Frame::default());
        }
        let safe = Arc::new(AtomicU32::new(0));
        let job = Job { folder: folder.clone(), stem: stem.into(), index, listed, safe: safe.clone() };
        let thread = std::thread::Builder::new()
            .name(format!("{stem} frames"))
            .spawn(move || job.run(&to_write, &written))
            .map_err(OutputError::io("start a thread for", &folder))?;
        Ok(Self { folder, stem: stem.into(), filled: Some(filled), free, safe, thread: Some(thread) })
    }

    /// Hands frame `number` over to be written. `fill` gets an empty frame, with the memory of an earlier one. Waits
    /// while two frames are under way. Fails with what went wrong with an earlier frame.
    ///
    /// Numbers ascend. The first one may lie below what an index on disk lists: from there on the list is replaced.
    pub fn submit(&mut self, number: u32, fill: impl FnOnce(&mut Frame)) -> Result<(), OutputError> {
        let Ok(mut frame) = self.free.recv() else { return Err(self.failure()) };
        frame.clear();
        fill(&mut frame);
        let Some(filled) = &self.filled else { return Err(self.failure()) };
        match filled.send((number, frame)) {
            Ok(()) => Ok(()),
            Err(_) => Err(self.failure()),
        }
    }

    /// The number up to which, not including it, all submitted frames are on disk and announced: with frames
    /// numbered from 0, how many are safe.
    pub fn safe(&self) -> u32 {
        self.safe.load(Ordering::Acquire)
    }

    /// Waits until everything submitted is on disk; returns what [`Self::safe`] then is.
    pub fn finish(mut self) -> Result<u32, OutputError> {
        match self.join() {
            Some(Ok(())) => Ok(self.safe()),
            Some(Err(error)) => Err(error),
            None => Err(self.stopped()),
        }
    }

    fn join(&mut self) -> Option<Result<(), OutputError>> {
        self.filled = None;
        self.thread.take()?.join().ok()
    }

    fn failure(&mut self) -> OutputError {
        match self.join() {
            Some(Err(error)) => error,
            _ => self.stopped(),
        }
    }

    fn stopped(&self) -> OutputError {
        OutputError::WriterStopped { dir: self.folder.clone(), stem: self.stem.clone() }
    }
}

impl FrameSink for FrameWriter {
    fn submit(&mut self, number: u32, fill: &mut dyn FnMut(&mut Frame)) -> Result<(), SinkError> {
        Ok(Self::submit(self, number, fill)?)
    }

    fn safe(&self) -> u32 {
        Self::safe(self)
    }

    fn finish(self: Box<Self>) -> Result<u32, SinkError> {
        Ok(Self::finish(*self)?)
    }
}

impl Drop for FrameWriter {
    /// Writes what was submitted; an error is only logged, use [`FrameWriter::finish`] to see it.
    fn drop(&mut self) {
        if let Some(Err(error)) = self.join() {
            tracing::error!("{error}");
        }
    }
}

/// What the thread owns.
struct Job {
    folder: PathBuf,
    stem: String,
    index: PathBuf,
    listed: series::Series,
    safe: Arc<AtomicU32>,
}

impl Job {
    fn run(
        mut self,
        to_write: &Receiver<(u32, Frame)>,
        written: &SyncSender<Frame>,
    ) -> Result<(), OutputError> {
        while let Ok((number, frame)) = to_write.recv() {
            let name = series::frame_name(&self.stem, number);
            vtkhdf::write(&self.folder.join(&name), &frame)?;
            self.listed.announce(name, frame.time);
            self.listed.write(&self.index)?;
            self.safe.store(number + 1, Ordering::Release);
            // Nobody waits for the memory once the last frame is submitted.
            let _ = written.send(frame);
        }
        Ok(())
    }
}
