//! The inverse of a rising function that has no closed form: a table to start from, Newton to finish, a bracket for safety.

use alloc::vec;
use alloc::vec::Vec;

/// Where a root lies, and where to start looking for it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bracket {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) start: f64,
}

impl Bracket {
    /// From 0 to `high`, starting at `start` or the nearest end.
    pub(super) fn up_to(high: f64, start: f64) -> Self {
        Self { low: 0.0, high, start: start.min(high) }
    }

    /// The root of a rising function, given its value and slope, to 1e-12 relative or better (the step that is
    /// that small is still taken, and Newton's error is its square); `None` when it does not settle.
    #[inline]
    pub(super) fn root(mut self, value_and_slope: impl Fn(f64) -> (f64, f64)) -> Option<f64> {
        let mut x = self.start;
        for _ in 0..200 {
            let (value, slope) = value_and_slope(x);
            if value <= 0.0 {
                self.low = x;
            } else {
                self.high = x;
            }
            let newton = x - value / slope;
            let inside = newton >= self.low && newton <= self.high;
            let next = if inside { newton } else { 0.5 * (self.low + self.high) };
            if (next - x).abs() <= 1e-12 * next.abs() {
                return Some(next);
            }
            x = next;
        }
        None
    }
}

/// A rising function x(y) with x(0) = 0, known at even steps of y.
#[derive(Clone, Debug, PartialEq, Default)]
pub(super) struct Inverse {
    knots: Vec<f64>,
    knots_per_y: f64,
}

impl Inverse {
    const INTERVALS: usize = 256;

    /// Tabulates x over y from 0 to `top`, where x is at most `x_max`; `solve` finds x for one y.
    pub(super) fn tabulate(
        top: f64,
        x_max: f64,
        solve: impl Fn(f64, Bracket) -> Option<f64>,
    ) -> Option<Self> {
        let mut knots = vec![0.0];
        for i in 1..=Self::INTERVALS {
            let y = top * i as f64 / Self::INTERVALS as f64;
            let start = knots[i - 1];
            let x = solve(y, Bracket { low: 0.0, high: x_max * (1.0 + 1e-9), start })?;
            knots.push(x.max(start));
        }
        Some(Self { knots, knots_per_y: Self::INTERVALS as f64 / top })
    }

    /// Where x(y) lies; a `y` past the table is taken as its end.
    #[inline]
    pub(super) fn bracket(&self, y: f64) -> Bracket {
        let place = (y * self.knots_per_y).clamp(0.0, Self::INTERVALS as f64);
        let i = (place as usize).min(Self::INTERVALS - 1);
        let (low, high) = (self.knots[i], self.knots[i + 1]);
        let slack = 1e-9 * self.knots[Self::INTERVALS];
        Bracket {
            low: (low - slack).max(0.0),
            high: high + slack,
            start: low + (place - i as f64) * (high - low),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(y: f64) -> impl Fn(f64) -> (f64, f64) {
        move |x| (x * x * x + x - y, 3.0 * x * x + 1.0)
    }

    #[test]
    fn table_and_newton_invert_a_cubic() {
        let table = Inverse::tabulate(10.0, 2.0, |y, bracket| bracket.root(cube(y))).unwrap();
        for i in 0..=1000 {
            let y = 10.0 * f64::from(i) / 1000.0;
            let x = table.bracket(y).root(cube(y)).unwrap();
            assert!((x * x * x + x - y).abs() <= 4e-15 * (1.0 + y), "{y}");
        }
    }

    #[test]
    fn a_bad_slope_falls_back_to_halving() {
        let root = Bracket::up_to(4.0, 1.0).root(|x| (x - 3.0, 0.0)).unwrap();
        assert!((root - 3.0).abs() < 1e-11);
        assert_eq!(Bracket::up_to(1.0, 0.5).root(|_| (f64::NAN, f64::NAN)).map(|x| x < 1e-9), None);
    }
}
