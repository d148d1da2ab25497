//! Memory of the fluid.

use crate::columns::{Columns, PairParticles};
use crate::effects::{Effects, FluidEffect};
use crate::fluid::Fluid;
use crate::walls::Walls;
use crate::walls::moving::Moving;

fn of<T>(column: &Vec<T>) -> usize {
    column.capacity() * size_of::<T>()
}

fn of_each<T, const D: usize>(columns: &[Vec<T>; D]) -> usize {
    columns.iter().map(of).sum()
}

impl<const D: usize> PairParticles<D> {
    fn bytes(&self) -> usize {
        of_each(&self.position) + of(&self.sources) + self.bytes_of_single()
    }
}

impl<const D: usize> Columns<D> {
    fn bytes(&self) -> usize {
        self.now.bytes()
            + of(&self.id)
            + of_each(&self.position_n)
            + of_each(&self.velocity_n)
            + of(&self.density_n)
            + of_each(&self.reference)
    }
}

impl<const D: usize> Walls<D> {
    fn bytes(&self) -> usize {
        self.shown.bytes()
            + of(&self.id)
            + of_each(&self.own_velocity)
            + of_each(&self.normal)
            + of(&self.reverse_all)
            + of(&self.depth)
            + of(&self.at_edge)
            + self.moving.as_ref().map_or(0, Moving::bytes)
            + self.rows.bytes()
    }
}

impl<const D: usize> Moving<D> {
    fn bytes(&self) -> usize {
        of(&self.shape) + [&self.initial, &self.surface, &self.normal].map(of_each).iter().sum::<usize>()
    }
}

impl<const D: usize, X: FluidEffect<D>> Fluid<D, X> {
    /// Bytes allocated for particles, sums, walls and neighbour lists.
    pub(crate) fn allocated(&self) -> usize {
        self.columns.bytes()
            + self.walls.as_ref().map_or(0, Walls::bytes)
            + self.rows.bytes()
            + [&self.fluid_list, &self.wall_list, &self.list_of_walls]
                .map(|l| l.bytes())
                .iter()
                .sum::<usize>()
            + of(&self.sums)
            + of(&self.predicted)
            + self.effects.bytes()
    }
}
