//! Located frames, one neighbour in each -> which spot is which marker, with its light where that can be trusted.
//!
//! A symmetric airframe looks the same in several turns: from frame to frame it is the one in which every marker goes on where it
//! went ([`Trail`]). Where the neighbour was lost in between, a new track begins; how tracks are turned against each other is told
//! by light.

use nalgebra::{Matrix2x3, Rotation3, Unit, Vector3};
use photinus::airframe::Airframe;
use photinus::locator::{self, Located, Settings};
use photinus::pose::{LogLight, Pose, Symmetry};

use super::trail::Trail;

/// The light of a spot is its marker's alone when no other marker or spot is as near, px.
const ALONE_PX: f64 = 7.0;
/// Markers this near in the image, px, pull each other's centres.
const APART_PX: f64 = 4.0;
/// A spot is a marker when it is no farther from it, in sigma, with markers this far off, m.
const GATE_SIGMAS: f64 = 6.0;
const GATE_M: f64 = 0.005;
/// Spread of the logarithm of light where lobes and powers are not known.
const UNKNOWN_UNIT_SIGMA: f64 = 0.5;
/// Nothing is known of a direction to better, rad.
const LEAST_RAD: f64 = 1e-6;

/// A marker as one frame shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Sighting {
    /// Which marker.
    pub marker: usize,
    /// Direction in the camera frame, a unit vector.
    pub direction: Vector3<f64>,
    /// The map that makes an error of the direction one of unit covariance.
    pub map: Matrix2x3<f64>,
    /// Logarithm of its light; `None` where it is not its own, or saturated.
    pub log_light: Option<LogLight>,
}

/// A neighbour in one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Where it is, at first as it was located.
    pub pose: Pose,
    /// Away from the ground, camera frame, where that is known.
    pub up: Option<Unit<Vector3<f64>>>,
    /// Its markers.
    pub sightings: Vec<Sighting>,
    /// Logarithm of the light of an LED of power 1 at 1 m.
    pub log_light: f64,
}

impl Frame {
    /// How many of its markers have a light of their own.
    pub fn lights(&self) -> usize {
        self.sightings.iter().filter(|seen| seen.log_light.is_some()).count()
    }

    /// Whether bearings, light and gravity tell more than the pose and how bright an LED is.
    fn tells(&self) -> bool {
        2 * self.sightings.len() + self.lights() + if self.up.is_some() { 2 } else { 0 } > 7
    }
}

/// A recording of one neighbour.
#[derive(Clone, Debug)]
pub struct Flight {
    airframe: Airframe,
    turns: usize,
    /// By turn, then marker: the marker whose place it takes.
    turned: Vec<Vec<usize>>,
    tracks: Vec<Vec<Frame>>,
    trail: Trail,
    not_alone: usize,
}

impl Flight {
    /// Nothing yet, of a neighbour that was located as this airframe.
    pub fn new(airframe: &Airframe) -> Self {
        let turns = Symmetry::of(airframe).turns();
        let markers = airframe.markers();
        let nearest = |place_m: Vector3<f64>| {
            let gap = |marker: &usize| (markers[*marker].position_m - place_m).norm_squared();
            (0..markers.len()).min_by(|a, b| gap(a).total_cmp(&gap(b))).unwrap_or(0)
        };
        let turned = |turn| {
            let rotation = about_z(turns, turn);
            markers.iter().map(|marker| nearest(rotation * marker.position_m)).collect()
        };
        let turned = (0..turns).map(turned).collect();
        Self {
            airframe: airframe.clone(),
            turns,
            turned,
            tracks: Vec::new(),
            trail: Trail::default(),
            not_alone: 0,
        }
    }

    /// Frames whose markers are known otherwise. In each track a symmetric airframe is named in one turn.
    pub fn of_tracks(airframe: &Airframe, tracks: Vec<Vec<Frame>>) -> Self {
        Self { tracks, ..Self::new(airframe) }
    }

    /// Settings to locate with, when lobes and powers are not known: brightness hardly counts, and an airframe that is not as it is told is told as well.
    pub fn settings(mut settings: Settings) -> Settings {
        settings.pose.unit_sigma = UNKNOWN_UNIT_SIGMA;
        settings.min_probability = 0.0;
        settings
    }

    /// The airframe as it was located.
    pub fn airframe(&self) -> &Airframe {
        &self.airframe
    }

    /// Frames that count, by track.
    pub fn tracks(&self) -> &[Vec<Frame>] {
        &self.tracks
    }

    /// How many turns look the same.
    pub fn turns(&self) -> usize {
        self.turns
    }

    /// How many frames had no neighbour or several.
    pub fn not_alone(&self) -> usize {
        self.not_alone
    }

