//! Windows in; how the level that each spot stands on changes from its middle out: the sky is no even ground.
//!
//! The outermost pixels of a window, a square ring, see no light of the spot. A polynomial in columns and rows is fitted to them. What one
//! ring tells is as much chance as ground, so all windows together tell what is to be expected: what is common to them (the median), and
//! how far they differ from that beyond chance (H. Robbins' empirical Bayes, 1956). Each window is taken for what lies between that and
//! its own ring. Before darkness that is even ground; a slope that all have is kept, however little one ring tells of it.

use nalgebra::{DMatrix, DVector, SVector};

use super::window::Window;

/// A ring nearer than this has light of its own spot, px.
const LEAST_REACH: usize = 8;
/// Bends are told by corners against sides, which the wings of a spot light unlike in a nearer ring, px.
const LEAST_BENT: usize = 11;
/// What rings have in common is kept as far as it explains more than so many times what it does by chance.
const CHANCES: f64 = 4.0;
/// Terms of a polynomial of order 2, and where orders begin and end.
const TERMS: usize = 6;
const ORDERS: [core::ops::Range<usize>; 2] = [1..3, 3..TERMS];

/// The level around the middle of a window above that in the middle: coefficients of the terms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ground(SVector<f64, TERMS>);

/// The polynomial that fits a ring best.
struct Fitted {
    ground: Ground,
    /// Terms of it that the ring tells.
    told: usize,
    /// From coefficients to what their terms, orthogonal to those before, explain.
    upper: DMatrix<f64>,
    /// Variance of what is left, grey levels^2.
    left: f64,
}

/// The ground under each spot.
pub(super) fn under(windows: &[Window]) -> Vec<Ground> {
    let fitted: Vec<Fitted> = windows.iter().map(Fitted::to).collect();
    let mut common = Ground::even();
    let spreads = ORDERS.map(|order| {
        let told: Vec<&Fitted> = fitted.iter().filter(|fitted| fitted.told >= order.end).collect();
        take_common(&told, &order, &mut common);
        let beyond = |fitted: &&Fitted| {
            fitted.squares(&fitted.apart(&common), &order) - order.len() as f64 * fitted.left
        };
        (told.iter().map(beyond).sum::<f64>() / told.len().max(1) as f64).max(0.0)
    });
    fitted.iter().map(|fitted| fitted.between(&common, &spreads)).collect()
}

/// What rings have in common of an order, as far as that is no chance (W. James and C. Stein, 1961).
fn take_common(told: &[&Fitted], order: &core::ops::Range<usize>, common: &mut Ground) {
    for term in order.clone() {
        common.0[term] = median(told.iter().map(|fitted| fitted.ground.0[term]).collect());
    }
    let by_chance =
        order.len() as f64 * told.iter().map(|fitted| fitted.left).sum::<f64>() / told.len() as f64;
    let explained = told.iter().map(|fitted| fitted.squares(common, order)).sum::<f64>();
    let kept = (1.0 - CHANCES * by_chance / explained.max(f64::MIN_POSITIVE)).max(0.0);
    order.clone().for_each(|term| common.0[term] *= kept);
}

impl Fitted {
    fn to(window: &Window) -> Self {
        let pixels: Vec<(isize, isize, u8)> = window.outermost().collect();
        let told = match window.reach {
            LEAST_BENT.. => ORDERS[1].end,
            LEAST_REACH.. => ORDERS[0].end,
            _ => 1,
        };
        let design = DMatrix::from_fn(pixels.len(), told, |row, term| {
            let (column, row, _) = pixels[row];
            terms(column, row)[term]
        });
        let values = DVector::from_iterator(pixels.len(), pixels.iter().map(|(.., value)| f64::from(*value)));
        let factors = design.qr();
        let along = factors.q().transpose() * &values;
        let upper = factors.r();
        let left = (values.norm_squared() - along.norm_squared()).max(0.0) / (pixels.len() - told) as f64;
        let found = upper.solve_upper_triangular(&along).unwrap_or_else(|| DVector::zeros(told));
        let coefficients = SVector::from_fn(|term, _| found.get(term).copied().unwrap_or(0.0));
        Self { ground: Ground(coefficients), told, upper, left }
    }

    /// What this ring has beyond the common ground.
    fn apart(&self, common: &Ground) -> Ground {
        Ground(self.ground.0 - common.0)
    }

