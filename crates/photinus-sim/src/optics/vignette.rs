//! Light that the rims of a lens cut off: the pupil, seen from the side, is the part that two circles share; and relative
//! illumination as it was measured of a real lens.

use core::f64::consts::FRAC_2_PI;

/// From where to where the rims cut light off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vignette {
    clear_rad: f64,
    dark_rad: f64,
}

impl Vignette {
    /// Nothing is cut off up to `clear_rad` off the axis, everything from `dark_rad` on; `None` unless 0 <= clear < dark <= pi.
    pub fn new(clear_rad: f64, dark_rad: f64) -> Option<Self> {
        let legal = (0.0..dark_rad).contains(&clear_rad) && dark_rad <= core::f64::consts::PI;
        legal.then_some(Self { clear_rad, dark_rad })
    }

    /// Share of the pupil that is open at an angle off the axis: two circles of the pupil's size whose centres move apart by
    /// two radii from where it is clear to where it is dark.
    pub fn open(&self, off_axis_rad: f64) -> f64 {
        let apart = ((off_axis_rad - self.clear_rad) / (self.dark_rad - self.clear_rad)).clamp(0.0, 1.0);
        (FRAC_2_PI * (libm::acos(apart) - apart * (1.0 - apart * apart).sqrt())).max(0.0)
    }
}

/// Relative illumination as it was measured of a lens: straight lines between angles, past the last as there.
#[derive(Clone, Debug, PartialEq)]
pub struct Falloff {
    /// Angle off the axis, rad, and the share of light that passes there.
    points: Vec<[f64; 2]>,
}

impl Falloff {
    /// From pairs of an angle off the axis, rad, and the share that passes; `None` unless angles rise and shares are not below 0.
    pub fn new(points: Vec<[f64; 2]>) -> Option<Self> {
        let rises = points.windows(2).all(|pair| pair[1][0] > pair[0][0]);
        let legal =
            points.iter().all(|[angle, share]| angle.is_finite() && *share >= 0.0 && share.is_finite());
        (rises && legal && !points.is_empty()).then_some(Self { points })
    }

    /// Share of light that passes at an angle off the axis.
    pub fn share(&self, off_axis_rad: f64) -> f64 {
        let between = |pair: &[[f64; 2]]| {
            let [[from, low], [to, high]] = [pair[0], pair[1]];
            low + (high - low) * ((off_axis_rad - from) / (to - from)).clamp(0.0, 1.0)
        };
        let here = self.points.windows(2).find(|pair| off_axis_rad <= pair[1][0]);
        here.map_or(self.points[self.points.len() - 1][1], between)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[allow(clippy::float_cmp, reason = "rounded to whole percents")]
    fn a_measured_falloff_is_straight_between_its_angles_and_even_beyond() {
        let falloff = Falloff::new(vec![[0.0, 1.0], [0.5, 0.8], [1.0, 0.2]]).unwrap();
        let shares = [0.0, 0.25, 0.5, 0.9, 1.0, 2.0].map(|rad| (100.0 * falloff.share(rad)).round());
        assert_eq!(shares, [100.0, 90.0, 80.0, 32.0, 20.0, 20.0]);
        assert_eq!((Falloff::new(vec![]), Falloff::new(vec![[0.1, 1.0], [0.1, 0.9]])), (None, None));
    }

    #[test]
    fn the_open_pupil_is_what_both_circles_hold() {
        let vignette = Vignette::new(0.5, 1.3).unwrap();
        for off_axis_rad in [0.2, 0.5, 0.7, 0.9, 1.1, 1.29, 1.5] {
            let apart = 2.0 * ((off_axis_rad - 0.5) / 0.8_f64).clamp(0.0, 1.0);
            let (mut both, mut one) = (0, 0);
            for i in 0..600 {
                for j in 0..600 {
                    let (x, y) = ((f64::from(i) - 299.5) / 300.0, (f64::from(j) - 299.5) / 300.0);
                    let inside = x * x + y * y < 1.0;
                    one += u32::from(inside);
                    both += u32::from(inside && (x - apart) * (x - apart) + y * y < 1.0);
                }
            }
            let share = f64::from(both) / f64::from(one);
            assert!((vignette.open(off_axis_rad) - share).abs() < 2e-3, "{share} at {off_axis_rad}");
        }
        assert_eq!(
            (Vignette::new(1.0, 1.0), Vignette::new(-0.1, 1.0), Vignette::new(0.0, 4.0)),
            (None, None, None)
        );
    }
}
