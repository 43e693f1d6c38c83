//! Markers so near to each other in the image that their light is one spot, or nearly.
//!
//! Gaps are in units of the detector's resolution, at which two markers are told apart half of the time. One that has no
//! spot of its own shines into the window of a spot beside it and pulls its centre; the window is that of [`crate::spots`],
//! and stands where the centre comes to be, not where the brighter marker is:
//!
//! ```text
//! at = sum(w I p) / sum(w I),   w = (1 - |p - at|^2 / window^2)^2.
//! ```
//!
//! The centre is followed from that of all the light towards this fixed point. Two markers of one light are one spot in their
//! middle, as far apart as they may be; a faint one far out leaves a bright one where it is. That one without a spot is dark instead is another mode
//! ([`super::estimator`]): from the one to the other there is no way downhill.
//!
//! Resolution was measured on rendered frames of two markers at gaps of 0 to 8 px: told apart in 0, 10, 42, 60,
//! 68, 88, 95 % at 1.2, 1.8, 2.2, 2.8, 3.2, 3.8, 4.8 px. Pairs of one light that were one spot had its centre at 0.44 to 0.47 of
//! their gap, from 1 to 4.5 px.

use nalgebra::{Matrix3, Vector3};

use super::problem::{Merging, Pose, Problem};
use crate::airframe::{Airframe, Marker};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// Radius of the window in resolutions.
const WINDOW: f64 = 1.32;
/// Beyond this many resolutions markers have nothing to do with each other.
pub(super) const FAR: f64 = 2.0;
/// The window is moved so often to where the centre is.
const MOVES: usize = 3;
/// Lights that are kept while a centre is followed; more are worked out again each time.
const KEPT: usize = 8;
/// How much farther than a pose markers are looked from to tell whether any merge near it.
const ROOM: f64 = 1.5;

/// How likely two markers at a squared gap are one spot: the odds fall with the sixth power of the gap, to nothing at
/// [`FAR`].
pub(super) fn one_spot(gap2: f64) -> f64 {
    // No resolution is no number, and far.
    if gap2.is_nan() || gap2 >= FAR * FAR {
        return 0.0;
    }
    let even = |gap2: f64| 1.0 / (1.0 + gap2 * gap2 * gap2);
    let least = even(FAR * FAR);
    (even(gap2) - least) / (1.0 - least)
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

/// What a spot shows of the markers in its window.
pub(super) struct Shining {
    pub(super) spot: usize,
    pub(super) marker: usize,
    /// The camera that sees it, in the body frame, m.
    pub(super) camera_m: Vector3<f64>,
    pub(super) centre: LightCentre,
    /// Their light, 1 being one LED straight ahead, with its derivative by the camera's place in the body frame, 1/m.
    pub(super) intensity: f64,
    pub(super) intensity_gradient: Vector3<f64>,
}

/// Markers without a spot of their own that shine, a bit each.
#[derive(Clone, Copy, Default)]
pub(super) struct Unseen([u64; Airframe::MAX_LEDS / 64]);

impl Unseen {
    fn add(&mut self, marker: usize) {
        self.0[marker / 64] |= 1 << (marker % 64);
    }

    fn remove(&mut self, marker: usize) {
        self.0[marker / 64] &= !(1 << (marker % 64));
    }

    /// From the first to the last.
    fn each(self) -> impl Iterator<Item = usize> {
        self.0.into_iter().enumerate().filter(|(_, bits)| *bits != 0).flat_map(|(word, bits)| {
            let left =
                core::iter::successors(Some(bits), |bits| Some(bits & (bits - 1)).filter(|left| *left != 0));
            left.map(move |bits| 64 * word + bits.trailing_zeros() as usize)
        })
    }
}

/// A marker without a spot of its own that may shine into that of another.
#[derive(Clone, Copy)]
struct Beside {
    place_m: Vector3<f64>,
    intensity: f64,
    intensity_gradient: Vector3<f64>,
}

/// A place in the body frame, with its derivative by the camera's place.
#[derive(Clone, Copy)]
struct Place {
    at_m: Vector3<f64>,
    by_camera: Matrix3<f64>,
}

/// What is left of a light at the edge of a window, with its derivative by the camera's place, 1/m.
struct Window {
    room: f64,
    gradient: Vector3<f64>,
}

/// A marker from which gaps are measured, in units of the resolution of its spot.
struct Gaps {
    from_m: Vector3<f64>,
    /// To the camera.
    ray_m: Vector3<f64>,
    range2_m2: f64,
    resolution2: f64,
}

/// The gap from one marker to another.
struct Gap<'a> {
    squared: f64,
    gaps: &'a Gaps,
    between_m: Vector3<f64>,
    along: f64,
    across: f64,
}

impl Gaps {
    /// The gap to a marker there; `None` where it is far.
    fn to(&self, other_m: &Vector3<f64>) -> Option<Gap<'_>> {
        let between_m = other_m - self.from_m;
        let along = between_m.dot(&self.ray_m);
        let across = between_m.norm_squared() * self.range2_m2 - along * along;
        let scale = self.range2_m2 * self.range2_m2 * self.resolution2;
        // No resolution, or no range, is no number, and far.
        let is_near = scale > 0.0 && across < FAR * FAR * scale;
        is_near.then(|| Gap { squared: (across / scale).max(0.0), gaps: self, between_m, along, across })
    }
}

