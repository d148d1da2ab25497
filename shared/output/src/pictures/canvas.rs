//! A picture in memory that plotters draws on, with a font of its own, and the way to a PNG file.

use crate::{OutputError, atomic};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::register_font;
use std::path::Path;
use std::sync::Once;

/// Drawing surface of [`Canvas::draw`].
pub type Area<'a> = DrawingArea<BitMapBackend<'a>, Shift>;
/// What plotters' own errors become: their text.
pub type Drawn = Result<(), Box<dyn std::error::Error>>;

/// Name under which the font of this crate is registered.
pub const FONT: &str = "halfstep";

/// Makes [`FONT`] known to plotters.
fn register() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let font = include_bytes!("../../assets/DejaVuSans.ttf");
        assert!(register_font(FONT, FontStyle::Normal, font).is_ok(), "the font of this crate is a font");
    });
}

/// An RGB picture, white at first.
pub struct Canvas {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) rgb: Vec<u8>,
}

impl Canvas {
    /// A white picture.
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, rgb: vec![255; width as usize * height as usize * 3] }
    }

    /// Draws with plotters.
    ///
    /// # Errors
    /// Error of plotters as text.
    pub fn draw(&mut self, draw: impl FnOnce(&Area<'_>) -> Drawn) -> Drawn {
        register();
        let area = BitMapBackend::with_buffer(&mut self.rgb, (self.width, self.height)).into_drawing_area();
        draw(&area)?;
        Ok(area.present()?)
    }

    /// The picture at half its width and height, each pixel the mean of four: smooth lines.
    pub fn halved(&self) -> Self {
        let mut half = Self::new(self.width / 2, self.height / 2);
        let row = self.width as usize * 3;
        for (y, line) in half.rgb.chunks_exact_mut(half.width as usize * 3).enumerate() {
            for (k, value) in line.iter_mut().enumerate() {
                let at = 2 * y * row + k / 3 * 6 + k % 3;
                let sum: u32 =
                    [at, at + 3, at + row, at + row + 3].iter().map(|&i| u32::from(self.rgb[i])).sum();
                *value = ((sum + 2) / 4) as u8;
            }
        }
        half
    }

    /// Writes the picture as PNG.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), OutputError> {
        save_png(path, self.width, self.height, png::ColorType::Rgb, None, &self.rgb)
    }
}

/// Writes 8-bit pixels as PNG, whole or not at all.
pub(crate) fn save_png(
    path: &Path,
    width: u32,
    height: u32,
    color: png::ColorType,
    palette: Option<Vec<u8>>,
    pixels: &[u8],
) -> Result<(), OutputError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(color);
    encoder.set_depth(png::BitDepth::Eight);
    if let Some(palette) = palette {
        encoder.set_palette(palette);
    }
    encoder
        .write_header()
        .and_then(|mut writer| {
            writer.write_image_data(pixels)?;
            writer.finish()
        })
        .map_err(|e| OutputError::Picture { path: path.into(), reason: e.to_string() })?;
    atomic::replace_bytes(path, &bytes)
}
