//! What was learned, to read.

use std::fmt;

use photinus::optics::Measured;
use photinus_calibrate::optics::{Learned, Unseen};

use super::Width;

/// Light at which a bend of the response is told, grey levels.
const BRIGHT_DN: f64 = 200.0;

/// The text for the terminal.
pub(super) struct Told<'a>(pub(super) &'a Learned);

impl fmt::Display for Told<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let learned = self.0;
        let (sensor, spread) = (&learned.optics.sensor, &learned.optics.spread);
        writeln!(f, "{} spots of {} frames", learned.spots, learned.frames)?;
        let middle = spread.zones().len() / 2 + if spread.columns() > 1 { spread.columns() / 2 } else { 0 };
        let middle = spread.zones().get(middle).or(spread.zones().first());
        if let Some(zone) = middle {
            writeln!(
                f,
                "  point spread      {} in the middle, {} zones",
                Width::of(zone),
                spread.zones().len()
            )?;
        }
        let error =
            Measured { value: 100.0 * spread.shape_error(), sigma: 100.0 * learned.shape_error_sigma };
        let wings =
            format!("% of a pixel's light; beside its summit {}", crate::info::known_beside_summit(spread));
        line(f, "shape known to", error, &wings, "")?;
        writeln!(
            f,
            "  {:<17} {:.4} px, depending on where in a pixel a spot is",
            "places off by",
            spread.place_error_px()
        )?;
        let seen = |unseen: Unseen| {
            if learned.unseen.contains(&unseen) { "  (not measured: the usual value)" } else { "" }
        };
        let sources = crate::info::sources(spread.source_size());
        writeln!(f, "  {:<17} {sources}{}", "sources", seen(Unseen::Sources))?;
        match sensor.dark_dn {
            Some(dark) => line(f, "darkness", dark, "grey levels", "")?,
            None => writeln!(f, "  darkness          not measured: clipped at 0")?,
        }
        line(f, "read noise", sensor.read_noise_dn, "grey levels", seen(Unseen::ReadNoise))?;
        line(f, "shot noise", sensor.shot, "grey levels^2 per grey level", seen(Unseen::ShotNoise))?;
        match sensor.response.map(|response| (response, response.missing_share(BRIGHT_DN))) {
            Some((response, Measured { value, sigma })) => {
                let shape = if response.is_bent() { "bent" } else { "straight" };
                let missing = Measured { value: 100.0 * value, sigma: 100.0 * sigma };
                line(
                    f,
                    "response",
                    missing,
                    &format!("% less than in proportion at {BRIGHT_DN:.0}: {shape}"),
                    "",
                )?;
            }
            None => writeln!(f, "  response          not measured: taken for straight")?,
        }
        let full = Measured {
            value: sensor.saturation.level_dn,
            sigma: learned.saturation_sigma_dn.unwrap_or_default(),
        };
        line(f, "full pixels read", full, "grey levels", seen(Unseen::Saturation))?;
        let spread_dn = sensor.saturation.spread_dn;
        if learned.saturation_sigma_dn.is_some() {
            writeln!(f, "                    with a spread of {spread_dn:.2} grey levels")?;
        }
        line(f, "spill of excess", sensor.spill, "of it, the rest is drained", seen(Unseen::Spill))?;
        match sensor.full_well_dn {
            Some(well) if learned.unseen.contains(&Unseen::Spill) => {
                writeln!(f, "                    below {:.0} grey levels nothing spills", well.value)?;
            }
            Some(well) => line(f, "full well", well, "grey levels", "")?,
            None => {}
        }
        if let Some(smear) = sensor.column_smear {
            writeln!(f, "  column smear      {:.1e} ± {:.1e} of a column's light", smear.value, smear.sigma)?;
        }
        if let Some(vignetting) = &learned.optics.vignetting {
            let (angles_rad, shares, sigmas) = vignetting.table();
            if let ([.., rad], [.., share], [.., sigma]) = (angles_rad, shares, sigmas) {
                let passes = Measured { value: 100.0 * share, sigma: 100.0 * sigma };
                let unit = format!("% of the light passes {:.0}° off the axis", rad.to_degrees());
                line(f, "vignetting", passes, &unit, "")?;
            }
        }
        if !learned.unseen.contains(&Unseen::HotPixels) {
            let hot = learned.optics.hot_pixels.iter();
            let count = hot.len();
            let brightest = hot.map(|hot| hot.level_dn.value).fold(0.0, f64::max);
            let so_bright =
                if count > 0 { format!(", up to {brightest:.0} grey levels") } else { String::new() };
            writeln!(f, "  hot pixels        {count}{so_bright}")?;
        }
        let unseen: Vec<&str> = learned.unseen.iter().map(|unseen| unseen.name()).collect();
        write!(f, "  not measured      {}", unseen.join(", "))
    }
}

fn line(f: &mut fmt::Formatter<'_>, name: &str, measured: Measured, unit: &str, note: &str) -> fmt::Result {
    let digits = if measured.sigma < 0.01 { 4 } else { 2 };
    writeln!(f, "  {name:<17} {:.digits$} ± {:.digits$} {unit}{note}", measured.value, measured.sigma)
}
