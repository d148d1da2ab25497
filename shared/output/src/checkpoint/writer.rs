//! Writing a participant's checkpoints beside the computation.

use super::{file, file_name, folder};
use crate::OutputError;
use crate::background::Background;
use halfstep_wire::frame::SinkError;
use halfstep_wire::state::{Group, StateSink};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::Receiver;

/// Writes the checkpoints of one participant, one after the other, on a thread of its own. Dropping it writes what was
/// submitted; an error is only logged then.
#[derive(Debug)]
pub struct StateWriter {
    states: Background<(u64, Group)>,
    safe: Arc<AtomicU64>,
}

impl StateWriter {
    /// Starts the writer of a participant's files in the checkpoints of the run in a folder.
    ///
    /// # Errors
    /// The thread cannot be started.
    pub fn start(run: &Path, participant: &str) -> Result<Self, OutputError> {
        let safe = Arc::new(AtomicU64::new(0));
        let (written, own_run, name) = (Arc::clone(&safe), run.to_owned(), file_name(participant));
        let work = move |states: Receiver<_>| write_all(&own_run, &name, &states, &written);
        // One state may wait while another is written.
        Ok(Self { states: Background::start(run, participant, "checkpoints", 1, work)?, safe })
    }
}

fn write_all(
    run: &Path,
    name: &str,
    states: &Receiver<(u64, Group)>,
    safe: &AtomicU64,
) -> Result<(), OutputError> {
    while let Ok((number, state)) = states.recv() {
        let folder = folder(run, number);
        std::fs::create_dir_all(&folder).map_err(OutputError::io("create", &folder))?;
        file::write(&folder.join(name), &state)?;
        safe.store(number, Ordering::Release);
    }
    Ok(())
}

impl StateSink for StateWriter {
    fn submit(&mut self, number: u64, state: Group) -> Result<(), SinkError> {
        Ok(self.states.send((number, state))?)
    }

    fn safe(&self) -> u64 {
        self.safe.load(Ordering::Acquire)
    }

    fn finish(mut self: Box<Self>) -> Result<u64, SinkError> {
        self.states.finish()?;
        Ok(StateSink::safe(&*self))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfstep_wire::state::Column;

    #[test]
    fn generations_take_turns_and_are_told_when_safe() {
        let dir = tempfile::tempdir().unwrap();
        let mut writer = Box::new(StateWriter::start(dir.path(), "gate").unwrap());
        let state = |n: u64| {
            let mut group = Group::default();
            group.columns.insert("step".into(), Column::Counts(vec![n]));
            group
        };
        for n in 1..=3 {
            writer.submit(n, state(n)).unwrap();
        }
        assert_eq!(writer.finish().unwrap(), 3);
        let read = |folder: &str| file::read(&dir.path().join(folder).join("gate.hdf")).unwrap();
        assert_eq!((read("checkpoint-a"), read("checkpoint-b")), (state(3), state(2)));
    }

    #[test]
    fn a_failed_write_is_told() {
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join("checkpoint-a"), "in the way").unwrap();
        let mut writer = Box::new(StateWriter::start(dir.path(), "gate").unwrap());
        writer.submit(1, Group::default()).unwrap();
        let message = writer.finish().unwrap_err().to_string();
        assert!(message.contains("checkpoint-a"), "{message}");
    }
}
