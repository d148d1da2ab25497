//! Remarks on how a run went.

use halfstep_output::RunReport;
use halfstep_scene::EnergyPart;

/// Density error that a weakly compressible fluid should stay below.
const DENSITY_ERROR: f64 = 0.03;
/// Distance of fluid and solid particles that says that one went into the other, over the mean spacing.
const CLOSEST: f64 = 0.1;

/// Energy that a contact may give to two solids, over its largest force times its largest penetration.
const CREATED: f64 = 0.1;

/// Part of the largest energy that the ledger may leave to the error of time integration.
const RESIDUAL: f64 = 0.05;

/// What at the end of a run says that its result is not to be trusted as it is.
pub fn outcome(report: &RunReport) -> Vec<String> {
    let mut all = Vec::new();
    let (removed, fluid) = (report.particles.removed, report.particles.fluid);
    if removed > 0 {
        all.push(format!("{removed} of {fluid} fluid particles left the domain"));
    }
    if let Some(error) = report.audit.density_error.filter(|error| *error > DENSITY_ERROR) {
        all.push(format!(
            "density error up to {:.0} %: the fluid was compressed or torn somewhere",
            100.0 * error
        ));
    }
    if let Some(gap) = report.audit.min_gap.filter(|gap| *gap < CLOSEST) {
        all.push(format!("fluid and solid came as close as {gap:.3} dx"));
    }
    for contact in &report.contacts {
        if contact.normal > CREATED * contact.largest_force * contact.largest_penetration {
            all.push(format!(
                "contact of {} gave them {:.2e} J instead of taking some: say a `stiffness` or a shorter step",
                contact.solids.join(" and "),
                contact.normal
            ));
        }
    }
    if let Some(energy) = &report.energy {
        if energy.relative_residual > RESIDUAL {
            let percent = 100.0 * energy.relative_residual;
            all.push(format!(
                "the energy ledger leaves {percent:.0} % unexplained: the time step is too long"
            ));
        }
        for participant in &energy.participants {
            let fracture = energy.joules(&participant.name, EnergyPart::Fracture);
            if let Some(given) = fracture.filter(|given| *given > 0.0) {
                all.push(format!(
                    "cracks of the {} gave it {given:.2e} J instead of taking some",
                    participant.name
                ));
            }
        }
    }
    all
}
