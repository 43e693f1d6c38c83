//! `swarm`: what it lists, leaves, says and refuses.

use serde_json::Value;

use crate::stage::Stage;

#[test]
fn a_flight_leaves_a_folder_to_look_at() {
    let stage = Stage::new("swarm");
    let done = stage.run("swarm five --duration 3 --threads 2 --out seen");
    assert_eq!(done.code, 0);
    assert!(done.out.contains("smallest distance") && done.err.contains("seen/index.html"));
    let metrics: Value = serde_json::from_str(&stage.read("seen/metrics.json")).unwrap();
    assert_eq!((metrics["scenario"].as_str(), metrics["vehicles"].as_u64()), (Some("five"), Some(5)));
    assert!(metrics["collisions"].is_u64() && metrics["smallest_distance_m"].is_f64());
    let lines = |name: &str| -> Vec<Value> {
        stage.read(name).lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    };
    let truth = lines("seen/truth.jsonl");
    assert_eq!((truth.len(), truth[0]["vehicles"].as_array().map(Vec::len)), (60, Some(5)));
    assert_eq!(
        stage.names("seen/vehicles"),
        ["000.jsonl", "001.jsonl", "002.jsonl", "003.jsonl", "004.jsonl"]
    );
    // what is told of one who is seen is near the truth in the same lines
    let seen = lines("seen/vehicles/002.jsonl");
    let told = seen.iter().flat_map(|line| line["seen"].as_array().unwrap());
    assert!(told.filter(|told| told["is"].is_u64()).count() > 60);
    let page = stage.read("seen/index.html");
    assert!(page.contains("id=\"film\"") && page.contains("<canvas") && !page.contains("http"));
    // the same, whatever the threads
    stage.run("swarm five --duration 3 --threads 1 --out again");
    assert_eq!(stage.read("seen/metrics.json"), stage.read("again/metrics.json"));
}

#[test]
fn seeds_give_a_table() {
    let stage = Stage::new("swarm-seeds");
    let done = stage.run("swarm three --duration 2 --seeds 3 --threads 2 --out many");
    assert_eq!(done.code, 0);
    assert!(done.out.starts_with("three: 3 flights, perception stand_in: "), "{}", done.out);
    let metrics: Value = serde_json::from_str(&stage.read("many/metrics.json")).unwrap();
    let seeds: Vec<u64> =
        metrics["each"].as_array().unwrap().iter().map(|flight| flight["seed"].as_u64().unwrap()).collect();
    assert_eq!(seeds, [0, 1, 2]);
    assert!(stage.read("many/index.html").contains("smallest_distance_m"));
}

#[test]
fn carried_scenarios_are_listed_printed_and_changed() {
    let stage = Stage::new("swarm-list");
    let list = stage.run("swarm --list").out;
    for name in ["three", "hundred", "gate", "hostile", "exposure"] {
        assert!(list.lines().any(|line| line.starts_with(&format!("{name} "))), "{name}\n{list}");
    }
    let text = stage.run("swarm three --print").out;
    stage.file("mine.toml", text.replace("name = \"three\"", "name = \"mine\""));
    assert!(stage.run("swarm mine.toml --duration 1").out.starts_with("mine: 3 vehicles, 1 s"));
    stage.refuses("swarm thre", &["no file thre", "it carries three, "]);
    stage.file("bad.toml", text.replace("rate_hz = 20.0", "rate_hz = nan"));
    stage.refuses("swarm bad.toml", &["error: bad.toml, `rate_hz`: NaN is out of range; give 1 to 240"]);
    stage.file("bad.toml", text.replace("boids = {", "boyds = {"));
    stage.refuses(
        "swarm bad.toml",
        &["error: bad.toml, line ", "unknown name `boyds`", "that is no controller"],
    );
    stage.refuses("swarm mine.toml --out mine.toml", &["mine.toml"]);
}
