//! Overlays: where they go, what they are called, which frames are drawn.

use photinus_io::image::read_image;
use photinus_io::video::Y4mFrames;

use crate::stage::{Stage, video};

const KNOWN: &str = "--camera camera.toml --airframe hexa.toml";

#[test]
fn a_video_of_pictures_goes_to_a_file_or_to_a_pipe() {
    let stage = Stage::new("overlay-video");
    stage.file("v.y4m", video(3));
    let done = stage.run(&format!("locate v.y4m {KNOWN} --overlay seen.y4m -q --out r.jsonl"));
    assert_eq!(done.code, 0, "{}", done.err);
    let frames: Vec<_> =
        Y4mFrames::new(std::fs::File::open(stage.path("seen.y4m")).unwrap(), "seen.y4m").unwrap().collect();
    assert_eq!(frames.len(), 3);
    assert_eq!(stage.run("detect v.y4m --overlay pictures -q").code, 0);
    let piped = stage.shell(&format!("$photinus locate v.y4m {KNOWN} --overlay - -q > piped.y4m"));
    assert_eq!(piped.code, 0, "{}", piped.err);
    assert!(
        std::fs::read(stage.path("piped.y4m")).unwrap() == std::fs::read(stage.path("seen.y4m")).unwrap()
    );
    let both = stage.run(&format!("locate v.y4m {KNOWN} --overlay - --out -"));
    assert!(both.code == 2 && both.err.contains("both write to standard output"), "{}", both.err);
}

#[test]
fn every_nth_frame_is_drawn_and_pictures_are_named_after_their_photos() {
    let stage = Stage::new("overlay-names");
    stage.dataset("rec", 5);
    assert_eq!(stage.run("locate rec --overlay seen --overlay-every 2 -q --out r.jsonl").code, 0);
    assert_eq!(stage.names("seen"), ["overlay-000000.png", "overlay-000002.png", "overlay-000004.png"]);
    assert_eq!(stage.read("r.jsonl").lines().count(), 5, "results are of every frame");
    for folder in ["left", "right"] {
        std::fs::create_dir(stage.path(folder)).unwrap();
        std::fs::copy(stage.path("frame.png"), stage.path(folder).join("photo.png")).unwrap();
    }
    assert_eq!(stage.run("detect left/photo.png frame.png right/photo.png --overlay both -q").code, 0);
    assert_eq!(stage.names("both"), ["overlay-frame.png", "overlay-photo-000002.png", "overlay-photo.png"]);
    assert!(read_image(stage.path("both/overlay-photo-000002.png")).unwrap().image.width() > 1000);
}
