//! A neighbour somewhere -> its markers as the camera gets them: where they fall, their light, which are likely to make spots.

use core::f64::consts::TAU;

use nalgebra::{Rotation3, Vector3};
use photinus::airframe::Airframe;
use photinus::camera::{Bearing, Pixel};
use photinus::pose::{Pose, Settings};
use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rand_pcg::Pcg64;

use crate::setup::Setup;
use crate::spot::{Spot, SpotTable};

/// Markers nearer to each other than this make one spot, px: the gap at which the detector tells two apart half of the time
/// (`photinus::pose`).
pub(crate) const RESOLUTION_PX: f64 = 2.5;
/// Light so near to a spot's marker pulls its centre, px: the detector's window (`photinus::pose`).
const WINDOW_PX: f64 = 1.32 * RESOLUTION_PX;

/// Spots with other light nearer than this, px, have centres that are known to no better than that, px: what the detector claims of such
/// spots on rendered frames (0.07 to 0.1), whether the other is a spot of its own or not.
const CROWDED_WITHIN_PX: f64 = 2.0 * RESOLUTION_PX;
const CROWDED_PX: f64 = 0.08;

/// One way to stand and to be built, whatever the distance.
#[derive(Clone, Debug)]
pub(crate) struct Draw {
    /// Direction, camera frame.
    ahead: Vector3<f64>,
    camera_from_body: Rotation3<f64>,
    /// Light of each marker against the drawing's.
    powers: Vec<f64>,
    /// A marker is found whose chance is more than this, 0 to 1.
    pub(crate) luck: Vec<f64>,
    /// A marker is one spot with a brighter one beside it whose chance of that is more than this, 0 to 1.
    merging: Vec<f64>,
}

/// Ways to stand: any heading, within the view, tilted as robots tilt.
#[derive(Clone, Debug)]
pub struct Draws(pub(crate) Vec<Draw>);

/// A marker in the image that has a spot to itself.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lit {
    pub(crate) marker: usize,
    pub(crate) place: Pixel,
    /// Where its light comes from, camera frame, m: with markers that are one spot with it, the middle of their light.
    pub(crate) centre_m: Vector3<f64>,
    pub(crate) electrons: f64,
    pub(crate) spot: Spot,
}

/// What the camera gets of a neighbour.
#[derive(Clone, Debug)]
pub struct View {
    pub(crate) pose: Pose,
    pub(crate) lit: Vec<Lit>,
}

impl Draw {
    /// Level and straight ahead, at a heading.
    pub(crate) fn level(yaw_rad: f64, markers: usize) -> Self {
        Self {
            ahead: Vector3::z(),
            camera_from_body: upright() * Rotation3::from_axis_angle(&Vector3::z_axis(), yaw_rad),
            powers: vec![1.0; markers],
            luck: vec![0.5; markers],
            merging: vec![0.5; markers],
        }
    }
}

impl Draws {
    /// So many, the same whenever it is asked.
    pub fn new(setup: &Setup, count: usize) -> Self {
        // the golden ratio spreads headings evenly, however many there are
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let mut random = Pcg64::new(0x97a4, 0x1eaf);
        let tilt_rad = Settings::default().tilt_sigma_rad;
        let markers = setup.airframe.markers().len();
        let mut draw = |index: usize| {
            let mut uniform = || -> f64 { StandardUniform.sample(&mut random) };
            let azimuth_rad = (2.0 * uniform() - 1.0) * setup.watch.azimuth_rad;
            let elevation_rad = (2.0 * uniform() - 1.0) * setup.watch.elevation_rad;
            let luck = (0..markers).map(|_| uniform()).collect();
            let merging = (0..markers).map(|_| uniform()).collect();
            let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
            let tilt = Vector3::new(normal(), 0.0, normal()) * tilt_rad;
            let powers = (0..markers).map(|_| setup.emitter.unit_factor(normal())).collect();
            let ((sin, cos), (sin_up, cos_up)) = (libm::sincos(azimuth_rad), libm::sincos(elevation_rad));
            let yaw = Rotation3::from_axis_angle(&Vector3::z_axis(), TAU * index as f64 * GOLDEN);
            Draw {
                ahead: Vector3::new(sin * cos_up, -sin_up, cos * cos_up),
                camera_from_body: Rotation3::new(tilt) * upright() * yaw,
                powers,
                luck,
                merging,
            }
        };
        Self((0..count).map(&mut draw).collect())
    }
}

