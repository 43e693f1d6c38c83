//! A warm detector, locator, decoder, follower, tracker and lookout allocate nothing: every request to the allocator is counted.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use nalgebra::{Matrix2, Vector3};
use photinus::airframe::{Airframe, Marker, Ring};
use photinus::camera::{Bearing, Camera, Ideal, IdealLaw, Model, Pixel, Watched};
use photinus::following::{self, Follower};
use photinus::frame::{FrameView, Mask};
use photinus::identity::decoder::{self, Decoder};
use photinus::identity::{CodeBook, Evidence, Word};
use photinus::locator::{self, Input, Located, Locator};
use photinus::lookout::{Fleet, Glance, Lookout, Vehicle};
use photinus::pose::{LogLight, p3p, pnp};
use photinus::spots::{Brightness, Detector, Extent, Settings, Spot};
use photinus::tracking::{self, Look, Tracker};
use rand_distr::{Distribution, Uniform};
use rand_pcg::Pcg64;

const WIDTH: usize = 376;
const HEIGHT: usize = 240;

struct Counting;

thread_local! {
    /// Requests of this thread: the test harness has others.
    static REQUESTS: Cell<u64> = const { Cell::new(0) };
}

fn count() {
    REQUESTS.with(|requests| requests.set(requests.get() + 1));
}

