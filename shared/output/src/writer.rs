//! Writing frames beside the computation.
//!
//! A thread of its own takes filled frames, writes them and hands the memory back. Two frames circulate: while one
//! is on its way to the disk the next can be filled, and [`FrameWriter::submit`] waits when both are under way.

use super::background::Background;
use super::{Frame, OutputError, series, vtkhdf};
use halfstep_wire::frame::{FrameSink, SinkError};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

/// Frames that circulate between the computation and the disk.
const IN_FLIGHT: usize = 2;

/// Writes the frames of one process. Dropping it writes what was submitted; an error is only logged then, use
/// [`FrameWriter::finish`] to see it.
#[derive(Debug)]
pub struct FrameWriter {
    /// Frames on their way to the disk.
    filled: Background<(u32, Frame)>,
    /// Frames that may be filled.
    free: Receiver<Frame>,
    safe: Arc<AtomicU32>,
}

impl FrameWriter {
    /// Starts the writer of `dir/frames/STEM_NNNNNN.hdf` and of their index; `dir` is the run's folder and `stem` is
    /// `fluid` or `solid`. An index that is there already is continued: see [`Self::submit`].
    pub fn start(dir: &Path, stem: &str) -> Result<Self, OutputError> {
        let folder = series::frames_folder(dir);
        std::fs::create_dir_all(&folder).map_err(OutputError::io("create", &folder))?;
        let index = folder.join(series::index_name(stem));
        let index = series::Index::open(index)?;
        let (written, free) = sync_channel(IN_FLIGHT);
        for _ in 0..IN_FLIGHT {
            // The receiver is right here and there is room for all of them.
            let _ = written.send(Frame::default());
        }
        let safe = Arc::new(AtomicU32::new(index.safe()));
        let job = Job { folder: folder.clone(), stem: stem.into(), index, safe: safe.clone() };
        let work = move |frames: Receiver<_>| job.run(&frames, &written);
        let filled = Background::start(&folder, stem, "frames", IN_FLIGHT, work)?;
        Ok(Self { filled, free, safe })
    }

    /// Hands frame `number` over to be written. `fill` gets an empty frame, with the memory of an earlier one. Waits
    /// while two frames are under way. Fails with what went wrong with an earlier frame.
    ///
    /// Numbers ascend. The first one may lie below what an index on disk lists: from there on the list is replaced.
    pub fn submit(&mut self, number: u32, fill: impl FnOnce(&mut Frame)) -> Result<(), OutputError> {
        let Ok(mut frame) = self.free.recv() else { return Err(self.filled.failure()) };
        frame.clear();
        fill(&mut frame);
        self.filled.send((number, frame))
    }

    /// The number up to which, not including it, all submitted frames are on disk and announced, those of an index that
    /// is continued among them: with frames numbered from 0, how many are safe.
    pub fn safe(&self) -> u32 {
        self.safe.load(Ordering::Acquire)
    }

    /// Waits until everything submitted is on disk; returns what [`Self::safe`] then is.
    pub fn finish(mut self) -> Result<u32, OutputError> {
        self.wait()?;
        Ok(self.safe())
    }

    /// Waits until everything submitted is on disk; nothing can be submitted any more.
    pub fn wait(&mut self) -> Result<(), OutputError> {
        self.filled.finish()
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

/// What the thread owns.
struct Job {
    folder: PathBuf,
    stem: String,
    index: series::Index,
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
            self.index.announce(name, frame.time)?;
            self.safe.store(number + 1, Ordering::Release);
            // Nobody waits for the memory once the last frame is submitted.
            let _ = written.send(frame);
        }
        Ok(())
    }
}
