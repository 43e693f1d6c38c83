//! Three cameras on one vehicle, which turns and accelerates, not synchronised: one set of tracks.

use nalgebra::{Matrix3, Rotation3, Vector3};
use rand_distr::{Distribution, StandardUniform};
use rand_pcg::Pcg64;

use super::simulator::*;
use crate::camera::{Mounted, Mounting, Rig};
use crate::locator::{self, Input, Located, Locator};
use crate::tracking::{Look, Moving, Placed, Settings, Track, TrackError, Tracked, Tracker, Turned};

/// Of each camera.
const CAMERA_HZ: f64 = 20.0;
/// When each shoots, s: the third 3 ms after the second.
const OFFSETS_S: [f64; 3] = [0.0, 0.017, 0.020];
const GYRO_SIGMA_RAD: f64 = 2e-4;

/// The vehicle that carries the cameras: where it is, how turned, how fast, world axes.
struct Carrier {
    position_m: Vector3<f64>,
    velocity_m_s: Vector3<f64>,
    world_from_body: Rotation3<f64>,
}

/// It yaws at 1 rad/s, nods, and swings to and fro at up to 2.4 m/s^2.
fn carrier(time_s: f64) -> Carrier {
    let (amplitude_m, rate) = (Vector3::new(0.6, 0.1, 0.3), 2.0);
    Carrier {
        position_m: amplitude_m * libm::sin(rate * time_s),
        velocity_m_s: amplitude_m * (rate * libm::cos(rate * time_s)),
        world_from_body: Rotation3::new(Vector3::new(0.0, time_s, 0.0))
            * Rotation3::new(Vector3::new(0.15 * libm::sin(1.7 * time_s), 0.0, 0.0)),
    }
}

/// Three that look all around, 0.2 m from the middle.
fn mountings() -> [Mounting; 3] {
    [0.0, 120.0, 240.0].map(|yaw_deg: f64| {
        let body_from_camera =
            Rotation3::new(Vector3::new(0.0, yaw_deg.to_radians(), 0.0)) * Rotation3::new(Vector3::x() * 0.1);
        let position_m = body_from_camera * Vector3::new(0.05, 0.0, 0.2);
        Mounting { body_from_camera, position_m, ..Mounting::default() }
    })
}

fn rig(mountings: impl IntoIterator<Item = Mounting>) -> Rig {
    let mounted = |mounting| Mounted { mounting, ..Mounted::from(camera()) };
    Rig::new(mountings.into_iter().map(mounted).collect()).unwrap()
}

/// Circles the carrier in 13 s.
fn target(time_s: f64) -> Vehicle {
    let (radius_m, phase) = (5.0, 0.48 * time_s);
    let (sine, cosine) = (libm::sin(phase), libm::cos(phase));
    let speed_m_s = 0.48 * radius_m;
    Vehicle::at(
        [radius_m * sine, -0.3, radius_m * cosine],
        [speed_m_s * cosine, 0.0, -speed_m_s * sine],
        0.3 * time_s,
    )
}

/// Where a vehicle is at a time.
type Target = fn(f64) -> Vehicle;

/// Three farther away, near each other.
fn far(time_s: f64) -> Vehicle {
    let near = target(time_s);
    Vehicle { position_m: near.position_m * 2.4, velocity_m_s: near.velocity_m_s * 2.4, ..near }
}

fn second(time_s: f64) -> Vehicle {
    let before = far(time_s - 0.25);
    Vehicle { position_m: before.position_m - Vector3::y() * 0.8, ..before }
}

fn third(time_s: f64) -> Vehicle {
    let before = second(time_s - 0.25);
    Vehicle { position_m: before.position_m - Vector3::y() * 0.8, ..before }
}

/// A frame as it is taken: which camera, when, how it is turned against the world, and what it shows.
#[derive(Clone)]
struct Shot {
    camera: usize,
    time_s: f64,
    camera_from_world: Rotation3<f64>,
    located: Located,
    shows: bool,
}

