//! `calibrate mounting`: the file that it writes, and what it refuses.

use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use photinus::camera::Pixel;
use photinus_io::calibration::read_mounting;
use photinus_io::read_camera;

use crate::stage::Stage;

/// How the camera of the mounting tests sits.
fn body_from_camera() -> Rotation3<f64> {
    Rotation3::from_scaled_axis(Vector3::new(-1.1, 1.3, -1.0))
}

/// Places over the image of camera.toml with their directions in the body frame, to 0.1 px.
pub(crate) fn directions(stage: &Stage) -> String {
    let camera = read_camera(stage.path("camera.toml")).unwrap().camera;
    let mut table = "u_px,v_px,x,y,z\n".to_owned();
    for index in 0..12 {
        let share = |step: f64| (f64::from(index) * step).fract();
        let (width, height) = (camera.width() as f64, camera.height() as f64);
        let pixel = Pixel::new(width * (0.1 + 0.8 * share(0.618)), height * (0.125 + 0.75 * share(0.7549)));
        let Some(bearing) = camera.bearing(pixel) else { continue };
        let ray = body_from_camera() * bearing.vector();
        table += &format!("{:.1},{:.1},{},{},{}\n", pixel.u, pixel.v, ray.x, ray.y, ray.z);
    }
    table
}

#[test]
fn directions_give_the_mounting() {
    let stage = Stage::new("mounting");
    let wrong = "40,30,0,0,1\n";
    stage.file("seen.csv", directions(&stage) + wrong);
    let done = stage.run("calibrate mounting seen.csv --camera camera.toml --out mounting.toml");
    assert_eq!(done.code, 0);
    assert!(done.out.contains("not used   line 14: "), "{}", done.out);
    let file = read_mounting(stage.path("mounting.toml")).unwrap();
    let error = file.body_from_camera.angle_to(&UnitQuaternion::from_rotation_matrix(&body_from_camera()));
    assert!(error < 1e-3, "{error}");
    let sigma_rad = file.rotation_covariance_rad2.trace().sqrt();
    assert!(sigma_rad > 1e-5 && sigma_rad < 2e-3 && file.position_m.is_none(), "{sigma_rad}");
}

#[test]
fn what_gives_no_mounting_is_refused() {
    let stage = Stage::new("mounting-bad");
    let good = directions(&stage);
    stage.file("outside.csv", format!("{good}500,30,0,0,1\n"));
    stage.file("few.csv", good.lines().take(3).collect::<Vec<_>>().join("\n"));
    stage.file("alike.csv", "u_px,v_px,x,y,z\n40,30,1,0,0\n40.2,30,1,0,0\n40,30.2,1,0,0\n40.1,30.1,1,0,0\n");
    stage.file("nowhere.csv", format!("{good}40,30,0,0,0\n"));
    for (table, parts) in [
        (
            "outside.csv",
            &["outside.csv, line 14: the camera sees nothing at (500, 30) px; give places inside"][..],
        ),
        ("few.csv", &["few.csv: 2 observations: 3 are needed; add rows"]),
        ("alike.csv", &["alike.csv: the directions are too much alike", "; add markers in other directions"]),
        ("nowhere.csv", &["nowhere.csv, line 14: [0, 0, 0] has no direction; "]),
    ] {
        stage.refuses(&format!("calibrate mounting {table} --camera camera.toml"), parts);
    }
}
