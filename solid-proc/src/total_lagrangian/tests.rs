//! The total-Lagrangian solid: exact deformations, symmetries, energy.

use super::material::Matrix;
use crate::model::{Load, SolidModel};
use crate::total_lagrangian::TotalLagrangian;
use halfstep_scene::{self as scene, Scene};
use halfstep_sph::lane::Isa;
use halfstep_wire::half_step::HalfStep;
use nalgebra::Rotation2;
use proptest::prelude::*;
use std::path::Path;

fn scene(shape: &str, overrides: &[&str]) -> Scene {
    let text = format!(
        r#"
        resolution = 0.01
        end_time = 1.0
        gravity = [0.0, 0.0]
        [solid]
        model = "total-lagrangian"
        density = 1000.0
        youngs_modulus = 1e6
        poissons_ratio = 0.3
        [[shape]]
        name = "body"
        phase = "solid"
        {shape}
        "#
    );
    let overrides: Vec<String> = overrides.iter().map(|&o| o.into()).collect();
    scene::parse(&text, Path::new("body.toml"), &overrides).expect("a right scene")
}

const BLOCK: &str = "box = { min = [0.0, 0.0], max = [0.2, 0.15] }";
/// The surface of the body is no lattice plane.
const RING: &str = "ring = { center = [0.0, 0.0], inner = 0.05, outer = 0.1 }";
const MATERIALS: [&str; 2] = ["solid.material=\"st-venant-kirchhoff\"", "solid.material=\"neo-hookean\""];

pub(super) fn solid(shape: &str, overrides: &[&str]) -> TotalLagrangian<2> {
    TotalLagrangian::new(&scene(shape, overrides), 0, Isa::detect()).expect("a solid")
}

impl TotalLagrangian<2> {
    /// Brings every particle to x(X) and evaluates.
    pub(super) fn deform(&mut self, x: impl Fn([f64; 2]) -> [f64; 2]) {
        for slot in 0..self.id.len() {
            let at: [f64; 2] = std::array::from_fn(|d| self.pairs.position()[d][slot]);
            let to = x(at);
            for d in 0..2 {
                self.now.displacement[d][slot] = to[d] - at[d];
            }
        }
        self.evaluate(0.0);
    }

    fn slots(&self) -> impl Iterator<Item = usize> + '_ {
        self.slot_of.iter().map(|&s| s as usize)
    }

    pub(super) fn accelerations(&self) -> Vec<[f64; 2]> {
        self.slots().map(|s| [self.now.acceleration[0][s], self.now.acceleration[1][s]]).collect()
    }
}

fn affine(f: Matrix<2>) -> impl Fn([f64; 2]) -> [f64; 2] {
    move |x| [f[(0, 0)] * x[0] + f[(0, 1)] * x[1] + 0.3, f[(1, 0)] * x[0] + f[(1, 1)] * x[1] - 0.1]
}

