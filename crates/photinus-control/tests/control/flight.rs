//! Vehicles as point masses with a delay, who see each other within bounds that hold (or lie, where a test says so).

use nalgebra::{Matrix3, Rotation3, UnitVector3, Vector3};
use photinus::locator::Distance;
use photinus::ranging::{Estimate, Interval};
use photinus_control::safety::{Basis, Cone, Detection, Limits, Obstacle, Safety, Watch};
use photinus_control::{Heading, Motion, Normal, OwnState, Seen, Setpoint};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::Rng;

pub(crate) const TICK_S: f64 = 0.005;

/// Uniform in 0 to 1.
pub(crate) fn uniform(rng: &mut Pcg64Mcg) -> f64 {
    (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

pub(crate) fn between(rng: &mut Pcg64Mcg, low: f64, high: f64) -> f64 {
    low + (high - low) * uniform(rng)
}

/// Uniform in a ball.
pub(crate) fn in_ball(rng: &mut Pcg64Mcg, radius: f64) -> Vector3<f64> {
    loop {
        let v = Vector3::from_fn(|_, _| between(rng, -1.0, 1.0));
        if v.norm() <= 1.0 {
            return v * radius;
        }
    }
}

/// How vehicles see.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sight {
    /// The near bound is down to 1 - this share of the distance, the far one up to 1 + three times it.
    pub(crate) loose: f64,
    pub(crate) bearing_bound_rad: f64,
    pub(crate) most_age_s: f64,
    /// What all distances are multiplied with: 1 for the truth.
    pub(crate) lie: f64,
    /// How often a neighbour is not seen.
    pub(crate) missed: f64,
    /// Nobody further than that is seen, and it is known that nobody unseen is nearer.
    pub(crate) range_m: f64,
    /// Whether vehicles know how often they miss each other; else they believe that they do not.
    pub(crate) honest: bool,
    /// Positions as UVDAR's own simulator makes them, their errors times a factor; else exact to a centimetre.
    pub(crate) uvdar: Option<f64>,
}

impl Sight {
    pub(crate) const GOOD: Self = Self {
        loose: 0.3,
        bearing_bound_rad: 0.1,
        most_age_s: 0.05,
        lie: 1.0,
        missed: 0.0,
        range_m: 1e3,
        honest: false,
        uvdar: None,
    };
}

pub(crate) type Wish = Box<dyn FnMut(&OwnState, &[Seen], f64) -> Setpoint>;

pub(crate) struct Vehicle {
    pub(crate) p: Vector3<f64>,
    pub(crate) v: Vector3<f64>,
    pub(crate) heading: f64,
    pub(crate) wish: Wish,
    pub(crate) safety: Option<Safety>,
    /// What it does at the most, whatever it is told; more than the limits for a hostile one.
    pub(crate) top_m_s: f64,
    /// The share of commanded braking that it manages.
    pub(crate) brakes: f64,
    pub(crate) bases: [usize; 3],
    /// Where it is at a time, whatever anybody says.
    pub(crate) script: Option<Box<dyn Fn(f64) -> Vector3<f64>>>,
    /// Acceleration that is flown, m/s^2.
    pub(crate) u: Vector3<f64>,
    yaw_rate: f64,
    watch: Watch,
    pending: Vec<(u64, Vector3<f64>)>,
    stands: bool,
    phase: u64,
    past: Vec<Vector3<f64>>,
}

pub(crate) struct Flight {
    pub(crate) rng: Pcg64Mcg,
    pub(crate) limits: Limits,
    pub(crate) sight: Sight,
    pub(crate) obstacles: Vec<Obstacle>,
    pub(crate) vehicles: Vec<Vehicle>,
    pub(crate) smallest_m: f64,
    pub(crate) tick: u64,
}

impl Flight {
    pub(crate) fn new(seed: u64, limits: Limits, sight: Sight) -> Self {
        let rng = Pcg64Mcg::new(u128::from(seed) * 2 + 0x9e37_79b9_7f4a_7c15);
        Self { rng, limits, sight, obstacles: vec![], vehicles: vec![], smallest_m: f64::INFINITY, tick: 0 }
    }

    pub(crate) fn add(&mut self, p: Vector3<f64>, v: Vector3<f64>, is_guarded: bool, wish: Wish) {
        let heading = between(&mut self.rng, -3.0, 3.0);
        let phase = self.rng.next_u64() % self.period_ticks();
        let safety = is_guarded.then(|| Safety::new(self.limits).unwrap());
        let Sight { missed, range_m, .. } = self.sight;
        let watch = if self.sight.honest {
            let detection = Detection { range_m, probability: 1.0 - missed };
            Watch::new(&[detection], 1e-6, self.limits.period_s, 2.0 * self.limits.speed_m_s)
        } else {
            Watch::empty_to(range_m)
        };
        let (top_m_s, past) = (self.limits.speed_m_s, vec![p]);
        self.vehicles.push(Vehicle {
            p,
            v,
            heading,
            wish,
            safety,
            top_m_s,
            phase,
            past,
            brakes: 1.0,
            bases: [0; 3],
            script: None,
            u: Vector3::zeros(),
            yaw_rate: 0.0,
            watch,
            pending: vec![],
            stands: false,
        });
    }

    fn period_ticks(&self) -> u64 {
        (self.limits.period_s / TICK_S).round() as u64
    }

    /// Flies for a time; who acts and when is each vehicle's own affair.
    pub(crate) fn fly(&mut self, time_s: f64) {
        for _ in 0..(time_s / TICK_S) as u64 {
            for i in 0..self.vehicles.len() {
                if (self.tick + self.vehicles[i].phase).is_multiple_of(self.period_ticks()) {
                    self.act(i);
                }
            }
            self.tick += 1;
            let (tick, limits) = (self.tick, self.limits);
            self.vehicles.iter_mut().for_each(|vehicle| vehicle.move_on(tick, &limits));
            for i in 0..self.vehicles.len() {
                for j in 0..i {
                    let apart = (self.vehicles[i].p - self.vehicles[j].p).norm();
                    self.smallest_m = self.smallest_m.min(apart);
                }
            }
        }
    }

    fn act(&mut self, i: usize) {
        let seen: Vec<Seen> =
            (0..self.vehicles.len()).filter(|j| *j != i).filter_map(|j| self.see(i, j)).collect();
        let error = in_ball(&mut self.rng, self.limits.velocity_error_m_s);
        let tick = self.tick;
        let vehicle = &mut self.vehicles[i];
        let level_from_world = Rotation3::from_axis_angle(&Vector3::z_axis(), -vehicle.heading);
        let own = OwnState {
            velocity_m_s: Some(Normal::exactly(level_from_world * vehicle.v + error)),
            heading: Some(Heading { angle_rad: vehicle.heading, sigma_rad: 0.0 }),
            rates_rad_s: Vector3::z() * vehicle.yaw_rate,
            ..OwnState::resting()
        };
        let period_s = self.limits.period_s;
        if self.sight.honest {
            let all = Cone { axis: Vector3::x_axis(), half_angle_rad: 4.0 };
            vehicle.watch.look(&[all], &[], vehicle.yaw_rate * period_s, period_s, 0.0);
        }
        let wanted = (vehicle.wish)(&own, &seen, period_s);
        let placed: Vec<Obstacle> =
            self.obstacles.iter().map(|body| moved(body, &level_from_world, &vehicle.p)).collect();
        let told = match &mut vehicle.safety {
            Some(safety) => {
                let guarded = safety.guard(&own, &seen, &vehicle.watch, &placed, &wanted, period_s);
                vehicle.bases[guarded.basis as usize] += 1;
                vehicle.stands = guarded.basis == Basis::Braking;
                guarded.setpoint
            }
            None => wanted,
        };
        vehicle.yaw_rate = told.yaw_rate_rad_s.clamp(-4.0, 4.0);
        let u = match told.motion {
            Motion::Acceleration(u) => u,
            Motion::Velocity(w) => {
                let u = (w - level_from_world * vehicle.v) * 3.0;
                u * (self.limits.acceleration_m_s2 / u.norm().max(self.limits.acceleration_m_s2))
            }
        };
        let due = tick + (self.limits.delay_s / TICK_S).round() as u64;
        vehicle.pending.push((due, level_from_world.inverse() * u));
    }

    /// What `i` sees of `j`, in the level frame of `i`.
    pub(crate) fn see(&mut self, i: usize, j: usize) -> Option<Seen> {
        let rng = &mut self.rng;
        let sight = self.sight;
        let apart = (self.vehicles[i].p - self.vehicles[j].p).norm();
        if uniform(rng) < sight.missed || apart > sight.range_m {
            return None;
        }
        let age_ticks = (uniform(rng) * sight.most_age_s / TICK_S) as usize;
        let past = |k: usize| {
            let past = &self.vehicles[k].past;
            past[past.len() - 1 - age_ticks.min(past.len() - 1)]
        };
        let level_from_world = Rotation3::from_axis_angle(&Vector3::z_axis(), -self.vehicles[i].heading);
        let offset = level_from_world * (past(j) - past(i));
        let range = offset.norm() * sight.lie;
        let near = range * (1.0 - sight.loose * uniform(rng));
        let far = range * (1.0 + 3.0 * sight.loose * uniform(rng));
        let axis = UnitVector3::new_normalize(offset.cross(&in_ball(rng, 1.0)));
        let turn = Rotation3::from_axis_angle(&axis, sight.bearing_bound_rad * uniform(rng));
        let bounds = Interval::new(near, far).unwrap();
        let exact = || Normal { mean: offset, covariance: Matrix3::identity() * 1e-4 };
        let position = sight.uvdar.map(|factor| uvdar(rng, &offset, factor)).unwrap_or_else(exact);
        Some(Seen {
            track: j as u64,
            identity: Some(j as u32),
            bearing: UnitVector3::new_normalize(turn * offset),
            bearing_bound_rad: sight.bearing_bound_rad,
            distance: Distance {
                estimate: Some(Estimate { distance_m: range, sigma_m: 0.1 * range }),
                bounds,
                perpendicular_m: Some(far),
                inline_m: Some(near),
            },
            position_m: Some(position),
            // UVDAR tells no velocities.
            velocity_m_s: sight
                .uvdar
                .is_none()
                .then(|| Normal::exactly(level_from_world * (self.vehicles[j].v - self.vehicles[i].v))),
            heading: None,
            probability: 1.0,
            spot_px: None,
            age_s: age_ticks as f64 * TICK_S,
        })
    }
}

impl Vehicle {
    fn move_on(&mut self, tick: u64, limits: &Limits) {
        while let Some(&(due, u)) = self.pending.first()
            && due < tick
        {
            self.u = u;
            self.pending.remove(0);
        }
        let slows = self.u.dot(&self.v) < 0.0;
        let u = if slows { self.u * self.brakes } else { self.u };
        let next = self.v + u * TICK_S;
        // A vehicle that is told to brake and hardly moves holds its place.
        let next =
            if self.stands && next.norm() < 2.0 * limits.velocity_error_m_s { next * 0.0 } else { next };
        let next = if next.norm() > self.top_m_s { next * (self.top_m_s / next.norm()) } else { next };
        match &self.script {
            Some(script) => {
                let p = script(tick as f64 * TICK_S);
                (self.v, self.p) = ((p - self.p) / TICK_S, p);
            }
            None => {
                self.p += (self.v + next) * (0.5 * TICK_S);
                self.v = next;
            }
        }
        self.heading += self.yaw_rate * TICK_S;
        self.past.push(self.p);
    }
}

/// What UVDAR's simulator makes of an offset nearer than 12 m: two or three markers by chance, uniform in an ellipsoid whose half
/// axes it gives out as standard deviations.
fn uvdar(rng: &mut Pcg64Mcg, offset: &Vector3<f64>, factor: f64) -> Normal {
    let range = offset.norm();
    let (along, across) = if uniform(rng) < 0.5 {
        (between(rng, 0.07, 0.13) * range, 3.0 * 0.004 * range)
    } else {
        (between(rng, 0.13, 0.27) * range, 1.5 * 0.25)
    };
    let axis = offset / range;
    let normal = axis.cross(&in_ball(rng, 1.0)).normalize();
    let axes = Matrix3::from_columns(&[axis, normal, axis.cross(&normal)]);
    let half = Matrix3::from_diagonal(&Vector3::new(along, across, across));
    Normal {
        mean: offset + axes * half * in_ball(rng, factor),
        covariance: axes * half * half * axes.transpose(),
    }
}

fn moved(body: &Obstacle, level_from_world: &Rotation3<f64>, origin: &Vector3<f64>) -> Obstacle {
    match body {
        Obstacle::Capsule { from, to, radius_m } => Obstacle::Capsule {
            from: level_from_world * (from - origin),
            to: level_from_world * (to - origin),
            radius_m: *radius_m,
        },
        Obstacle::Face { normal, height_m } => {
            Obstacle::Face { normal: level_from_world * normal, height_m: height_m + normal.dot(origin) }
        }
    }
}
