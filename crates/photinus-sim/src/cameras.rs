//! Cameras of all kinds, to try on what was never tuned to them: a projection, a lens and a sensor each.
//!
//! They differ in size and field, in the shape of the point spread (Gaussian, Moffat, coma, core and halo; sigmas of 0.3 px to
//! 1.5 px), in what a full pixel reads (230 to 255, with and without noise of its own) and does with the excess (0 to 1 of it
//! spilled), in vignetting, and in noise (0.3 to 3 times). What one camera does not say is that of [`plain`].

use std::path::Path;

use photinus::camera::{Camera, Ideal, IdealLaw, Model, Pixel};

use crate::optics::{Aberrations, Gaussian, PointSpread, Vignette};
use crate::preset::{BLUEFOX_FIT, Preset, bluefox};
use crate::scene::{Scene, parse_sampled};
use crate::sensor::{ColumnSmear, Converter, Overflow, Pattern};

/// A camera to try things on.
#[derive(Clone, Debug)]
pub struct World {
    /// Its name: lower case, digits, - and dots.
    pub name: &'static str,
    /// What is particular about it, for a table.
    pub about: &'static str,
    /// Its projection.
    pub camera: Camera,
    /// Its lens and sensor, and the LEDs it looks at.
    pub preset: Preset,
}

impl World {
    /// Puts the camera in place of every camera of a scene; where they sit stays as it is.
    pub fn install(&self, scene: &mut Scene) {
        scene.preset = self.preset.clone();
        scene.cameras.iter_mut().for_each(|mounted| mounted.camera = self.camera.clone());
    }
}

/// Image sizes and lenses.
#[derive(Clone, Copy, Debug)]
enum Projection {
    /// 752x480, equidistant, 265 px/rad: 160 deg across.
    W752,
    /// 960x600, orthographic, 464 px/rad on the axis: the circle of 160 deg is wider than the image is high.
    W960,
    /// 1280x1024, equidistant, 190 deg across the width.
    W1280,
    /// 640x480, stereographic, 120 deg across the width.
    W640,
}

impl Projection {
    fn camera(self) -> Camera {
        use core::f64::consts::PI;
        let (law, focal_px, (width, height), limit_deg) = match self {
            Self::W752 => (IdealLaw::Equidistant, 265.442, (752, 480), None),
            Self::W960 => (IdealLaw::Orthographic, 464.0, (960, 600), Some(80.0_f64)),
            Self::W1280 => (IdealLaw::Equidistant, 640.0 / (95.0 / 180.0 * PI), (1280, 1024), Some(95.0)),
            Self::W640 => (IdealLaw::Stereographic, 320.0 / (2.0 * libm::tan(PI / 6.0)), (640, 480), None),
        };
        let centre = Pixel::new(0.5 * width as f64 - 0.5, 0.5 * height as f64 - 0.5);
        let lens = Ideal::new(law, [focal_px; 2], centre).expect("a lens with a focal length");
        Camera::new(Model::Ideal(lens), width, height, limit_deg.map(f64::to_radians)).expect("a camera")
    }
}

/// What all have in common: the light that the paper's camera gathers, 40 electrons per grey level, a dark level of 6 with a
/// noise of 0.6, a well that ends far above 255, no spill, a point spread that keeps its width over the field.
pub fn plain() -> Preset {
    let mut preset = bluefox(&BLUEFOX_FIT);
    preset.lens.spread = gaussian(0.4);
    let sensor = &mut preset.sensor;
    sensor.electrons_per_dn = 40.0;
    sensor.read_noise_e = 24.0;
    sensor.dark_offset_dn = 6.0;
    sensor.hot_pixel_share = 0.0;
    sensor.overflow = Overflow { spill: 0.0 };
    sensor.full_well_e = 400.0 * sensor.electrons_per_dn;
    preset
}

fn gaussian(sigma_px: f64) -> PointSpread {
    PointSpread::new(vec![Gaussian { share: 1.0, sigma_px }], 0.0).expect("one Gaussian")
}

/// Moffat's profile as wide at half its summit as a Gaussian of this sigma.
fn moffat(sigma_px: f64, beta: f64) -> PointSpread {
    PointSpread::moffat(2.0 * (2.0 * core::f64::consts::LN_2).sqrt() * sigma_px, beta).expect("a profile")
}

fn core_and_halo(core_px: f64, halo_px: f64, halo_share: f64) -> PointSpread {
    let core = Gaussian { share: 1.0 - halo_share, sigma_px: core_px };
    PointSpread::new(vec![core, Gaussian { share: halo_share, sigma_px: halo_px }], 0.0)
        .expect("two Gaussians")
}

