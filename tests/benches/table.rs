//! The table of ratios: `cargo bench --bench table [-- huge]`. One line a figure; `target/bench.json` has the same
//! numbers.
//!
//! "Mstep/s" is million fluid particles times whole steps (two stages, walls and neighbour lists included) per second.
//! One-thread figures are CPU time, which other programs on the machine change little; all are medians of interleaved
//! rounds. `huge` adds 4 and 16 million particles (6 GB).

mod support;

use halfstep_fluid::composition::Shares;
use halfstep_role::serve::on_threads;
use halfstep_sph::lane::{Isa, Precision};
use serde_json::{Value, json};
use support::{Clock, LEAN, NARROW, Patch, Running, collapse, medians, naive, tank};

const STEPS: usize = 10;
const ROUNDS: usize = 15;

fn main() {
    let mut report = json!({});
    one(|| passes(&mut report));
    steps(&mut report);
    violent(&mut report);
    let huge = std::env::args().any(|a| a == "huge");
    one(|| sizes(&mut report, huge));
    one(|| solids(&mut report));
    if let Value::Object(figures) = report {
        support::store(figures);
    }
}

fn one<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    on_threads(1, work).expect("a thread")
}

fn line(what: &str, text: String) {
    println!("{what:<44}{text}");
}

/// The pass beside a naive one, by instruction set.
fn passes(report: &mut Value) {
    println!("pair pass, 14 000 particles, pressure + artificial viscosity + simple diffusion, one thread");
    let best = Isa::detect();
    let patch = Patch::new(best);
    let levels = [("AVX-512VL", Isa::Avx512vl), ("AVX2", Isa::Avx2), ("baseline", Isa::Baseline)];
    let precisions = [("", Precision::Double, 1e-11), (", mixed precision", Precision::Mixed, 1e-5)];
    let levels: Vec<_> = levels
        .into_iter()
        .filter(|&(_, isa)| isa <= best)
        .flat_map(|(name, isa)| {
            precisions.map(|(of, precision, bound)| (format!("{name}{of}"), isa, precision, bound))
        })
        .collect();
    let mixed = naive::shuffled(&patch.naive);
    let mixed_grid = naive::Grid::new(&mixed, 2.0 * patch.pass.h);
    let mut work: Vec<Box<dyn FnMut() + '_>> = vec![
        Box::new(|| {
            std::hint::black_box(patch.pass.run(&patch.naive, &patch.grid));
        }),
        Box::new(|| {
            std::hint::black_box(patch.pass.run(&mixed, &mixed_grid));
        }),
    ];
    for &(_, isa, precision, bound) in &levels {
        let mut engine = Patch::with_precision(isa, precision);
        Patch::effects().run(&mut engine);
        let difference = engine.difference();
        // The engine softens distances by 1e-12 h².
        assert!(difference < bound, "the engine and the naive pass agree: {difference}");
        work.push(Box::new(move || Patch::effects().run(&mut engine)));
    }
    let seconds = medians(Clock::Cpu, 41, &mut work);
    let of_particle = |s: f64| 1e9 * s / 14_000.0;
    let [in_order, mixed, engine @ ..] = &seconds[..] else { return };
    for (name, s) in [("naive, lattice order", in_order), ("naive, mixed order", mixed)] {
        line(&format!("  {name}"), format!("{:7.1} ns a particle", of_particle(*s)));
        report["pass"][name] = json!({ "ns": of_particle(*s) });
    }
    for ((name, ..), s) in levels.iter().zip(engine) {
        line(
            &format!("  engine, {name}"),
            format!(
                "{:7.1} ns a particle, {:4.1} and {:4.1} times faster",
                of_particle(*s),
                in_order / s,
                mixed / s
            ),
        );
        report["pass"][name.as_str()] = json!({
            "ns": of_particle(*s),
            "times_faster_than_lattice_order": in_order / s,
            "times_faster_than_mixed_order": mixed / s,
        });
    }
}

