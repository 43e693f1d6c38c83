//! What UVDAR's own simulator takes its sensor for: who is in view is told with that noise, ten times a second, to see what a swarm is worth that sees no better.
//!
//! The numbers are those of the public program `uvdar_multirobot_simulator`: how many markers show follows from the distance and from the side that is seen, each
//! is missed once in twenty, and the place is drawn evenly from within an ellipsoid whose semi-axes are told as standard deviations. They are drawn together with
//! three angles, so that each is off by 1/sqrt(8) of what is told on the average. One marker tells no distance: the place is told in the middle of what is in reach.
//! Velocities and strict bounds are not told there; whoever wants bounds has to take some standard deviations for them.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use photinus::locator::Distance;
use photinus::ranging::{Estimate, Interval};
use photinus_control::{Normal, Seen};

use super::perfect::exact;
use super::sight::in_view;
use super::stand_in::axes;
use super::{InView, Looking, Moment};
use crate::chance::{Chance, Use};
use crate::scenario::Scenario;

/// Time between two readings, s.
const PERIOD_S: f64 = 0.1;
/// Up to here two or three markers show, and up to here one, m.
const SEVERAL_M: f64 = 12.0;
const ONE_M: f64 = 15.0;
/// Three show where the side that is seen is between these from one of four axes, deg.
const THREE_DEG: std::ops::RangeInclusive<f64> = 20.0..=70.0;
/// A marker is missed so often.
const MISSED: f64 = 0.05;
/// Semi-axis along the line of sight over the distance, and the scatter of that, with three markers and with two.
const RANGE_OF_THREE: [f64; 2] = [0.10, 0.03];
const RANGE_OF_TWO: [f64; 2] = [0.20, 0.07];
/// Of one marker, the place and the semi-axis, m.
const RANGE_OF_ONE_M: f64 = 7.5;
/// Semi-axes across: three pixels of this many rad with three markers, m with two and with one.
const PIXEL_RAD: f64 = 0.004;
const ACROSS_OF_TWO_M: f64 = 1.5 * 0.25;
const ACROSS_OF_ONE_M: f64 = 2.0 * 0.25;
/// Standard deviations that are taken for a bound.
const BOUND_SIGMAS: f64 = 3.0;

/// Eyes with UVDAR's own noise.
#[derive(Debug)]
pub struct Uvdar {
    chance: Chance,
    has_codes: bool,
    read_s: f64,
    told: Vec<Seen>,
    views: Vec<InView>,
}

impl Uvdar {
    pub(super) fn new(scenario: &Scenario, index: usize) -> Self {
        Self {
            chance: Chance::new(scenario.seed, Use::Seeing, index as u64),
            has_codes: scenario.codes.is_some(),
            read_s: f64::NEG_INFINITY,
            told: Vec::new(),
            views: Vec::new(),
        }
    }

    pub(super) fn look(&mut self, looking: &Looking<'_>, moment: &Moment<'_>, seen: &mut Vec<Seen>) {
        let since_s = moment.time_s - self.read_s;
        // times of frames are rounded
        if since_s < PERIOD_S - 1e-6 {
            let now_from_before = looking.turned.inverse();
            self.told.iter_mut().for_each(|told| *told = turned(told, &now_from_before));
            seen.extend(self.told.iter().map(|told| Seen { age_s: since_s, ..*told }));
            return;
        }
        self.read_s = moment.time_s;
        let mut views = std::mem::take(&mut self.views);
        in_view(moment, looking.vehicle, &mut views);
        self.told.clear();
        for view in &views {
            let Some(truth) = exact(looking.vehicle, view.target, moment) else { continue };
            let read = match self.markers(looking.vehicle, view, moment) {
                0 => None,
                markers => self.read(&truth, markers),
            };
            self.told.extend(read);
        }
        self.views = views;
        seen.extend(&self.told);
    }

