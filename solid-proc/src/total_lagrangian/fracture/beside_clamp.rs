//! Damage beside a rigid clamp.
//!
//! F of a particle beside a clamp is a mean over both its sides, of which the clamp's, half as wide, counts with the
//! gain 2. It does not tell where a crack opens, nor whether the particle goes into its clamp.
//!
//! **Where it opens.** A crack along the clamp by w gives the first row a strain of w / dx, one beyond that row one of
//! w / 2 dx. With the opening that free neighbours show counted twice, both are w / dx: the band of dx takes G_f of the
//! one, and half of it of the other, whose other half the second row takes.
//!
//! **Into the clamp.** u = 2 u_clamp - u_next is free of strain, and damage takes the hourglass resistance that held
//! against it. So what a damaged particle approaches the clamp along a pair, n = X_ij / R_ij, has the energy
//!   E_i = 1/2 V0 (alpha G - a_i) sum_j w min(beta u_ij . n, 0)²,   j clamped,
//! with what damage has taken of the hourglass modulus; the force is its derivative. It comes on top of what F sees
//! where a damaged particle is pressed on its clamp.
//!
//! **Off the clamp.** Where a clamp's face crosses the rows, a crack along the face may break what lies next to it and
//! leave particles of the next row intact, which go on pulling at the clamp with their hourglass resistance.

use super::Fracture;
use super::cuts::LET_GO;
use super::principal::principal;
use crate::total_lagrangian::model::TotalLagrangian;
use crate::total_lagrangian::pass::Acceleration;
use halfstep_sph::lane::LANES;
use nalgebra::SVector;

impl<const D: usize> TotalLagrangian<D> {
    /// u_i - u_j, m.
    fn displaced(&self, i: usize, j: usize) -> SVector<f64, D> {
        SVector::from_fn(|d, _| self.now.displacement[d][i] - self.now.displacement[d][j])
    }

    /// Part of the largest principal strain that a crack on the free side of a particle beside a clamp gives; of all
    /// others zero. `elastic` is the strain by the stress that is left, half of which each side shows.
    pub(super) fn opening_inside(&self, slot: usize, elastic: f64) -> f64 {
        match &self.fracture {
            Some(fracture) if fracture.beside_clamp[slot] => {
                (self.strain_inside(slot) - 0.5 * elastic).max(0.0)
            }
            _ => 0.0,
        }
    }

    /// Part of the strain along the largest stretch, N, that free neighbours show. m = F N / |F N|:
    ///   m . sum w x_ij (x) X_ij L N - N . sum w X_ij (x) X_ij L N.
    pub(super) fn strain_inside(&self, slot: usize) -> f64 {
        let f = &self.gradient[slot];
        let (squares, directions) = principal(&(f.transpose() * f));
        let most = (1..D).fold(0, |most, k| if squares[k] > squares[most] { k } else { most });
        let reference: SVector<f64, D> = directions.column(most).into_owned();
        let (present, row) = ((f * reference).normalize(), self.correction[slot] * reference);
        let free = self.pairs.neighbours(slot).filter(|&(j, _)| !self.is_rigid(j));
        let strain = free.map(|(j, slope)| {
            let apart = self.apart(slot, j);
            let (now, then) = (present.dot(&(apart + self.displaced(slot, j))), reference.dot(&apart));
            -self.volume * slope * (now - then) * apart.dot(&row)
        });
        strain.sum()
    }

    /// Adds to `torn` what holds neighbours of broken particles that are not broken on their clamps: the pairs that are
    /// longer than F tells, by as much as lets go of a broken particle. Of an opening a pair of length R shows dx / R.
    pub(super) fn leave_clamps(&self, fracture: &Fracture<D>, broken: &[usize], torn: &mut Vec<[usize; 2]>) {
        let holds = |&slot: &usize| {
            let free = fracture.beside_clamp[slot] && self.is_free(slot) && self.has_strain(slot);
            free && !fracture.is_broken(slot)
        };
        for i in broken.iter().flat_map(|&slot| self.pairs.list().of(slot)).filter(holds) {
            let most = LET_GO * fracture.broken_opening(i) * self.spacing;
            for (j, _) in self.pairs.neighbours(i).filter(|&(j, _)| self.is_rigid(j)) {
                let then = self.apart(i, j);
                let now = (then + self.displaced(i, j)).norm();
                // A squeeze shows the pair less than F, whose gain is the clamp's: that opens nothing.
                let closed = (self.gradient[i] * then).norm().max(then.norm());
                if now - closed > most / then.norm() {
                    torn.push([i.min(j), i.max(j)]);
                }
            }
        }
    }

    /// The slot has a damaged particle beside a clamp, with a deformation gradient.
    fn may_go_into_clamp(&self, fracture: &Fracture<D>, slot: usize) -> bool {
        fracture.beside_clamp[slot] && fracture.damage[slot] > 0.0 && self.has_strain(slot)
    }

    /// What keeps a damaged particle out of its clamp, pair by pair: the clamped slot, stiffness per volume, Pa/m², and
    /// way into the clamp, m.
    fn ways_into_clamp(&self, slot: usize) -> impl Iterator<Item = (usize, f64, SVector<f64, D>)> + '_ {
        let taken = self.hourglass_modulus - self.hourglass[slot];
        let gain = 1.0 + self.fixed.excess_gain[slot];
        let clamped = self.pairs.neighbours(slot).filter(|&(j, _)| self.is_rigid(j));
        clamped.filter_map(move |(j, slope)| {
            let n = self.apart(slot, j).normalize();
            let way = gain * self.displaced(slot, j).dot(&n);
            (way < 0.0).then(|| (j, -self.volume * slope * taken, n * way))
        })
    }

    /// Energy of what keeps the particle at a slot out of its clamp, J (2D: J/m).
    pub(in crate::total_lagrangian) fn energy_beside_clamp(&self, slot: usize) -> f64 {
        if !self.fracture.as_ref().is_some_and(|fracture| self.may_go_into_clamp(fracture, slot)) {
            return 0.0;
        }
        self.ways_into_clamp(slot)
            .map(|(_, stiffness, way)| 0.5 * self.volume * stiffness * way.norm_squared())
            .sum()
    }

    /// Adds what keeps damaged particles out of their clamps to the sums of the second pass, m/s².
    pub(in crate::total_lagrangian) fn keep_out_of_clamps(&self, sums: &mut [Acceleration<D>]) {
        let mut add = |slot: usize, a: &SVector<f64, D>| {
            for (sum, a) in sums[slot / LANES].0.iter_mut().zip(a) {
                sum.0[slot % LANES] += a;
            }
        };
        let Some(fracture) = &self.fracture else { return };
        for &slot in fracture.damaged.iter().filter(|&&slot| self.may_go_into_clamp(fracture, slot)) {
            for (j, stiffness, way) in self.ways_into_clamp(slot) {
                let gain = 1.0 + self.fixed.excess_gain[slot];
                let a = way * (gain * stiffness / self.material.density);
                add(slot, &-a);
                add(j, &a);
            }
        }
    }
}