/// The point spread of a real lens, from a table of the scenes.
fn measured(text: &str) -> PointSpread {
    PointSpread::sampled(parse_sampled(text, Path::new("a measured point spread")).expect("a table of ours"))
}

/// The cameras, in a fixed order; each with a name of its own.
pub fn worlds() -> Vec<World> {
    use Projection::{W640, W752, W960, W1280};
    let world = |name, about, projection: Projection, change: &dyn Fn(&mut Preset)| {
        let mut preset = plain();
        change(&mut preset);
        World { name, about, camera: projection.camera(), preset }
    };
    let spread = |shape: PointSpread| move |preset: &mut Preset| preset.lens.spread = shape.clone();
    vec![
        world("gaussian-0.3", "752x480, Gaussian of 0.3 px", W752, &spread(gaussian(0.3))),
        world("gaussian-0.4", "752x480, Gaussian of 0.4 px", W752, &|_| {}),
        world("gaussian-0.6", "960x600, Gaussian of 0.6 px", W960, &spread(gaussian(0.6))),
        world("gaussian-1.0", "1280x1024 at 190 deg, Gaussian of 1 px", W1280, &spread(gaussian(1.0))),
        world("gaussian-1.5", "640x480 at 120 deg, Gaussian of 1.5 px", W640, &spread(gaussian(1.5))),
        world("moffat-0.5", "752x480, Moffat of beta 3 as wide as 0.5 px", W752, &spread(moffat(0.5, 3.0))),
        world("moffat-0.8", "960x600, Moffat of beta 2.5 as wide as 0.8 px", W960, &spread(moffat(0.8, 2.5))),
        world(
            "moffat-1.2",
            "1280x1024 at 190 deg, Moffat of beta 4 as wide as 1.2 px",
            W1280,
            &spread(moffat(1.2, 4.0)),
        ),
        world("coma", "752x480, Gaussian of 0.5 px, coma of 0.8 px per rad", W752, &|preset| {
            let coma = Aberrations { coma_px_per_rad: 0.8, ..Default::default() };
            preset.lens.spread = gaussian(0.5).with_aberrations(coma).expect("a lens");
        }),
        world(
            "coma-off-centre",
            "1280x1024 at 190 deg, Gaussian of 0.7 px, coma from the axis on, longer and wider aside",
            W1280,
            &|preset| {
                let bent = Aberrations {
                    widening_per_rad2: 0.15,
                    elongation_per_rad2: 0.2,
                    coma_px_per_rad: 0.4,
                    axis_coma_px: [0.35, -0.25],
                };
                preset.lens.spread = gaussian(0.7).with_aberrations(bent).expect("a lens");
            },
        ),
        world(
            "core-halo",
            "752x480, core of 0.6 px, a quarter of the light in a halo of 3.5 px",
            W752,
            &spread(core_and_halo(0.6, 3.5, 0.25)),
        ),
        world("full-240", "752x480, 0.5 px, a full pixel reads 240", W752, &|preset| {
            preset.lens.spread = gaussian(0.5);
            full(preset, 240.0, 0.0, 0.0);
        }),
        world(
            "full-255-noise",
            "960x600, 0.6 px, a full pixel reads 250 to 255 with noise",
            W960,
            &|preset| {
                preset.lens.spread = gaussian(0.6);
                full(preset, 253.0, 0.006, 1.5);
            },
        ),
        world(
            "full-230-noise",
            "752x480, 0.8 px, a full pixel reads 230 with noise, half the excess spills",
            W752,
            &|preset| {
                preset.lens.spread = gaussian(0.8);
                full(preset, 230.0, 0.01, 2.0);
                preset.sensor.overflow = Overflow { spill: 0.5 };
            },
        ),
        world(
            "spill-0.5",
            "752x480, 0.4 px, a full pixel reads 255, half the excess spills",
            W752,
            &|preset| {
                full(preset, 256.0, 0.0, 0.0);
                preset.sensor.overflow = Overflow { spill: 0.5 };
            },
        ),
        world(
            "spill-1",
            "640x480 at 120 deg, 0.5 px, a full pixel reads 250, all the excess spills",
            W640,
            &|preset| {
                preset.lens.spread = gaussian(0.5);
                full(preset, 250.0, 0.0, 0.0);
                preset.sensor.overflow = Overflow { spill: 1.0 };
            },
        ),
        world("vignette", "960x600, 0.6 px, rims cut light off from 25 deg on", W960, &|preset| {
            preset.lens.spread = gaussian(0.6);
            preset.lens.side_illumination = 0.3;
            preset.lens.vignette = Vignette::new(25.0_f64.to_radians(), 110.0_f64.to_radians());
        }),
        world("noise-0.3", "752x480, Moffat as wide as 0.6 px, a third of the noise", W752, &|preset| {
            preset.lens.spread = moffat(0.6, 3.0);
            noise(preset, 0.3);
        }),
        world("noise-3", "960x600, Gaussian of 0.5 px, three times the noise", W960, &|preset| {
            preset.lens.spread = gaussian(0.5);
            noise(preset, 3.0);
        }),
        world(
            "ccd",
            "752x480, 0.7 px, smear along columns, unequal pixels and columns, hot pixels",
            W752,
            &|preset| {
                preset.lens.spread = gaussian(0.7);
                full(preset, 245.0, 0.01, 0.5);
                let sensor = &mut preset.sensor;
                sensor.smear = ColumnSmear { share: 2e-4 };
                sensor.pattern =
                    Pattern { offset_dn: 1.0, column_offset_dn: 0.5, gain: 0.015, ..sensor.pattern };
                (sensor.hot_pixel_share, sensor.hot_pixel_e_per_s) = (1e-4, 1e6);
            },
        ),
        world(
            "measured-752",
            "752x480, the point spread of the real photos of that size: a pixel and its neighbours",
            W752,
            &spread(measured(include_str!("measured_optics/measured-752x480.toml"))),
        ),
        world(
            "measured-960",
            "960x600, the point spread of the real photos of that size: a disc 4 px wide, uneven",
            W960,
            &spread(measured(include_str!("measured_optics/measured-960x600.toml"))),
        ),
        world("twelve-bits", "1280x1024 at 190 deg, 0.9 px, 12 bits, unequal gains", W1280, &|preset| {
            preset.lens.spread = gaussian(0.9);
            preset.sensor.converter = Converter::new(12).expect("12 bits");
            preset.sensor.pattern = Pattern { gain: 0.01, ..Pattern::NONE };
        }),
    ]
}

