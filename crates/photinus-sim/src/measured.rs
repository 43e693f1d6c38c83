//! A camera whose file holds optics: lens and sensor as they were measured, in place of those of a preset.
//!
//! What was measured are grey levels; how many electrons make one follows from the shot noise. What nobody can measure from frames
//! (pupil, dark current, shutter, what lies off the axis) stays as it is, and an LED stays as bright in grey levels.

use photinus::camera::Camera;

use crate::optics::{Falloff, Lens, PointSpread, SampledSpread, ZonedSpread};
use crate::sensor::{ColumnSmear, Overflow, Pattern, Response, Sensor};

/// Electrons that make a grey level are within what sensors have.
const ELECTRONS_PER_DN: (f64, f64) = (0.1, 1e4);

/// Gives lens and sensor what the camera's file says of them; nothing where it says nothing.
pub fn as_measured(camera: &Camera, lens: &mut Lens, sensor: &mut Sensor) {
    let Some(optics) = camera.optics() else { return };
    let tables: Option<Vec<SampledSpread>> =
        optics.spread.zones().iter().map(|zone| sampled(zone.samples())).collect();
    let size_px = [camera.width(), camera.height()];
    let zones = tables.and_then(|tables| ZonedSpread::new(tables, optics.spread.columns(), size_px));
    if let Some(zones) = zones {
        lens.spread = PointSpread::zoned(zones);
    }
    if let Some(vignetting) = &optics.vignetting {
        let (angles_rad, shares, _) = vignetting.table();
        lens.falloff =
            Falloff::new(angles_rad.iter().zip(shares).map(|(angle, share)| [*angle, *share]).collect());
    }
    let measured = &optics.sensor;
    let (fewest, most) = ELECTRONS_PER_DN;
    let electrons_per_dn = (1.0 / measured.shot.value.max(1.0 / most)).max(fewest);
    let more = electrons_per_dn / sensor.electrons_per_dn;
    lens.pupil_m2 *= more;
    sensor.dark_current_e_per_s *= more;
    // those of this very camera are drawn by the renderer, one by one
    sensor.hot_pixel_share = 0.0;
    sensor.electrons_per_dn = electrons_per_dn;
    sensor.response = match measured.bent() {
        Some(response) => Response::Soft { ceiling_dn: 1.0 / response.bend_per_dn.value },
        None => Response::Linear,
    };
    sensor.read_noise_e = measured.read_noise_dn.value * electrons_per_dn;
    if let Some(dark) = measured.dark_dn {
        (sensor.dark_offset_dn, sensor.corner_offset_dn) = (dark.value, 0.0);
    }
    let reads_dn = measured.saturation.level_dn - sensor.dark_offset_dn;
    let well_dn = measured.full_well_dn.map_or(reads_dn, |well| well.value);
    sensor.full_well_e = well_dn * electrons_per_dn;
    sensor.well_noise_e = measured.saturation.spread_dn * electrons_per_dn;
    sensor.overflow = Overflow { spill: measured.spill.value };
    sensor.smear =
        measured.column_smear.map_or(ColumnSmear::NONE, |smear| ColumnSmear { share: smear.value });
    // the noise that was measured is that of all pixels, whatever of it stays from frame to frame
    sensor.pattern = Pattern::NONE;
}

/// A table of the simulator's own from samples, row by row: only the square that holds light.
fn sampled(samples: &[f64]) -> Option<SampledSpread> {
    const PER_PX: usize = 4;
    const LEAST_HALF: usize = 2 * PER_PX;
    let side = samples.len().isqrt();
    let middle = side / 2;
    let lit = |(index, share): (usize, &f64)| {
        let far = (index % side).abs_diff(middle).max((index / side).abs_diff(middle));
        if *share > 0.0 { far } else { 0 }
    };
    let half = samples.iter().enumerate().map(lit).max()?.clamp(LEAST_HALF, middle);
    let rows: Vec<Vec<f64>> = (middle - half..=middle + half)
        .map(|row| {
            samples[row * side + middle - half..=row * side + middle + half]
                .iter()
                .map(|share| share.max(0.0))
                .collect()
        })
        .collect();
    SampledSpread::new(PER_PX, &rows)
}

