//! A newcomer's mistakes, and what is answered: each names what is wrong and what to do.

use photinus_io::image::{GreyImage, write_png};

use crate::stage::{CAMERA, Stage, video};

/// Files that may be taken for others.
fn stage(test: &str) -> Stage {
    let stage = Stage::new(test);
    stage.dataset("rec", 2);
    stage.file("readme.md", "# Photinus\n\nPhotinus (the fireflies: they flash) tells a robot\n");
    stage.file("notes.txt", "hello\n");
    stage.file("empty.txt", "");
    stage.file("page.html", "<!DOCTYPE html>\n<html lang=\"en\">\n");
    stage.file("comment.toml", "# nothing yet\n");
    stage.file("v.mp4", b"\0\0\0\x20ftypisom\0\0\x02\0");
    stage.file("v.mkv", b"\x1a\x45\xdf\xa3\x01");
    stage.file("v.y4m", video(2));
    stage.file("bag.mcap", b"\x89MCAP0\r\n");
    stage.file("old.bag", b"#ROSBAG V1.2\n");
    stage.file("run.toml", "[[camera]]\nname = \"a\"\nsource = { dataset = \"gone\" }\n");
    stage.file("photos.zip", b"PK\x03\x04");
    stage.file("layout-cm.txt", "17 17 0 0 0.0 0.0 0\n-17 17 0 0 0.0 1.5 1\n");
    stage.file("layout-deg.txt", "0.17 0.17 0 0 0.0 0.0 0\n-0.17 0.17 0 0 0.0 135.0 1\n");
    stage.file("codes.txt", "0,1,1\n1,0,1\n");
    stage.file("curve.toml", "upper = { offset_px = 1, scale_px_m2 = 30, shift_m = 0 }\n");
    stage.file("scene.toml", "name = \"a\"\npreset = \"b\"\n");
    stage.file("mounting.toml", "body_from_camera_xyzw = [0, 0, 0, 1]\n");
    stage.file(
        "scores.json",
        "{\"dataset\":\"rec\",\"settings\":{},\"frames\":{\"truth\":2,\"evaluated\":2}}\n",
    );
    stage.file("other.csv", "a,b,c\n1,2,3\n");
    stage.file("poses.csv", "time_s,x_m,y_m,z_m,qx,qy,qz,qw\n0,0,0,1,0,0,0,1\n1,0,0,1,0,0,0,1\n");
    stage.file("poses-nan.csv", "time_s,x_m,y_m,z_m,qx,qy,qz,qw\n0,0,0,NaN,0,0,0,1\n");
    stage.file("down.csv", "time_s,gx,gy,gz\n0,0,0,1\n1,0,0.5,0\n");
    stage.file("keys.yaml", "detector: 3\ntracking: 4\n");
    let levels = |black: usize| (0..96 * 64).map(|px| if px < black { 0 } else { 255 }).collect();
    write_png(stage.path("mask-inverted.png"), &GreyImage::new(levels(5000), 96, 64).unwrap().view())
        .unwrap();
    std::fs::create_dir(stage.path("nothing")).unwrap();
    stage
}

