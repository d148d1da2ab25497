//! Thin plates with fluid on both faces: each face shows a state of its own.
//!
//! A particle s of a plate belongs to the plate's middle, o_s behind it along the unit normal n_s. Fluid at x_f stands
//! on the side of the normal with the share
//!   chi = 1/2 + [ o_s + n_s . (x_f - x_s) ] / dx, at least 0 and at most 1,
//! which is 0 or 1 along the faces and goes over from one to the other beyond the plate's end. s extrapolates one
//! pressure from each side, with the weights chi W and (1 - chi) W, and shows fluid the state
//! chi (...)_+ + (1 - chi) (...)_-.
//!
//! The normal is carried along with the plate's material (Nanson): from the positions X at the first half-step and x
//! now of the plate's particles j within 2h,
//!   n_s = F^-T N_s / |F^-T N_s|,  F = A M^-1,
//!   A = sum_j (x_j - x_s) (X_j - X_s)^T,  M = sum_j (X_j - X_s) (X_j - X_s)^T.
//! Where the plate can break, j are the particles of the same piece, and one on a line (in space in a plane) has no
//! normal.
//! Fluid and coupler have the same records, so they have the same normals without a message. Solid particles of no thin
//! plate have n = 0, o = 0: half of everything on either side, which is the one state that they show.

mod pieces;

use super::faces::{Faces, between};
use super::moving_wall::{WallPressure, extrapolated, extrapolation};
use super::{Interface, InterfaceParticles, Parameters};
use halfstep_sph::extrapolation::{Extrapolation, ExtrapolationSum};
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, LANES, Lanes};
use halfstep_sph::neighbours::PADDING;
use halfstep_sph::pair::{self, PairLaw, dot};
use halfstep_sph::tensor;
use halfstep_sph::with_kernel;
use halfstep_wire::protocol::StateRecord;
use nalgebra::{SMatrix, SVector};
use pieces::Pieces;

/// det M over that of an even arrangement below which particles lie on a line (in space in a plane).
const FLAT: f64 = 1e-6;

/// One face of the plates: pressures there, by slot of the solid.
#[derive(Clone, Debug, Default)]
pub(super) struct Face {
    /// p / rho².
    pub(super) pressure_term: Vec<f64>,
    /// m / rho, m³ (2D: m²).
    pub(super) volume: Vec<f64>,
}

/// The faces of the thin plates.
#[derive(Clone, Debug)]
pub(super) struct Screen<const D: usize> {
    /// Positions of the records at the first half-step, m.
    first: Vec<SVector<f64, D>>,
    /// And now; beside each other, since each is read for all of its neighbours.
    now: Vec<SVector<f64, D>>,
    material: Vec<Material<D>>,
    neighbours: Vec<u32>,
    /// Of a solid that can break.
    pieces: Option<Pieces<D>>,
    /// n_s by slot.
    pub(super) normal: [Vec<f64>; D],
    /// o_s by slot, m.
    before: Vec<f64>,
    /// Against the normal, and along it.
    pub(super) faces: [Face; 2],
    sums: Vec<[ExtrapolationSum; 2]>,
}

/// A solid record at the first half-step.
#[derive(Clone, Copy, Debug)]
struct Material<const D: usize> {
    /// N_s.
    across: SVector<f64, D>,
    /// M N_s; zero where there is no thin plate.
    normal: SVector<f64, D>,
    before: f64,
    /// End of its neighbours.
    end: u32,
}

