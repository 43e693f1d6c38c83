//! Figure 4: the solar spectrum, and what the UV band buys: light of LED, sky and sun in one pixel, with the filter and without.
//!
//! The sun is a blackbody, as the paper takes it; air scatters (Rayleigh, and aerosols by Angstrom's law with the optical depth of
//! the simulated daylight, 0.53 at 395 nm). Ozone, which matters below 340 nm, is left out. The camera without its filter
//! is that of a grey CMOS sensor.

use core::f64::consts::PI;

use nalgebra::Vector3;
use photinus_sim::background::Daylight;

use crate::{Figure, Kind, Panel, Report, Rig, Role, Row, Tolerance};

/// Effective temperature of the sun, K, and the solid angle of its disc, sr.
const SUN_K: f64 = 5772.0;
const SUN_SR: f64 = 6.794e-5;
/// The LED: its wavelength and the width of its spectrum at half height, nm.
const LED_NM: (f64, f64) = (395.0, 13.0);
/// The band that the filter passes, as the simulated daylight takes it, nm.
const BAND_NM: (f64, f64) = (380.0, 410.0);
/// Quantum efficiency of a grey CMOS sensor without filter, (nm, share); 34 % at 395 nm is the paper's, the rest the shape of
/// such a sensor's data sheet.
const SENSOR: [(f64, f64); 10] = [
    (340.0, 0.10),
    (395.0, 0.34),
    (450.0, 0.45),
    (530.0, 0.50),
    (600.0, 0.47),
    (700.0, 0.38),
    (800.0, 0.25),
    (900.0, 0.12),
    (1000.0, 0.04),
    (1100.0, 0.0),
];
const STEP_NM: f64 = 1.0;
const FROM_NM: f64 = 300.0;
const TO_NM: f64 = 1100.0;

/// Spectral irradiance of the sun outside the atmosphere, W/m^2/nm: Planck's law.
fn above_air(wavelength_nm: f64) -> f64 {
    const PLANCK_J_S: f64 = 6.626_070_15e-34;
    const LIGHT_M_S: f64 = 299_792_458.0;
    const BOLTZMANN_J_K: f64 = 1.380_649e-23;
    let m = wavelength_nm * 1e-9;
    let exponent = PLANCK_J_S * LIGHT_M_S / (m * BOLTZMANN_J_K * SUN_K);
    let radiance = 2.0 * PLANCK_J_S * LIGHT_M_S * LIGHT_M_S / (m.powi(5) * libm::expm1(exponent));
    radiance * SUN_SR * 1e-9
}

/// Optical depths of clear air: Rayleigh scattering, and aerosols.
fn depths(wavelength_nm: f64) -> (f64, f64) {
    let at_395 = wavelength_nm / 395.0;
    (0.38 * libm::pow(at_395, -4.08), 0.15 * libm::pow(at_395, -1.3))
}

/// Direct sunlight on the ground at an air mass of 1.5, W/m^2/nm.
fn on_ground(wavelength_nm: f64) -> f64 {
    let (rayleigh, aerosol) = depths(wavelength_nm);
    above_air(wavelength_nm) * libm::exp(-1.5 * (rayleigh + aerosol))
}

/// Light of the clear sky, in proportion: half of what the air scatters comes down.
fn from_sky(wavelength_nm: f64) -> f64 {
    let (rayleigh, aerosol) = depths(wavelength_nm);
    0.5 * above_air(wavelength_nm) * (1.0 - libm::exp(-(rayleigh + aerosol)))
}

/// Quantum efficiency without filter.
fn sensor(wavelength_nm: f64) -> f64 {
    let between = SENSOR.windows(2).find(|two| (two[0].0..=two[1].0).contains(&wavelength_nm));
    between.map_or(0.0, |two| {
        let share = (wavelength_nm - two[0].0) / (two[1].0 - two[0].0);
        two[0].1 + share * (two[1].1 - two[0].1)
    })
}

fn wavelengths() -> impl Iterator<Item = f64> {
    (0..=((TO_NM - FROM_NM) / STEP_NM) as u32).map(|step| FROM_NM + STEP_NM * f64::from(step))
}

