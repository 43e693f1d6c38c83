//! A track and the neighbour of the frame that is its spots -> the track, or another one where frames contradict it.
//!
//! A sum of normal distributions forgets what was unlikely once. Two vehicles nearly in line may begin as one that is nearer; a track that settled for a wrong
//! distance then explains two spots well enough for good, for what light and missing markers tell is the same error in every frame. But each frame also tells
//! by itself how far the neighbour is, with all that the locator knows. So two explanations are weighed from frame to frame: the track is right, or it is
//! wrong, and its vehicle is wherever frames have it. Errors that frames repeat count once here, too. A track whose LEDs would be unlike all others' is weighed
//! against the one place that fits best to what was heard of it.

use alloc::vec::Vec;

use super::appearing::begun;
use super::component::Component;
use super::look::{Appearance, Calls, Moment};
use super::reduction::reduce;
use super::state::{State, Target};
use super::ways::{Scene, Ways};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::locator::LOG_RANGE;
use crate::normal;
use crate::pose::Mode;

/// A track has settled for the wrong pose so seldom, ...
pub(super) const WRONG: f64 = 1e-3;

/// How likely a track is wrong that nothing contradicted, as the logarithm of odds.
pub(super) fn beforehand() -> f64 {
    libm::log(WRONG)
}

/// Weighs the track that was concluded last against the frame's neighbour; it begins anew there once it is rather wrong.
pub(super) fn doubt(
    scene: &Scene<'_>,
    ways: &mut Ways,
    vehicle: usize,
    repeats: f64,
    straight_rad: f64,
    modes: &mut Vec<Component>,
    after: &mut State,
) {
    let moment = scene.moment;
    let Some(&target) = after.targets.last() else { return };
    let Some(appearance) = own_neighbour(moment, &target, after.members(&target)) else { return };
    let right = how_right(moment, appearance, after.components(&target));
    // What was heard of an odd track tells of all that was seen of it, not of one frame.
    let said = match appearance.as_track {
        Calls::Doubting(_) => libm::log(right / most_right(moment, appearance).max(1.0)),
        _ => libm::log(right) / repeats,
    };
    let log_wrong = (target.log_wrong - said).max(beforehand());
    let first = target.first_component;
    let place = after.targets.len() - 1;
    after.targets[place].log_wrong = log_wrong;
    if log_wrong < 0.0 {
        return;
    }
    begun(scene, ways, appearance, straight_rad, modes);
    // What was odd is not begun with again.
    let is_odd = |mode: &Component| ways.is_odd(vehicle, mode, moment.camera).unwrap_or(false);
    if modes.iter().any(|mode| !is_odd(mode)) {
        modes.retain(|mode| !is_odd(mode));
        reduce(modes, straight_rad);
    }
    if modes.is_empty() {
        return;
    }
    after.components.truncate(first);
    after.components.extend_from_slice(modes);
    after.targets[place].components = modes.len();
    after.targets[place].log_wrong = beforehand();
}

/// The neighbour that has most spots in common with a track, if that is half of the spots of both.
fn own_neighbour<'a>(moment: &'a Moment, target: &Target, own: &[usize]) -> Option<&'a Appearance> {
    let common = |appearance: &Appearance| {
        moment.members(appearance).iter().filter(|&spot| own.contains(spot)).count()
    };
    let who = moment.who(target.id, target.vehicle);
    let may_be = moment.appearances.iter().filter(|appearance| match appearance.as_track {
        Calls::Doubting(track) => track == target.id,
        _ => appearance.may_be(who),
    });
    let best = may_be.max_by_key(|appearance| common(appearance))?;
    let half = own.len().max(moment.members(best).len()).div_ceil(2).max(1);
    (common(best) >= half).then_some(best)
}

/// How much likelier the frame is if the vehicle is where it most likely is than if it were at any distance.
fn most_right(moment: &Moment, appearance: &Appearance) -> f64 {
    let at = |pose_m, covariance_m2| {
        let [at_m, _] = along(pose_m, covariance_m2);
        let density = |mode: &Mode| {
            let [far_m, var] = along(&mode.pose.position_m, &mode.position_covariance_m2);
            let sigma = var.sqrt();
            mode.weight * normal::density(libm::log(far_m / at_m) / sigma, sigma)
        };
        moment.modes(appearance).iter().map(density).sum::<f64>() * LOG_RANGE
    };
    let modes = moment.modes(appearance).iter();
    modes.map(|mode| at(&mode.pose.position_m, &mode.position_covariance_m2)).fold(0.0, f64::max)
}

/// How much likelier the frame is if the vehicle is where the track has it than if it were at any distance: the density of what the frame tells of the
/// distance, at the track's, over that of the prior.
fn how_right(moment: &Moment, appearance: &Appearance, components: &[Component]) -> f64 {
    let mut right = 0.0;
    for mode in moment.modes(appearance) {
        let [far_m, far_var] = along(&mode.pose.position_m, &mode.position_covariance_m2);
        for component in components {
            let [track_m, track_var] = along(&component.pose.position_m, &component.block(0));
            let sigma = (far_var + track_var).sqrt();
            let density = normal::density(libm::log(far_m / track_m) / sigma, sigma);
            right += mode.weight * component.weight * density * LOG_RANGE;
        }
    }
    // spots that are no neighbour say nothing of the track
    appearance.probability * right + (1.0 - appearance.probability).max(f64::EPSILON)
}