/// A well that is full at a grey level, with the spread between pixels and the noise between frames.
fn full(preset: &mut Preset, reads_dn: f64, spread: f64, noise_dn: f64) {
    let sensor = &mut preset.sensor;
    sensor.full_well_e = (reads_dn - sensor.dark_offset_dn) * sensor.electrons_per_dn;
    sensor.pattern = Pattern { well: spread, ..sensor.pattern };
    sensor.well_noise_e = noise_dn * sensor.electrons_per_dn;
}

/// The same grey levels with `times` the noise: a pupil that gathers fewer electrons for each, and reading as much noisier.
fn noise(preset: &mut Preset, times: f64) {
    let fewer = times * times;
    preset.lens.pupil_m2 /= fewer;
    let sensor = &mut preset.sensor;
    sensor.electrons_per_dn /= fewer;
    sensor.full_well_e /= fewer;
    sensor.dark_current_e_per_s /= fewer;
    sensor.read_noise_e /= times;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_the_kinds_are_all_there() {
        let worlds = worlds();
        assert!(worlds.len() >= 16);
        for (i, world) in worlds.iter().enumerate() {
            assert!(worlds[..i].iter().all(|other| other.name != world.name), "{}", world.name);
            let sensor = &world.preset.sensor;
            let full_dn = sensor.full_well_e / sensor.electrons_per_dn + sensor.dark_offset_dn;
            assert!(full_dn >= 229.9 && sensor.full_well_e.is_finite(), "{full_dn}: {}", world.name);
        }
        for (width, height, across_deg) in [(752, 480, 162.3), (1280, 1024, 190.0), (640, 480, 120.0)] {
            let camera = |world: &&World| (world.camera.width(), world.camera.height()) == (width, height);
            let camera = &worlds.iter().find(camera).unwrap().camera;
            let edge = camera.bearing(Pixel::new(width as f64 - 1.0, 0.5 * height as f64 - 0.5)).unwrap();
            let deg = 2.0 * edge.off_axis_rad().to_degrees();
            assert!((deg - across_deg).abs() < 1.0, "{deg} of {width}x{height}");
        }
    }

    #[test]
    fn three_times_the_noise_is_three_times_the_noise_in_grey_levels() {
        let (one, mut three) = (plain(), plain());
        noise(&mut three, 3.0);
        let sigma_dn = |preset: &Preset, light_dn: f64| {
            let sensor = &preset.sensor;
            let variance_e2 = sensor.read_noise_e.powi(2) + light_dn * sensor.electrons_per_dn;
            variance_e2.sqrt() / sensor.electrons_per_dn
        };
        for light_dn in [0.0, 10.0, 200.0] {
            assert!((sigma_dn(&three, light_dn) / sigma_dn(&one, light_dn) - 3.0).abs() < 1e-9);
        }
        let gathered = |preset: &Preset| preset.lens.pupil_m2 / preset.sensor.electrons_per_dn;
        assert!((gathered(&three) / gathered(&one) - 1.0).abs() < 1e-9, "the same grey levels");
    }
}