/// The frames of all cameras in the order of time; these sit as `mountings` say.
fn shots(
    mountings: &[Mounting; 3],
    offsets_s: [f64; 3],
    vehicles: &[Target],
    seconds: f64,
    seed: u128,
) -> Vec<Shot> {
    let airframe = hexarotor();
    let mut rng = Pcg64::new(seed, 31);
    let mut locators = [(); 3].map(|()| Locator::new(camera(), &airframe, None, located_by()).unwrap());
    let mut shots = Vec::new();
    for frame in 0..(3.0 * CAMERA_HZ * seconds) as usize {
        let number = frame % 3;
        let time_s = (frame / 3) as f64 / CAMERA_HZ + offsets_s[number];
        let Carrier { position_m, world_from_body, .. } = carrier(time_s);
        let mounting = &mountings[number];
        let camera_from_world = (world_from_body * mounting.body_from_camera).inverse();
        let camera_m = position_m + world_from_body * mounting.position_m;
        let from_camera = |at: &Target| {
            let vehicle = at(time_s);
            Vehicle { position_m: vehicle.position_m - camera_m, ..vehicle }
        };
        let vehicles: Vec<Vehicle> = vehicles.iter().map(from_camera).collect();
        let seen = look(&airframe, &vehicles, &camera_from_world, &mut rng);
        let spots: Vec<_> = seen.iter().map(|seen| seen.spot.clone()).collect();
        let gravity = down(&camera_from_world);
        let located = locators[number].locate(Input::spots(&spots).gravity(&gravity)).unwrap().clone();
        shots.push(Shot { camera: number, time_s, camera_from_world, located, shows: !seen.is_empty() });
    }
    shots
}

/// Hands a frame to a tracker of the rig `believed`, with its turn since the frame of `before_s`.
fn take(
    tracker: &mut Tracker,
    believed: &Mounting,
    shot: &Shot,
    before_s: Option<f64>,
    rng: &mut Pcg64,
) -> Result<Tracked, TrackError> {
    let Carrier { velocity_m_s, world_from_body, .. } = carrier(shot.time_s);
    let camera_from_body = believed.body_from_camera.inverse();
    let turned = before_s.map(|before_s| {
        let of_body = Rotation3::new(normal3(rng) * GYRO_SIGMA_RAD)
            * world_from_body.inverse()
            * carrier(before_s).world_from_body;
        let now_from_before = camera_from_body * of_body * believed.body_from_camera;
        Turned { now_from_before, sigma_rad: GYRO_SIGMA_RAD }
    });
    let velocity_m_s = camera_from_body * (world_from_body.inverse() * velocity_m_s);
    let look = Look {
        camera: shot.camera,
        time_s: shot.time_s,
        turned,
        moving: Some(Moving { velocity_m_s, sigma_m_s: 0.0 }),
        gravity: Some(down(&shot.camera_from_world)),
        located: &shot.located,
        signals: &[],
        lit: &[],
        blinking: None,
    };
    tracker.track(&look).cloned()
}

#[derive(Debug, Default)]
struct Score {
    frames: f64,
    nees: f64,
    velocity_nees: f64,
    square_per_m2: f64,
}

impl Score {
    fn add(&mut self, position: (f64, f64), velocity_nees: f64) {
        self.frames += 1.0;
        self.nees += (position.0 - self.nees) / self.frames;
        self.square_per_m2 += (position.1 - self.square_per_m2) / self.frames;
        self.velocity_nees += (velocity_nees - self.velocity_nees) / self.frames;
    }
}

