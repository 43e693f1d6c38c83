//! Vehicles that fly and blink, seen by an ideal camera: who they are said to be, against who they are.

use nalgebra::Rotation3;
use rand_pcg::Pcg64;

use super::*;
use crate::airframe::Led;
use crate::identity::{CodeBook, Word};
use crate::locator::{Input, Locator};
use crate::tracking::tests::simulator::{self, Vehicle as Flown, camera, down, hexarotor, located_by};

const RATE_HZ: f64 = 60.0;
const EXPOSURE_S: f64 = 1e-3;
/// Bits of a word of the book.
const LENGTH: f64 = 12.0;
/// A vehicle is named from this probability on.
const SURE: f64 = 0.99;

pub(super) fn book() -> CodeBook {
    let words =
        ["001001010111", "001001101011", "000101100111", "010001110011", "001011000111", "000110101011"];
    let word = |bits: &&str| Word::new(&bits.bytes().map(|bit| bit == b'1').collect::<Vec<_>>()).unwrap();
    CodeBook::new(words.iter().map(word).collect()).unwrap()
}

/// A hexarotor whose arms carry these signals.
fn signalled(signals: [u32; 6]) -> Airframe {
    let leds = hexarotor()
        .leds()
        .iter()
        .zip(signals)
        .map(|(led, signal)| Led { signal: Some(signal), ..led.clone() })
        .collect();
    Airframe::new("signalled", leds).unwrap()
}

/// What flies: where, which words its signals blink, and when its clock began.
#[derive(Clone)]
struct Blinker {
    flown: Flown,
    words: Vec<Word>,
    phase_s: f64,
    is_hidden: bool,
    /// Markers whose LED is dead.
    dead: Vec<usize>,
}

impl Blinker {
    fn new(
        position_m: [f64; 3],
        velocity_m_s: [f64; 3],
        yaw_rad: f64,
        words: Vec<Word>,
        phase_s: f64,
    ) -> Self {
        let flown = Flown::at(position_m, velocity_m_s, yaw_rad);
        Self { flown, words, phase_s, is_hidden: false, dead: Vec::new() }
    }

    /// The same, turned so that a marker faces the camera, and with those LEDs dead that are so many places beside it.
    fn facing_with_dead(mut self, airframe: &Airframe, beside: &[usize]) -> Self {
        let shines = |own: &Self, marker: usize| {
            let camera_m = own.flown.world_from_body().inverse() * -own.flown.position_m;
            airframe.intensity(marker, &camera_m)
        };
        let turned = |degrees: i32| {
            let mut own = self.clone();
            own.flown.yaw_rad = f64::from(degrees).to_radians();
            own
        };
        let best = (0..360).max_by(|&a, &b| shines(&turned(a), 0).total_cmp(&shines(&turned(b), 0)));
        self = turned(best.unwrap());
        self.dead = beside.to_vec();
        self
    }

    fn is_lit(&self, signal: u32, time_s: f64) -> bool {
        let bit = (time_s + self.phase_s) * 60.03;
        self.words[signal as usize].bit(bit as usize)
    }
}

struct World {
    airframe: Airframe,
    locator: Locator,
    lookout: Lookout,
    frame: u32,
    rng: Pcg64,
}

impl World {
    /// Vehicles 1, 2, ... of this airframe, each with words of its own of the book, one for each signal.
    fn new(airframe: Airframe, vehicles: usize, signals: usize) -> Self {
        let vehicle =
            |of: usize| Vehicle { id: 1 + of as u32, words: (of * signals..(of + 1) * signals).collect() };
        let fleet = Fleet::new(book(), (0..vehicles).map(|of| (vehicle(of), 60.0))).unwrap();
        let settings = tracking::Settings::default();
        Self {
            locator: Locator::new(camera(), &airframe, None, located_by()).unwrap(),
            lookout: Lookout::new(camera(), &airframe, &located_by(), settings, Some(&fleet)).unwrap(),
            airframe,
            frame: 0,
            rng: Pcg64::new(11, 3),
        }
    }

