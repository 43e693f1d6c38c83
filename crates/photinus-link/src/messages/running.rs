//! What the loop says of itself -> the parts of diagnostics.

use photinus_run::health::{self, CameraHealth, CameraState, SinkHealth};

use super::Health;
use crate::ros::Level;

/// Silence of a camera that is told as such, s.
const SILENT_S: f64 = 0.5;

/// Every camera and every sink of a run.
#[must_use]
pub fn parts(health: &health::Health) -> Vec<Health> {
    health.cameras.iter().map(camera).chain(health.sinks.iter().map(sink)).collect()
}

fn camera(camera: &CameraHealth) -> Health {
    let is_silent = camera.silent_s.is_some_and(|silent_s| silent_s > SILENT_S);
    let (level, message) = match camera.state {
        CameraState::Opening => (Level::Warn, "is being opened"),
        CameraState::Lost => (Level::Error, "is lost and tried again"),
        CameraState::Ended => (Level::Ok, "is at the end of its frames"),
        CameraState::Running if is_silent => (Level::Stale, "gives no frames"),
        CameraState::Running if camera.failed > 0 => (Level::Warn, "gave frames that could not be used"),
        CameraState::Running => (Level::Ok, "gives frames"),
    };
    let mut values = vec![
        ("frames".to_owned(), camera.frames.to_string()),
        ("rate_hz".to_owned(), format!("{:.2}", camera.rate_hz)),
        ("dropped".to_owned(), camera.dropped.to_string()),
        ("failed".to_owned(), camera.failed.to_string()),
        ("lost".to_owned(), camera.lost.to_string()),
        ("neighbours".to_owned(), camera.neighbours.to_string()),
    ];
    values.extend(camera.exposure_us.map(|us| ("exposure_us".to_owned(), us.to_string())));
    values.extend(camera.latency_ms.iter().flat_map(|spread| spread_values("latency_ms", spread)));
    Health { name: camera.name.clone(), level, message: message.to_owned(), values }
}

fn sink(sink: &SinkHealth) -> Health {
    let (level, message) = match (sink.running, sink.dropped) {
        (false, _) => (Level::Error, "has failed and is left out"),
        (true, 0) => (Level::Ok, "takes everything"),
        (true, _) => (Level::Warn, "was too slow for some frames"),
    };
    let mut values = vec![
        ("written".to_owned(), sink.written.to_string()),
        ("dropped".to_owned(), sink.dropped.to_string()),
        ("waiting".to_owned(), sink.waiting.to_string()),
    ];
    values.extend(sink.age_ms.iter().flat_map(|spread| spread_values("age_ms", spread)));
    Health { name: sink.name.clone(), level, message: message.to_owned(), values }
}

/// The numbers of a spread by their names.
fn spread_values(of: &str, spread: &health::Spread) -> Vec<(String, String)> {
    let value = serde_json::to_value(spread).unwrap_or_default();
    let fields = value.as_object().cloned().unwrap_or_default();
    fields.into_iter().map(|(name, value)| (format!("{of}_{name}"), value.to_string())).collect()
}
