//! Total momentum of fluid and solid together, measured on the particles themselves: what one phase applies is what the
//! other one feels.

use halfstep::{RunReport, Simulation, scene};
use halfstep_output::run_json::ForceKind;
use halfstep_scene::EnergyPart;
use std::path::Path;

/// A drop that hits the middle of a free plate and one that hits its end, without gravity, walls and clamps.
const FREE: &str = r#"
    resolution = 0.005
    end_time = 0.02
    gravity = [0.0, 0.0]
    [fluid]
    density = 1000.0
    sound_speed = 60.0
    [solid]
    density = 1200.0
    youngs_modulus = 1e6
    poissons_ratio = 0.3
    [[shape]]
    name = "plate"
    phase = "solid"
    box = { min = [0.0, 0.0], max = [0.02, 0.12] }
    [[shape]]
    name = "drop"
    phase = "fluid"
    disc = { center = [-0.03, 0.06], radius = 0.02 }
    velocity = [5.0, 1.0]
    [[shape]]
    name = "second"
    phase = "fluid"
    disc = { center = [0.055, 0.11], radius = 0.02 }
    velocity = [-3.0, 0.0]
"#;

fn run(overrides: &[&str]) -> RunReport {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.into()).collect();
    let scene = scene::parse(FREE, Path::new("free.toml"), &overrides).unwrap_or_else(|e| panic!("{e:?}"));
    Simulation::new(scene).run().expect("a run")
}

#[test]
fn a_free_impact_keeps_the_total_momentum() {
    for overrides in [
        &[][..],
        &["effects.thin-plate-screen=off"],
        &["interface.cross_viscosity_far=1.0"],
        &["numerics.max_sub_steps=1"],
        &["shape.plate.spacing=0.0025"],
        &["solid.model=hypoelastic"],
        &["fluid.viscosity=5", "effects.viscosity=on"],
        &["fluid.viscosity=5", "effects.viscosity=on", "effects.thin-plate-screen=off"],
        &["solid.model=hypoelastic", "interface.treatment=phase-blind"],
    ] {
        let report = run(overrides);
        let drift = report.audit.momentum_drift.expect("nothing outside acts");
        println!("{overrides:?}: {drift:e}, closest {:?} dx", report.audit.min_gap);
        assert!(
            report.audit.min_gap.is_some_and(|gap| gap < 2.0),
            "{overrides:?}: within reach, 3 dx: {:?}",
            report.audit
        );
        assert!(drift < 1e-12, "{overrides:?}: {drift:e}");
    }
}

/// The solid keeps its own ledger, by the ways of its particles in sub-steps; the coupler books what it sends.
#[test]
fn work_by_kind_is_that_of_the_solids_ledger() {
    let probe = "\n[[probe]]\nname = \"plate\"\nkind = \"energy\"\nphase = \"solid\"\n";
    for overrides in [&[][..], &["interface.cross_viscosity_far=1.0"], &["numerics.max_sub_steps=1"]] {
        let overrides: Vec<String> = overrides.iter().map(|&o| o.into()).collect();
        let text = format!("{FREE}{probe}");
        let scene =
            scene::parse(&text, Path::new("free.toml"), &overrides).unwrap_or_else(|e| panic!("{e:?}"));
        let report = Simulation::new(scene).run().expect("a run");
        let energy = report.energy.as_ref().expect("a ledger");
        for (kind, part) in [
            (ForceKind::Stress, EnergyPart::InterfacePressure),
            (ForceKind::CrossViscosity, EnergyPart::CrossViscosity),
        ] {
            let sent = report.forces.iter().find(|by| by.kind == kind).expect("it acts");
            let own = energy.joules("solid", part).expect("a part");
            println!("{overrides:?} {kind}: {sent:?}, ledger {own}");
            assert!(own.abs() > 1e-6 && (sent.work / own - 1.0).abs() < 1e-9, "{sent:?} {own}");
        }
    }
}

#[test]
fn particles_that_leave_are_no_drift() {
    // The second drop flies on through the border at 0.06 m.
    let away = [
        "shape.second.velocity=[3.0, 0.0]",
        "numerics.domain={ min = [-0.2, -0.2], max = [0.08, 0.3] }",
        "end_time=0.01",
    ];
    let report = run(&away);
    assert!(report.particles.removed > 0, "{:?}", report.particles);
    assert!(report.audit.momentum_drift.is_some_and(|drift| drift < 1e-12), "{:?}", report.audit);
    let lost = report.particles.removed;
    let said = format!("{lost} of {} fluid particles left the domain", report.particles.fluid);
    assert!(report.warnings.contains(&said), "{:?}", report.warnings);
}

#[test]
fn what_begins_outside_of_the_domain_counts_among_what_left_it() {
    // The border goes through the middle of the second drop.
    let domain = "numerics.domain={ min = [-0.2, -0.2], max = [0.056, 0.3] }".to_owned();
    let end = "end_time=1e-5".to_owned();
    let scene =
        scene::parse(FREE, Path::new("free.toml"), &[domain, end]).unwrap_or_else(|e| panic!("{e:?}"));
    let layout = halfstep_scene::geometry::layout::<2>(&scene);
    let outside = layout.fluid.iter().filter(|p| p.position[0] > 0.056).count();
    assert!(outside > 10, "{outside}");
    let report = Simulation::new(scene).run().expect("a run");
    assert_eq!(report.particles.removed, outside as u64);
    let said = format!("{outside} of {} fluid particles left the domain", layout.fluid.len());
    assert!(report.warnings.contains(&said), "{:?}", report.warnings);
}