/// Whole steps of a tank at rest, by effects and threads.
fn steps(report: &mut Value) {
    let with = |extra: &[&'static str]| [LEAN, extra].concat();
    let variants: Vec<(&str, Vec<&str>)> = vec![
        ("lean: Wendland C2, simple diffusion", with(&[])),
        ("no diffusion", with(&["fluid.density_diffusion=none"])),
        ("hydrostatic diffusion", with(&["fluid.density_diffusion=hydrostatic"])),
        ("delta-SPH", with(&["fluid.density_diffusion=delta-sph"])),
        (
            "delta-SPH, gradient at both stages",
            with(&[
                "fluid.density_diffusion=delta-sph",
                "effects.frozen-diffusion=off",
                "fluid.time_integration=midpoint",
            ]),
        ),
        (
            "hydrostatic diffusion by the midpoint rule",
            with(&["fluid.density_diffusion=hydrostatic", "fluid.time_integration=midpoint"]),
        ),
        ("cubic spline", with(&["numerics.kernel=cubic-spline"])),
        ("physical viscosity", with(&["fluid.viscosity=1.0", "effects.viscosity=on"])),
        ("the defaults of water alone: h / dx = 2, shifting", vec![]),
        ("lean and narrow: h / dx = 1.33, no shifting", with(NARROW)),
    ];
    for threads in [1, 2] {
        println!("\nwhole step, 14 000 particles in a tank, {threads} thread(s)");
        let clock = if threads == 1 { Clock::Cpu } else { Clock::Wall };
        let (seconds, n) = on_threads(threads, || {
            let mut running: Vec<Running> =
                variants.iter().map(|(_, o)| Running::fluid(&tank(14_000, o), Isa::preferred())).collect();
            let n = running[0].particles();
            (timed(clock, &mut running), n)
        })
        .expect("threads");
        for ((name, _), s) in variants.iter().zip(&seconds) {
            let rate = n * STEPS as f64 / s * 1e-6;
            line(
                &format!("  {name}"),
                format!("{rate:6.2} Mstep/s, {:5.2} times the lean step", s / seconds[0]),
            );
            report["step"][format!("{threads} threads")][*name] =
                json!({ "mstep_per_s": rate, "over_lean": s / seconds[0] });
        }
    }
}

fn timed(clock: Clock, running: &mut [Running]) -> Vec<f64> {
    for r in running.iter_mut() {
        (0..50).for_each(|_| {
            r.step();
        });
    }
    let mut work: Vec<Box<dyn FnMut() + '_>> = running
        .iter_mut()
        .map(|r| -> Box<dyn FnMut() + '_> {
            Box::new(move || {
                (0..STEPS).for_each(|_| {
                    r.step();
                });
            })
        })
        .collect();
    medians(clock, ROUNDS, &mut work)
}

/// A collapsed column 0.35 s after its release, splashing.
fn violent(report: &mut Value) {
    println!("\nwhole step, violent flow, 14 000 particles");
    for (name, more) in [("lean", &[][..]), ("lean and narrow", NARROW)] {
        for threads in [1, 2] {
            let clock = if threads == 1 { Clock::Cpu } else { Clock::Wall };
            let rate = on_threads(threads, || {
                let mut running = [Running::fluid(&collapse(&[LEAN, more].concat()), Isa::preferred())];
                running[0].run_until(0.35);
                let n = running[0].particles();
                n * STEPS as f64 / timed(clock, &mut running)[0] * 1e-6
            })
            .expect("threads");
            line(&format!("  {name}, {threads} thread(s)"), format!("{rate:6.2} Mstep/s"));
            report["violent"][name][format!("{threads} threads")] = json!(rate);
        }
    }
}

/// Cost and memory of a particle by the number of particles.
fn sizes(report: &mut Value, huge: bool) {
    println!("\ncost of a particle's step by size, lean and with the defaults, one thread");
    let mut sizes = vec![14_000, 100_000, 1_000_000];
    if huge {
        sizes.extend([4_000_000, 16_000_000]);
    }
    let mut first = [0.0; 2];
    for n in sizes {
        let mut costs = [0.0; 2];
        let mut bytes = [0.0; 2];
        for (k, overrides) in [LEAN, &[]].into_iter().enumerate() {
            let mut running = Running::fluid(&tank(n, overrides), Isa::preferred());
            let particles = running.particles();
            let steps = (1_400_000 / n).clamp(2, 100);
            (0..2).for_each(|_| {
                running.step();
            });
            let mut work: Vec<Box<dyn FnMut() + '_>> = vec![Box::new(|| {
                (0..steps).for_each(|_| {
                    running.step();
                });
            })];
            let rounds = if n > 200_000 { 3 } else { 7 };
            costs[k] = 1e9 * medians(Clock::Cpu, rounds, &mut work)[0] / (particles * steps as f64);
            drop(work);
            bytes[k] = running.bytes_per_particle();
        }
        if first == [0.0; 2] {
            first = costs;
        }
        let [lean, full] = costs;
        line(
            &format!("  {n} particles"),
            format!(
                "{lean:6.1} ns ({:4.2}), {:3.0} bytes; {full:6.1} ns ({:4.2}), {:3.0} bytes",
                lean / first[0],
                bytes[0],
                full / first[1],
                bytes[1]
            ),
        );
        report["size"][n.to_string()] = json!({
            "lean": { "ns": lean, "over_14000": lean / first[0], "bytes": bytes[0] },
            "defaults": { "ns": full, "over_14000": full / first[1], "bytes": bytes[1] },
        });
    }
}

/// A solid step by model.
fn solids(report: &mut Value) {
    println!("\nsolid step (two evaluations), oscillating plate 20 across, one thread");
    let path = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/oscillating-plate.toml"));
    let scene = |model: &str| {
        let overrides = ["resolution=0.001".to_owned(), format!("solid.model={model}")];
        halfstep_scene::load(path, &overrides).unwrap_or_else(|e| panic!("{e:?}"))
    };
    let models = ["hypoelastic", "total-lagrangian"];
    let mut running: Vec<Running> = models.iter().map(|m| Running::solid(&scene(m))).collect();
    let n = running[0].particles();
    let seconds = timed(Clock::Cpu, &mut running);
    for (model, s) in models.iter().zip(&seconds) {
        let rate = n * STEPS as f64 / s * 1e-6;
        line(&format!("  {model}"), format!("{rate:6.2} Mstep/s, {:4.2} times hypoelastic", s / seconds[0]));
        report["solid"][*model] = json!({ "mstep_per_s": rate, "over_hypoelastic": s / seconds[0] });
    }
}
