//! `safety` of a group: the layer in front of a controller, and what it may take for granted.

use nalgebra::{Rotation3, Unit, UnitQuaternion, UnitVector3, Vector3};
use photinus_control::safety::{Basis, Cone, Detection, Limits, Obstacle as Body, Safety, Shadow, Watch};
use photinus_control::{OwnState, Seen, Setpoint};
use photinus_io::Result;
use photinus_sim::occlusion::Solid;
use photinus_sim::scene::Check;
use serde::Deserialize;

use crate::scenario::{Kind, Mounted};
use crate::world::Obstacle;

/// `safety` as it stands.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SafetyTable {
    speed_m_s: f64,
    acceleration_m_s2: f64,
    braking_m_s2: f64,
    delay_s: f64,
    stray_m: f64,
    velocity_error_m_s: f64,
    unknown_speed_m_s: f64,
    empty_m: Option<f64>,
    detection: Option<DetectionTable>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
struct DetectionTable {
    range_m: f64,
    probability: f64,
    missed: f64,
    steep_deg: Option<f64>,
}

/// The safety layer of a vehicle, as the scenario has it.
#[derive(Clone, Debug, PartialEq)]
pub struct SafetyPlan {
    /// What every vehicle of the group keeps to; radius and period are the scenario's.
    pub limits: Limits,
    /// What vouches that nobody unseen is near.
    pub unseen: Unseen,
}

/// Where nobody is who is not seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unseen {
    /// The scenario vouches that nobody unseen is nearer, m.
    EmptyTo(f64),
    /// The cameras vouch for it: out to a range, with a probability per frame, and missed for good no more often than this.
    Watched {
        /// How far, m.
        range_m: f64,
        /// With what probability a frame shows a neighbour that is no farther.
        probability: f64,
        /// How often somebody may be missed for good.
        missed: f64,
        /// The scenario vouches that nobody is more steeply above or below than this, rad.
        steep_rad: Option<f64>,
    },
}

impl SafetyTable {
    /// Checks every number.
    pub(crate) fn read(&self, check: &Check<'_>, key: &str) -> Result<SafetyPlan> {
        let of = |name: &str| format!("{key}.{name}");
        let positive = |name: &str, value: f64, most: f64| check.positive(&of(name), value, most);
        let limits = Limits {
            speed_m_s: positive("speed_m_s", self.speed_m_s, 100.0)?,
            acceleration_m_s2: positive("acceleration_m_s2", self.acceleration_m_s2, 100.0)?,
            braking_m_s2: positive("braking_m_s2", self.braking_m_s2, 100.0)?,
            delay_s: check.within(&of("delay_s"), self.delay_s, (0.0, 10.0))?,
            stray_m: check.within(&of("stray_m"), self.stray_m, (0.0, 10.0))?,
            velocity_error_m_s: check.within(
                &of("velocity_error_m_s"),
                self.velocity_error_m_s,
                (0.0, 10.0),
            )?,
            unknown_speed_m_s: check.within(
                &of("unknown_speed_m_s"),
                self.unknown_speed_m_s,
                (0.0, 100.0),
            )?,
            ..Limits::small_multirotor()
        };
        limits.check().map_err(|error| check.refuse(key, error.to_string()))?;
        let unseen = match (self.empty_m, self.detection) {
            (Some(empty_m), None) => Unseen::EmptyTo(positive("empty_m", empty_m, 1e3)?),
            (None, Some(DetectionTable { range_m, probability, missed, steep_deg })) => Unseen::Watched {
                range_m: positive("detection.range_m", range_m, 1e3)?,
                probability: check.share(&of("detection.probability"), probability)?,
                missed: positive("detection.missed", missed, 0.5)?,
                steep_rad: steep_deg
                    .map(|steep_deg| positive("detection.steep_deg", steep_deg, 90.0).map(f64::to_radians))
                    .transpose()?,
            },
            _ => {
                let refused = check.refuse(key, "it does not say who answers for those who are not seen");
                return Err(refused.advise("give one of empty_m and detection"));
            }
        };
        Ok(SafetyPlan { limits, unseen })
    }
}