#[cfg(test)]
mod tests {
    use photinus::camera::{Ideal, IdealLaw, Model, Pixel};
    use photinus::optics::{
        Gaussian, HotPixels, Measured, Optics, PointSpread as Learned, Saturation, SpreadField,
    };

    use super::*;
    use crate::optics::PointLight;
    use crate::preset::{BLUEFOX_FIT, bluefox};
    use crate::sensor::Charge;

    fn optics() -> Optics {
        let zone = |sigma_px: f64| Learned::gaussians(&[Gaussian { share: 1.0, sigma_px }]).unwrap();
        let known = |value: f64| Measured { value, sigma: 0.01 };
        Optics {
            spread: SpreadField::new(vec![zone(0.5), zone(0.9)], 2, 60.0, 40.0, 0.01).unwrap(),
            sensor: photinus::optics::Sensor {
                dark_dn: Some(known(7.0)),
                read_noise_dn: known(0.8),
                shot: known(0.02),
                response: None,
                saturation: Saturation { level_dn: 240.0, spread_dn: 1.5 },
                spill: known(0.4),
                full_well_dn: None,
                column_smear: None,
            },
            vignetting: None,
            hot_pixels: HotPixels::default(),
        }
    }

    #[test]
    fn a_measured_camera_is_rendered_as_it_was_measured() {
        let lens = Ideal::new(IdealLaw::Equidistant, [100.0; 2], Pixel::new(29.5, 19.5)).unwrap();
        let camera = Camera::new(Model::Ideal(lens), 60, 40, None).unwrap().with_optics(optics());
        let plain = bluefox(&BLUEFOX_FIT);
        let (mut lens, mut sensor) = (plain.lens.clone(), plain.sensor.clone());
        as_measured(&camera, &mut lens, &mut sensor);
        assert!((sensor.electrons_per_dn - 50.0).abs() < 1e-9 && (sensor.read_noise_e - 40.0).abs() < 1e-9);
        assert!((sensor.full_well_e / 50.0 + sensor.dark_offset_dn - 240.0).abs() < 1e-9);
        assert!((sensor.well_noise_e - 75.0).abs() < 1e-9 && (sensor.overflow.spill - 0.4).abs() < 1e-12);
        let bright = |lens: &Lens, sensor: &Sensor| lens.pupil_m2 / sensor.electrons_per_dn;
        assert!((bright(&lens, &sensor) / bright(&plain.lens, &plain.sensor) - 1.0).abs() < 1e-9);
        for (u_px, v_px) in [(12.3, 18.8), (44.6, 20.1)] {
            let mut charge = Charge::new(60, 40);
            lens.spread.draw(&PointLight { u_px, v_px, electrons: 1e6, ..Default::default() }, &mut charge);
            let optics = optics();
            let spread = optics.spread.at(Pixel::new(u_px, v_px));
            let summit = spread.share(0.0, 0.0);
            for (u, v) in (8..52).flat_map(|u| (10..30).map(move |v| (u, v))) {
                let share = spread.share(u as f64 - u_px, v as f64 - v_px);
                let drawn = f64::from(charge.at(u, v)) / 1e6;
                assert!((drawn - share).abs() < 0.02 * summit, "{drawn} not {share} at {u} {v}");
            }
        }
    }

    #[test]
    fn a_camera_without_optics_changes_nothing() {
        let lens = Ideal::new(IdealLaw::Equidistant, [100.0; 2], Pixel::new(29.5, 19.5)).unwrap();
        let camera = Camera::new(Model::Ideal(lens), 60, 40, None).unwrap();
        let plain = bluefox(&BLUEFOX_FIT);
        let (mut lens, mut sensor) = (plain.lens.clone(), plain.sensor.clone());
        as_measured(&camera, &mut lens, &mut sensor);
        assert!(lens == plain.lens && sensor == plain.sensor);
    }
}
