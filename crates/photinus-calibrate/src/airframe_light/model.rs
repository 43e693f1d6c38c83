//! Lobes, powers and positions -> what a spot must look like, with the derivatives by all of them and by the pose.

use nalgebra::{Matrix3, Matrix3x2, Rotation3, SVector, Unit, Vector2, Vector3};
use photinus::airframe::{Airframe, Led};
use photinus::pose::{LogLight, Pose};

use super::flight::{Frame, Sighting};
use super::shape::{COSINE_SIGMA, Shape};

/// Prior of the logarithm of a power.
pub(super) const POWER_SIGMA: f64 = 0.5;
/// How far an LED is mounted askew, rad per axis.
const ASKEW_RAD: f64 = 1.0 * core::f64::consts::PI / 180.0;
/// How far an LED's intensity may be from its lobe otherwise, 1 being one LED straight ahead.
const LOBE_SIGMA: f64 = 0.004;
/// Nothing is known of how much light an LED gives at 1 m.
const LIGHT_SIGMA: f64 = 100.0;
/// Step of a finite difference in the cosine of an angle.
const COS_STEP: f64 = 1e-5;
/// A marker that is seen shines at least this much towards the camera.
const DARK: f64 = 0.02;
/// A neighbour's tilt against the vertical, rad per axis.
const TILT_SIGMA_RAD: f64 = 5.0 * core::f64::consts::PI / 180.0;

/// A step of a frame: position over distance, turn in the body frame, logarithm of the light of an LED at 1 m.
pub(super) type Own = SVector<f64, 7>;

/// What all frames share.
#[derive(Clone, Debug)]
pub(super) struct Parameters {
    /// Logarithm of the power of each LED.
    pub(super) log_powers: Vec<f64>,
    /// What the airframe's file has it to be.
    pub(super) told_log_powers: Vec<f64>,
    /// The kinds of lobes.
    pub(super) shapes: Vec<Shape>,
    /// How far the axis of each LED is askew, in the plane across it, rad.
    pub(super) askew_rad: Vec<Vector2<f64>>,
    /// Logarithm of the light of an LED of power 1 at 1 m, in the mean over the frames.
    pub(super) log_light: f64,
    /// Where each marker sits against the airframe's file, m.
    pub(super) offsets_m: Vec<Vector3<f64>>,
}

impl Parameters {
    /// How many numbers, in the order powers, lobes, axes, light, offsets.
    pub(super) fn count(&self) -> usize {
        self.first_offset() + 3 * self.offsets_m.len()
    }

    /// Where the axes begin.
    fn first_axis(&self) -> usize {
        self.log_powers.len() + self.shapes.iter().filter_map(Shape::off_told).count()
    }

    /// Which one the light is.
    fn light(&self) -> usize {
        self.first_axis() + 2 * self.askew_rad.len()
    }

    /// Where the offsets begin.
    pub(super) fn first_offset(&self) -> usize {
        self.light() + 1
    }

    /// All of them less what they are thought to be beforehand, with the sigma of that; offsets have `offset_sigma_m`.
    pub(super) fn off_prior(&self, offset_sigma_m: f64) -> Vec<(f64, f64)> {
        let powers =
            self.log_powers.iter().zip(&self.told_log_powers).map(|(log, told)| (log - told, POWER_SIGMA));
        let shapes = self.shapes.iter().filter_map(Shape::off_told).map(|off| (off, COSINE_SIGMA));
        let axes = self.askew_rad.iter().flat_map(|askew_rad| askew_rad.iter().map(|rad| (*rad, ASKEW_RAD)));
        let offsets =
            self.offsets_m.iter().flat_map(|offset_m| offset_m.iter().map(|m| (*m, offset_sigma_m)));
        powers.chain(shapes).chain(axes).chain([(self.log_light, LIGHT_SIGMA)]).chain(offsets).collect()
    }

    /// After a step.
    pub(super) fn moved(&self, step: &[f64]) -> Self {
        let mut next = self.clone();
        let Self { log_powers, shapes, askew_rad, log_light, offsets_m, .. } = &mut next;
        let lobes = shapes.iter_mut().filter_map(|shape| shape.log_power.as_mut());
        let axes = askew_rad.iter_mut().flat_map(|askew_rad| askew_rad.iter_mut());
        let offsets = offsets_m.iter_mut().flat_map(|offset_m| offset_m.iter_mut());
        let all = log_powers.iter_mut().chain(lobes).chain(axes).chain([log_light]).chain(offsets);
        all.zip(step).for_each(|(number, step)| *number += step);
        next
    }
}