impl Gap<'_> {
    /// The derivative of its square by the camera's place in the body frame, 1/m.
    fn by_camera(&self) -> Vector3<f64> {
        let Gaps { ray_m, range2_m2, resolution2, .. } = self.gaps;
        let slope = ray_m * (2.0 * self.between_m.norm_squared())
            - self.between_m * (2.0 * self.along)
            - ray_m * (4.0 * self.across / range2_m2);
        slope / (range2_m2 * range2_m2 * resolution2)
    }

    /// The derivative of its square by the place of the other marker, 1/m.
    fn by_other(&self) -> Vector3<f64> {
        let Gaps { ray_m, range2_m2, resolution2, .. } = self.gaps;
        let slope = self.between_m * (2.0 * range2_m2) - ray_m * (2.0 * self.along);
        slope / (range2_m2 * range2_m2 * resolution2)
    }
}

impl Problem<'_> {
    /// The gaps in the image from a marker that is seen as a spot, for a camera at a place in the body frame.
    fn gaps(&self, spot: usize, from: usize, camera_m: &Vector3<f64>) -> Gaps {
        let from_m = self.airframe.markers()[from].position_m;
        let ray_m = camera_m - from_m;
        let resolution_rad = self.observations[spot].resolution_rad;
        Gaps { from_m, ray_m, range2_m2: ray_m.norm_squared(), resolution2: resolution_rad * resolution_rad }
    }

    /// How likely the detector makes one spot of two markers.
    pub(super) fn merged(&self, spot: usize, seen: usize, other: usize, camera_m: &Vector3<f64>) -> f64 {
        let other_m = &self.airframe.markers()[other].position_m;
        self.gaps(spot, seen, camera_m).to(other_m).map_or(0.0, |gap| one_spot(gap.squared))
    }

    /// Whether markers are so near to each other, anywhere near a pose, that one may merge into the spot of another.
    pub(super) fn merging_near(&self, pose: &Pose) -> Merging {
        let camera_m = pose.camera_in_body_m() * ROOM;
        let is_near = |(spot, seen)| {
            let gaps = self.gaps(spot, seen, &camera_m);
            let mut others = self.airframe.markers().iter().enumerate().filter(|&(other, _)| other != seen);
            // What shines where nobody looks is in no spot.
            others.any(|(other, marker)| {
                gaps.to(&marker.position_m).is_some() && (self.is_used(other) || self.is_watched(pose, other))
            })
        };
        if self.used().any(is_near) { Merging::Near } else { Merging::Far }
    }

    /// Whether a marker may merge into the spot of another, anywhere near a pose.
    pub(super) fn may_merge(&self, pose: &Pose, marker: usize) -> bool {
        let camera_m = pose.camera_in_body_m() * ROOM;
        let place_m = &self.airframe.markers()[marker].position_m;
        self.used().any(|(spot, seen)| self.gaps(spot, seen, &camera_m).to(place_m).is_some())
    }

    /// The markers without a spot of their own that shine towards a camera at a place in the body frame.
    pub(super) fn unseen(&self, camera_m: &Vector3<f64>) -> Unseen {
        let mut unseen = Unseen::default();
        let markers = if self.merging == Merging::Near { self.airframe.markers().len() } else { 0 };
        (0..markers).for_each(|marker| unseen.add(marker));
        self.markers.iter().flatten().for_each(|&marker| unseen.remove(usize::from(marker)));
        for marker in unseen.each() {
            if !self.airframe.is_visible(marker, camera_m) {
                unseen.remove(marker);
            }
        }
        unseen
    }

    /// Those of them so near to a spot's marker that they may be in its window.
    fn beside(
        &self,
        spot: usize,
        seen: usize,
        camera_m: Vector3<f64>,
        unseen: Unseen,
    ) -> impl Iterator<Item = Beside> + '_ {
        let gaps = self.gaps(spot, seen, &camera_m);
        unseen.each().filter_map(move |other| {
            let Marker { position_m, .. } = &self.airframe.markers()[other];
            gaps.to(position_m).filter(|_| other != seen)?;
            let (intensity, intensity_gradient) = self.airframe.intensity_with_gradient(other, &camera_m);
            (intensity > 0.0).then_some(Beside { place_m: *position_m, intensity, intensity_gradient })
        })
    }

    /// What a window at a place leaves of the light of a marker.
    fn window(&self, spot: usize, middle: &Place, of_m: &Vector3<f64>, camera_m: &Vector3<f64>) -> Window {
        let resolution_rad = self.observations[spot].resolution_rad;
        let ray_m = camera_m - middle.at_m;
        let gaps = Gaps {
            from_m: middle.at_m,
            ray_m,
            range2_m2: ray_m.norm_squared(),
            resolution2: resolution_rad * resolution_rad,
        };
        let room = |gap: &Gap<'_>| 1.0 - gap.squared / (WINDOW * WINDOW);
        match gaps.to(of_m).filter(|gap| room(gap) > 0.0) {
            Some(gap) => {
                let (by_camera, by_other) = (gap.by_camera(), gap.by_other());
                // What moves all three alike changes nothing, which tells the derivative by the middle.
                let by_middle = -(by_camera + by_other);
                let slope = by_camera + middle.by_camera.transpose() * by_middle;
                Window { room: room(&gap), gradient: slope * (-1.0 / (WINDOW * WINDOW)) }
            }
            None => Window { room: 0.0, gradient: Vector3::zeros() },
        }
    }

    /// What a spot shows: the light of its marker, with that of those that shine into its window.
    pub(super) fn shining(&self, spot: usize, marker: usize, camera_m: &Vector3<f64>) -> Shining {
        self.shining_among(&self.unseen(camera_m), spot, marker, camera_m)
    }

    /// The same where it is known which other markers shine without a spot.
    pub(super) fn shining_among(
        &self,
        unseen: &Unseen,
        spot: usize,
        marker: usize,
        camera_m: &Vector3<f64>,
    ) -> Shining {
        let alone_m = self.airframe.markers()[marker].position_m;
        let (own, own_gradient) = self.airframe.intensity_with_gradient(marker, camera_m);
        let mut shining = Shining {
            spot,
            marker,
            camera_m: *camera_m,
            centre: LightCentre { at_m: alone_m, by_camera: Matrix3::zeros(), factor: 1.0 },
            intensity: own,
            intensity_gradient: own_gradient,
        };
        let mut beside = self.beside(spot, marker, *camera_m, *unseen);
        let Some(first) = beside.next() else { return shining };
        // A marker that hardly shines is no middle of a spot, but it keeps the others' light from being the whole of it.
        let own_gradient = if own > 1e-3 { own_gradient } else { Vector3::zeros() };
        let own = Beside { place_m: alone_m, intensity: own.max(1e-3), intensity_gradient: own_gradient };
        let mut kept = [None; KEPT];
        let lights = [own, first].into_iter().chain(beside);
        kept.iter_mut().zip(lights).for_each(|(place, light)| *place = Some(light));
        let are_more = kept[KEPT - 1].is_some();
        let rest = || self.beside(spot, marker, *camera_m, *unseen).skip(KEPT - 1);
        let all = || kept.iter().flatten().copied().chain(are_more.then(rest).into_iter().flatten());
        let open = |_: &Beside| Window { room: 1.0, gradient: Vector3::zeros() };
        let mut middle = centre_of(&alone_m, all(), open);
        for _ in 0..MOVES {
            let at = middle;
            middle = centre_of(&alone_m, all(), |one| self.window(spot, &at, &one.place_m, camera_m));
        }
        let (mut total, mut unsure_m2) = (0.0, 0.0);
        // Units of LEDs differ, and so does their share.
        let unit = self.unit_sigma() * core::f64::consts::SQRT_2;
        for (place, one) in all().enumerate() {
            let Window { room, gradient } = self.window(spot, &middle, &one.place_m, camera_m);
            let weight = room * room;
            total += weight * one.intensity;
            if place > 0 {
                // Spots differ in their windows: what is at the edge of one is within another.
                let unsure = (1.0 - weight) * (1.0 - weight) + unit * unit;
                let light = weight * one.intensity;
                unsure_m2 += unsure * (one.place_m - alone_m).norm_squared() * light * light;
                shining.intensity += room * one.intensity;
                shining.intensity_gradient += one.intensity_gradient * room + gradient * one.intensity;
            }
        }
        shining.centre.at_m = middle.at_m;
        shining.centre.by_camera = middle.by_camera;
        let sigma2_rad2 = self.whitened[spot].variance_rad2;
        let unsure_rad2 = unsure_m2 / (total * total * camera_m.norm_squared()).max(f64::MIN_POSITIVE);
        shining.centre.factor = (sigma2_rad2 / (sigma2_rad2 + unsure_rad2)).sqrt();
        shining
    }
}

/// The centre of lights, each as far as a window leaves of it; `alone_m` where that is nothing.
fn centre_of(
    alone_m: &Vector3<f64>,
    all: impl Iterator<Item = Beside>,
    window: impl Fn(&Beside) -> Window,
) -> Place {
    let (mut total, mut pull_m) = (0.0, Vector3::zeros());
    let (mut total_gradient, mut pull_by_camera) = (Vector3::zeros(), Matrix3::zeros());
    for one in all {
        let Window { room, gradient } = window(&one);
        let (weight, off_m) = (room * room, one.place_m - alone_m);
        let light_gradient = one.intensity_gradient * weight + gradient * (2.0 * room * one.intensity);
        total += weight * one.intensity;
        total_gradient += light_gradient;
        pull_m += off_m * (weight * one.intensity);
        pull_by_camera += off_m * light_gradient.transpose();
    }
    if total <= 0.0 {
        return Place { at_m: *alone_m, by_camera: Matrix3::zeros() };
    }
    let off_m = pull_m / total;
    Place { at_m: alone_m + off_m, by_camera: (pull_by_camera - off_m * total_gradient.transpose()) / total }
}
