//! The point spread over the image: tables at the nodes of a grid, between which it changes evenly.
//!
//! In each round the tables change so that they explain what fits leave of the pixels (weighted least squares for the coefficients
//! of their splines, `correction.rs`), held back by what is believed beforehand: that of the whole image is nearly round and
//! smooth, those of the nodes differ from it as much as the pixels make likely. Where the lens is even they therefore fall back on it.

use nalgebra::{DMatrix, DVector};
use photinus::optics::{OpticsError, PointSpread, SpreadField};

use super::correction::{Belief, Correction};
use super::noise::Noise;
use super::profile;
use super::spot::Spot;
use super::table::{COUNT, PER_PX, SIDE, Table, radius_px, weights};

/// The table of the whole image differs from a round one by this share, and relative changes bend by this from one sample to the
/// next but one.
const ROUND: Belief = Belief { apart: 0.4, bent: 0.08 };
/// What is first believed of the nodes' tables against that of the whole image.
const EVEN: Belief = Belief { apart: 0.3, bent: 0.06 };
/// Least and most that the nodes may come to differ.
const LEAST_APART: f64 = 1e-4;
const MOST_APART: f64 = 1.0;
/// Beyond this the table is the round one, px: nothing there stands out of the level.
const LEARNED_PX: f64 = 8.0;
/// Zones from one node to the next.
const ZONES_PER_NODE: usize = 2;
/// Samples of less than this share of the summit are noise more than light.
const FAINT: f64 = 0.01;
/// Samples of no more than this share of it are the wings; down to that one they tell how unsure faint ones are.
const WINGS: f64 = 0.3;
const FAINTEST_WING: f64 = 1e-3;
/// Rounds in which the errors of samples are weighed by what the round before has of them.
const ROUNDS_OF_SCATTER: usize = 8;
/// A sample counts as being of at least this share of the summit.
const FAINTEST: f64 = 2e-4;

/// Tables over the image.
#[derive(Clone, Debug)]
pub(super) struct Field {
    size_px: [f64; 2],
    nodes: [usize; 2],
    whole: Table,
    of_nodes: Vec<Table>,
    belief: Belief,
    zones: [usize; 2],
    of_zones: Vec<Table>,
}

impl Field {
    /// The same table all over the image; it may change between this many nodes along columns and rows.
    pub(super) fn new(start: Table, size_px: [usize; 2], nodes: [usize; 2]) -> Self {
        Self {
            size_px: size_px.map(|px| px as f64),
            nodes,
            of_nodes: vec![start.clone(); nodes[0] * nodes[1]],
            belief: EVEN,
            zones: [1, 1],
            of_zones: vec![start.clone()],
            whole: start,
        }
    }

    /// Tables that are known, of zones in rows of `columns`.
    pub(super) fn given(of_zones: Vec<Table>, columns: usize, size_px: [usize; 2]) -> Self {
        let zones = [columns, of_zones.len() / columns];
        let whole = of_zones[of_zones.len() / 2].clone();
        Self { zones, of_zones, ..Self::new(whole, size_px, [1, 1]) }
    }

    /// The table at a place.
    pub(super) fn at(&self, [u, v]: [f64; 2]) -> &Table {
        let zone = |px: f64, axis: usize| {
            let share = (px + 0.5) / self.size_px[axis] * self.zones[axis] as f64;
            (share.max(0.0) as usize).min(self.zones[axis] - 1)
        };
        &self.of_zones[zone(v, 1) * self.zones[0] + zone(u, 0)]
    }

    /// Whether a spot would have no pixel that reads `full_from`, wherever in a pixel it were.
    pub(super) fn is_never_full(&self, spot: &Spot<'_>, full_from: u8) -> bool {
        spot.level + spot.light * summit(self.at(spot.place_px())) < f64::from(full_from)
    }

