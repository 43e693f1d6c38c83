//! Markers so near to each other in the image that their light is one spot, or nearly.
//!
//! Gaps are in units of the detector's resolution, at which two markers are told apart half of the time. One that has no
//! spot of its own shines into the window of a spot beside it and pulls its centre; the window of a centre is that of
//! [`crate::spots`],
//!
//! ```text
//! w = (1 - gap^2 / window^2)^2,   at = sum(w I p) / sum(w I).
//! ```
//!
//! Resolution and window were measured on rendered frames of two markers at gaps of 0 to 8 px: told apart in 0, 10, 42, 60,
//! 68, 88, 95 % at 1.2, 1.8, 2.2, 2.8, 3.2, 3.8, 4.8 px, and the pull within 0.01 px of this on average.

use nalgebra::{Matrix3, Vector3};

use super::problem::{Pose, Problem};

/// Radius of the window in resolutions.
const WINDOW: f64 = 1.32;
/// Beyond so many resolutions markers have nothing to do with each other.
const FAR: f64 = 2.0;
/// How much farther than a pose markers are looked from to tell whether any melt near it.
const ROOM: f64 = 1.5;

/// How likely two markers at a squared gap are one spot: the odds fall with the sixth power of the gap, to nothing at
/// [`FAR`].
pub(super) fn one_spot(gap2: f64) -> f64 {
    // No resolution is no number, and far.
    if gap2.is_nan() {
        return 0.0;
    }
    let even = |gap2: f64| 1.0 / (1.0 + gap2 * gap2 * gap2);
    let least = even(FAR * FAR);
    (even(gap2) - least).max(0.0) / (1.0 - least)
}

/// Where the light of a spot comes from, as far as its centre tells.
pub(super) struct LightCentre {
    /// In the body frame, m.
    pub(super) at_m: Vector3<f64>,
    /// Its derivative by the camera's place in the body frame.
    pub(super) by_camera: Matrix3<f64>,
    /// How much surer the direction of a lone marker is: a factor on the residual.
    pub(super) factor: f64,
}

/// A marker without a spot of its own that may shine into that of another.
struct Beside {
    place_m: Vector3<f64>,
    /// Its share in the window, and its derivative by the camera's place, 1/m.
    window: f64,
    window_gradient: Vector3<f64>,
    intensity: f64,
    intensity_gradient: Vector3<f64>,
}

