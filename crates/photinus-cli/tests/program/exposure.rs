//! Exposure control in a closed loop: `photinus run` sets the exposure of a simulated camera, before which a neighbour recedes and comes back, or blinks.

use crate::stage::Stage;

const FRAMES: usize = 240;
const SCENES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes");

/// What is seen of the neighbour in a frame.
#[derive(Clone, Copy, Debug)]
struct Seen {
    is_found: bool,
    /// Pixels of its spots that are saturated.
    full_px: u64,
}

/// Flies a hexarotor from 3 m to 14 m and back before a camera that begins with this exposure; every frame, in order.
fn flown(name: &str, exposure_us: f64, control: &str) -> Vec<Seen> {
    let stage = Stage::new(name);
    stage.file(
        "scene.toml",
        format!(
            "name = \"near and far\"\nseed = 3\npreset = \"bluefox-dsl215-bp365\"\nrate_hz = 20.0\nduration_s = 12.0\nexposure_us = 1000.0\n\
             [observer]\nmotion = {{ hover = {{ position_m = [0.0, 0.0, 5.0] }} }}\n\
             [[camera]]\nname = \"front\"\nfile = \"{SCENES}/cameras/bluefox-dsl215.toml\"\nposition_m = [0.0, 0.0, 0.0]\n\
             [[target]]\nid = 1\nairframe = \"{SCENES}/airframes/hexarotor-0.4.toml\"\nheading_deg = 170\n\
             motion = {{ line = {{ from_m = [3.0, 0.2, 5.3], to_m = [14.0, 0.2, 5.3], duration_s = 6.0 }} }}\n"
        ),
    );
    stage.file(
        "run.toml",
        format!(
            "pace = \"fast\"\n[[camera]]\nname = \"front\"\nsource = {{ scene = \"scene.toml\" }}\nexposure_us = {exposure_us}\n\
             camera = \"{SCENES}/cameras/bluefox-dsl215.toml\"\n[airframe]\nfile = \"{SCENES}/airframes/hexarotor-0.4.toml\"\n\
             [json]\nfile = \"live.jsonl\"\n{control}"
        ),
    );
    let done = stage.run("run run.toml -q");
    assert_eq!(done.code, 0, "{}", done.err);
    let seen = |line: &str| {
        let record: serde_json::Value = serde_json::from_str(line).unwrap();
        let spots = record["spots"].as_array().unwrap();
        Seen {
            is_found: !record["neighbours"].as_array().unwrap().is_empty(),
            full_px: spots.iter().filter_map(|spot| spot["saturated_px"].as_u64()).sum(),
        }
    };
    stage.read("live.jsonl").lines().map(seen).collect()
}

fn count(frames: &[Seen], is: impl Fn(&Seen) -> bool) -> usize {
    frames.iter().filter(|seen| is(seen)).count()
}

const CONTROL: &str = "[exposure]\nreach_m = 15.0\nshortest_us = 20.0\nlongest_us = 5000.0\n";

#[test]
fn a_neighbour_is_found_near_and_far_where_fixed_exposures_lose_or_saturate_it() {
    let short = flown("exposure-short", 60.0, "");
    assert_eq!(short.len(), FRAMES);
    assert!(count(&short, |seen| !seen.is_found) > FRAMES / 2, "{short:?}");
    let long = flown("exposure-long", 5000.0, "");
    assert!(count(&long, |seen| seen.full_px > 0) > FRAMES / 2, "{long:?}");
    // It begins far too dark, and far too bright.
    for first_us in [60.0, 5000.0] {
        let set = flown(&format!("exposure-set-{first_us}"), first_us, CONTROL);
        assert_eq!(count(&set, |seen| seen.is_found), FRAMES, "from {first_us} us: {set:?}");
    }
}

