//! What was told already and is still to be flown, and a set-point after it -> everywhere the vehicle will be until it stands.

use nalgebra::Vector3;

use super::Limits;

/// Points of the braking line; between points the path is bounded by its length.
const BRAKING_POINTS: usize = 10;
const POINTS: usize = 2 + BRAKING_POINTS;

/// A point of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Step {
    place: Vector3<f64>,
    /// An upper bound of the path's length from the point before it, m.
    length_m: f64,
    /// When it is reached, s.
    time_s: f64,
}

/// What the set-points of the last [`Limits::delay_s`] still do to a vehicle, from where it is (the origin, in its level frame).
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Underway {
    steps: Vec<Step>,
    velocity: Vector3<f64>,
    top_speed_m_s: f64,
}

impl Underway {
    /// Begins at the origin with a velocity, m/s.
    pub(super) fn begin(&mut self, velocity: Vector3<f64>) {
        self.steps.clear();
        self.steps.push(Step::default());
        self.velocity = velocity;
        self.top_speed_m_s = velocity.norm();
    }

    /// Goes on with an acceleration for a time.
    pub(super) fn accelerate(&mut self, acceleration: Vector3<f64>, time_s: f64) {
        let (step, velocity) = accelerated(&self.end(), self.velocity, acceleration, time_s);
        self.steps.push(step);
        self.velocity = velocity;
        self.top_speed_m_s = self.top_speed_m_s.max(velocity.norm());
    }

    fn end(&self) -> Step {
        self.steps.last().copied().unwrap_or_default()
    }

    /// The velocity when the next set-point is flown, m/s.
    pub(super) fn velocity(&self) -> Vector3<f64> {
        self.velocity
    }
}

/// A path that begins where the vehicle is: what is underway, the new set-point for a period, then straight braking until it stands.
/// The vehicle strays from it by [`Limits::stray_m`] at the beginning, and by more the longer what it takes for its velocity lasts.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Commitment<'a> {
    underway: &'a Underway,
    steps: [Step; POINTS],
    velocity_error_m_s: f64,
    top_speed_m_s: f64,
    reach_m: f64,
}

impl<'a> Commitment<'a> {
    /// What a vehicle commits itself to that is told to accelerate by `next`, m/s^2.
    pub(super) fn new(limits: &Limits, underway: &'a Underway, next: Vector3<f64>) -> Self {
        let mut steps = [Step::default(); POINTS];
        let half_s = 0.5 * limits.period_s;
        let (middle, velocity) = accelerated(&underway.end(), underway.velocity, next, half_s);
        let (end, left) = accelerated(&middle, velocity, next, half_s);
        (steps[0], steps[1]) = (middle, end);
        let error = limits.velocity_error_m_s;
        let share = 1.0 / BRAKING_POINTS as f64;
        let braking = left * (left.norm() / (2.0 * limits.braking_m_s2) * share);
        let braking_s = (left.norm() + error) / limits.braking_m_s2 * share;
        for k in 1..=BRAKING_POINTS {
            let (place, time_s) = (end.place + braking * k as f64, end.time_s + braking_s * k as f64);
            steps[1 + k] = Step { place, length_m: braking.norm(), time_s };
        }
        // The speed between two velocities on a straight line is largest at one of them.
        let top_speed_m_s = underway.top_speed_m_s.max(left.norm());
        let mut path =
            Self { underway, steps, velocity_error_m_s: error, top_speed_m_s, reach_m: f64::INFINITY };
        path.reach_m = -path.clear_of_m(|place| -place.norm());
        path
    }

    /// How far the path gets from where the vehicle is, at the most, m.
    pub(super) fn reach_m(&self) -> f64 {
        self.reach_m
    }

    /// The largest speed on the path, m/s.
    pub(super) fn top_speed_m_s(&self) -> f64 {
        self.top_speed_m_s
    }

    /// How far the path gets along a direction, at the most, m.
    pub(super) fn progress_m(&self, direction: &Vector3<f64>) -> f64 {
        -self.clear_of_m(|place| -place.dot(direction))
    }

    /// Whether each piece of the path leads away from `direction` by at least `beyond_rad` past a right angle.
    pub(super) fn leads_away(&self, direction: &Vector3<f64>, beyond_rad: f64) -> bool {
        let least = libm::sin(beyond_rad);
        let mut places = self.steps().map(|step| step.place);
        let mut before = places.next().unwrap_or_default();
        places.all(|place| {
            let step = place - before;
            before = place;
            -step.dot(direction) >= step.norm() * least
        })
    }

    /// A lower bound, along the path and for all that the vehicle's own velocity may be off by, of what changes by no more than the
    /// length of a way, such as the distance from anything. What is no number is taken for the worst.
    pub(super) fn clear_of_m(&self, distance_m: impl Fn(&Vector3<f64>) -> f64) -> f64 {
        let mut before = f64::INFINITY;
        let mut least = f64::INFINITY;
        for step in self.steps() {
            let here = distance_m(&step.place) - self.velocity_error_m_s * step.time_s;
            if here.is_nan() {
                return f64::NEG_INFINITY;
            }
            least = least.min(here).min(0.5 * (before + here - step.length_m));
            before = here;
        }
        least
    }

    fn steps(&self) -> impl Iterator<Item = Step> {
        self.underway.steps.iter().chain(&self.steps).copied()
    }
}

/// Where an acceleration leads in a time, with a bound of the length of the way, and the velocity then.
fn accelerated(
    from: &Step,
    velocity: Vector3<f64>,
    acceleration: Vector3<f64>,
    time_s: f64,
) -> (Step, Vector3<f64>) {
    let then = velocity + acceleration * time_s;
    let place = from.place + (velocity + then) * (0.5 * time_s);
    let length_m = velocity.norm().max(then.norm()) * time_s;
    (Step { place, length_m, time_s: from.time_s + time_s }, then)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
        [-size..size, -size..size, -size..size].prop_map(Vector3::from)
    }

    proptest! {
        /// Against the motion in steps of a tenth of a millisecond: bounds of distance and progress hold all along.
        #[test]
        fn bounds_hold_along_the_path(v in vector(2.0), before in vector(4.0), next in vector(4.0), to in vector(3.0)) {
            let limits = Limits::small_multirotor();
            let mut underway = Underway::default();
            underway.begin(v);
            underway.accelerate(before, limits.delay_s);
            let path = Commitment::new(&limits, &underway, next);
            let clear = path.clear_of_m(|x| (x - to).norm());
            let (mut p, mut v, step) = (Vector3::zeros(), v, 1e-4);
            for k in 0..100_000 {
                let t = f64::from(k) * step;
                let u = if t < limits.delay_s { before } else if t < limits.delay_s + limits.period_s { next } else {
                    if v.norm() <= limits.braking_m_s2 * step { break }
                    v * (-limits.braking_m_s2 / v.norm())
                };
                p += v * step + u * (0.5 * step * step);
                v += u * step;
                prop_assert!((p - to).norm() >= clear - 1e-2);
                prop_assert!(p.norm() <= path.reach_m() + 1e-2);
                prop_assert!(p.dot(&to) <= path.progress_m(&to.normalize()) * to.norm() + 1e-2 * to.norm());
                prop_assert!(v.norm() <= path.top_speed_m_s() + 1e-2);
            }
            // It stands where the path ends.
            prop_assert!((p - path.steps[POINTS - 1].place).norm() < 1e-2);
        }
    }
}
