//! An airframe: its markers, the ring that they form, and how many of them show from which side.

use std::path::Path;

use nalgebra::Vector3;
use photinus::airframe::{Airframe, Lobe};
use photinus_io::Result;
use photinus_io::airframe::read_airframe;

use super::{Report, counted};
use crate::aligned::{Aligned, Side};

/// From here the airframe is looked at, m: far enough that only the direction matters.
const AWAY_M: f64 = 20.0;
const AZIMUTHS_DEG: [i32; 8] = [0, 45, 90, 135, 180, -135, -90, -45];
const ELEVATIONS_DEG: [i32; 5] = [60, 30, 0, -30, -60];

pub(super) fn report(path: &Path) -> Result<Report> {
    let file = read_airframe(path)?;
    let airframe = &file.airframe;
    let mut report = Report::new("an airframe");
    report.fact("name", airframe.name());
    let (leds, markers) = (airframe.leds().len(), airframe.markers().len());
    report.fact("LEDs", format!("{leds}, {}", lobes(airframe)));
    report.fact("markers", format!("{markers} (LEDs closer than 3 cm are one)"));
    let ring = match airframe.ring() {
        Some(ring) => format!("{} markers, radius {:.4} m", ring.markers, ring.radius_m),
        None => {
            "none: the markers are on no regular ring, so there is no l_A and l_B of the paper".to_owned()
        }
    };
    report.fact("ring", ring);
    report.fact("reach", format!("{:.4} m from the origin to the farthest marker", airframe.max_radius_m()));
    report.fact("powers", powers(airframe, file.tolerances.power_sigma));
    if let Some(sigma_m) = file.tolerances.position_sigma_m {
        report.fact("positions", format!("known to {:.2} mm per axis", 1e3 * sigma_m));
    }
    report.fact("signals", signals(airframe));
    report.tables.push(markers_table(airframe));
    report.tables.push(visible_table(airframe));
    report.notes = file.notes;
    Ok(report)
}

/// How the LEDs shine: each kind of lobe with how many have it.
fn lobes(airframe: &Airframe) -> String {
    let mut kinds: Vec<(&Lobe, usize)> = Vec::new();
    for led in airframe.leds() {
        match kinds.iter_mut().find(|(lobe, _)| *lobe == &led.lobe) {
            Some((_, count)) => *count += 1,
            None => kinds.push((&led.lobe, 1)),
        }
    }
    match kinds.as_slice() {
        [(lobe, _)] => format!("all {}", in_words(lobe)),
        _ => kinds
            .iter()
            .map(|(lobe, count)| format!("{count} {}", in_words(lobe)))
            .collect::<Vec<_>>()
            .join(", "),
    }
}

fn in_words(lobe: &Lobe) -> String {
    match lobe {
        Lobe::Lambertian => "directional".to_owned(),
        Lobe::Omni => "shine in every direction".to_owned(),
        Lobe::Cosine { power } => format!("directional by cosine^{power:.2}"),
        Lobe::Table(table) => {
            let last_rad = table.entries().last().map_or(0.0, |(at_rad, _)| at_rad);
            format!("directional by a table to {:.0}°", last_rad.to_degrees())
        }
    }
}

/// The range of the LEDs' powers, and how well they are known.
fn powers(airframe: &Airframe, sigma: Option<f64>) -> String {
    let powers = || airframe.leds().iter().map(|led| led.power);
    let (least, most) =
        powers().fold((f64::INFINITY, 0.0_f64), |(low, high), power| (low.min(power), high.max(power)));
    let range = if most > least { format!("{least:.3} to {most:.3}") } else { "all alike".to_owned() };
    sigma.map_or(range.clone(), |sigma| format!("{range}, known to {:.1} %", 100.0 * sigma))
}

fn signals(airframe: &Airframe) -> String {
    let mut signals: Vec<u32> = airframe.leds().iter().filter_map(|led| led.signal).collect();
    signals.sort_unstable();
    signals.dedup();
    match signals.as_slice() {
        [] => "none".to_owned(),
        [first, .., last] if (*last - *first) as usize == signals.len() - 1 => format!("{first} to {last}"),
        _ => signals.iter().map(u32::to_string).collect::<Vec<_>>().join(", "),
    }
}

fn markers_table(airframe: &Airframe) -> Aligned {
    let mut table = Aligned::new(2, &[Side::Right; 7]);
    table.row(["marker", "x m", "y m", "z m", "LEDs", "spread mm", "yaw"]);
    for (number, marker) in airframe.markers().iter().enumerate() {
        let [x, y, z]: [f64; 3] = marker.position_m.into();
        table.row([
            number.to_string(),
            format!("{x:.4}"),
            format!("{y:.4}"),
            format!("{z:.4}"),
            marker.leds.len().to_string(),
            format!("{:.1}", 1e3 * marker.spread_m),
            format!("{:.1}°", libm::atan2(y, x).to_degrees()),
        ]);
    }
    table
}

/// Rows: from above to below; columns: around the body, 0 in front of it, 90 to its left.
fn visible_table(airframe: &Airframe) -> Aligned {
    let mut table = Aligned::new(2, &[Side::Right; 9]);
    let heading = AZIMUTHS_DEG.map(|degrees| match degrees {
        0 => "front".to_owned(),
        90 => "left".to_owned(),
        180 => "back".to_owned(),
        -90 => "right".to_owned(),
        _ => format!("{degrees}°"),
    });
    table.row(["markers seen from".to_owned()].into_iter().chain(heading));
    for elevation in ELEVATIONS_DEG {
        let side = match elevation {
            0 => "level".to_owned(),
            1.. => format!("{elevation}° above"),
            _ => format!("{}° below", -elevation),
        };
        let counts = AZIMUTHS_DEG.map(|azimuth| seen_from(airframe, azimuth, elevation).to_string());
        table.row([side].into_iter().chain(counts));
    }
    table
}

fn seen_from(airframe: &Airframe, azimuth_deg: i32, elevation_deg: i32) -> usize {
    let (sin_a, cos_a) = libm::sincos(f64::from(azimuth_deg).to_radians());
    let (sin_e, cos_e) = libm::sincos(f64::from(elevation_deg).to_radians());
    airframe.visible(Vector3::new(cos_e * cos_a, cos_e * sin_a, sin_e) * AWAY_M).count()
}

/// Name and size, in a line.
pub(super) fn in_a_line(airframe: &Airframe) -> String {
    format!("{}, {}", airframe.name(), counted(airframe.markers().len(), "marker"))
}

#[cfg(test)]
mod tests {
    use photinus::airframe::Ring;

    use super::*;

    #[test]
    fn three_markers_of_a_hexarotor_show_between_two_arms_and_signals_are_listed() {
        let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
        let hexa = Airframe::from_ring("hexa", ring).unwrap();
        assert_eq!(seen_from(&hexa, 0, 0), 3, "the arm ahead and its two neighbours");
        assert_eq!(seen_from(&hexa, 90, 0), 2, "the arms beside are edge on");
        assert_eq!(signals(&hexa), "none");
        assert_eq!(lobes(&hexa), "all directional");
        let mut leds = hexa.leds().to_vec();
        leds[1].lobe = Lobe::Cosine { power: 3.0 };
        leds[2].power = 1.25;
        let various = Airframe::new("various", leds).unwrap();
        assert_eq!(lobes(&various), "5 directional, 1 directional by cosine^3.00");
        assert_eq!(powers(&hexa, None), "all alike");
        assert_eq!(powers(&various, Some(0.02)), "1.000 to 1.250, known to 2.0 %");
    }
}
