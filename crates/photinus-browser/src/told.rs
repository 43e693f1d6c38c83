//! What was located, as JSON with the names of the results' file (docs/file-formats.md), as far as the page shows it.

use std::fmt::{self, Write};

use photinus::locator::{Located, Neighbour};

/// Adds the JSON of a frame.
pub(crate) fn write(located: &Located, onto: &mut String) {
    // Writing to a string does not fail.
    let _ = frame(located, onto);
}

fn frame(located: &Located, onto: &mut String) -> fmt::Result {
    onto.push_str("{\"spots\":[");
    for (index, sighting) in located.sightings.iter().enumerate() {
        let spot = &sighting.spot;
        let comma = if index > 0 { "," } else { "" };
        write!(
            onto,
            "{comma}{{\"u_px\":{},\"v_px\":{},\"area_px\":{},\"peak\":{}}}",
            spot.centre.u, spot.centre.v, spot.area_px, spot.peak
        )?;
    }
    write!(onto, "],\"rejected\":{},\"neighbours\":[", located.rejected.len())?;
    for (index, neighbour) in located.neighbours.iter().enumerate() {
        if index > 0 {
            onto.push(',');
        }
        of_neighbour(neighbour, onto)?;
    }
    onto.push_str("]}");
    Ok(())
}

fn of_neighbour(neighbour: &Neighbour, onto: &mut String) -> fmt::Result {
    let members: Vec<String> = neighbour.sightings.iter().map(ToString::to_string).collect();
    let b = neighbour.bearing.vector();
    write!(
        onto,
        "{{\"spots\":[{}],\"bearing\":[{},{},{}],\"probability\":{}",
        members.join(","),
        b.x,
        b.y,
        b.z,
        neighbour.probability
    )?;
    let distance = &neighbour.distance;
    write!(
        onto,
        ",\"distance_m\":{{\"min\":{},\"max\":{}",
        json(distance.bounds.min_m()),
        json(distance.bounds.max_m())
    )?;
    if let Some(estimate) = &distance.estimate {
        write!(onto, ",\"estimate\":{},\"sigma\":{}", estimate.distance_m, estimate.sigma_m)?;
    }
    onto.push('}');
    if let Some(position) = &neighbour.position {
        let p = &position.mean_m;
        write!(onto, ",\"position_m\":[{},{},{}]", p.x, p.y, p.z)?;
    }
    onto.push('}');
    Ok(())
}

/// A number as JSON has it: what is infinite is not known.
fn json(number: f64) -> String {
    if number.is_finite() { number.to_string() } else { "null".to_owned() }
}
