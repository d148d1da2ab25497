//! Quick table (work in progress).
mod support;
use halfstep_shared::lane::Isa;
use halfstep_shared::lockstep::on_threads;
use support::{LEAN, Running, collapse, medians, tank};

fn main() {
    let isa = Isa::detect();
    for threads in [1] {
        on_threads(threads, || {
            let with = |extra: &[&'static str]| [LEAN, extra].concat();
            let variants: Vec<(&str, Vec<&str>)> = vec![
                ("lean", with(&[])),
                ("hydrostatic", with(&["fluid.density_diffusion=hydrostatic"])),
                ("delta-sph", with(&["fluid.density_diffusion=delta-sph"])),
                ("cubic", with(&["numerics.kernel=cubic-spline"])),
                ("cubic+delta-sph", vec![]),
            ];
            let mut running: Vec<Running> =
                variants.iter().map(|(_, o)| Running::new(&tank(14000, o), isa)).collect();
            for r in &mut running {
                for _ in 0..50 {
                    r.step();
                }
            }
            let n = running[0].particles();
            let mut work: Vec<Box<dyn FnMut() + '_>> = running
                .iter_mut()
                .map(|r| -> Box<dyn FnMut() + '_> {
                    Box::new(move || {
                        for _ in 0..10 {
                            r.step();
                        }
                    })
                })
                .collect();
            let m = medians(15, &mut work);
            for ((name, _), s) in variants.iter().zip(&m) {
                println!("{threads} {name:<20}{:.2} Mstep/s  {:.2}", n * 10.0 / s * 1e-6, s / m[0]);
            }
        })
        .unwrap();
    }
    if std::env::args().any(|a| a == "violent") {
        on_threads(2, || {
            let mut r = Running::new(&collapse(LEAN), isa);
            r.run_until(0.35);
            let n = r.particles();
            let mut work: Vec<Box<dyn FnMut() + '_>> = vec![Box::new(|| {
                for _ in 0..10 {
                    r.step();
                }
            })];
            let m = medians(15, &mut work);
            println!("violent {:.2}", n * 10.0 / m[0] * 1e-6);
        })
        .unwrap();
    }
}