/// Flies with cameras that sit as `mountings` say and are believed to sit as `believed` say: scores of the frames in which a camera has long had the vehicle
/// in view, and of those of the half second after it came into view; the tracks that there were, and in how many frames one coasted.
fn fly(mountings: &[Mounting; 3], believed: &[Mounting; 3], seed: u128) -> ([Score; 2], Vec<u64>, usize) {
    let (mut scores, mut ids, mut predicted) = (<[Score; 2]>::default(), Vec::<u64>::new(), 0);
    let mut rng = Pcg64::new(seed, 37);
    let mut tracker = Tracker::new(rig(*believed), &hexarotor(), &located_by(), Settings::default()).unwrap();
    let (mut before_s, mut in_view_since_s) = (None, [f64::INFINITY; 3]);
    for shot in shots(mountings, OFFSETS_S, &[target], 14.0, seed) {
        let tracked = take(&mut tracker, &believed[shot.camera], &shot, before_s, &mut rng).unwrap();
        before_s = Some(shot.time_s);
        assert_eq!(tracked.camera, shot.camera);
        let since_s = &mut in_view_since_s[shot.camera];
        *since_s = if shot.shows { since_s.min(shot.time_s) } else { f64::INFINITY };
        ids.extend(tracked.tracks.iter().map(|track| track.id));
        ids.sort_unstable();
        ids.dedup();
        let Some(track) = tracked.tracks.first() else {
            assert!(shot.time_s < 0.2, "no track at {} s", shot.time_s);
            continue;
        };
        predicted += usize::from(track.is_predicted);
        if shot.time_s < 1.0 {
            continue;
        }
        let Carrier { position_m, velocity_m_s, world_from_body } = carrier(shot.time_s);
        let vehicle = target(shot.time_s);
        let camera_m = position_m + world_from_body * mountings[shot.camera].position_m;
        let off_m = track.position_m - shot.camera_from_world * (vehicle.position_m - camera_m);
        let off_m_s = track.velocity_m_s - shot.camera_from_world * (vehicle.velocity_m_s - velocity_m_s);
        // Half of the distance is known four times as well.
        let far_m = (vehicle.position_m - camera_m).norm();
        let is_after = shot.time_s - in_view_since_s[shot.camera] < 0.5;
        // What another camera shows is told as far as both mountings are known.
        if shot.shows {
            scores[usize::from(is_after)].add(
                (nees(&off_m, &track.position_covariance_m2), off_m.norm_squared() / far_m.powi(4)),
                nees(&off_m_s, &track.velocity_covariance_m2_s2),
            );
        }
    }
    (scores, ids, predicted)
}

#[test]
fn who_circles_a_vehicle_with_three_cameras_keeps_one_track() {
    let (mut all, mut after) = (Score::default(), Score::default());
    for seed in 0..6 {
        let ([in_view, come], ids, predicted) = fly(&mountings(), &mountings(), 700 + seed);
        assert_eq!((ids.as_slice(), predicted), (&[0][..], 0), "seed {seed}");
        for (sum, score) in [(&mut all, &in_view), (&mut after, &come)] {
            sum.frames += score.frames;
            sum.nees += score.nees / 6.0;
            sum.velocity_nees += score.velocity_nees / 6.0;
            sum.square_per_m2 += score.square_per_m2 / 6.0;
        }
    }
    println!("in view {all:.4?}, come into view {after:.4?}");
    assert!(all.frames > 1000.0 && after.frames > 150.0);
    for score in [&all, &after] {
        assert!(score.nees < 4.0 && score.velocity_nees < 4.0, "{score:?}");
    }
    // A vehicle that comes into view shows half of its markers.
    let ratio = (after.square_per_m2 / all.square_per_m2).sqrt();
    assert!(ratio < 1.5, "the error where another camera takes over is {ratio} of that elsewhere");
}

