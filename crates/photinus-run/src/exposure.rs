//! How long to expose: so long that a marker at the farthest wanted distance is found, and no longer, so that the nearest stay measurable. The paper
//! sets by exposure at which distance neighbours appear.
//!
//! The light of a marker falls with the square of its distance, and grows with the exposure: level above the background = k * exposure / distance^2, with
//! a k that is learnt from neighbours whose distance is known. One with saturated spots tells only that k is at least so much: until k is known, the exposure is halved
//! for such a one. Before any neighbour was seen, nothing is changed.

use nalgebra::Vector3;
use photinus::camera::{Bearing, Camera};
use photinus_io::results::{FrameRecord, NeighbourRecord, TrackRecord};

use crate::Entry;

/// How many times the detector's contrast the farthest marker stands out: of two LEDs of an airframe one faces away by half, and of a spot between
/// pixels each has a part.
const MARGIN: f64 = 3.0;
/// Share of a new k that is believed, per neighbour and frame.
const LEARNT: f64 = 0.05;
/// A neighbour whose distance is less sure than this, as a share of it, says no k, as a lone spot far away may be a hot pixel; one that is full is too
/// bright wherever it is.
const SURE: f64 = 0.25;
/// Exposures that differ by a smaller share are the same.
const SAME: f64 = 0.05;
/// Without any light of its own, a level that is nearly full says nothing of how bright a marker is.
const FULL: u8 = 250;

/// What is wanted of the exposure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// Markers as far as this are to be found, m.
    pub reach_m: f64,
    /// The shortest and the longest exposure that the camera may be set to, us.
    pub limits_us: [f64; 2],
    /// Grey levels that a spot must stand out by to be found.
    pub contrast: f64,
    /// Every other frame is exposed for the nearest neighbour in place of the farthest.
    pub alternate: bool,
}

/// Sets the exposure of one camera.
#[derive(Clone, Debug)]
pub struct Exposure {
    wanted: Wanted,
    camera: Option<Camera>,
    k: Option<Light>,
    /// How far the nearest neighbour is in this frame and in the one before, which alternating exposes otherwise: one of them may tell it badly.
    nearest_m: [Option<f64>; 2],
    told_us: Option<f64>,
    frames: u64,
}

/// How bright markers are: level times m^2 per us.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Light {
    /// Of spots that are not saturated.
    Is(f64),
    /// Where the brightest spots are.
    AtLeast(f64),
}

impl Exposure {
    /// Nothing is known of the markers' light yet.
    pub fn new(wanted: Wanted) -> Self {
        Self { wanted, camera: None, k: None, nearest_m: [None; 2], told_us: None, frames: 0 }
    }

    /// For those that this camera has in view: others of its vehicle may show more.
    #[must_use]
    pub fn of_camera(self, camera: Camera) -> Self {
        Self { camera: Some(camera), ..self }
    }

    /// The exposure of the frames after this one, us, where it is to be another.
    pub fn after(&mut self, entry: &Entry) -> Option<f64> {
        let exposure_us = 1e6 * entry.exposure_s.filter(|exposure_s| *exposure_s > 0.0)?;
        self.learn(&entry.record, exposure_us);
        self.frames += 1;
        let wished_us = self.wished()?;
        let now_us = self.told_us.unwrap_or(exposure_us);
        if (wished_us / now_us - 1.0).abs() < SAME {
            return None;
        }
        self.told_us = Some(wished_us);
        Some(wished_us)
    }

    /// The exposure that is wanted now, us; `None` before any neighbour was seen.
    fn wished(&self) -> Option<f64> {
        let Wanted { reach_m, limits_us, contrast, alternate } = self.wanted;
        // Half of full scale for the nearest.
        let nearest_m = self.nearest_m.into_iter().flatten().reduce(f64::min);
        let near_us = |k: f64| nearest_m.map(|nearest_m| 128.0 * nearest_m * nearest_m / k);
        let wished_us = match self.k? {
            Light::AtLeast(k) => near_us(k)?,
            Light::Is(k) => {
                let far_us = MARGIN * contrast * reach_m * reach_m / k;
                let is_near = alternate && self.frames % 2 == 1;
                near_us(k).filter(|_| is_near).map_or(far_us, |near_us| near_us.min(far_us))
            }
        };
        Some(wished_us.clamp(limits_us[0], limits_us[1]))
    }

    fn learn(&mut self, record: &FrameRecord, exposure_us: f64) {
        // One that blinks is followed through frames in which it is dark.
        let followed_m = record.tracks.iter().filter_map(|track| self.distance_m(track));
        let seen_m = record.neighbours.iter().filter_map(|neighbour| neighbour.distance_m.estimate);
        self.nearest_m = [seen_m.chain(followed_m).reduce(f64::min), self.nearest_m[0]];
        for neighbour in &record.neighbours {
            let Some(seen) = light(record, neighbour, exposure_us) else { continue };
            self.k = Some(self.k.map_or(seen, |known| known.with(seen)));
        }
    }