impl Problem<'_> {
    /// Squared gap of two markers in the image over the resolution of a spot, for a camera at a place in the body frame, with
    /// its derivative by that place, 1/m; `None` where they are far apart.
    fn gap2(&self, spot: usize, a: usize, b: usize, camera_m: &Vector3<f64>) -> Option<(f64, Vector3<f64>)> {
        let [a_m, b_m] = [a, b].map(|marker| self.airframe.markers()[marker].position_m);
        let (between_m, ray_m) = (b_m - a_m, camera_m - a_m);
        let range2_m2 = ray_m.norm_squared();
        let resolution2 = self.observations[spot].resolution_rad * self.observations[spot].resolution_rad;
        let along = between_m.dot(&ray_m);
        let across = between_m.norm_squared() * range2_m2 - along * along;
        let scale = 1.0 / (range2_m2 * range2_m2 * resolution2);
        let gap2 = across * scale;
        // No resolution, or no range, is no number, and far.
        if gap2.is_nan() || gap2 >= FAR * FAR {
            return None;
        }
        let slope = ray_m * (2.0 * between_m.norm_squared())
            - between_m * (2.0 * along)
            - ray_m * (4.0 * across / range2_m2);
        Some((gap2.max(0.0), slope * scale))
    }

    /// How likely the detector makes one spot of two markers.
    pub(super) fn melted(&self, spot: usize, seen: usize, other: usize, camera_m: &Vector3<f64>) -> f64 {
        self.gap2(spot, seen, other, camera_m).map_or(0.0, |(gap2, _)| one_spot(gap2))
    }

    /// Whether any marker may melt into a spot, anywhere near a pose.
    pub(super) fn may_melt(&self, pose: &Pose) -> bool {
        let camera_m = pose.camera_in_body_m() * ROOM;
        let near = |(spot, seen)| {
            let mut others = (0..self.airframe.markers().len()).filter(|&other| other != seen);
            others.any(|other| self.gap2(spot, seen, other, &camera_m).is_some())
        };
        self.used().any(near)
    }

    /// Markers without spots of their own in the window of a spot.
    fn beside(&self, spot: usize, seen: usize, camera_m: Vector3<f64>) -> impl Iterator<Item = Beside> + '_ {
        let others = if self.melting { 0..self.airframe.markers().len() } else { 0..0 };
        others.filter(move |&other| other != seen && !self.is_used(other)).filter_map(move |other| {
            let (gap2, gap2_gradient) = self.gap2(spot, seen, other, &camera_m)?;
            let room = 1.0 - gap2 / (WINDOW * WINDOW);
            let (intensity, intensity_gradient) = self.airframe.intensity_with_gradient(other, &camera_m);
            (room > 0.0 && intensity > 0.0).then(|| Beside {
                place_m: self.airframe.markers()[other].position_m,
                window: room,
                window_gradient: gap2_gradient * (-1.0 / (WINDOW * WINDOW)),
                intensity,
                intensity_gradient,
            })
        })
    }

    /// Where the light of a spot comes from: its marker, with those that shine into its window.
    pub(super) fn light_centre(&self, spot: usize, marker: usize, camera_m: &Vector3<f64>) -> LightCentre {
        let alone_m = self.airframe.markers()[marker].position_m;
        let mut centre = LightCentre { at_m: alone_m, by_camera: Matrix3::zeros(), factor: 1.0 };
        let mut beside = self.beside(spot, marker, *camera_m).peekable();
        if beside.peek().is_none() {
            return centre;
        }
        let (own, own_gradient) = self.airframe.intensity_with_gradient(marker, camera_m);
        // A marker that hardly shines is no middle of a spot, but it keeps the others' light from being the whole of it.
        let (mut total, mut pull_m) = (own.max(1e-3), Vector3::zeros());
        let mut total_gradient = if own > 1e-3 { own_gradient } else { Vector3::zeros() };
        let mut pull_by_camera = Matrix3::zeros();
        let mut unsure_m2 = 0.0;
        // Units of LEDs differ, and so does their share.
        let unit = self.settings.unit_sigma * core::f64::consts::SQRT_2;
        for Beside { place_m, window, window_gradient, intensity, intensity_gradient } in beside {
            let (weight, off_m) = (window * window, place_m - alone_m);
            let light = weight * intensity;
            let gradient = intensity_gradient * weight + window_gradient * (2.0 * window * intensity);
            total += light;
            total_gradient += gradient;
            pull_m += off_m * light;
            pull_by_camera += off_m * gradient.transpose();
            // Spots differ in their windows: what is at the edge of one is within another.
            let unsure = (1.0 - weight) * (1.0 - weight) + unit * unit;
            unsure_m2 += unsure * off_m.norm_squared() * light * light;
        }
        let off_m = pull_m / total;
        centre.at_m += off_m;
        centre.by_camera = (pull_by_camera - off_m * total_gradient.transpose()) / total;
        let sigma2_rad2 = self.observations[spot].variance_rad2();
        let unsure_rad2 = unsure_m2 / (total * total * camera_m.norm_squared());
        centre.factor = (sigma2_rad2 / (sigma2_rad2 + unsure_rad2)).sqrt();
        centre
    }

    /// The light of a spot, 1 being one LED straight ahead, with its derivative by the camera's place in the body frame, 1/m:
    /// its marker's, with that of those that shine into its window.
    pub(super) fn light(&self, spot: usize, marker: usize, camera_m: &Vector3<f64>) -> (f64, Vector3<f64>) {
        let own = self.airframe.intensity_with_gradient(marker, camera_m);
        self.beside(spot, marker, *camera_m).fold(own, |(light, gradient), beside| {
            let more = beside.intensity_gradient * beside.window + beside.window_gradient * beside.intensity;
            (light + beside.window * beside.intensity, gradient + more)
        })
    }
}
