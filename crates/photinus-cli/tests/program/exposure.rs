//! Exposure control in a closed loop: `photinus run` sets the exposure of a simulated camera, before which a neighbour recedes and comes back.

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
