//! What is measured of a solid.

use crate::model::{Load, SolidModel};
use crate::strain::Strain;
use halfstep_role::ledger::Ledger;
use halfstep_scene::geometry::{self, SolidPoint, holds, nearest};
use halfstep_scene::{Block, BodyQuantity, EnergyPart, Phase, ProbeKind, Scene, Spot};
use halfstep_wire::frame::{mean_stress, von_mises};
use halfstep_wire::wide;
use std::cell::OnceCell;

/// A probe of a solid.
pub(crate) enum Measurement<const D: usize> {
    /// Mean displacement of these particles.
    Displacement(Vec<u32>),
    /// Mean position of these particles.
    Position(Vec<u32>),
    /// Mean von Mises stress of these particles.
    Stress(Vec<u32>),
    /// Mean velocity of these particles.
    Velocity(Vec<u32>),
    /// Mean strain of particles.
    Strain(Strain<D>),
    /// Mean Cauchy stress of these particles.
    CauchyStress(Vec<u32>),
    KineticEnergy,
    StrainEnergy,
    CrackEnergy,
    CrackArea,
    /// With the number of bodies of a solid that does not break.
    Bodies(u32),
    Centroid,
    /// Force of the fluid on these particles.
    Force(Vec<u32>),
    /// Moment of the same forces about an axis along z through a point.
    Moment(Vec<u32>, [f64; D]),
    /// Something of the rigid body of that index.
    Body(usize, BodyQuantity),
    /// Kinetic and strain energy of these particles.
    EnergyOf(Vec<u32>),
    /// Something of the body that strains and has these particles.
    OfParticles(Vec<u32>, BodyQuantity),
    /// The ledger or a part of it.
    Energy(Option<EnergyPart>),
}

/// The probes of the scene's solid of that index, in the scene's order.
pub(crate) fn of_solid<const D: usize>(
    scene: &Scene,
    solid: usize,
    model: &dyn SolidModel<D>,
) -> Vec<Measurement<D>> {
    let particles = model.particles();
    let near = |at: &[f64; 3]| {
        let near = nearest(particles.reference.iter().copied(), std::array::from_fn(|d| at[d]));
        near.into_iter().map(|p| p as u32).collect()
    };
    // Filled where a probe asks for it, for all of them.
    let placed = OnceCell::new();
    let layout = || placed.get_or_init(|| geometry::layout::<D>(scene).with_solid(scene, solid));
    let of_body = |body: &str| -> Vec<u32> {
        let own = |(_, point): &(usize, &SolidPoint<D>)| scene.shapes[point.body as usize].body() == body;
        layout().solid.iter().enumerate().filter(own).map(|(p, _)| p as u32).collect()
    };
    let of_spot = |spot: &Spot| match spot {
        Spot::At(at) => near(at),
        Spot::Body(body) => of_body(body),
    };
    // What is clamped does not strain: of particles equally near to a point, as at the face of a clamp, the others.
    let strained = |of: &Spot| {
        let all = of_spot(of);
        let is_free = |p: &u32| !layout().solid.get(*p as usize).is_some_and(|point| point.clamped);
        match of {
            Spot::At(_) if all.len() > 1 && all.iter().any(is_free) => {
                all.into_iter().filter(is_free).collect()
            }
            _ => all,
        }
    };
    let strain = |of: &Spot| {
        let particles = strained(of);
        let pieces = geometry::pieces(scene, layout());
        let same = |p: u32, q: u32| pieces.get(p as usize) == pieces.get(q as usize);
        Strain::new(model, &particles, scene.solid_spacing(solid), same)
    };
    let loaded = |within: Option<Block>, shape: Option<usize>| {
        let is_of = |p: u32, shape: usize| {
            layout().solid.get(p as usize).is_some_and(|point| point.body as usize == shape)
        };
        let of_shape = |p: u32| shape.is_none_or(|shape| is_of(p, shape));
        let inside = |p: &u32| {
            within.is_none_or(|b| holds(&b, &particles.reference[*p as usize], 0.0)) && of_shape(*p)
        };
        model.interface_set().iter().copied().filter(inside).collect()
    };
    let measurement = |kind: &ProbeKind| match kind {
        ProbeKind::Displacement { at } => Some(Measurement::Displacement(near(at))),
        ProbeKind::Position { at } => Some(Measurement::Position(near(at))),
        ProbeKind::Stress { at } => Some(Measurement::Stress(strained(&Spot::At(*at)))),
        ProbeKind::SolidVelocity { at } => Some(Measurement::Velocity(near(at))),
        ProbeKind::Strain { of } => Some(Measurement::Strain(strain(of))),
        ProbeKind::CauchyStress { of } => Some(Measurement::CauchyStress(strained(of))),
        ProbeKind::KineticEnergy { phase: Phase::Solid } => Some(Measurement::KineticEnergy),
        ProbeKind::StrainEnergy => Some(Measurement::StrainEnergy),
        ProbeKind::CrackEnergy => Some(Measurement::CrackEnergy),
        ProbeKind::CrackArea => Some(Measurement::CrackArea),
        ProbeKind::Bodies => Some(Measurement::Bodies(bodies_of(scene, solid))),
        ProbeKind::Centroid { phase: Phase::Solid } => Some(Measurement::Centroid),
        ProbeKind::Force { within, shape } => Some(Measurement::Force(loaded(*within, *shape))),
        ProbeKind::Moment { about, within, shape } => {
            Some(Measurement::Moment(loaded(*within, *shape), std::array::from_fn(|d| about[d])))
        }
        ProbeKind::Body { body, quantity: BodyQuantity::Energy } if model.rigid_bodies().is_empty() => {
            Some(Measurement::EnergyOf(of_body(body)))
        }
        ProbeKind::Body { body, quantity } if model.rigid_bodies().is_empty() => {
            Some(Measurement::OfParticles(of_body(body), *quantity))
        }
        ProbeKind::Body { body, quantity } => {
            let of_name = model.rigid_bodies().iter().position(|state| state.name == *body);
            of_name.map(|body| Measurement::Body(body, *quantity))
        }
        ProbeKind::Energy { part, .. } => Some(Measurement::Energy(*part)),
        _ => None,
    };
    scene.probes.iter().filter(|p| p.solid == Some(solid)).filter_map(|p| measurement(&p.kind)).collect()
}

