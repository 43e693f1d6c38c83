//! What a flight leaves behind: lines of truth, and lines of what each vehicle saw and decided.
//!
//! Every format here is described in docs/swarm.md. Numbers are rounded to a tenth of a millimetre: finer digits mean nothing.

use photinus_control::{Motion, Seen};
use serde::Serialize;

use crate::metrics::pair;
use crate::world::World;

/// Everybody at a frame: a line of truth.jsonl.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TruthLine {
    /// When, s.
    pub time_s: f64,
    /// How long frames are exposed, us.
    pub exposure_us: f64,
    /// Everybody.
    pub vehicles: Vec<Place>,
}

/// Where a vehicle is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Place {
    /// Which vehicle.
    pub id: usize,
    /// Where, in the world, m.
    pub position_m: [f64; 3],
    /// How fast, m/s.
    pub velocity_m_s: [f64; 3],
    /// The rotation world_from_body as x, y, z, w.
    pub orientation_xyzw: [f64; 4],
}

/// What a vehicle saw and decided at a frame: a line of its results.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Line {
    /// When, s.
    pub time_s: f64,
    /// Whom it saw, in its level frame.
    pub seen: Vec<SeenLine>,
    /// The velocity that it decided on, level frame, m/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub velocity_m_s: Option<[f64; 3]>,
    /// The acceleration that it decided on, level frame, m/s^2.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub acceleration_m_s2: Option<[f64; 3]>,
    /// The rate of its heading that it decided on, rad/s.
    pub yaw_rate_rad_s: f64,
}

/// One who was seen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SeenLine {
    /// Its number.
    pub track: u64,
    /// Who it says it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub identity: Option<u32>,
    /// Who it is: the truth, by the nearest; `null` for a phantom.
    pub is: Option<usize>,
    /// Where, m.
    pub position_m: [f64; 3],
    /// Standard deviation along the line of sight, m.
    pub distance_sigma_m: f64,
    /// Strict bounds of the distance, m; the upper one `null` where there is none.
    pub bounds_m: [Option<f64>; 2],
    /// How likely it exists.
    pub probability: f64,
    /// Since when it has not been seen, s.
    pub age_s: f64,
}

/// Everybody now.
pub fn truth(world: &World, time_s: f64) -> TruthLine {
    let place = |(id, robot): (usize, &crate::world::Robot)| Place {
        id,
        position_m: rounded(robot.state.position_m.into()),
        velocity_m_s: rounded(robot.state.velocity_m_s.into()),
        orientation_xyzw: {
            let q = robot.state.attitude.coords;
            [q.x, q.y, q.z, q.w].map(tidy)
        },
    };
    let vehicles = world.robots().iter().enumerate().map(place).collect();
    TruthLine { time_s: tidy(time_s), exposure_us: world.exposure_us(), vehicles }
}

/// What a vehicle saw and decided.
pub fn line(world: &World, vehicle: usize, time_s: f64) -> Line {
    let robot = &world.robots()[vehicle];
    let paired = pair(world, vehicle);
    let seen = |(index, seen): (usize, &Seen)| {
        let mean = seen.position_m.map_or_else(Default::default, |place| place.mean);
        let upper_m = seen.distance.bounds.max_m();
        SeenLine {
            track: seen.track,
            identity: seen.identity,
            is: paired.iter().find(|pair| pair.seen == index).map(|pair| pair.target),
            position_m: rounded(mean.into()),
            distance_sigma_m: tidy(seen.distance.estimate.map_or(0.0, |estimate| estimate.sigma_m)),
            bounds_m: [Some(tidy(seen.distance.bounds.min_m())), upper_m.is_finite().then(|| tidy(upper_m))],
            probability: tidy(seen.probability),
            age_s: tidy(seen.age_s),
        }
    };
    let (velocity_m_s, acceleration_m_s2) = match robot.setpoint.motion {
        Motion::Velocity(velocity) => (Some(rounded(velocity.into())), None),
        Motion::Acceleration(acceleration) => (None, Some(rounded(acceleration.into()))),
    };
    Line {
        time_s: tidy(time_s),
        seen: robot.seen.iter().enumerate().map(seen).collect(),
        velocity_m_s,
        acceleration_m_s2,
        yaw_rate_rad_s: tidy(robot.setpoint.yaw_rate_rad_s),
    }
}

fn rounded(values: [f64; 3]) -> [f64; 3] {
    values.map(tidy)
}

fn tidy(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
