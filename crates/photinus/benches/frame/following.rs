//! Following and decoding the markers of a frame, which blink 41 words of 18 bits, spread over the view.

use std::hint::black_box;

use nalgebra::{Matrix2, Rotation3};
use photinus::camera::{Camera, Pixel, Watched};
use photinus::following::{self, Follower, Frame, Turn};
use photinus::identity::CodeBook;
use photinus::identity::decoder::{Decoder, Settings};
use photinus::locator::Sighting;
use photinus::pose::LogLight;
use photinus::spots::{Extent, Spot};

use crate::contest::Contest;
use crate::decoding;

/// Frames after which all begins again: a number of rounds of a word.
const FRAMES: usize = 360;
const SIGMA_PX: f64 = 0.1;

struct Markers {
    camera: Camera,
    follower: Follower,
    frames: Vec<Vec<Sighting>>,
    frame: usize,
    turn: Option<Turn>,
}

impl Markers {
    fn new(count: usize, turn: Option<Turn>) -> Self {
        let (camera, words) = (crate::camera(), decoding::words());
        let decoder = Decoder::new(&CodeBook::new(words.clone()).expect("a book"), Settings::default());
        let across = (count as f64 * 1.5).sqrt().ceil() as usize;
        let down = count.div_ceil(across);
        let sees = |frame: usize| {
            let lit = (0..count).filter(|marker| words[marker % words.len()].bit(frame + marker));
            let place = |marker: usize| {
                // off by a tenth of a pixel or so, another way in each frame
                let off = |factor: usize| ((marker * 31 + frame * factor) % 17) as f64 / 8.0 - 1.0;
                let u = 60.0 + 630.0 * (marker % across) as f64 / across as f64 + SIGMA_PX * off(7);
                let v = 60.0 + 360.0 * (marker / across) as f64 / down as f64 + SIGMA_PX * off(5);
                sighting(&camera, Pixel::new(u, v))
            };
            lit.map(place).collect()
        };
        let frames = (0..FRAMES).map(sees).collect();
        let follower = Follower::new(&camera, decoder.ok(), following::Settings::default());
        let mut markers = Self { camera, follower: follower.expect("settings"), frames, frame: 0, turn };
        (0..400).for_each(|_| markers.follow());
        let known = markers
            .follower
            .tracks()
            .iter()
            .filter(|track| track.identity.is_some_and(|identity| identity.probability > 0.99));
        println!("{count} markers: {} tracks, {} known", markers.follower.tracks().len(), known.count());
        markers
    }

    fn follow(&mut self) {
        self.frame += 1;
        let frame = Frame {
            time_s: self.frame as f64 / 60.0,
            exposure_s: 1e-3,
            sightings: &self.frames[self.frame % FRAMES],
            detection_limit: Some(LogLight { value: libm::log(200.0), sigma: 0.2 }),
            turn: self.turn,
            watched: Watched::new(&self.camera, None),
        };
        black_box(self.follower.follow(&frame).expect("time passes"));
    }
}

fn sighting(camera: &Camera, centre: Pixel) -> Sighting {
    let (bearing, jacobian) = camera.bearing_with_jacobian(centre).expect("inside the image");
    let covariance_px2 = Matrix2::identity() * (SIGMA_PX * SIGMA_PX);
    let covariance_rad2 = jacobian * covariance_px2 * jacobian.transpose();
    let spot = Spot {
        centre,
        covariance_px2,
        area_px: 6,
        peak: 200,
        saturated_px: 0,
        flux: 800.0,
        light: None,
        background: 5.0,
        marker_log_odds: 0.0,
        middle: (centre.u as u32, centre.v as u32),
        extent: Extent { left: 0, top: 0, right: 1, bottom: 1 },
    };
    Sighting {
        spot,
        signal: None,
        log_light: Some(LogLight { value: libm::log(800.0), sigma: 0.05 }),
        bearing,
        covariance_rad2,
        spot_covariance_rad2: covariance_rad2,
        rad_per_px: 3.8e-3,
        resolution_rad: 9.5e-3,
        bound_rad: 0.01,
        range: None,
    }
}

pub(crate) fn run() {
    let mut contest = Contest::beside_maximum("Following and decoding the markers of a frame");
    let gyro = Some(Turn { now_from_before: Rotation3::identity(), sigma_rad: 1e-4 });
    for count in [20, 120] {
        for (name, turn) in [("with a gyro", gyro), ("without", None)] {
            let mut markers = Markers::new(count, turn);
            contest.add(&format!("{count} markers, {name}"), move |_| markers.follow());
        }
    }
    contest.run();
}
