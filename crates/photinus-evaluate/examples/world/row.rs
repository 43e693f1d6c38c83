//! One row of a table: a camera, vehicles, what goes wrong -> scores.

use nalgebra::{Isometry3, Translation3, Unit, Vector3};
use photinus::airframe::{Airframe, Ring};
use photinus::camera::Camera;
use photinus::locator::{Input, Locator, Settings};
use photinus::optics::Optics;
use photinus_calibrate::optics::{Collection, learn};
use photinus_evaluate::{Scores, evaluate};
use photinus_io::dataset::TruthFrame;
use photinus_io::frames::{Frame, Moved};
use photinus_io::results::FrameRecord;
use photinus_sim::faults::{Fault, Faults, Shot};
use photinus_sim::preset::Preset;
use photinus_sim::snapshot::{Moving, Snapshot};
use photinus_sim::{CameraView, Renderer};
use rand_pcg::Pcg64;

use crate::calibrated::{calibrated, to_centroids};
use crate::light::{Fallen, Lights, fallen};
use crate::priors::{Build, Drawing, known_gravity, world_from_camera};

/// Distances of the vehicles whose LEDs tell the optics.
const OPTICS_RANGES_M: [f64; 2] = [2.0, 20.0];
/// The first of the frames that optics are learned from.
const OTHER_FRAMES: u64 = 1 << 32;
/// Frames that share the places of hot pixels and lamps, and the side to which gravity is wrong, unless a row says otherwise.
const SPELL: u64 = 20;

/// What frames are taken with.
#[derive(Clone, Debug)]
pub(crate) struct Eye {
    pub(crate) camera: Camera,
    pub(crate) preset: Preset,
    pub(crate) exposure_us: f64,
}

/// One row: what is there, and what is wrong with it.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) name: String,
    pub(crate) eye: Eye,
    pub(crate) airframe: Airframe,
    /// Vehicles in each frame.
    pub(crate) vehicles: usize,
    pub(crate) ranges_m: [f64; 2],
    pub(crate) build: Build,
    pub(crate) smear_px: f64,
    pub(crate) faults: Vec<Fault>,
    pub(crate) knows_gravity: bool,
    /// Frames that share the places of hot pixels and lamps, and the side to which gravity is wrong.
    pub(crate) spell: u64,
    /// Neighbours less likely than this are not told.
    pub(crate) min_probability: f64,
    /// Frames, none of those located, that the camera's optics are learned from; 0 for none.
    pub(crate) optics_frames: u64,
}

/// What came out of a row.
pub(crate) struct Outcome {
    pub(crate) name: String,
    pub(crate) airframe: String,
    pub(crate) frames: u64,
    pub(crate) vehicles: usize,
    /// Whether truth is as the model has it: nothing wrong, or clutter that is anywhere in each frame.
    pub(crate) is_as_believed: bool,
    pub(crate) scores: Scores,
    pub(crate) lights: Lights,
}

/// The airframes of the tables: those of scenes/, and an octorotor.
pub(crate) fn airframe(arms: usize) -> Airframe {
    let quarter = std::f64::consts::FRAC_PI_2;
    let (name, radius_m, leds_per_arm, splay_rad) = match arms {
        4 => ("quadrotor-0.245", 0.245, 2, quarter),
        8 => ("octorotor-0.5", 0.5, 1, 0.0),
        _ => ("hexarotor-0.4", 0.4, 1, 0.0),
    };
    let ring = Ring { arms, radius_m, leds_per_arm, splay_rad };
    Airframe::from_ring(name, ring).expect("a ring")
}

impl Row {
    /// A single neighbour with nothing wrong.
    pub(crate) fn plain(name: impl Into<String>, eye: &Eye, arms: usize) -> Self {
        Self {
            name: name.into(),
            eye: eye.clone(),
            airframe: airframe(arms),
            vehicles: 1,
            ranges_m: [2.0, 15.0],
            build: Build::default(),
            smear_px: 0.0,
            faults: Vec::new(),
            knows_gravity: true,
            spell: SPELL,
            min_probability: Settings::DEFAULT_MIN_PROBABILITY,
            optics_frames: 0,
        }
    }

