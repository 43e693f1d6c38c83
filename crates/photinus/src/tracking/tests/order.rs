//! Frames in any order, clocks that jump, times that mean nothing; and the same twice.

use nalgebra::Rotation3;
use rand_pcg::Pcg64;

use super::simulator::*;
use crate::locator::{Input, Located};
use crate::tracking::{Lit, Look, Placed, Settings, TrackError, Tracked, Tracker, Turned};

/// Frames of two vehicles before a camera that turns; each comes with its turn since the one before it.
fn frames() -> Vec<(f64, Turned, Located)> {
    let mut rng = Pcg64::new(7, 7);
    let mut observer = Observer::new(hexarotor(), Settings::default());
    let mut before = Rotation3::identity();
    let frame = |number: u32| {
        let time_s = f64::from(number) / RATE_HZ;
        let camera_from_world = Rotation3::new(nalgebra::Vector3::new(0.1, 0.4, 0.05) * time_s);
        let now_from_before = camera_from_world * before.inverse();
        before = camera_from_world;
        let vehicles = [
            Vehicle::at([-1.0, 0.1, 6.0], [0.8, 0.0, 0.1], 0.4).on(time_s),
            Vehicle::at([2.0, 0.1, 8.0], [-0.8, 0.0, 0.1], 1.4).on(time_s),
        ];
        let seen = look(&observer.airframe, &vehicles, &camera_from_world, &mut rng);
        let spots: Vec<_> = seen.into_iter().map(|seen| seen.spot).collect();
        let located = observer
            .locator
            .locate(Input::spots(&spots).gravity(&down(&camera_from_world)))
            .expect("spots have no size");
        (time_s, Turned { now_from_before, sigma_rad: 1e-4 }, located.clone())
    };
    (0..40).map(frame).collect()
}

fn tracker() -> Tracker {
    Tracker::new(camera(), &hexarotor(), &located_by(), Settings::default()).unwrap()
}

fn track(
    tracker: &mut Tracker,
    (time_s, turned, located): &(f64, Turned, Located),
) -> Result<Tracked, TrackError> {
    let look = Look {
        camera: 0,
        time_s: *time_s,
        turned: Some(*turned),
        moving: None,
        gravity: None,
        located,
        signals: &[],
        lit: &[],
        blinking: None,
    };
    tracker.track(&look).cloned()
}

/// Tracks one after the other.
fn in_order(frames: &[(f64, Turned, Located)]) -> Tracked {
    let mut tracker = tracker();
    frames.iter().map(|frame| track(&mut tracker, frame).unwrap()).last().unwrap()
}

#[test]
fn a_late_frame_is_the_same_as_in_order() {
    let frames = frames();
    let expected = in_order(&frames);
    assert_eq!(expected.tracks.len(), 2);
    assert_eq!(in_order(&frames), expected, "the same twice, bit for bit");
    let late = frames.len() - 10;
    let mut tracker = tracker();
    for (index, frame) in frames.iter().enumerate().filter(|(index, _)| *index != late) {
        let mut frame = frame.clone();
        if index == late + 1 {
            // Its turn is since the frame that came before it.
            frame.1.now_from_before *= frames[late].1.now_from_before;
        }
        track(&mut tracker, &frame).unwrap();
    }
    let told = track(&mut tracker, &frames[late]).unwrap();
    assert_eq!(told.placed, Placed::Late);
    // It tells its own time, as in order; and what is believed now is as in order, too.
    for (told, expected) in
        [(&told, &in_order(&frames[..=late])), (tracker.at(expected.time_s).unwrap(), &expected)]
    {
        assert_eq!((told.time_s.to_bits(), told.tracks.len()), (expected.time_s.to_bits(), 2));
        for (track, expected) in told.tracks.iter().zip(&expected.tracks) {
            assert_eq!(track.id, expected.id);
            assert!((track.position_m - expected.position_m).norm() < 1e-9);
            assert!((track.velocity_m_s - expected.velocity_m_s).norm() < 1e-8);
            assert!((track.position_covariance_m2 - expected.position_covariance_m2).norm() < 1e-10);
        }
    }
}

#[test]
fn what_is_refused_changes_nothing() {
    let frames = frames();
    let mut tracker = tracker();
    let expected = in_order(&frames);
    for frame in &frames {
        track(&mut tracker, frame).unwrap();
        let again = track(&mut tracker, frame);
        assert_eq!(again, Err(TrackError::Repeated { time_s: frame.0 }));
    }
    let newest_s = expected.time_s;
    let refused = |tracker: &mut Tracker, time_s: f64, sigma_rad: f64| {
        let mut frame = frames[3].clone();
        (frame.0, frame.1.sigma_rad) = (time_s, sigma_rad);
        track(tracker, &frame).unwrap_err()
    };
    assert!(matches!(refused(&mut tracker, newest_s - 0.6, 0.0), TrackError::TooLate { .. }));
    assert!(matches!(refused(&mut tracker, f64::NAN, 0.0), TrackError::Time(_)));
    assert!(matches!(refused(&mut tracker, newest_s + 0.1, -1.0), TrackError::Turn(_)));
    assert!(matches!(tracker.at(newest_s - 3.0), Err(TrackError::TooLate { .. })));
    assert_eq!(tracker.at(newest_s).unwrap().tracks[0].position_m, expected.tracks[0].position_m);
}