/// Number of bodies of a solid at the start.
fn bodies_of(scene: &Scene, solid: usize) -> u32 {
    let own = |shape: &usize| scene.shapes[*shape].solid == Some(solid);
    scene.bodies().iter().filter(|body| body.shapes.iter().any(own)).count() as u32
}

/// What probes see of a solid: the present state, under the load of the last exchange.
#[derive(Clone, Copy)]
pub(crate) struct Measured<'a, const D: usize> {
    pub(crate) model: &'a dyn SolidModel<D>,
    pub(crate) load: &'a Load<D>,
    pub(crate) ledger: Option<&'a Ledger>,
    /// Force of contacts on each particle that stands for the model's after a resume; empty: the model's counts.
    pub(crate) contact: &'a [[f64; D]],
}

impl<const D: usize> Measured<'_, D> {
    /// Force of contacts on each particle, by number, N (2D: N/m).
    pub(crate) fn contact_forces(&self) -> Vec<[f64; D]> {
        if !self.contact.is_empty() {
            return self.contact.to_vec();
        }
        let mut force = vec![[0.0; D]; self.model.particles().len()];
        self.model.contact_forces(&mut |p, given| {
            (0..D).for_each(|d| force[p as usize][d] += given[d]);
        });
        force
    }
}

impl<const D: usize> Measurement<D> {
    /// Asks for forces of contacts on particles.
    pub(crate) fn asks_for_contact(&self) -> bool {
        matches!(self, Self::OfParticles(_, BodyQuantity::ContactForce | BodyQuantity::ContactMoment))
    }

