//! Why a coupled run ended: who caused it, and what that process said last.

use halfstep_coupling::error::{RoleEnd, RunError};
use halfstep_coupling::supervise::Children;
use halfstep_link::LinkError;
use halfstep_wire::Name;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::ExitStatus;
use std::time::Duration;

/// The end of the log that is searched, bytes.
const TAIL: u64 = 64 << 10;
/// Characters of a process's words that are repeated.
const WORDS: usize = 400;

/// What is known when a run has failed.
pub(crate) struct Cause<'a> {
    /// The run's log.
    pub(crate) log: &'a Path,
    /// Solids of other programs.
    pub(crate) external: &'a [Name],
    /// Step n and its time, s; `None`: the run had not begun.
    pub(crate) at: Option<(u64, f64)>,
}

impl Cause<'_> {
    /// The last words of a process, where the log tells whose they are: of several programs of the user's it does not.
    fn words(&self, role: Name) -> Option<String> {
        let external = self.external.contains(&role);
        if external && self.external.len() > 1 { None } else { last_words(self.log, role, external) }
    }

    /// The error with its cause: `ended` is the process whose end ended the others, if one did.
    pub(crate) fn of(&self, error: RunError, ended: Option<(Name, ExitStatus)>) -> RunError {
        match (error, ended) {
            (RunError::RoleFailed { role, step, .. }, ended) => {
                let is_own = !self.external.contains(&role);
                let left = ended.is_some_and(|(ended, status)| ended == role && status.success());
                let said = self.words(role);
                let said = if left && !is_own { Some(left_early(said)) } else { said };
                RunError::RoleFailed { role, step, said }
            }
            // Whoever is silent is the cause: a program of the user's that has ended by then ended because of that.
            (RunError::Link(link @ LinkError::Timeout { peer, .. }), Some((role, _)))
                if role != peer && self.external.contains(&role) =>
            {
                RunError::Link(link)
            }
            (RunError::Link(link), Some((role, status))) if !names_the_fault(&link) => {
                let is_own = !self.external.contains(&role);
                // Whom a signal ends has no last words.
                let said = if status.signal().is_some() { None } else { self.words(role) };
                RunError::RoleEnded(Box::new(RoleEnd { role, status, at: self.at, said, is_own, link }))
            }
            (error, _) => error,
        }
    }
}

/// What is known of a program that ended without an error while the run went on.
fn left_early(said: Option<String>) -> String {
    let last = said.map_or_else(String::new, |said| format!("; last it wrote: {said}"));
    format!("its program left the run and ended without an error (exit status: 0){last}")
}

/// Ends all children after a run that failed with this error; returns the one whose end ended the others, if one did.
pub(crate) fn culprit(children: &mut Children, error: &RunError) -> Option<(Name, ExitStatus)> {
    children.wait(Duration::from_millis(300));
    let missed = match error {
        RunError::Link(LinkError::PeerDied { peer }) => Some(*peer),
        RunError::RoleFailed { role, .. } => Some(*role),
        _ => None,
    };
    let cause = children.culprit(missed);
    children.stop(Duration::from_secs(1));
    cause
}

/// Whether an error says what is wrong, and not only that somebody is missed.
fn names_the_fault(link: &LinkError) -> bool {
    !matches!(
        link,
        LinkError::PeerDied { .. }
            | LinkError::Timeout { .. }
            | LinkError::HandshakeTimeout { .. }
            | LinkError::Aborted
            | LinkError::Transport { .. }
    )
}

/// The last line of a log in which a process tells of its error; of a program of the user's the last line that no other
/// process has written.
fn last_words(log: &Path, role: Name, external: bool) -> Option<String> {
    let mut file = File::open(log).ok()?;
    let length = file.metadata().ok()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(TAIL))).ok()?;
    let mut text = Vec::new();
    file.take(TAIL).read_to_end(&mut text).ok()?;
    let text = String::from_utf8_lossy(&text);
    let mark = format!(": {role}: ");
    let words = |line: &str| match (line.split_once(" ERROR "), external) {
        (Some((_, rest)), false) => rest.split_once(&mark).map(|(_, words)| words.trim().to_owned()),
        (None, true) => Some(line.trim().to_owned()).filter(|line| !line.is_empty() && !is_of_a_role(line)),
        _ => None,
    };
    let words: String = text.lines().rev().find_map(words)?;
    Some(words.chars().take(WORDS).collect())
}

