//! Particle shifting's sums along with the rates have the bits of passes of their own.

use super::*;
use crate::Fluid;
use crate::equations::{Both, Momentum};
use crate::motion_tests::run;
use halfstep_role::role::Role;
use halfstep_sph::kernel::WendlandC2;

const DX: f64 = 0.01;
const H: f64 = 2.0 * DX;

/// A column of water that collapses in a tank, after some 60 steps, with the sums of the state there.
fn water(precision: &str) -> Fluid<2> {
    let text = format!(
        "resolution = {DX}\nsmoothing_ratio = 2.0\nend_time = 1.0\n[numerics]\nprecision = \"{precision}\"\n\
         [fluid]\ndensity = 1000.0\nsound_speed = 20.0\n\
         [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [0.2, 0.3] }}\n\
         [[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
         tank = {{ min = [0.0, 0.0], max = [0.4, 0.4], open = [\"top\"] }}\n"
    );
    let scene = halfstep_scene::parse(&text, "water.toml".as_ref(), &[]).unwrap_or_else(|e| panic!("{e:?}"));
    let mut fluid = Fluid::<2>::new(&scene, Isa::detect()).expect("a scene with fluid");
    run(&mut fluid, 0.036, |_, _| ());
    fluid.publish(&[], &mut Vec::new());
    fluid.own_sums();
    fluid
}

fn bits<const N: usize>(numbers: impl Iterator<Item = [f64; N]>) -> Vec<[u64; N]> {
    numbers.map(|each| each.map(f64::to_bits)).collect()
}

fn rates_of(sums: &[RateSum<2>]) -> Vec<[u64; 3]> {
    let each = |sum: &RateSum<2>| -> [[f64; 3]; LANES] {
        let [x, y] = sum.acceleration;
        std::array::from_fn(|k| [x.0[k], y.0[k], sum.density_rate.0[k]])
    };
    bits(sums.iter().flat_map(each))
}

fn along_as_alone<Q: Equations>(fluid: &Fluid<2>, equations: Q) {
    let (kernel, isa, shown) = (WendlandC2::<2>::new(H), fluid.isa, &fluid.columns.now);
    let (list, walls) = (&fluid.fluid_list, fluid.walls.as_ref().expect("a tank"));
    let rates = RateLaw { kernel, equations, effects: (), targets: shown, sources: shown };

    let mut shifting = ShiftingSums::<2>::new(DX, 0.6 * H * 20.0, 1.0);
    shifting.resize(fluid.columns.slots());
    let mut along = vec![RateSum::default(); list.fours()];
    shifting.with_rates(isa, rates, list, Some((&walls.shown, &fluid.wall_list)), &mut along);

    let mut alone = vec![RateSum::default(); list.fours()];
    pair::pass(isa, &rates, list, &mut alone);
    assert_eq!(rates_of(&along), rates_of(&alone));

    let at_spacing = 1.0 / kernel.at(DX);
    let law = ShiftingLaw { kernel, at_spacing, targets: shown, sources: shown, flows: true };
    let at_walls = ShiftingLaw { sources: &walls.shown, flows: false, ..law };
    let mut sums = vec![ShiftingSum::<2>::default(); list.fours()];
    pair::pass(isa, &law, list, &mut sums);
    let before: Vec<_> = sums.iter().map(|sum| sum.shift(1.0, 1.0).1).collect();
    pair::pass_adding(isa, &at_walls, &fluid.wall_list, &mut sums);
    let found: Vec<_> = sums.iter().map(|sum| sum.shift(0.6 * H * 20.0, 1.0)).collect();
    assert_eq!(bits(shifting.drift.iter().copied()), bits(found.iter().flat_map(|(drift, _)| *drift)));
    assert_eq!(
        bits(shifting.determinant.as_chunks::<LANES>().0.iter().copied()),
        bits(found.iter().map(|(_, determinant)| *determinant))
    );

    let moved = shifting.drift.iter().filter(|drift| drift[0].hypot(drift[1]) > 1e-3).count();
    let beside_walls = found.iter().zip(&before).filter(|((_, after), before)| after != *before).count();
    assert!(moved > 100 && beside_walls > 20, "disorder, and walls: {moved} {beside_walls}");
}

#[test]
fn sums_along_with_the_rates_have_the_bits_of_their_own_passes() {
    for precision in ["double", "mixed"] {
        let fluid = water(precision);
        along_as_alone(&fluid, Both);
        along_as_alone(&fluid, Momentum);
    }
}