    /// A frame on; tells the vehicles.
    fn see(&mut self, blinkers: &mut [Blinker]) -> Tracked {
        self.frame += 1;
        let time_s = f64::from(self.frame) / RATE_HZ;
        let level = Rotation3::identity();
        let mut spots = Vec::new();
        for blinker in blinkers {
            blinker.flown = blinker.flown.on(1.0 / RATE_HZ);
            for seen in simulator::look(&self.airframe, &[blinker.flown], &level, &mut self.rng) {
                let led = self.airframe.markers()[seen.marker].leds[0];
                let signal = self.airframe.leds()[led].signal.unwrap_or(0);
                let is_dark = blinker.is_hidden || blinker.dead.contains(&seen.marker);
                if !is_dark && blinker.is_lit(signal, time_s) {
                    spots.push(seen.spot);
                }
            }
        }
        let gravity = Some(down(&level));
        let located =
            self.locator.locate(Input::spots(&spots).gravity(gravity.as_ref())).expect("spots have no size");
        let turned = Some(Turned { now_from_before: level, sigma_rad: 1e-5 });
        let glance = Glance { exposure_s: EXPOSURE_S, turned, gravity, ..Glance::new(time_s, located) };
        self.lookout.look(&glance).unwrap().clone()
    }

    /// The id that is surely said of the track within 5 sigma of a vehicle; `None` where there is no such track, `Some(None)` where it is not sure.
    fn named(&self, tracked: &Tracked, blinker: &Blinker) -> Option<Option<u32>> {
        let off = |track: &tracking::Track| {
            simulator::nees(&(track.position_m - blinker.flown.position_m), &track.position_covariance_m2)
        };
        let near =
            tracked.tracks.iter().map(|track| (off(track), track.id)).min_by(|a, b| a.0.total_cmp(&b.0))?;
        let name = self.lookout.name(near.1).filter(|name| name.probability >= SURE);
        (near.0 < 25.0).then_some(name.map(|name| name.id))
    }
}

fn word(number: usize) -> Word {
    book().words()[number]
}

/// Two that cross in the image, each with one word: in frames after a word and a half, with those in which neither is lit.
#[test]
fn vehicles_that_cross_are_known() {
    let mut world = World::new(hexarotor(), 2, 1);
    let mut blinkers = [
        Blinker::new([-2.0, 0.2, 5.0], [0.9, 0.0, 0.0], 0.3, vec![word(0)], 0.003),
        Blinker::new([2.2, -0.3, 7.0], [-1.0, 0.0, 0.0], 1.0, vec![word(1)], 0.05),
    ];
    let (mut right, mut unsure, mut lost, mut wrong) = (0, 0, 0, 0);
    for frame in 0..300 {
        let tracked = world.see(&mut blinkers);
        for (blinker, id) in blinkers.iter().zip(1..).filter(|_| f64::from(frame) > 1.5 * LENGTH) {
            match world.named(&tracked, blinker) {
                Some(Some(told)) if told == id => right += 1,
                Some(Some(_)) => wrong += 1,
                Some(None) => unsure += 1,
                None => lost += 1,
            }
        }
    }
    println!("crossing: {right} right, {unsure} unsure, {lost} lost, {wrong} wrong");
    assert_eq!(wrong, 0);
    assert!(right >= 540, "{right} right, {unsure} unsure, {lost} lost");
}