    /// Appends the values.
    pub(crate) fn measure(&self, of: Measured<'_, D>, out: &mut Vec<f64>) {
        let Measured { model, load, .. } = of;
        if let (Self::Energy(part), Some(ledger)) = (self, of.ledger) {
            return ledger.measure(*part, out);
        }
        let mut put = |value: f64| out.push(value);
        let state = model.particles();
        match self {
            Self::Displacement(particles) => {
                for d in 0..D {
                    let sum: f64 = particles
                        .iter()
                        .map(|&p| state.position[p as usize][d] - state.reference[p as usize][d])
                        .sum();
                    put(sum / particles.len() as f64);
                }
            }
            Self::Position(particles) => {
                for d in 0..D {
                    let sum: f64 = particles.iter().map(|&p| state.position[p as usize][d]).sum();
                    put(sum / particles.len() as f64);
                }
            }
            Self::Stress(particles) => {
                let mut records = Vec::with_capacity(particles.len());
                model.records(particles, &mut records);
                let sum: f64 = records.iter().map(|r| von_mises(&r.deviatoric_stress)).sum();
                put(sum / particles.len() as f64);
            }
            Self::Velocity(particles) => {
                for d in 0..D {
                    let sum: f64 = particles.iter().map(|&p| state.velocity[p as usize][d]).sum();
                    put(sum / particles.len() as f64);
                }
            }
            Self::Strain(strain) => {
                let mean = strain.mean(model);
                let components: &[(usize, usize)] = match D {
                    2 => &[(0, 0), (1, 1), (0, 1)],
                    _ => &[(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)],
                };
                components.iter().for_each(|&at| put(mean[at]));
            }
            Self::CauchyStress(particles) => {
                let mut records = Vec::with_capacity(particles.len());
                model.records(particles, &mut records);
                mean_stress(&records)[..if D == 2 { 4 } else { 6 }].iter().for_each(|&s| put(s));
            }
            Self::KineticEnergy => put(model.kinetic_energy()),
            Self::StrainEnergy => put(model.strain_energy()),
            Self::Centroid if !model.rigid_bodies().is_empty() => {
                let bodies = model.rigid_bodies();
                let mass: f64 = bodies.iter().map(|body| body.mass).sum();
                for d in 0..D {
                    put(bodies.iter().map(|body| body.mass * body.center[d]).sum::<f64>() / mass);
                }
            }
            Self::CrackEnergy => put(model.fracture().energy),
            Self::CrackArea => put(model.fracture().area),
            Self::Bodies(whole) => {
                let fracture = model.fracture();
                put(f64::from(if model.breaks() { fracture.bodies } else { *whole }));
                put(f64::from(fracture.loose));
                put(f64::from(fracture.thin));
            }
            Self::Centroid => {
                let mass: f64 = state.mass.iter().sum();
                for d in 0..D {
                    let moment: f64 = state.mass.iter().zip(state.position).map(|(m, x)| m * x[d]).sum();
                    put(moment / mass);
                }
            }
            Self::Force(particles) => {
                for d in 0..D {
                    put(particles.iter().map(|&p| load.force[p as usize][d]).sum());
                }
            }
            Self::Moment(particles, about) => {
                let of = |&p: &u32| {
                    let (x, f) = (state.position[p as usize], load.force[p as usize]);
                    (x[0] - about[0]) * f[1] - (x[1] - about[1]) * f[0]
                };
                put(particles.iter().map(of).sum());
            }
            Self::EnergyOf(particles) => put(model.energy_of(particles)),
            Self::OfParticles(particles, quantity) => of_particles(of, particles, *quantity, &mut put),
            Self::Body(body, quantity) => of_body(model, load, *body, *quantity, &mut put),
            Self::Energy(_) => {}
        }
    }

    /// Appends what goes with the values of the probe ([`ProbeKind::companions`]).
    pub(crate) fn accompany(&self, model: &dyn SolidModel<D>, out: &mut Vec<f64>) {
        use BodyQuantity::{ContactMoment, Moment};
        match self {
            Self::OfParticles(particles, Moment | ContactMoment) => {
                out.extend(mean(model, particles, model.particles().position));
            }
            Self::Body(body, Moment | ContactMoment) => out.extend(model.rigid_bodies()[*body].center),
            _ => {}
        }
    }
}

