//! What looks through the first camera of a scene: as `photinus locate` does with a recording of it, who blinks what and how the camera turns among what is
//! known.

use photinus::locator::{Kind, Settings};
use photinus::lookout::{Fleet, Vehicle};
use photinus_io::dataset::ImuRow;
use photinus_io::sky::Sky;
use photinus_run::View;
use photinus_run::course::{Course, Told};
use photinus_run::watch::{Looking, Watch};
use photinus_sim::Scene;
use photinus_sim::scene::Target;

use crate::failure::Failure;

/// What looks at this scene, whose targets are built alike.
pub(super) fn of(scene: &Scene) -> Result<View, Failure> {
    let lacks = || Failure::Running("the scene has no camera or no target".to_owned());
    let (mounted, target) = scene.cameras.first().zip(scene.targets.first()).ok_or_else(lacks)?;
    let settings = Settings::default();
    let kinds = [Kind::new(target.airframe.clone(), &settings.pose)];
    let looking = Looking {
        camera: mounted.camera.clone(),
        mask: None,
        mounting: None,
        course: course(scene),
        exposure_us: Some(mounted.exposure_us.unwrap_or(scene.exposure_us)),
    };
    let watch = Watch::alone(looking, &kinds, &settings, &[fleet(scene)?])
        .map_err(|error| Failure::Running(error.to_string()))?;
    let sky = scene.sky.as_ref().map(|sky| Sky::new(sky, &scene.name)).transpose();
    let view = View::new(mounted.camera.clone(), &kinds, None, settings, None)
        .map_err(|error| Failure::Running(error.to_string()))?;
    Ok(view.following(watch).under(sky.map_err(Failure::running)?))
}

/// Who blinks what; `None` where nobody does.
fn fleet(scene: &Scene) -> Result<Option<Fleet>, Failure> {
    let blinking = |target: &Target| {
        let blink = target.blink.as_ref()?;
        Some((Vehicle { id: target.id, words: blink.words.clone() }, blink.rate_hz))
    };
    let Some(blink) = scene.targets.iter().find_map(|target| target.blink.as_ref()) else { return Ok(None) };
    let fleet = Fleet::new(blink.codes.clone(), scene.targets.iter().filter_map(blinking));
    fleet.map(Some).map_err(|error| Failure::Running(error.to_string()))
}

/// How the first camera turns, by the gyro of the observer.
fn course(scene: &Scene) -> Course {
    let until_s = scene.frames as f64 / scene.rate_hz;
    let camera_from_body = scene.cameras[0].body_from_camera.rotation.inverse();
    let rate = |row: ImuRow| (row.time_s, camera_from_body * row.turn_rad_s);
    let gyro = scene.instruments.gyro.iter();
    let rows = gyro.flat_map(|gyro| gyro.measure(&scene.observer, until_s, scene.seed));
    Course::Told(Told { rates: rows.map(rate).collect(), ..Default::default() })
}