/// The layer in front of a controller.
#[derive(Clone, Debug)]
pub struct Guard {
    safety: Safety,
    watch: Watch,
    /// Cones that lie within the fields of the cameras, body frame; none where the scenario answers.
    eyes: Vec<Cone>,
    /// Cones that the scenario answers for, level frame.
    answered: Vec<Cone>,
    /// How near a line of sight passes the middle of what hides, for it to be hidden, m: what is opaque of an airframe, and how far cameras are from the origin.
    hides_m: f64,
    lever_m: f64,
    obstacles: Vec<Obstacle>,
    /// How long ago its last set-point was that did not brake, s.
    braking_s: f64,
    /// Where it stands, m in the world.
    stands_m: Option<Vector3<f64>>,
    /// What the last set-point rests upon.
    basis: Basis,
}

/// What the layer knows of where its vehicle is on the map: exact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OnMap {
    pub(crate) position_m: Vector3<f64>,
    pub(crate) heading_rad: f64,
}

impl Guard {
    /// The layer of a vehicle; `None` where the limits have no meaning.
    pub(crate) fn new(plan: &SafetyPlan, kind: &Kind, period_s: f64, obstacles: &[Obstacle]) -> Option<Self> {
        let limits = Limits { radius_m: kind.build.radius_m, period_s, ..plan.limits };
        let (watch, eyes, answered) = match plan.unseen {
            Unseen::EmptyTo(range_m) => (Watch::empty_to(range_m), Vec::new(), Vec::new()),
            Unseen::Watched { range_m, probability, missed, steep_rad } => {
                let detection = Detection { range_m, probability };
                let watch = Watch::new(&[detection], missed, period_s, 2.0 * limits.speed_m_s);
                let steep = steep_rad.into_iter().flat_map(steep_cones).collect();
                (watch, kind.cameras.iter().flat_map(cones).collect(), steep)
            }
        };
        let lever_m = kind
            .cameras
            .iter()
            .map(|mounted| mounted.body_from_camera.translation.vector.norm())
            .fold(0.0, f64::max);
        let opaque_m = kind.solids.iter().map(Solid::reach_m).fold(0.0, f64::max);
        Some(Self {
            safety: Safety::new(limits).ok()?,
            hides_m: opaque_m + lever_m,
            lever_m,
            watch,
            eyes,
            answered,
            obstacles: obstacles.to_vec(),
            braking_s: 0.0,
            stands_m: None,
            basis: Basis::Braking,
        })
    }

    /// What to fly instead of what is wanted.
    pub(crate) fn guard(
        &mut self,
        own: &OwnState,
        seen: &[Seen],
        on_map: &OnMap,
        wanted: &Setpoint,
        dt_s: f64,
    ) -> Setpoint {
        let turned = |cone: &Cone| Cone {
            axis: Unit::new_normalize(own.level_from_body * cone.axis.into_inner()),
            ..*cone
        };
        let level = UnitQuaternion::from_scaled_axis(Vector3::z() * -on_map.heading_rad);
        let body = |obstacle: &Obstacle| Body::Capsule {
            from: level * (obstacle.from_m - on_map.position_m),
            to: level * (obstacle.to_m - on_map.position_m),
            radius_m: obstacle.radius_m,
        };
        let bodies: Vec<Body> = self.obstacles.iter().map(body).collect();
        // what the scenario answers for does not grow old
        if !self.eyes.is_empty() {
            let eyes: Vec<Cone> = self.eyes.iter().map(turned).chain(self.answered.iter().copied()).collect();
            let limits = self.safety.limits();
            let behind_bodies =
                bodies.iter().filter_map(|body| Shadow::of_obstacle(body, self.lever_m, limits));
            let behind_others = seen.iter().map(|seen| self.behind(seen, own, dt_s));
            let hidden: Vec<Shadow> = behind_bodies.chain(behind_others).collect();
            self.watch.look(&eyes, &hidden, own.turn_rad_s() * dt_s, dt_s, 0.0);
        }
        let guarded = self.safety.guard(own, seen, &self.watch, &bodies, wanted, dt_s);
        self.basis = guarded.basis;
        self.braking_s = if guarded.basis == Basis::Braking { self.braking_s + dt_s } else { 0.0 };
        self.hold(own, on_map, &level)
            .map_or(guarded.setpoint, |hold| hold.turning(guarded.setpoint.yaw_rate_rad_s))
    }

