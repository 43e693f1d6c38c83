//! Words as stamps: DejaVu Sans, each letter drawn once by the same antialiasing as every line, and kept.

use std::collections::HashMap;

use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::{FontRef, GlyphId, MetadataProvider};
use tiny_skia::{FillRule, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, Transform};

/// A letter stands at a whole row and at one of this many places within a column.
const PHASES: f32 = 4.0;
/// How wide the halo of a letter is, of an em.
const HALO: f32 = 0.26;

/// The font of all pictures.
pub(super) struct Font {
    face: FontRef<'static>,
    units_per_em: f32,
    stamps: HashMap<Key, Option<Stamp>>,
}

/// A letter, its size in bits, its place within a column, and whether it is its halo.
type Key = (GlyphId, u32, u8, bool);

/// How much of each pixel a letter covers.
pub(super) struct Stamp {
    /// Its upper left corner from the pixel that it stands at.
    pub(super) left: i32,
    pub(super) top: i32,
    pub(super) width: usize,
    /// Rows of this many columns, 0 to 255.
    pub(super) cover: Vec<u8>,
}

impl Font {
    /// DejaVu Sans; `None` would mean that the font inside the program is damaged.
    pub(super) fn new() -> Option<Self> {
        let face = FontRef::new(dejavu::sans::regular()).ok()?;
        let metrics = face.metrics(Size::unscaled(), LocationRef::default());
        (metrics.units_per_em > 0).then(|| Self {
            face,
            units_per_em: f32::from(metrics.units_per_em),
            stamps: HashMap::new(),
        })
    }

    /// How wide a line of text is at a size (of an em), px.
    pub(super) fn width(&self, text: &str, size: f32) -> f32 {
        text.chars().map(|c| self.advance(self.glyph(c), size)).sum()
    }

    /// The letters of a line of text whose baseline begins at column `x`: each with the column that it stands at.
    pub(super) fn stamps(
        &mut self,
        text: &str,
        mut x: f32,
        size: f32,
        is_halo: bool,
        mut take: impl FnMut(&Stamp, i32),
    ) {
        for c in text.chars() {
            let glyph = self.glyph(c);
            let places = (x * PHASES).round();
            let column = (places / PHASES).floor();
            let phase = places - column * PHASES;
            let key = (glyph, size.to_bits(), phase as u8, is_halo);
            if !self.stamps.contains_key(&key) {
                let stamp = self
                    .outline(glyph, phase / PHASES, size)
                    .and_then(|path| Stamp::of(&path, size, is_halo));
                self.stamps.insert(key, stamp);
            }
            if let Some(Some(stamp)) = self.stamps.get(&key) {
                take(stamp, column as i32);
            }
            x += self.advance(glyph, size);
        }
    }

    /// The outline of a letter on a baseline through (`x`, 0); `None` when nothing shows.
    fn outline(&self, glyph: GlyphId, x: f32, size: f32) -> Option<Path> {
        let mut outline = Outline { path: PathBuilder::new(), x, y: 0.0, scale: self.scale(size) };
        let settings = DrawSettings::unhinted(Size::unscaled(), LocationRef::default());
        // A glyph without an outline is a space; one that is damaged is not in the font inside the program.
        let _ = self.face.outline_glyphs().get(glyph)?.draw(settings, &mut outline);
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

impl Stamp {
    fn of(path: &Path, size: f32, is_halo: bool) -> Option<Self> {
        let bounds = path.bounds();
        let reach = if is_halo { HALO * size / 2.0 + 1.0 } else { 1.0 };
        let (left, top) = ((bounds.left() - reach).floor(), (bounds.top() - reach).floor());
        let side = |from: f32, to: f32| (to + reach - from).ceil().max(1.0) as u32;
        let mut drawn = Pixmap::new(side(left, bounds.right()), side(top, bounds.bottom()))?;
        let (paint, to_corner) = (Paint::default(), Transform::from_translate(-left, -top));
        if is_halo {
            let stroke = Stroke { width: HALO * size, line_join: LineJoin::Round, ..Stroke::default() };
            drawn.stroke_path(path, &paint, &stroke, to_corner, None);
        } else {
            drawn.fill_path(path, &paint, FillRule::Winding, to_corner, None);
        }
        let cover = drawn.pixels().iter().map(|pixel| pixel.alpha()).collect();
        Some(Self { left: left as i32, top: top as i32, width: drawn.width() as usize, cover })
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