#[test]
fn a_clock_that_jumps_is_a_reset_and_ids_are_new() {
    let frames = frames();
    for jump_s in [-1e4, 1e4] {
        let mut tracker = tracker();
        for frame in &frames {
            track(&mut tracker, frame).unwrap();
        }
        let mut jumped = frames[0].clone();
        jumped.0 += jump_s;
        let told = track(&mut tracker, &jumped).unwrap();
        assert_eq!(told.placed, Placed::Reset);
        assert!(told.tracks.iter().all(|track| track.id >= 2), "{told:?}");
    }
}

#[test]
fn between_frames_a_track_carries_on_and_is_less_sure() {
    let frames = frames();
    let mut tracker = tracker();
    let newest = frames.iter().map(|frame| track(&mut tracker, frame).unwrap()).last().unwrap();
    let later = tracker.at(newest.time_s + 0.1).unwrap();
    for (track, before) in later.tracks.iter().zip(&newest.tracks) {
        let carried_m = before.position_m + before.velocity_m_s * 0.1;
        assert!((track.position_m - carried_m).norm() < 1e-6);
        let more_m2 = track.position_covariance_m2 - before.position_covariance_m2;
        assert!(more_m2.trace() > 0.0 && track.is_predicted && !before.is_predicted);
    }
}

/// One marker lit at a time: what is told to be dark is not held against a vehicle, and what is lit tells which marker it is.
#[test]
fn one_lit_marker_keeps_a_track() {
    let still = Rotation3::identity();
    let mut rng = Pcg64::new(8, 7);
    let mut observer = Observer::new(hexarotor(), Settings::default());
    // Yaw is told but for the airframe's symmetry: the track's name of each marker.
    let mut names = [0; 6];
    let (mut sum, mut worst, mut square_m2): (f64, f64, f64) = (0.0, 0.0, 0.0);
    for frame in 0..120usize {
        let time_s = frame as f64 / RATE_HZ;
        let vehicle = Vehicle::at([-1.0, 0.1, 6.0], [0.5, 0.0, 0.1], 0.4).on(time_s);
        let mut seen = look(&observer.airframe, &[vehicle], &still, &mut rng);
        let turn = (frame / 3) % 6;
        if frame >= 30 {
            seen.retain(|seen| seen.marker == turn);
        }
        let lit = |marker: usize| if frame < 30 || marker == turn { 0.99 } else { 0.01 };
        let told = [0, 1, 2, 3, 4, 5].map(|marker| Lit {
            track: 0,
            marker: names[marker],
            probability: lit(marker),
        });
        let spots: Vec<_> = seen.iter().map(|seen| seen.spot.clone()).collect();
        let look = Look {
            camera: 0,
            time_s,
            turned: Some(Turned { now_from_before: still, sigma_rad: 0.0 }),
            moving: None,
            gravity: Some(down(&still)),
            located: observer
                .locator
                .locate(Input::spots(&spots).gravity(&down(&still)))
                .expect("spots have no size"),
            signals: &[],
            lit: if frame < 30 { &[] } else { &told },
            blinking: None,
        };
        let tracked = observer.tracker.track(&look).unwrap();
        assert_eq!(tracked.tracks.iter().map(|track| track.id).collect::<Vec<_>>(), [0], "frame {frame}");
        let track = &tracked.tracks[0];
        let own = nees(&(track.position_m - vehicle.position_m), &track.position_covariance_m2);
        (sum, worst) = (sum + own / 120.0, worst.max(own));
        square_m2 += (track.position_m - vehicle.position_m).norm_squared() / 120.0;
        if frame < 30 {
            let at_m = |turned: &Rotation3<f64>, marker: usize| {
                turned * observer.airframe.markers()[marker].position_m
            };
            for (marker, name) in names.iter_mut().enumerate() {
                let off = |own: &u16| {
                    let own_m = at_m(&track.camera_from_body, usize::from(*own));
                    (own_m - at_m(&vehicle.world_from_body(), marker)).norm()
                };
                *name = (0..6).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
            }
        }
    }
    println!("one lit marker: NEES {sum:.2}, at most {worst:.1}, rms {:.3} m", square_m2.sqrt());
    assert!(sum < 4.0 && worst < 20.0 && square_m2.sqrt() < 0.5, "{sum} {worst} {square_m2}");
}
