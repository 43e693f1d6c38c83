//! Vignetting: how the light of one LED changes as it moves over the image.
//!
//! In: lights of spots along their trails. Out: the share of light that passes at each angle off the axis. How bright an LED is nobody
//! knows, and that changes as it turns and comes nearer: the logarithm of its light is taken for a random walk, from a start of which nothing
//! is known, whose steps are as long as makes the trails likeliest. What all trails share by angle is the lens's. Recordings in which
//! a camera is turned tell it well; those in which lights only come and go do not, and the sigmas say so.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use photinus::camera::{Camera, Pixel};
use photinus::optics::Vignetting;

use super::field::Field;
use super::noise::{Noise, least};
use super::spot::Spot;

/// Angles at which the share is told.
const STEP_RAD: f64 = 0.0872;
/// Second differences of the logarithm of the share from one angle to the next: how far from 0 they are is tried between these, and is first believed to
/// be the most. Slopes are believed to be within the last.
const BENT: (f64, f64) = (0.004, 0.1);
const STEEP: f64 = 1.0;
/// Most sightings that are taken together: longer trails are cut, and say as much in two parts.
const LONGEST: usize = 60;
const SHORTEST: usize = 4;
/// A sighting farther off than this many sigmas is another light.
const CLIP: f64 = 5.0;
/// Steps of the walk from one frame to the next that are tried, as a share of the light.
const STEPS: (f64, f64) = (1e-4, 0.5);
/// The share is told as far as it is known so well...
const KNOWN: f64 = 0.05;
/// ...if that is far enough, rad.
const LEAST_RAD: f64 = 0.25;
const PARTS: usize = 10;

/// One sighting of a light.
#[derive(Clone, Copy, Debug)]
struct Sighted {
    frame: f64,
    off_axis_rad: f64,
    log_light: f64,
    variance: f64,
}

/// Trails of lights and what is asked of them.
struct Trails {
    trails: Vec<Vec<Sighted>>,
    /// Angles at which the share is unknown; it is 1 on the axis.
    knots: usize,
}

/// What lights and the lens are free to do.
#[derive(Clone, Copy)]
struct Freedom {
    /// Step of the walk of a light from one frame to the next, as a share of it.
    step: f64,
    /// How far second differences of the logarithm of the share are from 0.
    bent: f64,
}

