//! What the roles of a run must agree on to find each other.

use super::{LinkError, memory};
use halfstep_wire::Name;
use halfstep_wire::protocol::{PROTOCOL, SCHEMA};
use iceoryx2::prelude::{Config, FileName, Path as ShortPath, SemanticString};
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

/// Longest root path plus prefix. Socket addresses end at 107 bytes, of which the transport's own names take 46.
const MAX_NAME: usize = 61;

/// Place of the fluid among the participants.
pub const FLUID: usize = 0;

/// Environment variable with the participants as `name:capacity`, separated by commas.
const PARTICIPANTS: &str = "HALFSTEP_PARTICIPANTS";
/// Environment variable with their processes, `name:process`.
const PROCESSES: &str = "HALFSTEP_PROCESSES";
/// Environment variable with their numbers of probe values, `name:count`.
const PROBES: &str = "HALFSTEP_PROBES";

/// A participant of a run: it owns particles and publishes their states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Participant {
    /// Name of the participant, unique in the run.
    pub name: Name,
    /// The process that it runs in.
    pub process: Name,
    /// Largest number of its particles in a message.
    pub capacity: u32,
    /// Number of its probe values; 0: it sends none.
    pub probes: u32,
}

/// Identifies a run and sizes its messages; the same for all of its processes.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkConfig {
    /// The run's number, in every message.
    pub run_id: u64,
    /// What the names of the run's objects in shared memory begin with.
    pub prefix: String,
    /// The run's folder for sockets and locks. Short: the path becomes part of socket addresses.
    pub root: PathBuf,
    /// The fluid first, then the solids in the scene's order.
    pub participants: Vec<Participant>,
    /// How long a process waits for the others at the start, s.
    pub handshake_seconds: f64,
    /// Longest wait for a message of a peer that is alive, s.
    pub patience_seconds: f64,
}