    /// What a neighbour hides: by this frame, or by what the layer held of it where that tells more.
    fn behind(&self, seen: &Seen, own: &OwnState, dt_s: f64) -> Shadow {
        let limits = self.safety.limits();
        let now = Shadow::of_neighbour(seen, self.hides_m, limits);
        let now_from_before = Rotation3::from_axis_angle(&Vector3::z_axis(), -own.turn_rad_s() * dt_s);
        let before = self.safety.held(seen.track).map(|held| {
            let bearing = now_from_before * held.bearing;
            Shadow::of_neighbour(&Seen { bearing, age_s: held.age_s + dt_s, ..*held }, self.hides_m, limits)
        });
        before.filter(|before| before.starts_m() > now.starts_m()).unwrap_or(now)
    }

    /// Back to where it stands, once it does: a velocity that is brought to nothing by an instrument with a bias is a slow drift.
    fn hold(&mut self, own: &OwnState, on_map: &OnMap, level: &UnitQuaternion<f64>) -> Option<Setpoint> {
        let limits = self.safety.limits();
        if self.braking_s <= limits.delay_s + limits.period_s + limits.speed_m_s / limits.braking_m_s2 {
            self.stands_m = None;
            return None;
        }
        let place_m = *self.stands_m.get_or_insert(on_map.position_m);
        let velocity_m_s = own.velocity_m_s.map_or_else(Vector3::zeros, |velocity| velocity.mean);
        let back = level * (place_m - on_map.position_m) * HOLD_1_S2 - velocity_m_s * HOLD_1_S;
        Some(Setpoint::acceleration(back.cap_magnitude(limits.braking_m_s2)))
    }

    /// What every vehicle of the group keeps to.
    pub fn limits(&self) -> &Limits {
        self.safety.limits()
    }

    /// What the last set-point rests upon.
    pub fn basis(&self) -> Basis {
        self.basis
    }

    /// How far it takes it for known that nobody is in a direction of the level frame who is not seen, m.
    pub fn empty_m(&self, direction: &UnitVector3<f64>) -> f64 {
        self.watch.empty_m(direction)
    }

    /// What it holds of a track that it sees, or takes to be still there.
    pub fn held(&self, track: u64) -> Option<&Seen> {
        self.safety.held(track)
    }
}

/// Gains of the place that is held, 1/s^2, and of its velocity, 1/s: critically damped.
const HOLD_1_S2: f64 = 2.0;
const HOLD_1_S: f64 = 2.8;

/// All directions that are steeper, upwards and downwards.
fn steep_cones(steep_rad: f64) -> [Cone; 2] {
    let half_angle_rad = core::f64::consts::FRAC_PI_2 - steep_rad;
    [Vector3::z_axis(), -Vector3::z_axis()].map(|axis| Cone { axis, half_angle_rad })
}

/// Cones within the field of a camera: one about its axis, and one to either side as far as the image is wider than high. Each is as wide as all
/// directions about its axis lie in the image, by trying them degree by degree.
fn cones(mounted: &Mounted) -> Vec<Cone> {
    let body_from_camera: Rotation3<f64> = mounted.body_from_camera.rotation.into();
    let about = |yaw_rad: f64| {
        let axis = Rotation3::from_axis_angle(&Vector3::y_axis(), yaw_rad) * Vector3::z();
        let across = Rotation3::from_axis_angle(&Vector3::y_axis(), yaw_rad) * Vector3::x();
        let is_seen = |half_rad: f64| {
            (0..72).all(|step| {
                let around = Rotation3::from_axis_angle(&Unit::new_normalize(axis), f64::from(step) * 0.0873);
                let tilt = Unit::new_normalize(around * across);
                let direction = Rotation3::from_axis_angle(&tilt, half_rad) * axis;
                photinus::camera::Bearing::new(direction)
                    .is_some_and(|bearing| mounted.camera.pixel(&bearing).is_some())
            })
        };
        let degrees = (1..180).take_while(|degrees| is_seen(f64::from(*degrees).to_radians())).count();
        let axis = Unit::new_normalize(body_from_camera * axis);
        Cone { axis, half_angle_rad: (degrees as f64).to_radians() }
    };
    [-0.5, -0.25, 0.0, 0.25, 0.5].map(about).into_iter().filter(|cone| cone.half_angle_rad > 0.0).collect()
}
