//! Words as outlines: DejaVu Sans, drawn by the same antialiasing as every line.

use tiny_skia::{Path, PathBuilder};
use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// The font of all pictures.
pub(super) struct Font {
    face: Face<'static>,
}

impl Font {
    /// DejaVu Sans; `None` would mean that the font inside the program is damaged.
    pub(super) fn new() -> Option<Self> {
        Face::parse(dejavu::sans::regular(), 0).ok().map(|face| Self { face })
    }

    /// How wide a line of text is at a size (of an em), px.
    pub(super) fn width(&self, text: &str, size: f32) -> f32 {
        text.chars().map(|c| self.advance(self.glyph(c), size)).sum()
    }

    /// The outline of a line of text whose baseline begins at (`x`, `y`); `None` when nothing shows.
    pub(super) fn outline(&self, text: &str, mut x: f32, y: f32, size: f32) -> Option<Path> {
        let mut outline = Outline { path: PathBuilder::new(), x, y, scale: self.scale(size) };
        for glyph in text.chars().map(|c| self.glyph(c)) {
            outline.x = x;
            // A glyph without an outline is a space.
            let _ = self.face.outline_glyph(glyph, &mut outline);
            x += self.advance(glyph, size);
        }
        outline.path.finish()
    }

    /// The glyph of a character; the font's own empty box where it has none.
    fn glyph(&self, c: char) -> GlyphId {
        self.face.glyph_index(c).unwrap_or_default()
    }

    fn advance(&self, glyph: GlyphId, size: f32) -> f32 {
        f32::from(self.face.glyph_hor_advance(glyph).unwrap_or_default()) * self.scale(size)
    }

    fn scale(&self, size: f32) -> f32 {
        size / f32::from(self.face.units_per_em())
    }
}

/// Font units, y up -> pixels, y down.
struct Outline {
    path: PathBuilder,
    x: f32,
    y: f32,
    scale: f32,
}

impl Outline {
    fn at(&self, x: f32, y: f32) -> (f32, f32) {
        (self.x + self.scale * x, self.y - self.scale * y)
    }
}

impl OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.at(x1, y1), self.at(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}