impl LinkConfig {
    /// A run of its own: number, prefix and root are unique on this machine. Creates nothing yet.
    pub fn new(participants: Vec<Participant>) -> Self {
        static COUNTER: AtomicU32 = AtomicU32::new(0);
        let pid = std::process::id();
        let nanos = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_nanos() as u64);
        let count = COUNTER.fetch_add(1, Ordering::Relaxed);
        let run_id = mix(nanos ^ (u64::from(pid) << 32) ^ mix(u64::from(count) + 1)) | 1;
        let name = format!("hs{pid}-{:08x}", (run_id >> 16) as u32);
        let mut root = std::env::temp_dir().join(&name);
        if root.as_os_str().len() + name.len() + 1 > MAX_NAME {
            root = Path::new("/tmp").join(&name);
        }
        Self {
            run_id,
            prefix: format!("{name}_"),
            root,
            participants,
            handshake_seconds: 60.0,
            patience_seconds: 600.0,
        }
    }

    /// A run of the fluid and one solid, each in its process.
    pub fn of_two(fluid_capacity: u32, solid_capacity: u32) -> Self {
        let alone = |name, capacity| Participant { name, process: name, capacity, probes: 0 };
        Self::new(vec![alone(Name::FLUID, fluid_capacity), alone(Name::SOLID, solid_capacity)])
    }

    /// Names of the participants, in order.
    pub fn names(&self) -> Vec<Name> {
        self.participants.iter().map(|p| p.name).collect()
    }

    /// Places of the participants that a process drives, in order.
    pub fn members(&self, process: Name) -> Vec<usize> {
        (0..self.participants.len()).filter(|&k| self.participants[k].process == process).collect()
    }

    /// Places of those whose states a participant reads: the fluid all solids', a solid the fluid's.
    pub fn peers(&self, place: usize) -> Vec<usize> {
        if place == FLUID { (1..self.participants.len()).collect() } else { vec![FLUID] }
    }

    /// Processes of the participants, each once, in order.
    pub fn processes(&self) -> Vec<Name> {
        let mut processes: Vec<Name> = Vec::new();
        for participant in &self.participants {
            if !processes.contains(&participant.process) {
                processes.push(participant.process);
            }
        }
        processes
    }

    /// The processes that a process exchanges messages with.
    pub fn partners(&self, process: Name) -> Vec<Name> {
        let of_fluid = self.participants.first().map(|fluid| fluid.process);
        let all = self.processes().into_iter().chain([Name::COUPLER]);
        let wanted = |other: &Name| {
            let central = |name: Name| name == Name::COUPLER || Some(name) == of_fluid;
            *other != process && (central(process) || central(*other))
        };
        all.filter(wanted).collect()
    }

    /// Shared memory that the messages of all participants and of the coupler take, bytes.
    pub fn shared_memory_bytes(&self) -> u64 {
        self.processes().into_iter().chain([Name::COUPLER]).map(|p| memory::published_bytes(self, p)).sum()
    }

    /// The variables from which a process that somebody else started learns all of this.
    pub fn to_env(&self) -> Vec<(&'static str, String)> {
        let list = |of: &dyn Fn(&Participant) -> String| {
            let all: Vec<String> =
                self.participants.iter().map(|p| format!("{}:{}", p.name, of(p))).collect();
            all.join(",")
        };
        let mut variables = vec![
            ("HALFSTEP_RUN_ID", self.run_id.to_string()),
            ("HALFSTEP_PREFIX", self.prefix.clone()),
            ("HALFSTEP_ROOT", self.root.display().to_string()),
            (PARTICIPANTS, list(&|p| p.capacity.to_string())),
            (PROCESSES, list(&|p| p.process.to_string())),
            (PROBES, list(&|p| p.probes.to_string())),
            ("HALFSTEP_SCHEMA", SCHEMA.to_string()),
            ("HALFSTEP_PROTOCOL", PROTOCOL.to_string()),
            ("HALFSTEP_HANDSHAKE_SECONDS", self.handshake_seconds.to_string()),
            ("HALFSTEP_PATIENCE_SECONDS", self.patience_seconds.to_string()),
        ];
        if let [fluid, solid] = self.participants.as_slice() {
            variables.push(("HALFSTEP_FLUID_CAPACITY", fluid.capacity.to_string()));
            variables.push(("HALFSTEP_SOLID_CAPACITY", solid.capacity.to_string()));
        }
        variables
    }

    /// The variables of [`Self::to_env`] and those that tell an external participant which one it is.
    pub fn to_env_of(&self, participant: &Participant) -> Vec<(&'static str, String)> {
        let mut variables = self.to_env();
        variables.push(("HALFSTEP_NAME", participant.name.to_string()));
        variables.push(("HALFSTEP_CAPACITY", participant.capacity.to_string()));
        variables
    }

    /// Reads the variables of [`Self::to_env`] from this process's environment.
    pub fn from_env() -> Result<Self, LinkError> {
        Self::from_variables(|key| std::env::var(key).ok())
    }

    /// Reads the variables of [`Self::to_env`] from anywhere.
    pub fn from_variables(get: impl Fn(&'static str) -> Option<String>) -> Result<Self, LinkError> {
        let text =
            |key| get(key).ok_or_else(|| LinkError::Config { key, reason: "the variable is not set".into() });
        for (key, own) in [("HALFSTEP_SCHEMA", SCHEMA), ("HALFSTEP_PROTOCOL", PROTOCOL.into())] {
            let found: u64 = parsed(key, &text(key)?)?;
            if found != own {
                let reason = format!("the run speaks {found}, this program {own}");
                return Err(LinkError::Incompatible { service: key.into(), reason });
            }
        }
        let config = Self {
            run_id: parsed("HALFSTEP_RUN_ID", &text("HALFSTEP_RUN_ID")?)?,
            prefix: text("HALFSTEP_PREFIX")?,
            root: text("HALFSTEP_ROOT")?.into(),
            participants: participants(&text(PARTICIPANTS)?, &text(PROCESSES)?, &text(PROBES)?)?,
            handshake_seconds: parsed("HALFSTEP_HANDSHAKE_SECONDS", &text("HALFSTEP_HANDSHAKE_SECONDS")?)?,
            patience_seconds: parsed("HALFSTEP_PATIENCE_SECONDS", &text("HALFSTEP_PATIENCE_SECONDS")?)?,
        };
        config.transport()?;
        Ok(config)
    }

    /// The transport's configuration, after a check of all values.
    pub(super) fn transport(&self) -> Result<Config, LinkError> {
        let wrong = |key, reason: String| Err(LinkError::Config { key, reason });
        let legal = |c: char| c.is_ascii_alphanumeric() || "-_".contains(c);
        if self.prefix.len() < 4 || !self.prefix.chars().all(legal) {
            return wrong("prefix", format!("`{}` is not a name of at least four letters", self.prefix));
        }
        let Some(root) = self.root.to_str().filter(|_| self.root.is_absolute()) else {
            return wrong("root", format!("`{}` is not an absolute UTF-8 path", self.root.display()));
        };
        if root.len() + self.prefix.len() > MAX_NAME {
            return wrong("root", format!("`{root}` and `{}` exceed {MAX_NAME} bytes", self.prefix));
        }
        let names = self.names();
        if names.first() != Some(&Name::FLUID) || names.len() < 2 {
            return wrong(PARTICIPANTS, "a coupled run has the fluid first and at least one solid".into());
        }
        let taken = |k: usize| names[k] == Name::COUPLER || names[..k].contains(&names[k]);
        if let Some(k) = (0..names.len()).find(|&k| taken(k)) {
            return wrong(PARTICIPANTS, format!("the name `{}` is taken", names[k]));
        }
        for (key, seconds) in
            [("handshake_seconds", self.handshake_seconds), ("patience_seconds", self.patience_seconds)]
        {
            if !(seconds > 0.0 && seconds < 1e9) {
                return wrong(key, format!("{seconds} is not a positive time"));
            }
        }
        let mut config = Config::default();
        config.global.prefix =
            FileName::new(self.prefix.as_bytes()).map_err(|e| LinkError::transport("name of the run", e))?;
        let root = ShortPath::new(root.as_bytes()).map_err(|e| LinkError::transport("root of the run", e))?;
        config.global.set_root_path(&root);
        Ok(config)
    }
}

