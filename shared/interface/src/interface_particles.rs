//! One side's record as columns in row order.

use halfstep_sph::columns::bounds;
use halfstep_sph::neighbours::{PADDING, Rows};
use halfstep_wire::protocol::StateRecord;
use halfstep_wire::wire_component;

/// The interface particles of one phase, sorted into rows.
#[derive(Clone, Debug)]
pub struct InterfaceParticles<const D: usize> {
    /// Position, m.
    pub position: [Vec<f64>; D],
    /// Velocity, m/s.
    pub velocity: [Vec<f64>; D],
    /// Density that the other phase sees, kg/m³.
    pub density: Vec<f64>,
    /// Pressure that the other phase sees, Pa.
    pub pressure: Vec<f64>,
    /// Mass that the other phase sees, kg (2D: kg/m).
    pub mass: Vec<f64>,
    /// The particle's own mass, kg (2D: kg/m).
    pub own_mass: Vec<f64>,
    /// sigma_ab / rho² (symmetric; a <= b filled).
    pub stress_term: [[Vec<f64>; D]; D],
    /// Position when the lists were made, m.
    pub(super) reference: [Vec<f64>; D],
    /// Record number of a slot.
    pub(super) record: Vec<u32>,
    pub(super) records: usize,
    pub(super) rows: Rows<D>,
}

impl<const D: usize> Default for InterfaceParticles<D> {
    fn default() -> Self {
        let columns = || std::array::from_fn(|_| Vec::new());
        Self {
            position: columns(),
            velocity: columns(),
            density: Vec::new(),
            pressure: Vec::new(),
            mass: Vec::new(),
            own_mass: Vec::new(),
            stress_term: std::array::from_fn(|_| columns()),
            reference: columns(),
            record: Vec::new(),
            records: 0,
            rows: Rows::default(),
        }
    }
}

impl<const D: usize> InterfaceParticles<D> {
    /// Number of records.
    pub fn records(&self) -> usize {
        self.records
    }

    /// The order of the slots.
    pub fn rows(&self) -> &Rows<D> {
        &self.rows
    }

    /// Record number of a slot, or [`PADDING`].
    pub fn record_of(&self, slot: usize) -> u32 {
        self.record[slot]
    }

    /// Slots that hold a particle, with its record number.
    pub fn slots(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.record.iter().enumerate().filter(|&(_, &r)| r != PADDING).map(|(slot, &r)| (slot, r as usize))
    }

    pub(super) fn sort(&mut self, records: &[StateRecord], height: f64) {
        self.records = records.len();
        self.record.clear();
        self.record.extend(0..records.len() as u32);
        for d in 0..D {
            self.position[d].clear();
            self.position[d].extend(records.iter().map(|r| r.position[d]));
        }
        let (low, high) = bounds(&self.position);
        self.rows.sort(&self.position, &self.record, height, low, high);
        for column in &mut self.position {
            self.rows.permute(column);
        }
        self.rows.permute_ids(&mut self.record);
        for d in 0..D {
            self.reference[d].clone_from(&self.position[d]);
        }
        self.fit_columns();
        self.load(records);
    }

    /// Fits the columns that [`Self::load`] fills to the slots.
    pub(super) fn fit_columns(&mut self) {
        let slots = self.rows.slots();
        for d in 0..D {
            self.velocity[d].resize(slots, 0.0);
            for b in d..D {
                self.stress_term[d][b].resize(slots, 0.0);
            }
        }
        for column in [&mut self.density, &mut self.pressure, &mut self.mass, &mut self.own_mass] {
            column.resize(slots, 0.0);
        }
    }

    pub(super) fn load(&mut self, records: &[StateRecord]) {
        let mut last = 0;
        for slot in 0..self.record.len() {
            // A padding slot repeats the particle before it.
            if self.record[slot] != PADDING {
                last = self.record[slot] as usize;
            }
            let r = &records[last];
            for d in 0..D {
                self.position[d][slot] = r.position[d];
                self.velocity[d][slot] = r.velocity[d];
            }
            self.density[slot] = r.density;
            self.pressure[slot] = r.pressure;
            self.mass[slot] = r.mass;
            self.own_mass[slot] = r.mass;
            let inverse = 1.0 / (r.density * r.density);
            for a in 0..D {
                for b in a..D {
                    let s = r.deviatoric_stress[wire_component(a, b)];
                    let sigma = if a == b { s - r.pressure } else { s };
                    self.stress_term[a][b][slot] = sigma * inverse;
                }
            }
        }
    }

    /// Largest displacement since the lists were made, m.
    pub(super) fn displacement(&self) -> f64 {
        let mut largest = 0.0_f64;
        for slot in 0..self.record.len() {
            let r2: f64 = (0..D).map(|d| (self.position[d][slot] - self.reference[d][slot]).powi(2)).sum();
            largest = largest.max(r2);
        }
        largest.sqrt()
    }
}
