//! The sides of a polygon, prepared for questions about many points.

use super::{Polygon, dot};

/// A side; the region lies on its left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Edge {
    /// Begin, m.
    pub(crate) from: [f64; 2],
    /// End, m.
    pub(crate) to: [f64; 2],
    /// Index of the side that ends where this one begins.
    pub(in crate::geometry) before: usize,
    /// Index of the side that begins where this one ends.
    pub(super) after: usize,
    /// Length of the line of sides up to its begin, m.
    pub(super) start: f64,
    /// Line that it belongs to: 0 the outline, then the holes.
    pub(super) line: usize,
}

impl Edge {
    pub(crate) fn length(&self) -> f64 {
        libm::hypot(self.to[0] - self.from[0], self.to[1] - self.from[1])
    }

    pub(crate) fn direction(&self) -> [f64; 2] {
        let length = self.length();
        [0, 1].map(|a| (self.to[a] - self.from[a]) / length)
    }

    /// Unit normal out of the region.
    pub(crate) fn normal(&self) -> [f64; 2] {
        let [x, y] = self.direction();
        [y, -x]
    }

    /// Where along the side a point's foot is, m from its begin, and how far the point lies on its left, m.
    pub(super) fn coordinates(&self, p: &[f64; 2]) -> [f64; 2] {
        let from = [p[0] - self.from[0], p[1] - self.from[1]];
        let [x, y] = self.direction();
        [dot(&from, &[x, y]), dot(&from, &[-y, x])]
    }

    /// The side's point nearest to a point.
    pub(in crate::geometry) fn foot(&self, p: &[f64; 2]) -> [f64; 2] {
        let way = [self.to[0] - self.from[0], self.to[1] - self.from[1]];
        let share = dot(&[p[0] - self.from[0], p[1] - self.from[1]], &way) / dot(&way, &way);
        match share {
            s if s <= 0.0 => self.from,
            s if s >= 1.0 => self.to,
            s => [0, 1].map(|a| self.from[a] + s * way[a]),
        }
    }
}

/// All sides of a polygon, and which of them lie in which strip of y.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Edges {
    pub(crate) all: Vec<Edge>,
    /// Lowest corner of the box around them, m.
    pub(crate) low: [f64; 2],
    pub(crate) high: [f64; 2],
    strips: Vec<Vec<u32>>,
    /// Height of a strip, m.
    height: f64,
}

impl Edges {
    pub(crate) fn new(polygon: &Polygon) -> Self {
        let mut all: Vec<Edge> = Vec::new();
        for (line, corners) in std::iter::once(&polygon.outline).chain(&polygon.holes).enumerate() {
            let (first, n) = (all.len(), corners.len());
            let mut start = 0.0;
            for k in 0..n {
                let (before, after) = (first + (k + n - 1) % n, first + (k + 1) % n);
                let edge = Edge { from: corners[k], to: corners[(k + 1) % n], before, after, start, line };
                start += edge.length();
                all.push(edge);
            }
        }
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for edge in &all {
            for a in 0..2 {
                (low[a], high[a]) = (low[a].min(edge.from[a]), high[a].max(edge.from[a]));
            }
        }
        let count = all.len().clamp(1, 1024);
        let height = (high[1] - low[1]) / count as f64;
        let mut edges = Self { all, low, high, strips: vec![Vec::new(); count], height };
        for k in 0..edges.all.len() {
            let Edge { from, to, .. } = edges.all[k];
            for strip in edges.strips_between(from[1].min(to[1]), from[1].max(to[1])) {
                edges.strips[strip].push(k as u32);
            }
        }
        edges
    }

    /// Strips that an interval of y touches.
    fn strips_between(&self, low: f64, high: f64) -> std::ops::RangeInclusive<usize> {
        let last = self.strips.len() - 1;
        // A float beyond the range becomes the range's end.
        let strip = |y: f64| (((y - self.low[1]) / self.height).floor() as usize).min(last);
        strip(low)..=strip(high)
    }

    /// Calls `visit` with the sides that may be within `reach` of a point, some of them several times.
    pub(super) fn near(&self, p: &[f64; 2], reach: f64, mut visit: impl FnMut(usize)) {
        for strip in self.strips_between(p[1] - reach, p[1] + reach) {
            for &k in &self.strips[strip] {
                let Edge { from, to, .. } = &self.all[k as usize];
                if from[0].min(to[0]) - reach <= p[0] && p[0] <= from[0].max(to[0]) + reach {
                    visit(k as usize);
                }
            }
        }
    }

    /// The side nearest to a point, and its distance, m: of those within `reach`, m.
    pub(in crate::geometry) fn nearest(&self, p: &[f64; 2], reach: f64) -> Option<(usize, f64)> {
        let mut nearest: Option<(usize, f64)> = None;
        self.near(p, reach, |k| {
            let foot = self.all[k].foot(p);
            let distance = libm::hypot(p[0] - foot[0], p[1] - foot[1]);
            if distance <= reach && nearest.is_none_or(|(_, least)| distance < least) {
                nearest = Some((k, distance));
            }
        });
        nearest
    }

    /// Whether the region, grown by `margin` (shrunk where negative), m, holds a point.
    pub(crate) fn contains(&self, p: &[f64; 2], margin: f64) -> bool {
        let outside = |a: usize| p[a] < self.low[a] - margin.abs() || p[a] > self.high[a] + margin.abs();
        if outside(0) || outside(1) {
            return false;
        }
        if self.nearest(p, margin.abs()).is_some() {
            return margin > 0.0;
        }
        // Half-open in y: a ray through a corner crosses one of its two sides.
        let mut inside = false;
        let strip = *self.strips_between(p[1], p[1]).start();
        for &k in &self.strips[strip] {
            let Edge { from, to, .. } = &self.all[k as usize];
            if (from[1] <= p[1]) != (to[1] <= p[1]) {
                let x = from[0] + (p[1] - from[1]) / (to[1] - from[1]) * (to[0] - from[0]);
                inside ^= p[0] < x;
            }
        }
        inside
    }

    /// Distance of a point to the region, m: zero inside.
    pub(crate) fn distance(&self, p: &[f64; 2]) -> f64 {
        match self.contains(p, 0.0) {
            true => 0.0,
            false => self.nearest(p, f64::MAX).map_or(f64::INFINITY, |(_, distance)| distance),
        }
    }

    /// The longest side, the first of several.
    pub(crate) fn longest(&self) -> &Edge {
        // Lengths that differ by rounding alone are equal.
        let longest = self.all.iter().map(Edge::length).fold(0.0, f64::max) * (1.0 - 1e-9);
        let found = self.all.iter().find(|edge| edge.length() >= longest);
        found.unwrap_or(&self.all[0])
    }
}
