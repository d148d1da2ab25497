//! Particle shifting's sums, along with accelerations or alone, have the bits of single passes over fluid and walls.

use super::*;
use crate::Fluid;
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

fn along_as_alone(fluid: &Fluid<2>) {
    let (kernel, isa, shown) = (WendlandC2::<2>::new(H), fluid.isa, &fluid.columns.now);
    let (list, walls) = (&fluid.fluid_list, fluid.walls.as_ref().expect("a tank"));
    let rates = RateLaw { kernel, equations: Momentum, effects: (), targets: shown, sources: shown };

    let mut shifting = ShiftingSums::<2>::new(DX, 0.6 * H * 20.0, 1.0);
    shifting.resize(fluid.columns.slots());
    let mut along = vec![RateSum::default(); list.fours()];
    let at_walls = Some((&walls.shown, &fluid.wall_list));
    shifting.with_accelerations(isa, rates, list, at_walls, &mut along);

    let mut alone = vec![RateSum::default(); list.fours()];
    pair::pass(isa, &rates, list, &mut alone);
    assert_eq!(rates_of(&along), rates_of(&alone));

    let mut own = ShiftingSums::<2>::new(DX, 0.6 * H * 20.0, 1.0);
    own.resize(fluid.columns.slots());
    own.alone(isa, kernel, shown, list, at_walls);
    let at_spacing = 1.0 / kernel.at(DX);
    let law = ShiftingLaw { kernel, at_spacing, targets: shown, sources: shown, flows: true };
    let mut sums = vec![ShiftingSum::<2>::default(); list.fours()];
    pair::pass(isa, &law, list, &mut sums);
    let before: Vec<_> = sums.iter().map(|sum| sum.shift(1.0, 1.0).1).collect();
    let law = ShiftingLaw { sources: &walls.shown, flows: false, ..law };
    pair::pass_adding(isa, &law, &fluid.wall_list, &mut sums);
    let found: Vec<_> = sums.iter().map(|sum| sum.shift(0.6 * H * 20.0, 1.0)).collect();
    for shifting in [&shifting, &own] {
        assert_eq!(bits(shifting.drift.iter().copied()), bits(found.iter().flat_map(|(drift, _)| *drift)));
        assert_eq!(
            bits(shifting.determinant.as_chunks::<LANES>().0.iter().copied()),
            bits(found.iter().map(|(_, determinant)| *determinant))
        );
    }

    let moved = shifting.drift.iter().filter(|drift| drift[0].hypot(drift[1]) > 1e-3).count();
    let beside_walls = found.iter().zip(&before).filter(|((_, after), before)| after != *before).count();
    assert!(moved > 100 && beside_walls > 20, "disorder, and walls: {moved} {beside_walls}");
}

#[test]
fn sums_along_with_accelerations_and_alone_have_the_bits_of_single_passes() {
    for precision in ["double", "mixed"] {
        along_as_alone(&water(precision));
    }
}
