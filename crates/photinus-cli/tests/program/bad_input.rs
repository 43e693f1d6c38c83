//! What is wrong with a file is told with the file, the place, the reason and what to do, and with the right exit code.

use photinus_io::image::{GreyImage, write_png};

use crate::stage::{AIRFRAME, CAMERA, OCAM, Stage, frame, video};

const LOCATE: &str = "locate frame.png --camera camera.toml --airframe hexa.toml";

/// Runs and expects one error with these parts.
fn refuses(stage: &Stage, words: &str, code: i32, parts: &[&str]) {
    let done = stage.run(words);
    assert_eq!(done.code, code, "{words}: {}", done.err);
    let error = done.err.lines().find(|line| line.starts_with("error: ")).unwrap_or_default();
    for part in parts {
        assert!(error.contains(part), "{words}\n{}\nlacks `{part}`", done.err);
    }
    assert_eq!(done.err.matches("error: ").count(), 1, "said once: {}", done.err);
}

#[test]
fn missing_files() {
    let stage = Stage::new("missing");
    let advice = "; check the path, which is taken from the current folder";
    for (words, file) in [
        ("detect no.png", "no.png: "),
        ("detect frame.png no.png", "no.png: "),
        ("detect frame.png --mask no.png", "no.png: "),
        ("info no.png", "no.png: "),
        ("convert no.txt out.toml", "no.txt: "),
        ("locate frame.png --camera no.txt --airframe hexa.toml", "no.txt: "),
        ("locate frame.png --camera camera.toml --airframe no.toml", "no.toml: "),
        ("locate --spots no.jsonl --camera camera.toml --airframe hexa.toml", "no.jsonl: "),
        (&format!("{LOCATE} --spot-curve no.toml"), "no.toml: "),
    ] {
        refuses(&stage, words, 2, &[file, advice]);
    }
}

#[test]
fn usage() {
    let stage = Stage::new("usage");
    refuses(&stage, "detect", 2, &["no input: name a dataset folder, image files"]);
    refuses(&stage, "locate frame.png --airframe hexa.toml", 2, &["no camera: give --camera FILE"]);
    refuses(&stage, "locate frame.png --camera camera.toml", 2, &["no airframe: give --airframe FILE"]);
    refuses(&stage, "detect frame.png --threshold 0", 2, &["--threshold"]);
    refuses(&stage, "detect frame.png --raw 9", 2, &["752x480@60"]);
    refuses(&stage, "detect frame.png frame.png --raw 9x9", 2, &["--raw takes one stream"]);
    refuses(&stage, &format!("{LOCATE} --gravity 0,0,0"), 2, &["no direction"]);
    refuses(&stage, &format!("{LOCATE} --gravity 0,nan,0"), 2, &["no direction"]);
    refuses(&stage, &format!("{LOCATE} --max-tilt 200"), 2, &["0 to 180"]);
    refuses(&stage, &format!("{LOCATE} --tilt-sigma 0"), 2, &["--tilt-sigma", "degrees, 0.01 to 180"]);
    refuses(&stage, &format!("{LOCATE} --marker-sigma 2"), 2, &["--marker-sigma"]);
    refuses(&stage, &format!("{LOCATE} --marker-sigma nan"), 2, &["metres, 0 to 1"]);
    refuses(&stage, "detect frame.png --reflection-ratio 2", 2, &["--reflection-ratio", "a share, 0 to 1"]);
    std::fs::create_dir(stage.path("nothing")).unwrap();
    refuses(&stage, "detect nothing", 2, &["holds no dataset.toml", "; name the folder of a dataset"]);
    refuses(&stage, "detect . frame.png", 2, &["a folder among several inputs; name"]);
    refuses(
        &stage,
        "detect - frame.png",
        2,
        &["standard input: a stream among several inputs; name it alone"],
    );
    refuses(&stage, "info -", 2, &["standard input: what it holds can be told of files only; save it"]);
    refuses(&stage, &format!("{LOCATE} --csv - --out -"), 2, &["both write to standard output: name a file"]);
    refuses(&stage, &format!("{LOCATE} --spots frame.png --threshold 9"), 2, &["cannot be used with"]);
}

