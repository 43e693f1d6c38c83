//! What was located, as JSON with the names of the results' file (docs/file-formats.md), as far as the page shows it.

use photinus::locator::{Located, Neighbour, Sighting};
use photinus::tracking::{Track, Tracked};
use serde::Serialize;

/// JSON of anything; what is not finite is null.
pub(crate) fn json(told: &impl Serialize) -> Option<String> {
    serde_json::to_string(told).ok()
}

/// A frame.
#[derive(Debug, Serialize)]
pub(crate) struct Frame {
    spots: Vec<Spot>,
    rejected: usize,
    neighbours: Vec<Told>,
}

#[derive(Debug, Serialize)]
struct Spot {
    u_px: f64,
    v_px: f64,
    area_px: u32,
    peak: u8,
}

#[derive(Debug, Serialize)]
struct Told {
    spots: Vec<usize>,
    bearing: [f64; 3],
    probability: f64,
    distance_m: Distance,
    /// The track that has most of its spots.
    track: Option<Followed>,
}

#[derive(Debug, Serialize)]
struct Distance {
    min: f64,
    max: f64,
    estimate: Option<f64>,
    sigma: Option<f64>,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct Followed {
    id: u64,
    velocity_m_s: [f64; 3],
}

impl Frame {
    /// What a frame told, and tracks if they were followed in it.
    pub(crate) fn of(located: &Located, tracked: Option<&Tracked>) -> Self {
        Self {
            spots: located.sightings.iter().map(Spot::from).collect(),
            rejected: located.rejected.len(),
            neighbours: located.neighbours.iter().map(|neighbour| Told::of(neighbour, tracked)).collect(),
        }
    }
}

impl From<&Sighting> for Spot {
    fn from(Sighting { spot, .. }: &Sighting) -> Self {
        Self { u_px: spot.centre.u, v_px: spot.centre.v, area_px: spot.area_px, peak: spot.peak }
    }
}

impl Told {
    fn of(neighbour: &Neighbour, tracked: Option<&Tracked>) -> Self {
        let Neighbour { bearing, distance, probability, .. } = neighbour;
        Self {
            spots: neighbour.sightings.clone(),
            bearing: (*bearing.vector()).into(),
            probability: *probability,
            distance_m: Distance {
                min: distance.bounds.min_m(),
                max: distance.bounds.max_m(),
                estimate: distance.estimate.map(|estimate| estimate.distance_m),
                sigma: distance.estimate.map(|estimate| estimate.sigma_m),
            },
            track: tracked.and_then(|tracked| followed(neighbour, tracked)),
        }
    }
}

/// The track that most of a neighbour's spots updated.
fn followed(neighbour: &Neighbour, tracked: &Tracked) -> Option<Followed> {
    let shared = |track: &Track| {
        let members = tracked.members(track);
        neighbour.sightings.iter().filter(|spot| members.contains(spot)).count()
    };
    let track = tracked.tracks.iter().max_by_key(|track| shared(track)).filter(|track| shared(track) > 0)?;
    Some(Followed { id: track.id, velocity_m_s: track.velocity_m_s.into() })
}