#[test]
fn a_uniform_deformation_is_exact_everywhere() {
    // The patch test: F, J and stress at every particle, surface and corners included; no acceleration inside.
    let f = Matrix::<2>::new(1.2, 0.1, -0.3, 0.9);
    for shape in [BLOCK, RING] {
        for material in MATERIALS {
            let mut body = solid(shape, &[material]);
            body.deform(affine(f));
            let stress = body.law.first_piola_kirchhoff(&f, f.determinant());
            let cauchy = body.law.cauchy(&f, f.determinant());
            for slot in body.slots() {
                assert!((body.gradient[slot] - f).norm() < 1e-13, "{}", body.gradient[slot]);
                assert!((body.volume_ratio[slot] - f.determinant()).abs() < 1e-13);
                let found = body.law.first_piola_kirchhoff(&body.gradient[slot], body.volume_ratio[slot]);
                assert!((found - stress).norm() < 1e-12 * stress.norm());
            }
            let r = body.record(0);
            assert!((r.density - 1000.0 / f.determinant()).abs() < 1e-9);
            assert!((r.pressure - cauchy.pressure).abs() < 1e-12 * stress.norm());
            assert!((r.deviatoric_stress[3] - cauchy.deviator[(0, 1)]).abs() < 1e-12 * stress.norm());
            assert!(r.deviatoric_stress[..3].iter().sum::<f64>().abs() < 1e-12 * stress.norm());
            // Energy: psi times the volume, none in hourglass modes.
            let volume = body.particles().len() as f64 * 1e-4;
            let energy = body.law.energy(&f, f.determinant()) * volume;
            assert!((body.strain_energy() - energy).abs() < 1e-12 * energy);
        }
    }
    let mut block = solid(BLOCK, &[]);
    block.deform(affine(f));
    let accelerations = block.accelerations();
    for p in 0..block.particles().len() {
        let x = block.particles().reference[p];
        let inside = x[0] > 0.03 && x[0] < 0.17 && x[1] > 0.03 && x[1] < 0.12;
        let a = accelerations[p][0].hypot(accelerations[p][1]);
        // The scale of a surface particle's is P / (rho dx).
        assert!(if inside { a < 1e-7 } else { a.is_finite() }, "{a} at {x:?}");
    }
    assert!(accelerations[0][0].hypot(accelerations[0][1]) > 1e3);
}

#[test]
fn a_rigid_rotation_makes_no_stress_and_no_force() {
    for angle in [0.3, 2.0, 3.1] {
        let rotation = *Rotation2::new(angle).matrix();
        for shape in [BLOCK, RING] {
            for material in MATERIALS {
                let mut body = solid(shape, &[material]);
                body.deform(affine(rotation));
                // E = 1e6 Pa: 1e-14 of it.
                for p in 0..body.particles().len() as u32 {
                    let r = body.record(p);
                    let largest = r.deviatoric_stress.iter().fold(r.pressure.abs(), |m, s| m.max(s.abs()));
                    assert!(largest < 1e-8, "{largest} Pa at {angle}");
                }
                // E / (rho dx) = 1e5 m/s².
                assert!(body.accelerations().as_flattened().iter().all(|a| a.abs() < 1e-8));
                assert!(body.strain_energy().abs() < 1e-9);
            }
        }
    }
}

#[test]
fn hourglass_resistance_acts_on_hourglass_modes_only() {
    // A linear field, at any strength: the same forces.
    let shear = affine(Matrix::<2>::new(1.0, 0.2, 0.0, 1.1));
    let [mut none, mut strong] = ["0.0", "5.0"].map(|a| solid(RING, &[&format!("solid.hourglass={a}")]));
    none.deform(&shear);
    strong.deform(&shear);
    for (a, b) in none.accelerations().as_flattened().iter().zip(strong.accelerations().as_flattened()) {
        assert!((a - b).abs() < 1e-8 * 1e5, "{a} {b}");
    }
    // Neighbours that move against each other inside a block: F does not see it, only the resistance acts, against it.
    let e = 1e-4;
    let sign = |x: [f64; 2]| if ((x[0] + x[1]) / 0.01 - 1.0).round() as i64 % 2 == 0 { 1.0 } else { -1.0 };
    for (alpha, expected) in [("0.0", 0.0), ("0.5", 0.5)] {
        let mut block = solid(BLOCK, &[&format!("solid.hourglass={alpha}")]);
        block.deform(|x| [x[0] + e * sign(x), x[1]]);
        // By hand: sum over the four axial neighbours, which move by 2 e against it, of 2 alpha G V0 F 2 e / rho; the
        // diagonal ones move with it. F_axial V0 = -w.
        let w = {
            use halfstep_sph::kernel::{Kernel, WendlandC2};
            use halfstep_sph::lane::{Lane, Lanes, Unfused};
            let kernel = WendlandC2::<2>::new(0.0075);
            -1e-4 * kernel.gradient_over_r::<Unfused, Lane>(Lane::splat(0.01)).0[0]
        };
        let g = 1e6 / 2.6;
        let by_hand = 4.0 * 2.0 * expected * g * w * 2.0 * e / 1000.0;
        let p = (0..300).find(|&p| {
            let x = block.particles().reference[p as usize];
            (x[0] - 0.105).abs() < 1e-9 && (x[1] - 0.075).abs() < 1e-9
        });
        let p = p.expect("an inner particle");
        let a = block.accelerations()[p as usize];
        let against = -a[0] * sign(block.particles().reference[p as usize]);
        assert!((against - by_hand).abs() < 1e-9 * by_hand + 1e-6, "{against} {by_hand}");
        assert!(a[1].abs() < 1e-6);
    }
}