    /// How far someone who is followed is, if in view.
    fn distance_m(&self, track: &TrackRecord) -> Option<f64> {
        let bearing = Bearing::new(Vector3::from(track.position_m))?;
        let is_in_view = self.camera.as_ref().is_none_or(|camera| camera.pixel(&bearing).is_some());
        is_in_view.then(|| Vector3::from(track.position_m).norm())
    }
}

impl Light {
    fn with(self, seen: Self) -> Self {
        let believed = |known: f64, seen: f64| known + LEARNT * (seen - known);
        match (self, seen) {
            (Self::Is(known), Self::Is(seen)) => Self::Is(believed(known, seen)),
            (Self::Is(known), Self::AtLeast(seen)) => Self::Is(believed(known, seen.max(known))),
            (Self::AtLeast(known), Self::AtLeast(seen)) => Self::AtLeast(seen.max(known)),
            (Self::AtLeast(_), Self::Is(_)) => seen,
        }
    }
}

/// By the brightest spot of a neighbour.
fn light(record: &FrameRecord, neighbour: &NeighbourRecord, exposure_us: f64) -> Option<Light> {
    let distance_m = neighbour.distance_m.estimate?;
    let spots = || neighbour.spots.iter().filter_map(|&spot| record.spots.get(spot));
    let levels = spots().map(|spot| f64::from(spot.peak) - spot.background);
    let level = levels.reduce(f64::max).filter(|level| *level > 0.0)?;
    let k = level * distance_m * distance_m / exposure_us;
    let is_full = spots().any(|spot| spot.peak >= FULL || spot.saturated_px > 0);
    let is_sure = neighbour.distance_m.sigma.is_some_and(|sigma_m| sigma_m <= SURE * distance_m);
    if is_full { Some(Light::AtLeast(k)) } else { is_sure.then_some(Light::Is(k)) }
}

#[cfg(test)]
mod tests {
    use photinus::camera::{Ideal, IdealLaw, Model, Pixel};
    use photinus_io::results::ResultsReader;

    use super::*;

    const WANTED: Wanted =
        Wanted { reach_m: 20.0, limits_us: [20.0, 10_000.0], contrast: 20.0, alternate: false };

