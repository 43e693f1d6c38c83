//! A filter that is told which spot is which marker: what a tracker can reach at best. Written apart from it: an extended Kalman filter over positions
//! in the image, with derivatives by differences.

use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, SMatrix, SVector, Vector3};
use rand_pcg::Pcg64;

use super::simulator::{SIGMA_PX, Seen, Vehicle, camera, normal};
use crate::airframe::Airframe;
use crate::camera::Bearing;
use crate::tracking::Settings;

/// Position, velocity, yaw, tilt about the world's x and z, yaw rate.
type State = SVector<f64, 10>;

pub(super) struct Told {
    state: State,
    covariance: SMatrix<f64, 10, 10>,
}

impl Told {
    /// Begins near the truth.
    pub(super) fn near(truth: &Vehicle, settings: &Settings, tilt_sigma_rad: f64, rng: &mut Pcg64) -> Self {
        let mut state = State::zeros();
        state.fixed_rows_mut::<3>(0).copy_from(&truth.position_m);
        state.fixed_rows_mut::<3>(3).copy_from(&truth.velocity_m_s);
        state[6] = truth.yaw_rad;
        state[7] = truth.tilt_rad[0];
        state[8] = truth.tilt_rad[1];
        state[9] = truth.yaw_rate_rad_s;
        let (v, tilt, rate) = (settings.velocity_sigma_m_s, tilt_sigma_rad, settings.yaw_rate_sigma_rad_s);
        let sigmas = State::from_column_slice(&[0.1, 0.1, 0.1, v, v, v, 0.2, tilt, tilt, rate]);
        let noise = State::from_fn(|axis, _| sigmas[axis] * normal(rng));
        Self { state: state + noise, covariance: SMatrix::from_diagonal(&sigmas.component_mul(&sigmas)) }
    }

    pub(super) fn predict(&mut self, interval_s: f64, settings: &Settings, tilt_sigma_rad: f64) {
        let keeps = libm::exp(-interval_s / settings.tilt_time_s);
        let mut f = SMatrix::<f64, 10, 10>::identity();
        f.fixed_view_mut::<3, 3>(0, 3).copy_from(&(Matrix3::identity() * interval_s));
        f[(7, 7)] = keeps;
        f[(8, 8)] = keeps;
        let (a2, t) = (settings.acceleration * settings.acceleration, interval_s);
        let mut q = SMatrix::<f64, 10, 10>::zeros();
        for axis in 0..3 {
            q[(axis, axis)] = a2 * t * t * t / 3.0;
            q[(axis, axis + 3)] = a2 * t * t / 2.0;
            q[(axis + 3, axis)] = a2 * t * t / 2.0;
            q[(axis + 3, axis + 3)] = a2 * t;
        }
        // The rate is white noise through a filter of the first order; over a frame it is taken to change evenly.
        let (time_s, keeps_rate) = (settings.yaw_rate_time_s, libm::exp(-t / settings.yaw_rate_time_s));
        f[(6, 9)] = time_s * (1.0 - keeps_rate);
        f[(9, 9)] = keeps_rate;
        let density = 2.0 * settings.yaw_rate_sigma_rad_s * settings.yaw_rate_sigma_rad_s / time_s;
        q[(6, 6)] = density * t * t * t / 3.0;
        q[(6, 9)] = density * t * t / 2.0;
        q[(9, 6)] = q[(6, 9)];
        q[(9, 9)] = density * t;
        q[(7, 7)] = tilt_sigma_rad * tilt_sigma_rad * (1.0 - keeps * keeps);
        q[(8, 8)] = q[(7, 7)];
        self.state = f * self.state;
        self.covariance = f * self.covariance * f.transpose() + q;
    }

    pub(super) fn update(&mut self, airframe: &Airframe, seen: &[&Seen], camera_from_world: &Rotation3<f64>) {
        let camera = camera();
        let project = |state: &State| {
            let vehicle = vehicle(state);
            DVector::from_iterator(
                2 * seen.len(),
                seen.iter().flat_map(|seen| {
                    let at_m = vehicle.world_from_body() * airframe.markers()[seen.marker].position_m
                        + vehicle.position_m;
                    let pixel = camera.pixel(&Bearing::new(camera_from_world * at_m).unwrap()).unwrap();
                    [pixel.u, pixel.v]
                }),
            )
        };
        let measured = DVector::from_iterator(
            2 * seen.len(),
            seen.iter().flat_map(|seen| [seen.spot.centre.u, seen.spot.centre.v]),
        );
        let prior = self.state;
        let p = DMatrix::from_column_slice(10, 10, self.covariance.as_slice());
        let mut after = p.clone();
        for _ in 0..3 {
            let mut h = DMatrix::zeros(2 * seen.len(), 10);
            for axis in 0..10 {
                let mut step = State::zeros();
                step[axis] = 1e-5;
                let slope = (project(&(self.state + step)) - project(&(self.state - step))) / 2e-5;
                h.set_column(axis, &slope);
            }
            let s = &h * &p * h.transpose()
                + DMatrix::identity(2 * seen.len(), 2 * seen.len()) * (SIGMA_PX * SIGMA_PX);
            let gain = &p * h.transpose() * s.try_inverse().unwrap();
            let off = self.state - prior;
            let residual = &measured - project(&self.state) + &h * DVector::from_column_slice(off.as_slice());
            let step = &gain * residual;
            self.state = prior + State::from_column_slice(step.as_slice());
            after = &p - &gain * &h * &p;
        }
        let after = SMatrix::<f64, 10, 10>::from_column_slice(after.as_slice());
        self.covariance = (after + after.transpose()) * 0.5;
    }

    pub(super) fn position_m(&self) -> Vector3<f64> {
        self.state.fixed_rows::<3>(0).into_owned()
    }
}

fn vehicle(state: &State) -> Vehicle {
    Vehicle {
        position_m: state.fixed_rows::<3>(0).into_owned(),
        velocity_m_s: state.fixed_rows::<3>(3).into_owned(),
        yaw_rad: state[6],
        yaw_rate_rad_s: state[9],
        tilt_rad: [state[7], state[8]],
        body_m: 0.0,
    }
}
