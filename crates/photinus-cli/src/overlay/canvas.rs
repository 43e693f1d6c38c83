//! A picture to draw on: lines, discs, polygons and words, all antialiased; no meaning.

use photinus::frame::FrameView;
use tiny_skia::{
    ColorU8 as Colour, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Point,
    PremultipliedColorU8, Rect, Stroke, Transform,
};

use super::text::{Font, Stamp};
use super::zoom::Zoom;

/// How a line is drawn.
#[derive(Clone, Copy)]
pub(super) struct Pen {
    pub(super) colour: Colour,
    pub(super) width: f32,
    /// Drawn wider behind it, so that it stands out on any ground.
    pub(super) halo: Option<Colour>,
}

impl Pen {
    /// A plain line.
    pub(super) fn new(colour: Colour, width: f32) -> Self {
        Self { colour, width, halo: None }
    }

    /// With a halo.
    pub(super) fn on(self, halo: Colour) -> Self {
        Self { halo: Some(halo), ..self }
    }
}

/// Where words stand against their point.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Align {
    Left,
    Middle,
}

/// Words and how they are drawn.
#[derive(Clone, Copy)]
pub(super) struct Words<'a> {
    pub(super) text: &'a str,
    /// Of an em, px.
    pub(super) size: f32,
    pub(super) colour: Colour,
    pub(super) halo: Option<Colour>,
}

/// A picture in the making, opaque everywhere.
pub(super) struct Canvas<'c> {
    pixmap: &'c mut Pixmap,
    font: &'c mut Font,
}

impl<'c> Canvas<'c> {
    /// Goes on with what is drawn already.
    pub(super) fn on(pixmap: &'c mut Pixmap, font: &'c mut Font) -> Self {
        Self { pixmap, font }
    }

    /// Makes all of it one colour.
    pub(super) fn fill_all(&mut self, ground: Colour) {
        let (red, green, blue) = (ground.red(), ground.green(), ground.blue());
        self.pixmap.fill(tiny_skia::Color::from_rgba8(red, green, blue, u8::MAX));
    }

    /// A grey frame, its levels replaced through `levels`.
    pub(super) fn frame(
        &mut self,
        frame: &FrameView<'_>,
        (left, top): (u32, u32),
        zoom: Zoom,
        levels: &[u8; 256],
    ) {
        let (width, height) = (self.pixmap.width() as usize, self.pixmap.height() as usize);
        let (left, top) = (left as usize, top as usize);
        let drawn = |px: usize| zoom.drawn_px(u32::try_from(px).unwrap_or(u32::MAX)) as usize;
        let rows = drawn(frame.height()).min(height.saturating_sub(top));
        let columns = drawn(frame.width()).min(width.saturating_sub(left));
        let greys = levels.map(|level| {
            // Opaque, so that no part of the colour is above its opacity.
            PremultipliedColorU8::from_rgba(level, level, level, u8::MAX)
                .unwrap_or(PremultipliedColorU8::TRANSPARENT)
        });
        let pixels = self.pixmap.pixels_mut();
        let mut brightest = vec![0_u8; frame.width()];
        let mut last = None;
        for y in 0..rows {
            let begin = (top + y) * width + left;
            let shown = zoom.shown(y, frame.height());
            if last.replace(shown.clone()) == Some(shown.clone()) {
                pixels.copy_within(begin - width..begin - width + columns, begin);
                continue;
            }
            // The brightest of what is shown, so that no spot is lost in a smaller picture.
            brightest.fill(0);
            for row in shown {
                brightest.iter_mut().zip(frame.row(row)).for_each(|(most, &level)| *most = level.max(*most));
            }
            let row = &mut pixels[begin..begin + columns];
            match zoom {
                Zoom::In(times) => {
                    let shown = row.chunks_mut(times as usize).zip(&brightest);
                    shown.for_each(|(shown, &level)| shown.fill(greys[usize::from(level)]));
                }
                Zoom::Out(times) => {
                    let shown = row.iter_mut().zip(brightest.chunks(times as usize));
                    for (pixel, across) in shown {
                        *pixel = greys[usize::from(across.iter().copied().max().unwrap_or_default())];
                    }
                }
            }
        }
    }

    /// A filled rectangle.
    pub(super) fn rectangle(&mut self, rect: Rect, colour: Colour) {
        self.pixmap.fill_rect(rect, &paint(colour), Transform::identity(), None);
    }

    /// A line through points.
    pub(super) fn line(&mut self, points: &[Point], pen: Pen) {
        if let Some(path) = path_through(points, false) {
            self.stroke(&path, pen);
        }
    }

    /// A line with a head of `head` px; where it is too short for that, nothing.
    pub(super) fn arrow(&mut self, from: Point, to: Point, pen: Pen, head: f32) {
        let (dx, dy) = (to.x - from.x, to.y - from.y);
        let length = (dx * dx + dy * dy).sqrt();
        if !(head..=1e5).contains(&length) {
            return;
        }
        let (x, y) = (dx / length * head, dy / length * head);
        let base = Point::from_xy(to.x - x, to.y - y);
        self.line(&[from, base], pen);
        let side = |sign: f32| Point::from_xy(base.x - sign * 0.5 * y, base.y + sign * 0.5 * x);
        self.polygon(&[to, side(1.0), side(-1.0)], pen.colour);
    }