#[test]
fn alternating_gives_the_nearest_a_frame_that_is_not_saturated() {
    let one = flown("exposure-one", 5000.0, CONTROL);
    let two = flown("exposure-two", 5000.0, &format!("{CONTROL}alternate = true\n"));
    assert_eq!(count(&two, |seen| seen.is_found), FRAMES, "{two:?}");
    // After a dozen frames the light is known; then of any three in a row one is measurable.
    let blind = |frames: &[Seen]| {
        frames[12..].windows(3).filter(|three| three.iter().all(|seen| seen.full_px > 0)).count()
    };
    assert_eq!(blind(&two), 0, "{two:?}");
    assert!(blind(&one) > FRAMES / 5, "{one:?}");
}

/// Frames of a simulated camera in which a hexarotor that blinks is named, and those in which it is saturated, of 360.
fn named(name: &str, control: &str) -> [usize; 2] {
    let stage = Stage::new(name);
    let codes = format!("{SCENES}/codes/l14-d3-r3.txt");
    let airframe = format!("{SCENES}/airframes/hexarotor-0.4.toml");
    stage.file(
        "scene.toml",
        format!(
            "name = \"it blinks\"\nseed = 117\npreset = \"bluefox-dsl215-bp365\"\nrate_hz = 60.0\nduration_s = 6.0\nexposure_us = 1000.0\n\
             [observer]\nmotion = {{ hover = {{ position_m = [0.0, 0.0, 5.0] }} }}\n\
             [[camera]]\nname = \"front\"\nfile = \"{SCENES}/cameras/bluefox-dsl215.toml\"\nposition_m = [0.0, 0.0, 0.0]\n\
             [[target]]\nid = 1\nairframe = \"{airframe}\"\nheading_deg = 170\n\
             motion = {{ circle = {{ centre_m = [4.0, 0.0, 5.2], radius_m = 0.3, speed_m_s = 0.5, phase_deg = 0 }} }}\n\
             blink = {{ codes = \"{codes}\", words = [2], rate_hz = 60.0, shift_s = 0.001, ppm = 12.0 }}\n"
        ),
    );
    // Its airframe is found beside the list, and is all that is said of how neighbours are built.
    std::fs::create_dir(stage.path("fleet")).unwrap();
    std::fs::copy(&airframe, stage.path("fleet/hexarotor.toml")).unwrap();
    stage.file(
        "fleet/vehicles.toml",
        "[[vehicle]]\nid = 1\nairframe = \"hexarotor.toml\"\nwords = [2]\nbit_rate_hz = 60.0\n",
    );
    stage.file(
        "run.toml",
        format!(
            "pace = \"fast\"\n[[camera]]\nname = \"front\"\nsource = {{ scene = \"scene.toml\" }}\nexposure_us = 1000\n\
             camera = \"{SCENES}/cameras/bluefox-dsl215.toml\"\n[vehicles]\nfile = \"fleet/vehicles.toml\"\ncodes = \"{codes}\"\n\
             [json]\nfile = \"live.jsonl\"\n{control}"
        ),
    );
    let done = stage.run("run run.toml -q");
    assert_eq!(done.code, 0, "{}", done.err);
    let records = stage.read("live.jsonl");
    let records = records.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap());
    records.fold([0; 2], |[named, full], record| {
        let has = |list: &str, what: fn(&serde_json::Value) -> bool| {
            usize::from(record[list].as_array().unwrap().iter().any(what))
        };
        let is_full = has("spots", |spot| spot["saturated_px"].as_u64().unwrap() > 0);
        [named + has("tracks", |track| track["id"] == 1), full + is_full]
    })
}

#[test]
fn one_that_blinks_is_named_whatever_the_exposures() {
    let [still, full] = named("exposure-word", "");
    let [changing, full_of_both] = named("exposure-word-two", &format!("{CONTROL}alternate = true\n"));
    assert!(still > 340 && changing > 340, "{still} {changing}");
    assert!(2 * full_of_both < full, "{full_of_both} {full}: it alternates");
}
