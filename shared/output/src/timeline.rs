//! The timeline of half-steps as a trace event file, the JSON that chrome://tracing and Perfetto read.
//!
//! The format: "Trace Event Format" of the Chromium project, JSON object format, with complete events (`ph` is `X`) and
//! metadata (`M`). A process of the run is a process of the trace, a participant or the coupler one of its threads.

use crate::{OutputError, atomic};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// Category of the spans that are whole half-steps.
pub const HALF_STEP: &str = "half-step";

/// A phase, or a whole half-step.
#[derive(Clone, Debug, PartialEq)]
pub struct Span {
    /// Name of the phase.
    pub name: String,
    /// `half-step`, `compute`, `wait`, `message` or `output`.
    pub category: String,
    /// Beginning, µs.
    pub start: f64,
    /// Length, µs.
    pub duration: f64,
    /// The step it belongs to.
    pub step: u64,
    /// 0 or 1.
    pub stage: u32,
    /// Whose message it is, if it is about one.
    pub with: Option<String>,
}

impl Span {
    /// Its name; of a wait with whom it waits for.
    pub fn label(&self) -> String {
        match &self.with {
            Some(with) if self.category == "wait" => format!("{}: {with}", self.name),
            _ => self.name.clone(),
        }
    }

    /// Its end, µs.
    pub fn end(&self) -> f64 {
        self.start + self.duration
    }
}

/// What a participant or the coupler did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Track {
    /// Name of its process, and the system's number of that.
    pub process: (String, u32),
    /// Its own name.
    pub name: String,
    /// By their beginnings; a span that lies within another follows it.
    pub spans: Vec<Span>,
}

/// What all participants did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Timeline {
    /// Who.
    pub tracks: Vec<Track>,
    /// Phases that were too many to be recorded.
    pub lost: u64,
}

/// An event of the file.
#[derive(Serialize, Deserialize)]
struct Event {
    name: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    cat: String,
    ph: String,
    #[serde(default)]
    ts: f64,
    #[serde(default)]
    dur: f64,
    pid: u32,
    tid: u32,
    #[serde(default)]
    args: Arguments,
}

/// What an event says about itself.
#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
struct Arguments {
    #[serde(skip_serializing_if = "Option::is_none")]
    step: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stage: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    with: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sort_index: Option<u32>,
}

#[derive(Deserialize)]
struct Document {
    #[serde(rename = "traceEvents")]
    events: Vec<Event>,
    #[serde(rename = "otherData", default)]
    other: Other,
}

#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
struct Other {
    lost_phases: u64,
}

impl Timeline {
    /// One of the parts of several processes, whose times are of the same clock: counted from the first of all. The
    /// coupler comes first, then `order`.
    pub fn merged(parts: Vec<Self>, order: &[String]) -> Self {
        let lost = parts.iter().map(|part| part.lost).sum();
        let mut tracks: Vec<Track> = parts.into_iter().flat_map(|part| part.tracks).collect();
        // Who is not named is the coupler.
        let place = |track: &Track| order.iter().position(|name| *name == track.name).map(|place| place + 1);
        tracks.sort_by_key(|track| (place(track), track.name.clone()));
        let starts = tracks.iter().flat_map(|track| &track.spans).map(|span| span.start);
        let first = starts.fold(f64::INFINITY, f64::min);
        for span in tracks.iter_mut().flat_map(|track| &mut track.spans) {
            span.start -= first;
        }
        Self { tracks, lost }
    }

    /// First and last step of which a track has the whole; `None` where there is none.
    pub fn steps(&self) -> Option<(u64, u64)> {
        let whole = |span: &&Span| span.category == HALF_STEP && span.stage == 1;
        let steps = || self.tracks.iter().flat_map(|track| &track.spans).filter(whole).map(|span| span.step);
        steps().min().zip(steps().max())
    }