/// Photo-electrons in proportion: a spectrum in energy, through a pass band and the sensor; longer waves have more photons.
fn electrons(spectrum: impl Fn(f64) -> f64, passes: impl Fn(f64) -> bool) -> f64 {
    wavelengths().filter(|nm| passes(*nm)).map(|nm| spectrum(nm) * nm * sensor(nm) * STEP_NM).sum()
}

fn led(wavelength_nm: f64) -> f64 {
    let sigma_nm = LED_NM.1 / (8.0 * core::f64::consts::LN_2).sqrt();
    let off = (wavelength_nm - LED_NM.0) / sigma_nm;
    libm::exp(-0.5 * off * off) / (sigma_nm * (2.0 * PI).sqrt())
}

/// What the filter does to a kind of light: electrons with it over electrons without.
fn kept(spectrum: impl Fn(f64) -> f64 + Copy) -> f64 {
    electrons(spectrum, |nm| (BAND_NM.0..=BAND_NM.1).contains(&nm)) / electrons(spectrum, |_| true)
}

pub(crate) fn report(rig: &Rig) -> Report {
    let (sky_kept, led_kept, ground_kept) = (kept(from_sky), kept(led), kept(on_ground));
    let budget = Budget::of(rig);
    let peak = wavelengths().map(on_ground).fold(0.0, f64::max);
    let rows = vec![
        Row::own(
            "sunlight at 395 nm over its peak, per nm, on the ground",
            on_ground(395.0) / peak,
            Tolerance::AtMost(0.75),
            "a fall towards the UV",
        ),
        Row::own(
            "sunlight at 365 nm over its peak, per nm, on the ground",
            on_ground(365.0) / peak,
            Tolerance::AtMost(0.6),
            "steeper there, but lens glass absorbs 365 nm",
        ),
        Row::own(
            "sunlight on the ground at 395 nm (W/m^2/nm)",
            on_ground(395.0),
            Tolerance::AtLeast(0.4),
            "ASTM G173 has 0.6 to 0.9 near by: a blackbody has no lines",
        ),
        Row::own(
            "LED light that the band keeps, share",
            led_kept,
            Tolerance::AtLeast(0.9),
            "all of it, nearly",
        ),
        Row::own(
            "light of the blue sky that the band keeps, share of electrons",
            sky_kept,
            Tolerance::AtMost(0.25),
            "against the camera without filter",
        ),
        Row::own(
            "sunlight that the band keeps, share of electrons",
            ground_kept,
            Tolerance::AtMost(0.1),
            "and what sunlit ground and airframes reflect of it",
        ),
        Row::own(
            "contrast of an LED against sky: gain by the band",
            led_kept / sky_kept,
            Tolerance::AtLeast(4.0),
            "the blue sky is the worst background",
        ),
        Row::own(
            "contrast of an LED against sunlit surfaces: gain by the band",
            led_kept / ground_kept,
            Tolerance::AtLeast(10.0),
            "before the low reflectance of most surfaces in the UV",
        ),
        Row::own(
            "LED at 15 m over sky in the brightest pixel, 1000 us",
            budget.led_e(15.0) / budget.sky_e,
            Tolerance::AtLeast(2.0),
            "what a threshold has to tell apart",
        ),
    ];
    Report { figure: Figure::Spectrum, panels: vec![spectra(), budget.panel(sky_kept)], rows }
}

fn spectra() -> Panel {
    let curve = |of: fn(f64) -> f64| wavelengths().map(|nm| (nm, of(nm))).collect::<Vec<_>>();
    let led_height = 1.5 / led(LED_NM.0);
    let upright = |nm: f64| vec![(nm, 0.0), (nm, 2.0)];
    Panel::new(
        "Sunlight falls towards the ultraviolet; the LED sits where it is weak",
        "wavelength (nm)",
        "irradiance (W/m^2/nm)",
    )
    .with_ranges([FROM_NM, TO_NM], [0.0, 2.0])
    .with("sun, a blackbody above the air", Kind::Dashed, Role::Truth, curve(above_air))
    .with("sun on the ground", Kind::Line, Role::Perpendicular, curve(on_ground))
    .with("blue sky on the ground", Kind::Line, Role::Bound, curve(from_sky))
    .with(
        "LED, not to scale",
        Kind::Line,
        Role::Member(6),
        wavelengths().map(|nm| (nm, led_height * led(nm))).collect(),
    )
    .with("band of the filter", Kind::Dashed, Role::Inline, upright(BAND_NM.0))
    .with("", Kind::Dashed, Role::Inline, upright(BAND_NM.1))
}

