//! `[[kind]]`: how vehicles are built.

use std::sync::Arc;

use nalgebra::{Isometry3, Translation3, Vector3};
use photinus_io::Result;
use photinus_sim::occlusion::Solid;
use photinus_sim::scene::{Check, mounting};

use super::files::Library;
use super::table::{BodyTable, CameraTable, KindTable};
use super::{Kind, Mounted};
use crate::vehicle::{Build, GRAVITY_M_S2};

/// Most cameras that a vehicle carries.
const MOST_CAMERAS: usize = 3;

pub(super) fn read(check: &Check<'_>, library: &Library<'_>, index: usize, table: KindTable) -> Result<Kind> {
    let key = |name: &str| format!("kind[{index}].{name}");
    let airframe = Arc::new(library.airframe(&key("airframe"), &table.airframe)?.airframe);
    let expects = match &table.expects {
        Some(file) => Arc::new(library.airframe(&key("expects"), file)?.airframe),
        None => Arc::clone(&airframe),
    };
    match table.camera.len() {
        0 => {
            let refused = check.refuse(&key("camera"), "it has no camera: it could see nobody");
            return Err(refused.advise("add a [[kind.camera]]"));
        }
        count if count > MOST_CAMERAS => {
            let refused = check.refuse(&key("camera"), format!("{count} cameras"));
            return Err(refused.advise(format!("a vehicle carries 1 to {MOST_CAMERAS}")));
        }
        _ => {}
    }
    let cameras = table.camera.into_iter().enumerate().map(|(at, camera)| {
        let key = |name: &str| key(&format!("camera[{at}].{name}"));
        mounted(check, library, &key, camera)
    });
    let cameras: Vec<Mounted> = cameras.collect::<Result<_>>()?;
    let names = |camera: usize| &cameras[camera].name;
    if let Some(twice) = (1..cameras.len()).find(|&at| (0..at).any(|before| names(before) == names(at))) {
        let refused = check.refuse(&key(&format!("camera[{twice}].name")), "another camera is called so");
        return Err(refused.advise("name each its own way"));
    }
    let solid = Solid::Cylinder {
        centre_m: Vector3::zeros(),
        radius_m: check.positive(&key("body.hub_radius_m"), table.body.hub_radius_m.unwrap_or(0.12), 10.0)?,
        half_height_m: check.positive(
            &key("body.hub_half_height_m"),
            table.body.hub_half_height_m.unwrap_or(0.08),
            10.0,
        )?,
    };
    let build = build(check, &|name| key(&format!("body.{name}")), &table.body)?;
    Ok(Kind { name: table.name, build, airframe, solids: Arc::new([solid]), cameras, expects })
}

fn mounted(
    check: &Check<'_>,
    library: &Library<'_>,
    key: &dyn Fn(&str) -> String,
    table: CameraTable,
) -> Result<Mounted> {
    let angle = |name: &str, value_deg| check.angle(&key(name), value_deg);
    let turn = mounting(
        angle("yaw_deg", table.yaw_deg)?,
        angle("pitch_deg", table.pitch_deg)?,
        angle("roll_deg", table.roll_deg)?,
    );
    let position_m = check.place(&key("position_m"), table.position_m)?;
    Ok(Mounted {
        name: table.name,
        camera: library.camera(&key("file"), &table.file)?.camera,
        body_from_camera: Isometry3::from_parts(Translation3::from(position_m), turn),
    })
}

fn build(check: &Check<'_>, key: &dyn Fn(&str) -> String, table: &BodyTable) -> Result<Build> {
    let usual = Build::default();
    let positive = |name: &str, value: Option<f64>, usual: f64, most: f64| {
        value.map_or(Ok(usual), |value| check.positive(&key(name), value, most))
    };
    let drag = |name: &str, value: Option<f64>, usual: f64| {
        value.map_or(Ok(usual), |value| check.within(&key(name), value, (0.0, 100.0)))
    };
    let build = Build {
        mass_kg: positive("mass_kg", table.mass_kg, usual.mass_kg, 100.0)?,
        thrust_n: positive("thrust_n", table.thrust_n, usual.thrust_n, 1e4)?,
        tilt_rad: positive("tilt_deg", table.tilt_deg, usual.tilt_rad.to_degrees(), 75.0)?.to_radians(),
        turn_rad_s: positive("turn_deg_s", table.turn_deg_s, usual.turn_rad_s.to_degrees(), 2000.0)?
            .to_radians(),
        speed_m_s: positive("speed_m_s", table.speed_m_s, usual.speed_m_s, 100.0)?,
        drag_n_s_m: drag("drag_n_s_m", table.drag_n_s_m, usual.drag_n_s_m)?,
        drag_n_s2_m2: drag("drag_n_s2_m2", table.drag_n_s2_m2, usual.drag_n_s2_m2)?,
        radius_m: positive("radius_m", table.radius_m, usual.radius_m, 10.0)?,
        thrust_lag_s: positive("thrust_lag_s", table.thrust_lag_s, usual.thrust_lag_s, 10.0)?,
        turn_lag_s: positive("turn_lag_s", table.turn_lag_s, usual.turn_lag_s, 10.0)?,
    };
    let weight_n = build.mass_kg * GRAVITY_M_S2;
    if build.thrust_n < 1.2 * weight_n {
        let reason = format!("{} N hardly lift {weight_n:.1} N", build.thrust_n);
        let refused = check.refuse(&key("thrust_n"), reason);
        return Err(refused.advise("give 1.2 times the weight at least, or a smaller mass_kg"));
    }
    Ok(build)
}
