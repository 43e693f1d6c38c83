//! Located neighbours whose spots no vehicle claims -> new vehicles.
//!
//! A neighbour that is a vehicle's own spots, located again, is claimed and no news. The mixture of a neighbour's poses enters as it is. A vehicle that is
//! heard appears once; where its track is lost, that one begins anew where the vehicle shows. So does a track that has its markers together with another
//! vehicle's. Where one that was hidden may be what comes out, what the frame tells of a vehicle there is told of both, and one that nobody knew of comes as seldom as those
//! that are hidden are gone: a marker that comes out from behind another vehicle is the known one's rather than a stranger's.

use alloc::vec::Vec;

use nalgebra::Matrix3;

use super::component::{Component, Covariance, YAW_RATE};
use super::doubting;
use super::existence;
use super::look::{Appearance, Calls, Moment};
use super::power::Power;
use super::reduction::reduce;
use super::silent::Silent;
use super::state::{MOST_TARGETS, State, Target};
use super::step::Model;
use super::ways::{Scene, Ways};
use crate::camera::Rig;
use crate::pose::{Mode, Pose};

/// A neighbour less likely than this to be new and there is none.
const LEAST: f64 = 0.1;
/// A vehicle that was heard and shows is not dark for so long, s: a track of it that is not seen meanwhile is lost.
pub(super) const LOST_S: f64 = 0.15;

/// Adds those that appear; returns how many sightings are nobody's.
pub(super) fn appear(
    scene: &Scene<'_>,
    ways: &mut Ways,
    straight_rad: f64,
    claimed: &[f64],
    modes: &mut Vec<Component>,
    after: &mut State,
) -> f64 {
    let Scene { moment, interval_s, .. } = *scene;
    let mut unexplained: f64 = claimed.iter().map(|claimed| (1.0 - claimed).max(0.0)).sum();
    for appearance in &moment.appearances {
        let members = moment.members(appearance);
        let of_others = members.iter().map(|&spot| claimed[spot]).fold(0.0, f64::max);
        let place_of = |track: u64| after.targets.iter().position(|own| own.id == track);
        let instead = match appearance.as_track {
            Calls::New => None,
            Calls::InsteadOf(track) => place_of(track),
            Calls::Doubting(_) => continue,
        };
        let free = if instead.is_some() { 1.0 } else { (1.0 - of_others).max(0.0) };
        let is_anybody = instead.is_none() && appearance.vehicle.is_none();
        let hidden = if is_anybody { ways.hidden(members) } else { 0.0 };
        let exists = free * appearance.probability * unknown(existence::comes(interval_s), hidden);
        unexplained -= exists * members.len() as f64;
        let is_there = |own: &Target| {
            appearance.vehicle.is_some() && moment.who(own.id, own.vehicle) == appearance.vehicle
        };
        let before = instead.or_else(|| after.targets.iter().position(is_there));
        let may_begin = match before {
            Some(_) if instead.is_some() => true,
            Some(before) => !members.is_empty() && after.is_lost(&after.targets[before]),
            None => after.targets.len() < MOST_TARGETS,
        };
        if exists < LEAST || !may_begin {
            continue;
        }
        begun(scene, ways, appearance, straight_rad, modes);
        if modes.is_empty() {
            continue;
        }
        let calibration = members.iter().map(|&spot| moment.calibrations[spot]).sum::<Matrix3<f64>>();
        let (first_component, first_member) = (after.components.len(), after.members.len());
        after.components.extend_from_slice(modes);
        after.members.extend_from_slice(members);
        after.markers.resize(after.members.len(), None);
        let target = Target {
            id: before.map_or(after.next_id, |before| after.targets[before].id),
            vehicle: appearance.vehicle,
            existence: exists,
            hidden: 0.0,
            seen_s: moment.time_s,
            seen_by: moment.camera,
            seen_by_each_s: seen_by_each_s(moment),
            is_predicted: members.is_empty(),
            is_odd: false,
            calibration_rad2: calibration / members.len().max(1) as f64,
            first_component,
            components: modes.len(),
            first_member,
            members: members.len(),
            log_wrong: doubting::beforehand(),
        };
        match before {
            Some(before) => after.targets[before] = target,
            None => {
                after.targets.push(target);
                after.next_id += 1;
            }
        }
    }
    unexplained.max(0.0)
}

/// How likely who shows is one that nobody knew of, where those come so seldom and one that is known is hidden so likely: what a frame tells of the two is the same.
fn unknown(comes: f64, hidden: f64) -> f64 {
    if hidden > 0.0 { comes / (comes + hidden) } else { 1.0 }
}

/// Fills `modes` with what a neighbour tells of a vehicle of which nothing else is known.
pub(super) fn begun(
    scene: &Scene<'_>,
    ways: &mut Ways,
    appearance: &Appearance,
    straight_rad: f64,
    modes: &mut Vec<Component>,
) {
    let Scene { model, moment, .. } = *scene;
    modes.clear();
    let turns = if moment.is_turned_anyhow(appearance) { model.symmetry.turns() } else { 1 };
    for mode in moment.modes(appearance) {
        let first = modes.first().copied();
        let mut begun = begin(model, mode, first.as_ref(), turns);
        ways.first_look(scene, moment.members(appearance), &mut begun);
        modes.push(begun);
    }
    reduce(modes, straight_rad);
}

fn seen_by_each_s(moment: &Moment) -> [f64; Rig::MOST] {
    let mut seen_s = [f64::NEG_INFINITY; Rig::MOST];
    seen_s[moment.camera] = moment.time_s;
    seen_s
}

/// A mode as the beginning of a track, turned next to the `first` as far as the airframe's symmetry allows.
fn begin(model: &Model, mode: &Mode, first: Option<&Component>, turns: usize) -> Component {
    let mut covariance = Covariance::zeros();
    covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(&mode.position_covariance_m2);
    let speed = model.settings.velocity_sigma_m_s * model.settings.velocity_sigma_m_s;
    covariance.fixed_view_mut::<3, 3>(3, 3).copy_from(&Matrix3::from_diagonal_element(speed));
    covariance.fixed_view_mut::<3, 3>(6, 6).copy_from(&mode.orientation_covariance_rad2);
    covariance[(YAW_RATE, YAW_RATE)] =
        model.settings.yaw_rate_sigma_rad_s * model.settings.yaw_rate_sigma_rad_s;
    let begun = Component {
        weight: mode.weight,
        pose: mode.pose,
        velocity_m_s: nalgebra::Vector3::zeros(),
        yaw_rate_rad_s: 0.0,
        covariance,
        silent: Silent::BEFOREHAND,
        power: Power::UNKNOWN,
    };
    let turn = first.and_then(|first| turn_next_to(model, &begun.pose, &first.pose, turns));
    turn.map_or(begun, |turn| begun.turned(model.symmetry.turn(turn)))
}

/// The turn of the airframe's symmetry that brings an attitude next to another one, of the first so many.
pub(super) fn turn_next_to(model: &Model, pose: &Pose, to: &Pose, turns: usize) -> Option<usize> {
    let between = to.camera_from_body.inverse() * pose.camera_from_body;
    // The smaller an angle, the larger the trace of its matrix.
    let near = |turn: usize| (between * model.symmetry.turn(turn)).matrix().trace();
    (0..turns).rev().max_by(|a, b| near(*a).total_cmp(&near(*b)))
}
