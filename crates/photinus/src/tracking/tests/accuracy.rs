//! Trajectories drawn from the motion model: what is claimed of tracks is true of them.

use nalgebra::Rotation3;
use rand_distr::{Distribution, Uniform};
use rand_pcg::Pcg64;

use super::simulator::*;
use super::told::Told;
use crate::airframe::Airframe;
use crate::tracking::{Settings, Track};

/// What was measured over all flights.
#[derive(Debug, Default)]
struct Score {
    frames: f64,
    found: f64,
    nees_position: f64,
    nees_velocity: f64,
    /// Over flights in which the told filter, which is one normal distribution, is honest: three spots or more all the time.
    clear: f64,
    square_m2: f64,
    told_square_m2: f64,
    ids: usize,
}

/// Flies single vehicles from somewhere between two distances, a second and a half each; of all frames a share is lost.
fn fly(airframe: Airframe, flights: u64, distances_m: [f64; 2], lost: f64) -> Score {
    let settings = Settings { velocity_sigma_m_s: 1.5, ..Settings::default() };
    let tilt_sigma_rad = located_by().pose.tilt_sigma_rad;
    let mut observer = Observer::new(airframe, settings);
    let mut score = Score::default();
    let still = Rotation3::identity();
    for flight in 0..flights {
        let mut rng = Pcg64::new(100 + u128::from(flight), 3);
        observer.forget();
        let any = |low: f64, high: f64, rng: &mut Pcg64| Uniform::new(low, high).unwrap().sample(rng);
        let distance_m = any(distances_m[0], distances_m[1], &mut rng);
        let place_m = [any(-2.0, 2.0, &mut rng), any(-1.0, 1.0, &mut rng), distance_m];
        let mut vehicle = Vehicle::at(place_m, [0.0; 3], any(0.0, core::f64::consts::TAU, &mut rng));
        vehicle.velocity_m_s = normal3(&mut rng) * settings.velocity_sigma_m_s;
        vehicle.tilt_rad = [(); 2].map(|()| tilt_sigma_rad * normal(&mut rng));
        vehicle.yaw_rate_rad_s = settings.yaw_rate_sigma_rad_s * normal(&mut rng);
        let mut told = Told::near(&vehicle, &settings, tilt_sigma_rad, &mut rng);
        let (mut ids, mut is_clear, mut squares) = (Vec::new(), true, [0.0; 3]);
        for frame in 0..45 {
            if frame > 0 {
                vehicle = vehicle.drawn(1.0 / RATE_HZ, &settings, tilt_sigma_rad, &mut rng);
                told.predict(1.0 / RATE_HZ, &settings, tilt_sigma_rad);
            }
            if vehicle.position_m.z < 2.5 || vehicle.position_m.xy().norm() > 0.8 * vehicle.position_m.z {
                break;
            }
            if frame > 0 && any(0.0, 1.0, &mut rng) < lost {
                continue;
            }
            let seen = look(&observer.airframe, &[vehicle], &still, &mut rng);
            let alone: Vec<&Seen> = seen.iter().filter(|seen| seen.is_alone).collect();
            is_clear &= alone.len() > 2;
            told.update(&observer.airframe, &alone, &still);
            let tracked = observer.see(f64::from(frame) / RATE_HZ, &seen, &still, &mut rng).unwrap();
            score.frames += 1.0;
            let by_existence = |a: &&Track, b: &&Track| a.existence.total_cmp(&b.existence);
            let Some(track) = tracked.tracks.iter().max_by(by_existence) else { continue };
            if !ids.contains(&track.id) {
                ids.push(track.id);
            }
            let off_m = track.position_m - vehicle.position_m;
            let off_m_s = track.velocity_m_s - vehicle.velocity_m_s;
            score.found += 1.0;
            score.nees_position += nees(&off_m, &track.position_covariance_m2);
            score.nees_velocity += nees(&off_m_s, &track.velocity_covariance_m2_s2);
            if frame >= 10 {
                let told_m = told.position_m() - vehicle.position_m;
                squares =
                    [squares[0] + 1.0, squares[1] + off_m.norm_squared(), squares[2] + told_m.norm_squared()];
            }
        }
        if is_clear {
            score.clear += squares[0];
            score.square_m2 += squares[1];
            score.told_square_m2 += squares[2];
        }
        score.ids += ids.len();
    }
    score.nees_position /= score.found;
    score.nees_velocity /= score.found;
    score
}

#[test]
fn drawn_flights_have_the_covariance_that_is_claimed() {
    for (name, airframe) in [("hexarotor", hexarotor()), ("quadrotor", quadrotor())] {
        for lost in [0.0, 0.3] {
            let flights = 80;
            let score = fly(airframe.clone(), flights, [4.0, 9.0], lost);
            let ratio = (score.square_m2 / score.told_square_m2).sqrt();
            println!(
                "| {name} | {:.0} % | {:.0} | {:.2} | {:.2} | {:.0} | {ratio:.3} |",
                lost * 100.0,
                score.frames,
                score.nees_position,
                score.nees_velocity,
                score.clear
            );
            assert!(score.found > 0.995 * score.frames, "{score:?}");
            assert!(score.ids <= flights as usize + 1, "{score:?}");
            assert!((2.6..3.3).contains(&score.nees_position), "{score:?}");
            assert!((2.6..3.3).contains(&score.nees_velocity), "{score:?}");
            assert!(score.clear > 200.0 && ratio < 1.1, "{ratio} {score:?}");
        }
    }
}