/// The second camera sits 0.6 deg from where it is believed to sit.
#[test]
fn a_mounting_that_is_off_by_what_it_says_makes_nobody_sure() {
    let off_rad = 0.01;
    let mut truth = mountings();
    truth[1].body_from_camera =
        Rotation3::new(Vector3::new(0.3, 0.9, 0.3) * off_rad) * truth[1].body_from_camera;
    let told = mountings().map(|mounting| Mounting {
        rotation_covariance_rad2: Matrix3::from_diagonal_element(off_rad * off_rad / 2.0),
        ..mounting
    });
    let worst = |believed: &[Mounting; 3]| {
        let (scores, ids, _) = fly(&truth, believed, 720);
        println!("{scores:.3?} {ids:?}");
        (scores.iter().map(|score| score.nees).fold(0.0, f64::max), ids.len())
    };
    let (nees, tracks) = worst(&told);
    assert!(nees < 5.0 && tracks == 1, "{nees} {tracks}");
    let (_, tracks) = worst(&mountings());
    assert!(tracks > 1, "what is not said is believed: another vehicle");
}

/// Frames come up to 0.15 s late, as cameras, cables and other work have it.
#[test]
fn frames_of_several_cameras_come_in_any_order() {
    let all = shots(&mountings(), OFFSETS_S, &[target], 3.0, 730);
    let believed = mountings();
    let tracker =
        || Tracker::new(rig(mountings()), &hexarotor(), &located_by(), Settings::default()).unwrap();
    let turned_since = |taken: &[f64], time_s: f64| {
        taken.iter().copied().filter(|&before_s| before_s < time_s).reduce(f64::max)
    };
    let run = |order: &[usize]| {
        let (mut tracker, mut taken, mut late) = (tracker(), Vec::new(), 0);
        for &index in order {
            let shot = &all[index];
            let before_s = turned_since(&taken, shot.time_s);
            // Turns to the bit, so that only the order differs.
            let Carrier { world_from_body, velocity_m_s, .. } = carrier(shot.time_s);
            let camera_from_body = believed[shot.camera].body_from_camera.inverse();
            let turned = before_s.map(|before_s| Turned {
                now_from_before: camera_from_body
                    * world_from_body.inverse()
                    * carrier(before_s).world_from_body
                    * camera_from_body.inverse(),
                sigma_rad: GYRO_SIGMA_RAD,
            });
            let look = Look {
                camera: shot.camera,
                time_s: shot.time_s,
                turned,
                moving: Some(Moving {
                    velocity_m_s: camera_from_body * (world_from_body.inverse() * velocity_m_s),
                    sigma_m_s: 0.0,
                }),
                gravity: Some(down(&shot.camera_from_world)),
                located: &shot.located,
                signals: &[],
                lit: &[],
                blinking: None,
            };
            let told = tracker.track(&look).unwrap();
            assert_eq!((told.camera, told.time_s.to_bits()), (shot.camera, shot.time_s.to_bits()));
            late += usize::from(told.placed == Placed::Late);
            taken.push(shot.time_s);
        }
        (tracker.at(all.last().unwrap().time_s).unwrap().clone(), late)
    };
    let in_order: Vec<usize> = (0..all.len()).collect();
    let (expected, late) = run(&in_order);
    assert_eq!((expected.tracks.len(), late), (1, 0));
    let mut rng = Pcg64::new(731, 1);
    let mut late_s =
        || -> f64 { 0.15 * <StandardUniform as Distribution<f64>>::sample(&StandardUniform, &mut rng) };
    let mut arrival: Vec<(f64, usize)> =
        all.iter().enumerate().map(|(index, shot)| (shot.time_s + late_s(), index)).collect();
    // The first is there when the others come: nobody was followed before it.
    arrival[0].0 = -1.0;
    arrival.sort_by(|a, b| a.0.total_cmp(&b.0));
    let shuffled: Vec<usize> = arrival.into_iter().map(|(_, index)| index).collect();
    let (told, late) = run(&shuffled);
    assert!(late > all.len() / 4, "{late} late");
    let [track, expected] = [&told.tracks[0], &expected.tracks[0]];
    assert_eq!(told.tracks.len(), 1);
    assert!((track.position_m - expected.position_m).norm() < 1e-7, "{track:?} {expected:?}");
    assert!((track.velocity_m_s - expected.velocity_m_s).norm() < 1e-6);
}