/// How far things are from what they are said or thought to be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spread {
    /// Of centres and of light, in the sigmas that are claimed.
    pub(super) scatter: [f64; 2],
    /// Of the light of an LED from frame to frame, as a logarithm.
    pub(super) light_sigma: f64,
    /// Of the markers' positions, m.
    pub(super) offset_sigma_m: f64,
}

/// What a number of a residual is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Bearing,
    Light,
    /// What is thought of the frame beforehand.
    Prior,
}

/// A residual of unit variance, with its derivatives.
pub(super) struct Row {
    pub(super) kind: Kind,
    pub(super) residual: f64,
    pub(super) by_own: Own,
    /// By what all frames share: number and derivative.
    pub(super) by_shared: Vec<(usize, f64)>,
}

/// The airframe as the parameters have it.
pub(super) struct Model<'a> {
    airframe: Airframe,
    parameters: &'a Parameters,
    /// By LED: the plane across its axis.
    across: Vec<Matrix3x2<f64>>,
    /// By LED: which shape it has, and which of the parameters is its power of the cosine.
    shape_of: Vec<(usize, usize)>,
}

impl<'a> Model<'a> {
    /// `None` for parameters that no airframe has.
    pub(super) fn new(nominal: &Airframe, parameters: &'a Parameters) -> Option<Self> {
        let mut leds: Vec<Led> = nominal.leds().to_vec();
        let mut shape_of = vec![(0, 0); leds.len()];
        let mut first = leds.len();
        for (number, shape) in parameters.shapes.iter().enumerate() {
            let lobe = shape.lobe();
            for &led in &shape.leds {
                leds[led].lobe = lobe.clone();
                shape_of[led] = (number, first);
            }
            first += usize::from(shape.log_power.is_some());
        }
        let across: Vec<Matrix3x2<f64>> = leds.iter().map(|led| plane_across(&led.axis)).collect();
        for (number, led) in leds.iter_mut().enumerate() {
            led.power = libm::exp(parameters.log_powers[number]);
            led.axis =
                Unit::new_normalize(led.axis.into_inner() + across[number] * parameters.askew_rad[number]);
        }
        let airframe = Airframe::new(nominal.name(), leds).ok()?;
        Some(Self { airframe, parameters, across, shape_of })
    }

    /// All that a frame says.
    pub(super) fn rows(&self, frame: &Frame, Spread { scatter, light_sigma, .. }: &Spread) -> Vec<Row> {
        let mut rows = Vec::with_capacity(3 * frame.sightings.len() + 2);
        for sighting in &frame.sightings {
            rows.extend(self.bearing(frame, sighting, scatter[0]));
            rows.extend(
                sighting.log_light.map(|light| self.light(frame, sighting.marker, light, scatter[1])),
            );
        }
        rows.extend(attitude(frame));
        rows.push(Row {
            kind: Kind::Prior,
            residual: (frame.log_light - self.parameters.log_light) / light_sigma,
            by_own: own(Vector3::zeros(), Vector3::zeros(), 1.0 / light_sigma),
            by_shared: vec![(self.parameters.light(), -1.0 / light_sigma)],
        });
        rows
    }

    fn bearing(&self, frame: &Frame, sighting: &Sighting, scatter: f64) -> [Row; 2] {
        let Sighting { marker, direction, map, .. } = sighting;
        let Pose { position_m, camera_from_body } = &frame.pose;
        let at_m = self.airframe.markers()[*marker].position_m + self.parameters.offsets_m[*marker];
        let place_m = camera_from_body * at_m + position_m;
        let range_m = place_m.norm();
        let seen = place_m / range_m;
        let residual = map * (seen - direction) / scatter;
        let by_place = map * (Matrix3::identity() - seen * seen.transpose()) / (range_m * scatter);
        let by_offset = by_place * camera_from_body.matrix();
        let distance_m = position_m.norm();
        let first = self.parameters.first_offset() + 3 * marker;
        [0, 1].map(|axis| {
            let in_body = by_offset.row(axis).transpose();
            let turn = at_m.cross(&in_body);
            Row {
                kind: Kind::Bearing,
                residual: residual[axis],
                by_own: own(by_place.row(axis).transpose() * distance_m, turn, 0.0),
                by_shared: (0..3).map(|part| (first + part, in_body[part])).collect(),
            }
        })
    }

