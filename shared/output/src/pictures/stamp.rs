//! A palette picture that discs are stamped into: thousands of particles in a millisecond.

use super::canvas::{Canvas, save_png};
use crate::OutputError;
use std::path::Path;

/// Levels of grey from white (0) to black, for text and lines.
const GREYS: u8 = 16;
/// The last of them.
pub(crate) const DARK: u8 = GREYS - 1;
/// Colour of a wall particle.
pub(crate) const WALL: u8 = GREYS;
/// Steps of each colour scale.
const STEPS: u8 = 112;

/// Nodes of the fluid's scale, from low to high pressure.
const FLUID_NODES: [[u8; 3]; 6] =
    [[176, 224, 240], [92, 184, 222], [38, 130, 196], [34, 80, 164], [56, 34, 120], [38, 8, 62]];
/// Nodes of the solid's scale, from no stress to the largest.
const SOLID_NODES: [[u8; 3]; 5] =
    [[214, 204, 190], [246, 190, 96], [240, 130, 40], [206, 60, 28], [120, 12, 26]];
const WALL_COLOR: [u8; 3] = [158, 158, 158];

/// A scale of colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scale {
    /// Pressure of the fluid.
    Fluid,
    /// Stress of the solid.
    Solid,
}

impl Scale {
    /// Palette index of a place on the scale, 0 to 1; a value outside, or NaN, gets the nearest end.
    pub(crate) fn index(self, place: f64) -> u8 {
        let step = (place.clamp(0.0, 1.0) * f64::from(STEPS - 1)).round() as u8;
        GREYS + 1 + step + if self == Self::Solid { STEPS } else { 0 }
    }
}

/// The colours of all indices, RGB.
pub(crate) fn palette() -> Vec<u8> {
    let mut colors: Vec<[u8; 3]> = (0..GREYS).map(|k| [255 - 17 * k; 3]).collect();
    colors.push(WALL_COLOR);
    for nodes in [&FLUID_NODES[..], &SOLID_NODES[..]] {
        colors.extend((0..STEPS).map(|step| {
            let place = f64::from(step) / f64::from(STEPS - 1) * (nodes.len() - 1) as f64;
            let node = (place as usize).min(nodes.len() - 2);
            let part = place - node as f64;
            let mix = |a: u8, b: u8| (f64::from(a) + part * (f64::from(b) - f64::from(a))).round() as u8;
            [0, 1, 2].map(|c| mix(nodes[node][c], nodes[node + 1][c]))
        }));
    }
    colors.into_flattened()
}

/// A rectangle of pixels: x, y, width, height.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Rect {
    pub(crate) x: i32,
    pub(crate) y: i32,
    pub(crate) width: i32,
    pub(crate) height: i32,
}

impl Rect {
    /// Whether two rectangles have a pixel in common.
    pub(crate) fn meets(&self, other: &Self) -> bool {
        let along = |a: i32, length: i32, b: i32, other: i32| a < b + other && b < a + length;
        along(self.x, self.width, other.x, other.width) && along(self.y, self.height, other.y, other.height)
    }
}

/// A picture of palette indices, white at first.
pub(crate) struct Sheet {
    width: i32,
    height: i32,
    pixels: Vec<u8>,
}

impl Sheet {
    pub(crate) fn new(width: i32, height: i32) -> Self {
        Self { width, height, pixels: vec![0; (width * height) as usize] }
    }

    pub(crate) fn size(&self) -> (u32, u32) {
        (self.width as u32, self.height as u32)
    }

    /// Stamps a disc, cut to a rectangle inside the picture. The centre is not rounded to pixels: a lattice stays even.
    pub(crate) fn disc(&mut self, inside: Rect, center: [f64; 2], radius: f64, color: u8) {
        let [cx, cy] = center;
        let out = |c: f64, low: i32, length: i32| {
            !c.is_finite() || c + radius < f64::from(low) || c - radius > f64::from(low + length)
        };
        if out(cx, inside.x, inside.width) || out(cy, inside.y, inside.height) {
            return;
        }
        let top = ((cy - radius).floor() as i32).max(inside.y);
        let bottom = ((cy + radius).ceil() as i32).min(inside.y + inside.height);
        for y in top..bottom {
            let height = f64::from(y) + 0.5 - cy;
            let half = radius * radius - height * height;
            if half > 0.0 {
                let half = half.sqrt();
                let left = ((cx - half - 0.5).ceil() as i32).max(inside.x);
                let right = ((cx + half - 0.5).floor() as i32 + 1).min(inside.x + inside.width);
                if left < right {
                    let row = y * self.width;
                    self.pixels[(row + left) as usize..(row + right) as usize].fill(color);
                }
            }
        }
    }