/// Photo-electrons in one pixel, by the simulated camera.
struct Budget<'a> {
    rig: &'a Rig,
    exposure_s: f64,
    /// Of the brighter half of the sky, with the filter.
    sky_e: f64,
    saturated_e: f64,
}

impl<'a> Budget<'a> {
    fn of(rig: &'a Rig) -> Self {
        let scene = rig.scene();
        let (preset, exposure_s) = (&scene.preset, scene.exposure_us * 1e-6);
        let per_pixel_sr = rig.rad_per_px() * rig.rad_per_px();
        let horizon = Vector3::new(1.0, 0.0, 0.1).normalize();
        let radiance = scene.daylight.as_ref().map_or(0.0, |daylight: &Daylight| daylight.radiance(&horizon));
        let power_w = preset.lens.gathered_w(radiance * per_pixel_sr, 0.0);
        let sky_e = preset.sensor.photo_electrons(power_w, exposure_s, preset.emitter.photon_j());
        Self { rig, exposure_s, sky_e, saturated_e: preset.sensor.electrons_at(255.0) }
    }

    /// Of an LED that faces the camera and falls in the middle of a pixel: what the point spread leaves there.
    fn led_e(&self, distance_m: f64) -> f64 {
        let preset = &self.rig.scene().preset;
        let power_w = preset.lens.gathered_w(preset.emitter.irradiance_w_m2(1.0, distance_m), 0.0);
        let all_e = preset.sensor.photo_electrons(power_w, self.exposure_s, preset.emitter.photon_j());
        let mut charge = photinus_sim::sensor::Charge::new(33, 33);
        let light = photinus_sim::optics::PointLight {
            u_px: 16.0,
            v_px: 16.0,
            electrons: all_e,
            ..Default::default()
        };
        preset.lens.spread.draw(&light, &mut charge);
        f64::from(charge.row(16)[16])
    }

    fn panel(&self, sky_kept: f64) -> Panel {
        let led = (0..=120).map(|step| 0.5 * libm::pow(60.0, f64::from(step) / 120.0));
        let led: Vec<_> = led.map(|l| (l, self.led_e(l))).collect();
        let across = |level: f64| vec![(0.0, level), (30.0, level)];
        let mut panel = Panel::new(
            "Brightest pixel at 1000 us: an LED that faces the camera, and the sky behind it",
            "distance (m)",
            "photo-electrons",
        )
        .with_ranges([0.0, 30.0], [100.0, 1e5])
        .with("LED", Kind::Line, Role::Member(6), led)
        .with("saturation", Kind::Dashed, Role::Truth, across(self.saturated_e))
        .with("sky without the filter", Kind::Line, Role::Perpendicular, across(self.sky_e / sky_kept))
        .with("sky with the filter", Kind::Line, Role::Bound, across(self.sky_e));
        panel.is_log_y = true;
        panel
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sun_is_the_one_of_text_books() {
        let total: f64 = (100..20_000).map(|nm| above_air(f64::from(nm))).sum();
        assert!((total / 1361.0 - 1.0).abs() < 0.01, "the solar constant: {total}");
        let peak = wavelengths().max_by(|a, b| above_air(*a).total_cmp(&above_air(*b))).unwrap();
        assert!((peak - 2.897_772e6 / SUN_K).abs() <= 1.0, "Wien: {peak}");
    }

    #[test]
    fn spectra_are_weighted_by_photons_and_sensor() {
        assert!((wavelengths().map(led).sum::<f64>() - 1.0).abs() < 1e-6);
        assert!((sensor(395.0) - 0.34).abs() < 1e-12 && sensor(320.0) <= 0.0);
        assert!((kept(|_| 1.0) - 30.0 / 800.0).abs() < 0.03, "about its share of the range");
    }
}
