//! What a flight was worth, as the field reports it: the world enters, frame by frame, and numbers leave.
//!
//! ```text
//! every step    who is how near to whom              nearness
//! every frame   how the group flies                  shape
//!               whether the safety layer's proof applied   contract (path)
//!               who saw whom, and how right          sight (pairing)
//! ```

mod contract;
mod nearness;
mod pairing;
mod path;
mod shape;
mod sight;
#[cfg(test)]
mod tests;

use serde::Serialize;

pub use contract::Contract;
pub use nearness::Collision;
pub use pairing::{Paired, pair};

use crate::world::{Touch, World};
use contract::Notary;
use nearness::Nearness;
use shape::Shape;
use sight::Sight;

/// Numbers of one flight. What could not be measured is `null` in JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Metrics {
    /// The scenario's name.
    pub scenario: String,
    /// The seed.
    pub seed: u64,
    /// How vehicles saw.
    pub perception: &'static str,
    /// How many vehicles.
    pub vehicles: usize,
    /// How long it lasted, s.
    pub duration_s: f64,
    /// How often two vehicles came nearer than their radii allow; each time counts once, however long it lasts.
    pub collisions: usize,
    /// How often a vehicle touched an obstacle.
    pub obstacle_collisions: usize,
    /// The smallest distance between the centres of two vehicles, m.
    pub smallest_distance_m: Option<f64>,
    /// The smallest distance between the balls of two vehicles, m: below 0 they collided.
    pub smallest_clearance_m: Option<f64>,
    /// The smallest distance of a vehicle's ball from an obstacle, m.
    pub smallest_obstacle_clearance_m: Option<f64>,
    /// Alignment: length of the mean direction of flight, 0 to 1, on the average over the flight.
    pub order: Option<f64>,
    /// The same over its last fifth.
    pub final_order: Option<f64>,
    /// Root of the mean square distance from the group's centre, m, on the average over the flight.
    pub extension_m: Option<f64>,
    /// The same over its last fifth.
    pub final_extension_m: Option<f64>,
    /// Standard deviation of that over the last fifth, m: how much the group breathes.
    pub extension_sigma_m: Option<f64>,
    /// Distance to the wanted formation: root of the mean square over its vehicles, after the best shift and turn about the vertical, m, over the last fifth.
    pub formation_error_m: Option<f64>,
    /// Time from which on that stays within twice its final value, s.
    pub formation_settles_s: Option<f64>,
    /// Root of the mean square velocity of its vehicles against that of the formation, m/s, over the last fifth: how much it oscillates.
    pub formation_oscillation_m_s: Option<f64>,
    /// Mean speed, m/s.
    pub mean_speed_m_s: f64,
    /// Share of frames in which the sight graph is connected: two are linked when one sees the other.
    pub connected: f64,
    /// Mean share of vehicles in the largest connected part.
    pub largest_part: f64,
    /// Of pairs where one could see the other (in a field, lit, nothing between), the share that was told.
    pub contact: Option<f64>,
    /// Mean share of time that a seeing vehicle saw somebody.
    pub contact_with_anybody: Option<f64>,
    /// Share of time in which vehicle 0 was seen by vehicle 1, of that in which it could be.
    pub contact_with_leader: Option<f64>,
    /// The longest that a seeing vehicle saw nobody, s.
    pub longest_alone_s: f64,
    /// Root of the mean square error of told positions, m.
    pub position_error_m: Option<f64>,
    /// Median of the error of told distances over the true ones.
    pub range_error: Option<f64>,
    /// Mean squared Mahalanobis distance of what was believed from the truth; 3 where covariances are honest. A mean is led by outliers.
    pub nees: Option<f64>,
    /// Its median; 2.37 where they are honest.
    pub nees_median: Option<f64>,
    /// Share within the 95 % ellipsoid.
    pub nees_within_95: Option<f64>,
    /// Reported neighbours whose bounds of the distance are of their frame.
    pub bounds: usize,
    /// Those that the truth was outside of.
    pub bounds_broken: usize,
    /// How often one who is seen got another number.
    pub identity_switches: usize,
    /// Reported neighbours with an id.
    pub named: usize,
    /// Those whose id was another's.
    pub named_wrong: usize,
    /// Share of reported neighbours that are phantoms.
    pub phantoms: Option<f64>,
    /// What the safety layer's proof assumes and how often it was not so; `null` where no vehicle has the layer.
    pub contract: Option<Contract>,
    /// The collisions.
    pub touches: Vec<Collision>,
}

