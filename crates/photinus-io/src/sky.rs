//! Where the sun stands: enters a place on Earth, a time and how the camera is turned, leaves the sun in the camera frame, for
//! [`photinus::locator::Input::sun`]. By the algorithm of Reda and Andreas (NREL SPA, 2004) of a crate.

use std::path::Path;
use std::str::FromStr;

use nalgebra::{Unit, UnitQuaternion, Vector3};
use photinus::locator::Sun;
use serde::{Deserialize, Serialize};
use solar_positioning::time::JulianDate;
use solar_positioning::{Location, RefractionCorrection, SolarPositions, delta_t};
use toml::value::{Datetime, Offset};

use crate::{Error, Place, Result, physics};

const SECONDS_PER_DAY: f64 = 86_400.0;
/// A sun lower than this is not seen, rad: its disc and the air that lifts it.
const LOWEST_RAD: f64 = -0.015;
/// How far gravity errs in flight, rad: the sigma of the sun's elevation.
const TILT_SIGMA_RAD: f64 = 0.035;
/// How far a heading is off where nobody says, deg.
const HEADING_SIGMA_DEG: f64 = 10.0;
const LATITUDE_DEG: std::ops::RangeInclusive<f64> = -90.0..=90.0;
const LONGITUDE_DEG: std::ops::RangeInclusive<f64> = -180.0..=180.0;
const HEIGHT_M: std::ops::RangeInclusive<f64> = -500.0..=9000.0;
const HEADING_DEG: std::ops::RangeInclusive<f64> = -360.0..=360.0;
const SIGMA_DEG: std::ops::RangeInclusive<f64> = 0.0..=180.0;

/// A place on Earth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// Latitude, north positive, deg.
    pub latitude_deg: f64,
    /// Longitude, east positive, deg.
    pub longitude_deg: f64,
    /// Height above the sea, m.
    pub height_m: f64,
}

/// Direction of the sun (x east, y north, z up) at a place and a time in UTC; `None` for a place or a time that does not exist.
pub fn sun_direction(site: &Site, time: &Datetime) -> Option<Unit<Vector3<f64>>> {
    sun_of_day(site, &julian_date(time)?)
}

/// Whether this is a date and a time of day in UTC.
pub fn is_utc(time: &Datetime) -> bool {
    matches!(time, Datetime { date: Some(_), time: Some(_), offset: Some(Offset::Z) })
}

fn julian_date(time: &Datetime) -> Option<JulianDate> {
    let Datetime { date: Some(date), time: Some(time), offset: Some(Offset::Z) } = *time else {
        return None;
    };
    let [month, day] = [u32::from(date.month), u32::from(date.day)];
    let second = f64::from(time.second.unwrap_or(0)) + f64::from(time.nanosecond.unwrap_or(0)) * 1e-9;
    let delta_t_s = delta_t::estimate(f64::from(date.year) + (f64::from(month) - 0.5) / 12.0).ok()?;
    let (hour, minute) = (u32::from(time.hour), u32::from(time.minute));
    JulianDate::from_utc(i32::from(date.year), month, day, hour, minute, second, delta_t_s).ok()
}

fn sun_of_day(site: &Site, time: &JulianDate) -> Option<Unit<Vector3<f64>>> {
    let location = Location { latitude: site.latitude_deg, longitude: site.longitude_deg };
    let refraction = Some(RefractionCorrection::standard());
    let position = SolarPositions::new().at_from_julian(*time, location, site.height_m, refraction).ok()?;
    let (sin_azimuth, cos_azimuth) = libm::sincos(position.azimuth().to_radians());
    let (sin_up, cos_up) = libm::sincos(position.elevation_angle().to_radians());
    Some(Unit::new_normalize(Vector3::new(sin_azimuth * cos_up, cos_azimuth * cos_up, sin_up)))
}

/// A `[sky]` of dataset.toml.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SkyInfo {
    /// Latitude, north positive, deg.
    pub latitude_deg: f64,
    /// Longitude, east positive, deg.
    pub longitude_deg: f64,
    /// Height above the sea, m; 0 where it is not said.
    #[serde(default)]
    pub height_m: f64,
    /// Date and time in UTC at which times of frames are 0.
    pub time: Datetime,
    /// Where the camera looks, deg clockwise from north, if it keeps looking there; else the sun is anywhere at its elevation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heading_deg: Option<f64>,
    /// How sure that is, sigma, deg; 10 where it is not said.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heading_sigma_deg: Option<f64>,
}