#[test]
fn forces_are_the_slope_of_the_energy() {
    // Clamp with its face, bent: the energy that is reported is the one that the forces derive from.
    let clamp = "shape.body.clamp={min=[0.0,0.0],max=[0.05,0.2]}";
    for material in MATERIALS {
        let mut body = solid(BLOCK, &[clamp, material]);
        let bent = |x: [f64; 2]| {
            let s = (x[0] - 0.05).max(0.0);
            [x[0] + 0.8 * s * (0.075 - x[1]), x[1] + 2.0 * s * s]
        };
        body.deform(bent);
        let a = body.accelerations();
        let step = 1e-7;
        for p in [5_u32, 25, 66, 107, 155, 219, 299] {
            for d in 0..2 {
                let at = body.particles().reference[p as usize];
                let mut energies = [1.0, -1.0].map(|sign| {
                    body.deform(|x| {
                        let mut to = bent(x);
                        to[d] += if x == at { sign * step } else { 0.0 };
                        to
                    });
                    body.strain_energy()
                });
                energies.iter_mut().for_each(|e| *e /= 2.0 * step);
                let force = energies[1] - energies[0];
                let found = 0.1 * a[p as usize][d];
                assert!((force - found).abs() < 1e-4 * (force.abs() + 10.0), "{p} {d}: {force} {found}");
            }
        }
    }
}

#[test]
fn the_face_of_a_clamp_is_where_the_scene_says() {
    // Stretched evenly from the face at x = 0.05: exact from the first free particle on, and nothing behind.
    let mut body = solid(BLOCK, &["shape.body.clamp={min=[0.0,0.0],max=[0.05,0.2]}"]);
    body.deform(|x| [if x[0] < 0.05 { x[0] } else { 0.05 + 1.1 * (x[0] - 0.05) }, x[1]]);
    for p in 0..300 {
        let f = body.gradient[body.slot_of[p as usize] as usize];
        let stretch = if body.particles().reference[p as usize][0] < 0.05 { 1.0 } else { 1.1 };
        assert!((f - Matrix::<2>::new(stretch, 0.0, 0.0, 1.0)).norm() < 1e-13, "{f}");
    }
}

#[test]
fn energy_is_kept_without_viscosity() {
    // A free block that vibrates strongly: three periods of its slowest mode, sqrt(E / rho) = 32 m/s over 0.4 m.
    let mode = "shape.body.cantilever_mode={fraction=0.03,root=0.0,length=0.2}";
    let mut body = solid(BLOCK, &[mode, "solid.artificial_viscosity.linear=0.0"]);
    let load = Load::none(body.particles().len());
    let energy = |b: &TotalLagrangian<2>| {
        let kinetic: f64 = (0..b.particles().len() as u32)
            .map(|p| {
                0.5 * b.particles().mass[p as usize]
                    * b.particles().velocity[p as usize].iter().map(|v| v * v).sum::<f64>()
            })
            .sum();
        (kinetic + b.strain_energy(), b.strain_energy())
    };
    let (start, dt) = (energy(&body).0, body.sub_step_limit());
    let mut stored = 0.0_f64;
    for _ in 0..(0.04 / dt) as usize {
        for half_step in HalfStep::begin(0, 0.0).lasting(dt).both() {
            body.advance(&half_step, 1, &load).unwrap();
        }
        let (total, strain) = energy(&body);
        stored = stored.max(strain / start);
        assert!((total / start - 1.0).abs() < 1e-3, "{total} {start}");
    }
    assert!(stored > 0.05, "it vibrates: {stored}");
}

