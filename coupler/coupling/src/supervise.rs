//! Starts the roles as processes, watches them and ends them.
//!
//! Start all children before the coupler opens its link, and from a thread that lives as long as they shall: the system
//! ends them when that thread ends.

mod log;

use halfstep_link::{LinkConfig, Participant};
use halfstep_wire::Name;
use log::Log;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1};
use std::ffi::OsStr;
use std::io;
use std::os::fd::{AsRawFd, BorrowedFd, RawFd};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// What tells a role to end. Roles hear nothing else: SIGTERM may reach all processes of a run at once (`timeout`,
/// systemd, Slurm), and then the coupler ends the run in order.
const END: i32 = SIGUSR1;

/// Pause between two looks at the children.
const TICK: Duration = Duration::from_millis(5);
/// How long the rest of a group that was killed may take to die.
const DYING: Duration = Duration::from_secs(1);

/// Why a role could not be started.
#[derive(Debug, thiserror::Error)]
pub enum SuperviseError {
    /// The log could not be opened.
    #[error("{path}: {source}", path = path.display())]
    Log {
        /// Its path.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The program could not be started.
    #[error("the {role} could not be started (`{command}`): {source}")]
    Start {
        /// Which role.
        role: Name,
        /// The command.
        command: String,
        /// What the system said.
        source: io::Error,
    },
}

/// The roles that run as children of this process. What they print is appended to a log. Dropping it kills those that
/// still live.
#[derive(Debug)]
pub struct Children {
    log: Log,
    /// A file that roles keep open, as long as they live.
    kept: Option<RawFd>,
    children: Vec<Supervised>,
}

#[derive(Debug)]
struct Supervised {
    role: Name,
    child: Child,
    /// It is a program of the user's, which leads a process group.
    external: bool,
    /// That group may outlive it.
    group: bool,
    /// Ends that group if this process is killed.
    watchdog: Option<Watchdog>,
    status: Option<ExitStatus>,
}

impl Supervised {
    /// Whether the child, or what it started itself, still runs.
    fn is_alive(&self) -> bool {
        self.status.is_none() || self.group
    }

    fn poll(&mut self) {
        if self.status.is_none() {
            self.status = self.child.try_wait().ok().flatten();
        }
        // An empty group is forgotten at once: its number may be given to others.
        if self.status.is_some() && self.group && !self.signal(0) {
            self.group = false;
            self.watchdog = None;
        }
    }

    fn signal(&self, signal: i32) -> bool {
        let pid = self.child.id() as libc::pid_t;
        // SAFETY: the target is a child that has not been waited for, or a group that had members when last polled.
        self.is_alive() && unsafe { libc::kill(if self.group { -pid } else { pid }, signal) } == 0
    }
}

impl Children {
    /// No children yet; theirs is the log at this path.
    pub fn new(log: &Path) -> Self {
        Self { log: Log::new(log), kept: None, children: Vec::new() }
    }

    /// Roles started from now on keep this file open as long as they live: a lock on it ends with the last of them. The
    /// file must stay open until they are started.
    pub fn keep(&mut self, file: BorrowedFd<'_>) {
        self.kept = Some(file.as_raw_fd());
    }

    /// Cuts the log where a program fills it, and says so once.
    pub fn keep_log_short(&mut self) {
        self.log.keep_short();
    }

    /// Starts a role. It ends with this process, it does not hear Ctrl-C, and its output goes to the log.
    pub fn spawn(&mut self, role: Name, command: Command) -> Result<(), SuperviseError> {
        self.start(role, command, false)
    }

    /// Starts a solid of another program, from a line for the shell. It learns of the run from the variables of
    /// [`LinkConfig::to_env`] and from `more`.
    pub fn spawn_shell(
        &mut self,
        participant: &Participant,
        line: &str,
        link: &LinkConfig,
        more: &[(&str, &Path)],
    ) -> Result<(), SuperviseError> {
        let mut command = Command::new("sh");
        let replaces = if is_one_program(line) { "exec " } else { "" };
        command.arg("-c").arg(format!("{replaces}{line}"));
        command.envs(link.to_env_of(participant)).envs(more.iter().copied());
        self.start(participant.name, command, true)?;
        // The shell's death signal does not reach what the shell has started.
        let Some(child) = self.children.last_mut() else { return Ok(()) };
        child.watchdog = Some(Watchdog::start(child.child.id(), link).map_err(|source| {
            SuperviseError::Start { role: participant.name, command: "sh".into(), source }
        })?);
        Ok(())
    }