    fn light(&self, frame: &Frame, marker: usize, seen: LogLight, scatter: f64) -> Row {
        let camera_m = frame.pose.camera_in_body_m();
        let (intensity, gradient) = match self.airframe.intensity_with_gradient(marker, &camera_m) {
            (intensity, gradient) if intensity > DARK => (intensity, gradient),
            // What is seen shines: a lobe that leaves it dark must not be the cheaper for it.
            _ => (DARK, Vector3::zeros()),
        };
        let from_marker_m = camera_m - self.airframe.markers()[marker].position_m;
        let range2_m2 = from_marker_m.norm_squared();
        let by_camera = gradient / intensity - from_marker_m * (2.0 / range2_m2);
        let sigma = libm::hypot(seen.sigma * scatter, LOBE_SIGMA / intensity);
        let expected = frame.log_light + libm::log(intensity) - libm::log(range2_m2);
        // The camera in the body frame moves by -R' distance delta, and by c x omega.
        let by_delta = frame.pose.camera_from_body * by_camera * -frame.pose.position_m.norm();
        let by_omega = by_camera.cross(&camera_m);
        let mut by_shared = Vec::new();
        for &led in &self.airframe.markers()[marker].leds {
            let shining = &self.airframe.leds()[led];
            let share = shining.intensity(&camera_m) / intensity;
            by_shared.push((led, share / sigma));
            let ray_m = camera_m - shining.position_m;
            let towards = ray_m / ray_m.norm();
            let cos = shining.axis.dot(&towards);
            let lobe = |cos: f64| shining.power * shining.lobe.intensity(cos) / (intensity * sigma);
            let by_cos = (lobe(cos + COS_STEP) - lobe(cos - COS_STEP)) / (2.0 * COS_STEP);
            let by_axis = self.across[led].transpose() * (towards - *shining.axis * cos) * by_cos;
            let first = self.parameters.first_axis() + 2 * led;
            by_shared.extend([(first, by_axis.x), (first + 1, by_axis.y)]);
            let (shape, number) = self.shape_of[led];
            let shape = &self.parameters.shapes[shape];
            if shape.log_power.is_some() && cos > 0.0 {
                by_shared.push((number, share * shape.slope(cos) / sigma));
            }
        }
        Row {
            kind: Kind::Light,
            residual: (expected - seen.value) / sigma,
            by_own: own(by_delta / sigma, by_omega / sigma, 1.0 / sigma),
            by_shared,
        }
    }
}

/// Two directions across an axis.
fn plane_across(axis: &Vector3<f64>) -> Matrix3x2<f64> {
    let aside = if axis.z.abs() < 0.7 { Vector3::z() } else { Vector3::x() };
    let across = axis.cross(&aside).normalize();
    Matrix3x2::from_columns(&[across, axis.cross(&across)])
}

fn own(by_delta: Vector3<f64>, by_omega: Vector3<f64>, by_light: f64) -> Own {
    Own::from_column_slice(&[
        by_delta.x, by_delta.y, by_delta.z, by_omega.x, by_omega.y, by_omega.z, by_light,
    ])
}

/// How far the body is from level, where gravity is known.
fn attitude(frame: &Frame) -> impl Iterator<Item = Row> {
    let up = frame.up.map(|up| frame.pose.camera_from_body.inverse() * up.into_inner());
    up.into_iter().flat_map(|up| {
        // d(exp(-omega) up) = up x omega.
        let by_turn = up.cross_matrix() / TILT_SIGMA_RAD;
        [0, 1].map(|axis| Row {
            kind: Kind::Prior,
            residual: up[axis] / TILT_SIGMA_RAD,
            by_own: own(Vector3::zeros(), by_turn.row(axis).transpose(), 0.0),
            by_shared: Vec::new(),
        })
    })
}

/// A frame after a step.
pub(super) fn moved(frame: &Frame, step: &Own) -> Frame {
    let Pose { position_m, camera_from_body } = frame.pose;
    let (delta, omega) = (step.fixed_rows::<3>(0), step.fixed_rows::<3>(3));
    let pose = Pose {
        position_m: position_m + position_m.norm() * delta,
        camera_from_body: camera_from_body * Rotation3::new(omega.into_owned()),
    };
    Frame { pose, log_light: frame.log_light + step[6], ..frame.clone() }
}