/// Whether a line begins with an instant and a level, as those of the program's own processes do.
fn is_of_a_role(line: &str) -> bool {
    let mut words = line.split_whitespace();
    let instant =
        words.next().is_some_and(|word| word.len() > 20 && word.ends_with('Z') && word.contains('T'));
    instant && words.next().is_some_and(|word| ["ERROR", "WARN", "INFO", "DEBUG", "TRACE"].contains(&word))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOG: &str = "block: ready\n\
        2026-11-22T09:00:00.000001Z ERROR halfstep::role_main: fluid: cannot write f.hdf: No space left on device\n\
        Traceback (most recent call last):\nValueError: no such key\n\n\
        2026-11-22T09:00:00.000002Z  WARN halfstep::role_main: the last frame is missing\n\
        2026-11-22T09:00:00.000003Z ERROR halfstep::role_main: solid: the fluid ended the run at step 3, stage 1\n";

    #[test]
    fn each_process_has_words_of_its_own() {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("log.txt");
        assert_eq!(last_words(&log, Name::FLUID, false), None, "there is no log");
        std::fs::write(&log, LOG).unwrap();
        let words = |role, external| last_words(&log, role, external);
        assert_eq!(words(Name::FLUID, false).unwrap(), "cannot write f.hdf: No space left on device");
        assert_eq!(words(Name::SOLID, false).unwrap(), "the fluid ended the run at step 3, stage 1");
        assert_eq!(words(Name::SOLID, true).unwrap(), "ValueError: no such key");
    }

    #[test]
    fn the_culprit_leads_with_step_and_time() {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("log.txt");
        std::fs::write(&log, LOG).unwrap();
        let at = Some((12, 0.25));
        let failed = ExitStatus::from_raw(2 << 8);
        let told = |external: &[Name], at, ended, link: LinkError| {
            let cause = Cause { log: &log, external, at };
            cause.of(RunError::Link(link), Some(ended)).to_string()
        };
        let died = LinkError::PeerDied { peer: Name::FLUID };
        assert_eq!(
            told(&[], at, (Name::FLUID, failed), died.clone()),
            "cannot write f.hdf: No space left on device (the fluid process ended with it, exit status: 2, at step 12, \
             t = 2.500000e-1 s)"
        );
        assert_eq!(
            told(&[Name::SOLID], None, (Name::SOLID, failed), LinkError::Aborted),
            "the solid process ended (exit status: 2) before the run had begun: ValueError: no such key"
        );
        let two = ["left", "right"].map(|name| name.parse::<Name>().unwrap());
        let of_two = told(&two, None, (two[1], failed), LinkError::Aborted);
        assert_eq!(of_two, "the right process ended (exit status: 2) before the run had begun");
        let left = |status| {
            let cause = Cause { log: &log, external: &[Name::SOLID], at };
            let failed = RunError::RoleFailed { role: Name::SOLID, step: 5, said: None };
            cause.of(failed, Some((Name::SOLID, ExitStatus::from_raw(status)))).to_string()
        };
        assert_eq!(left(1 << 8), "the solid failed at step 5: ValueError: no such key");
        assert_eq!(
            left(0),
            "the solid failed at step 5: its program left the run and ended without an error (exit status: 0); last it \
             wrote: ValueError: no such key"
        );
        let killed = told(&[], at, (Name::FLUID, ExitStatus::from_raw(9)), died);
        assert!(killed.starts_with("the fluid process ended (signal: 9 (SIGKILL)) at step 12, "), "{killed}");
        let lie =
            LinkError::Capacity { peer: Name::SOLID, needed: 9, capacity: 1, key: LinkError::CAPACITY_KEY };
        assert_eq!(
            told(&[], at, (Name::FLUID, failed), lie.clone()),
            lie.to_string(),
            "the liar is named, not who heard it"
        );
    }
}