    /// Fills a rectangle inside the picture with a colour scale, low values left.
    pub(crate) fn bar(&mut self, at: Rect, scale: Scale) {
        for y in at.y..at.y + at.height {
            for x in 0..at.width {
                let place = f64::from(x) / f64::from((at.width - 1).max(1));
                self.pixels[(y * self.width + at.x + x) as usize] = scale.index(place);
            }
        }
    }

    /// Makes what the picture has of a rectangle white.
    pub(crate) fn blank(&mut self, at: Rect) {
        let within = |from: i32, length: i32, all: i32| from.clamp(0, all)..(from + length).clamp(0, all);
        let columns = within(at.x, at.width, self.width);
        for row in within(at.y, at.height, self.height).map(|y| y * self.width) {
            self.pixels[(row + columns.start) as usize..(row + columns.end) as usize].fill(0);
        }
    }

    /// Puts what is drawn on a canvas of the same size on top, in shades of grey.
    pub(crate) fn overlay(&mut self, canvas: &Canvas) {
        for (pixel, rgb) in self.pixels.iter_mut().zip(canvas.rgb.chunks_exact(3)) {
            let level = (255 - u16::from(rgb[1])) * u16::from(GREYS - 1) / 255;
            if level > 0 {
                *pixel = level as u8;
            }
        }
    }

    /// Writes the picture as PNG.
    pub(crate) fn save(&self, path: &Path) -> Result<(), OutputError> {
        let (width, height) = self.size();
        save_png(path, width, height, png::ColorType::Indexed, Some(palette()), &self.pixels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_stay_apart_in_the_palette() {
        let colors = palette();
        assert_eq!(colors.len() / 3, usize::from(GREYS) + 1 + 2 * usize::from(STEPS));
        assert_eq!(Scale::Fluid.index(-1.0), WALL + 1);
        assert_eq!(Scale::Fluid.index(f64::NAN), WALL + 1);
        assert_eq!(Scale::Solid.index(0.0), Scale::Fluid.index(2.0) + 1);
        let color = |index: u8| &colors[3 * usize::from(index)..][..3];
        assert_eq!(color(Scale::Solid.index(1.0)), SOLID_NODES[4]);
        assert_eq!(color(WALL), WALL_COLOR);
        assert_eq!((color(0), color(GREYS - 1)), (&[255; 3][..], &[0; 3][..]));
    }

    #[test]
    fn a_disc_has_its_area_and_stays_in_its_rectangle() {
        let inside = Rect { x: 10, y: 20, width: 60, height: 50 };
        let count = |center: [f64; 2]| {
            let mut sheet = Sheet::new(100, 100);
            sheet.disc(inside, center, 10.0, 5);
            let marked = |(k, &p): (usize, &u8)| (p == 5).then_some((k as i32 % 100, k as i32 / 100));
            let marked: Vec<_> = sheet.pixels.iter().enumerate().filter_map(marked).collect();
            assert!(marked.iter().all(|(x, y)| (10..70).contains(x) && (20..70).contains(y)));
            marked.len() as f64
        };
        let area = std::f64::consts::PI * 100.0;
        assert!((count([40.3, 45.6]) / area - 1.0).abs() < 0.02);
        assert!((count([10.0, 45.6]) / area - 0.5).abs() < 0.03);
        assert!((count([70.0, 70.0]) / area - 0.25).abs() < 0.03);
        assert_eq!(count([f64::NAN, 40.0]) + count([1e300, 40.0]) + count([40.0, -500.0]), 0.0);
    }
}