    /// The trace event file's text.
    ///
    /// # Errors
    /// A time is not finite.
    pub fn to_json(&self) -> serde_json::Result<String> {
        let mut lines = Vec::new();
        for (tid, track) in self.tracks.iter().enumerate() {
            let (process, pid) = &track.process;
            let (tid, pid) = (tid as u32, *pid);
            let mut about = |what: &str, args| {
                let none = String::new();
                let event =
                    Event { name: what.into(), cat: none, ph: "M".into(), ts: 0.0, dur: 0.0, pid, tid, args };
                lines.push(serde_json::to_string(&event)?);
                Ok::<(), serde_json::Error>(())
            };
            let named = |name: &String| Arguments { name: Some(name.clone()), ..Arguments::default() };
            about("process_name", named(process))?;
            about("thread_name", named(&track.name))?;
            about("thread_sort_index", Arguments { sort_index: Some(tid), ..Arguments::default() })?;
            for span in &track.spans {
                let (step, stage) = (Some(span.step), Some(span.stage));
                let args = Arguments { step, stage, with: span.with.clone(), ..Arguments::default() };
                lines.push(serde_json::to_string(&Event {
                    name: span.name.clone(),
                    cat: span.category.clone(),
                    ph: "X".into(),
                    ts: span.start,
                    dur: span.duration,
                    pid,
                    tid,
                    args,
                })?);
            }
        }
        let other = serde_json::to_string(&Other { lost_phases: self.lost })?;
        let events = lines.join(",\n");
        Ok(format!("{{\"displayTimeUnit\":\"ms\",\"otherData\":{other},\"traceEvents\":[\n{events}\n]}}\n"))
    }

    /// Reads such a text.
    ///
    /// # Errors
    /// It is none.
    pub fn from_json(text: &str) -> serde_json::Result<Self> {
        let document: Document = serde_json::from_str(text)?;
        let mut tracks: BTreeMap<(u32, u32), Track> = BTreeMap::new();
        for Event { name, cat, ph, ts, dur, pid, tid, args } in document.events {
            let track = tracks.entry((tid, pid)).or_default();
            match (ph.as_str(), name.as_str()) {
                ("M", "process_name") => track.process = (args.name.unwrap_or_default(), pid),
                ("M", "thread_name") => track.name = args.name.unwrap_or_default(),
                ("X", _) => track.spans.push(Span {
                    name,
                    category: cat,
                    start: ts,
                    duration: dur,
                    step: args.step.unwrap_or_default(),
                    stage: args.stage.unwrap_or_default(),
                    with: args.with,
                }),
                _ => {}
            }
        }
        Ok(Self { tracks: tracks.into_values().collect(), lost: document.other.lost_phases })
    }

    /// Writes the trace event file, whole or not at all.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), OutputError> {
        let text = self.to_json().map_err(|error| OutputError::malformed(path, error.to_string()))?;
        atomic::replace_bytes(path, text.as_bytes())
    }

    /// Reads a trace event file.
    ///
    /// # Errors
    /// It cannot be read, or is none.
    pub fn read(path: &Path) -> Result<Self, OutputError> {
        let text = std::fs::read_to_string(path).map_err(OutputError::io("read", path))?;
        Self::from_json(&text).map_err(|error| OutputError::malformed(path, error.to_string()))
    }
}

/// What a phase takes of a track's time.
#[derive(Clone, Debug, PartialEq)]
pub struct Share {
    /// The spans' label.
    pub name: String,
    /// Its category.
    pub category: String,
    /// Its part of the time from the track's first half-step to the end of its last, without what lies within the phase
    /// and has a name of its own: 0 to 1.
    pub share: f64,
}

impl Track {
    /// What each phase takes of the track's time, in the order in which the phases come first; all shares and what has
    /// no name add to 1.
    pub fn shares(&self) -> Vec<Share> {
        let mut own: Vec<f64> = self.spans.iter().map(|span| span.duration).collect();
        let mut open: Vec<usize> = Vec::new();
        for (k, span) in self.spans.iter().enumerate() {
            while open.last().is_some_and(|&outer| !self.spans[outer].contains(span)) {
                open.pop();
            }
            if let Some(&outer) = open.last() {
                own[outer] -= span.duration;
            }
            open.push(k);
        }
        let whole = || self.spans.iter().filter(|span| span.category == HALF_STEP);
        let first = whole().map(|span| span.start).fold(f64::INFINITY, f64::min);
        let length = whole().map(Span::end).fold(0.0, f64::max) - first;
        let mut shares: Vec<Share> = Vec::new();
        for (span, own) in self.spans.iter().zip(own).filter(|(span, _)| span.category != HALF_STEP) {
            let name = span.label();
            match shares.iter_mut().find(|share| share.name == name) {
                Some(share) => share.share += own / length,
                None => shares.push(Share { name, category: span.category.clone(), share: own / length }),
            }
        }
        shares
    }
}

impl Span {
    /// Whether another that does not begin before lies within this one; a thousandth of a microsecond is rounding.
    pub fn contains(&self, other: &Self) -> bool {
        other.start < self.end() && other.end() <= self.end() + 2e-3
    }
}

#[cfg(test)]
mod tests;
