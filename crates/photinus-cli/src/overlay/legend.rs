//! What the marks mean, in one line below the panels.

use tiny_skia::Point;

use super::canvas::{Align, Canvas, Pen, Words};
use super::colours;

/// A mark of the legend.
#[derive(Clone, Copy)]
enum Mark {
    Spot,
    Rejected,
    Neighbour,
    Bounds,
    Estimate,
    Followed,
    Truth,
    /// Words without a mark.
    Words,
}

/// Which marks there are besides those of spots.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Kinds {
    pub(super) neighbours: bool,
    pub(super) followed: bool,
    pub(super) truth: bool,
}

const MARKS: [(Mark, &str); 2] = [(Mark::Spot, "spot"), (Mark::Rejected, "rejected, and why")];
const NEIGHBOUR_MARKS: [(Mark, &str); 5] = [
    (Mark::Spot, "spot of no neighbour"),
    (Mark::Rejected, "rejected, and why"),
    (Mark::Neighbour, "spots of a neighbour"),
    (Mark::Bounds, "bounds: truth is within"),
    (Mark::Estimate, "estimate ± 1 σ"),
];
/// What stands beside spots; last, for it may lie outside of a narrow picture.
const NUMBER: (Mark, &str) = (Mark::Words, "7 42 %: spot 7, a marker with 42 %");

/// Draws the legend to the right of `at`, through its middle; that of neighbours where they are looked for.
pub(super) fn draw(canvas: &mut Canvas<'_>, at: Point, kinds: Kinds, unit: f32) {
    let marks = if kinds.neighbours { &NEIGHBOUR_MARKS[..] } else { &MARKS };
    let followed = kinds.followed.then_some((Mark::Followed, "2 s ago to 0.5 s ahead; # is its id"));
    let truth = kinds.truth.then_some((Mark::Truth, "truth"));
    let mut x = at.x;
    for (mark, text) in marks.iter().copied().chain(followed).chain(truth).chain([NUMBER]) {
        let width = mark.draw(canvas, Point::from_xy(x, at.y), unit);
        let words = Words { text, size: 13.0 * unit, colour: colours::INK, halo: None };
        let begin = x + width + 7.0 * unit;
        canvas.words(words, Point::from_xy(begin, at.y + 4.6 * unit), Align::Left);
        x = begin + canvas.width_of(words) + 22.0 * unit;
    }
}

impl Mark {
    /// Draws the mark to the right of `at` and gives its width.
    fn draw(self, canvas: &mut Canvas<'_>, at: Point, unit: f32) -> f32 {
        let colour = colours::neighbour(0);
        let x = |offset: f32| Point::from_xy(at.x + offset * unit, at.y);
        match self {
            Mark::Spot => {
                canvas.circle(x(7.0), 6.0 * unit, Pen::new(colours::SPOT, 1.6 * unit).on(colours::SHADE));
                14.0 * unit
            }
            Mark::Rejected => {
                let r = 7.0 * unit;
                let centre = x(7.0);
                let diamond = [(r, 0.0), (0.0, r), (-r, 0.0), (0.0, -r)]
                    .map(|(dx, dy)| Point::from_xy(centre.x + dx, centre.y + dy));
                canvas.outline(&diamond, Pen::new(colours::REJECTED, 1.4 * unit).on(colours::SHADE));
                14.0 * unit
            }
            Mark::Followed => {
                canvas.line(&[x(0.0), x(20.0)], Pen::new(colour, 1.2 * unit));
                canvas.arrow(x(20.0), x(36.0), Pen::new(colour, 2.0 * unit), 6.0 * unit);
                36.0 * unit
            }
            Mark::Words => 0.0,
            Mark::Truth => {
                canvas.square(x(7.0), 6.0 * unit, Pen::new(colours::INK, 1.8 * unit));
                14.0 * unit
            }
            Mark::Neighbour => {
                let pen = Pen::new(colour, 1.6 * unit).on(colours::SHADE);
                canvas.line(&[x(15.0), x(29.0)], pen);
                canvas.circle(x(7.0), 6.0 * unit, pen);
                canvas.circle(x(37.0), 6.0 * unit, pen);
                44.0 * unit
            }
            Mark::Bounds => {
                canvas.line(&[x(0.0), x(40.0)], Pen::new(colours::pale(colour, 0.45), 9.0 * unit));
                cap(canvas, x(0.0), 8.0 * unit, Pen::new(colour, 1.6 * unit));
                cap(canvas, x(40.0), 8.0 * unit, Pen::new(colour, 1.6 * unit));
                40.0 * unit
            }
            Mark::Estimate => {
                let pen = Pen::new(colour, 2.6 * unit);
                canvas.line(&[x(0.0), x(32.0)], pen);
                cap(canvas, x(0.0), 4.5 * unit, pen);
                cap(canvas, x(32.0), 4.5 * unit, pen);
                canvas.disc(x(16.0), 5.0 * unit, colour);
                32.0 * unit
            }
        }
    }
}

fn cap(canvas: &mut Canvas<'_>, at: Point, half: f32, pen: Pen) {
    canvas.line(&[Point::from_xy(at.x, at.y - half), Point::from_xy(at.x, at.y + half)], pen);
}