#[test]
fn images_that_are_none() {
    let stage = Stage::new("images");
    let png = std::fs::read(stage.path("frame.png")).unwrap();
    stage.file("empty.png", "");
    stage.file("cut.png", &png[..png.len() / 2]);
    stage.file("text.png", "no image");
    refuses(&stage, "detect empty.png", 2, &["empty.png: the file is empty; "]);
    refuses(&stage, "detect cut.png", 2, &["cut.png: ", "; copy or record it again"]);
    refuses(
        &stage,
        "detect text.png",
        2,
        &["text.png: this is text in no format that Photinus knows, not an image", "; use PNG"],
    );
    refuses(&stage, "info cut.png", 2, &["cut.png: ", "; copy or record it again"]);

    // One bad frame in a run is reported, counted and skipped; the others are there.
    refuses(&stage, "detect frame.png cut.png frame.png --out s.jsonl", 1, &["cut.png: "]);
    assert_eq!(stage.read("s.jsonl").lines().count(), 2);
    assert!(stage.run("detect frame.png cut.png").err.contains("frames    1 done, 1 failed"));
}

#[test]
fn many_bad_frames_are_counted_rather_than_told() {
    let stage = Stage::new("many");
    stage.file("bad.png", "no image");
    let done = stage.run(&format!("detect frame.png {}", "bad.png ".repeat(25)));
    assert_eq!((done.code, done.err.matches("error: bad.png").count()), (1, 10));
    assert!(done.err.contains("error: 15 more frames failed"));
}

#[test]
fn frames_and_masks_of_another_size() {
    let stage = Stage::new("size");
    stage.file("other.toml", CAMERA.replace("96", "752"));
    let parts =
        ["frame.png, frame 0: the frame is 96x64, the camera 752x64; give the calibration of this camera"];
    refuses(&stage, "locate frame.png --camera other.toml --airframe hexa.toml", 2, &parts);

    write_png(stage.path("mask.png"), &GreyImage::new(vec![0, 255], 2, 1).unwrap().view()).unwrap();
    let parts = ["mask.png: the mask is 2x1, the frame 96x64; use the mask of this camera"];
    refuses(&stage, &format!("{LOCATE} --mask mask.png"), 2, &parts);
    refuses(&stage, "detect frame.png --mask mask.png", 2, &parts[..1]);
}

#[test]
fn a_colour_frame_is_taken_and_told_once() {
    let stage = Stage::new("colour");
    let grey = frame();
    let mut ppm = format!("P6\n{} {}\n255\n", grey.width(), grey.height()).into_bytes();
    ppm.extend(grey.pixels().iter().flat_map(|&level| [level; 3]));
    stage.file("colour.ppm", ppm);
    let done = stage.run("detect colour.ppm colour.ppm colour.ppm");
    assert_eq!(done.code, 0);
    assert_eq!(
        done.err.matches("note: colour.ppm: colour with three equal channels: one was taken").count(),
        1
    );
    let spots = |text: &str| text.lines().map(|line| line[11..].to_owned()).collect::<Vec<_>>();
    assert_eq!(spots(&stage.run("detect colour.ppm").out), spots(&stage.run("detect frame.png").out));
}

#[test]
fn calibrations_that_are_no_camera() {
    let stage = Stage::new("calibration");
    let with = |name: &str, text: String| {
        stage.file(name, text);
        format!("locate frame.png --camera {name} --airframe hexa.toml")
    };
    let words = with("nan.txt", OCAM.replace("-60", "nan"));
    refuses(&stage, &words, 2, &["nan.txt, line 1: ", "; "]);
    let words = with("inf.txt", OCAM.replace("47.5", "inf"));
    refuses(&stage, &words, 2, &["inf.txt, line 5: ", "; "]);
    let words = with("nan.toml", CAMERA.replace("47.5", "nan"));
    refuses(&stage, &words, 2, &["nan.toml, line 4: NaN", "; correct it there"]);
    let words = with("folds.txt", OCAM.replace("1.6e-3", "-0.2"));
    refuses(
        &stage,
        &words,
        2,
        &[
            "folds.txt, line 1: the angle off the axis stops growing at",
            "; if the lens was calibrated no farther, restrict the field with field_limit_deg = ",
        ],
    );
    let words = with("unknown.toml", format!("{CAMERA}lens = 3\n"));
    refuses(&stage, &words, 2, &["unknown.toml, line 6: unknown", "`lens`"]);
}

