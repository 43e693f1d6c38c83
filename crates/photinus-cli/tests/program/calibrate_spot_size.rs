//! `calibrate spot-size`: the curve that it writes, and what it refuses.

use photinus_io::spot_curve::read_spot_curve;

use crate::stage::Stage;

/// A table of areas, of 1 + 30 / l^2 px at most.
pub(crate) fn areas(exposures_us: &[f64]) -> String {
    let mut table = "distance_m,area_px,exposure_us\n".to_owned();
    for exposure_us in exposures_us {
        for index in 0..200 {
            let share = |step: f64| (f64::from(index) * step).fract();
            let distance_m = 0.5 + 8.0 * share(0.618);
            let top_px = 1.0 + exposure_us * 0.03 / (distance_m * distance_m);
            let area_px = (top_px * (0.6 + 0.4 * share(0.414))).round();
            table += &format!("{distance_m},{area_px},{exposure_us}\n");
        }
    }
    table
}

#[test]
fn a_table_of_areas_gives_the_curve_that_locate_reads() {
    let stage = Stage::new("spot-size");
    stage.file("areas.csv", areas(&[1000.0]));
    let done = stage.run("calibrate spot-size areas.csv --out spots.toml --json spots.json --plots figures");
    assert_eq!(done.code, 0);
    assert!(done.out.starts_with("1000 us: 200 spots in 200 frames\n"), "{}", done.out);
    let file = read_spot_curve(stage.path("spots.toml")).unwrap();
    assert_eq!(file.exposure_us, Some(1000.0));
    assert!((30.0..50.0).contains(&file.curve.upper().scale_px_m2), "{file:?}");
    let json: serde_json::Value = serde_json::from_str(&stage.read("spots.json")).unwrap();
    assert_eq!((json[0]["frames"].as_u64(), json[0]["share_above"].as_f64()), (Some(200), Some(0.0)));
    assert!(stage.path("figures/spot-size-1000us.png").is_file());
    let words = "locate frame.png --camera camera.toml --airframe hexa.toml --spot-curve spots.toml";
    assert_eq!(stage.run(words).code, 0);

    stage.file("two.csv", areas(&[1000.0, 2000.0]));
    assert_eq!(stage.run("calibrate spot-size two.csv --out two.toml -q").code, 0);
    let scale = |name: &str| read_spot_curve(stage.path(name)).unwrap().curve.upper().scale_px_m2;
    let ratio = scale("two-2000us.toml") / scale("two-1000us.toml");
    assert!((ratio - 2.0).abs() < 0.2, "{ratio}");
}

#[test]
fn areas_that_give_no_curve_are_refused() {
    let stage = Stage::new("spot-size-bad");
    let good = areas(&[1000.0]);
    stage.file("word.csv", good.replacen(",1000\n", ",fast\n", 1));
    stage.file("few.csv", good.lines().take(11).collect::<Vec<_>>().join("\n"));
    stage.file("near.csv", "distance_m,area_px\n1,30\n".to_owned() + &"1.2,25\n".repeat(40));
    for (words, parts) in [
        ("word.csv", &["error: word.csv, line 2: exposure_us is `fast`; give a number"][..]),
        (
            "few.csv",
            &["few.csv: at an exposure of 1000 us: 10 spots with a known distance: a curve needs 30; record"],
        ),
        ("near.csv", &["near.csv: the distances go from 1.00 m to 1.20 m", "; move the LED farther away"]),
        ("camera.toml", &["camera.toml, line 1: unknown column `model = \"equidistant\"`; name the columns"]),
        ("no.csv", &["no.csv: ", "; check the path"]),
        (".", &["holds no dataset.toml"]),
        ("word.csv --brighter nan", &["--brighter"]),
    ] {
        stage.refuses(&format!("calibrate spot-size {words}"), parts);
    }
    stage.file("same.csv", good);
    stage.refuses("calibrate spot-size same.csv --out same.csv", &["this file is an input"]);
}

#[test]
fn a_simulated_recording_gives_a_curve_as_a_user_would_do_it() {
    let stage = Stage::new("spot-size-simulated");
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/receding-led.toml");
    assert_eq!(stage.run(&format!("simulate {scene} -q --out recording --frames 420")).code, 0);
    let done = stage.run("calibrate spot-size recording --threshold 200 --out spots.toml");
    assert_eq!((done.code, done.err.as_str()), (0, ""));
    let file = read_spot_curve(stage.path("spots.toml")).unwrap();
    assert_eq!((file.exposure_us, file.threshold), (Some(1000.0), Some(200)));
}
