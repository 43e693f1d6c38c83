//! From the camera's frame to the body frame of the vehicle that carries it.

use nalgebra::{Matrix3, Vector3};

use super::FrameRecord;
use super::found::rows;
use crate::calibration::MountingFile;

impl FrameRecord {
    /// Says where neighbours and tracks are in the body frame, as far as the mounting knows: p_body = R p + t. Its covariance is
    /// R S R^T + [R p]x S_R [R p]x^T + S_t, with the mounting's covariances S_R of a small turn about the body's axes and S_t of the
    /// camera's place. Where the mounting does not know the place, the body frame stays unknown.
    pub fn put_mounting(&mut self, mounting: &MountingFile) {
        let Some(centre_m) = mounting.position_m else { return };
        let turn = mounting.body_from_camera.to_rotation_matrix();
        let place = |position_m: [f64; 3]| <[f64; 3]>::from(turn * Vector3::from(position_m) + centre_m);
        let covariance = |position_m: [f64; 3], covariance_m2: [[f64; 3]; 3]| {
            let lever = (turn * Vector3::from(position_m)).cross_matrix();
            let seen = turn * matrix(covariance_m2) * turn.inverse();
            let mounted = lever * mounting.rotation_covariance_rad2 * lever.transpose();
            rows(&(seen + mounted + mounting.position_covariance_m2.unwrap_or_else(Matrix3::zeros)))
        };
        for neighbour in &mut self.neighbours {
            let Some(position_m) = neighbour.position_m else { continue };
            neighbour.position_body_m = Some(place(position_m));
            let camera_m2 = neighbour.position_covariance_m2;
            neighbour.position_body_covariance_m2 =
                camera_m2.map(|camera_m2| covariance(position_m, camera_m2));
        }
        for track in &mut self.tracks {
            track.position_body_m = Some(place(track.position_m));
            track.position_body_covariance_m2 =
                Some(covariance(track.position_m, track.position_covariance_m2));
        }
    }
}

fn matrix(rows: [[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|row, column| rows[row][column])
}

#[cfg(test)]
mod tests {
    use nalgebra::{Rotation3, UnitQuaternion};
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    use super::*;
    use crate::results::ResultsReader;

    #[test]
    fn the_covariance_is_that_of_many_mountings_and_places() {
        let line = br#"{"spots":[],"neighbours":[{"airframe":"a","spots":[],"bearing":[0,0,1],"distance_m":{"estimate":5,
            "sigma":0.1,"min":1,"max":9,"perpendicular":null,"inline":null},"position_m":[1,-0.5,5],
            "position_covariance_m2":[[0.0004,0.0001,0],[0.0001,0.0009,0.0002],[0,0.0002,0.01]]}]}"#;
        let line: Vec<u8> = line.iter().copied().filter(|&byte| byte != b'\n').collect();
        let mut record = ResultsReader::new(line.as_slice(), "t").next().unwrap().unwrap();
        let (sigma_rad, sigma_m) = ([0.004, 0.006, 0.002], [0.01, 0.02, 0.005]);
        let diagonal =
            |sigmas: [f64; 3]| Matrix3::from_diagonal(&Vector3::from(sigmas.map(|sigma| sigma * sigma)));
        let mounting = MountingFile {
            body_from_camera: UnitQuaternion::from_euler_angles(0.3, -0.4, 2.0),
            rotation_covariance_rad2: diagonal(sigma_rad),
            position_m: Some(Vector3::new(0.1, 0.02, -0.05)),
            position_covariance_m2: Some(diagonal(sigma_m)),
        };
        record.put_mounting(&mounting);
        let told_m = Vector3::from(record.neighbours[0].position_body_m.unwrap());
        let told_m2 = matrix(record.neighbours[0].position_body_covariance_m2.unwrap());

        let mut random = Pcg64::new(7, 7);
        let mut normal = |sigmas: [f64; 3]| {
            Vector3::from(sigmas.map(|sigma| {
                sigma * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut random)
            }))
        };
        let root = matrix(record.neighbours[0].position_covariance_m2.unwrap()).cholesky().unwrap().l();
        let (mut mean_m, mut square_m2, count) = (Vector3::zeros(), Matrix3::zeros(), 200_000);
        for _ in 0..count {
            let turn = Rotation3::new(normal(sigma_rad)) * mounting.body_from_camera.to_rotation_matrix();
            let place_m = Vector3::new(1.0, -0.5, 5.0) + root * normal([1.0; 3]);
            let off_m = turn * place_m + mounting.position_m.unwrap() + normal(sigma_m) - told_m;
            mean_m += off_m / f64::from(count);
            square_m2 += off_m * off_m.transpose() / f64::from(count);
        }
        assert!(mean_m.norm() < 1e-3, "{mean_m}");
        assert!((square_m2 - told_m2).abs().max() < 0.015 * told_m2.abs().max(), "{square_m2}{told_m2}");
        let unknown = MountingFile { position_m: None, ..mounting };
        record.neighbours[0].position_body_m = None;
        record.put_mounting(&unknown);
        assert_eq!(record.neighbours[0].position_body_m, None);
    }
}