#[test]
fn airframes_that_are_none() {
    let stage = Stage::new("airframe");
    let with = |name: &str, text: &str| {
        stage.file(name, text);
        format!("locate frame.png --camera camera.toml --airframe {name}")
    };
    refuses(
        &stage,
        &with("none.toml", "name = \"none\"\nled = []\n"),
        2,
        &["none.toml: no LED: an airframe has at least one", "; list every LED"],
    );
    let twice = "0.1 0 0 0 0 0 0\n-0.1 0 0 0 0 0 0\n0.1 0 0 0 0 0 1\n";
    refuses(
        &stage,
        &with("twice.txt", twice),
        2,
        &["twice.txt, line 3: LEDs 0 and 2 have the same position", "; "],
    );
    let unknown = AIRFRAME.replace("name", "nmae");
    refuses(
        &stage,
        &with("unknown.toml", &unknown),
        2,
        &["unknown.toml, line 1: unknown key `nmae`", "; correct its name"],
    );
}

#[test]
fn spot_curves_that_are_none() {
    let stage = Stage::new("curve");
    stage.file("curve.toml", "upper = { offset_px = 1, scale_px_m2 = -3, shift_m = 0 }\n");
    refuses(
        &stage,
        &format!("{LOCATE} --spot-curve curve.toml"),
        2,
        &["curve.toml, `upper`: an envelope of offset 1 px, scale -3 px m^2", "; an example: upper"],
    );
    stage.file("curve.toml", "upper = { offset_px = 1, scale_px_m2 = 3, shift = 0 }\n");
    refuses(
        &stage,
        &format!("{LOCATE} --spot-curve curve.toml"),
        2,
        &["curve.toml, line 1: unknown key `shift`"],
    );
}

#[test]
fn datasets_that_are_not_in_order() {
    let stage = Stage::new("dataset");
    std::fs::create_dir(stage.path("rec")).unwrap();
    stage.file(
        "rec/dataset.toml",
        "camera = \"c\"\nairframe = \"a\"\nexposure_us = 1\nrate_hz = 20\nmsak = \"m\"\n",
    );
    refuses(&stage, "locate rec", 2, &["rec/dataset.toml, line 5: unknown key `msak`", "; correct its name"]);
    stage.file("rec/dataset.toml", "camera = \"c\"\nairframe = \"a\"\nexposure_us = 1\nrate_hz = 20\n");
    refuses(&stage, "locate rec", 2, &["the folder holds no frames.csv", "; "]);
}

#[test]
fn a_cut_video_keeps_the_frames_before() {
    let stage = Stage::new("cut");
    let whole = video(3);
    stage.file("cut.y4m", &whole[..whole.len() - 1000]);
    let words = "locate cut.y4m --camera camera.toml --airframe hexa.toml --out r.jsonl";
    refuses(
        &stage,
        words,
        1,
        &["cut.y4m, frame 2: the stream ends after 5144 of", "; the frames before it are whole (2)"],
    );
    assert_eq!(stage.read("r.jsonl").lines().count(), 2);
    let done = stage.run_with("detect - --out -", &whole[..whole.len() - 1000]);
    assert_eq!((done.code, done.out.lines().count()), (1, 2));
    assert!(done.err.contains("error: standard input, frame 2: the stream ends after"), "{}", done.err);
    assert!(stage.run("info cut.y4m").out.contains("  ! cut.y4m, frame 2: the stream ends after"));
}

#[test]
fn an_output_that_cannot_be_written_is_told_before_any_work() {
    let stage = Stage::new("unwritable");
    stage.file("file", "in the way");
    for (option, advice) in [
        ("--out file/r.jsonl", "; write elsewhere"),
        ("--out no/r.jsonl", "; make its folder first"),
        ("--csv file/r.csv", "; write elsewhere"),
        ("--overlay file/seen", "; name a folder that can be made"),
    ] {
        let words = format!("{LOCATE} {option}");
        refuses(&stage, &words, 2, &[advice]);
        assert!(!stage.run(&words).err.contains("frames"), "no work is done");
    }
    refuses(
        &stage,
        "detect frame.png --out frame.png",
        2,
        &["frame.png: this file is an input", "; write elsewhere"],
    );
    assert!(std::fs::read(stage.path("frame.png")).unwrap().starts_with(b"\x89PNG"), "it is still there");
}

#[test]
fn spots_of_another_program_with_a_bad_line() {
    let stage = Stage::new("spots");
    let good = "{\"spots\":[{\"u_px\":40,\"v_px\":30},{\"u_px\":50,\"v_px\":30}]}\n";
    stage.file("s.jsonl", format!("{good}{{\"spots\":[{{\"u_px\":1}}]}}\n{good}"));
    let words = "locate --spots s.jsonl --camera camera.toml --airframe hexa.toml --out r.jsonl";
    refuses(&stage, words, 1, &["s.jsonl, line 2: ", "`v_px`", "; see docs/file-formats.md"]);
    assert_eq!(stage.read("r.jsonl").lines().count(), 2);
}
