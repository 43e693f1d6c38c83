//! What was found, to read.

use std::fmt;

use photinus::airframe::Airframe;
use photinus_calibrate::airframe_layout::Layout;
use photinus_io::calibration::LedSighting;

/// The text for the terminal.
pub(super) struct Told<'a> {
    pub(super) found: &'a Layout,
    pub(super) nominal: &'a Airframe,
    pub(super) rows: &'a [LedSighting],
    pub(super) photos: &'a [&'a str],
}

impl fmt::Display for Told<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { found, nominal, rows, .. } = self;
        writeln!(f, "LED    photos        x         y         z (m)   sigma (mm)   from nominal (mm)")?;
        for (number, marker) in nominal.markers().iter().enumerate() {
            let leds: Vec<String> = marker.leds.iter().map(ToString::to_string).collect();
            let leds = leds.join("+");
            let of_marker = rows.iter().enumerate().filter(|(_, row)| marker.leds.contains(&row.led));
            let seen = of_marker.filter(|(index, _)| found.residuals[*index].is_some()).count();
            match (found.positions_m[number], found.covariance_of(number)) {
                (Some(place_m), Some(covariance_m2)) => writeln!(
                    f,
                    "{leds:<6} {seen:>6} {:>9.4} {:>9.4} {:>9.4}       {:>7.2}             {:>7.1}",
                    place_m.x,
                    place_m.y,
                    place_m.z,
                    1e3 * (covariance_m2.trace() / 3.0).sqrt(),
                    1e3 * (place_m - marker.position_m).norm()
                )?,
                _ => writeln!(
                    f,
                    "{leds:<6} {seen:>6}   in too few photos: it stays where the nominal airframe has it"
                )?,
            }
        }
        self.photos(f)
    }
}

impl Told<'_> {
    fn photos(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { found, rows, photos, .. } = self;
        let residual_px =
            |index: usize| Some(found.residuals[index]? * rows[index].sigma_px.unwrap_or(super::SIGMA_PX));
        let used: Vec<f64> = (0..rows.len()).filter_map(residual_px).collect();
        let mean_px = used.iter().sum::<f64>() / used.len() as f64;
        let most_px = used.iter().copied().fold(0.0, f64::max);
        let posed = found.photos.iter().flatten().count();
        write!(
            f,
            "residuals  mean {mean_px:.3} px, largest {most_px:.3} px, of {} sightings in {posed} photos",
            used.len()
        )?;
        for &index in &found.outliers {
            write!(
                f,
                "\nnot used   line {}: LED {} in {} is too far off",
                rows[index].line, rows[index].led, rows[index].photo
            )?;
        }
        let unused = photos.iter().zip(&found.photos).filter(|(_, pose)| pose.is_none());
        for (photo, _) in unused {
            write!(f, "\nnot used   {photo}: fewer than four LEDs that other photos show too")?;
        }
        Ok(())
    }
}

/// Standard deviation of a position per axis, m, over all LEDs that were placed.
pub(super) fn mean_sigma_m(found: &Layout) -> f64 {
    (found.covariance_m2.trace() / found.covariance_m2.nrows() as f64).sqrt()
}

/// The head of the file.
pub(super) fn comment(found: &Layout, has_scale: bool) -> String {
    format!(
        "# photinus calibrate airframe: {} photos, positions known to {:.2} mm on average; axes, lobes and signals are nominal,\n\
         # and so are origin, axes of the body frame{}.\n",
        found.photos.iter().flatten().count(),
        1e3 * mean_sigma_m(found),
        if has_scale { "" } else { " and scale" }
    )
}