    /// Renders, injects, locates with default options but for the least probability, and scores.
    pub(crate) fn run(&self, frames: u64) -> Outcome {
        let mut studio = Studio::new(self);
        let wrong = |seed| Faults { list: self.faults.clone(), seed };
        let told = wrong(0).airframe(&self.airframe).expect("an airframe");
        let camera = calibrated(&self.eye.camera, &self.eye.preset.lens);
        let camera = wrong(0).camera(&camera).expect("a camera");
        let camera = match self.learned() {
            Some(optics) => camera.with_optics(optics),
            None => camera,
        };
        let mut settings = Settings::default();
        settings.min_probability = self.min_probability;
        let mut locator = Locator::new(camera, &told, None, settings).expect("default settings");
        let (mut truth, mut records, mut lights) = (Vec::new(), Vec::new(), Lights::default());
        for first in (0..frames).step_by(self.spell as usize) {
            let numbers = first..frames.min(first + self.spell);
            let (shots, fallen): (Vec<_>, Vec<_>) = numbers.map(|number| studio.shoot(number)).unzip();
            let shots = wrong(first).inject(shots.into_iter().map(Ok));
            for (shot, fallen) in shots.zip(fallen) {
                let Shot { frame, truth: there } = shot.expect("frames of memory");
                let located =
                    locator.locate(Input::frame(&frame.image.view()).gravity(frame.gravity.as_ref()));
                let located = located.expect("the camera's size");
                let mut record = record_of(&frame);
                record.put_located(located, &[told.name()]);
                lights.add(&located.sightings, &record.spots, &fallen);
                records.push(record);
                truth.extend(there);
            }
        }
        let evaluation = evaluate(&truth, &records, &photinus_evaluate::Settings::default());
        Outcome {
            name: self.name.clone(),
            airframe: self.airframe.name().to_owned(),
            frames,
            vehicles: self.vehicles,
            is_as_believed: self.faults.is_empty() || self.spell == 1,
            scores: evaluation.expect("frames of one world").scores,
            lights,
        }
    }

    /// The optics that frames of the camera tell, none of which is located: of LEDs that stand alone, far enough away that not all are full.
    fn learned(&self) -> Option<Optics> {
        let frames = self.optics_frames;
        if frames == 0 {
            return None;
        }
        let shown = Row { airframe: airframe(6), ranges_m: OPTICS_RANGES_M, ..self.clone() };
        let mut studio = Studio::new(&shown);
        let mut collection = Collection::of(&self.eye.camera);
        for number in OTHER_FRAMES..OTHER_FRAMES + frames {
            let (shot, _) = studio.shoot(number);
            assert!(collection.add(&shot.frame.image.view(), None), "frames of one size");
        }
        match learn(&collection) {
            Ok(learned) => Some(learned.optics),
            Err(error) => panic!("{}: {error}", self.name),
        }
    }
}

fn record_of(frame: &Frame) -> FrameRecord {
    FrameRecord {
        frame: Some(frame.index),
        camera: None,
        time_s: frame.time_s,
        latency_s: None,
        tracks: Vec::new(),
        source: String::new(),
        incomplete: false,
        spots: Vec::new(),
        rejected: Vec::new(),
        neighbours: Vec::new(),
    }
}

/// Takes the frames of a row.
struct Studio<'a> {
    row: &'a Row,
    renderer: Renderer,
}

impl<'a> Studio<'a> {
    fn new(row: &'a Row) -> Self {
        let Eye { camera, preset, .. } = &row.eye;
        let view =
            CameraView { camera: camera.clone(), lens: preset.lens.clone(), sensor: preset.sensor.clone() };
        Self { row, renderer: Renderer::new(view, 1) }
    }

    /// A frame with vehicles drawn for its number, and the light that fell.
    fn shoot(&mut self, number: u64) -> (Shot, Vec<Fallen>) {
        let row = self.row;
        let mut rng = Pcg64::new(u128::from(number), 0xfa17);
        let gravity = known_gravity(&mut rng);
        let snapshot = self.snapshot(number, &gravity, &mut rng);
        let mut rendered = self.renderer.render(&snapshot, number);
        let lens = &row.eye.preset.lens;
        to_centroids(&mut rendered.truth, &row.eye.camera, lens);
        let fallen = fallen(&snapshot, &rendered.truth, lens);
        let TruthFrame { frame: index, time_s, .. } = rendered.truth;
        let frame = Frame {
            image: rendered.image,
            index,
            time_s: Some(time_s),
            source: row.name.clone(),
            gravity: row.knows_gravity.then_some(gravity),
            exposure_s: None,
            moved: Moved::default(),
            conversions: Vec::new(),
        };
        (Shot { frame, truth: Some(rendered.truth) }, fallen)
    }

    fn snapshot(&self, number: u64, gravity: &Unit<Vector3<f64>>, rng: &mut Pcg64) -> Snapshot {
        let row = self.row;
        let exposure_s = row.eye.exposure_us * 1e-6;
        let drawing = Drawing {
            airframe: &row.airframe,
            build: row.build,
            camera: &row.eye.camera,
            ranges_m: row.ranges_m,
            exposure_s,
            smear_px: row.smear_px,
        };
        let pose = Isometry3::from_parts(Translation3::identity(), world_from_camera().into());
        Snapshot {
            exposure: self.renderer.view().exposure(number as f64, exposure_s),
            camera: Moving::still(pose),
            vehicles: drawing.vehicles(row.vehicles, gravity, rng),
            emitter: row.eye.preset.emitter,
            daylight: None,
            water: None,
            lamps: Vec::new(),
        }
    }
}
