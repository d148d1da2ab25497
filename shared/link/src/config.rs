//! What the roles of a run must agree on to find each other.

use super::{LinkError, memory};
use halfstep_wire::failure::RoleName;
use halfstep_wire::protocol::{PROTOCOL, SCHEMA};
use iceoryx2::prelude::{Config, FileName, Path as ShortPath, SemanticString};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

/// Longest root path plus prefix. Socket addresses end at 107 bytes, of which the transport's own names take 46.
const MAX_NAME: usize = 61;

/// Identifies a run and sizes its messages; the same for all of its roles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LinkConfig {
    /// The run's number, in every message.
    pub run_id: u64,
    /// What the names of the run's objects in shared memory begin with.
    pub prefix: String,
    /// The run's folder for sockets and locks. Short: the path becomes part of socket addresses.
    pub root: PathBuf,
    /// Largest number of fluid particles in a message.
    pub fluid_capacity: u32,
    /// Largest number of solid particles in a message.
    pub solid_capacity: u32,
    /// How long a role waits for the others at the start, s.
    pub handshake_seconds: f64,
    /// Longest wait for a message of a peer that is alive, s.
    pub patience_seconds: f64,
}

impl LinkConfig {
    /// A run of its own: number, prefix and root are unique on this machine. Creates nothing yet.
    pub fn new(fluid_capacity: u32, solid_capacity: u32) -> Self {
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
            fluid_capacity,
            solid_capacity,
            handshake_seconds: 60.0,
            patience_seconds: 600.0,
        }
    }

    /// Largest number of particles of a phase in a message.
    pub fn capacity(&self, phase: RoleName) -> u32 {
        match phase {
            RoleName::Fluid => self.fluid_capacity,
            RoleName::Solid => self.solid_capacity,
            RoleName::Coupler => 0,
        }
    }

    /// Shared memory that the messages of all roles of this run take, bytes.
    pub fn shared_memory_bytes(&self) -> u64 {
        [RoleName::Fluid, RoleName::Solid, RoleName::Coupler]
            .into_iter()
            .map(|role| memory::publisher_bytes(self, role))
            .sum()
    }

    /// The variables from which a process that somebody else started learns all of this.
    pub fn to_env(&self) -> Vec<(&'static str, String)> {
        vec![
            ("HALFSTEP_RUN_ID", self.run_id.to_string()),
            ("HALFSTEP_PREFIX", self.prefix.clone()),
            ("HALFSTEP_ROOT", self.root.display().to_string()),
            ("HALFSTEP_FLUID_CAPACITY", self.fluid_capacity.to_string()),
            ("HALFSTEP_SOLID_CAPACITY", self.solid_capacity.to_string()),
            ("HALFSTEP_SCHEMA", SCHEMA.to_string()),
            ("HALFSTEP_PROTOCOL", PROTOCOL.to_string()),
            ("HALFSTEP_HANDSHAKE_SECONDS", self.handshake_seconds.to_string()),
            ("HALFSTEP_PATIENCE_SECONDS", self.patience_seconds.to_string()),
        ]
    }

    /// Reads the variables of [`Self::to_env`] from this process's environment.
    pub fn from_env() -> Result<Self, LinkError> {
        Self::from_variables(|key| std::env::var(key).ok())
    }

    /// Reads the variables of [`Self::to_env`] from anywhere.
    pub fn from_variables(get: impl Fn(&'static str) -> Option<String>) -> Result<Self, LinkError> {
        let text =
            |key| get(key).ok_or_else(|| LinkError::Config { key, reason: "the variable is not set".into() });
        fn number<T: std::str::FromStr<Err: std::fmt::Display>>(
            key: &'static str,
            text: &str,
        ) -> Result<T, LinkError> {
            text.parse().map_err(|e| LinkError::Config { key, reason: format!("`{text}`: {e}") })
        }
        for (key, own) in [("HALFSTEP_SCHEMA", SCHEMA), ("HALFSTEP_PROTOCOL", PROTOCOL.into())] {
            let found: u64 = number(key, &text(key)?)?;
            if found != own {
                let reason = format!("the run speaks {found}, this program {own}");
                return Err(LinkError::Incompatible { service: key.into(), reason });
            }
        }
        let config = Self {
            run_id: number("HALFSTEP_RUN_ID", &text("HALFSTEP_RUN_ID")?)?,
            prefix: text("HALFSTEP_PREFIX")?,
            root: text("HALFSTEP_ROOT")?.into(),
            fluid_capacity: number("HALFSTEP_FLUID_CAPACITY", &text("HALFSTEP_FLUID_CAPACITY")?)?,
            solid_capacity: number("HALFSTEP_SOLID_CAPACITY", &text("HALFSTEP_SOLID_CAPACITY")?)?,
            handshake_seconds: number("HALFSTEP_HANDSHAKE_SECONDS", &text("HALFSTEP_HANDSHAKE_SECONDS")?)?,
            patience_seconds: number("HALFSTEP_PATIENCE_SECONDS", &text("HALFSTEP_PATIENCE_SECONDS")?)?,
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
        let config = LinkConfig { patience_seconds: 12.5, ..LinkConfig::new(300, 40) };
        let variables = config.to_env();
        let get = |key: &str| variables.iter().find(|(k, _)| *k == key).map(|(_, v)| v.clone());
        assert_eq!(LinkConfig::from_variables(get), Ok(config.clone()));

        for (missing, _) in &variables {
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
    fn runs_differ() {
        let (a, b) = (LinkConfig::new(1, 1), LinkConfig::new(1, 1));
        assert!(a.run_id != b.run_id && a.prefix != b.prefix && a.root != b.root);
        assert!(a.transport().is_ok());
    }

    #[test]
    fn unusable_values_are_named() {
        let good = LinkConfig::new(1, 1);
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