/// The sky over a recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    site: Site,
    start: JulianDate,
    /// Where the camera looks, clockwise from north, with its sigma.
    heading_rad: Option<[f64; 2]>,
}

impl Sky {
    /// The sky that a file describes.
    ///
    /// # Errors
    /// [`Error`] with the key for a place that is not on Earth, or a time that is no date and time in UTC.
    pub fn new(info: &SkyInfo, path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let key = |name: &str| format!("sky.{name}");
        let within = |name: &str, value: f64, range| physics::within(path, &key(name), value, range);
        let site = Site {
            latitude_deg: within("latitude_deg", info.latitude_deg, &LATITUDE_DEG)?,
            longitude_deg: within("longitude_deg", info.longitude_deg, &LONGITUDE_DEG)?,
            height_m: within("height_m", info.height_m, &HEIGHT_M)?,
        };
        let sigma_deg = info.heading_sigma_deg.unwrap_or(HEADING_SIGMA_DEG);
        let sigma_deg = within("heading_sigma_deg", sigma_deg, &SIGMA_DEG)?;
        let heading_deg =
            info.heading_deg.map(|heading| within("heading_deg", heading, &HEADING_DEG)).transpose()?;
        let start = julian_date(&info.time).ok_or_else(|| {
            Error::format(path, format!("{} is no date and time in UTC", info.time))
                .at(Place::Key(key("time")))
                .advise("write it as 2018-05-10T10:00:00Z")
        })?;
        let heading_rad = heading_deg.map(|heading| [heading.to_radians(), sigma_deg.to_radians()]);
        Ok(Self { site, start, heading_rad })
    }

    /// The sun at a time of the recording, s, for a camera in whose frame `down` is down; `None` at night.
    pub fn sun(&self, time_s: f64, down: &Unit<Vector3<f64>>) -> Option<Sun> {
        Some(self.seen(&self.direction(time_s)?, down))
    }

    /// Where the sun stands in the second of the recording that `time_s` is in, x east, y north, z up; `None` at night. It is the same for the whole
    /// second, in which the sun goes 0.004 deg, so that it need not be worked out for every frame.
    pub fn direction(&self, time_s: f64) -> Option<Unit<Vector3<f64>>> {
        let day = self.start.julian_date() + time_s.floor() / SECONDS_PER_DAY;
        let sun = sun_of_day(&self.site, &JulianDate::new(day, self.start.delta_t()).ok()?)?;
        (libm::asin(sun.z) >= LOWEST_RAD).then_some(sun)
    }

    /// The sun of [`Self::direction`] in the frame of a camera in which `down` is down.
    pub fn seen(&self, sun: &Unit<Vector3<f64>>, down: &Unit<Vector3<f64>>) -> Sun {
        let up = -*down;
        // A camera that looks straight up or down has no heading.
        let ahead = Vector3::z() - up.into_inner() * up.z;
        let level = Unit::try_new(ahead, 1e-3);
        let (heading_rad, sigma_rad) = match (self.heading_rad, &level) {
            (Some([heading_rad, sigma_rad]), Some(_)) => (heading_rad, sigma_rad),
            _ => (0.0, f64::INFINITY),
        };
        let ahead = level.unwrap_or_else(|| any_across(&up));
        let north = UnitQuaternion::from_axis_angle(&up, heading_rad) * ahead.into_inner();
        let east = north.cross(&up);
        let towards = east * sun.x + north * sun.y + up.into_inner() * sun.z;
        Sun::new(Unit::new_normalize(towards), up, TILT_SIGMA_RAD, sigma_rad)
    }
}

/// `LATITUDE,LONGITUDE,TIME` or `LATITUDE,LONGITUDE,TIME,HEADING`, as in `[sky]`.
impl FromStr for Sky {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let advice = "give LATITUDE,LONGITUDE,TIME[,HEADING], such as 50.08,14.42,2018-05-10T10:00:00Z,170";
        let parts: Vec<&str> = text.split(',').map(str::trim).collect();
        let (latitude, longitude, time, heading) = match *parts.as_slice() {
            [latitude, longitude, time] => (latitude, longitude, time, None),
            [latitude, longitude, time, heading] => (latitude, longitude, time, Some(heading)),
            _ => return Err(advice.to_owned()),
        };
        let number = |text: &str| text.parse().map_err(|_| format!("`{text}` is no number; {advice}"));
        let info = SkyInfo {
            latitude_deg: number(latitude)?,
            longitude_deg: number(longitude)?,
            height_m: 0.0,
            time: time.parse().map_err(|_| format!("`{time}` is no date and time; {advice}"))?,
            heading_deg: heading.map(number).transpose()?,
            heading_sigma_deg: None,
        };
        // There is no file to name.
        Self::new(&info, "").map_err(|error| error.to_string().trim_start_matches([',', ':', ' ']).to_owned())
    }
}

