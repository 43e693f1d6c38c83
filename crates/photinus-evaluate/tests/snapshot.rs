//! Accuracy as it was committed, number for number: the example `world` with the argument `snapshot`.

#![allow(dead_code, reason = "the example prints more than the test looks at")]

#[path = "../examples/world/cameras.rs"]
mod cameras;
#[path = "../examples/world/light.rs"]
mod light;
#[path = "../examples/world/priors.rs"]
mod priors;
#[path = "../examples/world/row.rs"]
mod row;
#[path = "../examples/world/snapshot.rs"]
mod snapshot;
#[path = "../examples/world/table.rs"]
mod table;

#[test]
fn accuracy_is_what_was_committed() {
    let committed = std::fs::read_to_string(snapshot::FILE).unwrap_or_default();
    let today = snapshot::text();
    let pairs = committed.lines().zip(today.lines()).filter(|(committed, today)| committed != today);
    let changed: Vec<String> = pairs.map(|(committed, today)| format!("- {committed}\n+ {today}")).collect();
    assert!(
        committed == today,
        "accuracy has changed; if that is meant, run\n{}\n\n{}\n\nall of it:\n{today}",
        snapshot::UPDATE,
        changed.join("\n")
    );
}
