//! Two laws in one pass have the bits that each has in its own.

use super::*;
use crate::extrapolation::{Extrapolation, ExtrapolationSum};
use crate::kernel::{Kernel, WendlandC2};
use crate::neighbours::Rows;

const H: f64 = 1.5;

impl<K: Kernel<D>, const D: usize> Along<Self, D> for Extrapolation<'_, K, D> {
    fn along(&self, other: &Self) -> Self {
        Self { kernel: other.kernel, targets: other.targets, sources: other.sources, ..*self }
    }
    fn targets<L: Lanes>(_: &()) {}
}

#[test]
fn two_laws_in_one_pass_have_the_bits_of_their_own() {
    let isa = Isa::detect();
    let mut x: [Vec<f64>; 2] = [
        (0..900).map(|k| (k % 30) as f64 + 0.3 * (k as f64).sin()).collect(),
        (0..900).map(|k| (k / 30) as f64 + 0.3 * (1.7 * k as f64).cos()).collect(),
    ];
    let mut id: Vec<u32> = (0..900).collect();
    let mut rows = Rows::<2>::new(Precision::Double);
    rows.sort(&x, &id, 2.0, [0.0; 2], [1e4; 2]);
    x.iter_mut().for_each(|column| rows.permute(column));
    rows.permute_ids(&mut id);
    // The second set of neighbours: the same a little aside.
    let aside: [Vec<f64>; 2] = [x[0].iter().map(|x| x + 0.4).collect(), x[1].clone()];
    let listed = |sources: &[Vec<f64>; 2], reach: f64| {
        let mut list = ClusterList::new(isa);
        list.build(&x, sources, &rows, reach);
        list
    };
    let (list, more) = (listed(&x, 2.2 * H), listed(&aside, 2.5 * H));
    assert!(list.fours() > TASK_FOURS, "several tasks");

    let slots = id.len();
    let density = vec![1000.0; slots];
    let pressures: [Vec<f64>; 2] =
        [0.3, 0.7].map(|k| (0..slots).map(|slot| 100.0 * (k * slot as f64).cos()).collect());
    let law = |sources, pressure| Extrapolation {
        kernel: WendlandC2::<2>::new(H),
        gravity: [0.0, -9.81],
        targets: &x,
        sources,
        density: &density,
        pressure,
    };
    let [first, second] = [law(&x, &pressures[0]), law(&x, &pressures[1])];
    let onward = law(&aside, &pressures[0]);

    let none = vec![ExtrapolationSum::<Lane>::default(); list.fours()];
    let mut alone = [none.clone(), none.clone()];
    pass(isa, &first, &list, &mut alone[0]);
    pass(isa, &second, &list, &mut alone[1]);
    let before = bits(&alone[1]);
    pass_adding(isa, &onward, &more, &mut alone[1]);
    assert_ne!(before, bits(&alone[1]), "the second set counts");

    let mut together = [none.clone(), none];
    let mut slots_of = vec![0; list.fours()];
    let [sums, out] = &mut together;
    let laws = (first, second);
    let finish = |slot, sum: &ExtrapolationSum| (*sum, slot);
    pass_together(isa, laws, &list, Some((onward, &more)), sums, finish, (&mut *out, &mut slots_of));
    assert!(slots_of.iter().enumerate().all(|(four, slot)| *slot == four * LANES));
    assert_eq!(alone.each_ref().map(|sums| bits(sums)), together.each_ref().map(|sums| bits(sums)));

    let [sums, out] = &mut together;
    pass_together(isa, laws, &list, None, sums, finish, (&mut *out, &mut slots_of));
    assert_eq!(before, bits(out));

    pass_onward(isa, second, &list, Some((onward, &more)), finish, (&mut *out, &mut slots_of));
    assert_eq!(bits(&alone[1]), bits(out));

    let more = |sum: &ExtrapolationSum, out: &mut usize| *out += usize::from(sum.weight(0) > 0.0);
    pass_changing(isa, &laws.0, &list, more, &mut slots_of);
    assert!(slots_of.iter().enumerate().all(|(four, slot)| *slot == four * LANES + 1));
}

fn bits(sums: &[ExtrapolationSum]) -> Vec<[u64; 2]> {
    let each = |sum: &ExtrapolationSum| -> [[u64; 2]; LANES] {
        std::array::from_fn(|k| [sum.weight(k).to_bits(), sum.pressure(k).unwrap_or(0.0).to_bits()])
    };
    sums.iter().flat_map(each).collect()
}