    /// Learns what is the same all over the image from what the fits of spots leave.
    pub(super) fn learn_whole(&mut self, spots: &[Spot<'_>], noise: &Noise) {
        let mut whole = self.whole.clone();
        profile::correct(&mut whole, spots, self, noise);
        self.become_whole(whole);
        let round = round(&self.whole);
        let scale = scale(&round);
        let mut correction = Correction::new(&scale, &ROUND, 1);
        let all = |_: [f64; 2]| [(0, 1.0); 1];
        correction.gather(spots, self, noise, 0.1 * summit(&self.whole), all);
        correction.solve(&[&self.whole], &round);
        correction.apply(0, &mut self.whole, noise);
        self.become_whole(self.whole.clone());
    }

    /// Learns what the fits of spots leave, node by node where there are several.
    pub(super) fn learn(&mut self, spots: &[Spot<'_>], noise: &Noise) {
        match self.nodes {
            [1, 1] => self.learn_whole(spots, noise),
            _ => self.learn_nodes(spots, noise),
        }
    }

    /// Learns how the nodes differ.
    fn learn_nodes(&mut self, spots: &[Spot<'_>], noise: &Noise) {
        let scale = scale(&round(&self.whole));
        let mut correction = Correction::new(&scale, &self.belief, self.of_nodes.len());
        correction.gather(spots, self, noise, 0.03 * summit(&self.whole), |place| self.corners(place));
        correction.solve(&self.of_nodes.iter().collect::<Vec<_>>(), &self.whole);
        for (node, table) in self.of_nodes.iter_mut().enumerate() {
            correction.apply(node, table, noise);
        }
        // how far the nodes lie apart tells how far they may
        let apart = correction.apart(&self.of_nodes, &self.whole).clamp(LEAST_APART, MOST_APART);
        self.belief = Belief { apart, bent: EVEN.bent / EVEN.apart * apart };
        let count = self.of_nodes.len() as f64;
        let mut samples = vec![0.0; COUNT];
        for table in &self.of_nodes {
            samples.iter_mut().zip(&table.samples).for_each(|(sum, share)| *sum += share / count);
        }
        self.whole = Table::new(samples);
        self.whole.settle_in(noise);
        self.blend();
    }

    /// The four nodes around a place with their shares in it.
    fn corners(&self, place: [f64; 2]) -> [(usize, f64); 4] {
        let along = |axis: usize| {
            let last = self.nodes[axis] - 1;
            let at = ((place[axis] + 0.5) / self.size_px[axis]).clamp(0.0, 1.0) * last as f64;
            let first = (at as usize).min(last.saturating_sub(1));
            (first, (first + 1).min(last), at - first as f64)
        };
        let ((left, right, x), (top, bottom, y)) = (along(0), along(1));
        let node = |column: usize, row: usize| row * self.nodes[0] + column;
        [
            (node(left, top), (1.0 - x) * (1.0 - y)),
            (node(right, top), x * (1.0 - y)),
            (node(left, bottom), (1.0 - x) * y),
            (node(right, bottom), x * y),
        ]
    }

    fn become_whole(&mut self, whole: Table) {
        self.of_nodes.fill(whole.clone());
        self.of_zones = vec![whole.clone()];
        (self.zones, self.whole) = ([1, 1], whole);
    }

    /// Tables of zones finer than the nodes.
    fn blend(&mut self) {
        self.zones = self.nodes.map(|nodes| ZONES_PER_NODE * nodes);
        let mut tables = Vec::with_capacity(self.zones[0] * self.zones[1]);
        for row in 0..self.zones[1] {
            for column in 0..self.zones[0] {
                let middle = |index: usize, axis: usize| {
                    (index as f64 + 0.5) / self.zones[axis] as f64 * self.size_px[axis] - 0.5
                };
                let mut samples = vec![0.0; COUNT];
                for (node, part) in self.corners([middle(column, 0), middle(row, 1)]) {
                    let table = &self.of_nodes[node];
                    samples.iter_mut().zip(&table.samples).for_each(|(sum, share)| *sum += part * share);
                }
                tables.push(Table::new(samples));
            }
        }
        self.of_zones = tables;
    }

    /// How far the mean of two fields is off, by how they differ: each is of spots that the other knows nothing of.
    pub(super) fn scatter([one, other]: &[Self; 2]) -> Scatter {
        let summit = summit(&one.whole);
        let samples = || {
            one.whole.samples.iter().zip(&other.whole.samples).map(|(one, other)| {
                let share = 0.5 * (one + other);
                (share, 0.25 * (one - other) * (one - other) / (share * share))
            })
        };
        let from = |least: f64, most: f64| {
            samples().filter(move |(share, _)| (least * summit..most * summit).contains(share))
        };
        let (squares, light) = from(FAINT, f64::INFINITY)
            .fold((0.0, 0.0), |(squares, light), (share, square)| (squares + share * square, light + share));
        let (even, unknown_below) = even_and_below(&from(FAINTEST_WING, WINGS).collect::<Vec<_>>());
        Scatter {
            all: f64::sqrt(squares / f64::max(light, f64::MIN_POSITIVE)),
            wings: even.sqrt(),
            unknown_below,
        }
    }

    /// The table of the whole image.
    pub(super) fn whole(&self) -> &Table {
        &self.whole
    }

    /// What the method takes: light, of which there is nowhere less than none.
    pub(super) fn spread(&self, shape_error: f64) -> Result<SpreadField, OpticsError> {
        let is_even = self.belief.apart <= 2.0 * LEAST_APART;
        let tables = if is_even { std::slice::from_ref(&self.whole) } else { &self.of_zones };
        let spread =
            |table: &Table| PointSpread::new(table.samples.iter().map(|share| share.max(0.0)).collect());
        if let [only] = tables {
            return SpreadField::even(spread(only)?, shape_error);
        }
        let [width_px, height_px] = self.size_px;
        let zones = tables.iter().map(spread).collect::<Result<_, _>>()?;
        SpreadField::new(zones, self.zones[0], width_px, height_px, shape_error)
    }
}

/// How far a table is off: the error of a sample over its share of the light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scatter {
    /// Of all light.
    pub(super) all: f64,
    /// Of the wings, the part of it that is as large for all of them.
    pub(super) wings: f64,
    /// The share of the light at which the other part alone is as large as the light, where light tells samples as counts tell a rate.
    pub(super) unknown_below: f64,
}

/// By shares of the light and squared errors of samples, which are even + below / share, what is even and what below is: weighted least squares, a square being as
/// unsure as it is large.
fn even_and_below(samples: &[(f64, f64)]) -> (f64, f64) {
    let (mut even, mut below) = (0.0, 1.0);
    for _ in 0..ROUNDS_OF_SCATTER {
        let [mut ones, mut inverses, mut both, mut squares, mut squares_by_inverse] = [0.0; 5];
        for (share, square) in samples {
            let (inverse, expected) = (1.0 / share, even + below / share);
            let weight = 1.0 / (expected * expected).max(f64::MIN_POSITIVE);
            ones += weight;
            both += weight * inverse;
            inverses += weight * inverse * inverse;
            squares += weight * square;
            squares_by_inverse += weight * inverse * square;
        }
        let determinant = ones * inverses - both * both;
        if !(determinant > 0.0 && determinant.is_finite()) {
            return (0.0, 0.0);
        }
        even = (inverses * squares - both * squares_by_inverse) / determinant;
        below = (ones * squares_by_inverse - both * squares) / determinant;
        if even < 0.0 {
            (even, below) = (0.0, squares_by_inverse / inverses);
        } else if below < 0.0 {
            (even, below) = (squares / ones, 0.0);
        }
    }
    (even, below)
}

fn summit(table: &Table) -> f64 {
    table.samples.iter().copied().fold(0.0, f64::max)
}

/// The table's profile in every direction: the cubic spline over the radius that fits the samples best.
fn round(table: &Table) -> Table {
    const KNOT_PX: f64 = 1.0 / PER_PX as f64;
    let last = radius_px(0) / KNOT_PX;
    let knots = last as usize + 4;
    // An even function of the radius: what lies before the point is what lies behind it.
    let row = |sample: usize| {
        let at = radius_px(sample) / KNOT_PX;
        let (values, _) = weights(at.fract());
        let first = at as usize;
        std::array::from_fn::<_, 4, _>(|k| ((first + k).abs_diff(1), values[k]))
    };
    let mut normal = DMatrix::<f64>::zeros(knots, knots);
    let mut right = DVector::<f64>::zeros(knots);
    for (sample, share) in table.samples.iter().enumerate() {
        for (knot, weight) in row(sample) {
            right[knot] += weight * share;
            for (other, beside) in row(sample) {
                normal[(knot, other)] += weight * beside;
            }
        }
    }
    (0..knots).for_each(|knot| normal[(knot, knot)] += 1e-6);
    let Some(profile) = normal.cholesky().map(|factor| factor.solve(&right)) else { return table.clone() };
    let value = |sample: usize| row(sample).iter().map(|&(knot, weight)| weight * profile[knot]).sum();
    Table::new((0..COUNT).map(value).collect())
}

/// How large changes of each coefficient may be, if all of it may change.
fn scale(round: &Table) -> Vec<f64> {
    let faintest = FAINTEST * summit(round);
    let of = |sample: usize| {
        let fade = (0.5 * (LEARNED_PX - radius_px(sample))).clamp(0.0, 1.0);
        // what is beside something bright may be as bright
        let widest = |dx: isize, dy: isize| {
            let beside = sample as isize + dx + dy * SIDE as isize;
            usize::try_from(beside).ok().and_then(|beside| round.samples.get(beside)).copied().unwrap_or(0.0)
        };
        let beside = [(0, 0), (2, 0), (-2, 0), (0, 2), (0, -2)].map(|(dx, dy)| widest(dx, dy));
        fade * (beside.into_iter().fold(0.0, f64::max) + faintest)
    };
    (0..COUNT).map(of).collect()
}

#[cfg(test)]
mod tests {
    use photinus::optics::Gaussian;
    use rand_distr::{Distribution as _, StandardNormal};
    use rand_pcg::rand_core::SeedableRng as _;

    use super::*;

    #[test]
    fn what_faint_samples_do_not_tell_is_told() {
        for (seed, (even, below)) in (0..).zip([(0.02, 1e-4), (0.1, 1e-3), (0.0, 3e-5), (0.03, 0.0)]) {
            let mut rng = rand_pcg::Pcg64::seed_from_u64(seed);
            let sample = |number: u32| {
                let share = 1e-3 * libm::exp(0.055 * f64::from(number % 100));
                let error: f64 = StandardNormal.sample(&mut rng);
                (share, error * error * (even * even + below / share))
            };
            let samples: Vec<(f64, f64)> = (0..4000).map(sample).collect();
            let (told_even, told) = even_and_below(&samples);
            assert!((told - below).abs() < 0.1 * below + 3e-6, "{told} not {below}");
            assert!((told_even.sqrt() - even).abs() < 0.1 * even + 0.02, "{} not {even}", told_even.sqrt());
        }
        assert_eq!(even_and_below(&[]), (0.0, 0.0), "no samples say nothing");
    }

    /// What a round table is believed to be is itself: were its profile sharper or flatter, tables would become so round by round.
    #[test]
    fn the_profile_of_a_round_table_is_that_table() {
        for core_px in [0.25, 0.4, 1.0] {
            let parts = [Gaussian { share: 0.6, sigma_px: core_px }, Gaussian { share: 0.4, sigma_px: 2.2 }];
            let table = Table::gaussians(&parts);
            // a pixel is a square: a table of a sharp lens is round but for that
            let tolerance = if core_px < 0.5 { 0.05 } else { 3e-3 };
            let (round, summit) = (round(&table), summit(&table));
            for (sample, (found, share)) in round.samples.iter().zip(&table.samples).enumerate() {
                assert!(
                    (found - share).abs() < tolerance * summit,
                    "{found} not {share} at {sample}, {core_px} px"
                );
            }
        }
    }
}
