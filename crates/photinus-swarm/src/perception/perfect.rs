//! What is in view, exactly: to see what perception costs.

use nalgebra::Unit;
use photinus::locator::Distance;
use photinus::ranging::{Estimate, Interval};
use photinus_control::{Normal, Seen};

use super::sight::{InView, in_view};
use super::{Looking, Moment};

/// Eyes that err in nothing.
#[derive(Debug, Default)]
pub struct Perfect {
    views: Vec<InView>,
}

impl Perfect {
    pub(super) fn look(&mut self, looking: &Looking<'_>, moment: &Moment<'_>, seen: &mut Vec<Seen>) {
        in_view(moment, looking.vehicle, &mut self.views);
        seen.extend(self.views.iter().filter_map(|view| exact(looking.vehicle, view.target, moment)));
    }
}

/// The truth about a neighbour, in the body frame of the one who looks; `None` for two at one place.
pub(super) fn exact(observer: usize, target: usize, moment: &Moment<'_>) -> Option<Seen> {
    let [own, other] = [observer, target].map(|index| &moment.vehicles[index].kinematics);
    let body_from_world = own.pose.rotation.inverse();
    let position_m = body_from_world * (other.pose.translation.vector - own.pose.translation.vector);
    let distance_m = position_m.norm();
    Some(Seen {
        track: target as u64,
        identity: Some(target as u32),
        bearing: Unit::try_new(position_m, 1e-9)?,
        bearing_bound_rad: 0.0,
        distance: Distance {
            estimate: Some(Estimate { distance_m, sigma_m: 0.0 }),
            bounds: Interval::new(distance_m, distance_m)?,
            perpendicular_m: Some(distance_m),
            inline_m: Some(distance_m),
        },
        position_m: Some(Normal::exactly(position_m)),
        velocity_m_s: Some(Normal::exactly(body_from_world * (other.velocity_m_s - own.velocity_m_s))),
        heading: None,
        probability: 1.0,
        spot_px: None,
        age_s: 0.0,
    })
}