/// Takes a flight's numbers.
#[derive(Debug)]
pub struct Tally {
    nearness: Nearness,
    shape: Shape,
    sight: Sight,
    notary: Option<Notary>,
}

impl Tally {
    /// For a flight that begins.
    pub fn new(world: &World) -> Self {
        let scenario = world.scenario();
        Self {
            nearness: Nearness::new(scenario),
            shape: Shape::new(scenario),
            sight: Sight::new(scenario),
            notary: Notary::new(world),
        }
    }

    /// Takes a frame, after everybody looked.
    pub fn take(&mut self, world: &World) {
        self.shape.take(world);
        self.sight.take(world);
        if let Some(notary) = &mut self.notary {
            notary.take(world);
        }
    }

    /// Takes a pair at a step of the physics.
    pub fn near(&mut self, touch: &Touch) {
        self.nearness.take(touch);
    }

    /// The numbers.
    pub fn metrics(self, world: &World) -> Metrics {
        let scenario = world.scenario();
        let Self { nearness, shape, sight, notary } = self;
        let last = shape.frames() - shape.frames() / 5;
        let (formation_error_m, formation_settles_s) = shape.formation(last, scenario.period_s());
        let shares = sight.shares(scenario);
        Metrics {
            scenario: scenario.name.clone(),
            seed: scenario.seed,
            perception: world.grade().name(),
            vehicles: scenario.vehicles.len(),
            duration_s: scenario.frames() as f64 * scenario.period_s(),
            collisions: nearness.collisions(),
            obstacle_collisions: nearness.obstacle_collisions(),
            smallest_distance_m: nearness.smallest_distance_m(),
            smallest_clearance_m: nearness.smallest_clearance_m(),
            smallest_obstacle_clearance_m: nearness.smallest_obstacle_clearance_m(),
            order: mean(&shape.order),
            final_order: mean(&shape.order[last..]),
            extension_m: mean(&shape.extension_m),
            final_extension_m: mean(&shape.extension_m[last..]),
            extension_sigma_m: sigma(&shape.extension_m[last..]),
            formation_error_m,
            formation_settles_s,
            formation_oscillation_m_s: shape.oscillation_m_s(last),
            mean_speed_m_s: mean(&shape.speed_m_s).unwrap_or(0.0),
            connected: shares.connected,
            largest_part: shares.largest_part,
            contact: shares.contact,
            contact_with_anybody: shares.with_anybody,
            contact_with_leader: shares.with_leader,
            longest_alone_s: shares.longest_alone_s,
            position_error_m: mean(&sight.square_error_m2).map(f64::sqrt),
            range_error: median(&sight.range_error),
            nees: mean(&sight.nees),
            nees_median: median(&sight.nees),
            nees_within_95: share(&sight.nees, CHI2_95),
            bounds: sight.bounds,
            bounds_broken: sight.bounds_broken,
            identity_switches: sight.switches,
            named: sight.named,
            named_wrong: sight.named_wrong,
            phantoms: (sight.told > 0).then(|| sight.phantoms as f64 / sight.told as f64),
            contract: notary.map(Notary::contract),
            touches: nearness.touches,
        }
    }
}

/// 95 % quantile of chi-square with three degrees of freedom.
const CHI2_95: f64 = 7.815;

fn mean(numbers: &[f64]) -> Option<f64> {
    (!numbers.is_empty()).then(|| numbers.iter().sum::<f64>() / numbers.len() as f64)
}

fn sigma(numbers: &[f64]) -> Option<f64> {
    let middle = mean(numbers)?;
    mean(&numbers.iter().map(|number| (number - middle) * (number - middle)).collect::<Vec<_>>())
        .map(f64::sqrt)
}

fn median(numbers: &[f64]) -> Option<f64> {
    let mut sorted = numbers.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.get(sorted.len().saturating_sub(1) / 2).copied()
}

fn share(numbers: &[f64], most: f64) -> Option<f64> {
    let within = numbers.iter().filter(|number| **number <= most).count();
    (!numbers.is_empty()).then(|| within as f64 / numbers.len() as f64)
}
