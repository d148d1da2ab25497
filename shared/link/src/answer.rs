//! What every answer of the coupler must satisfy before anybody uses it.

use super::check::Check;
use super::records::{are_possible, copy_checked};
use super::{Expect, Identities, LinkError};
use halfstep_wire::Name;
use halfstep_wire::half_step::Stage;
use halfstep_wire::protocol::{ForceHeader, ForceRecord, order};

/// Checks the coupler's answer to an own state of these particles.
///
/// # Errors
/// What is wrong with it: the field, what was expected and found.
pub fn verify_forces(
    run_id: u64,
    sent: &Identities,
    header: &ForceHeader,
    records: &[ForceRecord],
    expect: &Expect,
) -> Result<(), LinkError> {
    if !forces_follow(run_id, sent, header, records.len(), expect)? || are_possible(&sent.ids, records) {
        return Ok(());
    }
    find_wrong_force(sent, records, expect)
}

/// Copies the coupler's answer to `records`, and checks it and the copies as [`verify_forces`] does.
///
/// # Errors
/// As for [`verify_forces`].
pub(super) fn take_forces(
    run_id: u64,
    sent: &Identities,
    header: &ForceHeader,
    from: &[ForceRecord],
    expect: &Expect,
    records: &mut Vec<ForceRecord>,
) -> Result<(), LinkError> {
    records.clear();
    let checked = forces_follow(run_id, sent, header, from.len(), expect)?;
    if copy_checked(&sent.ids, from, records) || !checked {
        return Ok(());
    }
    find_wrong_force(sent, records, expect).inspect_err(|_| records.clear())
}

/// Whether the header says that the run goes on, with forces for the particles that were sent.
fn forces_follow(
    run_id: u64,
    sent: &Identities,
    header: &ForceHeader,
    count: usize,
    expect: &Expect,
) -> Result<bool, LinkError> {
    let check = Check { peer: Name::COUPLER, expect };
    check.identity(run_id, header.run_id, header.protocol, header.schema)?;
    check.equal("count", count, header.count as usize)?;
    check.position(header.step, header.stage, header.time, header.dt)?;
    check.finite("next_time", header.next_time)?;
    let stops = header.order & order::STOP != 0;
    if stops == (header.order & order::GO != 0) {
        return Err(check.mismatch("order", "one of go and stop", header.order));
    }
    if stops {
        check.equal("stage", Stage::First.number(), header.stage)?;
        return Ok(false);
    }
    if header.dt <= 0.0 {
        return Err(check.mismatch("dt", "a positive number", header.dt));
    }
    check.equal("epoch", sent.epoch.unwrap_or_default(), header.epoch)?;
    check.equal("count", sent.ids.len(), count)?;
    Ok(true)
}

fn find_wrong_force(sent: &Identities, records: &[ForceRecord], expect: &Expect) -> Result<(), LinkError> {
    let check = Check { peer: Name::COUPLER, expect };
    for (id, record) in sent.ids.iter().zip(records) {
        check.equal("id", *id, record.id)?;
        if let Some((field, value)) = force_values(record).find(|(_, value)| !value.is_finite()) {
            return Err(check.not_finite(field, Some(record.id), value));
        }
    }
    Ok(())
}

fn force_values(r: &ForceRecord) -> impl Iterator<Item = (&'static str, f64)> {
    let named = |name: &'static str, values: [f64; 3]| values.into_iter().map(move |v| (name, v));
    named("cross_viscosity", r.cross_viscosity).chain(named("stress_force", r.stress_force))
}
