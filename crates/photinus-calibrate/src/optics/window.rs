//! What is kept of frames: pixels around a spot that stands alone, and patches without light.

/// Pixels to every side of the middle of a window.
pub(super) const REACH: usize = 12;
/// Pixels along a side.
pub(super) const SIDE: usize = 2 * REACH + 1;
/// Pixels along a side of a patch.
pub(super) const PATCH_SIDE: usize = 9;

/// A spot and the pixels around it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Window {
    /// Column of the middle pixel.
    pub(super) column: usize,
    /// Row of the middle pixel.
    pub(super) row: usize,
    /// Pixels to every side that no other spot lights.
    pub(super) reach: usize,
    /// Where in the recording it was seen.
    pub(super) seen: Seen,
    /// Row by row.
    pub(super) pixels: Box<[u8]>,
}

/// Where in a recording a spot was seen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Seen {
    /// Spots of one trail are one LED, as far as frames tell that follow each other.
    pub(super) trail: u64,
    /// Number of the frame.
    pub(super) frame: u64,
}

impl Window {
    /// The pixel this many columns and rows from the middle.
    pub(super) fn at(&self, column: isize, row: isize) -> u8 {
        let index = |offset: isize| (REACH as isize + offset) as usize;
        self.pixels[index(row) * SIDE + index(column)]
    }

    /// Pixels within the reach: columns and rows from the middle, value.
    pub(super) fn within(&self, reach: usize) -> impl Iterator<Item = (isize, isize, u8)> + '_ {
        let reach = reach.min(self.reach) as isize;
        (-reach..=reach)
            .flat_map(move |row| (-reach..=reach).map(move |column| (column, row, self.at(column, row))))
    }

    /// The outermost pixels that no other spot lights.
    pub(super) fn outermost(&self) -> impl Iterator<Item = (isize, isize, u8)> + '_ {
        let edge = self.reach as isize;
        let is_edge = move |(column, row, _): &(isize, isize, u8)| column.abs().max(row.abs()) == edge;
        self.within(self.reach).filter(is_edge)
    }

    /// How much the outermost pixels vary, grey levels^2: where the surroundings are uneven, by more than darkness does.
    pub(super) fn unevenness(&self) -> f64 {
        let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
        for value in self.outermost().map(|(.., value)| f64::from(value)) {
            (count, sum, squares) = (count + 1.0, sum + value, squares + value * value);
        }
        squares / count - (sum / count) * (sum / count)
    }

    /// Their median.
    pub(super) fn border(&self) -> u8 {
        let mut values: Vec<u8> = self.outermost().map(|(.., value)| value).collect();
        let middle = values.len() / 2;
        *values.select_nth_unstable(middle).1
    }

    /// The pixel where the light of the spot is: one that full pixels beside it with their noise do not choose.
    pub(super) fn middle(&self) -> u8 {
        let level = f64::from(self.border());
        let (mut sum, mut u, mut v) = (1e-9, 0.0, 0.0);
        for (column, row, value) in self.within(3) {
            let above = (f64::from(value) - level).max(0.0);
            (sum, u, v) = (sum + above, u + above * column as f64, v + above * row as f64);
        }
        self.at((u / sum).round() as isize, (v / sum).round() as isize)
    }

    /// The brightest of the nine pixels in the middle.
    pub(super) fn peak(&self) -> u8 {
        self.within(1).map(|(.., value)| value).max().unwrap_or(0)
    }
}

/// A patch of the image that no spot lights.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Patch {
    /// Row by row.
    pub(super) pixels: [u8; PATCH_SIDE * PATCH_SIDE],
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution as _, StandardNormal};
    use rand_pcg::Pcg64;

    use super::super::table::{Share, Shares, Table};
    use super::*;

    impl Window {
        /// One of many spots of a point spread, each elsewhere within a pixel, in read noise of 0.6 grey levels, on a level and in shot noise as told.
        pub(in super::super) fn drawn(
            number: usize,
            table: &Table,
            light: f64,
            (level, shot): (f64, f64),
            random: &mut Pcg64,
        ) -> Self {
            let mut shares = Shares::default();
            let at = |step: f64| (step * number as f64).fract() - 0.5;
            table.window(at(0.618), at(0.414), REACH, &mut shares);
            let mut read = |share: &Share| {
                let noise: f64 = StandardNormal.sample(random);
                let light = light * share.value;
                (level + light + noise * (0.36 + shot * light.max(0.0)).sqrt()).round().clamp(0.0, 255.0)
                    as u8
            };
            let pixels: Box<[u8]> = shares.of_pixels.iter().map(&mut read).collect();
            assert_eq!(pixels.len(), SIDE * SIDE);
            Self { column: 100, row: 100, reach: REACH, seen: Seen::default(), pixels }
        }
    }
}