    fn start(&mut self, role: Name, mut command: Command, group: bool) -> Result<(), SuperviseError> {
        let unopened = |source| SuperviseError::Log { path: self.log.path().to_owned(), source };
        let log = self.log.open().map_err(unopened)?;
        let errors = log.try_clone().map_err(unopened)?;
        command.stdin(Stdio::null()).stdout(log).stderr(errors);
        if group {
            // A shell may have children of its own.
            command.process_group(0);
        }
        let parent = std::process::id();
        let kept = self.kept.filter(|_| !group);
        // SAFETY: between fork and exec; only calls that are safe after a fork of a process with threads.
        unsafe {
            command.pre_exec(move || {
                if let Some(file) = kept {
                    libc::fcntl(file, libc::F_SETFD, 0);
                }
                bind_to_parent(parent, group)
            });
        }
        let child = command.spawn().map_err(|source| SuperviseError::Start {
            role,
            command: std::iter::once(command.get_program())
                .chain(command.get_args())
                .map(OsStr::to_string_lossy)
                .collect::<Vec<_>>()
                .join(" "),
            source,
        })?;
        self.children.push(Supervised { role, child, external: group, group, watchdog: None, status: None });
        Ok(())
    }

    /// Process numbers of the roles, in the order of their start.
    pub fn pids(&self) -> Vec<(Name, u32)> {
        self.children.iter().map(|c| (c.role, c.child.id())).collect()
    }

    /// Whether a child still runs.
    pub fn any_alive(&mut self) -> bool {
        self.poll();
        self.children.iter().any(Supervised::is_alive)
    }

    /// The first child that was found to have ended, and how. Children that end in the same moment are ordered by
    /// their failure: one that did not succeed comes before one that did.
    pub fn first_exit(&mut self) -> Option<(Name, ExitStatus)> {
        self.poll();
        let ended = || self.children.iter().filter_map(|c| Some((c.role, c.status?)));
        ended().find(|(_, status)| !status.success()).or_else(|| ended().next())
    }

    /// The child whose end ended the others: one that a signal ended, else the one that was missed, which is one that
    /// failed or, of programs of the user's, any, else any that failed. Which of them was noticed first says nothing.
    pub fn culprit(&mut self, missed: Option<Name>) -> Option<(Name, ExitStatus)> {
        let exits = self.exits();
        let failed = || exits.iter().copied().filter(|(_, status)| !status.success());
        let foreign = |name: Name| self.children.iter().any(|child| child.external && child.role == name);
        let mut gone = exits.iter().copied().filter(|(role, _)| Some(*role) == missed);
        failed()
            .find(|(_, status)| status.signal().is_some())
            .or_else(|| gone.find(|(role, status)| !status.success() || foreign(*role)))
            .or_else(|| failed().next())
    }

    /// How each child ended that has.
    pub fn exits(&mut self) -> Vec<(Name, ExitStatus)> {
        self.poll();
        self.children.iter().filter_map(|c| Some((c.role, c.status?))).collect()
    }

    /// Waits until all have ended by themselves; returns whether they have within this time.
    pub fn wait(&mut self, time: Duration) -> bool {
        let deadline = Instant::now() + time;
        while self.any_alive() {
            if Instant::now() >= deadline {
                return false;
            }
            std::thread::sleep(TICK);
        }
        true
    }

    /// Asks all to end, waits so long, then kills those that have not. Returns how each ended.
    pub fn stop(&mut self, grace: Duration) -> Vec<(Name, ExitStatus)> {
        self.poll();
        for child in &self.children {
            child.signal(if child.group { SIGTERM } else { END });
        }
        if !self.wait(grace) {
            self.signal(libc::SIGKILL);
            for child in self.children.iter_mut().filter(|c| c.is_alive()) {
                if child.status.is_none() {
                    child.status = child.child.wait().ok();
                }
                // What the child had started dies beside it, and has files of the run open until then.
                let deadline = Instant::now() + DYING;
                child.poll();
                while child.group && Instant::now() < deadline {
                    std::thread::sleep(TICK);
                    child.poll();
                }
            }
        }
        self.exits()
    }

    fn poll(&mut self) {
        self.children.iter_mut().for_each(Supervised::poll);
    }

    fn signal(&mut self, signal: i32) {
        self.poll();
        for child in &self.children {
            child.signal(signal);
        }
    }
}

impl Drop for Children {
    fn drop(&mut self) {
        self.stop(Duration::ZERO);
    }
}

/// Lets the calling process end when its parent does and not hear Ctrl-C: the coupler decides what that means. A role
/// does not hear SIGTERM and SIGHUP either; `external` programs do.
fn bind_to_parent(parent: u32, external: bool) -> io::Result<()> {
    // SAFETY: no memory is passed; all calls are safe after a fork.
    unsafe {
        if libc::prctl(libc::PR_SET_PDEATHSIG, if external { SIGTERM } else { END }) != 0 {
            return Err(io::Error::last_os_error());
        }
        // The parent may have ended before that call.
        if libc::getppid() as u32 != parent {
            libc::_exit(1);
        }
        libc::signal(SIGINT, libc::SIG_IGN);
        if !external {
            libc::signal(SIGTERM, libc::SIG_IGN);
            libc::signal(SIGHUP, libc::SIG_IGN);
        }
    }
    Ok(())
}

/// A process that outlives this one where this one is killed, and then ends a process group and removes what it may
/// have made in shared memory. It learns of the end from a pipe that the system closes.
#[derive(Debug)]
struct Watchdog(Child);

impl Watchdog {
    /// What it does, with the group, the prefix of the run's objects and its folder as arguments. It removes them more
    /// than once: a role that was about to connect makes objects until it hears of the end.
    const SCRIPT: &str = "trap '' HUP INT TERM; read -r _; kill -s TERM -- \"-$1\"; sleep 1; \
                          kill -s KILL -- \"-$1\"; for _ in 1 2 3 4 5 6 7 8 9 10; do \
                          rm -f -- /dev/shm/\"$2\"*; rm -rf -- \"$3\"; sleep 0.5; done";

