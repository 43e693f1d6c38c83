//! Set-ups drawn at random: a text like a user's, with other LEDs, lenses, sensors, skies and airframes.

use std::path::Path;

use photinus_plan::Setup;
use rand_distr::{Distribution, StandardUniform};
use rand_pcg::Pcg64;

/// Sensors that are drawn from: parts, and the pixels that a drawn focal length is for.
const SENSORS: [(&str, f64); 3] =
    [("mvbluefox-mlc200wg", 6.0), ("omnivision-ov9281", 3.0), ("sony-imx296", 3.45)];

/// A set-up with a name for the table.
pub(crate) struct Drawn {
    pub(crate) name: String,
    pub(crate) setup: Setup,
}

/// Set-up number `number`.
pub(crate) fn drawn(number: u64) -> Drawn {
    let mut random = Pcg64::new(u128::from(number), 0x9e7);
    let mut share = || -> f64 { StandardUniform.sample(&mut random) };
    let most_arms = 3 + (share() * 6.0) as usize;
    let radius_m = 0.15 * libm::pow(4.0, share());
    let leds_per_arm = 1 + usize::from(share() < 0.4);
    // of three arms with an LED each half of all headings show one alone
    let arms = if leds_per_arm == 1 { most_arms.max(4) } else { most_arms };
    let splay_deg = if leds_per_arm == 2 { 60.0 + 60.0 * share() } else { 0.0 };
    let (sensor, pixel_um) = SENSORS[(share() * 3.0) as usize];
    let (power_mw, lobe_power) = (50.0 * libm::pow(10.0, share()), if share() < 0.3 { 2.0 } else { 1.0 });
    let exposure_us = 200.0 * libm::pow(10.0, share());
    let (focal_mm, transmission) = (1.4 + 1.6 * share(), 0.05 * libm::pow(4.0, share()));
    let (core_px, halo_share) = (0.35 + 0.6 * share(), 0.3 * share());
    let contrast = 15 + (share() * 15.0) as u8;
    let unit_spread = 0.05 + 0.2 * share();
    let sky = ["night", "overcast", "clear"][(share() * 3.0) as usize];
    let text = format!(
        "exposure_us = {exposure_us:.1}\n\
         [led]\npart = \"prolight-pm2b-1lle\"\nradiant_power_mw = {power_mw:.1}\nlobe_power = {lobe_power}\nunit_spread = {unit_spread:.2}\n\
         [filter]\ntransmission = {transmission:.3}\n\
         [lens]\npart = \"sunnex-dsl215\"\nfocal_mm = {focal_mm:.2}\ncore_um = {:.2}\nhalo_um = {:.2}\nhalo_share = {halo_share:.2}\n\
         [sensor]\npart = \"{sensor}\"\n\
         [airframe]\nring = {{ arms = {arms}, radius_m = {radius_m:.2}, leds_per_arm = {leds_per_arm}, splay_deg = {splay_deg:.0} }}\n\
         [sky]\nkind = \"{sky}\"\nsun_deg = 50.0\n\
         [detector]\ncontrast = {contrast}\n",
        core_px * pixel_um,
        2.5 * pixel_um,
    );
    let arm = if leds_per_arm == 2 { format!("2 at {splay_deg:.0} deg") } else { "1".to_owned() };
    let name = format!(
        "{arms} arms of {radius_m:.2} m, {arm}; {power_mw:.0} mW, {exposure_us:.0} us, f = {focal_mm:.1} mm, {sensor}, {sky}"
    );
    let setup = Setup::parse(&text, Path::new("drawn.toml"));
    Drawn { name, setup: setup.unwrap_or_else(|error| panic!("{error}\n{text}")) }
}
