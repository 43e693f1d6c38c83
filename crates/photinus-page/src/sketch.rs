//! What the page draws of a located frame: enters an entry, leaves JSON with a JPEG behind it.
//!
//! A message is 4 bytes with the length of the JSON (little endian), the JSON, then the picture, if any.
//! The view from above has x forward and y left: the body frame where the mounting is known, otherwise the camera's, seen from above a level camera.

use jpeg_encoder::{ColorType, Encoder};
use photinus_io::results::FrameRecord;
use photinus_run::Entry;
use serde::Serialize;

/// The quality of pictures, 1 to 100: 20 kB of a frame of 752 x 480.
const QUALITY: u8 = 70;
/// The most spots and neighbours that are drawn.
const MOST: usize = 200;

#[derive(Serialize)]
struct Sketch<'a> {
    camera: usize,
    name: &'a str,
    frame: u64,
    time_s: Option<f64>,
    latency_ms: Option<f64>,
    dropped: u64,
    exposure_us: Option<f64>,
    size: Option<[usize; 2]>,
    /// Place, px, and whether it is likely a marker.
    spots: Vec<(f64, f64, f64)>,
    rejected: Vec<(f64, f64)>,
    neighbours: Vec<Drawn>,
    tracks: Vec<Drawn>,
}

/// A neighbour or a track.
#[derive(Serialize)]
struct Drawn {
    id: Option<u32>,
    track: Option<u64>,
    probability: Option<f64>,
    predicted: bool,
    spots: Vec<usize>,
    distance_m: Option<f64>,
    sigma_m: Option<f64>,
    bounds_m: Option<(f64, Option<f64>)>,
    /// Forward and left, m.
    above_m: Option<[f64; 2]>,
    /// Their covariance: xx, xy, yy, m^2.
    above_m2: Option<[f64; 3]>,
}

/// The message of a frame.
pub(crate) fn message(entry: &Entry) -> Vec<u8> {
    let json = serde_json::to_vec(&Sketch::of(entry)).unwrap_or_default();
    packed(&json, &picture(entry).unwrap_or_default())
}

/// JSON with a picture behind it.
pub(crate) fn packed(json: &[u8], picture: &[u8]) -> Vec<u8> {
    let mut message = Vec::with_capacity(4 + json.len() + picture.len());
    message.extend_from_slice(&u32::try_from(json.len()).unwrap_or(u32::MAX).to_le_bytes());
    message.extend_from_slice(json);
    message.extend_from_slice(picture);
    message
}

/// A JPEG; `None` without pixels, or of a size that JPEG has not.
fn picture(entry: &Entry) -> Option<Vec<u8>> {
    let image = entry.image.as_ref()?;
    let (width, height) =
        (u16::try_from(image.view().width()).ok()?, u16::try_from(image.view().height()).ok()?);
    let mut bytes = Vec::new();
    Encoder::new(&mut bytes, QUALITY).encode(image.pixels(), width, height, ColorType::Luma).ok()?;
    Some(bytes)
}

impl<'a> Sketch<'a> {
    fn of(entry: &'a Entry) -> Self {
        let record = &entry.record;
        let view = entry.image.as_ref().map(|image| image.view());
        Self {
            camera: entry.camera,
            name: record.camera.as_deref().unwrap_or_default(),
            frame: entry.number(),
            time_s: record.time_s,
            latency_ms: record.latency_s.map(|latency_s| 1e3 * latency_s),
            dropped: entry.dropped,
            exposure_us: entry.exposure_s.map(|exposure_s| 1e6 * exposure_s),
            size: view.map(|view| [view.width(), view.height()]),
            spots: record
                .spots
                .iter()
                .take(MOST)
                .map(|spot| (spot.u_px, spot.v_px, spot.probability))
                .collect(),
            rejected: record.rejected.iter().take(MOST).map(|spot| (spot.u_px, spot.v_px)).collect(),
            neighbours: neighbours(record),
            tracks: tracks(record),
        }
    }
}

fn neighbours(record: &FrameRecord) -> Vec<Drawn> {
    let drawn = record.neighbours.iter().take(MOST).map(|neighbour| {
        let body = neighbour.position_body_m.zip(neighbour.position_body_covariance_m2);
        let camera = neighbour.position_m.zip(neighbour.position_covariance_m2);
        let (above_m, above_m2) = above(body, camera);
        Drawn {
            id: neighbour.id,
            track: neighbour.track,
            probability: neighbour.probability,
            predicted: false,
            spots: neighbour.spots.clone(),
            distance_m: neighbour.distance_m.estimate,
            sigma_m: neighbour.distance_m.sigma,
            bounds_m: Some((neighbour.distance_m.min, neighbour.distance_m.max)),
            above_m,
            above_m2,
        }
    });
    drawn.collect()
}

fn tracks(record: &FrameRecord) -> Vec<Drawn> {
    let drawn = record.tracks.iter().take(MOST).map(|track| {
        let body = track.position_body_m.zip(track.position_body_covariance_m2);
        let (above_m, above_m2) = above(body, Some((track.position_m, track.position_covariance_m2)));
        let [x, y, z] = track.position_m;
        Drawn {
            id: track.id,
            track: Some(track.track),
            probability: Some(track.probability),
            predicted: track.predicted,
            spots: track.spots.clone(),
            distance_m: Some((x * x + y * y + z * z).sqrt()),
            sigma_m: None,
            bounds_m: None,
            above_m,
            above_m2,
        }
    });
    drawn.collect()
}

type Placed = Option<([f64; 3], [[f64; 3]; 3])>;

/// Forward and left, with their covariance: the body's x and y, or the camera's z and -x.
fn above(body: Placed, camera: Placed) -> (Option<[f64; 2]>, Option<[f64; 3]>) {
    match (body, camera) {
        (Some((at, c)), _) => (Some([at[0], at[1]]), Some([c[0][0], c[0][1], c[1][1]])),
        (None, Some((at, c))) => (Some([at[2], -at[0]]), Some([c[2][2], -c[2][0], c[0][0]])),
        (None, None) => (None, None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seen_from_above_forward_is_up_and_left_is_left() {
        let c = [[1.0, 2.0, 3.0], [2.0, 4.0, 5.0], [3.0, 5.0, 6.0]];
        // Right of and before the camera: forward, and to the right of the vehicle.
        assert_eq!(above(None, Some(([1.0, 0.0, 5.0], c))), (Some([5.0, -1.0]), Some([6.0, -3.0, 1.0])));
        let body = Some(([5.0, 1.0, 0.0], c));
        assert_eq!(above(body, Some(([0.0; 3], c))), (Some([5.0, 1.0]), Some([1.0, 2.0, 4.0])));
    }
}