    fn start(group: u32, link: &LinkConfig) -> io::Result<Self> {
        let LinkConfig { prefix, root, .. } = link;
        // Only a folder that is the run's own by its name.
        let is_own = root.file_name().is_some_and(|name| prefix.trim_end_matches('_') == name);
        let mut command = Command::new("sh");
        command.args(["-c", Self::SCRIPT, "halfstep-watchdog", &group.to_string(), prefix]);
        command.arg(if is_own { root.as_os_str() } else { OsStr::new("") });
        command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null()).process_group(0);
        command.spawn().map(Self)
    }
}

impl Drop for Watchdog {
    fn drop(&mut self) {
        // The group has ended, or been killed.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Whether a line for the shell does nothing but start one program, which can then take the shell's place.
fn is_one_program(line: &str) -> bool {
    const OF_THE_SHELL: [&str; 31] = [
        ".", ":", "!", "{", "alias", "bg", "break", "case", "cd", "command", "continue", "eval", "exec",
        "exit", "export", "fg", "for", "if", "jobs", "read", "readonly", "return", "set", "shift", "times",
        "trap", "ulimit", "umask", "unset", "until", "while",
    ];
    let first = line.split_whitespace().next().unwrap_or_default();
    // Also within quotes, where they would do nothing: the shell without its program is only the longer way.
    let joins = |c: char| ";&|()<>\n`".contains(c);
    !(first.is_empty() || first.contains('=') || OF_THE_SHELL.contains(&first) || line.contains(joins))
}

/// What a process that people see is asked to do.
#[derive(Clone, Debug, Default)]
pub struct StopFlags {
    /// End in order, at the next step.
    pub stop: Arc<AtomicBool>,
    /// End at once.
    pub at_once: Arc<AtomicBool>,
}

impl StopFlags {
    /// Flags that SIGINT (Ctrl-C), SIGTERM and SIGHUP set: the first of them asks for an end in order, the second for
    /// one at once.
    ///
    /// # Errors
    /// The system refuses.
    pub fn of_signals() -> io::Result<Self> {
        let flags = Self::default();
        for signal in [SIGINT, SIGTERM, SIGHUP] {
            let Self { stop, at_once } = flags.clone();
            let note = move || {
                if stop.swap(true, Ordering::Relaxed) {
                    at_once.store(true, Ordering::Relaxed);
                }
            };
            // SAFETY: the handler does nothing but atomic operations.
            unsafe { signal_hook::low_level::register(signal, note) }?;
        }
        Ok(flags)
    }
}

/// A flag that the supervisor's signal sets, for a role: passed to the link as its abort flag, it ends every wait, so
/// that the role can clean up.
///
/// # Errors
/// The system refuses.
pub fn abort_flag() -> io::Result<Arc<AtomicBool>> {
    let flag = Arc::new(AtomicBool::new(false));
    signal_hook::flag::register(END, Arc::clone(&flag))?;
    Ok(flag)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A program of the user's that ends without an error while it is missed is why the others end.
    #[test]
    fn who_leaves_with_status_0_is_the_culprit() {
        let folder = tempfile::tempdir().unwrap();
        let mut children = Children::new(&folder.path().join("log.txt"));
        let [left, right] = ["left", "right"].map(|name| name.parse::<Name>().unwrap());
        for (name, line) in [(left, "exit 0"), (right, "exit 3")] {
            let mut command = Command::new("sh");
            command.args(["-c", line]);
            children.start(name, command, true).unwrap();
        }
        assert!(children.wait(Duration::from_secs(10)));
        let is = |missed: Option<Name>, children: &mut Children| children.culprit(missed).unwrap();
        assert_eq!(is(Some(left), &mut children).0, left);
        assert_eq!(is(None, &mut children).0, right);
    }

    #[test]
    fn a_program_takes_the_place_of_its_shell_and_a_script_does_not() {
        for line in ["./solid", "python3 'my block.py' 2e4", "  \"/opt/my solver/bin\" -k $HOME/x"] {
            assert!(is_one_program(line), "{line}");
        }
        for line in [
            "",
            "K=2 ./solid",
            "cd solver && ./solid",
            "./solid > x",
            "./solid; true",
            ". ./env",
            "exec ./solid",
        ] {
            assert!(!is_one_program(line), "{line}");
        }
    }
}
