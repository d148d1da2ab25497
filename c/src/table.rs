//! The particles that the scene gives a solid: the file of the variable HALFSTEP_PARTICLES.

use crate::call::Fault;
use std::ops::Range;

/// Columns of the file.
const COLUMNS: usize = 11;

/// The file's rows, one after the other.
pub(crate) struct Table(Vec<f64>);

impl Table {
    /// Reads the file that the launcher names.
    pub(crate) fn read() -> Result<Self, Fault> {
        let path = std::env::var("HALFSTEP_PARTICLES").map_err(|_| {
            let how =
                "start it with `halfstep run SCENE --solid COMMAND`, or alone with `halfstep fake-fluid`";
            Fault::run(format!("HALFSTEP_PARTICLES is not set: this program is the solid of a run, {how}"))
        })?;
        let text = std::fs::read_to_string(&path).map_err(|e| Fault::run(format!("{path}: {e}")))?;
        Self::parse(&text).ok_or_else(|| Fault::run(format!("{path}: no table of particles")))
    }

    fn parse(text: &str) -> Option<Self> {
        let mut all = Vec::new();
        for line in text.lines().skip(1) {
            let before = all.len();
            for cell in line.split(',') {
                all.push(cell.parse().ok()?);
            }
            if all.len() != before + COLUMNS {
                return None;
            }
        }
        Some(Self(all))
    }

    pub(crate) fn count(&self) -> usize {
        self.0.len() / COLUMNS
    }

    pub(crate) fn column(&self, column: usize) -> impl Iterator<Item = f64> {
        self.0.iter().skip(column).step_by(COLUMNS).copied()
    }

    /// Copies some columns, row by row.
    pub(crate) fn copy(&self, columns: Range<usize>, to: &mut [f64]) {
        for (to, row) in to.chunks_exact_mut(columns.len()).zip(self.0.chunks_exact(COLUMNS)) {
            to.copy_from_slice(&row[columns.clone()]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_by_hand() {
        let table = Table::parse("x,y\n1,2,3,4,5,6,7,8,1,0,2\n-1e-3,0,0,0,0,0,7,9,0,0,2\n").unwrap();
        let mut position = [0.0; 6];
        table.copy(0..3, &mut position);
        assert_eq!((table.count(), position), (2, [1.0, 2.0, 3.0, -1e-3, 0.0, 0.0]));
        assert_eq!(table.column(7).collect::<Vec<_>>(), [8.0, 9.0]);
        assert!(Table::parse("x\n1,2\n").is_none() && Table::parse("x\n1,2,3,4,5,6,7,8,1,0,no\n").is_none());
    }
}