/// Those in whose frames a vehicle stands at one time see the same errors of its markers, and nobody else for that.
#[test]
fn cameras_may_shoot_at_one_time_but_none_twice() {
    let all = shots(&mountings(), [0.0; 3], &[far, second, third], 10.0, 740);
    let believed = mountings();
    // By defaults, markers are off by a hand's work.
    let (settings, mut rng) = (locator::Settings::default(), Pcg64::new(1, 1));
    let mut tracker = Tracker::new(rig(believed), &hexarotor(), &settings, Settings::default()).unwrap();
    let (mut before_s, mut in_two) = (None, 0);
    for frames in all.chunks(3) {
        in_two += usize::from(frames.iter().filter(|shot| shot.shows).count() > 1);
        for shot in frames {
            let told = take(&mut tracker, &believed[shot.camera], shot, before_s, &mut rng).unwrap();
            let is_known = |track: &Track| {
                track.id < 3 && track.position_covariance_m2.iter().all(|part| part.is_finite())
            };
            assert!(told.tracks.len() < 4 && told.tracks.iter().all(is_known), "{} s: {told:?}", shot.time_s);
            let again = take(&mut tracker, &believed[shot.camera], shot, before_s, &mut rng);
            assert_eq!(again, Err(TrackError::Repeated { time_s: shot.time_s }));
            before_s = Some(shot.time_s);
        }
    }
    assert!(in_two > 50, "{in_two}");
    let stranger = Shot { camera: 3, time_s: 11.0, ..all[0].clone() };
    let refused = take(&mut tracker, &believed[0], &stranger, None, &mut rng);
    assert_eq!(refused, Err(TrackError::Camera { number: 3, of: 3 }));
}

/// A camera alone is the same wherever its body's axes point.
#[test]
fn a_camera_alone_needs_no_mounting() {
    let all: Vec<Shot> = shots(&mountings(), OFFSETS_S, &[target], 3.0, 750)
        .into_iter()
        .filter(|shot| shot.camera == 0)
        .collect();
    let turned = Mounting { position_m: Vector3::zeros(), ..mountings()[1] };
    let mut told = [Mounting::default(), turned].map(|mounting| {
        let mut tracker =
            Tracker::new(rig([mounting]), &hexarotor(), &located_by(), Settings::default()).unwrap();
        let (mut rng, mut before_s, mut last) = (Pcg64::new(2, 2), None, None);
        for shot in &all {
            // The same turns in the camera's axes, whatever is believed of the body's.
            last = Some(take(&mut tracker, &mountings()[0], shot, before_s, &mut rng).unwrap());
            before_s = Some(shot.time_s);
        }
        last.unwrap()
    });
    let [alone, mounted] = &mut told;
    assert_eq!((alone.tracks.len(), mounted.tracks.len()), (1, 1));
    assert!((alone.tracks[0].position_m - mounted.tracks[0].position_m).norm() < 1e-9);
    assert!((alone.tracks[0].velocity_m_s - mounted.tracks[0].velocity_m_s).norm() < 1e-8);
}

#[test]
fn what_is_no_rig_is_refused() {
    assert!(Rig::new(Vec::new()).is_err());
    assert!(Rig::new(vec![Mounted::from(camera()); Rig::MOST + 1]).is_err());
    let wrong = |mounting: Mounting| Rig::new(vec![Mounted { mounting, ..Mounted::from(camera()) }]).is_err();
    assert!(wrong(Mounting { position_m: Vector3::new(f64::NAN, 0.0, 0.0), ..Mounting::default() }));
    let negative = Matrix3::from_diagonal_element(-1e-6);
    assert!(wrong(Mounting { rotation_covariance_rad2: negative, ..Mounting::default() }));
    assert!(!wrong(Mounting::default()));
}