/// A distance, m, and the variance of its logarithm.
fn along(position_m: &nalgebra::Vector3<f64>, covariance_m2: &nalgebra::Matrix3<f64>) -> [f64; 2] {
    let distance_m = position_m.norm();
    let ahead = position_m / distance_m;
    [distance_m, (ahead.dot(&(covariance_m2 * ahead)) / (distance_m * distance_m)).max(f64::EPSILON)]
}

#[cfg(test)]
mod tests {
    use nalgebra::Rotation3;
    use rand_pcg::Pcg64;

    use super::*;
    use crate::camera::Mounting;
    use crate::locator::{Input, Locator};
    use crate::tracking::Look;
    use crate::tracking::tests::simulator::{Vehicle, camera, down, hexarotor, located_by, look, model};

    const AWAY_M: f64 = 8.0;

    /// A frame with one hexarotor that is as likely there as told.
    fn frame(probability: f64) -> Moment {
        let (still, airframe) = (Rotation3::identity(), hexarotor());
        let vehicle = Vehicle::at([0.0, 0.1, AWAY_M], [0.0; 3], 0.2);
        let seen = look(&airframe, &[vehicle], &still, &mut Pcg64::new(3, 5));
        let spots: Vec<_> = seen.iter().map(|seen| seen.spot.clone()).collect();
        let mut locator = Locator::new(camera(), &airframe, None, located_by()).unwrap();
        let gravity = down(&still);
        let mut located = locator.locate(Input::spots(&spots).gravity(&gravity)).unwrap().clone();
        assert!(located.neighbours.len() == 1 && located.neighbours[0].sightings.len() == 3);
        located.neighbours[0].probability = probability;
        let look = Look {
            camera: 0,
            time_s: 1.0,
            turned: None,
            moving: None,
            gravity: Some(gravity),
            located: &located,
            signals: &[],
            lit: &[],
            blinking: None,
        };
        let mut moment = Moment::default();
        moment.keep(&look, &Mounting::default(), 0);
        moment
    }

    /// What is believed of it, but for the distance.
    fn believed(scene: &Scene<'_>, ways: &mut Ways, times: f64, members: &[usize]) -> State {
        let mut state = State::empty(1.0, 1);
        let mut modes = Vec::new();
        begun(scene, ways, &scene.moment.appearances[0], 0.2, &mut modes);
        modes.iter_mut().for_each(|mode| mode.pose.position_m *= times);
        state.components.extend_from_slice(&modes);
        state.members.extend_from_slice(members);
        state.targets.push(Target {
            log_wrong: beforehand(),
            components: modes.len(),
            members: members.len(),
            ..Target::somebody(1.0)
        });
        state
    }

    /// The number of the frame after which a track begins anew, of the first thousand, at such a rate of frames.
    fn begins_anew(moment: &Moment, times: f64, members: &[usize], repeats: f64) -> Option<usize> {
        let (model, mut modes) = (model(), Vec::new());
        let (watched, interval_s) = (model.rig.watched(0), 0.1);
        let scene = Scene { model: &model, watched, moment, interval_s, own_interval_s: interval_s };
        let mut ways = Ways::with_room(&model.airframe);
        ways.begin(&scene, 0.5, &[0.0; 3], core::iter::once(None));
        let mut state = believed(&scene, &mut ways, times, members);
        let distance_m = |state: &State| state.components[0].pose.position_m.norm();
        let before_m = distance_m(&state);
        let began = (1..=1000).find(|_| {
            doubt(&scene, &mut ways, 0, repeats, 0.2, &mut modes, &mut state);
            (distance_m(&state) - before_m).abs() > 1e-9
        });
        if began.is_some() {
            assert!((distance_m(&state) / AWAY_M - 1.0).abs() < 0.05, "where the frame has it");
            assert!(state.targets.len() == 1 && state.targets[0].id == 0 && state.targets[0].components > 0);
        }
        began
    }

    #[test]
    fn a_track_that_frames_contradict_begins_anew_in_the_time_that_errors_last() {
        let moment = frame(0.9999);
        for times in [0.5, 0.7, 1.5] {
            for repeats in [10.0, 60.0] {
                let frames = begins_anew(&moment, times, &[0, 1, 2], repeats).unwrap() as f64;
                // frames that are sure to a ten-thousandth outweigh what is believed to a thousandth within one such time
                assert!((0.7..=0.8).contains(&(frames / repeats)), "{times} {repeats}: {frames}");
            }
        }
    }

    #[test]
    fn one_that_frames_agree_with_or_say_little_of_goes_on() {
        for times in [0.98, 1.0, 1.02] {
            assert_eq!(begins_anew(&frame(0.9999), times, &[0, 1, 2], 10.0), None, "{times}");
        }
        // a neighbour of other spots
        assert_eq!(begins_anew(&frame(0.9999), 0.5, &[2], 10.0), None);
        // an even chance that it is none takes long
        let frames = begins_anew(&frame(0.5), 0.5, &[0, 1, 2], 10.0).unwrap();
        assert!((95..105).contains(&frames), "{frames}");
    }
}