/// Mean over particles of a model, each with its mass.
fn mean<const D: usize>(model: &dyn SolidModel<D>, particles: &[u32], of: &[[f64; D]]) -> [f64; D] {
    let masses = model.particles().mass;
    let mass: f64 = particles.iter().map(|&p| masses[p as usize]).sum();
    let sum = |d| particles.iter().map(|&p| masses[p as usize] * of[p as usize][d]).sum::<f64>();
    std::array::from_fn(|d| sum(d) / mass)
}

/// Puts the components of something of a body that strains: of its centre of mass, or of the forces on its particles.
fn of_particles<const D: usize>(
    of: Measured<'_, D>,
    particles: &[u32],
    quantity: BodyQuantity,
    put: &mut impl FnMut(f64),
) {
    let Measured { model, load, .. } = of;
    let state = model.particles();
    let mean = |of| mean(model, particles, of);
    // Forces on particles, by number.
    let sum = |force: &[[f64; D]]| -> [f64; D] {
        std::array::from_fn(|d| particles.iter().map(|&p| force[p as usize][d]).sum())
    };
    let moment = |force: &[[f64; D]], put: &mut _| {
        let all = particles.iter().map(|&p| (&force[p as usize], &state.position[p as usize]));
        about(mean(state.position), all, put);
    };
    let vector = match quantity {
        BodyQuantity::Position => mean(state.position),
        BodyQuantity::Velocity => mean(state.velocity),
        BodyQuantity::Force => sum(&load.force),
        BodyQuantity::ContactForce => sum(&of.contact_forces()),
        BodyQuantity::Moment => return moment(&load.force, put),
        BodyQuantity::ContactMoment => return moment(&of.contact_forces(), put),
        // A scene cannot ask for the others.
        BodyQuantity::Angle | BodyQuantity::AngularVelocity | BodyQuantity::Energy => [f64::NAN; D],
    };
    vector.iter().for_each(|&x| put(x));
}

/// Puts the components of the moment of forces at these places about a point.
fn about<'a, const D: usize>(
    point: [f64; D],
    forces: impl Iterator<Item = (&'a [f64; D], &'a [f64; D])>,
    put: &mut impl FnMut(f64),
) {
    let mut sum = [0.0; 3];
    for (force, position) in forces {
        let force = wide(*force);
        let arm = wide(std::array::from_fn::<f64, D, _>(|d| position[d] - point[d]));
        for d in 0..3 {
            let [a, b] = [(d + 1) % 3, (d + 2) % 3];
            sum[d] += arm[a] * force[b] - arm[b] * force[a];
        }
    }
    if D == 2 { put(sum[2]) } else { sum.iter().for_each(|&x| put(x)) }
}

/// Puts the components of something of a rigid body.
fn of_body<const D: usize>(
    model: &dyn SolidModel<D>,
    load: &Load<D>,
    body: usize,
    quantity: BodyQuantity,
    put: &mut impl FnMut(f64),
) {
    let state = &model.rigid_bodies()[body];
    let own = || {
        let of = model.body_of().iter().zip(&load.force).zip(model.particles().position);
        of.filter(|((of, _), _)| **of as usize == body).map(|((_, force), position)| (force, position))
    };
    let vector = match quantity {
        BodyQuantity::Position => wide(state.center),
        BodyQuantity::Angle => state.angle,
        BodyQuantity::Velocity => wide(state.velocity),
        BodyQuantity::AngularVelocity => state.angular_velocity,
        BodyQuantity::Force => wide::<D>(std::array::from_fn(|d| own().map(|(force, _)| force[d]).sum())),
        BodyQuantity::Moment => return about(state.center, own(), put),
        BodyQuantity::ContactForce => wide(state.contact_force),
        BodyQuantity::ContactMoment => state.contact_moment,
        BodyQuantity::Energy => return put(state.kinetic_energy),
    };
    if quantity.turns() && D == 2 { put(vector[2]) } else { vector[..D].iter().for_each(|&x| put(x)) }
}
