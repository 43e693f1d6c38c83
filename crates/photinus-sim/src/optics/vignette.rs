//! Light that the rims of a lens cut off: the pupil, seen from the side, is the part that two circles share.

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

#[cfg(test)]
mod tests {
    use super::*;

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