/// A hexarotor looks the same six ways; what its arms blink says which.
#[test]
fn signals_tell_how_a_symmetric_airframe_is_turned() {
    for (yaw_deg, rate_rad_s) in [(0.0, 0.5), (100.0, -0.5), (200.0, 0.5), (300.0, -0.5)] {
        let mut world = World::new(signalled([0, 1, 1, 2, 2, 2]), 2, 3);
        let words = vec![word(3), word(4), word(5)];
        let yaw_rad = f64::to_radians(yaw_deg);
        let mut blinkers = [Blinker::new([-0.4, 0.1, 4.0], [0.2, 0.0, 0.1], yaw_rad, words, 0.01)];
        let mut known = 0;
        for frame in 0..180 {
            blinkers[0].flown.yaw_rad += rate_rad_s / RATE_HZ;
            let tracked = world.see(&mut blinkers);
            let truth = blinkers[0].flown.world_from_body();
            if frame >= 90 {
                assert_eq!(
                    world.named(&tracked, &blinkers[0]),
                    Some(Some(2)),
                    "{yaw_deg}: {:?}",
                    world.lookout.names()
                );
                let off = (tracked.tracks[0].camera_from_body.inverse() * truth).angle().to_degrees();
                known += u32::from(off < 15.0);
            }
        }
        assert!(known >= 80, "{yaw_deg}: {known} of 90");
    }
}

/// One shows two LEDs, since the one between them is dead, and another in line with it shows one: in every frame in which both are lit they look like one
/// neighbour. A third shows a single LED and has no group in any frame.
#[test]
fn what_is_heard_parts_vehicles_that_look_like_one() {
    let airframe = hexarotor();
    let mut world = World::new(airframe.clone(), 5, 1);
    let at = |position_m, velocity_m_s, number: usize| {
        let phase_s = 0.003 + 0.035 * number as f64;
        Blinker::new(position_m, velocity_m_s, 0.3, vec![word(number)], phase_s)
    };
    let mut blinkers = [
        at([-2.5, 0.2, 5.0], [0.1, 0.0, 0.0], 0),
        at([3.0, -0.3, 6.0], [0.0, 0.0, 0.1], 1),
        at([-0.2, 0.0, 6.0], [0.0, 0.05, 0.0], 2).facing_with_dead(&airframe, &[0]),
        at([0.5, 0.0, 5.5], [0.0, -0.05, 0.0], 3).facing_with_dead(&airframe, &[1, 5]),
        at([4.5, 1.0, 7.0], [-0.1, 0.0, 0.0], 4).facing_with_dead(&airframe, &[1, 5]),
    ];
    let mut right = [0; 5];
    for frame in 0..240 {
        let tracked = world.see(&mut blinkers);
        for (of, (blinker, id)) in blinkers.iter().zip(1..).enumerate().filter(|_| frame >= 90) {
            let is_it = |track: &&tracking::Track| {
                let name = world.lookout.name(track.id);
                let (at_m, there_m) = (track.position_m, blinker.flown.position_m);
                // Of one LED nobody knows how it is turned: its light tells the distance to a factor of two.
                let near = match of {
                    0..3 => simulator::nees(&(at_m - there_m), &track.position_covariance_m2) < 16.0,
                    _ => at_m.angle(&there_m) < 0.1 && (0.5..2.0).contains(&(at_m.norm() / there_m.norm())),
                };
                near && name.is_some_and(|name| name.id == id && name.probability > SURE)
            };
            right[of] += u32::from(tracked.tracks.iter().any(|track| is_it(&track)));
        }
    }
    assert_eq!(right, [150; 5]);
    assert_eq!(world.lookout.tracked().tracks.len(), 5, "{:?}", world.lookout.names());
}

/// Nobody is sure of an id that two carry, and the answer says why.
#[test]
fn an_id_that_two_carry_is_contested() {
    let mut world = World::new(hexarotor(), 3, 1);
    let mut blinkers = [
        Blinker::new([-1.5, 0.2, 5.0], [0.0, 0.1, 0.0], 0.3, vec![word(1)], 0.003),
        Blinker::new([1.5, -0.3, 6.0], [0.0, 0.0, 0.1], 1.0, vec![word(1)], 0.05),
        Blinker::new([0.0, 1.0, 6.0], [0.0, 0.0, 0.1], 1.0, vec![word(2)], 0.03),
    ];
    let mut contested = 0;
    for frame in 0..240 {
        let tracked = world.see(&mut blinkers);
        if frame > 60 {
            for blinker in &blinkers[..2] {
                assert!(
                    !matches!(world.named(&tracked, blinker), Some(Some(_))),
                    "{:?}",
                    world.lookout.names()
                );
            }
            assert_eq!(world.named(&tracked, &blinkers[2]), Some(Some(3)));
            contested +=
                world.lookout.names().iter().filter(|name| name.is_contested && name.id == 2).count();
        }
    }
    assert!(contested > 300, "{contested}");
}