impl<const D: usize> Screen<D> {
    /// From the positions of the solid's records at the first half-step.
    pub(super) fn new(parameters: &Parameters<D>, x: &[[f64; D]]) -> Self {
        let reach = 2.0 * parameters.smoothing_length;
        let plate_of = |x: &[f64; D]| parameters.thin_plates.iter().position(|p| p.holds(x));
        let plates: Vec<Option<usize>> = x.iter().map(plate_of).collect();
        let mut order: Vec<usize> = (0..x.len()).collect();
        let widest = widest_axis(x);
        order.sort_by(|&a, &b| x[a][widest].total_cmp(&x[b][widest]));
        let mut place = vec![0; x.len()];
        order.iter().enumerate().for_each(|(k, &i)| place[i] = k);
        let first: Vec<SVector<f64, D>> = x.iter().map(|&x| x.into()).collect();
        let (mut material, mut neighbours) = (Vec::with_capacity(x.len()), Vec::new());
        for i in 0..x.len() {
            let (mut moment, mut normal, mut before) = (SMatrix::zeros(), [0.0; D], 0.0);
            if let Some(plate) = plates[i] {
                (normal, before) = parameters.thin_plates[plate].across(&x[i]);
                let near = |&j: &usize| (x[j][widest] - x[i][widest]).abs() <= reach;
                let below = order[..place[i]].iter().copied().rev().take_while(near);
                let above = order[place[i] + 1..].iter().copied().take_while(near);
                for j in below.chain(above).filter(|&j| plates[j] == plates[i]) {
                    let apart = first[j] - first[i];
                    if apart.norm() <= reach {
                        moment += apart * apart.transpose();
                        neighbours.push(j as u32);
                    }
                }
            }
            let end = neighbours.len() as u32;
            let across = SVector::from(normal);
            material.push(Material { across, normal: moment * across, before, end });
        }
        let pieces = parameters.torn.map(|torn| {
            Pieces::new(first.clone(), torn, reach, |record| &neighbours[range(&material, record)])
        });
        Self {
            now: Vec::with_capacity(first.len()),
            first,
            material,
            neighbours,
            pieces,
            normal: std::array::from_fn(|_| Vec::new()),
            before: Vec::new(),
            faces: Default::default(),
            sums: Vec::new(),
        }
    }

    /// Positions of the solid's records at the first half-step.
    pub(super) fn first_positions(&self) -> Vec<[f64; D]> {
        self.first.iter().map(|&x| x.into()).collect()
    }

    /// Number of the solid's records.
    pub(super) fn records(&self) -> usize {
        self.material.len()
    }

    /// The unit normal of a record's plate; zero where it has none.
    fn normal(&mut self, record: usize) -> SVector<f64, D> {
        let own = &self.material[record];
        let (then, here) = (self.first[record], self.now[record]);
        let neighbours = &self.neighbours[range(&self.material, record)];
        let mut piece = self.pieces.as_mut().filter(|_| !neighbours.is_empty());
        if let Some(pieces) = &mut piece {
            pieces.gather(record, |j| self.now[j]);
        }
        let mut moment = SMatrix::<f64, D, D>::zeros();
        let mut first = SMatrix::<f64, D, D>::zeros();
        for j in neighbours.iter().map(|&j| j as usize) {
            let apart = self.first[j] - then;
            match &piece {
                Some(pieces) if !pieces.holds(j) => continue,
                Some(_) => first += apart * apart.transpose(),
                None => {}
            }
            moment += (self.now[j] - here) * apart.transpose();
        }
        let even = (first.trace() / D as f64).powi(D as i32);
        if piece.is_some() && tensor::determinant(&first) <= FLAT * even {
            return SVector::zeros();
        }
        let carried = if piece.is_some() { first * own.across } else { own.normal };
        let inverse = tensor::inverse(&moment, tensor::determinant(&moment));
        let normal = inverse.map_or_else(SVector::zeros, |inverse| inverse.transpose() * carried);
        let length = normal.norm();
        if length > 0.0 { normal / length } else { SVector::zeros() }
    }

