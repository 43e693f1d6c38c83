//! How a running Photinus is doing -> diagnostic_msgs/DiagnosticArray.

use crate::ros::{DiagnosticArray, DiagnosticStatus, Header, KeyValue, Level, Time};

/// What is known of one part of the program, a camera as a rule.
#[derive(Clone, Debug, PartialEq)]
pub struct Health {
    /// Its name.
    pub name: String,
    /// How it is.
    pub level: Level,
    /// That in words.
    pub message: String,
    /// Numbers that were measured, with their names: rates, drops, latencies.
    pub values: Vec<(String, String)>,
}

/// What is told of all parts at a time.
#[must_use]
pub fn diagnostics(parts: &[Health], stamp: Time) -> DiagnosticArray {
    let value = |(key, value): &(String, String)| KeyValue { key: key.clone(), value: value.clone() };
    let status = |health: &Health| DiagnosticStatus {
        level: health.level as u8,
        name: format!("photinus: {}", health.name),
        message: health.message.clone(),
        hardware_id: health.name.clone(),
        values: health.values.iter().map(value).collect(),
    };
    let header = Header { stamp, frame_id: String::new() };
    DiagnosticArray { header, status: parts.iter().map(status).collect() }
}
