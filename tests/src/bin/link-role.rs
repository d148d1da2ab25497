//! A role of the known run as a process of its own, for tests that kill it: `link-role ROLE STEPS` with the run in the
//! environment; `link-role launcher DIR` starts a run of all three as its children.

use halfstep_coupling::supervise::{Children, abort_flag};
use halfstep_link::{Claim, LinkConfig, Processes};
use halfstep_tests::conformance::link::play;
use halfstep_wire::Name;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;
use std::process::{Command, ExitCode};
use std::time::Duration;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let role = match arguments[0].as_str() {
        "fluid" => Name::FLUID,
        "solid" => Name::SOLID,
        "coupler" => Name::COUPLER,
        _ => return launcher(Path::new(&arguments[1])),
    };
    let flag = abort_flag().expect("a signal handler");
    let config = LinkConfig::from_env().expect("a run");
    match play::role::<Processes>(&config, role, arguments[1].parse().expect("steps"), Some(flag)) {
        Ok(_) => ExitCode::SUCCESS,
        Err(error) => {
            // In one piece: several roles write to one log.
            let _ = std::io::stderr().write_all(format!("{role}: {error}\n").as_bytes());
            ExitCode::from(2)
        }
    }
}

fn launcher(dir: &Path) -> ExitCode {
    let config = LinkConfig::of_two(100, 100);
    let _claim = Claim::new(&config).expect("a claim");
    let mut children = Children::new(&dir.join("log.txt"));
    for role in ["fluid", "solid", "coupler"] {
        let mut command = Command::new(std::env::current_exe().expect("own path"));
        command.args([role, "1000000000"]).envs(config.to_env());
        let role = [Name::FLUID, Name::SOLID, Name::COUPLER]
            .into_iter()
            .find(|name| name.to_string() == role)
            .expect("a role");
        children.spawn(role, command).expect("a child");
    }
    let environment: BTreeMap<&str, String> = config.to_env().into_iter().collect();
    let pids: Vec<u32> = children.pids().into_iter().map(|(_, pid)| pid).collect();
    let state = serde_json::json!({ "environment": environment, "pids": pids });
    let path = dir.join("run.json");
    std::fs::write(path.with_extension("tmp"), state.to_string()).expect("a file");
    std::fs::rename(path.with_extension("tmp"), path).expect("a file");
    children.wait(Duration::from_secs(60));
    ExitCode::SUCCESS
}
