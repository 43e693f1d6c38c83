//! Bundle adjustment: LED positions and a pose per photo, by Levenberg-Marquardt. Poses are eliminated (Schur complement): what is
//! solved is as large as the airframe, however many photos there are.

use nalgebra::{DMatrix, DVector, Matrix3, Matrix6, Matrix6x3, Vector3, Vector6};

use super::{KnownDistance, LedSighting};
use crate::resection::{Known, Observation, Pose};
use crate::robust::Loss;

const PASSES: usize = 60;

/// LEDs, poses and what was seen.
#[derive(Clone, Debug)]
pub(super) struct Adjustment {
    /// Every LED of the nominal layout; those that no sighting shows stay where they are.
    pub(super) leds_m: Vec<Vector3<f64>>,
    /// A pose per photo, where it has one.
    pub(super) poses: Vec<Option<Pose>>,
    sightings: Vec<LedSighting>,
    distances: Vec<KnownDistance>,
    /// Sigma of a residual, by which distances are weighed against bearings.
    sigma: f64,
}

/// The normal equations: information and gradient of the LEDs, and of each photo's pose with what joins them.
struct Equations {
    cost: f64,
    leds: DMatrix<f64>,
    gradient: DVector<f64>,
    photos: Vec<PhotoEquations>,
}

#[derive(Clone, Default)]
struct PhotoEquations {
    information: Matrix6<f64>,
    gradient: Vector6<f64>,
    with_leds: Vec<(usize, Matrix6x3<f64>)>,
}

impl Adjustment {
    pub(super) fn new(
        leds_m: Vec<Vector3<f64>>,
        poses: Vec<Option<Pose>>,
        sightings: Vec<LedSighting>,
        distances: Vec<KnownDistance>,
    ) -> Self {
        Self { leds_m, poses, sightings, distances, sigma: 1.0 }
    }

    /// The same with fewer sightings.
    pub(super) fn with_sightings(self, all: &[LedSighting], used: &[usize]) -> Self {
        let sightings = used.iter().map(|&index| all[index]).collect();
        let sigma = self.sigma;
        Self { sigma, ..Self::new(self.leds_m, self.poses, sightings, self.distances) }
    }

    pub(super) fn sightings(&self) -> &[LedSighting] {
        &self.sightings
    }

    pub(super) fn distances(&self) -> &[KnownDistance] {
        &self.distances
    }

    /// Says what a residual's sigma is: a distance's is in metres, a bearing's only stated.
    pub(super) fn weigh_distances(&mut self, sigma: f64) {
        self.sigma = sigma;
    }

    /// Numbers of the LEDs that are seen, ascending.
    pub(super) fn placed(&self) -> Vec<usize> {
        let is_seen = |led: &usize| self.sightings.iter().any(|sighting| sighting.led == *led);
        (0..self.leds_m.len()).filter(is_seen).collect()
    }

    /// Poses of the photos that are used.
    pub(super) fn used_poses(&self) -> impl Iterator<Item = Option<&Pose>> {
        let is_used = |photo: usize| self.sightings.iter().any(|sighting| sighting.photo == photo);
        self.poses.iter().enumerate().map(move |(photo, pose)| pose.as_ref().filter(|_| is_used(photo)))
    }

    /// Length of each sighting's residual, in stated sigmas.
    pub(super) fn lengths(&self) -> Vec<f64> {
        let length = |sighting: &LedSighting| {
            let pose = self.poses[sighting.photo].as_ref()?;
            pose.residual(&self.observation(sighting)).map(|(residual, _)| residual.norm())
        };
        self.sightings.iter().map(|sighting| length(sighting).unwrap_or(f64::INFINITY)).collect()
    }

    fn observation(&self, sighting: &LedSighting) -> Observation {
        Observation { sighted: sighting.sighted, known: Known::Position(self.leds_m[sighting.led]) }
    }

    /// Goes to the least cost near by.
    pub(super) fn refine(&mut self, loss: Loss) {
        let Some(mut equations) = self.equations(loss) else { return };
        let mut damping = 1e-3;
        for _ in 0..PASSES {
            let next = equations.step(damping).map(|step| self.moved(&step));
            let after = next.as_ref().and_then(|next| next.equations(loss));
            match (next, after) {
                (Some(next), Some(after)) if after.cost < equations.cost => {
                    let gain = equations.cost - after.cost;
                    (*self, equations) = (next, after);
                    damping = f64::max(damping * 0.2, 1e-9);
                    if gain < 1e-10 * equations.cost {
                        break;
                    }
                }
                _ if damping > 1e9 => break,
                _ => damping *= 6.0,
            }
        }
    }

    /// Covariance of the LEDs that are `placed`, for residuals of sigma 1, under `constraints` on what bearings cannot tell (a
    /// row each, on x, y, z of the placed LEDs). `None` where they do not tell enough.
    pub(super) fn covariance(&self, placed: &[usize], constraints: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        let equations = self.equations(Loss::Squares)?;
        let (all, _) = equations.without_poses(0.0)?;
        let rows: Vec<usize> = placed.iter().flat_map(|led| 3 * led..3 * led + 3).collect();
        let information = all.select_rows(&rows).select_columns(&rows);
        // As stiff as the rest is at most, a thousand times over: what is left of the constraints' own variance is nothing.
        let stiff = 1e3 * information.diagonal().max();
        let inverse = (information + constraints.transpose() * constraints * stiff).cholesky()?.inverse();
        inverse.iter().all(|entry| entry.is_finite()).then_some(inverse)
    }

