//! Frames in, guarded set-points out, without a simulator: what runs on a vehicle between its camera and its flight controller.
//!
//! `cargo run --release -p photinus-control --example by_sight`
//!
//! A neighbour is painted that comes nearer at 2 m/s from 12 m. The flock's rules want to close up, then to keep away; the safety layer
//! lets them, or not. Each line is what SET_POSITION_TARGET_LOCAL_NED (frame MAV_FRAME_BODY_FRD) or a ROS 2
//! TrajectorySetpoint would carry, before their axes.

mod painted;

use nalgebra::{UnitVector3, Vector3};
use photinus::frame::FrameView;
use photinus::locator::{Input, Locator, Settings};
use photinus_control::controllers::Boids;
use photinus_control::safety::{Cone, Detection, Limits, Safety, Watch};
use photinus_control::{Controller, Held, Motion, Normal, OwnState, Seen};

#[allow(clippy::print_stdout)]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (camera, airframe) = (painted::camera()?, painted::hexarotor()?);
    let mut locator = Locator::new(camera.clone(), &airframe, None, Settings::default())?;
    let held =
        Held { level_from_camera: painted::level_from_camera(), camera_m: Vector3::new(0.1, 0.0, 0.0) };
    let gravity = UnitVector3::new_normalize(Vector3::y());

    let limits = Limits::small_multirotor();
    let mut flock = Boids::new(4.0, 8.0);
    let mut safety = Safety::new(limits)?;
    let detection = Detection { range_m: 12.0, probability: 0.9 };
    let mut watch = Watch::new(&[detection], 1e-6, limits.period_s, 2.0 * limits.speed_m_s);
    // The lens covers a half-space ahead; a second one behind is taken to show nobody.
    let eyes = [1.0, -1.0]
        .map(|x| Cone { axis: UnitVector3::new_normalize(Vector3::x() * x), half_angle_rad: 1.61 });

    let mut velocity = Vector3::zeros();
    println!("distance  bounds              wanted m/s           flown m/s^2          basis");
    for frame in 0..150 {
        let distance_m = 12.0 - 2.0 * limits.period_s * f64::from(frame);
        let place = Vector3::new(distance_m, 1.0, 0.3);
        let pixels = painted::paint(&camera, &airframe, &(place - held.camera_m), 0.2);
        let located =
            locator.locate(Input::frame(&FrameView::packed(&pixels, 752, 480)?).gravity(&gravity))?;
        let seen: Vec<Seen> = located
            .neighbours
            .iter()
            .enumerate()
            .map(|(k, neighbour)| {
                let members = neighbour.sightings.iter().map(|k| &located.sightings[*k]);
                held.seen(neighbour, members, airframe.max_radius_m(), k as u64, None, None)
            })
            .collect();

        let own = OwnState { velocity_m_s: Some(Normal::exactly(velocity)), ..OwnState::resting() };
        watch.look(&eyes, &[], own.turn_rad_s() * limits.period_s, limits.period_s, 0.0);
        let wanted = flock.command(&own, &seen, limits.period_s);
        let guarded = safety.guard(&own, &seen, &watch, &[], &wanted, limits.period_s);
        let (Motion::Acceleration(flown), Motion::Velocity(wanted)) =
            (guarded.setpoint.motion, wanted.motion)
        else {
            return Err("the layer tells accelerations, the flock velocities".into());
        };
        velocity += flown * limits.period_s;
        if frame % 10 == 0 {
            let bounds = seen.first().map(|s| (s.distance.bounds.min_m(), s.distance.bounds.max_m()));
            let [wanted, flown] = [wanted, flown].map(|v| format!("{:5.2} {:5.2} {:5.2}", v.x, v.y, v.z));
            println!("{distance_m:5.1} m  {bounds:.2?}  {wanted}  {flown}  {:?}", guarded.basis);
        }
    }
    Ok(())
}
