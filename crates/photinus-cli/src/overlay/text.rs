//! Words as outlines: DejaVu Sans, drawn by the same antialiasing as every line.

use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::{FontRef, GlyphId, MetadataProvider};
use tiny_skia::{Path, PathBuilder};

/// The font of all pictures.
pub(super) struct Font {
    face: FontRef<'static>,
    units_per_em: f32,
}

impl Font {
    /// DejaVu Sans; `None` would mean that the font inside the program is damaged.
    pub(super) fn new() -> Option<Self> {
        let face = FontRef::new(dejavu::sans::regular()).ok()?;
        let metrics = face.metrics(Size::unscaled(), LocationRef::default());
        (metrics.units_per_em > 0).then(|| Self { face, units_per_em: f32::from(metrics.units_per_em) })
    }

    /// How wide a line of text is at a size (of an em), px.
    pub(super) fn width(&self, text: &str, size: f32) -> f32 {
        text.chars().map(|c| self.advance(self.glyph(c), size)).sum()
    }

    /// The outline of a line of text whose baseline begins at (`x`, `y`); `None` when nothing shows.
    pub(super) fn outline(&self, text: &str, mut x: f32, y: f32, size: f32) -> Option<Path> {
        let mut outline = Outline { path: PathBuilder::new(), x, y, scale: self.scale(size) };
        let outlines = self.face.outline_glyphs();
        for glyph in text.chars().map(|c| self.glyph(c)) {
            outline.x = x;
            if let Some(drawn) = outlines.get(glyph) {
                let settings = DrawSettings::unhinted(Size::unscaled(), LocationRef::default());
                // A glyph without an outline is a space; one that is damaged is not in the font inside the program.
                let _ = drawn.draw(settings, &mut outline);
            }
            x += self.advance(glyph, size);
        }
        outline.path.finish()
    }

    /// The glyph of a character; the font's own empty box where it has none.
    fn glyph(&self, c: char) -> GlyphId {
        self.face.charmap().map(c).unwrap_or(GlyphId::NOTDEF)
    }

    fn advance(&self, glyph: GlyphId, size: f32) -> f32 {
        let metrics = self.face.glyph_metrics(Size::unscaled(), LocationRef::default());
        metrics.advance_width(glyph).unwrap_or_default() * self.scale(size)
    }

    fn scale(&self, size: f32) -> f32 {
        size / self.units_per_em
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

impl OutlinePen for Outline {
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