    /// How many markers a reading finds.
    fn markers(&mut self, observer: usize, view: &InView, moment: &Moment<'_>) -> usize {
        let [own, other] = [observer, view.target].map(|index| &moment.vehicles[index].kinematics.pose);
        let from = other.rotation.inverse() * (own.translation.vector - other.translation.vector);
        let side_deg = libm::atan2(from.y, from.x).to_degrees().rem_euclid(90.0);
        let show = match from.norm() {
            far_m if far_m > ONE_M => 0,
            far_m if far_m > SEVERAL_M => 1,
            _ if THREE_DEG.contains(&side_deg) => 3,
            _ => 2,
        };
        (0..show).filter(|_| self.chance.uniform() >= MISSED).count()
    }

    /// A reading of somebody who shows some markers.
    fn read(&mut self, truth: &Seen, markers: usize) -> Option<Seen> {
        let place_m = truth.position_m?.mean;
        let distance_m = place_m.norm();
        let share = |[usual, scatter]: [f64; 2], normal: f64| (usual + scatter * normal).max(0.01);
        let (along_m, across_m) = match markers {
            1 => (RANGE_OF_ONE_M, ACROSS_OF_ONE_M),
            2 => (share(RANGE_OF_TWO, self.chance.normal()) * distance_m, ACROSS_OF_TWO_M),
            _ => {
                let across_m = 3.0 * distance_m * libm::tan(PIXEL_RAD);
                (share(RANGE_OF_THREE, self.chance.normal()) * distance_m, across_m)
            }
        };
        let off = self.within_ball();
        let [along, left, up] = axes(&truth.bearing);
        // the middle of what is in reach is no measurement of the distance
        let range_m = if markers == 1 { RANGE_OF_ONE_M } else { distance_m + off.x * along_m };
        let drawn_m = along * range_m + (left * off.y + up * off.z) * across_m;
        let part = |axis: Vector3<f64>, sigma_m: f64| axis * axis.transpose() * (sigma_m * sigma_m);
        let covariance: Matrix3<f64> = part(along, along_m) + part(left, across_m) + part(up, across_m);
        let told_m = drawn_m.norm();
        let bounds =
            Interval::new((told_m - BOUND_SIGMAS * along_m).max(0.0), told_m + BOUND_SIGMAS * along_m)?;
        let bearing = nalgebra::Unit::try_new(drawn_m, 1e-9)?;
        Some(Seen {
            identity: truth.identity.filter(|_| self.has_codes),
            bearing,
            bearing_bound_rad: libm::atan2(BOUND_SIGMAS * across_m, told_m),
            distance: Distance {
                estimate: Some(Estimate { distance_m: told_m, sigma_m: along_m }),
                bounds,
                // one distance is told: near and far margins are held by it
                perpendicular_m: Some(told_m),
                inline_m: Some(told_m),
            },
            position_m: Some(Normal { mean: drawn_m, covariance }),
            velocity_m_s: None,
            ..*truth
        })
    }

    /// Three of the six coordinates of a point that is drawn evenly from a ball of radius 1.
    fn within_ball(&mut self) -> Vector3<f64> {
        let (three, others) = (self.chance.normals(), self.chance.normals());
        let radius = libm::pow(self.chance.uniform(), 1.0 / 6.0);
        three * (radius / libm::sqrt(three.norm_squared() + others.norm_squared()))
    }
}

