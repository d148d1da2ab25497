//! `probes.csv`: what is measured while the run goes on, one row an instant.

use super::OutputError;
use super::run_json::ProbeReport;
use super::series::is_at;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use xxhash_rust::xxh3::Xxh3;

/// Header of the first column.
pub const TIME_COLUMN: &str = "time [s]";
/// A row must fit into one write to the file, so that a reader never sees a part of it.
const ROW_CAPACITY: usize = 1 << 16;

/// Writes `probes.csv` row by row.
#[derive(Debug)]
pub struct ProbeLog {
    path: PathBuf,
    writer: csv::Writer<Hashed>,
    columns: usize,
}

/// What is on disk of a log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Logged {
    /// Length, bytes.
    pub bytes: u64,
    /// XXH3 (64 bit) of these bytes.
    pub hash: u64,
}

/// A file that knows the hash of what it holds.
struct Hashed {
    file: File,
    hash: Box<Xxh3>,
}

impl std::fmt::Debug for Hashed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Hashed").field("file", &self.file).finish_non_exhaustive()
    }
}

impl Write for Hashed {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let written = self.file.write(bytes)?;
        self.hash.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.file.flush()
    }
}

impl ProbeLog {
    /// Creates the file with the header `time [s]` and then `columns` (see [`halfstep_scene::Probe::columns`]).
    pub fn create(path: &Path, columns: &[String]) -> Result<Self, OutputError> {
        let file = File::create(path).map_err(OutputError::io("create", path))?;
        let mut writer = Self::writer(Hashed { file, hash: Box::default() });
        writer
            .write_record(std::iter::once(TIME_COLUMN).chain(columns.iter().map(String::as_str)))
            .and_then(|()| Ok(writer.flush()?))
            .map_err(|e| OutputError::Io { action: "write", path: path.into(), error: e.into() })?;
        Ok(Self { path: path.into(), writer, columns: columns.len() })
    }

    fn writer(file: Hashed) -> csv::Writer<Hashed> {
        csv::WriterBuilder::new().has_headers(false).buffer_capacity(ROW_CAPACITY).from_writer(file)
    }

    /// Opens the log of an interrupted run after what was `logged`; [`Self::forget_rest`] before the next row.
    ///
    /// # Errors
    /// The file is shorter, or has other columns or rows.
    pub fn resume(path: &Path, columns: &[String], logged: Logged) -> Result<Self, OutputError> {
        let length = logged.bytes;
        let table = read_probes(path)?;
        if table.columns.first().map(String::as_str) != Some(TIME_COLUMN) || table.columns[1..] != *columns {
            return Err(OutputError::malformed(path, "its columns are not the scene's probes"));
        }
        let mut file =
            File::options().read(true).write(true).open(path).map_err(OutputError::io("open", path))?;
        let found = file.metadata().map_err(OutputError::io("read", path))?.len();
        if found < length {
            let reason = format!("it has {found} bytes, and {length} at the checkpoint: rows are lost");
            return Err(OutputError::malformed(path, reason));
        }
        let mut hash = Box::<Xxh3>::default();
        let mut buffer = vec![0; ROW_CAPACITY];
        let mut rest = (&mut file).take(length);
        while let n @ 1.. = rest.read(&mut buffer).map_err(OutputError::io("read", path))? {
            hash.update(&buffer[..n]);
        }
        if hash.digest() != logged.hash {
            let reason = "its rows up to the checkpoint are not those that the run has written";
            return Err(OutputError::malformed(path, reason));
        }
        file.seek(SeekFrom::Start(length)).map_err(OutputError::io("read", path))?;
        Ok(Self { path: path.into(), writer: Self::writer(Hashed { file, hash }), columns: columns.len() })
    }

    /// Forgets the rows after the place where the log goes on.
    ///
    /// # Errors
    /// The file cannot be changed.
    pub fn forget_rest(&self) -> Result<(), OutputError> {
        let mut file = &self.writer.get_ref().file;
        let shortened = file.stream_position().and_then(|end| file.set_len(end));
        shortened.map_err(OutputError::io("shorten", &self.path))
    }

    /// What was written so far, with the guarantee that it outlives a crash of the machine.
    ///
    /// # Errors
    /// The disk refuses, or somebody has removed the file.
    pub fn synchronise(&self) -> Result<Logged, OutputError> {
        let Hashed { file, hash } = self.writer.get_ref();
        if !is_at(file, &self.path) {
            let reason = "it was removed or replaced while the run went on: its rows are lost";
            return Err(OutputError::malformed(&self.path, reason));
        }
        file.sync_data().map_err(OutputError::io("synchronise", &self.path))?;
        let bytes = file.metadata().map_err(OutputError::io("read", &self.path))?.len();
        Ok(Logged { bytes, hash: hash.digest() })
    }

