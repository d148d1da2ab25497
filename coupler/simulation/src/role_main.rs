//! The process of a role: what a program becomes that a [`crate::Launcher`] starts.

use crate::isa;
use crate::timeline;
use halfstep_coupling::supervise::abort_flag;
use halfstep_coupling::{no_room, say};
use halfstep_coupling::{reports, roles};
use halfstep_role::lockstep::RoleError;
use halfstep_role::serve::serve_process;
use halfstep_sph::lane::Isa;
use halfstep_wire::Name;
use std::os::unix::process::parent_id;

/// Serves a process of participants and ends the program, if it was started for that (arguments `role NAME`); else
/// returns at once. A program that names itself in a [`crate::Launcher`] calls this first in its `main`.
pub fn role_main() {
    let arguments: Vec<String> =
        std::env::args_os().skip(1).map(|a| a.to_string_lossy().into_owned()).collect();
    let [word, name] = arguments.as_slice() else { return };
    if word != "role" {
        return;
    }
    let code = match isa::of_environment() {
        Ok(isa) => serve_role(name, isa),
        Err(error) => {
            say::warn(format_args!("error: {error}"));
            1
        }
    };
    std::process::exit(code.into());
}

/// Serves a process of participants, as its environment says; returns the exit status.
pub fn serve_role(name: &str, isa: Isa) -> u8 {
    tracing_subscriber::fmt().with_writer(std::io::stderr).with_ansi(false).init();
    let process: Name = match name.parse() {
        Ok(process) => process,
        Err(error) => {
            say::warn(format_args!("error: {error}"));
            return 1;
        }
    };
    let launcher = parent_id();
    // In the form of the log's other lines.
    let said = format!("- ERROR {}: {process}: {}\n", module_path!(), no_room::REASON);
    if let Err(error) = no_room::prepare(said, None) {
        tracing::warn!("{process}: a want of shared memory would not be told: {error}");
    }
    let result = abort_flag()
        .map_err(|e| RoleError::Start(format!("cannot watch for signals: {e}")))
        .and_then(|abort| {
            serve_process(
                process,
                abort,
                |scene, places, folder, checkpoint| roles::members(scene, places, isa, folder, checkpoint),
                |folder, report| Ok(reports::write(folder, report)?),
                move |folder, part| timeline::keep(folder, process, process.as_str(), &part),
            )
        });
    match result {
        Ok(()) => 0,
        Err(error) => {
            // Without its launcher a role hears of the end from the system, or from another role that was faster.
            let of_others = matches!(error, RoleError::Link(_) | RoleError::PeerEnded { .. });
            if of_others && parent_id() != launcher {
                tracing::error!("{process}: the coupler is gone, and its roles go with it ({error})");
            } else {
                tracing::error!("{process}: {error}");
            }
            2
        }
    }
}