/// camera_from_body of a level body that looks to the camera's right.
fn upright() -> Rotation3<f64> {
    Rotation3::from_basis_unchecked(&[Vector3::x(), Vector3::z(), -Vector3::y()])
}

impl Lit {
    fn gap_px(&self, other: &Self) -> f64 {
        libm::hypot(other.place.u - self.place.u, other.place.v - self.place.v)
    }

    /// Whether a fainter one beside it is one spot with it. The odds fall with the sixth power of the gap (`photinus::pose`).
    fn merges(&self, fainter: &Self, luck: f64) -> bool {
        let even = libm::pow(1.0 / luck.max(1e-9) - 1.0, 1.0 / 6.0);
        self.gap_px(fainter) < RESOLUTION_PX * even
    }

    /// Adds the light of a fainter one, as far as it is in the window.
    fn take(&mut self, fainter: &Self) {
        let window = 1.0 - self.gap_px(fainter) * self.gap_px(fainter) / (WINDOW_PX * WINDOW_PX);
        if window > 0.0 {
            let pull = window * window * fainter.electrons;
            self.centre_m += (fainter.centre_m - self.centre_m) * (pull / (self.electrons + pull));
            self.electrons += window * fainter.electrons;
        }
    }
}

impl View {
    /// What the camera gets of an airframe that stands like this, so far away.
    pub(crate) fn new(
        setup: &Setup,
        table: &SpotTable,
        airframe: &Airframe,
        draw: &Draw,
        distance_m: f64,
    ) -> Self {
        let pose = Pose { position_m: draw.ahead * distance_m, camera_from_body: draw.camera_from_body };
        let camera_m = pose.camera_in_body_m();
        let light = |(marker, power): (usize, &f64)| {
            let centre_m = pose.camera_from_body * airframe.markers()[marker].position_m + pose.position_m;
            let bearing = Bearing::new(centre_m)?;
            let place = setup.camera.pixel(&bearing)?;
            let intensity = airframe.intensity(marker, &camera_m) * power;
            let electrons = setup.electrons(intensity, centre_m.norm(), bearing.off_axis_rad());
            (electrons > 0.0).then_some(Lit { marker, place, centre_m, electrons, spot: table.at(electrons) })
        };
        let mut lights: Vec<Lit> =
            draw.powers.iter().take(airframe.markers().len()).enumerate().filter_map(light).collect();
        lights.sort_by(|a, b| b.electrons.total_cmp(&a.electrons));
        let mut lit: Vec<Lit> = Vec::with_capacity(lights.len());
        for light in &lights {
            match lit.iter_mut().find(|brighter| brighter.merges(light, draw.merging[light.marker])) {
                Some(brighter) => brighter.take(light),
                None => lit.push(*light),
            }
        }
        for spot in &mut lit {
            let is_other =
                |light: &Lit| light.marker != spot.marker && spot.gap_px(light) < CROWDED_WITHIN_PX;
            let is_crowded = lights.iter().any(is_other);
            spot.spot = table.at(spot.electrons);
            spot.spot.variance_px2 += if is_crowded { CROWDED_PX * CROWDED_PX } else { 0.0 };
        }
        Self { pose, lit }
    }

    /// How likely one spot at least is found, and two at least.
    pub(crate) fn found(&self) -> [f64; 2] {
        let (mut none, mut one) = (1.0, 0.0);
        for lit in &self.lit {
            one = one * (1.0 - lit.spot.found) + none * lit.spot.found;
            none *= 1.0 - lit.spot.found;
        }
        [1.0 - none, 1.0 - none - one]
    }

    /// The markers that are found with this luck.
    pub(crate) fn seen(&self, luck: &[f64]) -> Vec<Lit> {
        self.lit.iter().filter(|lit| luck[lit.marker] < lit.spot.found).copied().collect()
    }
}