    /// What a camera sees of a marker: level = light * exposure / distance^2, cut at 255.
    fn seen(light: f64, exposure_us: f64, distance_m: f64) -> Entry {
        let level = (light * exposure_us / (distance_m * distance_m) + 10.0).min(255.0);
        let line = format!(
            r#"{{"spots":[{{"u_px":1,"v_px":1,"peak":{},"saturated_px":{},"background":10}}],"neighbours":[{{"airframe":"a","spots":[0],
            "bearing":[0,0,1],"distance_m":{{"estimate":{distance_m},"sigma":0.1,"min":1,"max":99,"perpendicular":null,"inline":null}}}}]}}"#,
            level.floor(),
            u32::from(level >= 255.0)
        )
        .replace('\n', "");
        let record = ResultsReader::new(line.as_bytes(), "t").next().unwrap().unwrap();
        let spots = record.neighbours.clone();
        let mut entry = Entry::from_spots(record);
        entry.record.neighbours = spots;
        entry.exposure_s = Some(1e-6 * exposure_us);
        entry
    }

    /// Closes the loop over a marker that comes nearer, and gives the last exposure.
    fn settled(light: f64, wanted: Wanted, first_us: f64, distance_m: f64) -> f64 {
        let (mut control, mut exposure_us) = (Exposure::new(wanted), first_us);
        for _ in 0..200 {
            exposure_us = control.after(&seen(light, exposure_us, distance_m)).unwrap_or(exposure_us);
        }
        exposure_us
    }

    #[test]
    fn a_marker_at_the_reach_stands_out_enough_whatever_its_light() {
        for light in [5.0, 10.0, 50.0] {
            for distance_m in [8.0, 15.0, 25.0] {
                // It begins where the marker is found.
                let first_us = 60.0 * distance_m * distance_m / light;
                let exposure_us = settled(light, WANTED, first_us, distance_m);
                let level = light * exposure_us / (WANTED.reach_m * WANTED.reach_m);
                assert!(
                    (level / (MARGIN * WANTED.contrast) - 1.0).abs() < 0.1,
                    "light {light}, {distance_m} m: level {level}"
                );
            }
        }
    }

    #[test]
    fn limits_hold_whatever_the_light() {
        assert!((settled(0.001, WANTED, 5000.0, 1.0) - 10_000.0).abs() < 1e-9);
        assert!((settled(1e6, WANTED, 5000.0, 3.0) - 20.0).abs() < 1e-9);
    }

    #[test]
    fn full_scale_is_left_by_halves_until_the_light_is_known() {
        let mut control = Exposure::new(WANTED);
        let mut exposure_us = 8000.0;
        let mut told = Vec::new();
        for _ in 0..12 {
            exposure_us = control.after(&seen(10.0, exposure_us, 4.0)).unwrap_or(exposure_us);
            told.push(exposure_us);
        }
        // At 4 m a marker is full above 392 us; then the reach of 20 m counts.
        assert!(told[..4].windows(2).all(|pair| (0.45..0.6).contains(&(pair[1] / pair[0]))), "{told:?}");
        assert!((10.0 * exposure_us / 400.0 / (MARGIN * WANTED.contrast) - 1.0).abs() < 0.1, "{told:?}");
    }

    #[test]
    fn a_spot_that_faces_away_says_nothing_beside_one_that_is_full() {
        let mut entry = seen(10.0, 4000.0, 4.0);
        let mut dim = entry.record.spots[0];
        (dim.peak, dim.saturated_px) = (30, 0);
        entry.record.spots.push(dim);
        entry.record.neighbours[0].spots.push(1);
        let mut control = Exposure::new(WANTED);
        let asked_us = control.after(&entry).unwrap();
        assert!((asked_us / 4000.0 - 128.0 / 245.0).abs() < 0.01, "{asked_us}");
    }

    #[test]
    fn who_may_be_anywhere_says_nothing_of_the_light() {
        let mut entry = seen(10.0, 40.0, 4.0);
        let mut unsure = entry.record.neighbours[0].clone();
        unsure.distance_m.sigma = Some(0.5 * unsure.distance_m.estimate.unwrap());
        entry.record.neighbours[0] = unsure.clone();
        let mut control = Exposure::new(WANTED);
        assert_eq!(control.after(&entry), None);
        // Where it is full it is too bright all the same.
        let mut full = seen(10.0, 4000.0, 4.0);
        full.record.neighbours[0].distance_m.sigma = Some(2.0);
        let halved = Exposure::new(WANTED).after(&full).unwrap() / 4000.0;
        assert!((halved - 128.0 / 245.0).abs() < 0.01, "{halved}");
        // Nor beside one whose distance is known.
        let known = seen(10.0, 40.0, 4.0);
        let wanted_us = Exposure::new(WANTED).after(&known);
        entry = known;
        unsure.distance_m.estimate = Some(20.0);
        unsure.distance_m.sigma = Some(10.0);
        entry.record.neighbours.push(unsure);
        assert!(wanted_us.is_some() && Exposure::new(WANTED).after(&entry) == wanted_us);
    }

    #[test]
    fn who_is_in_view_of_other_cameras_only_is_nobody_to_expose_for() {
        let lens = Ideal::new(IdealLaw::Equidistant, [200.0; 2], Pixel::new(319.5, 239.5)).unwrap();
        let camera = Camera::new(Model::Ideal(lens), 640, 480, None).unwrap();
        let followed = |position_m: &str| {
            let line = format!(
                r#"{{"spots":[],"tracks":[{{"track":0,"airframe":"a","probability":1,"predicted":true,"spots":[],"position_m":{position_m},"position_covariance_m2":[[1,0,0],[0,1,0],[0,0,1]],"velocity_m_s":[0,0,0],"velocity_covariance_m2_s2":[[1,0,0],[0,1,0],[0,0,1]],"orientation_xyzw":[0,0,0,1],"orientation_covariance_rad2":[[1,0,0],[0,1,0],[0,0,1]]}}]}}"#
            );
            ResultsReader::new(line.as_bytes(), "t").next().unwrap().unwrap()
        };
        let mut control = Exposure::new(WANTED).of_camera(camera);
        control.learn(&followed("[0.1,0,2]"), 100.0);
        assert!((control.nearest_m[0].unwrap() - 2.0).abs() < 0.01);
        control.learn(&followed("[0.1,0,-2]"), 100.0);
        assert_eq!(control.nearest_m[0], None);
    }

    #[test]
    fn alternating_gives_the_nearest_a_shorter_exposure_every_other_frame() {
        let mut control = Exposure::new(Wanted { alternate: true, ..WANTED });
        let (mut exposure_us, mut set) = (200.0, Vec::new());
        for _ in 0..100 {
            exposure_us = control.after(&seen(10.0, exposure_us, 5.0)).unwrap_or(exposure_us);
            set.push(exposure_us);
        }
        let last = &set[98..];
        let (short_us, long_us) = (last[0].min(last[1]), last[0].max(last[1]));
        assert!((10.0 * long_us / 400.0 / (MARGIN * WANTED.contrast) - 1.0).abs() < 0.1, "{long_us}");
        assert!((10.0 * short_us / 25.0 / 128.0 - 1.0).abs() < 0.1, "{short_us}");
    }
}