fn parsed<T: FromStr<Err: Display>>(key: &'static str, text: &str) -> Result<T, LinkError> {
    text.parse().map_err(|e| LinkError::Config { key, reason: format!("`{text}`: {e}") })
}

/// The pairs of a list `name:value,name:value`.
fn pairs<T: FromStr<Err: Display>>(key: &'static str, list: &str) -> Result<Vec<(Name, T)>, LinkError> {
    let pair = |entry: &str| {
        let (name, value) = entry.split_once(':').ok_or_else(|| LinkError::Config {
            key,
            reason: format!("`{entry}` is not of the form name:value"),
        })?;
        Ok((parsed(key, name)?, parsed(key, value)?))
    };
    list.split(',').map(pair).collect()
}

fn participants(capacities: &str, processes: &str, probes: &str) -> Result<Vec<Participant>, LinkError> {
    let processes = pairs::<Name>(PROCESSES, processes)?;
    let probes = pairs::<u32>(PROBES, probes)?;
    let missing = |key, name| LinkError::Config { key, reason: format!("nothing about `{name}`") };
    let participant = |(name, capacity): (Name, u32)| {
        let process = processes.iter().find(|p| p.0 == name).ok_or_else(|| missing(PROCESSES, name))?;
        let probes = probes.iter().find(|p| p.0 == name).ok_or_else(|| missing(PROBES, name))?;
        Ok(Participant { name, process: process.1, capacity, probes: probes.1 })
    };
    pairs::<u32>(PARTICIPANTS, capacities)?.into_iter().map(participant).collect()
}