    /// Appends the values at `time` (s), in the order and the units of the columns. The row is in the file when this
    /// returns; values read back bit for bit.
    pub fn row(&mut self, time: f64, values: &[f64]) -> Result<(), OutputError> {
        if values.len() != self.columns {
            let path = self.path.clone();
            return Err(OutputError::Columns { path, expected: self.columns, got: values.len() });
        }
        self.writer
            .serialize((time, values))
            .and_then(|()| Ok(self.writer.flush()?))
            .map_err(|e| OutputError::Io { action: "write", path: self.path.clone(), error: e.into() })
    }
}

/// A table of numbers with named columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Headers; the first is `time [s]`.
    pub columns: Vec<String>,
    /// Rows, each as long as `columns`.
    pub rows: Vec<Vec<f64>>,
}

impl Table {
    /// Position of a column: by its whole header, or by the header without its unit (`tip.x`).
    pub fn position(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column == name || split_unit(column).0 == name)
    }

    /// Values of a column, found as by [`Self::position`].
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        self.position(name).map(|k| self.rows.iter().map(|row| row[k]).collect())
    }

    /// Times, s.
    pub fn times(&self) -> Vec<f64> {
        self.rows.iter().map(|row| row[0]).collect()
    }
}

/// Splits a header `NAME [UNIT]` into name and unit; the unit is empty where there is none.
pub fn split_unit(header: &str) -> (&str, &str) {
    header
        .strip_suffix(']')
        .and_then(|rest| rest.rsplit_once(" ["))
        .map_or((header, ""), |(name, unit)| (name, unit))
}

/// Reads a `probes.csv`, also while it is being written: a last line that has no end yet is left out.
pub fn read_probes(path: &Path) -> Result<Table, OutputError> {
    let text = std::fs::read_to_string(path).map_err(OutputError::io("read", path))?;
    let whole = &text[..text.rfind('\n').map_or(0, |end| end + 1)];
    let mut reader = csv::Reader::from_reader(whole.as_bytes());
    let bad = |e: csv::Error| OutputError::malformed(path, e.to_string());
    let columns: Vec<String> = reader.headers().map_err(bad)?.iter().map(Into::into).collect();
    if columns.first().is_none_or(|first| first != TIME_COLUMN) {
        return Err(OutputError::malformed(path, format!("its first column is not '{TIME_COLUMN}'")));
    }
    let rows = reader.deserialize().collect::<Result<_, _>>().map_err(bad)?;
    Ok(Table { columns, rows })
}

