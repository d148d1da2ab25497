//! From a scene to the finite-element solid at its start.

use super::FiniteElement;
use crate::columns::{ParticleColumns, vectors};
use crate::effects::takes_part;
use crate::finite_element::element::Element;
use crate::finite_element::equations::Equations;
use crate::finite_element::mesh::Mesh;
use crate::shown_velocity::ShownVelocity;
use crate::surface::surface_set;
use crate::total_lagrangian::bounds::VolumeBounds;
use crate::total_lagrangian::contact::Contact;
use crate::total_lagrangian::material::{Law, Matrix};
use crate::verlet::Kinematics;
use halfstep_scene::{EffectName, ModelKeys, Motion, Plane, Scene, Solid, TimeIntegration, geometry};
use halfstep_sph::lane::Isa;

impl<const D: usize> FiniteElement<D> {
    /// The scene's solid of that index.
    pub fn new(scene: &Scene, solid: usize, isa: Isa) -> Option<Self> {
        let material = scene.solids.get(solid)?.clone();
        let ModelKeys::FiniteElement(keys) = &material.model else { return None };
        let layout = geometry::layout::<D>(scene).with_solid(scene, solid);
        let points = &layout.solid;
        let body = geometry::pieces(scene, &layout);
        let dx = scene.solid_spacing(solid);
        let (mesh, element) = (Mesh::new(points, &body, dx), Element::new(dx));
        let contact = Contact::new(scene, solid, &material, &layout, &body, isa);
        let mass = material.density * element.volume();
        let nodes = mesh.nodes();
        let mut clamped = vec![false; nodes];
        let mut motions: Vec<Option<Motion>> = vec![None; nodes];
        for (p, point) in points.iter().enumerate().filter(|(_, point)| point.clamped) {
            let motion = geometry::clamp_motion(scene, point);
            for &node in mesh.of(p) {
                clamped[node as usize] = true;
                motions[node as usize].clone_from(&motion);
            }
        }
        let mut velocity = mesh.spread(|p| points[p].velocity);
        for column in &mut velocity {
            column.iter_mut().zip(&clamped).filter(|(_, held)| **held).for_each(|(v, _)| *v = 0.0);
        }
        let now = Kinematics::new(velocity);
        let implicit = keys.time_integration == TimeIntegration::Implicit;
        let equations = implicit.then(|| Equations::new(&mesh, &clamped));
        let driven = motions.into_iter().enumerate().filter_map(|(node, motion)| Some((node, motion?)));
        let kinematic =
            material.artificial_viscosity.kinematic(material.smoothing_ratio * dx, material.sound_speed());
        let mut model = Self {
            law: Law::new(&material, keys.material, keys.plane),
            hourglass: element.hourglass(bending_modulus(&material, keys.plane)),
            viscosity: material.density * kinematic,
            side_friction: takes_part(scene, solid, EffectName::SideFriction)
                .then(|| material.side_friction / material.density),
            isa,
            spacing: dx,
            gravity: std::array::from_fn(|d| scene.gravity[d]),
            courant: scene.numerics.solid_cfl,
            shown: ParticleColumns::new(points, mass),
            mass,
            interface_set: surface_set(points, &body, 2.0 * scene.smoothing_ratio * scene.resolution, dx),
            clamped,
            driven: driven.collect(),
            at_n: now.clone(),
            shown_velocity: ShownVelocity::new((0..points.len()).map(|p| mesh.mean(p, &now.velocity))),
            load: vectors(nodes),
            inner: vectors(nodes),
            gradient: vec![Matrix::identity(); points.len()],
            volume_ratio: vec![1.0; points.len()],
            points: layout.solid,
            element,
            mesh,
            now,
            material,
            contact,
            bounds: VolumeBounds::new(scene, solid)?,
            failure: None,
            evaluations: 0,
            account: None,
            equations,
            alone: scene.fluid.is_none(),
        };
        model.drive(0.0);
        model.evaluate();
        model.show_particles();
        Some(model)
    }
}

/// E' of a plate that is bent, Pa.
fn bending_modulus(material: &Solid, plane: Plane) -> f64 {
    match plane {
        Plane::Strain => material.youngs_modulus / (1.0 - material.poissons_ratio.powi(2)),
        Plane::Stress => material.youngs_modulus,
    }
}
