//! Stress of every particle, from the sums of the first pass: each hangs on its own sums alone, so threads share them.

use super::bounds::keep_worse;
use super::evaluate::at;
use super::fracture::Fracture;
use super::material::Matrix;
use super::model::TotalLagrangian;
use super::pass::Matrices;
use super::relaxation::Relaxation;
use crate::columns::vectors;
use halfstep_scene::bounds::Excess;
use halfstep_sph::lane::LANES;
use halfstep_sph::neighbours::PADDING;

/// Slots that one thread takes at a time.
pub(super) const TASK: usize = 256;

/// Columns of neighbouring slots.
struct Part<'a, const D: usize> {
    /// Slot of the first entries.
    first: usize,
    gradient: &'a mut [Matrix<D>],
    volume_ratio: &'a mut [f64],
    bracket: [[&'a mut [f64]; D]; D],
}

/// What the stresses of a part have shown.
#[derive(Default)]
struct Seen {
    /// Of particles whose volume left its bounds the one farthest out.
    worst: Option<(u32, Excess)>,
    /// Slots where damage may grow, ascending.
    candidates: Vec<usize>,
}

impl Seen {
    /// Of a part and the one that follows it.
    fn and(mut self, mut next: Self) -> Self {
        if let Some((particle, excess)) = next.worst {
            keep_worse(&mut self.worst, particle, Some(excess));
        }
        self.candidates.append(&mut next.candidates);
        self
    }
}

impl<'a, const D: usize> Part<'a, D> {
    fn whole(
        gradient: &'a mut [Matrix<D>],
        volume_ratio: &'a mut [f64],
        bracket: &'a mut Matrices<D>,
    ) -> Self {
        let bracket = bracket.each_mut().map(|row| row.each_mut().map(Vec::as_mut_slice));
        Self { first: 0, gradient, volume_ratio, bracket }
    }

    fn split(self, at: usize) -> (Self, Self) {
        let (gradient, more_gradient) = self.gradient.split_at_mut(at);
        let (volume_ratio, more_volume_ratio) = self.volume_ratio.split_at_mut(at);
        let mut more_bracket = [(); D].map(|()| [(); D].map(|()| <&mut [f64]>::default()));
        let mut bracket = self.bracket;
        for (column, more) in bracket.as_flattened_mut().iter_mut().zip(more_bracket.as_flattened_mut()) {
            (*column, *more) = std::mem::take(column).split_at_mut(at);
        }
        let rest = Self {
            first: self.first + at,
            gradient: more_gradient,
            volume_ratio: more_volume_ratio,
            bracket: more_bracket,
        };
        (Self { gradient, volume_ratio, bracket, ..self }, rest)
    }

    /// Fills the part with what `model` has summed; its own columns are here meanwhile.
    fn fill<R: Relaxation<D>>(self, model: &TotalLagrangian<D>, relaxation: &mut R) -> Seen {
        let screen = model.fracture.as_ref().map_or(f64::INFINITY, Fracture::screen);
        let Self { first, gradient, volume_ratio, mut bracket } = self;
        let mut seen = Seen::default();
        for k in 0..gradient.len() {
            let slot = first + k;
            if model.id[slot] == PADDING {
                continue;
            }
            let correction = model.correction[slot];
            let h = at(&model.deformations[slot / LANES].gradient, slot % LANES) * correction;
            let f = Matrix::identity() + h;
            let j = model.law.volume_ratio(&f);
            keep_worse(&mut seen.worst, model.id[slot], model.bounds.excess(j, 0.0));
            let mut p = model.stress_at(slot, &f, j);
            let tense = screen < f64::INFINITY && (p.norm_squared() > screen || model.damage_at(slot) > 0.0);
            if tense && model.fixed.clamped[slot] == 0.0 {
                seen.candidates.push(slot);
            }
            if R::ACTS {
                p += f * relaxation.advance(slot, &f);
            }
            let b = p * correction - h * model.hourglass[slot];
            gradient[k] = f;
            volume_ratio[k] = j;
            for (row, entries) in bracket.iter_mut().enumerate() {
                for (column, entries) in entries.iter_mut().enumerate() {
                    entries[k] = b[(row, column)];
                }
            }
        }
        seen
    }

    /// The same, by as many threads as there are.
    fn share(self, model: &TotalLagrangian<D>) -> Seen {
        let slots = self.gradient.len();
        if slots <= TASK {
            return self.fill(model, &mut ());
        }
        let (left, right) = self.split(slots.div_ceil(2));
        let (seen, next) = rayon::join(|| left.share(model), || right.share(model));
        seen.and(next)
    }
}

impl<const D: usize> TotalLagrangian<D> {
    /// F of every particle from the sums of the first pass, and the second pass' brackets. Of the first evaluation
    /// in which volumes leave their bounds, the one farthest out is kept in `failure`.
    pub(super) fn stresses<R: Relaxation<D>>(&mut self, relaxation: &mut R) {
        let mut gradient = std::mem::take(&mut self.gradient);
        let mut volume_ratio = std::mem::take(&mut self.volume_ratio);
        let mut bracket = std::mem::replace(&mut self.bracket, std::array::from_fn(|_| vectors(0)));
        let part = Part::whole(&mut gradient, &mut volume_ratio, &mut bracket);
        // What arms lose is summed in the order of slots.
        let seen = if R::ACTS { part.fill(self, relaxation) } else { part.share(self) };
        (self.gradient, self.volume_ratio, self.bracket) = (gradient, volume_ratio, bracket);
        self.failure = self.failure.or(seen.worst);
        self.grow(seen.candidates);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_neighbours() {
        let mut gradient: Vec<_> = (0..5).map(|k| Matrix::<2>::repeat(f64::from(k))).collect();
        let mut volume_ratio: Vec<_> = (0..5).map(f64::from).collect();
        let mut bracket: Matrices<2> = [0, 1].map(|a| [0, 1].map(|b| vec![f64::from(2 * a + b); 5]));
        let (left, right) = Part::whole(&mut gradient, &mut volume_ratio, &mut bracket).split(3);
        assert_eq!((left.first, left.gradient.len(), left.volume_ratio.len()), (0, 3, 3));
        assert_eq!((right.first, right.gradient.len(), &*right.volume_ratio), (3, 2, &[3.0, 4.0][..]));
        assert_eq!(
            right.bracket.each_ref().map(|row| row.each_ref().map(|b| (b.len(), b[0]))),
            [[(2, 0.0), (2, 1.0)], [(2, 2.0), (2, 3.0)]]
        );
    }
}