    /// Where the faces are now.
    fn carry(&mut self, solid: &InterfaceParticles<D>, records: &[StateRecord]) {
        let slots = solid.density.len();
        self.now.clear();
        self.now.extend(records.iter().map(|r| SVector::from_fn(|d, _| r.position[d])));
        for column in self.normal.iter_mut().chain([&mut self.before]) {
            column.resize(slots, 0.0);
        }
        let (mut normal, mut before) = (SVector::<f64, D>::zeros(), 0.0);
        for slot in 0..slots {
            // A padding slot repeats the particle before it.
            if solid.record_of(slot) != PADDING {
                let record = solid.record_of(slot) as usize;
                normal = self.normal(record);
                before = if normal.norm() > 0.0 { self.material[record].before } else { 0.0 };
            }
            for d in 0..D {
                self.normal[d][slot] = normal[d];
            }
            self.before[slot] = before;
        }
    }

    /// Pressures at both faces of the plates.
    pub(super) fn wall(&self, interface: &Interface<D>) -> TwoFaces<'_, D> {
        let sharpness = 1.0 / interface.parameters.resolution;
        TwoFaces { normal: &self.normal, before: &self.before, faces: &self.faces, sharpness }
    }
}

/// Where the neighbours of a record are.
fn range<const D: usize>(material: &[Material<D>], record: usize) -> std::ops::Range<usize> {
    let start = if record == 0 { 0 } else { material[record - 1].end };
    start as usize..material[record].end as usize
}

/// The axis along which points spread most.
fn widest_axis<const D: usize>(x: &[[f64; D]]) -> usize {
    let spread = |d: usize| {
        let (low, high) =
            x.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (x[d].min(low), x[d].max(high)));
        high - low
    };
    (0..D).max_by(|&a, &b| spread(a).total_cmp(&spread(b))).unwrap_or(0)
}

/// chi: the share of the normal's side that fluid has.
#[inline(always)]
fn share<const D: usize, A: Arch, L: Lanes>(
    normal: [L; D],
    before: L,
    to_fluid: [L; D],
    sharpness: f64,
) -> L {
    let height = before + dot::<D, A, L>(normal, to_fluid);
    let share = A::mul_add(height, L::splat(sharpness), L::splat(0.5));
    share.max(L::ZERO).min(L::splat(1.0))
}

/// A state on each side.
#[derive(Clone, Copy)]
pub(super) struct TwoFaces<'a, const D: usize> {
    normal: &'a [Vec<f64>; D],
    before: &'a [f64],
    faces: &'a [Face; 2],
    /// 1 / dx, 1/m.
    sharpness: f64,
}

/// Of several solid particles.
#[derive(Clone, Copy)]
pub(super) struct Own<L, const D: usize> {
    normal: [L; D],
    before: L,
    pressure_term: [L; 2],
}

impl<const D: usize> WallPressure<D> for TwoFaces<'_, D> {
    type Own<L: Lanes> = Own<L, D>;

    #[inline(always)]
    fn own<L: Lanes>(&self, slot: usize) -> Own<L, D> {
        Own {
            normal: std::array::from_fn(|d| L::load(&self.normal[d], slot)),
            before: L::load(self.before, slot),
            pressure_term: std::array::from_fn(|k| L::load(&self.faces[k].pressure_term, slot)),
        }
    }
    #[inline(always)]
    fn of<A: Arch, L: Lanes>(&self, own: &Own<L, D>, to_fluid: [L; D]) -> L {
        between::<A, L>(own.pressure_term, self.share_of::<A, L>(&(own.normal, own.before), to_fluid))
    }
    #[inline(always)]
    fn to<A: Arch, L: Lanes>(&self, j: usize, to_fluid: [L; D]) -> (L, L) {
        let share = self.share_at::<A, L>(j, to_fluid);
        let [against, along] = self.faces;
        let both = |a: &[f64], b: &[f64]| between::<A, L>([L::splat(a[j]), L::splat(b[j])], share);
        (both(&against.pressure_term, &along.pressure_term), both(&against.volume, &along.volume))
    }
    fn pressure_terms(&self, slot: usize) -> [f64; 2] {
        std::array::from_fn(|side| self.faces[side].pressure_term[slot])
    }
}

