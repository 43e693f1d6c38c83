//! Photos of far LEDs -> a table of the lens's point spread, for `[optics] spread = { table = { file = ... } }` of a scene.
//!
//! `cargo run --release -p photinus-sim --example measure_point_spread -- TABLE.toml SAMPLES_PER_PX HALF_PX DARK CEILING PHOTO...`
//!
//! DARK is the grey level of a pixel without light; CEILING that above it at which a soft response ends, or `linear`.

#![allow(clippy::print_stdout, reason = "a program that reports")]

use std::fmt::Write;

use photinus_io::image::read_image;
use photinus_sim::stacking::{Photo, Spot, Stacked, Wanted, find, stack};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [out, samples, half, dark, ceiling, photos @ ..] = &arguments[..] else {
        return Err("give TABLE.toml SAMPLES_PER_PX HALF_PX DARK CEILING PHOTO...".into());
    };
    let (samples, half): (usize, usize) = (samples.parse()?, half.parse()?);
    let dark_dn: f64 = dark.parse()?;
    let ceiling_dn: Option<f64> = if ceiling == "linear" { None } else { Some(ceiling.parse()?) };
    let mut spots: Vec<Spot> = Vec::new();
    for path in photos {
        let image = read_image(path)?.image;
        let levels = image.pixels().iter().map(|&level| linear(f64::from(level) - dark_dn, ceiling_dn));
        let photo = Photo::new(levels.collect(), image.width()).ok_or("no whole rows")?;
        let found = find(&photo, &Wanted { half_px: half + 1, least: 25.0, most: 1e4 });
        println!("{path}: {} spots", found.len());
        spots.extend(found);
    }
    let stacked = stack(spots, samples, half).ok_or("too few spots that stand alone for a table")?;
    println!(
        "{} spots; what is left within 2 px is {:.1} % of the summit; sigma with the pixel {:.3} px",
        stacked.spots.len(),
        100.0 * stacked.residual,
        stacked.table.variance_px2().sqrt()
    );
    std::fs::write(out, text(&stacked, samples, photos.len()))?;
    Ok(())
}

/// Light in grey levels from a level above the dark; not finite where the level tells nothing.
fn linear(above_dn: f64, ceiling_dn: Option<f64>) -> f64 {
    const HIGHEST_DN: f64 = 235.0;
    match ceiling_dn {
        None if above_dn < HIGHEST_DN => above_dn,
        Some(ceiling) if above_dn < 0.9 * ceiling => -ceiling * libm::log1p(-above_dn / ceiling),
        _ => f64::INFINITY,
    }
}

fn text(stacked: &Stacked, samples_per_px: usize, photos: usize) -> String {
    let mut text = format!(
        "# share of an LED's light in a pixel by how far its centre is from the LED's image; measured by the program\n\
         # measure_point_spread on {} LEDs of {photos} photos, what is left of their pixels is {:.1} % of the summit\n\
         samples_per_px = {samples_per_px}\nrows = [\n",
        stacked.spots.len(),
        100.0 * stacked.residual
    );
    for row in &stacked.rows {
        let numbers: Vec<String> = row.iter().map(|share| format!("{share:.5}")).collect();
        writeln!(text, "  [{}],", numbers.join(", ")).expect("a string grows");
    }
    text + "]\n"
}