    /// Adds what was located in the next frame. `gravity` is down in the camera frame, where it is known.
    pub fn add(&mut self, located: &Located, gravity: Option<&Unit<Vector3<f64>>>, time_s: f64) {
        let [neighbour] = located.neighbours.as_slice() else {
            self.not_alone += 1;
            return;
        };
        let Some(mode) = neighbour.modes.first() else { return };
        let members: Vec<&locator::Sighting> =
            neighbour.sightings.iter().map(|&member| &located.sightings[member]).collect();
        let sightings = self.sightings(&mode.pose, &members, &located.sightings);
        if sightings.len() < 2 {
            return;
        }
        let log_light = self.log_light(&mode.pose, &sightings);
        let frame = Frame { pose: mode.pose, up: gravity.map(|down| -*down), sightings, log_light };
        let turn = self.trail.turn(time_s, self.turns, &|turn| self.turned(&frame, turn).sightings);
        // What looks like nothing else but itself needs no following.
        if self.tracks.is_empty() || turn.is_none() && self.turns > 1 {
            self.tracks.push(Vec::new());
        }
        let frame = self.turned(&frame, turn.unwrap_or(0));
        self.trail.go_on(time_s, &frame.sightings);
        if let Some(track) = self.tracks.last_mut().filter(|_| frame.tells()) {
            track.push(frame);
        }
    }

    /// A frame, its neighbour in another turn that looks the same.
    pub(super) fn turned(&self, frame: &Frame, turn: usize) -> Frame {
        let camera_from_body = frame.pose.camera_from_body * about_z(self.turns, turn).inverse();
        let sightings = frame.sightings.iter().map(|seen| {
            let marker = self.turned[turn][seen.marker];
            Sighting { marker, ..seen.clone() }
        });
        Frame {
            pose: Pose { camera_from_body, ..frame.pose },
            sightings: sightings.collect(),
            ..frame.clone()
        }
    }

    fn sightings(
        &self,
        pose: &Pose,
        members: &[&locator::Sighting],
        all: &[locator::Sighting],
    ) -> Vec<Sighting> {
        let camera_m = pose.camera_in_body_m();
        let place_m = |marker: usize| {
            pose.camera_from_body * self.airframe.markers()[marker].position_m + pose.position_m
        };
        let shining: Vec<(usize, Vector3<f64>)> =
            self.airframe.visible(camera_m).map(|marker| (marker, place_m(marker).normalize())).collect();
        let mut found: Vec<Sighting> = Vec::new();
        for member in members {
            let direction = *member.bearing.vector();
            let gap_rad = |other: &Vector3<f64>| (other - direction).norm();
            let nearest = shining.iter().min_by(|a, b| gap_rad(&a.1).total_cmp(&gap_rad(&b.1)));
            let Some(&(marker, expected)) = nearest else { continue };
            let sigma_rad = (member.spot_covariance_rad2.trace() / 2.0).sqrt();
            let gate_rad = libm::hypot(GATE_SIGMAS * sigma_rad, GATE_M / place_m(marker).norm());
            let nearer_px = |directions: &mut dyn Iterator<Item = Vector3<f64>>| {
                directions.map(|other| gap_rad(&other)).fold(f64::INFINITY, f64::min) / member.rad_per_px
            };
            let markers_px =
                nearer_px(&mut shining.iter().filter(|other| other.0 != marker).map(|other| other.1));
            let others = all.iter().filter(|other| !core::ptr::eq(*other, *member));
            let spots_px = nearer_px(&mut others.map(|other| *other.bearing.vector()));
            let is_taken = found.iter().any(|seen| seen.marker == marker);
            if is_taken || gap_rad(&expected) > gate_rad || markers_px < APART_PX {
                continue;
            }
            let has_own_light = member.spot.saturated_px == 0 && markers_px.min(spots_px) > ALONE_PX;
            found.push(Sighting {
                marker,
                direction,
                map: whitening(&direction, member),
                log_light: member.log_light.filter(|_| has_own_light),
            });
        }
        found
    }

    /// Logarithm of the light of an LED at 1 m, on average over the spots.
    fn log_light(&self, pose: &Pose, sightings: &[Sighting]) -> f64 {
        let camera_m = pose.camera_in_body_m();
        let (mut sum, mut count) = (0.0, 0.0);
        for (marker, light) in sightings.iter().filter_map(|seen| Some((seen.marker, seen.log_light?))) {
            let range2_m2 = (camera_m - self.airframe.markers()[marker].position_m).norm_squared();
            let intensity = self.airframe.intensity(marker, &camera_m).max(0.05);
            sum += light.value + libm::log(range2_m2 / intensity);
            count += 1.0;
        }
        sum / f64::max(count, 1.0)
    }
}

/// A turn of an airframe about its z axis.
fn about_z(turns: usize, turn: usize) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Vector3::z_axis(), core::f64::consts::TAU * turn as f64 / turns as f64)
}

/// The inverse of the Cholesky factor of the covariance across the direction.
fn whitening(direction: &Vector3<f64>, sighting: &locator::Sighting) -> Matrix2x3<f64> {
    let aside = if direction.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() };
    let across = direction.cross(&aside).normalize();
    let along = direction.cross(&across);
    let entry = |a: &Vector3<f64>, b: &Vector3<f64>| a.dot(&(sighting.spot_covariance_rad2 * b));
    let least = LEAST_RAD * LEAST_RAD;
    let (xx, xy, yy) =
        (entry(&across, &across).max(least), entry(&across, &along), entry(&along, &along).max(least));
    let first = xx.sqrt();
    let below = xy / first;
    let second = (yy - below * below).max(least).sqrt();
    let row = across / first;
    Matrix2x3::from_rows(&[row.transpose(), ((along - row * below) / second).transpose()])
}