/// What is typed after `photinus`, the exit code, and what the answer says.
type Mistake = (&'static str, i32, &'static [&'static str]);

const LOCATE: &str = "locate frame.png --camera camera.toml --airframe hexa.toml";

const FILES: [Mistake; 33] = [
    ("info poses-nan.csv", 2, &["poses-nan.csv, line 2", "NaN"]),
    ("info down.csv", 2, &["down.csv, line 3", "length 0.5, not 1"]),
    ("info readme.md", 2, &["this is text in no format that Photinus knows; name a camera"]),
    ("info notes.txt", 2, &["this is text in no format"]),
    ("info empty.txt", 2, &["a file that holds nothing"]),
    ("info comment.toml", 2, &["nothing but comments"]),
    ("info v.mp4", 2, &["this is an MP4 video; decode it into a pipe: `ffmpeg -i v.mp4 -pix_fmt gray"]),
    ("info bag.mcap", 2, &["ended in the middle", "`photinus recover` mends a recording that was cut off"]),
    ("info old.bag", 2, &["does not begin as a bag of format 2.0 does; `rosbag reindex`"]),
    (
        "run --check run.toml",
        2,
        &["run.toml, `camera[0].source.dataset`: gone: ", "taken from the folder of the configuration"],
    ),
    ("info photos.zip", 2, &["this is a ZIP archive; unpack it first"]),
    ("info nothing", 2, &["this is a folder without frames"]),
    ("info page.html", 0, &["page.html: a page for a browser", "open it in a browser"]),
    ("detect page.html", 2, &["this is a page for a browser, not an image; open it in a browser"]),
    ("info other.csv", 2, &["no table of Photinus has the columns `a,b,c`; docs/file-formats.md"]),
    ("info keys.yaml", 2, &["YAML with keys that Photinus does not know"]),
    ("info camer.toml", 2, &["camer.toml: ", "check the path"]),
    ("detect v.mp4", 2, &["this is an MP4 video, not an image; decode it into a pipe: `ffmpeg -i v.mp4"]),
    ("detect v.mkv", 2, &["a Matroska video", "ffmpeg -i v.mkv"]),
    ("detect photos.zip", 2, &["a ZIP archive, not an image; unpack it first"]),
    ("detect camera.toml", 2, &["this is a camera in Photinus TOML, not an image; use PNG"]),
    (
        "detect nothing",
        2,
        &["the folder holds no dataset.toml; name the folder of a dataset, or list the image files"],
    ),
    ("detect v.y4m v.y4m", 2, &["a video among several inputs; name one video"]),
    (
        "locate frame.png --camera hexa.toml --airframe hexa.toml",
        2,
        &["hexa.toml: this is an airframe, not a camera"],
    ),
    (
        "locate frame.png --camera frame.png --airframe hexa.toml",
        2,
        &["frame.png: this is an image, not a camera"],
    ),
    (
        "locate frame.png --camera rec/dataset.toml --airframe hexa.toml",
        2,
        &["the dataset.toml of a dataset, not a camera", "`camera`"],
    ),
    (
        "locate frame.png --camera readme.md --airframe hexa.toml",
        2,
        &["text in no format that Photinus knows, not a camera"],
    ),
    (
        "locate frame.png --camera keys.yaml --airframe hexa.toml",
        2,
        &["the keys detector, tracking: none of a camera"],
    ),
    (
        "locate frame.png --camera camera.toml --airframe camera.toml",
        2,
        &["camera.toml: this is a camera in Photinus TOML, not an airframe"],
    ),
    (
        "locate frame.png --camera camera.toml --airframe codes.txt",
        2,
        &["a list of blink sequences, not an airframe"],
    ),
    (
        "locate frame.png --camera camera.toml --airframe scene.toml",
        2,
        &["a scene for `photinus simulate`, not an airframe"],
    ),
    (
        "convert mounting.toml x.txt",
        2,
        &["this is the mounting of a camera, which cannot become OCamCalib text"],
    ),
    ("convert v.mp4 out.y4m", 2, &["this is an MP4 video, which cannot become a Y4M video; decode it"]),
];

const OPTIONS: [Mistake; 28] = [
    (
        "detect frame.png --contrast 0.1",
        2,
        &[
            "'0.1' for '--contrast <N>': give grey levels, a whole number of 1 to 255: 0.1 of full scale is 26",
        ],
    ),
    (
        "detect frame.png --contrast 300",
        2,
        &["'300' for '--contrast <N>': give grey levels, a whole number of 1 to 255"],
    ),
    ("detect frame.png --threshold dark", 2, &["give grey levels, a whole number of 1 to 255"]),
    ("detect frame.png --frames 0", 2, &["give a whole number, 1 or more"]),
    ("detect frame.png --overlay seen --overlay-every 0", 2, &["give a whole number, 1 or more"]),
    ("detect frame.png --overlay-every 5", 2, &["--overlay"]),
    ("detect v.y4m --raw 752", 2, &["give the size as 752x480"]),
    (
        "locate",
        2,
        &[
            "no input: name a dataset folder, image files or a folder of them, a Y4M video, an MCAP recording, a bag of ROS 1, or -",
        ],
    ),
    ("locate frame.png --airframe hexa.toml", 2, &["no camera: give --camera FILE, or a dataset folder"]),
    ("locate frame.png --camera camera.toml", 2, &["no airframe: give --airframe FILE"]),
    ("locate rec --only left", 2, &["--only left: the dataset has one camera, without a name"]),
    ("locat rec", 2, &["unrecognized subcommand 'locat'", "'locate'"]),
    ("locate rec --overlays seen", 2, &["a similar argument exists: '--overlay"]),
    (
        "detect frame.png --out r.csv",
        2,
        &["r.csv: its name ends in .csv, but a file of JSON lines is written there; end it in .jsonl"],
    ),
    (
        "detect frame.png --overlay seen.mp4",
        2,
        &["its name ends in .mp4, but a folder is written there", "it ends in .y4m"],
    ),
    ("detect frame.png --out no/r.jsonl", 2, &["make its folder first"]),
    ("detect frame.png --out nothing", 2, &["it is a folder; name a file"]),
    ("detect frame.png --out frame.png", 2, &["this file is an input, it would be replaced"]),
    (
        "calibrate camera frame.png --grid 7x5 --out x.txt",
        2,
        &["its name ends in .txt, but a TOML file is written there; end it in .toml"],
    ),
    ("calibrate camera frame.png --grid 7x5 --out no/x.toml", 2, &["make its folder first"]),
    ("calibrate camera frame.png --grid 7 --out x.toml", 2, &["two whole numbers with an x between them"]),
    (
        "calibrate camera frame.png --grid 7x5 --pitch 50mm --out x.toml",
        2,
        &["give metres, above 0, without the unit"],
    ),
    ("reproduce 9 --out x", 2, &["choose among 4, 7, 8"]),
    ("convert camera.toml camera.yaml", 2, &["choose --to kalibr, --to ros or --to uvdar"]),
    (
        "evaluate empty.txt missing.jsonl",
        2,
        &["empty.txt: this is a file that holds nothing", "not ground truth"],
    ),
    ("evaluate missing results.jsonl", 2, &["missing: ", "check the path"]),
    (
        "evaluate poses.csv results.jsonl",
        2,
        &[
            "poses.csv: this is a table of poses; to get truth from poses, give the log of the other vehicle, too: --target FILE",
        ],
    ),
    (
        "convert camera.toml camera",
        2,
        &["cannot become a dataset folder; choose --to toml, ocam, kalibr, ros or uvdar"],
    ),
];

/// What is done all the same, and what is said about it.
const DOUBTS: [Mistake; 9] = [
    (
        "info layout-cm.txt",
        0,
        &["its farthest marker is 24.04 m from the body's origin: positions are taken as metres"],
    ),
    (
        "info layout-deg.txt",
        0,
        &["1 LED(s) have a pitch or yaw beyond a whole turn", "divide them by 57.296"],
    ),
    ("info mask-inverted.png", 0, &["the mask ignores 81 % of the image", "invert it"]),
    ("info rec/truth.jsonl", 0, &["ground truth"]),
    ("info scores.json", 0, &["scores of `photinus evaluate`"]),
    ("info rec/frames.csv", 0, &["the frames.csv of a dataset"]),
    ("info rec/images", 0, &["a folder of images", "2"]),
    ("detect rec/images", 0, &["frame     1  spot  0"]),
    ("detect frame.png --mask mask-inverted.png", 0, &["the mask ignores 81 % of the image"]),
];

#[test]
fn sixty_mistakes_and_what_is_answered() {
    let stage = stage("mistakes");
    let mistakes = FILES.iter().chain(&OPTIONS).chain(&DOUBTS);
    assert!(mistakes.clone().count() >= 60);
    let before = stage.names("");
    for (words, code, parts) in mistakes {
        let done = stage.run(words);
        assert_eq!(done.code, *code, "{words}\n{}", done.err);
        // A long line is broken by clap at the width of a terminal.
        let told = format!("{}\n{}", done.out, done.err);
        for part in *parts {
            assert!(told.contains(part), "{words}\n{told}\nlacks `{part}`");
        }
    }
    let left: Vec<String> = stage.names("").into_iter().filter(|name| name != ".stdin").collect();
    let before: Vec<String> = before.into_iter().filter(|name| name != ".stdin").collect();
    assert_eq!(left, before, "no mistake leaves a file behind");
}

#[test]
fn a_layout_in_other_units_is_told_where_it_is_used() {
    let stage = stage("mistakes-units");
    let done = stage.run("locate frame.png --camera camera.toml --airframe layout-cm.txt");
    assert!(
        done.code == 0 && done.err.contains("note: layout-cm.txt: its farthest marker is 24.04 m"),
        "{}",
        done.err
    );
    assert!(!stage.run(LOCATE).err.contains("farthest marker"), "{CAMERA}");
}