fn any_across(up: &Unit<Vector3<f64>>) -> Unit<Vector3<f64>> {
    let aside = if up.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() };
    Unit::new_normalize(up.cross(&aside))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sky(text: &str) -> Sky {
        text.parse().unwrap()
    }

    #[test]
    fn the_sun_stands_where_published_values_have_it() {
        // Reda and Andreas, table A5.1: Golden, Colorado, 2003-10-17 19:30:30 UTC, 820 mbar, 11 degrees Celsius
        let golden = Site { latitude_deg: 39.742_476, longitude_deg: -105.178_6, height_m: 1830.14 };
        let utc = |text: &str| text.parse::<Datetime>().unwrap();
        let sun = sun_direction(&golden, &utc("2003-10-17T19:30:30Z")).unwrap();
        let azimuth_deg = libm::atan2(sun.x, sun.y).to_degrees() + 360.0;
        assert!((azimuth_deg - 194.340_24).abs() < 2e-3, "{azimuth_deg}");
        let zenith_deg = libm::acos(sun.z).to_degrees();
        assert!((zenith_deg - 50.111_62).abs() < 5e-3, "{zenith_deg}: thinner air there bends light less");
        // at the equinox of 2024-03-20, 12:07 UTC, the sun is nearly overhead at 0 N 0 E
        let equator = Site { latitude_deg: 0.0, longitude_deg: 0.0, height_m: 0.0 };
        assert!(sun_direction(&equator, &utc("2024-03-20T12:07:00Z")).unwrap().z > 0.9999);
        let mut nowhen = utc("2003-10-17T19:30:30Z");
        nowhen.date = nowhen.date.map(|date| toml::value::Date { month: 13, ..date });
        assert_eq!(sun_direction(&golden, &nowhen), None);
    }

    #[test]
    fn a_camera_that_looks_at_the_sun_has_it_ahead() {
        // Golden again: azimuth 194.34 deg, elevation 39.89 deg; a level camera (x right, y down) that looks there.
        let sky = sky("39.742476,-105.1786,2003-10-17T19:30:30Z,194.34");
        let sun = sky.sun(0.0, &Vector3::y_axis()).unwrap();
        let elevation_rad = 39.888_f64.to_radians();
        let ahead = Vector3::new(0.0, -libm::sin(elevation_rad), libm::cos(elevation_rad));
        let expected = Sun::new(Unit::new_normalize(ahead), -Vector3::y_axis(), 0.035, 10f64.to_radians());
        assert!((sun.towards().into_inner() - expected.towards().into_inner()).norm() < 1e-3, "{sun:?}");
        // A camera that looks 30 deg farther clockwise has it on its left; an hour later it has gone on by 15 deg or so, to the right.
        let left = super::tests::sky("39.742476,-105.1786,2003-10-17T19:30:30Z,224.34");
        let [now, later] =
            [0.0, 3600.0].map(|time_s| left.sun(time_s, &Vector3::y_axis()).unwrap().towards().x);
        assert!(now < -0.3 && later > now + 0.1, "{now} {later}");
    }

    #[test]
    fn there_is_no_sun_at_night_and_no_heading_straight_down() {
        assert!(sky("50.08,14.42,2018-05-10T23:00:00Z").sun(0.0, &Vector3::y_axis()).is_none());
        let down = sky("50.08,14.42,2018-05-10T10:00:00Z,90").sun(0.0, &Vector3::z_axis());
        assert!(down.is_some_and(|sun| sun.towards().iter().all(|number| number.is_finite())));
    }

    #[test]
    fn what_is_no_place_or_time_is_refused_with_a_reason() {
        for (text, reason) in [
            ("50,14", "give LATITUDE"),
            ("95,14,2018-05-10T10:00:00Z", "95.0 is out of range"),
            ("50,14,2018-05-10", "is no date and time in UTC"),
            ("50,14,2018-05-10T10:00:00+02:00", "is no date and time in UTC"),
            ("50,x,2018-05-10T10:00:00Z", "`x` is no number"),
            ("50,14,noon", "`noon` is no date and time"),
        ] {
            let error = text.parse::<Sky>().unwrap_err();
            assert!(error.contains(reason) && !error.starts_with(','), "{text}: {error}");
        }
    }
}
