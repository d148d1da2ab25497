//! The timeline of half-steps: what the participants of a thread do, and when, recorded over a window of steps.
//!
//! A thread that drives participants or couples them has one recorder or none. Without one a phase costs a branch and
//! nothing is allocated. Times are those of the system's monotonic clock, which all processes of a machine share, so
//! that their parts fit into one picture.

mod window;
pub use window::{BadWindow, Window};

use halfstep_link::LinkTimes;
use halfstep_wire::Name;
use halfstep_wire::half_step::{HalfStep, Stage};
use std::cell::{Cell, RefCell};
use std::marker::PhantomData;
use std::time::{Duration, Instant};

/// Events of a thread that are kept at most: some twenty megabytes.
const MOST_EVENTS: usize = 200_000;
/// Events of a half-step of one participant that room is made for.
const USUAL_EVENTS: usize = 40;

/// What an event is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A whole half-step; everything else lies within one or between two.
    HalfStep,
    /// Computing.
    Compute,
    /// Waiting for others.
    Wait,
    /// Sending, and taking over what has come.
    Message,
    /// Handing over what is written, and measuring it.
    Output,
}

impl Kind {
    /// The category of the trace event file.
    pub const fn name(self) -> &'static str {
        match self {
            Self::HalfStep => "half-step",
            Self::Compute => "compute",
            Self::Wait => "wait",
            Self::Message => "message",
            Self::Output => "output",
        }
    }
}

/// Something that took time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// Who was busy or waited: a participant, or the coupler.
    pub track: Name,
    /// What it is about.
    pub kind: Kind,
    /// Name of the phase.
    pub what: &'static str,
    /// Whose message it is, if it is about one.
    pub with: Option<Name>,
    /// Beginning and end on the system's monotonic clock, ns.
    pub span: [u64; 2],
    /// The half-step that it belongs to.
    pub step: u64,
    /// Its stage.
    pub stage: Stage,
}

/// What a thread recorded.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// By their ends.
    pub events: Vec<Event>,
    /// Phases for which there was no room; no half-step is among them.
    pub lost: u64,
}

/// Takes what a thread recorded: when the window has been passed, or the recording ends before.
pub type Deliver = Box<dyn FnOnce(Part)>;

struct Recorder {
    window: Window,
    /// The same moment on two clocks: that of [`Instant`], and the system's monotonic one, ns.
    anchor: (Instant, u64),
    track: Name,
    half_step: (u64, Stage),
    part: Part,
    deliver: Deliver,
}

impl Recorder {
    fn push(&mut self, kind: Kind, what: &'static str, with: Option<Name>, span: [Instant; 2]) {
        if kind != Kind::HalfStep && self.part.events.len() >= MOST_EVENTS {
            self.part.lost += 1;
            return;
        }
        let (instant, nanoseconds) = self.anchor;
        let span = span.map(|at| nanoseconds + at.saturating_duration_since(instant).as_nanos() as u64);
        let (step, stage) = self.half_step;
        self.part.events.push(Event { track: self.track, kind, what, with, span, step, stage });
    }
}

/// How far the recording of this thread is.
#[derive(Clone, Copy, PartialEq)]
enum Progress {
    /// Nothing is to be recorded, or no more.
    Off,
    /// The window has not begun.
    Ahead,
    /// Within the window.
    On,
}

thread_local! {
    static PROGRESS: Cell<Progress> = const { Cell::new(Progress::Off) };
    static RECORDER: RefCell<Option<Recorder>> = const { RefCell::new(None) };
}

/// The recording of a thread; dropping it delivers what has not been yet.
#[must_use]
pub struct Recording(PhantomData<*const ()>);

impl Drop for Recording {
    fn drop(&mut self) {
        finish();
    }
}

/// Records this thread's half-steps within a window of steps; what an earlier recording of it has is delivered.
pub fn record(window: Window, deliver_to: Deliver) -> Recording {
    finish();
    let recorder = Recorder {
        window,
        anchor: anchor(),
        track: Name::COUPLER,
        half_step: (0, Stage::First),
        part: Part::default(),
        deliver: deliver_to,
    };
    RECORDER.set(Some(recorder));
    PROGRESS.set(Progress::Ahead);
    Recording(PhantomData)
}

/// Ends this thread's recording, if there is one, and delivers what it has.
pub fn finish() {
    PROGRESS.set(Progress::Off);
    if let Some(recorder) = RECORDER.take() {
        (recorder.deliver)(recorder.part);
    }
}

/// The same moment on the clock of [`Instant`] and on the system's monotonic one, ns: of many readings the one with the
/// least time between its two, since another process may take the processor there.
fn anchor() -> (Instant, u64) {
    let reading = |_| {
        let (before, nanoseconds) = (Instant::now(), monotonic());
        (before.elapsed(), before, nanoseconds)
    };
    let best = (1..100).map(reading).fold(reading(0), |best, next| if next.0 < best.0 { next } else { best });
    (best.1, best.2)
}