    fn moved(&self, (leds, photos): &(DVector<f64>, Vec<Vector6<f64>>)) -> Self {
        let mut next = self.clone();
        for (led, position_m) in next.leds_m.iter_mut().enumerate() {
            *position_m += leds.fixed_rows::<3>(3 * led);
        }
        for (pose, step) in next.poses.iter_mut().zip(photos) {
            *pose = pose.map(|pose| pose.moved(step));
        }
        next
    }

    fn equations(&self, loss: Loss) -> Option<Equations> {
        let size = 3 * self.leds_m.len();
        let photos = vec![PhotoEquations::default(); self.poses.len()];
        let mut equations =
            Equations { cost: 0.0, leds: DMatrix::zeros(size, size), gradient: DVector::zeros(size), photos };
        for sighting in &self.sightings {
            let pose = self.poses[sighting.photo].as_ref()?;
            let (residual, by_pose) = pose.residual(&self.observation(sighting))?;
            // An LED that moves one way looks as the camera does that moves the other way.
            let by_led = -by_pose.fixed_columns::<3>(3).into_owned();
            let (cost, weight) = loss.cost_and_weight(residual.norm_squared());
            let (information, gradient) = (by_led.transpose() * by_led, by_led.transpose() * residual);
            equations.add_led(cost, sighting.led, sighting.led, &(information * weight));
            equations.gradient.fixed_rows_mut::<3>(3 * sighting.led).axpy(weight, &gradient, 1.0);
            let photo = &mut equations.photos[sighting.photo];
            photo.information += by_pose.transpose() * by_pose * weight;
            photo.gradient += by_pose.transpose() * residual * weight;
            photo.with_leds.push((sighting.led, by_pose.transpose() * by_led * weight));
        }
        for distance in &self.distances {
            self.add_distance(&mut equations, distance)?;
        }
        equations.cost.is_finite().then_some(equations)
    }

    fn add_distance(&self, equations: &mut Equations, known: &KnownDistance) -> Option<()> {
        let [a, b] = known.leds;
        let apart_m = self.leds_m[a] - self.leds_m[b];
        let along = apart_m.try_normalize(0.0)?;
        let weight = (self.sigma / known.sigma_m) * (self.sigma / known.sigma_m);
        let off_m = apart_m.norm() - known.distance_m;
        let information: Matrix3<f64> = along * along.transpose() * weight;
        equations.add_led(weight * off_m * off_m, a, a, &information);
        equations.add_led(0.0, b, b, &information);
        equations.add_led(0.0, a, b, &-information);
        equations.add_led(0.0, b, a, &-information);
        equations.gradient.fixed_rows_mut::<3>(3 * a).axpy(weight * off_m, &along, 1.0);
        equations.gradient.fixed_rows_mut::<3>(3 * b).axpy(-weight * off_m, &along, 1.0);
        Some(())
    }
}

impl Equations {
    fn add_led(&mut self, cost: f64, row: usize, column: usize, information: &Matrix3<f64>) {
        self.cost += cost;
        let mut block = self.leds.fixed_view_mut::<3, 3>(3 * row, 3 * column);
        block += information;
    }

    /// Information and gradient of the LEDs alone, the poses following them.
    fn without_poses(&self, damping: f64) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let (mut leds, mut gradient) = (self.leds.clone(), self.gradient.clone());
        for photo in self.photos.iter().filter(|photo| !photo.with_leds.is_empty()) {
            let factors = photo.damped(damping).cholesky()?;
            for (led, joined) in &photo.with_leds {
                let followed = factors.solve(joined);
                let mut of_led = gradient.fixed_rows_mut::<3>(3 * led);
                of_led -= followed.transpose() * photo.gradient;
                for (other, with_other) in &photo.with_leds {
                    let mut block = leds.fixed_view_mut::<3, 3>(3 * led, 3 * other);
                    block -= followed.transpose() * with_other;
                }
            }
        }
        Some((leds, gradient))
    }

    /// The step of the LEDs and of each pose.
    fn step(&self, damping: f64) -> Option<(DVector<f64>, Vec<Vector6<f64>>)> {
        let (mut leds, gradient) = self.without_poses(damping)?;
        // Unseen LEDs, and what bearings cannot tell, stay: the least damping holds them.
        let least = 1e-9 * self.leds.diagonal().max();
        for index in 0..leds.nrows() {
            leds[(index, index)] += damping * self.leds[(index, index)] + least;
        }
        let moved = leds.cholesky()?.solve(&-gradient);
        let photos = self.photos.iter().map(|photo| {
            if photo.with_leds.is_empty() {
                return Some(Vector6::zeros());
            }
            let joined = photo.with_leds.iter().map(|(led, joined)| joined * moved.fixed_rows::<3>(3 * led));
            let gradient = photo.gradient + joined.sum::<Vector6<f64>>();
            Some(photo.damped(damping).cholesky()?.solve(&-gradient))
        });
        let photos = photos.collect::<Option<Vec<_>>>()?;
        Some((moved, photos))
    }
}

impl PhotoEquations {
    fn damped(&self, damping: f64) -> Matrix6<f64> {
        self.information + Matrix6::from_diagonal(&(self.information.diagonal() * damping))
    }
}
