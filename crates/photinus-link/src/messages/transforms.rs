//! tf: where the camera sits on its vehicle, and where neighbours are whose id is known.

use photinus_io::calibration::MountingFile;
use photinus_io::results::FrameRecord;

use crate::ros::{Header, TFMessage, Transform, TransformStamped};

/// A frame `neighbour_ID` per followed vehicle whose id is known: in its body axes, x forward, y left, z up.
pub(super) fn of(record: &FrameRecord, header: &Header) -> TFMessage {
    let named = record.tracks.iter().filter_map(|track| Some((track.id?, track)));
    let transform = |(id, track): (u32, &photinus_io::results::TrackRecord)| TransformStamped {
        header: header.clone(),
        child_frame_id: format!("neighbour_{id}"),
        transform: Transform {
            translation: track.position_m.into(),
            rotation: track.orientation_xyzw.into(),
        },
    };
    TFMessage { transforms: named.map(transform).collect() }
}

/// Where a camera's optical frame sits in the body frame `base` of its vehicle; `None` where the mounting does not say where the camera is.
#[must_use]
pub fn mounting_transform(mounting: &MountingFile, base: &str, optical: &Header) -> Option<TransformStamped> {
    Some(TransformStamped {
        header: Header { stamp: optical.stamp, frame_id: base.to_owned() },
        child_frame_id: optical.frame_id.clone(),
        transform: Transform {
            translation: mounting.position_m?.into(),
            rotation: mounting.body_from_camera.into(),
        },
    })
}
