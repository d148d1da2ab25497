//! Reports of participants on their way to the coupler: one file each in the run's folder.

use halfstep_output::{OutputError, atomic};
use halfstep_role::report::Report;
use std::path::{Path, PathBuf};

/// Where the report of a participant lies.
pub fn path(folder: &Path, name: &str) -> PathBuf {
    folder.join(format!("report-{name}.json"))
}

/// Writes a report, whole or not at all.
///
/// # Errors
/// The file cannot be written.
pub fn write(folder: &Path, report: &Report) -> Result<(), OutputError> {
    let path = path(folder, &report.name);
    let malformed =
        |e: serde_json::Error| OutputError::Malformed { path: path.clone(), reason: e.to_string() };
    atomic::replace_bytes(&path, &serde_json::to_vec_pretty(report).map_err(malformed)?)
}

/// Reads the report of a participant; `None` where it left none, as an external solid may.
///
/// # Errors
/// There is a file that is no report.
pub fn read(folder: &Path, name: &str) -> Result<Option<Report>, OutputError> {
    let path = path(folder, name);
    let text = match std::fs::read(&path) {
        Ok(text) => text,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(OutputError::Io { action: "read", path, error }),
    };
    match serde_json::from_slice(&text) {
        Ok(report) => Ok(Some(report)),
        Err(e) => Err(OutputError::Malformed { path, reason: e.to_string() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_arrives_and_a_missing_one_is_none() {
        let folder = tempfile::tempdir().unwrap();
        let report = Report { name: "gate".into(), compute: 0.1, walls: 0.25, ..Report::default() };
        assert_eq!(read(folder.path(), "gate").unwrap(), None);
        write(folder.path(), &report).unwrap();
        assert_eq!(read(folder.path(), "gate").unwrap(), Some(report));
        std::fs::write(path(folder.path(), "gate"), "{").unwrap();
        assert!(read(folder.path(), "gate").is_err());
    }
}
