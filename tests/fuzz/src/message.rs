//! Messages of other participants.

use halfstep_link::{Expect, Identities, LinkConfig, StateCheck, verify_forces, verify_probes};
use halfstep_wire::half_step::Stage;
use halfstep_wire::protocol::{
    ForceHeader, ForceRecord, PROTOCOL, Plain, ProbeHeader, SCHEMA, StateHeader, StateRecord, order, status,
};

/// Room for records in a message.
const CAPACITY: u32 = 8;
/// Number of the run.
const RUN: u64 = 7;

/// The bytes of a message, taken off the front; zeros where they end.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn take<T: Plain>(&mut self) -> T {
        let mut value = T::default();
        let count = size_of::<T>().min(self.0.len());
        let (now, later) = self.0.split_at(count);
        self.0 = later;
        // SAFETY: `value` has at least `count` bytes, and every bit pattern is a value of `T`.
        unsafe { std::ptr::copy_nonoverlapping(now.as_ptr(), (&raw mut value).cast::<u8>(), count) };
        value
    }

    fn byte(&mut self) -> u8 {
        let (first, later) = self.0.split_first().map_or((0, self.0), |(first, later)| (*first, later));
        self.0 = later;
        first
    }

    fn records<T: Plain>(&mut self, count: usize) -> Vec<T> {
        (0..count).map(|_| self.take()).collect()
    }
}

/// Up to eight messages after one another: a byte says which kind, a second one how many records it has, a third one
/// whether its identity (run, protocol, schema, step) is put right, so that the checks behind see something.
///
/// # Panics
/// What was accepted is not what a receiver relies on.
pub fn message(bytes: &[u8]) {
    let mut bytes = Bytes(bytes);
    let mut config = LinkConfig::of_two(CAPACITY, CAPACITY);
    config.run_id = RUN;
    let mut checks = [StateCheck::new(&config, 0), StateCheck::new(&config, 1)];
    let mut sent = Identities::new(CAPACITY);
    sent.begin(1);
    (0..3).for_each(|id| sent.push(id));
    for step in 0..8 {
        let (kind, count, right) = (bytes.byte(), usize::from(bytes.byte() % 12), bytes.byte());
        let expect = expect(step, kind >> 4);
        match kind % 4 {
            place @ (0 | 1) => {
                state(&mut checks[usize::from(place)], &mut bytes, count, right, &expect, step)
            }
            2 => forces(&sent, &mut bytes, count, right, step),
            _ => probes(&config, &mut bytes, count, right, step),
        }
        if bytes.0.is_empty() {
            return;
        }
    }
}

/// The message that is due, of four kinds.
fn expect(step: u64, kind: u8) -> Expect {
    match kind % 4 {
        0 => Expect::new(step, Stage::First).time(0.0),
        1 => Expect::new(step, Stage::Second).dt(0.0),
        2 => Expect::new(step, Stage::First),
        _ => Expect::last(step),
    }
}

fn state(check: &mut StateCheck, bytes: &mut Bytes<'_>, count: usize, right: u8, expect: &Expect, step: u64) {
    let mut header: StateHeader = bytes.take();
    let records: Vec<StateRecord> = bytes.records(count);
    if right & 1 == 0 {
        (header.run_id, header.schema, header.protocol, header.step) = (RUN, SCHEMA, PROTOCOL, step);
        (header.count, header.status) = (count as u32, header.status % 4);
    }
    if check.verify(&header, &records, expect).is_err()
        || matches!(header.status, status::DIVERGED | status::FAILED)
    {
        return;
    }
    assert_eq!((header.run_id, header.schema, header.protocol), (RUN, SCHEMA, PROTOCOL));
    assert!(records.len() == header.count as usize && records.len() <= CAPACITY as usize);
    assert_eq!(header.step, step);
    assert!(records.windows(2).all(|pair| pair[0].id < pair[1].id), "one particle twice");
    for record in &records {
        let all = record.position.iter().chain(&record.velocity).chain(&record.deviatoric_stress);
        assert!(all.chain([&record.pressure]).all(|value| value.is_finite()));
        let positive = |value: f64| value.is_finite() && value > 0.0;
        assert!(positive(record.density) && positive(record.mass));
    }
    if !expect.is_last() {
        assert!(header.time.is_finite() && header.dt.is_finite() && header.dt_limit.is_finite());
    }
}

fn forces(sent: &Identities, bytes: &mut Bytes<'_>, count: usize, right: u8, step: u64) {
    let mut header: ForceHeader = bytes.take();
    let records: Vec<ForceRecord> = bytes.records(count);
    if right & 1 == 0 {
        (header.run_id, header.schema, header.protocol, header.step) = (RUN, SCHEMA, PROTOCOL, step);
        header.count = count as u32;
    }
    let expect = expect(step, right >> 1);
    if verify_forces(RUN, sent, &header, &records, &expect).is_err() || header.order & order::STOP != 0 {
        return;
    }
    assert!(header.dt > 0.0 && header.dt.is_finite() && header.next_time.is_finite());
    assert_eq!(records.len(), 3);
    for (id, record) in records.iter().enumerate() {
        assert_eq!(record.id as usize, id);
        assert!(record.cross_viscosity.iter().chain(&record.stress_force).all(|value| value.is_finite()));
    }
}

fn probes(config: &LinkConfig, bytes: &mut Bytes<'_>, count: usize, right: u8, step: u64) {
    let mut header: ProbeHeader = bytes.take();
    let values: Vec<f64> = bytes.records(count);
    if right & 1 == 0 {
        (header.run_id, header.schema, header.protocol, header.step) = (RUN, SCHEMA, PROTOCOL, step);
    }
    if verify_probes(RUN, &config.participants[1], &header, &values, step).is_ok() {
        assert_eq!(values.len(), config.participants[1].probes as usize);
    }
}
