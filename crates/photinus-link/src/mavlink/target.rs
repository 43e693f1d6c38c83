//! A track and the own global position -> FOLLOW_TARGET, which carries latitude and longitude.

use mavlink::dialects::common::FOLLOW_TARGET_DATA;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use photinus_io::results::TrackRecord;

/// WGS84: half the equator's diameter, m, and the square of the first eccentricity.
const EQUATOR_M: f64 = 6_378_137.0;
const ECCENTRICITY2: f64 = 6.694_379_990_14e-3;
/// Bits of `est_capabilities`: position and velocity.
const POSITION_AND_VELOCITY: u8 = 0b11;

/// Where the own vehicle is, as its autopilot says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Own {
    /// North of the equator, rad.
    pub latitude_rad: f64,
    /// East of Greenwich, rad.
    pub longitude_rad: f64,
    /// Above mean sea level, m.
    pub altitude_m: f64,
    /// North, east, down, m/s.
    pub velocity_ned_m_s: Vector3<f64>,
    /// The attitude enu_from_flu.
    pub enu_from_body: UnitQuaternion<f64>,
}

/// Where a followed neighbour is on the globe. `body_from_camera` and the camera's place say how it is mounted; `time_boot_ms` is the
/// sender's clock.
#[must_use]
pub fn follow_target(
    track: &TrackRecord,
    own: &Own,
    (body_from_camera, camera_m): (UnitQuaternion<f64>, Vector3<f64>),
    time_boot_ms: u64,
) -> FOLLOW_TARGET_DATA {
    let enu_from_camera = own.enu_from_body * body_from_camera;
    let body_m = body_from_camera * Vector3::from(track.position_m) + camera_m;
    let off_m = super::ned(&(own.enu_from_body * body_m));
    let sine = libm::sin(own.latitude_rad);
    let level2 = 1.0 - ECCENTRICITY2 * sine * sine;
    // Radii of curvature along the meridian and across it.
    let meridian_m = EQUATOR_M * (1.0 - ECCENTRICITY2) / (level2 * level2.sqrt()) + own.altitude_m;
    let across_m = EQUATOR_M / level2.sqrt() + own.altitude_m;
    let latitude_rad = own.latitude_rad + off_m.x / meridian_m;
    let longitude_rad = own.longitude_rad + off_m.y / (across_m * libm::cos(own.latitude_rad));
    let velocity = own.velocity_ned_m_s + super::ned(&(enu_from_camera * Vector3::from(track.velocity_m_s)));
    let turn = enu_from_camera.to_rotation_matrix();
    let covariance = Matrix3::from_fn(|row, column| track.position_covariance_m2[row][column]);
    let enu_m2 = turn * covariance * turn.inverse();
    let level_m = (0.5 * (enu_m2.m11 + enu_m2.m22)).max(0.0).sqrt();
    let attitude = enu_from_camera * quaternion(track.orientation_xyzw);
    let attitude = super::ned_from_frd(&attitude);
    let degrees = |rad: f64| (rad.to_degrees() * 1e7).round() as i32;
    FOLLOW_TARGET_DATA {
        timestamp: time_boot_ms,
        custom_state: u64::from(track.id.unwrap_or(0)),
        lat: degrees(latitude_rad),
        lon: degrees(longitude_rad),
        alt: (own.altitude_m - off_m.z) as f32,
        vel: narrow(velocity),
        acc: [0.0; 3],
        attitude_q: [attitude.w, attitude.i, attitude.j, attitude.k].map(|part| part as f32),
        rates: [0.0; 3],
        position_cov: [level_m as f32, enu_m2.m33.max(0.0).sqrt() as f32, 0.0],
        est_capabilities: POSITION_AND_VELOCITY,
    }
}

fn narrow(vector: Vector3<f64>) -> [f32; 3] {
    <[f64; 3]>::from(vector).map(|axis| axis as f32)
}

fn quaternion([x, y, z, w]: [f64; 4]) -> UnitQuaternion<f64> {
    UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Earth-centred coordinates of a place, m: the textbook's formula, which shares nothing with the radii above.
    fn earth(latitude_rad: f64, longitude_rad: f64, height_m: f64) -> Vector3<f64> {
        let (sine, cosine) = libm::sincos(latitude_rad);
        let across_m = EQUATOR_M / (1.0 - ECCENTRICITY2 * sine * sine).sqrt();
        let level_m = (across_m + height_m) * cosine;
        let (east, north) = libm::sincos(longitude_rad);
        Vector3::new(level_m * north, level_m * east, (across_m * (1.0 - ECCENTRICITY2) + height_m) * sine)
    }

    #[test]
    fn a_neighbour_is_on_the_globe_where_it_is_seen() {
        let line = r#"{"track":1,"airframe":"a","probability":1,"id":7,"predicted":false,"spots":[],"position_m":[20,-5,60],
            "position_covariance_m2":[[1,0,0],[0,4,0],[0,0,9]],"velocity_m_s":[0,0,2],"velocity_covariance_m2_s2":[[1,0,0],[0,1,0],[0,0,1]],
            "orientation_xyzw":[0,0,0,1],"orientation_covariance_rad2":[[1,0,0],[0,1,0],[0,0,1]]}"#;
        let track: TrackRecord = serde_json::from_str(line).unwrap();
        // A camera that looks ahead: x right, y down, z forward.
        let body_from_camera =
            UnitQuaternion::from_matrix(&Matrix3::new(0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0));
        for (latitude, longitude, heading) in
            [(50.1_f64, 14.4_f64, 0.3), (-33.0, 151.0, 2.5), (0.0, -179.0, -1.0)]
        {
            let own = Own {
                latitude_rad: latitude.to_radians(),
                longitude_rad: longitude.to_radians(),
                altitude_m: 300.0,
                velocity_ned_m_s: Vector3::new(1.0, 0.0, 0.0),
                enu_from_body: UnitQuaternion::from_euler_angles(0.05, -0.1, heading),
            };
            let told = follow_target(&track, &own, (body_from_camera, Vector3::new(0.1, 0.0, 0.0)), 5);
            let place = earth(
                (f64::from(told.lat) * 1e-7).to_radians(),
                (f64::from(told.lon) * 1e-7).to_radians(),
                f64::from(told.alt),
            );
            let own_place = earth(own.latitude_rad, own.longitude_rad, own.altitude_m);
            let enu = own.enu_from_body * Vector3::new(60.1, -20.0, 5.0);
            let (lat_s, lat_c) = libm::sincos(own.latitude_rad);
            let (lon_s, lon_c) = libm::sincos(own.longitude_rad);
            let east = Vector3::new(-lon_s, lon_c, 0.0);
            let north = Vector3::new(-lat_s * lon_c, -lat_s * lon_s, lat_c);
            let up = Vector3::new(lat_c * lon_c, lat_c * lon_s, lat_s);
            let off = place - own_place - (east * enu.x + north * enu.y + up * enu.z);
            // 1e-7 deg is 1.1 cm; the plane leaves the globe by 0.3 mm.
            assert!(off.norm() < 0.02, "{off}");
            let ahead = own.enu_from_body * Vector3::new(2.0, 0.0, 0.0);
            let velocity = Vector3::new(1.0 + ahead.y, ahead.x, -ahead.z);
            assert!((Vector3::from(told.vel).cast::<f64>() - velocity).norm() < 1e-5);
            assert_eq!((told.custom_state, told.est_capabilities, told.timestamp), (7, 3, 5));
        }
    }
}
