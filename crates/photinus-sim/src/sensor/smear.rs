//! Smear along columns: what a CCD's rows pick up on their way to the register.
//!
//! While a frame is shifted out, each of its pixels stands for a moment under every row of its column and takes light there,
//! or light leaks into the shaded register beside the pixels all through the exposure: either way every pixel of a column
//! gets the same share of the light of all of it (EMVA 1288 release 4.0 names it; typical -80 to -120 dB of the light).

use super::{Background, Charge};

/// Light that rows pick up on their way through a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColumnSmear {
    /// Share of the light of a whole column that each of its pixels gets besides its own, 0 to 0.1.
    pub share: f64,
}

impl ColumnSmear {
    /// A sensor without: CMOS with charge stored in the pixel.
    pub const NONE: Self = Self { share: 0.0 };

    /// Adds it for the light of markers.
    pub(super) fn of_light(&self, charge: &mut Charge) {
        if self.share <= 0.0 {
            return;
        }
        let mut columns = vec![0.0; charge.width()];
        for v in 0..charge.height() {
            if let Some((first, pixels)) = charge.touched_row_mut(v) {
                columns[first..].iter_mut().zip(pixels).for_each(|(sum, e)| *sum += *e);
            }
        }
        let lit = |e: &f32| *e > 0.0;
        let (Some(first), Some(last)) = (columns.iter().position(lit), columns.iter().rposition(lit)) else {
            return;
        };
        self.of_columns(charge, first, &columns[first..=last]);
    }

    /// Adds it for columns that hold this much light, from column `first` on.
    pub(super) fn of_columns(&self, charge: &mut Charge, first: usize, light_e: &[f32]) {
        if self.share > 0.0 {
            (0..charge.height()).for_each(|v| charge.add_row(v, first, light_e, self.share as f32));
        }
    }

    /// Adds it for what lies behind the markers.
    pub(super) fn of_background(&self, background: &mut Background, height: usize) {
        if self.share > 0.0 {
            background.smear(self.share as f32, height);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_of_a_column_gets_the_share_of_the_columns_light() {
        let mut charge = Charge::new(40, 30);
        charge.add(7, 3, 1e6);
        charge.add(7, 20, 5e5);
        charge.add(12, 29, 2e5);
        let smear = ColumnSmear { share: 1e-3 };
        smear.of_light(&mut charge);
        for v in 0..30 {
            let own = [(3, 1e6), (20, 5e5)].into_iter().find(|(row, _)| *row == v).map_or(0.0, |(_, e)| e);
            assert!((charge.at(7, v) - own - 1500.0).abs() < 0.5, "{}", charge.at(7, v));
            assert!((charge.at(12, v) - 200.0 - if v == 29 { 2e5 } else { 0.0 }).abs() < 0.1);
            assert!(charge.at(6, v) <= 0.0 && charge.at(10, v) <= 0.0);
        }
        assert!((charge.total() / 1.7e6 - 1.0 - 30.0 * 1e-3).abs() < 1e-6);
        let mut background = Background::new(40, 30);
        background.fill(|u, _| 10.0 + u as f32);
        smear.of_background(&mut background, 30);
        let mut row = Vec::new();
        background.row(11, &mut row);
        assert!((row[1] - 26.0 * 1.03).abs() < 1e-3, "{row:?}");
        let mut plain = Charge::new(4, 4);
        plain.add(1, 1, 5.0);
        ColumnSmear::NONE.of_light(&mut plain);
        assert_eq!(plain.touched(0), None);
    }
}