impl<const D: usize> Faces<D> for TwoFaces<'_, D> {
    /// n and o.
    type Own<L: Lanes> = ([L; D], L);

    #[inline(always)]
    fn load<L: Lanes>(&self, slot: usize) -> Self::Own<L> {
        (std::array::from_fn(|d| L::load(&self.normal[d], slot)), L::load(self.before, slot))
    }
    #[inline(always)]
    fn share_of<A: Arch, L: Lanes>(&self, own: &Self::Own<L>, to_fluid: [L; D]) -> L {
        share::<D, A, L>(own.0, own.1, to_fluid, self.sharpness)
    }
    #[inline(always)]
    fn share_at<A: Arch, L: Lanes>(&self, j: usize, to_fluid: [L; D]) -> L {
        let normal = std::array::from_fn(|d| L::splat(self.normal[d][j]));
        share::<D, A, L>(normal, L::splat(self.before[j]), to_fluid, self.sharpness)
    }
}

/// The law of the pass over the solid: a pressure from each side.
struct FromTwoFaces<'a, K, const D: usize> {
    extrapolation: Extrapolation<'a, K, D>,
    wall: TwoFaces<'a, D>,
}

impl<K: Kernel<D>, const D: usize> PairLaw<D> for FromTwoFaces<'_, K, D> {
    type Target<L: Lanes> = ([L; D], L);
    type Sum<L: Lanes> = [ExtrapolationSum<L>; 2];

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        self.extrapolation.targets
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        std::array::from_fn(|d| self.extrapolation.sources[d][j])
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> Self::Target<L> {
        let normal = std::array::from_fn(|d| L::load(&self.wall.normal[d], slot));
        (normal, L::load(self.wall.before, slot))
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        i: &Self::Target<L>,
        j: usize,
        dx: [L; D],
        r2: L,
        sum: &mut Self::Sum<L>,
    ) {
        let (w, p) = self.extrapolation.source::<A, L>(j, dx, r2);
        let along = w * share::<D, A, L>(i.0, i.1, dx.map(|x| -x), self.wall.sharpness);
        sum[0].add::<A>(w - along, p);
        sum[1].add::<A>(along, p);
    }
}

/// Pressure at each face of the plates, from the records of both phases.
pub(super) fn show_pressures<const D: usize>(interface: &mut Interface<D>, records: &[StateRecord]) {
    let positions =
        || -> Vec<[f64; D]> { records.iter().map(|r| std::array::from_fn(|d| r.position[d])).collect() };
    let mut screen =
        interface.screen.take().unwrap_or_else(|| Screen::new(&interface.parameters, &positions()));
    screen.carry(&interface.solid, records);
    let mut sums = std::mem::take(&mut screen.sums);
    sums.resize(interface.solid_list.fours(), Default::default());
    let p = &interface.parameters;
    with_kernel!(p.kernel, p.smoothing_length, D, |kernel| {
        let law =
            FromTwoFaces { extrapolation: extrapolation(interface, kernel), wall: screen.wall(interface) };
        pair::pass(p.isa, &law, &interface.solid_list, &mut sums);
    });
    let displaced = p.fluid.density / p.solid_density;
    let solid = &mut interface.solid;
    for face in &mut screen.faces {
        face.pressure_term.resize(solid.density.len(), 0.0);
        face.volume.resize(solid.density.len(), 0.0);
    }
    for slot in 0..solid.density.len() {
        let mass = solid.own_mass[slot] * displaced;
        let mut mean = 0.0;
        for (face, sum) in screen.faces.iter_mut().zip(sums[slot / LANES]) {
            let pressure = extrapolated(p, &sum, slot % LANES);
            let density = p.fluid.density_at(pressure);
            face.pressure_term[slot] = pressure / (density * density);
            face.volume[slot] = mass / density;
            mean += 0.5 * pressure;
        }
        // The cross-phase viscosity asks for one density; the faces' differ by less than the fluid is compressible.
        solid.pressure[slot] = mean;
        solid.density[slot] = p.fluid.density_at(mean);
        solid.mass[slot] = mass;
    }
    screen.sums = sums;
    interface.screen = Some(screen);
}