/// Finaliser of SplitMix64: neighbouring inputs give unrelated outputs.
fn mix(value: u64) -> u64 {
    let mut z = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn environment_carries_everything() {
        let config = LinkConfig { patience_seconds: 12.5, ..LinkConfig::of_two(300, 40) };
        let variables = config.to_env();
        let get = |key: &str| variables.iter().find(|(k, _)| *k == key).map(|(_, v)| v.clone());
        assert_eq!(LinkConfig::from_variables(get), Ok(config.clone()));

        for (missing, _) in variables.iter().filter(|(key, _)| !key.ends_with("D_CAPACITY")) {
            let error = LinkConfig::from_variables(|key| get(key).filter(|_| key != *missing)).unwrap_err();
            assert!(matches!(error, LinkError::Config { key, .. } if key == *missing), "{error}");
        }
        for other in ["HALFSTEP_SCHEMA", "HALFSTEP_PROTOCOL"] {
            let error =
                LinkConfig::from_variables(|key| if key == other { Some("7".into()) } else { get(key) })
                    .unwrap_err();
            assert!(matches!(&error, LinkError::Incompatible { service, .. } if service == other), "{error}");
        }
    }

    #[test]
    fn partners_are_those_who_exchange_messages() {
        let [a, b, c]: [Name; 3] = ["a", "b", "c"].map(|name| name.parse().unwrap());
        let solid = |name, process| Participant { name, process, capacity: 9, probes: 2 };
        let mut config = LinkConfig::of_two(5, 9);
        config.participants.splice(1.., [solid(a, Name::SOLID), solid(b, b), solid(c, Name::SOLID)]);
        assert_eq!(config.processes(), [Name::FLUID, Name::SOLID, b]);
        assert_eq!(config.members(Name::SOLID), [1, 3]);
        assert_eq!((config.peers(0), config.peers(2)), (vec![1, 2, 3], vec![0]));
        assert_eq!(config.partners(Name::FLUID), [Name::SOLID, b, Name::COUPLER]);
        assert_eq!(config.partners(b), [Name::FLUID, Name::COUPLER]);
        assert_eq!(config.partners(Name::COUPLER), [Name::FLUID, Name::SOLID, b]);
        let variables = config.to_env();
        let get = |key: &str| variables.iter().find(|(k, _)| *k == key).map(|(_, v)| v.clone());
        assert_eq!(LinkConfig::from_variables(get), Ok(config.clone()));
        assert_eq!(get("HALFSTEP_PARTICIPANTS").unwrap(), "fluid:5,a:9,b:9,c:9");
        assert_eq!(get("HALFSTEP_SOLID_CAPACITY"), None, "there is not one solid");
        config.participants[3].name = a;
        assert!(matches!(config.transport(), Err(LinkError::Config { key: PARTICIPANTS, .. })));
    }

    #[test]
    fn runs_differ() {
        let (a, b) = (LinkConfig::of_two(1, 1), LinkConfig::of_two(1, 1));
        assert!(a.run_id != b.run_id && a.prefix != b.prefix && a.root != b.root);
        assert!(a.transport().is_ok());
    }

    #[test]
    fn unusable_values_are_named() {
        let good = LinkConfig::of_two(1, 1);
        let key = |config: LinkConfig| match config.transport() {
            Err(LinkError::Config { key, .. }) => key,
            other => panic!("{other:?}"),
        };
        assert_eq!(key(LinkConfig { prefix: String::new(), ..good.clone() }), "prefix");
        assert_eq!(key(LinkConfig { prefix: "../../etc".into(), ..good.clone() }), "prefix");
        assert_eq!(key(LinkConfig { root: "relative".into(), ..good.clone() }), "root");
        assert_eq!(
            key(LinkConfig { root: format!("/tmp/{}", "x".repeat(60)).into(), ..good.clone() }),
            "root"
        );
        assert_eq!(key(LinkConfig { patience_seconds: f64::NAN, ..good.clone() }), "patience_seconds");
        assert_eq!(key(LinkConfig { handshake_seconds: 0.0, ..good }), "handshake_seconds");
    }
}
