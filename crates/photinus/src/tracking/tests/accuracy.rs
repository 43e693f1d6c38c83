//! Trajectories drawn from the motion model: what is claimed of tracks is true of them.

use nalgebra::Rotation3;
use rand_distr::{Distribution, Uniform};
use rand_pcg::Pcg64;

use super::simulator::*;
use super::told::Told;
use crate::airframe::Airframe;
use crate::tracking::{Look, Settings};

/// What was measured over all flights.
#[derive(Debug, Default)]
struct Score {
    frames: usize,
    found: usize,
    nees_position: f64,
    nees_velocity: f64,
    late: usize,
    square_m2: f64,
    told_square_m2: f64,
    told_nees: f64,
    ids: usize,
}

/// Flies vehicles from `distance_m` on, alone, for a second and a half each; errors are compared with those of the told filter after the first third.
fn fly(airframe: &Airframe, flights: u64, distances_m: [f64; 2]) -> Score {
    let settings = Settings { velocity_sigma_m_s: 1.5, ..Settings::default() };
    let tilt_sigma_rad = located_by().pose.tilt_sigma_rad;
    let mut locator = locator(airframe);
    let mut score = Score::default();
    for flight in 0..flights {
        let mut rng = Pcg64::new(100 + u128::from(flight), 3);
        let mut tracker = tracker(airframe, settings);
        locator.forget();
        let any = |low: f64, high: f64, rng: &mut Pcg64| Uniform::new(low, high).unwrap().sample(rng);
        let distance_m = any(distances_m[0], distances_m[1], &mut rng);
        let mut vehicle = Vehicle::at(
            [any(-2.0, 2.0, &mut rng), any(-1.0, 1.0, &mut rng), distance_m],
            [0.0; 3],
            any(0.0, 6.28, &mut rng),
        );
        vehicle.velocity_m_s = normal3(&mut rng) * settings.velocity_sigma_m_s;
        vehicle.tilt_rad = [(); 2].map(|()| tilt_sigma_rad * normal(&mut rng));
        let mut told = Told::near(&vehicle, settings.velocity_sigma_m_s, tilt_sigma_rad, &mut rng);
        let still = Rotation3::identity();
        let mut ids = Vec::new();
        for frame in 0..45 {
            if frame > 0 {
                vehicle = vehicle.drawn(1.0 / RATE_HZ, &settings, tilt_sigma_rad, &mut rng);
                told.predict(1.0 / RATE_HZ, &settings, tilt_sigma_rad);
            }
            if vehicle.position_m.z < 2.5 || vehicle.position_m.xy().norm() > 0.8 * vehicle.position_m.z {
                break;
            }
            let seen = look(airframe, &[vehicle], &still, &mut rng);
            let clear: Vec<&Seen> = seen.iter().filter(|seen| seen.is_alone).collect();
            told.update(airframe, &clear, &still);
            let spots: Vec<_> = seen.iter().map(|seen| seen.spot.clone()).collect();
            let gravity = down(&still);
            let located = locator.locate_spots(&spots, Some(&gravity), &mut |_| ());
            let look = Look {
                time_s: f64::from(frame) / RATE_HZ,
                turned: Some(crate::tracking::Turned { now_from_before: still, sigma_rad: 0.0 }),
                gravity: Some(gravity),
                located,
                signals: &[],
                lit: &[],
            };
            let tracked = tracker.track(&look).unwrap();
            score.frames += 1;
            let tracked = tracked.clone(); let Some(track) = tracked.tracks.iter().max_by(|a, b| a.existence.total_cmp(&b.existence)) else {
                continue;
            };
            if !ids.contains(&track.id) {
                ids.push(track.id);
            }
            let off_m = track.position_m - vehicle.position_m;
            let own = nees(&off_m, &track.position_covariance_m2);
            if own > 40.0 && std::env::var("SHOW").is_ok() {
                println!(
                    "flight {flight} frame {frame} nees {own:.1} off {:.3} {:.3} {:.3} at {:.2} m, {} spots, told nees {:.1}",
                    off_m.x,
                    off_m.y,
                    off_m.z,
                    vehicle.position_m.norm(),
                    seen.len(),
                    nees(&(told.position_m() - vehicle.position_m), &told.covariance_m2())
                );
            }
            score.found += 1;
            score.nees_position += own;
            score.nees_velocity +=
                nees(&(track.velocity_m_s - vehicle.velocity_m_s), &track.velocity_covariance_m2_s2);
            if frame >= 15 {
                let told_m = told.position_m() - vehicle.position_m;
                score.late += 1;
                score.square_m2 += off_m.norm_squared();
                score.told_square_m2 += told_m.norm_squared();
                score.told_nees += nees(&told_m, &told.covariance_m2());
            }
        }
        score.ids += ids.len();
    }
    let found = score.found as f64;
    score.nees_position /= found;
    score.nees_velocity /= found;
    score.told_nees /= score.late as f64;
    score
}

#[test]
fn drawn_flights() {
    for (name, airframe) in [("hexarotor", hexarotor()), ("quadrotor", quadrotor())] {
        let score = fly(&airframe, 60, [4.0, 9.0]);
        let ratio = (score.square_m2 / score.told_square_m2).sqrt();
        println!("{name}: {score:?} ratio {ratio:.3}");
    }
}
