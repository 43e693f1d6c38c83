//! Motion during the exposure, as far as pixels tell: every pixel is the mean along a line through it.
//!
//! Light that saturated before it was smeared is not put back: a simulator that moves what it draws does better.

use photinus_io::image::GreyImage;

use super::{repainted, to_grey};

/// Steps to the right and down, and the weight of the pixel there.
pub(super) struct Kernel(Vec<(isize, isize, f32)>);

impl Kernel {
    /// Samples per pixel of length.
    const FINENESS: f64 = 8.0;

    /// A line of `length_px` centred on the pixel, `direction_rad` from right towards down.
    pub(super) fn new(length_px: f64, direction_rad: f64) -> Self {
        let (sin, cos) = libm::sincos(direction_rad);
        let samples = (Self::FINENESS * length_px).ceil().max(1.0);
        let reach = (0.5 * length_px).ceil() as isize + 1;
        let side = 2 * reach as usize + 1;
        let mut weights = vec![0.0; side * side];
        for sample in 0..samples as usize {
            let along = length_px * ((sample as f64 + 0.5) / samples - 0.5);
            let (u, v) = (along * cos, along * sin);
            let (left, top) = (u.floor(), v.floor());
            let (right_share, lower_share) = (u - left, v - top);
            for (step_u, share_u) in [(0, 1.0 - right_share), (1, right_share)] {
                for (step_v, share_v) in [(0, 1.0 - lower_share), (1, lower_share)] {
                    let column = left as isize + step_u + reach;
                    let row = top as isize + step_v + reach;
                    weights[row as usize * side + column as usize] += share_u * share_v / samples;
                }
            }
        }
        let steps = weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0);
        let step = |index: usize| index as isize - reach;
        Self(steps.map(|(i, &weight)| (step(i % side), step(i / side), weight as f32)).collect())
    }

    /// The image goes on past its edges as it ends.
    pub(super) fn apply(&self, image: &GreyImage) -> GreyImage {
        let (width, height) = (image.width(), image.height());
        let pixels = image.pixels();
        let stepped = |at: usize, step: isize, side: usize| at.saturating_add_signed(step).min(side - 1);
        let smeared = (0..pixels.len()).map(|i| {
            let (u, v) = (i % width, i / width);
            let parts = self.0.iter().map(|&(du, dv, weight)| {
                weight * f32::from(pixels[stepped(v, dv, height) * width + stepped(u, du, width)])
            });
            to_grey(f64::from(parts.fold(0.0, |sum: f32, part| sum + part)))
        });
        repainted(image, smeared.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_has_its_length_and_direction() {
        for (length_px, direction_rad) in
            [(3.0, 0.0), (6.0, 0.0), (6.0, 0.5), (10.0, 2.2), (4.0, core::f64::consts::FRAC_PI_2)]
        {
            let Kernel(steps) = Kernel::new(length_px, direction_rad);
            let (sin, cos) = libm::sincos(direction_rad);
            let mean = |of: &dyn Fn(f64, f64) -> f64| {
                steps.iter().map(|&(u, v, weight)| f64::from(weight) * of(u as f64, v as f64)).sum::<f64>()
            };
            assert!((mean(&|_, _| 1.0) - 1.0).abs() < 1e-6);
            assert!(mean(&|u, _| u).abs() < 1e-6 && mean(&|_, v| v).abs() < 1e-6);
            // a box of length L has variance L^2 / 12; a place between pixels adds f (1 - f) along each axis, 0 to 1/4
            let along = mean(&|u, v| (u * cos + v * sin).powi(2)) - length_px * length_px / 12.0;
            let across = mean(&|u, v| (v * cos - u * sin).powi(2));
            assert!((-0.01..0.26).contains(&along), "{length_px} {direction_rad}: {along}");
            assert!((-1e-9..0.26).contains(&across), "{length_px} {direction_rad}: {across}");
            if direction_rad == 0.0 {
                assert!((along - 1.0 / 6.0).abs() < 0.01 && across < 1e-9, "{along} {across}");
            }
        }
    }

    #[test]
    fn a_point_becomes_a_streak_of_the_same_light() {
        let mut pixels = vec![0; 41 * 31];
        pixels[15 * 41 + 20] = 240;
        let image = GreyImage::new(pixels, 41, 31).unwrap();
        let smeared = Kernel::new(6.0, 0.0).apply(&image);
        let row = &smeared.pixels()[15 * 41..][..41];
        assert_eq!(row.iter().filter(|&&grey| grey >= 20).count(), 7, "{row:?}");
        assert_eq!(row[18..=22], [40; 5], "240 / 6");
        let light: u32 = smeared.pixels().iter().map(|&grey| u32::from(grey)).sum();
        assert!((236..=244).contains(&light), "{light}");
        assert_eq!(smeared.pixels().iter().filter(|&&grey| grey > 0).count(), 7, "one row only");
    }
}
