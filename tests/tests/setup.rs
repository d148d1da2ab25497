//! `setup.sh` installs exactly what is missing, and says clearly what it cannot do. Every program it calls is a
//! stand-in.

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::PathBuf;
use std::process::Command;

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../setup.sh");

/// A machine that consists of stand-ins. `apt-get install` makes its packages' programs appear.
struct Machine {
    dir: tempfile::TempDir,
}

impl Machine {
    /// Has everything, and belongs to root.
    fn complete() -> Self {
        let machine = Self { dir: tempfile::tempdir().unwrap() };
        fs::create_dir(machine.bin()).unwrap();
        for tool in ["bash", "env"] {
            let from = ["/bin", "/usr/bin"].map(|folder| PathBuf::from(folder).join(tool));
            symlink(from.iter().find(|path| path.exists()).unwrap(), machine.bin().join(tool)).unwrap();
        }
        for tool in ["cargo", "cc", "make", "pkg-config", "valgrind", "python3"] {
            machine.program(tool, "exit 0");
        }
        machine.program("id", "echo 0");
        machine
            .program("apt-get", "echo \"apt-get $*\" >> \"$LOG\"; [ $2 = update ] || : > \"$LOG.installed\"");
        machine
    }

    fn bin(&self) -> PathBuf {
        self.dir.path().join("bin")
    }

    fn program(&self, name: &str, body: &str) {
        let path = self.bin().join(name);
        fs::write(&path, format!("#!/bin/bash\n{body}\n")).unwrap();
        fs::set_permissions(path, fs::Permissions::from_mode(0o755)).unwrap();
    }

    /// A program that fails until something was installed.
    fn needs_install(self, name: &str) -> Self {
        self.program(name, "[ -e \"$LOG.installed\" ]");
        self
    }

    fn without(self, name: &str) -> Self {
        fs::remove_file(self.bin().join(name)).unwrap();
        self
    }

    fn not_root(self) -> Self {
        self.program("id", "echo 1000");
        self
    }

    /// Exit status, what it said, and the calls of apt-get and sudo.
    fn set_up(&self) -> (Option<i32>, String, Vec<String>) {
        let log = self.dir.path().join("log");
        let output = Command::new("/bin/bash")
            .arg(SCRIPT)
            .env_clear()
            .env("PATH", self.bin())
            .env("HOME", self.dir.path())
            .env("LOG", &log)
            .stdin(std::process::Stdio::null())
            .output()
            .unwrap();
        let calls = fs::read_to_string(log).unwrap_or_default().lines().map(String::from).collect();
        (output.status.code(), String::from_utf8(output.stderr).unwrap(), calls)
    }
}

#[test]
fn a_complete_machine_is_left_alone() {
    assert_eq!(Machine::complete().set_up(), (Some(0), String::new(), vec![]));
}

#[test]
fn what_is_missing_is_installed_after_an_update_and_once() {
    let machine = Machine::complete().needs_install("pkg-config");
    let (status, _, calls) = machine.set_up();
    assert_eq!(status, Some(0));
    let install = "apt-get -qq install --yes --no-install-recommends libhdf5-dev";
    assert_eq!(calls, ["apt-get -qq update", install]);
    assert_eq!(machine.set_up().2, calls, "the second time there is nothing to do");
}

#[test]
fn each_missing_program_asks_for_its_packages() {
    for (program, packages) in [
        ("cc", "gcc libc6-dev"),
        ("make", "make"),
        ("pkg-config", "pkg-config libhdf5-dev"),
        ("python3", "python3 python3-venv"),
        ("valgrind", "valgrind"),
    ] {
        let (status, said, calls) = Machine::complete().without(program).set_up();
        assert!(calls[1].ends_with(&format!("--no-install-recommends {packages}")), "{calls:?}");
        // The stand-in of apt-get brings no program: that is noticed.
        assert_eq!(status, Some(1));
        assert!(said.contains("still missing"), "{said}");
    }
}

#[test]
fn sudo_is_used_where_it_works_without_a_terminal() {
    let machine = Machine::complete().needs_install("pkg-config").not_root();
    machine.program("sudo", "echo \"sudo $1\" >> \"$LOG\"; [ \"$1\" != -n ] || shift; \"$@\"");
    machine.program("true", "exit 0");
    let (status, _, calls) = machine.set_up();
    assert_eq!(status, Some(0));
    assert_eq!(calls[..3], ["sudo -n", "sudo apt-get", "apt-get -qq update"]);
    assert_eq!(calls[3], "sudo env");
}

#[test]
fn what_it_cannot_do_it_says() {
    let lacking = || Machine::complete().needs_install("pkg-config");
    let refusing = lacking().not_root();
    refusing.program("sudo", "exit 1");
    for (machine, word) in [
        (lacking().without("apt-get"), "no apt-get"),
        (lacking().not_root(), "apt-get install libhdf5-dev"),
        (refusing, "no right to install"),
        (Machine::complete().without("cargo"), "rustup"),
    ] {
        let (status, said, calls) = machine.set_up();
        assert_eq!((status, calls), (Some(1), vec![]));
        assert!(said.starts_with("setup: ") && said.contains(word), "{said}");
    }
}
