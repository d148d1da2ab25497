//! How many targets are computed at once does not show in the bits.

use super::*;
use crate::extrapolation::{Extrapolation, ExtrapolationSum};
use crate::kernel::{Kernel, WendlandC2};
use crate::neighbours::{PADDING, Rows};

/// Pressure at each of 400 places in several rows, as many targets at once as the lanes have.
fn pressures<const D: usize, A: Arch, L: Lanes>() -> Vec<Option<f64>> {
    let h = 1.5;
    let place = |k: usize, d: usize| match d {
        0 => (k % 40) as f64 + 0.3 * (k as f64).sin(),
        1 => (k / 40 % 10) as f64 + 0.3 * (1.7 * k as f64).cos(),
        _ => 0.5 * (k as f64).sin(),
    };
    let mut x: [Vec<f64>; D] = std::array::from_fn(|d| (0..400).map(|k| 1e3 + place(k, d)).collect());
    let mut id: Vec<u32> = (0..400).collect();
    let mut rows = Rows::<D>::new(Precision::Mixed);
    rows.sort(&x, &id, 2.0, [0.0; D], [1e4; D]);
    x.iter_mut().for_each(|column| rows.permute(column));
    rows.permute_ids(&mut id);
    let slots = id.len();
    let mut list = ClusterList::of_width(L::TARGETS);
    list.build(&x, &x, &rows, 2.2 * h);
    let density: Vec<f64> = (0..slots).map(|slot| 1000.0 + (0.1 * slot as f64).sin()).collect();
    let pressure: Vec<f64> = (0..slots).map(|slot| 100.0 * (0.3 * slot as f64).cos()).collect();
    let gravity = std::array::from_fn(|d| if d == 1 { -9.81 } else { 0.0 });
    let (kernel, density, pressure) = (WendlandC2::<D>::new(h), &density[..], &pressure[..]);
    let law = Extrapolation { kernel, gravity, targets: &x, sources: &x, density, pressure };
    let mut sums = vec![ExtrapolationSum::<Lane>::default(); list.fours()];
    for task in 0..list.fours().div_ceil(TASK_FOURS) {
        let out = &mut sums[task * TASK_FOURS..];
        let len = out.len().min(TASK_FOURS);
        run::<D, _, _, _, A, L>(
            (&law, &list),
            task,
            Replace(|_, sum: &ExtrapolationSum| *sum),
            &mut out[..len],
        );
    }
    let real = (0..slots).filter(|&slot| id[slot] != PADDING);
    real.map(|slot| sums[slot / LANES].pressure(slot % LANES)).collect()
}

fn widths_agree<const D: usize>() {
    let doubles = pressures::<D, Unfused, Lane>();
    assert_eq!(doubles.iter().flatten().count(), 400);
    assert_eq!(doubles, pressures::<D, Unfused, Eight>());
    let singles = pressures::<D, Unfused, Single<LANES>>();
    assert_eq!(singles, pressures::<D, Unfused, Single<WIDEST>>());
    assert_eq!(singles, pressures::<D, Unfused, Single<WIDEST_SINGLE>>());
    assert_eq!(pressures::<D, Fused, Single<WIDEST>>(), pressures::<D, Fused, Single<WIDEST_SINGLE>>());
    // A rounding of single precision is 6e-8 of the sum's largest part, 1e3 times the head of 3 m.
    let apart = doubles.iter().zip(&singles).map(|(a, b)| (a.unwrap() - b.unwrap()).abs());
    let worst = apart.fold(0.0, f64::max);
    assert!(worst > 0.0 && worst < 1e-6 * 3e4, "{worst}");
}

#[test]
fn widths_agree_in_the_plane() {
    widths_agree::<2>();
}

#[test]
fn widths_agree_in_space() {
    widths_agree::<3>();
}
