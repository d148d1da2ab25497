//! What the fluid keeps over an interruption at a state n: particles with the order of their slots, where they and the
//! walls were at the last sort, and the interface set. The rates' sums, the frozen density gradient and what walls show
//! belong to a step that has not begun; lists are made anew from where everything was at the last sort.

use crate::columns::{Columns, Source, fit};
use crate::effects::{Effects, FluidEffect};
use crate::fluid::Fluid;
use crate::interface::Coupling;
use crate::rates::RateSum;
use crate::walls::Walls;
use halfstep_scene::FluidIntegration;
use halfstep_sph::lane::LANES;
use halfstep_sph::neighbours::PADDING;
use halfstep_sph::state_equation::StateEquation;
use halfstep_wire::half_step::Stage;
use halfstep_wire::order;
use halfstep_wire::state::{Fields, State, StateError};

impl<const D: usize, X: FluidEffect<D>> State for Fluid<D, X> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        fields.part("particles", &mut self.columns)?;
        fields.real("displacement", &mut self.displacement)?;
        fields.real("largest_speed", &mut self.largest_speed)?;
        fields.real("largest_acceleration", &mut self.largest_acceleration)?;
        if self.integration == FluidIntegration::Verlet {
            fields.real("density_lag", &mut self.density_lag)?;
        }
        // The sums of the state are evaluated again.
        fields.count("pair_evaluations", &mut self.evaluations_before)?;
        if let Some(walls) = &mut self.walls {
            fields.part("walls", walls)?;
        }
        if let Some(coupling) = &mut self.coupling {
            fields.part("coupling", coupling)?;
        }
        if !self.riders.now.is_empty() {
            fields.part("riders", &mut self.riders)?;
        }
        if let Some(own) = &mut self.ledger {
            fields.part("energy", &mut own.ledger)?;
        }
        Ok(())
    }

    fn restored(&mut self) -> Result<(), StateError> {
        self.columns.restore(self.number_of_particles, &self.state)?;
        let Columns { reference, id, .. } = &self.columns;
        let (height, domain) = (2.0 * self.resolution, self.domain);
        order::sort_again(&mut self.rows, reference, id, height, domain, "the fluid's rows")?;
        if let Some(walls) = &mut self.walls {
            walls.restored()?;
        }
        self.list();
        if let Some(coupling) = &mut self.coupling {
            coupling.restored()?;
            coupling.check_slots(&self.columns)?;
        }
        self.riders.restored()?;
        fit(&mut self.sums, self.fluid_list.fours(), RateSum::default());
        self.effects.resize(self.columns.slots(), self.walls.as_ref());
        self.stage = Stage::First;
        self.pair_evaluations = self.evaluations_before;
        self.sorted = false;
        self.published = true;
        Ok(())
    }
}

impl<const D: usize> State for Columns<D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        let sources = &self.now.sources;
        let mut velocity = std::array::from_fn(|d| sources.iter().map(|s| s.velocity[d]).collect());
        let mut density: Vec<f64> = sources.iter().map(|s| s.density).collect();
        fields.numbers("id", &mut self.id)?;
        fields.vectors("position", &mut self.now.position)?;
        fields.vectors("velocity", &mut velocity)?;
        fields.reals("density", &mut density)?;
        fields.vectors("position_at_sort", &mut self.reference)?;
        if fields.loading() {
            let slots = self.id.len();
            fields.length("density", slots, density.len())?;
            for (name, columns) in [
                ("position", &self.now.position),
                ("velocity", &velocity),
                ("position_at_sort", &self.reference),
            ] {
                columns.iter().try_for_each(|c| fields.length(name, slots, c.len()))?;
            }
            // The state at n of a step is taken from the present state when the step begins.
            self.position_n = self.now.position.clone();
            self.density_n.clone_from(&density);
            let of = |slot: usize| Source {
                velocity: std::array::from_fn(|d| velocity[d][slot]),
                density: density[slot],
                ..Source::ZERO
            };
            self.now.sources = (0..slots).map(of).collect();
            self.velocity_n = velocity;
        }
        Ok(())
    }
}

impl<const D: usize> Columns<D> {
    /// What follows from the fields, for a scene that began with so many particles.
    fn restore(&mut self, number_of_particles: usize, state: &StateEquation) -> Result<(), StateError> {
        let slots = self.id.len();
        let wrong = "the fluid's particles are not those of the scene";
        self.particles = order::count(&self.id, number_of_particles, wrong)?;
        if !slots.is_multiple_of(LANES) {
            return Err(StateError::contradiction("the fluid's slots are not in fours"));
        }
        for slot in 0..slots {
            self.now.show(slot, state.pressure(self.now.sources[slot].density));
        }
        Ok(())
    }
}

impl<const D: usize> State for Walls<D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        let Some(moving) = &mut self.moving else { return Ok(()) };
        fields.real("sorted_at", &mut moving.sorted_at)
    }

    fn restored(&mut self) -> Result<(), StateError> {
        if let Some(moving) = &mut self.moving {
            moving.return_to_sort(&mut self.shown.position);
            self.sort();
        }
        Ok(())
    }
}

impl<const D: usize> State for Coupling<D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        fields.numbers("slots", &mut self.slots)?;
        fields.points("chosen_at", &mut self.chosen_at)?;
        fields.count("epoch", &mut self.epoch)?;
        fields.real("gap", &mut self.gap)?;
        fields.part("impulse", &mut self.impulse)?;
        let mut interfaces = self.interfaces.iter_mut().enumerate();
        interfaces.try_for_each(|(k, interface)| fields.part(&format!("interface_{k}"), interface))
    }

    fn restored(&mut self) -> Result<(), StateError> {
        self.interfaces.iter_mut().try_for_each(State::restored)
    }
}

impl<const D: usize> Coupling<D> {
    /// The published slots hold particles, in the order of their numbers.
    fn check_slots(&self, fluid: &Columns<D>) -> Result<(), StateError> {
        let ids = self.slots.iter().map(|&slot| fluid.id.get(slot as usize).copied().unwrap_or(PADDING));
        match ids.clone().all(|id| id != PADDING) && ids.is_sorted() {
            true => Ok(()),
            false => Err(StateError::contradiction("the interface set is none of the fluid's particles")),
        }
    }
}
