//! A flock of anonymous neighbours: not too near, not too far, the same way.
//!
//! The rules are those of C. W. Reynolds, "Flocks, Herds, and Schools", SIGGRAPH 1987, with the two margins of M. Saska, J. Vakula and
//! L. Preucil, "Swarms of micro aerial vehicles stabilized under a visual relative localization", ICRA 2014. The founding paper's
//! part V.C says which of its two distances goes with which margin: a neighbour is *too near* by l_B, the least that the pair of
//! markers allows, and *too far* by l_A, the most, so that neither test comes too late.

use nalgebra::Vector3;

use super::{likely, limited};
use crate::{Controller, OwnState, Seen, Setpoint};

/// Which distance of a neighbour is compared with a margin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RangeTest {
    /// The paper's l_B; the strict near bound where the markers form no ring.
    Inline,
    /// The paper's l_A; the strict far bound where the markers form no ring.
    Perpendicular,
    /// The mean of the estimate; the near bound where there is none.
    Estimate,
    /// The size of the largest spot, told as a distance: so large as one of `at_metre_px` pixels at 1 m that shrinks with the square of the distance.
    /// Margins then are sizes of spots, and the exposure sets how far away spots are so large (part V.C). The near bound where no size is known.
    SpotSize {
        /// Pixels of a spot at 1 m; at an exposure at which that is so, margins are metres.
        at_metre_px: f64,
    },
}

impl RangeTest {
    /// The distance, m; possibly infinite.
    pub fn distance_m(self, seen: &Seen) -> f64 {
        let distance = &seen.distance;
        match self {
            Self::Inline => distance.inline_m.unwrap_or(distance.bounds.min_m()),
            Self::Perpendicular => distance.perpendicular_m.unwrap_or(distance.bounds.max_m()),
            Self::Estimate => {
                distance.estimate.map_or(distance.bounds.min_m(), |estimate| estimate.distance_m)
            }
            Self::SpotSize { at_metre_px } => {
                seen.spot_px.map_or(distance.bounds.min_m(), |px| libm::sqrt(at_metre_px / px.max(1.0)))
            }
        }
    }
}

/// The flock's rules and their weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boids {
    /// Neighbours nearer than that are flown away from, m.
    pub near_m: f64,
    /// Neighbours further than that are flown towards, m.
    pub far_m: f64,
    /// What is compared with the near margin.
    pub near_by: RangeTest,
    /// What is compared with the far margin.
    pub far_by: RangeTest,
    /// Speed away from a neighbour at no distance, m/s.
    pub separation_m_s: f64,
    /// Speed towards a neighbour at twice the far margin or more, m/s.
    pub cohesion_m_s: f64,
    /// Share of the neighbours' mean relative velocity that is taken over, 0 to 1.
    pub alignment: f64,
    /// Where the flock goes, m/s, in axes that all share (level where there is no heading).
    pub cruise_m_s: Vector3<f64>,
    /// No faster, m/s.
    pub speed_m_s: f64,
}

impl Boids {
    /// A flock that keeps its neighbours between two distances, m, at up to 2 m/s.
    pub fn new(near_m: f64, far_m: f64) -> Self {
        Self {
            near_m,
            far_m,
            near_by: RangeTest::Inline,
            far_by: RangeTest::Perpendicular,
            separation_m_s: 4.0,
            cohesion_m_s: 2.0,
            alignment: 0.3,
            cruise_m_s: Vector3::zeros(),
            speed_m_s: 2.0,
        }
    }
}

impl Controller for Boids {
    fn command(&mut self, own: &OwnState, seen: &[Seen], _dt_s: f64) -> Setpoint {
        let (mut push, mut align, mut moving) = (Vector3::zeros(), Vector3::zeros(), 0.0);
        let mut flock = 0.0;
        for neighbour in likely(seen) {
            flock += 1.0;
            let towards = neighbour.bearing.into_inner();
            let too_near = 1.0 - self.near_by.distance_m(neighbour) / self.near_m;
            if too_near > 0.0 {
                push -= towards * (self.separation_m_s * too_near);
            }
            let too_far = (self.far_by.distance_m(neighbour) / self.far_m - 1.0).min(1.0);
            // Somebody who is too near by one test is not flown towards by the other.
            if too_far > 0.0 && too_near <= 0.0 {
                push += towards * (self.cohesion_m_s * too_far);
            }
            if let Some(velocity) = neighbour.velocity_m_s {
                align += velocity.mean;
                moving += 1.0;
            }
        }
        let cruise = super::in_level(own, &self.cruise_m_s);
        let mean = |sum: Vector3<f64>, count: f64| if count > 0.0 { sum / count } else { sum };
        // What neighbours do relative to the vehicle is added to what it does; without a velocity of its own, to the cruise.
        let own_m_s = own.velocity_m_s.map_or(cruise, |velocity| velocity.mean);
        let aligned = cruise
            + (own_m_s + mean(align, moving) - cruise) * if moving > 0.0 { self.alignment } else { 0.0 };
        Setpoint::velocity(limited(aligned + mean(push, flock), self.speed_m_s))
    }
}