#[test]
fn viscosity_takes_energy_away() {
    let mode = "shape.body.cantilever_mode={fraction=0.03,root=0.0,length=0.2}";
    let of = |a: &str| solid(BLOCK, &[mode, &format!("solid.artificial_viscosity.linear={a}")]);
    // The same time for both: damping makes the step shorter.
    let span = 150.0 * of("0.0").sub_step_limit();
    let energies = ["0.0", "1.0"].map(|a| {
        let mut body = of(a);
        let load = Load::none(body.particles().len());
        let dt = 0.5 * body.sub_step_limit();
        for _ in 0..(span / dt) as usize {
            for half_step in HalfStep::begin(0, 0.0).lasting(dt).both() {
                body.advance(&half_step, 1, &load).unwrap();
            }
        }
        let v2 = (0..body.particles().len() as u32)
            .map(|p| body.particles().velocity[p as usize].iter().map(|v| v * v).sum::<f64>());
        v2.sum::<f64>() * 0.05 + body.strain_energy()
    });
    // More than the error of the undamped energy.
    assert!(energies[1] < 0.997 * energies[0], "{energies:?}");
}

#[test]
fn shapes_that_touch_are_one_piece_where_they_name_one_body() {
    let other = |left: f64, name: &str| {
        format!(
            "{BLOCK}\n[[shape]]\nname = \"other\"\n{name}\nphase = \"solid\"\nbox = {{ min = [{left}, 0.0], max = [0.4, 0.15] }}"
        )
    };
    // Side by side: a pull on one moves both. A gap of one spacing, or another body: it does not.
    let one = "body = \"body\"";
    for (left, name, together) in [(0.2, one, true), (0.21, one, false), (0.2, "", false)] {
        let mut body = solid(&other(left, name), &[]);
        assert_eq!(body.contact.is_none(), together);
        body.deform(|x| [if x[0] < 0.2 { x[0] - 1e-4 } else { x[0] }, x[1]]);
        let pulled = body.accelerations().as_flattened().iter().any(|a| a.abs() > 1.0);
        assert_eq!(pulled, together);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// Whatever the deformation, inner forces have neither a sum nor a moment.
    #[test]
    fn forces_sum_to_nothing(c in prop::array::uniform6(-0.3..0.3f64), k in 1.0..40.0f64) {
        for shape in [BLOCK, RING] {
            let mut body = solid(shape, &[]);
            body.deform(|x| [
                x[0] * (1.0 + c[0]) + c[1] * x[1] + 0.2 / k * c[2] * (k * x[1]).sin(),
                x[1] * (1.0 + c[3]) + c[4] * x[0] + 0.2 / k * c[5] * (k * x[0]).cos(),
            ]);
            prop_assert!(body.failure.is_none());
            let a = body.accelerations();
            let scale: f64 = a.as_flattened().iter().map(|a| a.abs()).sum();
            let mut sums = [0.0; 3];
            for (p, a) in a.iter().enumerate() {
                let x = body.record(p as u32).position;
                sums = [sums[0] + a[0], sums[1] + a[1], sums[2] + (x[0] * a[1] - x[1] * a[0]) / 0.2];
            }
            for sum in sums {
                prop_assert!(sum.abs() <= 1e-12 * scale + 1e-9, "{sums:?} {scale}");
            }
        }
    }
}

#[test]
fn stress_relaxes_from_a_sudden_strain_as_exp_t_over_tau() {
    // Strained at t = 0, so that h = g s, and held: h = g s exp(-t / tau), in sub-steps of any length.
    let prony = ["solid.prony=[[0.5,0.06],[0.2,0.001]]"];
    let f = Matrix::<2>::new(1.05, 0.1, -0.03, 0.98);
    let e = (f.transpose() * f - Matrix::identity()) * 0.5;
    for material in MATERIALS {
        let mut body = solid(BLOCK, &[prony[0], material]);
        body.deform(affine(f));
        let shear = 1e6 / 2.6;
        let s = (e - Matrix::identity() * (e.trace() / 3.0)) * (2.0 * shear);
        let law = body.law.cauchy(&f, f.determinant());
        let mut time = 0.0_f64;
        for dt in [0.0, 1e-5, 3e-4, 0.004, 0.05] {
            body.evaluate(dt);
            time += dt;
            let h = s * (0.5 * (-time / 0.06).exp() + 0.2 * (-time / 0.001).exp());
            let sigma =
                law.deviator - Matrix::identity() * law.pressure + f * h * f.transpose() / f.determinant();
            for slot in body.slots() {
                let found = body.cauchy(slot);
                let found = found.deviator - Matrix::identity() * found.pressure;
                assert!((found - sigma).norm() < 1e-10 * sigma.norm(), "{time}: {found} {sigma}");
            }
        }
    }
}

#[test]
fn a_sudden_strain_is_stiffer_and_takes_shorter_steps() {
    // c_P² = (K + 4 G (1 + sum g) / 3) / rho, and alpha G / rho beside it.
    let keys = ["solid.hourglass=0", "solid.prony=[[0.5,0.06],[0.2,1]]"];
    let [long, sudden] = [solid(BLOCK, &keys[..1]), solid(BLOCK, &keys)].map(|body| body.sub_step_limit());
    let (bulk, shear): (f64, f64) = (1e6 / 1.2, 1e6 / 2.6);
    let ratio = ((bulk + 4.0 / 3.0 * shear * 1.7) / (bulk + 4.0 / 3.0 * shear)).sqrt();
    assert!((long / sudden - ratio).abs() < 1e-12, "{long} {sudden}");
}

#[test]
fn a_wall_that_pushes_shortens_the_step() {
    // The wall is below the right end of the block: the first particles touch nothing.
    let limit = |by: f64| {
        let shape = "box = { min = [0.0, 0.0], max = [0.2, 0.05] }\n[[shape]]\nname = \"floor\"\nphase = \"wall\"\n\
                     box = { min = [0.15, -0.04], max = [0.25, 0.0] }\ncontact = true";
        let keys = ["solid.artificial_viscosity={linear=0.0,quadratic=0.0}", "numerics.solid_cfl=0.9"];
        let mut body = solid(shape, &keys);
        body.now.displacement[1].fill(by);
        body.evaluate(0.0);
        (body.sub_step_limit(), body.material.pressure_wave_speed() / 0.01)
    };
    let ((free, _), (held, rate)) = (limit(0.0), limit(-0.001));
    // At rest 0.9 / 0.94 of 2 / omega. The wall adds k / m = (c / dx)² / 2 to omega², and half of its damping
    // 2 zeta sqrt(k / m), zeta = 0.2.
    let part = 0.9 / 0.94;
    let omega = ((2.0 * part / free).powi(2) + 0.5 * rate * rate).sqrt();
    let zeta = 0.2 * rate * 0.5_f64.sqrt() / omega;
    let expected = part * 2.0 / omega * ((1.0 + zeta * zeta).sqrt() - zeta);
    assert!((held / expected - 1.0).abs() < 1e-9, "{held} {expected} {free}");
}

#[test]
fn what_arms_remember_is_taken_back_with_a_stage() {
    // A step whose first stage is done twice ends with the bits of one that is not.
    let swung = |again: bool| {
        let mut body = solid(BLOCK, &["solid.prony=[[0.5,0.001]]", "shape.body.velocity=[0.0,0.0]"]);
        body.deform(affine(Matrix::<2>::new(1.02, 0.0, 0.0, 1.0)));
        let load = Load::none(body.particles().len());
        for step in 0..20 {
            let [first, second] = HalfStep::begin(step, 0.0).lasting(4.0 * body.sub_step_limit()).both();
            body.advance(&first, 4, &load).expect("within bounds");
            if again {
                // The second stage begins at n whatever the first one did.
                body.now.velocity.iter_mut().flatten().for_each(|v| *v = 0.0);
                body.evaluate(1e-3);
            }
            body.advance(&second, 4, &load).expect("within bounds");
        }
        body.accelerations()
    };
    assert_eq!(swung(false), swung(true));
}