/// The system's monotonic clock, ns.
fn monotonic() -> u64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the call writes to a structure of this function and knows the clock.
    unsafe { libc::clock_gettime(libc::CLOCK_MONOTONIC, &mut time) };
    time.tv_sec as u64 * 1_000_000_000 + time.tv_nsec as u64
}

#[inline]
fn is_on() -> bool {
    PROGRESS.get() == Progress::On
}

fn with_recorder<T>(act: impl FnOnce(&mut Recorder) -> T) -> Option<T> {
    RECORDER.with_borrow_mut(|recorder| recorder.as_mut().map(act))
}

fn push(kind: Kind, what: &'static str, with: Option<Name>, span: [Instant; 2]) {
    with_recorder(|recorder| recorder.push(kind, what, with, span));
}

/// A half-step has begun; `None` where it is not recorded.
pub fn begin(half_step: &HalfStep, participants: usize) -> Option<Instant> {
    if PROGRESS.get() == Progress::Off {
        return None;
    }
    let HalfStep { step, stage, .. } = *half_step;
    let place = with_recorder(|recorder| {
        recorder.half_step = (step, stage);
        let room = recorder.window.steps() as usize * 2 * participants * USUAL_EVENTS;
        let inside = recorder.window.place(step);
        if inside.is_eq() && recorder.part.events.is_empty() {
            recorder.part.events.reserve(room.min(MOST_EVENTS));
        }
        inside
    })?;
    if place.is_gt() {
        finish();
    }
    if place.is_eq() {
        PROGRESS.set(Progress::On);
    }
    is_on().then(Instant::now)
}

/// A half-step that began at `start` has ended for a participant or the coupler.
pub fn end(track: Name, start: Option<Instant>) {
    if let Some(start) = start.filter(|_| is_on()) {
        let _turn = turn(track);
        push(Kind::HalfStep, "half-step", None, [start, Instant::now()]);
    }
}

/// Whose phases are recorded; dropping it gives the turn back.
#[must_use]
pub struct Turn(Option<Name>);

/// Phases from here on are those of this participant, or of the coupler.
pub fn turn(track: Name) -> Turn {
    let change = || with_recorder(|recorder| std::mem::replace(&mut recorder.track, track));
    Turn(if is_on() { change() } else { None })
}

impl Drop for Turn {
    fn drop(&mut self) {
        if let Some(track) = self.0 {
            with_recorder(|recorder| recorder.track = track);
        }
    }
}

/// A phase that goes on; dropping it ends it.
#[must_use]
pub struct Phase {
    start: Option<Instant>,
    kind: Kind,
    what: &'static str,
}

/// Begins a phase of computing.
#[inline]
pub fn phase(what: &'static str) -> Phase {
    phase_of(Kind::Compute, what)
}

/// Begins a phase.
#[inline]
pub fn phase_of(kind: Kind, what: &'static str) -> Phase {
    Phase { start: if is_on() { Some(Instant::now()) } else { None }, kind, what }
}

impl Drop for Phase {
    #[inline]
    fn drop(&mut self) {
        if let Some(start) = self.start {
            push(self.kind, self.what, None, [start, Instant::now()]);
        }
    }
}

/// A phase whose time is wanted in any case.
pub struct Watch {
    start: Instant,
    kind: Kind,
    what: &'static str,
}

impl Watch {
    /// Begins.
    pub fn start(kind: Kind, what: &'static str) -> Self {
        Self { start: Instant::now(), kind, what }
    }

    /// What the phase took.
    pub fn stop(self) -> Duration {
        let end = Instant::now();
        if is_on() {
            push(self.kind, self.what, None, [self.start, end]);
        }
        end - self.start
    }
}

/// Takes a message of `from` through a link, whose own account tells waiting from taking over.
pub fn receive<L: ?Sized, T>(
    link: &mut L,
    what: &'static str,
    from: Name,
    times: impl Fn(&L) -> LinkTimes,
    take: impl FnOnce(&mut L) -> T,
) -> T {
    if !is_on() {
        return take(link);
    }
    let (start, before) = (Instant::now(), times(link).wait);
    let taken = take(link);
    let (end, wait) = (Instant::now(), times(link).wait - before);
    // A link without an account of its own only answers calls.
    let arrival = if wait.is_zero() { end } else { end.min(start + wait) };
    push(Kind::Wait, what, Some(from), [start, arrival]);
    if arrival < end {
        push(Kind::Message, "receive", Some(from), [arrival, end]);
    }
    taken
}

#[cfg(test)]
mod tests;
