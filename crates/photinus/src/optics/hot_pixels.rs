//! Pixels that are bright without light: a list, as a calibration found them.

use alloc::vec::Vec;

use super::{Measured, OpticsError, check};

/// A pixel that reads more than those around it in every frame, whatever falls on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HotPixel {
    /// Its column and row, px.
    pub column: u32,
    /// Its row, px.
    pub row: u32,
    /// How far it stands above the pixels around it, grey levels, at the exposure and temperature of the calibration.
    pub level_dn: Measured,
}

/// The hot pixels of a sensor, row by row; none where nobody looked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HotPixels {
    pixels: Vec<HotPixel>,
}

impl HotPixels {
    /// From pixels in any order.
    ///
    /// # Errors
    /// [`OpticsError`] when a pixel stands there twice, or a level is not 0 to 255 grey levels with a finite sigma.
    pub fn new(mut pixels: Vec<HotPixel>) -> Result<Self, OpticsError> {
        pixels.sort_unstable_by_key(place);
        for pixel in &pixels {
            let Measured { value, sigma } = pixel.level_dn;
            check("the level of a hot pixel", value, (0.0..=255.0).contains(&value), "0 to 255 grey levels")?;
            check("a sigma", sigma, sigma >= 0.0 && sigma.is_finite(), "0 or more")?;
        }
        for pair in pixels.windows(2) {
            let column = f64::from(pair[1].column);
            check(
                "the column of a hot pixel",
                column,
                place(&pair[0]) != place(&pair[1]),
                "told once in its row",
            )?;
        }
        Ok(Self { pixels })
    }

    /// All of them, row by row.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &HotPixel> {
        self.pixels.iter()
    }

    /// Those of one row, from left to right.
    pub fn of_row(&self, row: u32) -> &[HotPixel] {
        let first = self.pixels.partition_point(|pixel| pixel.row < row);
        let end = self.pixels.partition_point(|pixel| pixel.row <= row);
        &self.pixels[first..end]
    }

    /// The hot pixel at a column and row, if that one is hot.
    pub fn at(&self, column: u32, row: u32) -> Option<&HotPixel> {
        let found = self.pixels.binary_search_by_key(&(row, column), place);
        found.ok().map(|at| &self.pixels[at])
    }
}

fn place(pixel: &HotPixel) -> (u32, u32) {
    (pixel.row, pixel.column)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hot(column: u32, row: u32) -> HotPixel {
        HotPixel { column, row, level_dn: Measured { value: 20.0, sigma: 0.5 } }
    }

    #[test]
    fn pixels_are_found_by_their_place_whatever_the_order_they_came_in() {
        let hot_pixels = HotPixels::new(vec![hot(5, 9), hot(7, 2), hot(1, 9), hot(30, 2)]).unwrap();
        let columns = |row: u32| hot_pixels.of_row(row).iter().map(|pixel| pixel.column).collect::<Vec<_>>();
        assert_eq!((columns(2), columns(9), columns(3)), (vec![7, 30], vec![1, 5], vec![]));
        assert!(hot_pixels.at(5, 9).is_some() && hot_pixels.at(9, 5).is_none());
    }

    #[test]
    fn a_pixel_stands_there_once_and_its_level_is_a_grey_level() {
        assert!(HotPixels::new(vec![hot(5, 9), hot(5, 9)]).is_err());
        let bright = HotPixel { level_dn: Measured { value: 300.0, sigma: 0.0 }, ..hot(1, 1) };
        assert!(HotPixels::new(vec![bright]).is_err());
    }
}
