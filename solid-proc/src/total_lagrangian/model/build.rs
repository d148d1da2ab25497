//! From a scene to the total-Lagrangian solid at its start.

use super::TotalLagrangian;
use crate::columns::{ParticleColumns, Vectors, vectors};
use crate::effects::takes_part;
use crate::shown_velocity::ShownVelocity;
use crate::surface::surface_set;
use crate::total_lagrangian::bounds::VolumeBounds;
use crate::total_lagrangian::clamp;
use crate::total_lagrangian::contact::Contact;
use crate::total_lagrangian::fracture::Fracture;
use crate::total_lagrangian::hourglass;
use crate::total_lagrangian::loads::{self, Loads};
use crate::total_lagrangian::material::{Law, Matrix};
use crate::total_lagrangian::pass::{Acceleration, DeformationSum, Fixed};
use crate::total_lagrangian::relaxation::{self, Memory};
use crate::verlet::Kinematics;
use halfstep_scene::geometry::{self, SolidPoint};
use halfstep_scene::{EffectName, ModelKeys, Motion, Plane, Scene};
use halfstep_sph::lane::{Isa, LANES};
use halfstep_sph::neighbours::{ClusterList, PADDING, Rows};
use halfstep_sph::pair::FixedPairs;
use halfstep_sph::with_kernel;

impl<const D: usize> TotalLagrangian<D> {
    /// The scene's solid of that index.
    pub fn new(scene: &Scene, solid: usize, isa: Isa) -> Option<Self> {
        let material = scene.solids.get(solid)?.clone();
        let ModelKeys::TotalLagrangian(keys) = &material.model else { return None };
        let layout = geometry::layout::<D>(scene).with_solid(scene, solid);
        let points = &layout.solid;
        let dx = scene.solid_spacing(solid);
        let h = material.smoothing_ratio * dx;
        let reach = 2.0 * h;

        let mut position: Vectors<D> =
            std::array::from_fn(|d| points.iter().map(|p| p.position[d]).collect());
        let mut id: Vec<u32> = (0..points.len() as u32).collect();
        let mut rows = Rows::default();
        rows.sort(&position, &id, reach, [f64::MIN; D], [f64::MAX; D]);
        for column in &mut position {
            rows.permute(column);
        }
        rows.permute_ids(&mut id);
        let mut list = ClusterList::narrow();
        list.build(&position, &position, &rows, reach);
        let slots = id.len();
        let mut slot_of = vec![0; points.len()];
        let (mut velocity, mut clamped) = (vectors(slots), vec![0.0; slots]);
        for (slot, &p) in id.iter().enumerate().filter(|&(_, &p)| p != PADDING) {
            slot_of[p as usize] = slot as u32;
            let point = &points[p as usize];
            clamped[slot] = f64::from(u8::from(point.clamped));
            for d in 0..D {
                velocity[d][slot] = point.velocity[d];
            }
        }
        let body = geometry::pieces(scene, &layout);
        let rigid_clamps = takes_part(scene, solid, EffectName::ClampFace);
        let excess_gain = if rigid_clamps {
            clamp::excess_gain(scene, points, &body, &id, &list, reach)
        } else {
            vec![0.0; slots]
        };
        let mut contact = Contact::new(scene, solid, &material, &layout, &body, isa);
        let breaks = takes_part(scene, solid, EffectName::Fracture);
        let dormant = if breaks { contact.take_if(|contact| !contact.acts()) } else { None };
        let alpha = keys.hourglass.unwrap_or_else(|| {
            with_kernel!(scene.numerics.kernel, h, D, |k| hourglass::from_bending(
                k,
                dx,
                in_plane(material.poissons_ratio, keys.plane)
            ))
        });
        let mass = material.density * dx.powi(D as i32);
        let relaxes = takes_part(scene, solid, EffectName::Relaxation);
        let arms = if relaxes { relaxation::arms(&keys.prony) } else { Vec::new() };
        let (now, memory) = (Kinematics::new(velocity), Memory::new(slots, arms.len()));
        let mut pairs =
            with_kernel!(scene.numerics.kernel, h, D, |k| FixedPairs::new(isa, k, position, list));
        let body_at = |slot: usize| body.get(id[slot] as usize);
        pairs.part(|i, j| body_at(i).zip(body_at(j)).is_some_and(|(a, b)| a != b));
        loads::crack(scene, solid, &mut pairs);
        let mut model = Self {
            law: Law::new(&material, keys.material, keys.plane),
            arms,
            driven: driven(scene, &layout.solid, &slot_of),
            driven_load: Vec::new(),
            side_friction: takes_part(scene, solid, EffectName::SideFriction)
                .then(|| material.side_friction / material.density),
            isa,
            smoothing_length: h,
            spacing: dx,
            gravity: std::array::from_fn(|d| scene.gravity[d]),
            courant: scene.numerics.solid_cfl,
            volume: dx.powi(D as i32),
            shown: ParticleColumns::new(points, mass),
            mass,
            hourglass_modulus: alpha * material.shear_modulus(),
            rigid_clamps,
            interface_set: match breaks && (scene.fluid.is_some() || scene.solids.len() > 1) {
                // Cracks open surfaces everywhere, to water and to other solids.
                true => (0..points.len() as u32).collect(),
                false => surface_set(points, &body, 2.0 * scene.smoothing_ratio * scene.resolution, dx),
            },
            fracture: Fracture::new(scene, solid, &body, dormant),
            loads: Loads::new(scene, &layout.solid, &slot_of, dx, mass),
            at_n: now.clone(),
            memory_at_n: memory.clone(),
            memory,
            shown_velocity: ShownVelocity::new(layout.solid.iter().map(|p| p.velocity)),
            load: vectors(slots),
            gradient: vec![Matrix::identity(); slots],
            volume_ratio: vec![1.0; slots],
            bracket: std::array::from_fn(|_| vectors(slots)),
            deformations: vec![DeformationSum::default(); slots / LANES],
            sums: vec![Acceleration::default(); slots / LANES],
            slope_sum: 0.0,
            correction: vec![Matrix::zeros(); slots],
            hourglass: vec![0.0; slots],
            fixed: Fixed { clamped, excess_gain },
            pairs,
            points: layout.solid,
            now,
            material,
            id,
            slot_of,
            contact,
            bounds: VolumeBounds::new(scene, solid)?,
            failure: None,
            pair_evaluations: 0,
            account: None,
        };
        model.correct();
        model.prepare_fracture();
        model.slope_sum = model.largest_slope_sum();
        model.drive(0.0);
        model.evaluate(0.0);
        model.show_particles();
        Some(model)
    }
}

/// Slots of the particles that clamps move, and how.
fn driven<const D: usize>(scene: &Scene, points: &[SolidPoint<D>], slot_of: &[u32]) -> Vec<(usize, Motion)> {
    let clamped = points.iter().zip(slot_of).filter(|(point, _)| point.clamped);
    clamped.filter_map(|(p, &slot)| Some((slot as usize, geometry::clamp_motion(scene, p)?))).collect()
}

/// Poisson's ratio with which the formulas of plane strain hold for a plane.
fn in_plane(poissons_ratio: f64, plane: Plane) -> f64 {
    match plane {
        Plane::Strain => poissons_ratio,
        Plane::Stress => poissons_ratio / (1.0 + poissons_ratio),
    }
}