    /// What terms of a ground make of the pixels of the ring, along axes that have nothing in common.
    fn along(&self, ground: &Ground) -> DVector<f64> {
        &self.upper * ground.0.rows(0, self.told)
    }

    /// The squares that an order of a ground explains, summed over the ring.
    fn squares(&self, ground: &Ground, order: &core::ops::Range<usize>) -> f64 {
        self.along(ground).rows_range(order.clone()).norm_squared()
    }

    /// The ground between the common one and that of this ring; where the ring tells nothing, none.
    fn between(&self, common: &Ground, spreads: &[f64; 2]) -> Ground {
        let mut apart = self.along(&self.apart(common));
        let mut ground = Ground::even();
        for (order, spread) in ORDERS.into_iter().zip(spreads).filter(|(order, _)| order.end <= self.told) {
            let by_chance = order.len() as f64 * self.left;
            apart.rows_range_mut(order).scale_mut(spread / (spread + by_chance).max(f64::MIN_POSITIVE));
        }
        let apart = self.upper.solve_upper_triangular(&apart).unwrap_or_else(|| DVector::zeros(self.told));
        (1..self.told).for_each(|term| ground.0[term] = common.0[term] + apart[term]);
        ground
    }
}

impl Ground {
    fn even() -> Self {
        Self(SVector::zeros())
    }

    /// How much higher a pixel stands than the middle, grey levels.
    pub(super) fn above_middle(&self, column: isize, row: isize) -> f64 {
        self.0.iter().zip(terms(column, row)).skip(1).map(|(coefficient, term)| coefficient * term).sum()
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// The terms of the polynomial at a pixel.
fn terms(column: isize, row: isize) -> [f64; TERMS] {
    let (u, v) = (column as f64, row as f64);
    [1.0, u, v, u * u, u * v, v * v]
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    use super::super::window::{REACH, SIDE, Seen};
    use super::*;

    const NOISE_DN: f64 = 0.7;

    fn windows(count: usize, reach: usize, level: impl Fn(f64, f64) -> f64) -> Vec<Window> {
        let mut random = Pcg64::new(2, 7);
        let mut read = |index: usize| {
            let [u, v] = [index % SIDE, index / SIDE].map(|at| at as f64 - REACH as f64);
            let normal: f64 = StandardNormal.sample(&mut random);
            (level(u, v) + NOISE_DN * normal).round().clamp(0.0, 255.0) as u8
        };
        let mut window = || {
            let pixels = (0..SIDE * SIDE).map(&mut read).collect();
            Window { column: 100, row: 100, reach, seen: Seen::default(), pixels }
        };
        (0..count).map(|_| window()).collect()
    }

    /// Of a slope that a single window hardly tells from none as well as of a steep one.
    #[test]
    fn ground_that_rises_and_bends_is_what_it_is_on_average_and_even_ground_is_even() {
        for steep in [0.0, 0.1, 1.0] {
            let sky = |u: f64, v: f64| 20.0 + steep * (0.02 * u - 0.2 * v - 0.012 * v * v);
            let grounds = under(&windows(400, 12, sky));
            for (column, row) in [(0, 6), (0, -6), (6, 0), (-6, 0), (4, 4)] {
                let expected = sky(column as f64, row as f64) - sky(0.0, 0.0);
                let found = grounds.iter().map(|ground| ground.above_middle(column, row));
                let (sum, squares) =
                    found.fold((0.0, 0.0), |(sum, squares), found| (sum + found, squares + found * found));
                let mean = sum / grounds.len() as f64;
                let close = 0.02 + 0.05 * expected.abs();
                assert!((mean - expected).abs() < close, "{mean} not {expected} at {column}, {row}: {steep}");
                let rms = (squares / grounds.len() as f64).sqrt();
                assert!(steep > 0.0 || rms < 0.03, "{rms} of even ground at {column}, {row}");
            }
        }
    }

    /// The nearer a ring, the more light of the spot it has: it would be taken for a dome.
    #[test]
    fn rings_that_are_near_tell_no_bends_and_nearer_ones_nothing() {
        let steep = |u: f64, v: f64| 40.0 + u - 0.1 * v * v;
        for ground in under(&windows(30, 9, steep)) {
            assert!((ground.above_middle(5, 0) - 5.0).abs() < 0.5 && ground.above_middle(0, 5).abs() < 0.5);
        }
        assert!(under(&windows(30, 6, steep)).iter().all(|ground| ground.above_middle(5, 0) == 0.0));
    }
}