#[expect(
    unsafe_code,
    reason = "an allocator is unsafe by its trait; every call goes on to the system's unchanged"
)]
// SAFETY: the arguments are passed on as they came, so the caller's promises are those that `System` needs.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count();
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        unsafe { System.realloc(memory, layout, size) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        unsafe { System.dealloc(memory, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn requests_during(work: impl FnOnce()) -> u64 {
    let before = REQUESTS.get();
    work();
    REQUESTS.get() - before
}

/// Markers of many sizes, pairs that must be split, and pieces of a large bright surface.
fn frame(markers: usize, rng: &mut Pcg64) -> Vec<u8> {
    let (across, down) = (Uniform::new(0, WIDTH).unwrap(), Uniform::new(0, HEIGHT).unwrap());
    let (radius, level) = (Uniform::new(0, 9).unwrap(), Uniform::new(4, 9).unwrap());
    let mut pixels: Vec<u8> = (0..WIDTH * HEIGHT).map(|_| level.sample(rng)).collect();
    for _ in 0..markers {
        let (u0, v0, r) = (across.sample(rng), down.sample(rng), radius.sample(rng) as isize);
        for (du, dv) in (-r..=r).flat_map(|dv| (-r..=r).map(move |du| (du, dv))) {
            if let (Some(u), Some(v)) = (u0.checked_add_signed(du), v0.checked_add_signed(dv))
                && u < WIDTH
                && v < HEIGHT
            {
                let light = 330 - 25 * (du * du + dv * dv);
                let pixel = &mut pixels[v * WIDTH + u];
                *pixel = (*pixel).max(light.clamp(0, 255) as u8);
            }
        }
    }
    pixels
}

/// No frame has more runs, parts or summits than these two.
fn busiest() -> [Vec<u8>; 2] {
    let dots = |i: usize| (i % WIDTH).is_multiple_of(2) && (i / WIDTH).is_multiple_of(2);
    let board = |i: usize| (i % WIDTH + i / WIDTH).is_multiple_of(2);
    [
        (0..WIDTH * HEIGHT).map(|i| if dots(i) { 255 } else { 0 }).collect(),
        (0..WIDTH * HEIGHT).map(|i| if board(i) { 255 } else { 0 }).collect(),
    ]
}

#[test]
fn the_counter_counts() {
    assert_eq!(requests_during(|| drop(std::hint::black_box(vec![1u8; 100]))), 1);
}

#[test]
fn a_warm_detector_allocates_nothing() {
    let mut rng = Pcg64::new(31, 7);
    let warm_up: Vec<Vec<u8>> = busiest().into_iter().chain((0..12).map(|_| frame(300, &mut rng))).collect();
    let frames: Vec<Vec<u8>> = (0..60).map(|i| frame(4 * i, &mut rng)).collect();
    let mask_pixels: Vec<u8> = (0..WIDTH * HEIGHT).map(|i| u8::from(i % WIDTH > 30)).collect();
    let mask = Mask::from_frame(&FrameView::packed(&mask_pixels, WIDTH, HEIGHT).unwrap());
    for brightness in [Brightness::Threshold(200), Brightness::Contrast(20)] {
        let mut settings = Settings::default();
        settings.brightness = brightness;
        let mut detector = Detector::new(settings).unwrap();
        let mut spots = 0;
        let mut detect = |pixels: &[u8]| {
            let frame = FrameView::packed(pixels, WIDTH, HEIGHT).unwrap();
            spots += detector.detect(&frame, Some(&mask)).unwrap().spots.len();
        };
        warm_up.iter().for_each(|pixels| detect(pixels));
        assert_eq!(requests_during(|| frames.iter().for_each(|pixels| detect(pixels))), 0, "{brightness:?}");
        assert!(spots > 1000, "{spots} spots");
    }
}

#[test]
fn closed_form_poses_allocate_nothing() {
    let points_m = [[0.4, 0.0, 0.0], [0.0, 0.4, 0.1], [-0.4, 0.0, 0.0], [0.0, -0.4, 0.0], [0.2, 0.2, 0.2]];
    let points_m = points_m.map(Vector3::from);
    let bearings = points_m.map(|p| (p + Vector3::new(0.3, 0.2, 2.0)).normalize());
    let mut poses = 0;
    let work = || {
        poses += usize::from(pnp(&bearings, &points_m).is_some());
        poses += p3p(bearings[..3].try_into().unwrap(), points_m[..3].try_into().unwrap()).iter().len();
    };
    assert_eq!(requests_during(work), 0);
    assert!(poses > 1, "{poses}");
}

#[test]
fn a_warm_locator_allocates_nothing() {
    let mut rng = Pcg64::new(32, 7);
    let warm_up: Vec<Vec<u8>> = (0..6).map(|_| frame(300, &mut rng)).collect();
    let frames: Vec<Vec<u8>> = (0..30).map(|i| frame(4 * i, &mut rng)).collect();
    let lens = Ideal::new(IdealLaw::Equidistant, [130.0; 2], Pixel::new(187.5, 119.5)).unwrap();
    let camera = Camera::new(Model::Ideal(lens), WIDTH, HEIGHT, None).unwrap();
    let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
    let airframe = Airframe::from_ring("hexarotor", ring).unwrap();
    let mut settings = locator::Settings::default();
    settings.min_probability = 0.0;
    let mut locator = Locator::new(camera, &airframe, None, settings).unwrap();
    let mut neighbours = 0;
    let mut locate = |pixels: &[u8]| {
        let frame = FrameView::packed(pixels, WIDTH, HEIGHT).unwrap();
        let gravity = Vector3::y_axis();
        neighbours += locator.locate(Input::frame(&frame).gravity(&gravity)).unwrap().neighbours.len();
    };
    // Warm is who has seen such frames.
    warm_up.iter().chain(&frames).for_each(|pixels| locate(pixels));
    assert_eq!(requests_during(|| frames.iter().for_each(|pixels| locate(pixels))), 0);
    assert!(neighbours > 300, "{neighbours}");
}

/// The spots of an upright vehicle at a place in the camera frame.
fn spots_of(camera: &Camera, airframe: &Airframe, place_m: Vector3<f64>) -> Vec<Spot> {
    let camera_m = Vector3::new(-place_m.x, -place_m.z, place_m.y);
    let spot_of = |(index, marker): (usize, &Marker)| {
        let [x, y, z]: [f64; 3] = marker.position_m.into();
        let at_m = place_m + Vector3::new(x, -z, y);
        let flux = 1e5 * airframe.intensity(index, &camera_m) / at_m.norm_squared();
        (flux > 75.0).then(|| spot(camera.pixel(&Bearing::new(at_m).unwrap()).unwrap(), flux))
    };
    airframe.markers().iter().enumerate().filter_map(spot_of).collect()
}

/// A spot as a detector finds it.
fn spot(centre: Pixel, flux: f64) -> Spot {
    let middle = (centre.u as u32, centre.v as u32);
    Spot {
        centre,
        covariance_px2: Matrix2::identity() * 0.01,
        area_px: 9,
        peak: 200,
        saturated_px: 0,
        flux,
        light: None,
        background: 5.0,
        marker_log_odds: 3.0,
        middle,
        extent: Extent { left: middle.0, top: middle.1, right: middle.0 + 1, bottom: middle.1 + 1 },
    }
}

#[test]
fn a_warm_tracker_allocates_nothing() {
    let lens = Ideal::new(IdealLaw::Equidistant, [130.0; 2], Pixel::new(187.5, 119.5)).unwrap();
    let camera = Camera::new(Model::Ideal(lens), WIDTH, HEIGHT, None).unwrap();
    let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
    let airframe = Airframe::from_ring("hexarotor", ring).unwrap();
    let settings = locator::Settings::default();
    let mut locator = Locator::new(camera.clone(), &airframe, None, settings).unwrap();
    let gravity = Vector3::y_axis();
    // Two vehicles that drift by, a glint now and then.
    let mut locate = |number: u32| {
        let mut spots = Vec::new();
        for place_m in
            [[0.01 * f64::from(number) - 1.0, 0.1, 4.0], [1.0 - 0.02 * f64::from(number), -0.1, 5.0]]
        {
            spots.extend(spots_of(&camera, &airframe, Vector3::from(place_m)));
        }
        if number.is_multiple_of(3) {
            spots.push(spot(Pixel::new(150.0 + f64::from(number), 80.0), 900.0));
        }
        locator.locate(Input::spots(&spots).gravity(&gravity)).expect("spots have no size").clone()
    };
    let located: Vec<_> = (0..60).map(&mut locate).collect();
    let mut tracker =
        Tracker::new(camera.clone(), &airframe, &settings, tracking::Settings::default()).unwrap();
    let (mut tracks, mut number) = (0, 0);
    let mut track = |located: &Located| {
        number += 1;
        // Every fifth frame comes after the next one.
        let time_s = f64::from(number + u32::from(number % 5 == 1) - u32::from(number % 5 == 2)) / 30.0;
        let look = Look {
            camera: 0,
            time_s,
            turned: None,
            moving: None,
            gravity: Some(gravity),
            located,
            signals: &[],
            lit: &[],
            blinking: None,
        };
        tracks += tracker.track(&look).unwrap().tracks.len();
        tracker.at(f64::from(number + 2) / 30.0).unwrap();
    };
    // Warm is who has been through it.
    (0..20).for_each(|_| located.iter().for_each(&mut track));
    assert_eq!(requests_during(|| located.iter().for_each(&mut track)), 0);
    assert!(tracks > 100, "{tracks}");
}

#[test]
fn a_warm_lookout_allocates_nothing() {
    let lens = Ideal::new(IdealLaw::Equidistant, [130.0; 2], Pixel::new(187.5, 119.5)).unwrap();
    let camera = Camera::new(Model::Ideal(lens), WIDTH, HEIGHT, None).unwrap();
    let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
    let airframe = Airframe::from_ring("hexarotor", ring).unwrap();
    let settings = locator::Settings::default();
    let bits = |text: &str| text.chars().map(|bit| bit == '1').collect::<Vec<_>>();
    let words = ["0010110111", "0010101111", "0001110101"].map(|text| Word::new(&bits(text)).unwrap());
    let book = CodeBook::new(words.to_vec()).unwrap();
    let vehicle = |id: usize| (Vehicle { id: id as u32, words: vec![id] }, 60.0);
    let fleet = Fleet::new(book, (0..3).map(vehicle)).unwrap();
    let mut locator = Locator::new(camera.clone(), &airframe, None, settings).unwrap();
    let mut lookout =
        Lookout::new(camera.clone(), &airframe, &settings, tracking::Settings::default(), Some(&fleet))
            .unwrap();
    let gravity = Vector3::y_axis();
    // Two that drift by, each with a word; the second is away for half of the time, and comes back as another track.
    let mut number = 0_u32;
    let (mut named, mut away) = (0, 0);
    let mut requests = 0;
    for round in 0..12 {
        for step in 0..90_u32 {
            number += 1;
            let side_m = 0.01 * f64::from(step) - 0.45;
            let mut spots = Vec::new();
            for (word, place_m) in [(0, [side_m - 0.8, 0.1, 4.0]), (1, [0.8 - side_m, -0.1, 5.0])] {
                let is_away = word == 1 && step > 60;
                away += u32::from(is_away);
                if is_away || !words[word].bit(number as usize) {
                    continue;
                }
                spots.extend(spots_of(&camera, &airframe, Vector3::from(place_m)));
            }
            let located = locator.locate(Input::spots(&spots).gravity(&gravity)).expect("spots have no size");
            let time_s = f64::from(number) / 60.0;
            let glance = Glance {
                camera: 0,
                turned_since_any: None,
                time_s,
                exposure_s: 1e-3,
                turned: None,
                moving: None,
                gravity: Some(gravity),
                located,
            };
            let own = requests_during(|| {
                lookout.look(&glance).unwrap();
            });
            // Warm is who has been through it.
            requests += if round > 8 { own } else { 0 };
            named += lookout.names().iter().filter(|name| name.probability > 0.99).count();
        }
    }
    assert_eq!(requests, 0);
    assert!(named > 600 && away > 100, "{named}");
}

#[test]
fn a_warm_decoder_allocates_nothing() {
    let bits = |text: &str| text.chars().map(|bit| bit == '1').collect::<Vec<_>>();
    let words = ["0010110111", "0010101111", "0001110101"].map(|text| Word::new(&bits(text)).unwrap());
    let book = CodeBook::new(words.to_vec()).unwrap();
    let decoder = Decoder::new(&book, decoder::Settings::default()).unwrap();
    let mut listener = decoder.listener();
    let requests = requests_during(|| {
        for frame in 0..300 {
            let time_s = frame as f64 / 60.0;
            // the track takes on another light
            let evidence = Evidence::of_bit(words[usize::from(frame > 150)].bit(frame), 0.01);
            decoder.hear(&mut listener, time_s, 1e-3, &evidence).unwrap();
            decoder.light_at(&listener, time_s + 0.01, 1e-3).unwrap();
            decoder.identity(&listener);
        }
        decoder.restart(&mut listener);
    });
    assert_eq!(requests, 0);
}

/// Markers that blink, come, go and move to and fro; spots that a locator sees in rendered frames, many of them clutter.
#[test]
fn a_warm_follower_allocates_nothing() {
    let lens = Ideal::new(IdealLaw::Equidistant, [130.0; 2], Pixel::new(187.5, 119.5)).unwrap();
    let camera = Camera::new(Model::Ideal(lens), WIDTH, HEIGHT, None).unwrap();
    let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
    let airframe = Airframe::from_ring("hexarotor", ring).unwrap();
    let mut locator = Locator::new(camera.clone(), &airframe, None, locator::Settings::default()).unwrap();
    let mut rng = Pcg64::new(33, 7);
    let shown: Vec<Vec<u8>> = (0..8).map(|i| frame(20 + i, &mut rng)).collect();
    let mut see = |pixels: &Vec<u8>| {
        let frame = FrameView::packed(pixels, WIDTH, HEIGHT).unwrap();
        locator.locate(Input::frame(&frame)).unwrap().sightings.to_vec()
    };
    let frames: Vec<_> = shown.iter().map(&mut see).collect();
    let bits = |text: &str| text.chars().map(|bit| bit == '1').collect::<Vec<_>>();
    let words = ["0010110111", "0010101111", "0001110101"].map(|text| Word::new(&bits(text)).unwrap());
    let decoder =
        Decoder::new(&CodeBook::new(words.to_vec()).unwrap(), decoder::Settings::default()).unwrap();
    let mut follower = Follower::new(&camera, Some(decoder), following::Settings::default()).unwrap();
    let (mut time_s, mut tracks) = (0.0, 0);
    let mut follow = |round: usize| {
        for frame in 0..120 {
            time_s += 1.0 / 60.0;
            // another picture each second, whose spots blink
            let sightings = &frames[(round + frame / 60) % frames.len()];
            let all = if words[0].bit(frame) { sightings.len() } else { sightings.len() / 2 };
            let frame = following::Frame {
                time_s,
                exposure_s: 1e-3,
                sightings: &sightings[..all],
                detection_limit: Some(LogLight { value: libm::log(100.0), sigma: 0.2 }),
                turn: None,
                watched: Watched::new(&camera, None),
            };
            tracks += follower.follow(&frame).unwrap().len();
        }
    };
    (0..8).for_each(&mut follow);
    assert_eq!(requests_during(|| (0..8).for_each(&mut follow)), 0);
    assert!(tracks > 1000, "{tracks}");
}