/// Words of another book are nobody's, and steady lights are.
#[test]
fn strangers_have_no_name() {
    let mut world = World::new(hexarotor(), 6, 1);
    let other = Word::new(&[0, 1, 0, 0, 1, 1, 1, 0, 1, 1, 0, 1].map(|bit| bit == 1)).unwrap();
    let steady = Word::new(&[true]).unwrap();
    let mut blinkers = [
        Blinker::new([-1.5, 0.2, 5.0], [0.0, 0.1, 0.0], 0.3, vec![other], 0.003),
        Blinker::new([1.5, -0.3, 6.0], [0.0, 0.0, 0.1], 1.0, vec![steady], 0.05),
    ];
    for _ in 0..240 {
        let tracked = world.see(&mut blinkers);
        for blinker in &blinkers {
            assert!(!matches!(world.named(&tracked, blinker), Some(Some(_))), "{:?}", world.lookout.names());
        }
    }
    assert_eq!(world.lookout.tracked().tracks.len(), 2);
}

/// Who was known stays known while hidden, and one who comes in its place is not taken for it.
#[test]
fn who_is_hidden_stays_who_it_is() {
    let mut world = World::new(hexarotor(), 2, 1);
    let mut blinkers = [Blinker::new([-0.5, 0.2, 5.0], [0.3, 0.0, 0.0], 0.3, vec![word(0)], 0.003)];
    for _ in 0..90 {
        world.see(&mut blinkers);
    }
    let track = world.lookout.tracked().tracks[0].id;
    blinkers[0].is_hidden = true;
    for _ in 0..60 {
        let tracked = world.see(&mut blinkers);
        assert_eq!(tracked.tracks.len(), 1);
        assert_eq!(world.named(&tracked, &blinkers[0]), Some(Some(1)), "{:?}", world.lookout.names());
    }
    (blinkers[0].is_hidden, blinkers[0].words) = (false, vec![word(1)]);
    let mut last = None;
    for _ in 0..90 {
        let tracked = world.see(&mut blinkers);
        last = world.named(&tracked, &blinkers[0]);
    }
    assert_eq!(last, Some(Some(2)), "track {track}: {:?}", world.lookout.names());
}

/// The same look twice, a late one, another clock.
#[test]
fn times_are_the_trackers() {
    let mut world = World::new(hexarotor(), 2, 1);
    let mut blinkers = [Blinker::new([-0.5, 0.2, 5.0], [0.3, 0.0, 0.0], 0.3, vec![word(0)], 0.003)];
    for _ in 0..60 {
        world.see(&mut blinkers);
    }
    let nothing = world.locator.locate(Input::spots(&[])).expect("spots have no size");
    let glance = Glance {
        camera: 0,
        turned_since_any: None,
        time_s: 1.0,
        exposure_s: EXPOSURE_S,
        turned: None,
        moving: None,
        gravity: None,
        located: nothing,
    };
    let before = world.lookout.names().to_vec();
    assert!(matches!(world.lookout.look(&glance), Err(TrackError::Repeated { .. })));
    assert_eq!(world.lookout.names(), before);
    let late = Glance { time_s: 0.99, ..glance };
    assert_eq!(world.lookout.look(&late).unwrap().placed, Placed::Late);
    assert!(world.lookout.names()[0].probability > SURE);
    let other = Glance { time_s: -100.0, ..glance };
    assert_eq!(world.lookout.look(&other).unwrap().placed, Placed::Reset);
    assert!(world.lookout.names().is_empty() && world.lookout.markers(0).is_empty());
    world.frame = 0;
    for _ in 0..60 {
        world.see(&mut blinkers);
    }
    assert_eq!(world.lookout.names()[0].id, 1);
    assert!(world.lookout.names()[0].probability > SURE);
}

