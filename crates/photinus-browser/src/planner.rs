//! A set-up as text -> how far and how exactly it sees, as `photinus plan --json` tells it.

use std::path::Path;

use photinus_plan::{Plan, Setup};
use serde::Serialize;

use crate::told;

/// What is wrong with a set-up.
#[derive(Debug, Serialize)]
struct Refused {
    wrong: String,
}

/// The plan, or `{"wrong": reason}`.
pub fn plan(set_up: &str) -> Option<String> {
    match Setup::parse(set_up, Path::new("set-up")) {
        Ok(setup) => told::json(&Plan::new(&setup)),
        Err(error) => told::json(&Refused { wrong: error.to_string() }),
    }
}