/// The share of light by angle; `None` where the recording does not tell it.
pub(super) fn learn(spots: &[Spot<'_>], field: &Field, noise: &Noise, camera: &Camera) -> Option<Vignetting> {
    let mut trails = Trails::of(spots, field, noise, camera)?;
    let mut free = Freedom { step: STEPS.0, bent: BENT.1 };
    for _ in 0..2 {
        let likeliest = |of: &dyn Fn(f64) -> Freedom, (low, high): (f64, f64), tries: usize| {
            let cost =
                |log: f64| trails.solve(of(libm::exp(log)), |_| true).map_or(f64::INFINITY, |found| found.1);
            libm::exp(least(cost, libm::log(low), libm::log(high), tries))
        };
        free.step = likeliest(&|step| Freedom { step, ..free }, STEPS, 12);
        // A lens that may bend as it pleases leaves open what passes on the axis itself, where few lights are seen.
        free.bent = likeliest(&|bent| Freedom { bent, ..free }, BENT, 8);
        let (found, _) = trails.solve(free, |_| true)?;
        trails.drop_outliers(&found, free.step);
    }
    let (found, _) = trails.solve(free, |_| true)?;
    let (formal, mut squares) = (trails.sigmas(free)?, DVector::<f64>::zeros(trails.knots));
    for part in 0..PARTS {
        let (without, _) = trails.solve(free, |number| number % PARTS != part)?;
        squares += (without - &found).map(|off| off * off);
    }
    let scattered = squares.map(|sum| (sum * (PARTS - 1) as f64 / PARTS as f64).sqrt());
    let sigma = |knot: usize| libm::exp(found[knot]) * scattered[knot].max(formal[knot]);
    let known = (0..trails.knots).take_while(|knot| sigma(*knot) < KNOWN).count();
    if (known as f64) * STEP_RAD < LEAST_RAD {
        return None;
    }
    let angles: Vec<f64> = (0..=known).map(|knot| knot as f64 * STEP_RAD).collect();
    let mut shares = vec![1.0];
    shares.extend((0..known).map(|knot| libm::exp(found[knot])));
    let mut sigmas = vec![0.0];
    sigmas.extend((0..known).map(sigma));
    Vignetting::new(&angles, &shares, &sigmas).ok()
}

impl Trails {
    /// Trails of spots that are not full and that the table explains; `None` of none.
    fn of(spots: &[Spot<'_>], field: &Field, noise: &Noise, camera: &Camera) -> Option<Self> {
        let mut sighted: Vec<(u64, Sighted)> = spots
            .iter()
            .filter(|spot| spot.is_used && spot.is_linear() && spot.light > 0.0)
            .filter_map(|spot| {
                let [u, v] = spot.place_px();
                let bearing = camera.bearing(Pixel::new(u, v))?;
                let sigma = spot.told(field.at([u, v]), noise, usize::MAX)?.light_sigma() / spot.light;
                let seen = spot.window.seen;
                let variance = sigma * sigma + 0.25 * noise.shape * noise.shape;
                let (off_axis_rad, log_light) = (bearing.off_axis_rad(), libm::log(spot.light));
                Some((seen.trail, Sighted { frame: seen.frame as f64, off_axis_rad, log_light, variance }))
            })
            .collect();
        sighted.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.frame.total_cmp(&b.1.frame)));
        let trails: Vec<Vec<Sighted>> = sighted
            .chunk_by(|a, b| a.0 == b.0)
            .flat_map(|trail| trail.chunks(LONGEST))
            .filter(|part| part.len() >= SHORTEST)
            .map(|part| part.iter().map(|(_, sighted)| *sighted).collect())
            .collect();
        let farthest = trails.iter().flatten().map(|sighted| sighted.off_axis_rad).fold(0.0, f64::max);
        let knots = (farthest / STEP_RAD).ceil() as usize;
        (trails.len() >= PARTS && knots > 0).then_some(Self { trails, knots })
    }

    /// Weights of the unknowns at an angle.
    fn row(&self, off_axis_rad: f64) -> DVector<f64> {
        let at = (off_axis_rad / STEP_RAD).min(self.knots as f64);
        let before = (at as usize).min(self.knots - 1);
        let part = at - before as f64;
        let mut row = DVector::zeros(self.knots);
        row[before] += part;
        if let Some(knot) = before.checked_sub(1) {
            row[knot] += 1.0 - part;
        }
        row
    }

    /// What is believed beforehand, as a normal matrix.
    fn believed(&self, bent: f64) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(self.knots, self.knots);
        for knot in 0..self.knots {
            // the logarithm is 0 on the axis and as steep to both sides of it
            let at = |back: usize| knot.checked_sub(back);
            let mut bend = DVector::zeros(self.knots);
            let mut slope = DVector::zeros(self.knots);
            (bend[knot], slope[knot]) = (if knot == 0 { 2.0 } else { 1.0 }, 1.0);
            if let Some(before) = at(1) {
                bend[before] -= 2.0;
                slope[before] -= 1.0;
            }
            if let Some(before) = at(2) {
                bend[before] += 1.0;
            }
            matrix += &bend * bend.transpose() / (bent * bent) + &slope * slope.transpose() / (STEEP * STEEP);
        }
        matrix
    }

    /// Inverse of the covariance of a trail's logarithms, its start taken out, and the logarithm of its determinant.
    fn weights(trail: &[Sighted], step: f64) -> Option<(DMatrix<f64>, f64)> {
        let walk = |i: usize, j: usize| step * step * (trail[i.min(j)].frame - trail[0].frame);
        let covariance = DMatrix::from_fn(trail.len(), trail.len(), |i, j| {
            walk(i, j) + if i == j { trail[i].variance } else { 0.0 }
        });
        let factor = covariance.cholesky()?;
        let log_determinant = log_determinant(&factor);
        let inverse = factor.inverse();
        let ones = DVector::from_element(trail.len(), 1.0);
        let sums = &inverse * &ones;
        let all = ones.dot(&sums);
        Some((inverse - &sums * sums.transpose() / all, log_determinant + libm::log(all)))
    }

    /// Normal matrix, right side, squares and logarithms of determinants of the trails used.
    fn normal(
        &self,
        Freedom { step, bent }: Freedom,
        is_used: impl Fn(usize) -> bool,
    ) -> Option<(DMatrix<f64>, DVector<f64>, f64)> {
        let mut matrix = self.believed(bent);
        let (mut right, mut cost) =
            (DVector::zeros(self.knots), -log_determinant(&matrix.clone().cholesky()?));
        for (_, trail) in self.trails.iter().enumerate().filter(|(number, _)| is_used(*number)) {
            let (weights, own_cost) = Self::weights(trail, step)?;
            let rows = DMatrix::from_fn(trail.len(), self.knots, |i, k| self.row(trail[i].off_axis_rad)[k]);
            let logs = DVector::from_iterator(trail.len(), trail.iter().map(|sighted| sighted.log_light));
            let weighted = rows.transpose() * &weights;
            matrix += &weighted * &rows;
            right += &weighted * &logs;
            cost += own_cost + logs.dot(&(&weights * &logs));
        }
        Some((matrix, right, cost))
    }

    /// Logarithms of the shares, and minus twice the logarithm of the likelihood.
    fn solve(&self, free: Freedom, is_used: impl Fn(usize) -> bool) -> Option<(DVector<f64>, f64)> {
        let (matrix, right, cost) = self.normal(free, is_used)?;
        let factor = matrix.cholesky()?;
        let found = factor.solve(&right);
        let cost = cost - right.dot(&found) + log_determinant(&factor);
        Some((found, cost))
    }

    fn sigmas(&self, free: Freedom) -> Option<DVector<f64>> {
        let (matrix, ..) = self.normal(free, |_| true)?;
        Some(matrix.cholesky()?.inverse().diagonal().map(f64::sqrt))
    }

    /// Cuts trails where the light jumps by more than noise and walk explain.
    fn drop_outliers(&mut self, found: &DVector<f64>, step: f64) {
        let share = |sighted: &Sighted| self.row(sighted.off_axis_rad).dot(found);
        let cut: Vec<Vec<Sighted>> = self
            .trails
            .iter()
            .flat_map(|trail| {
                trail.chunk_by(|a, b| {
                    let jump = (b.log_light - share(b)) - (a.log_light - share(a));
                    let variance = a.variance + b.variance + step * step * (b.frame - a.frame);
                    jump * jump < CLIP * CLIP * variance
                })
            })
            .filter(|part| part.len() >= SHORTEST)
            .map(<[Sighted]>::to_vec)
            .collect();
        if cut.len() >= PARTS {
            self.trails = cut;
        }
    }
}

fn log_determinant(factor: &Cholesky<f64, Dyn>) -> f64 {
    2.0 * factor.l_dirty().diagonal().iter().map(|d| libm::log(*d)).sum::<f64>()
}