/// A reading in the axes of now.
fn turned(told: &Seen, now_from_before: &UnitQuaternion<f64>) -> Seen {
    let turn = now_from_before.to_rotation_matrix();
    let normal = |normal: Normal| Normal {
        mean: turn * normal.mean,
        covariance: turn.matrix() * normal.covariance * turn.matrix().transpose(),
    };
    Seen { bearing: turn * told.bearing, position_m: told.position_m.map(normal), ..*told }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::perception::Grade;
    use crate::scenario::carried;
    use crate::{Run, Scenario};

    /// What one who hovers and sees everything is told of another who hovers at a place, reading by reading, and how many readings there were.
    fn readings(at_m: [f64; 3], seconds: f64) -> (Vec<Seen>, usize) {
        let text = carried("leader").unwrap().text;
        let text = text.replace("figure_eight = { half_m = [10.0, 4.0], period_s = 25.0 }", "hover = {}");
        let text = text.replace("follow = { distance_m = 6.0 }", "hover = {}");
        let text = text.replace("[[-6.0, 0.0, 12.0]]", &format!("[{at_m:?}]"));
        let text = text.replace("duration_s = 40.0", &format!("duration_s = {seconds:.1}\nseed = 77"));
        let run = Run::new(Scenario::parse(&text, Path::new("a.toml")).unwrap(), "a.toml", Grade::Uvdar);
        let (mut seen, mut frames) = (Vec::new(), 0);
        let flown = run.fly(1, |world| {
            frames += 1;
            seen.extend(world.robots()[0].seen.iter().filter(|seen| seen.age_s <= 0.0));
            Ok(())
        });
        flown.unwrap();
        // 30 frames a second
        (seen, frames / 3)
    }

    /// What is off along the line of sight, in semi-axes that are told.
    fn off(seen: &[Seen], true_m: f64) -> impl Iterator<Item = f64> {
        let told = seen.iter().filter_map(|seen| seen.distance.estimate);
        told.map(move |told| (told.distance_m - true_m) / told.sigma_m)
    }

    #[test]
    fn readings_are_spread_through_the_ellipsoid_that_is_told() {
        // from 45 deg aside three markers show
        let (seen, readings) = readings([4.5, 4.5, 12.0], 300.0);
        let distance_m = 4.5 * core::f64::consts::SQRT_2;
        // all three are missed once in 8000
        assert!(seen.len() + 3 >= readings, "{} of {readings}", seen.len());
        let square = off(&seen, distance_m).map(|off| off * off).sum::<f64>() / seen.len() as f64;
        assert!((8.0 * square - 1.0).abs() < 0.12, "{square}");
        assert!(off(&seen, distance_m).all(|off| off.abs() < 1.1), "an ellipsoid ends");
        let holds = |seen: &&Seen| {
            seen.distance.bounds.min_m() <= distance_m && distance_m <= seen.distance.bounds.max_m()
        };
        assert_eq!(seen.iter().filter(holds).count(), seen.len());
    }

    #[test]
    fn fewer_markers_show_farther_away_and_from_the_axes() {
        let sigma = |seen: &[Seen], true_m: f64| {
            let mut told: Vec<f64> =
                seen.iter().filter_map(|s| s.distance.estimate).map(|e| e.sigma_m / true_m).collect();
            told.sort_by(f64::total_cmp);
            told[told.len() / 2]
        };
        let (aside, ahead) = (readings([4.0, 4.0, 12.0], 60.0).0, readings([5.7, 0.0, 12.0], 60.0).0);
        let [three, two] = [sigma(&aside, 5.66), sigma(&ahead, 5.7)];
        assert!((three - 0.1).abs() < 0.02 && (two - 0.2).abs() < 0.03, "{three} {two}");
        let (one, readings_of_one) = readings([13.5, 0.0, 12.0], 60.0);
        let found = one.len() as f64 / readings_of_one as f64;
        assert!((found - 0.95).abs() < 0.03, "{found}");
        assert!(
            one.iter().filter_map(|s| s.distance.estimate).all(|told| (told.distance_m - 7.5).abs() < 0.05)
        );
        assert!(readings([16.0, 0.0, 12.0], 5.0).0.is_empty());
    }

    #[test]
    fn between_readings_the_last_one_is_told_in_the_axes_of_now() {
        let truth = crate::perception::hand_made::seen(Vector3::new(5.0, 0.0, 0.0), Matrix3::identity());
        let quarter = UnitQuaternion::from_scaled_axis(Vector3::z() * core::f64::consts::FRAC_PI_2);
        let turned = turned(&truth, &quarter);
        assert!((turned.position_m.unwrap().mean - Vector3::new(0.0, 5.0, 0.0)).norm() < 1e-12);
        assert!((turned.bearing.into_inner() - Vector3::y()).norm() < 1e-12);
    }
}
