//! Where in the image LEDs were seen, and where photos are missing.

use std::fmt;

use crate::adjust::View;

/// A ninth of the image: the middle, or a strip along an edge, or a corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Part {
    column: usize,
    row: usize,
}

/// How wide the strips along the edges are, as a share of the image.
pub const STRIP: f64 = 0.22;
/// A part is seen by a photo that shows this many LEDs in it.
const LEDS: usize = 3;

/// How often each part of the image was seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Coverage {
    photos: usize,
    seen: [[usize; 3]; 3],
}

/// A part of the image where photos are missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lack {
    /// Which part.
    pub part: Part,
    /// Photos that show it.
    pub have: usize,
    /// How many more are wanted.
    pub more: usize,
}

impl Part {
    /// All nine, row by row.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..9).map(|i| Self { column: i % 3, row: i / 3 })
    }

    /// Column and row of this part, 0 to 2.
    pub fn place(self) -> [usize; 2] {
        [self.column, self.row]
    }

    /// Photos that a good calibration has of it. Not every lens shows the corners.
    fn wanted(self) -> usize {
        match (self.column, self.row) {
            (1, 1) => 4,
            (1, _) | (_, 1) => 3,
            _ => 1,
        }
    }

    fn of(share: [f64; 2]) -> Self {
        let third = |x: f64| {
            if x < STRIP {
                0
            } else if x < 1.0 - STRIP {
                1
            } else {
                2
            }
        };
        Self { column: third(share[0]), row: third(share[1]) }
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match (self.column, self.row) {
            (0, 0) => "in the top left corner",
            (1, 0) => "at the top edge",
            (2, 0) => "in the top right corner",
            (0, 1) => "at the left edge",
            (1, 1) => "in the middle",
            (2, 1) => "at the right edge",
            (0, 2) => "in the bottom left corner",
            (1, 2) => "at the bottom edge",
            _ => "in the bottom right corner",
        })
    }
}

impl fmt::Display for Lack {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (more, photos) = (self.more, if self.more == 1 { "photo" } else { "photos" });
        write!(f, "take {more} more {photos} with the grid {}", self.part)?;
        if self.part.column != 1 && self.part.row != 1 {
            write!(f, " if the lens shows it")?;
        }
        Ok(())
    }
}

impl Coverage {
    /// What these views of images of `size_px` cover.
    pub fn of(views: &[View], size_px: [usize; 2]) -> Self {
        let mut seen = [[0; 3]; 3];
        for view in views {
            let mut leds = [[0; 3]; 3];
            for spot in &view.observations {
                let share = |axis: usize| (spot.pixel[axis] + 0.5) / size_px[axis] as f64;
                let part = Part::of([share(0), share(1)]);
                leds[part.row][part.column] += 1;
            }
            for part in Part::all() {
                seen[part.row][part.column] += usize::from(leds[part.row][part.column] >= LEDS);
            }
        }
        Self { photos: views.len(), seen }
    }

    /// Photos in all.
    pub fn photos(&self) -> usize {
        self.photos
    }

    /// Photos that show a part.
    pub fn seen(&self, part: Part) -> usize {
        self.seen[part.row][part.column]
    }

    /// Where photos are missing, the emptiest part first.
    pub fn lacks(&self) -> Vec<Lack> {
        let lack = |part: Part| {
            let have = self.seen(part);
            Lack { part, have, more: part.wanted().saturating_sub(have) }
        };
        let mut lacks: Vec<Lack> = Part::all().map(lack).filter(|lack| lack.more > 0).collect();
        lacks.sort_by_key(|lack| (std::cmp::Reverse(lack.more), lack.part));
        lacks
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;
    use crate::adjust::Observation;

    #[test]
    fn what_is_missing_is_named() {
        let at = |u: f64, v: f64| {
            let observations = (0..4).map(|led| Observation { led, pixel: Vector2::new(u + led as f64, v) });
            View { photo: 0, observations: observations.collect() }
        };
        let views: Vec<View> =
            (0..5).flat_map(|_| [at(300.0, 200.0), at(300.0, 10.0), at(600.0, 200.0)]).collect();
        let coverage = Coverage::of(&views, [640, 400]);
        assert_eq!(coverage.photos(), 15);
        let said: Vec<String> = coverage.lacks().iter().map(Lack::to_string).collect();
        assert_eq!(said[0], "take 3 more photos with the grid at the left edge");
        assert_eq!(said[1], "take 3 more photos with the grid at the bottom edge");
        assert_eq!(said[2], "take 1 more photo with the grid in the top left corner if the lens shows it");
        assert_eq!(said.len(), 6);
    }
}
