//! `[optics]`, `[sensor]` and the keys of light: what they change, and what is refused.

use std::path::{Path, PathBuf};

use super::*;
use crate::preset::{BLUEFOX_FIT, bluefox};

fn path(name: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes")).join(name)
}

fn text() -> String {
    std::fs::read_to_string(path("other-light.toml")).unwrap()
}

fn message(text: &str) -> String {
    Scene::parse(text, path("test.toml")).map(|_| ()).unwrap_err().to_string()
}

#[test]
fn a_file_changes_a_preset_and_the_scene_changes_the_file() {
    let scene = Scene::read(path("other-light.toml")).unwrap();
    let (lens, sensor, plain) = (&scene.preset.lens, &scene.preset.sensor, bluefox(&BLUEFOX_FIT));
    let bent = lens.spread.aberrations();
    assert!((bent.coma_px_per_rad - 0.8).abs() < 1e-12, "the scene's, not the file's 0.6");
    assert!((bent.elongation_per_rad2 - 0.2).abs() < 1e-12 && lens.vignette.is_some());
    assert!((lens.pupil_m2 - plain.lens.pupil_m2).abs() < 1e-18, "what nobody changes is the preset's");
    let full_dn = sensor.full_well_e / sensor.electrons_per_dn + sensor.dark_offset_dn;
    assert!((full_dn - 245.0).abs() < 1e-9 && (sensor.well_noise_e - 20.0).abs() < 1e-9, "{full_dn}");
    assert_eq!(sensor.converter.bits(), 10);
    assert_eq!(
        (scene.targets[0].faults.dead.len(), scene.targets[0].mirrors.len(), scene.lamps.len()),
        (1, 2, 2)
    );
    assert_eq!(scene.lamps[1].beside, Some(0));
    // gain alone leaves what a full pixel reads as it was
    let gain =
        text().replace("file = \"sensors/ccd.toml\"", "electrons_per_dn = 20.0\ndark_offset_dn = 10.0");
    let sensor = Scene::parse(&gain, path("test.toml")).unwrap().preset.sensor;
    let full_dn = sensor.full_well_e / 20.0 + 10.0;
    assert!((full_dn - plain.sensor.full_well_e / plain.sensor.electrons_per_dn).abs() < 1e-6, "{full_dn}");
}

#[test]
fn what_no_lens_sensor_or_light_has_is_refused_with_its_key() {
    for (from, to, expected) in [
        (
            "coma_px_per_rad = 0.8",
            "coma_px_per_rad = 80",
            "`optics.coma_px_per_rad`: 80.0 is out of range; give -10 to 10",
        ),
        ("coma_px_per_rad = 0.8", "coma = 1", "unknown key `coma`"),
        (
            "coma_px_per_rad = 0.8",
            "spread = { gaussian = { sigma_px = 0.0 } }",
            "`optics.spread.gaussian.sigma_px`: 0.0 is out of range",
        ),
        (
            "coma_px_per_rad = 0.8",
            "spread = { gaussians = [{ share = 0.5, sigma_px = 1.0 }] }",
            "`optics.spread`: the shares do not sum to 1",
        ),
        (
            "coma_px_per_rad = 0.8",
            "spread = { moffat = { fwhm_px = 1.0, beta = 1.0 } }",
            "`optics.spread.moffat.beta`: 1.0 is",
        ),
        (
            "coma_px_per_rad = 0.8",
            "spread = { table = { file = \"none\" } }",
            "`optics.spread.table.file`: there is no file",
        ),
        (
            "coma_px_per_rad = 0.8",
            "vignette = { clear_deg = 50, dark_deg = 40 }",
            "`optics.vignette`: from 50 to 40 deg",
        ),
        ("optics/coma.toml", "sensors/ccd.toml", "ccd.toml, line 15: unknown key `bits`"),
        ("file = \"sensors/ccd.toml\"", "bits = 14", "`sensor.bits`: 14 is out of range; give 8 to 12"),
        ("file = \"sensors/ccd.toml\"", "spill = 1.5", "`sensor.spill`: 1.5 is out of range; give 0 to 1"),
        ("file = \"sensors/ccd.toml\"", "full_reads_dn = nan", "`sensor.full_reads_dn`: NaN is out of range"),
        ("lobe = { cosine = 3.0 }", "lobe = { cosine = -1.0 }", "`target[0].lobe`: no LED shines like that"),
        ("dead = [2]", "dead = [8]", "`target[0].leds.dead`: there is no LED 8; give 0 to 7"),
        ("power = 0.4", "power = 40", "`target[0].leds.weak[0].power`: 40.0 is out of range"),
        ("misplaced_m = 0.003", "misplaced_m = 3", "`target[0].leds.misplaced_m`: 3.0 is out of range"),
        (
            "radius_m = 0.05, reflectance = 0.3",
            "radius_m = 0.05, reflectance = 3",
            "`target[0].mirror[0].sphere.reflectance`",
        ),
        ("beside = 1", "beside = 7", "`lamp[1].beside`: there is no target 7"),
        ("brightness = 0.3", "brightness = 3.0", "`own_airframe.brightness`: 3.0 is out of range"),
    ] {
        let changed = text().replacen(from, to, 1);
        assert_ne!(changed, text(), "{from}");
        assert!(message(&changed).contains(expected), "{}\nnot {expected}", message(&changed));
    }
}

#[test]
fn a_table_of_a_point_spread_that_is_none_is_refused() {
    let of = |text: &str| parse_sampled(text, Path::new("t.toml")).map(|_| ()).unwrap_err().to_string();
    assert!(of("samples_per_px = 1\nrows = [[1.0, 2.0]]").contains("the rows make no point spread"));
    assert!(of("samples_per_px = 1\nrows = 3").starts_with("t.toml, line 2"));
}