/// The end and the extremes of each column of a `probes.csv`, read row by row; none where it has no rows.
pub fn summarise(path: &Path) -> Result<Vec<ProbeReport>, OutputError> {
    let bad = |e: csv::Error| OutputError::malformed(path, e.to_string());
    let mut reader = csv::Reader::from_path(path).map_err(bad)?;
    let named = |title: &str| {
        let (name, unit) = split_unit(title);
        ProbeReport { name: name.into(), unit: unit.into(), ..ProbeReport::default() }
    };
    let mut all: Vec<ProbeReport> = reader.headers().map_err(bad)?.iter().skip(1).map(named).collect();
    let mut rows = 0;
    for row in reader.deserialize() {
        let row: Vec<f64> = row.map_err(bad)?;
        let Some((&time, values)) = row.split_first() else { continue };
        rows += 1;
        for (report, &value) in all.iter_mut().zip(values) {
            report.end = (!value.is_nan()).then_some(value);
            if report.min.is_none_or(|min| value < min) && report.end.is_some() {
                (report.min, report.min_time) = (Some(value), Some(time));
            }
            if report.max.is_none_or(|max| value > max) && report.end.is_some() {
                (report.max, report.max_time) = (Some(value), Some(time));
            }
        }
    }
    Ok(if rows > 0 { all } else { Vec::new() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_have_their_end_and_their_extremes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("probes.csv");
        let columns = ["tip.x [m]", "w.bodies [1]"].map(String::from);
        let mut log = ProbeLog::create(&path, &columns).unwrap();
        assert_eq!(summarise(&path).unwrap(), []);
        for (time, x) in [(0.0, 0.5), (0.1, -2.0), (0.2, 3.0), (0.3, -2.0), (0.4, 1.0)] {
            log.row(time, &[x, f64::NAN]).unwrap();
        }
        let [tip, bodies] = summarise(&path).unwrap().try_into().unwrap();
        assert_eq!((tip.name.as_str(), tip.unit.as_str(), tip.end), ("tip.x", "m", Some(1.0)));
        assert_eq!(
            (tip.min, tip.min_time, tip.max, tip.max_time),
            (Some(-2.0), Some(0.1), Some(3.0), Some(0.2))
        );
        assert_eq!((bodies.end, bodies.min, bodies.max_time), (None, None, None));
    }

    #[test]
    fn values_read_back_bit_for_bit_while_the_log_is_open() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("probes.csv");
        let columns = ["tip.x [m]".to_string(), "a, \"b\" [Pa]".to_string()];
        let mut log = ProbeLog::create(&path, &columns).unwrap();
        assert_eq!(read_probes(&path).unwrap().rows.len(), 0);
        let rows = [[0.0, -0.0, 1.0 / 3.0], [1e-9, 5e-324, f64::MAX], [0.1 + 0.2, -1.5e-7, f64::INFINITY]];
        for (k, row) in rows.iter().enumerate() {
            log.row(row[0], &row[1..]).unwrap();
            let table = read_probes(&path).unwrap();
            assert_eq!(table.columns[1..], columns);
            assert_eq!(table.rows.len(), k + 1);
            let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&table.rows[k]), bits(row));
        }
        let table = read_probes(&path).unwrap();
        assert_eq!(table.column("tip.x").unwrap(), table.column("tip.x [m]").unwrap());
        assert_eq!(table.position("tip"), None);
        assert_eq!(table.times(), [0.0, 1e-9, 0.1 + 0.2]);
    }

    #[test]
    fn a_resumed_log_forgets_later_rows_and_goes_on() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("probes.csv");
        let columns = ["level [m]".to_string()];
        let mut log = ProbeLog::create(&path, &columns).unwrap();
        log.row(0.0, &[1.0]).unwrap();
        let length = log.synchronise().unwrap();
        log.row(0.1, &[2.0]).unwrap();
        drop(log);
        let mut log = ProbeLog::resume(&path, &columns, length).unwrap();
        assert_eq!(read_probes(&path).unwrap().rows, [[0.0, 1.0], [0.1, 2.0]], "it may yet be refused");
        log.forget_rest().unwrap();
        assert_eq!(read_probes(&path).unwrap().rows, [[0.0, 1.0]]);
        log.row(0.05, &[3.0]).unwrap();
        assert_eq!(read_probes(&path).unwrap().rows, [[0.0, 1.0], [0.05, 3.0]]);
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, text.replace("1.0", "1.5")).unwrap();
        let message = ProbeLog::resume(&path, &columns, length).unwrap_err().to_string();
        assert!(message.contains("are not those that the run has written"), "{message}");
        std::fs::write(&path, text).unwrap();
        let longer = Logged { bytes: 1000, ..length };
        let message = ProbeLog::resume(&path, &columns, longer).unwrap_err().to_string();
        assert!(message.contains("rows are lost"), "{message}");
        assert!(ProbeLog::resume(&path, &["other [m]".to_string()], length).is_err());
    }

    #[test]
    fn a_row_of_the_wrong_length_is_refused_and_not_written() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("probes.csv");
        let mut log = ProbeLog::create(&path, &["level.level [m]".into()]).unwrap();
        assert!(matches!(log.row(0.0, &[1.0, 2.0]), Err(OutputError::Columns { expected: 1, got: 2, .. })));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "time [s],level.level [m]\n");
    }

    #[test]
    fn an_unfinished_last_line_is_left_out_and_a_wrong_cell_is_named() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("probes.csv");
        std::fs::write(&path, "time [s],p [Pa]\n0.0,1.0\n0.1,2").unwrap();
        assert_eq!(read_probes(&path).unwrap().rows, [[0.0, 1.0]]);
        std::fs::write(&path, "time [s],p [Pa]\n0.0,water\n").unwrap();
        let message = read_probes(&path).unwrap_err().to_string();
        assert!(message.contains("probes.csv") && message.contains("line: 2"), "{message}");
        std::fs::write(&path, "t,p\n0.0,1.0\n").unwrap();
        assert!(read_probes(&path).unwrap_err().to_string().contains("first column"));
    }

    #[test]
    fn headers_split_into_name_and_unit() {
        assert_eq!(split_unit("tip.x [m]"), ("tip.x", "m"));
        assert_eq!(split_unit("ratio"), ("ratio", ""));
    }
}
