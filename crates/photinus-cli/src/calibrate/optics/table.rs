//! What was learned, to read.

use std::fmt;

use photinus::optics::Measured;
use photinus_calibrate::optics::{Learned, Unseen};

use super::Width;

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
        line(f, "shape known to", error, "% of a pixel's light", "")?;
        let seen = |unseen: Unseen| {
            if learned.unseen.contains(&unseen) { "  (not measured: the usual value)" } else { "" }
        };
        match sensor.dark_dn {
            Some(dark) => line(f, "darkness", dark, "grey levels", "")?,
            None => writeln!(f, "  darkness          not measured: clipped at 0")?,
        }
        line(f, "read noise", sensor.read_noise_dn, "grey levels", seen(Unseen::ReadNoise))?;
        line(f, "shot noise", sensor.shot, "grey levels^2 per grey level", seen(Unseen::ShotNoise))?;
        let full = Measured {
            value: sensor.saturation.level_dn,
            sigma: learned.saturation_sigma_dn.unwrap_or_default(),
        };
        line(f, "full pixels read", full, "grey levels", seen(Unseen::Saturation))?;
        let spread_dn = sensor.saturation.spread_dn;
        if learned.saturation_sigma_dn.is_some() {
            writeln!(f, "                    with a spread of {spread_dn:.2} grey levels")?;
        }
        line(f, "spill of excess", sensor.spill, "of it", seen(Unseen::Spill))?;
        if let Some(well) = sensor.full_well_dn {
            line(f, "full well", well, "grey levels", "")?;
        }
        if let Some(smear) = sensor.column_smear {
            line(f, "column smear", smear, "of a pixel's light", "")?;
        }
        let unseen: Vec<&str> = learned.unseen.iter().map(|unseen| unseen.name()).collect();
        write!(f, "  not measured      {}", unseen.join(", "))
    }
}

fn line(f: &mut fmt::Formatter<'_>, name: &str, measured: Measured, unit: &str, note: &str) -> fmt::Result {
    let digits = if measured.sigma < 0.01 { 4 } else { 2 };
    writeln!(f, "  {name:<17} {:.digits$} ± {:.digits$} {unit}{note}", measured.value, measured.sigma)
}