#[test]
fn fleets_without_a_meaning_are_refused() {
    let vehicle = |id: u32, words: &[usize]| Vehicle { id, words: words.to_vec() };
    let fleet = |vehicles: &[(u32, &[usize], f64)]| {
        Fleet::new(book(), vehicles.iter().map(|&(id, words, rate)| (vehicle(id, words), rate))).unwrap_err()
    };
    assert_eq!(fleet(&[]), FleetError::Nobody);
    assert_eq!(fleet(&[(1, &[0], 60.0), (1, &[1], 60.0)]), FleetError::Twice(1));
    assert_eq!(fleet(&[(1, &[], 60.0)]), FleetError::Silent(1));
    assert_eq!(fleet(&[(1, &[6], 60.0)]), FleetError::Word { id: 1, word: 6, words: 6 });
    assert_eq!(fleet(&[(1, &[0], 0.0)]), FleetError::BitRate(0.0));
    assert_eq!(fleet(&[(1, &[0], 60.0), (2, &[1], 62.0)]), FleetError::BitRates(60.0, 62.0));
}

/// Six arms with three words, of two vehicles that cross: each is one track with its own name, from three code lengths on, and no other.
#[test]
fn vehicles_with_several_signals_cross_as_one_track_each() {
    let mut world = World::new(signalled([0, 1, 1, 2, 2, 2]), 2, 3);
    let mut blinkers = [
        Blinker::new([-1.6, 0.2, 4.5], [0.7, 0.0, 0.0], 0.3, vec![word(0), word(1), word(2)], 0.003),
        Blinker::new([1.6, -0.4, 6.0], [-0.7, 0.0, 0.0], 1.0, vec![word(3), word(4), word(5)], 0.05),
    ];
    let (mut right, mut not, mut tracks) = (0, 0, std::collections::BTreeSet::new());
    for frame in 0..240 {
        let tracked = world.see(&mut blinkers);
        if f64::from(frame) < 3.0 * LENGTH {
            continue;
        }
        tracks.extend(tracked.tracks.iter().map(|track| track.id));
        for (blinker, id) in blinkers.iter().zip(1..) {
            match world.named(&tracked, blinker) {
                Some(Some(told)) => {
                    assert_eq!(told, id, "frame {frame}");
                    right += 1;
                }
                _ => not += 1,
            }
        }
    }
    println!("several signals, crossing: {right} right, {not} not, tracks {tracks:?}");
    assert_eq!(tracks.len(), 2);
    assert!(not < 12, "{right} right, {not} not");
}

/// What blinks words of nobody is followed without a name beside who is known, and nobody takes its spots.
#[test]
fn strangers_fly_beside_vehicles_with_several_signals() {
    let mut world = World::new(signalled([0, 1, 1, 2, 2, 2]), 2, 3);
    let steady = Word::new(&[true]).unwrap();
    let mut blinkers = [
        Blinker::new([-1.2, 0.2, 4.5], [0.2, 0.0, 0.0], 0.3, vec![word(0), word(1), word(2)], 0.003),
        Blinker::new([1.2, -0.2, 5.0], [-0.1, 0.0, 0.0], 1.0, vec![steady, steady, steady], 0.0),
    ];
    for frame in 0..150 {
        let tracked = world.see(&mut blinkers);
        if frame > 75 {
            assert_eq!(world.named(&tracked, &blinkers[0]), Some(Some(1)), "frame {frame}");
            assert_eq!(world.named(&tracked, &blinkers[1]), Some(None), "frame {frame}");
        }
    }
}
