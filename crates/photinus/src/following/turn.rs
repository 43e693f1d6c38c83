//! The observer's own rotation since the frame before, where nothing tells it: that by which all tracks together fit the sightings best.
//!
//! In: offsets of sightings from tracks near them. Out: a small rotation with its covariance. It is the maximum of the posterior under a
//! rotation that goes on as it was, with every sighting being of any of the tracks near it or of none: least squares, weighed anew in each
//! round by who is likely whose, at first with what the rotation itself leaves open.
//!
//! Nothing tells a rotation of the observer from markers that all move as if it rotated: what rates have in common is taken for the observer's,
//! and how unsure that leaves them is told.

use alloc::vec::Vec;

use nalgebra::{Matrix2, Matrix3, Matrix3x2, Rotation3, Vector2, Vector3};

use super::Settings;
use super::motion::{Motion, Offset};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// How much of what the rotation leaves open beforehand widens the offsets, round by round.
const ROUNDS: [f64; 4] = [1.0, 0.3, 0.03, 0.0];

/// How the observer turns itself.
#[derive(Debug)]
pub(super) struct OwnTurn {
    rate_rad_s: Vector3<f64>,
    covariance_rad2_s2: Matrix3<f64>,
    /// How unsure it is what rates have in common, rad^2/s^2.
    common_rad2_s2: Matrix3<f64>,
    matches: Vec<Match>,
}

/// A sighting that may be of a track.
#[derive(Clone, Copy, Debug)]
struct Match {
    sighting: usize,
    offset: Vector2<f64>,
    /// Of the offset, without the rotation, rad^2.
    covariance_rad2: Matrix2<f64>,
    /// Derivative of the offset by the rotation, transposed.
    by_turn: Matrix3x2<f64>,
    /// How likely the track shows at all, over the density of other sightings.
    odds: f64,
    likelihood: f64,
}

impl OwnTurn {
    pub(super) fn new(settings: &Settings) -> Self {
        let mut own = Self {
            rate_rad_s: Vector3::zeros(),
            covariance_rad2_s2: Matrix3::zeros(),
            common_rad2_s2: Matrix3::zeros(),
            matches: Vec::new(),
        };
        own.forget(settings);
        own
    }

    /// The observer may turn in any way.
    pub(super) fn forget(&mut self, settings: &Settings) {
        self.rate_rad_s = Vector3::zeros();
        self.covariance_rad2_s2 = Matrix3::identity() * (settings.turn_rad_s * settings.turn_rad_s);
        self.common_rad2_s2 = Matrix3::zeros();
    }

    /// How unsure it is what the rates of all tracks have in common, rad^2/s^2: nothing where a gyro tells how the observer turns.
    pub(super) fn common_rad2_s2(&self) -> &Matrix3<f64> {
        &self.common_rad2_s2
    }

    /// What the rates of these have in common, rad/s, which is taken for the observer's.
    pub(super) fn take_common<'a>(
        &mut self,
        motions: impl Iterator<Item = &'a Motion> + Clone,
        settings: &Settings,
    ) -> Vector3<f64> {
        // how much rates differ: no less than with what they are known
        let (mut squares, mut count) = (0.0, 0.0);
        for motion in motions.clone() {
            squares += motion.rate_on_plane().norm_squared() + motion.covariance().rate.trace();
            count += 2.0;
        }
        let prior = settings.rate_rad_s * settings.rate_rad_s;
        let variance = (squares + prior) / (count + 1.0);
        let mut information = Matrix3::identity() * (variance / (settings.turn_rad_s * settings.turn_rad_s));
        let mut sum = Vector3::zeros();
        for motion in motions {
            let by_turn = motion.by_turn();
            information += by_turn * by_turn.transpose();
            sum += by_turn * motion.rate_on_plane();
        }
        let inverse = information.try_inverse().unwrap_or_else(Matrix3::zeros);
        self.common_rad2_s2 = inverse * variance;
        let common_rad_s = inverse * sum;
        self.rate_rad_s += common_rad_s;
        common_rad_s
    }

    /// The rotation if it went on as it was, with its covariance, rad^2; what is known of it is forgotten by and by.
    pub(super) fn expect(&mut self, passed_s: f64, settings: &Settings) -> (Rotation3<f64>, Matrix3<f64>) {
        let most = settings.turn_rad_s * settings.turn_rad_s;
        let change = settings.turn_change_rad_s2 * passed_s;
        let new = (change * change).min(most);
        let keep = 1.0 - new / most;
        self.rate_rad_s *= keep.sqrt();
        self.covariance_rad2_s2 = self.covariance_rad2_s2 * keep + Matrix3::identity() * new;
        self.matches.clear();
        (Rotation3::new(self.rate_rad_s * passed_s), self.covariance_rad2_s2 * (passed_s * passed_s))
    }

    /// Adds a sighting near a track whose place has this covariance, rad^2.
    pub(super) fn add(
        &mut self,
        sighting: usize,
        offset: &Offset,
        place_rad2: &Matrix2<f64>,
        by_turn: Matrix3x2<f64>,
        odds: f64,
    ) {
        self.matches.push(Match {
            sighting,
            offset: offset.value,
            covariance_rad2: offset.noise + place_rad2,
            by_turn,
            odds,
            likelihood: 0.0,
        });
    }

    /// The rotation that is left over what was expected, with its covariance, rad^2, which was `prior_rad2`. `claims` is room for a number
    /// per sighting.
    pub(super) fn estimate(
        &mut self,
        passed_s: f64,
        prior_rad2: &Matrix3<f64>,
        claims: &mut [f64],
    ) -> (Rotation3<f64>, Matrix3<f64>) {
        let prior = prior_rad2.try_inverse().unwrap_or_else(Matrix3::zeros);
        let (mut turn, mut covariance) = (Vector3::zeros(), *prior_rad2);
        for open in ROUNDS {
            self.weigh(&turn, &(prior_rad2 * open), claims);
            let (mut information, mut sum) = (prior, Vector3::zeros());
            for seen in &self.matches {
                let share = seen.likelihood / (1.0 + claims[seen.sighting]);
                let Some(inverse) = seen.covariance_rad2.try_inverse() else { continue };
                let weighed = seen.by_turn * inverse * share;
                information += weighed * seen.by_turn.transpose();
                sum += weighed * seen.offset;
            }
            covariance = information.try_inverse().unwrap_or(*prior_rad2);
            turn = covariance * sum;
        }
        self.rate_rad_s += turn / passed_s;
        self.covariance_rad2_s2 = covariance / (passed_s * passed_s);
        (Rotation3::new(turn), covariance)
    }

    /// How likely each match is after this rotation, and what all claim of each sighting.
    fn weigh(&mut self, turn: &Vector3<f64>, open_rad2: &Matrix3<f64>, claims: &mut [f64]) {
        claims.fill(0.0);
        for seen in &mut self.matches {
            let covariance = seen.covariance_rad2 + seen.by_turn.transpose() * open_rad2 * seen.by_turn;
            let left = seen.offset - seen.by_turn.transpose() * turn;
            seen.likelihood = seen.odds * density(&left, &covariance);
            claims[seen.sighting] += seen.likelihood;
        }
    }
}

/// The normal density, 1/rad^2.
pub(super) fn density(off: &Vector2<f64>, covariance: &Matrix2<f64>) -> f64 {
    let determinant = covariance.determinant();
    let Some(inverse) = covariance.try_inverse().filter(|_| determinant > 0.0) else { return 0.0 };
    libm::exp(-0.5 * off.dot(&(inverse * off))) / (core::f64::consts::TAU * determinant.sqrt())
}
