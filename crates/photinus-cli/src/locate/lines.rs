//! Neighbours as lines to be read.

use photinus_io::results::NeighbourRecord;
use photinus_run::Entry;

/// A line per neighbour.
pub(super) fn of(entry: &Entry) -> Vec<String> {
    let frame = entry.record.frame.unwrap_or_default();
    let line = |neighbour| format!("frame {frame:>5}  {}", neighbour_line(neighbour));
    entry.record.neighbours.iter().map(line).collect()
}

/// Distance, bounds and direction of a neighbour, to be read.
fn neighbour_line(neighbour: &NeighbourRecord) -> String {
    let distance = &neighbour.distance_m;
    let sigma = distance.sigma.map_or(String::new(), |sigma| format!("± {sigma:.2}"));
    let estimate = distance.estimate.map_or_else(|| "?".to_owned(), |m| format!("{m:.2}"));
    let bounds = match distance.max {
        Some(max) => format!("{:.2} to {max:.2} m", distance.min),
        None => format!("{:.2} m or more", distance.min),
    };
    // As wide where somebody blinks and is not known yet.
    let who = match (neighbour.id, neighbour.id_probability) {
        (Some(id), _) => format!("  #{id:<3}"),
        (None, Some(_)) => " ".repeat(6),
        (None, None) => String::new(),
    };
    let [x, y, z] = neighbour.bearing;
    let (azimuth, elevation) =
        (libm::atan2(x, z).to_degrees(), libm::atan2(-y, libm::hypot(x, z)).to_degrees());
    let side = |degrees: f64, positive: &str, negative: &str| {
        format!("{:5.1}° {}", degrees.abs(), if degrees < 0.0 { negative } else { positive })
    };
    format!(
        "{}{who}  {estimate:>6} {sigma:<6} m  {bounds:<17}  {:<12} {:<11}  {} {}",
        neighbour.airframe,
        side(azimuth, "right", "left"),
        side(elevation, "up", "down"),
        neighbour.spots.len(),
        if neighbour.spots.len() == 1 { "spot" } else { "spots" }
    )
}