    /// The outline of a polygon.
    pub(super) fn outline(&mut self, points: &[Point], pen: Pen) {
        if let Some(path) = path_through(points, true) {
            self.stroke(&path, pen);
        }
    }

    /// A square about a point, of twice `half` a side.
    pub(super) fn square(&mut self, centre: Point, half: f32, pen: Pen) {
        let corners = [(half, half), (-half, half), (-half, -half), (half, -half)];
        self.outline(&corners.map(|(dx, dy)| Point::from_xy(centre.x + dx, centre.y + dy)), pen);
    }

    /// A filled polygon.
    pub(super) fn polygon(&mut self, points: &[Point], colour: Colour) {
        if let Some(path) = path_through(points, true) {
            self.fill(&path, colour);
        }
    }

    /// A circle.
    pub(super) fn circle(&mut self, centre: Point, radius: f32, pen: Pen) {
        if let Some(path) = PathBuilder::from_circle(centre.x, centre.y, radius) {
            self.stroke(&path, pen);
        }
    }

    /// A filled circle.
    pub(super) fn disc(&mut self, centre: Point, radius: f32, colour: Colour) {
        if let Some(path) = PathBuilder::from_circle(centre.x, centre.y, radius) {
            self.fill(&path, colour);
        }
    }

    /// How wide words are, px.
    pub(super) fn width_of(&self, words: Words<'_>) -> f32 {
        self.font.width(words.text, words.size)
    }

    /// Words on a baseline through `at`.
    pub(super) fn words(&mut self, words: Words<'_>, at: Point, align: Align) {
        let width = self.width_of(words);
        let x = match align {
            Align::Left => at.x,
            Align::Middle => at.x - width / 2.0,
        };
        let row = at.y.round() as i32;
        let (width, pixels) = (self.pixmap.width() as usize, self.pixmap.pixels_mut());
        if let Some(halo) = words.halo {
            self.font.stamps(words.text, x, words.size, true, |stamp, column| {
                press(stamp, (column, row), halo, (pixels, width));
            });
        }
        self.font.stamps(words.text, x, words.size, false, |stamp, column| {
            press(stamp, (column, row), words.colour, (pixels, width));
        });
    }

    fn fill(&mut self, path: &Path, colour: Colour) {
        self.pixmap.fill_path(path, &paint(colour), FillRule::Winding, Transform::identity(), None);
    }

    fn stroke(&mut self, path: &Path, pen: Pen) {
        let mut draw = |colour, width| {
            let stroke =
                Stroke { width, line_cap: LineCap::Butt, line_join: LineJoin::Round, ..Stroke::default() };
            self.pixmap.stroke_path(path, &paint(colour), &stroke, Transform::identity(), None);
        };
        if let Some(halo) = pen.halo {
            draw(halo, 2.4 * pen.width);
        }
        draw(pen.colour, pen.width);
    }
}

/// Lays a colour over the pixels that a stamp covers, as far as they are in the picture.
fn press(
    stamp: &Stamp,
    (column, row): (i32, i32),
    colour: Colour,
    (pixels, width): (&mut [PremultipliedColorU8], usize),
) {
    for (line, y) in stamp.cover.chunks_exact(stamp.width).zip(row + stamp.top..) {
        let Some(begin) =
            usize::try_from(y).ok().map(|y| y * width).filter(|begin| begin + width <= pixels.len())
        else {
            continue;
        };
        for (&cover, x) in line.iter().zip(column + stamp.left..) {
            let Some(x) = usize::try_from(x).ok().filter(|&x| x < width && cover > 0) else { continue };
            let pixel = &mut pixels[begin + x];
            let mix = |over: u8, under: u8| {
                let (over, under, cover) = (u32::from(over), u32::from(under), u32::from(cover));
                ((over * cover + under * (255 - cover) + 127) / 255) as u8
            };
            let (red, green, blue) = (
                mix(colour.red(), pixel.red()),
                mix(colour.green(), pixel.green()),
                mix(colour.blue(), pixel.blue()),
            );
            if let Some(mixed) = PremultipliedColorU8::from_rgba(red, green, blue, u8::MAX) {
                *pixel = mixed;
            }
        }
    }
}

fn paint(colour: Colour) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(colour.red(), colour.green(), colour.blue(), colour.alpha());
    paint
}

fn path_through(points: &[Point], closed: bool) -> Option<Path> {
    let (first, rest) = points.split_first()?;
    let mut path = PathBuilder::new();
    path.move_to(first.x, first.y);
    rest.iter().for_each(|point| path.line_to(point.x, point.y));
    if closed {
        path.close();
    }
    path.finish()
}
