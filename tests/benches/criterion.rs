//! Criterion benchmarks of what a step is made of; `table` prints the ratios.

mod support;

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use halfstep_fluid::composition::Shares;
use halfstep_sph::lane::Isa;
use halfstep_sph::neighbours::{ClusterList, Rows};
use support::{Patch, Running, tank};

fn passes(c: &mut Criterion) {
    let mut group = c.benchmark_group("pass");
    group.throughput(Throughput::Elements(14_000));
    let mut patch = Patch::new(Isa::preferred());
    group.bench_function("engine", |b| b.iter(|| Patch::effects().run(&mut patch)));
    let patch = Patch::new(Isa::preferred());
    group.bench_function("naive", |b| b.iter(|| patch.pass.run(&patch.naive, &patch.grid)));
    group.finish();
}

fn lists(c: &mut Criterion) {
    let n = 14_000;
    let x: Vec<f64> = (0..n).map(|k| f64::from(k % 140)).collect();
    let y: Vec<f64> = (0..n).map(|k| f64::from(k / 140)).collect();
    let id: Vec<u32> = (0..n as u32).collect();
    let mut group = c.benchmark_group("neighbours");
    group.throughput(Throughput::Elements(n as u64));
    group.bench_function("sort and list", |b| {
        b.iter_batched(
            || ([x.clone(), y.clone()], Rows::<2>::default(), ClusterList::new(Isa::preferred())),
            |(mut x, mut rows, mut list)| {
                rows.sort(&x, &id, 2.0, [-1.0; 2], [1e3; 2]);
                x.iter_mut().for_each(|column| rows.permute(column));
                list.build(&x, &x, &rows, 2.3 * 1.33);
                list
            },
            BatchSize::LargeInput,
        );
    });
    group.finish();
}

fn steps(c: &mut Criterion) {
    let mut group = c.benchmark_group("step");
    group.sample_size(20);
    for (name, overrides) in [("lean", support::LEAN), ("defaults", &[])] {
        let mut running = Running::fluid(&tank(14_000, overrides), Isa::preferred());
        group.throughput(Throughput::Elements(running.particles() as u64));
        group.bench_function(name, |b| b.iter(|| running.step()));
    }
    group.finish();
}

criterion_group!(benches, passes, lists, steps);
criterion_main!(benches);
