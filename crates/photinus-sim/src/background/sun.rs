//! Where the sun stands, by the algorithm of Reda and Andreas (NREL SPA, 2004) of a crate.

use nalgebra::{Unit, Vector3};
use solar_positioning::time::JulianDate;
use solar_positioning::{Location, RefractionCorrection, SolarPositions, delta_t};

/// A place on Earth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Latitude, north positive, deg.
    pub latitude_deg: f64,
    /// Longitude, east positive, deg.
    pub longitude_deg: f64,
    /// Height above the sea, m.
    pub height_m: f64,
}

/// Direction of the sun (x east, y north, z up) at a place, for year, month, day, hour, minute and second in UTC; `None`
/// for a place or a time that does not exist.
pub fn sun_direction(
    place: &Place,
    date: [u32; 3],
    hour: [u32; 2],
    second: f64,
) -> Option<Unit<Vector3<f64>>> {
    let [year, month, day] = date;
    let delta_t_s = delta_t::estimate(f64::from(year) + (f64::from(month) - 0.5) / 12.0).ok()?;
    let year = i32::try_from(year).ok()?;
    let time = JulianDate::from_utc(year, month, day, hour[0], hour[1], second, delta_t_s).ok()?;
    let location = Location { latitude: place.latitude_deg, longitude: place.longitude_deg };
    let refraction = Some(RefractionCorrection::standard());
    let position = SolarPositions::new().at_from_julian(time, location, place.height_m, refraction).ok()?;
    let (sin_azimuth, cos_azimuth) = libm::sincos(position.azimuth().to_radians());
    let (sin_up, cos_up) = libm::sincos(position.elevation_angle().to_radians());
    Some(Unit::new_normalize(Vector3::new(sin_azimuth * cos_up, cos_azimuth * cos_up, sin_up)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sun_stands_where_published_values_have_it() {
        // Reda and Andreas, table A5.1: Golden, Colorado, 2003-10-17 19:30:30 UTC, 820 mbar, 11 degrees Celsius
        let golden = Place { latitude_deg: 39.742_476, longitude_deg: -105.178_6, height_m: 1830.14 };
        let sun = sun_direction(&golden, [2003, 10, 17], [19, 30], 30.0).unwrap();
        let azimuth_deg = libm::atan2(sun.x, sun.y).to_degrees() + 360.0;
        assert!((azimuth_deg - 194.340_24).abs() < 2e-3, "{azimuth_deg}");
        let zenith_deg = libm::acos(sun.z).to_degrees();
        assert!((zenith_deg - 50.111_62).abs() < 5e-3, "{zenith_deg}: thinner air there bends light less");
        // at the equinox of 2024-03-20, 12:07 UTC, the sun is nearly overhead at 0 N 0 E
        let equator = Place { latitude_deg: 0.0, longitude_deg: 0.0, height_m: 0.0 };
        assert!(sun_direction(&equator, [2024, 3, 20], [12, 7], 0.0).unwrap().z > 0.9999);
        assert_eq!(sun_direction(&golden, [2003, 13, 17], [19, 30], 30.0), None);
    }
}
