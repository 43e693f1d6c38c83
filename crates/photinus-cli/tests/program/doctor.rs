//! `doctor`, `completions`, `man`: what a newcomer asks before the first flight.

use photinus_io::image::{GreyImage, write_png};

use crate::stage::{SIZE, Stage};

#[test]
fn what_is_doubtful_is_said_and_what_is_fine_too() {
    let stage = Stage::new("doctor");
    stage.dataset("rec", 4);
    let done = stage.run("doctor camera.toml hexa.toml rec");
    assert_eq!(done.code, 0, "{}", done.err);
    for said in [
        "   !  it does not say how sure it is",
        "   !  its optics are not measured",
        "  ok  seen from every side",
        "  ok  two markers or more from every side",
        "  ok  8 spots, 0 % of them a single pixel",
        "  ok  frames come every 50.0 ms, without gaps",
        "  ok  gravity is known in every frame",
        "  ok  of the camera's size",
        "things are doubtful.",
    ] {
        assert!(done.out.contains(said), "lacks `{said}`:\n{}", done.out);
    }

    assert_eq!(stage.run("convert rec rec.mcap").code, 0);
    let of_mcap = stage.run("doctor camera.toml hexa.toml rec.mcap");
    assert_eq!(
        (of_mcap.code, of_mcap.out),
        (0, done.out.replace("\nrec\n", "\nrec.mcap\n")),
        "{}",
        of_mcap.err
    );

    let (width, height) = SIZE;
    let bright = |level: u8| GreyImage::new(vec![level; width * height], width, height).unwrap();
    std::fs::create_dir(stage.path("day")).unwrap();
    for (number, level) in [90, 140, 60].into_iter().enumerate() {
        write_png(stage.path("day").join(format!("{number}.png")), &bright(level).view()).unwrap();
    }
    let done = stage.run("doctor day");
    for said in [
        "no spot in any frame",
        "the background goes from 60 to 140 grey levels",
        "background of 97 grey levels",
    ] {
        assert!(done.out.contains(said), "lacks `{said}`:\n{}", done.out);
    }
    assert_eq!(stage.run("doctor no.toml").code, 2);
    assert_eq!(stage.run("doctor rec/truth.jsonl").code, 2);
}

#[test]
fn shells_and_manuals_know_every_command() {
    let stage = Stage::new("shell");
    for shell in ["bash", "zsh", "fish"] {
        let done = stage.run(&format!("completions {shell}"));
        assert!(done.code == 0 && done.out.contains("overlay-every"), "{shell}");
    }
    assert_eq!(stage.run("man pages").code, 0);
    let pages = stage.names("pages");
    for page in ["photinus.1", "photinus-locate.1", "photinus-calibrate-camera.1"] {
        assert!(pages.contains(&page.to_owned()), "{pages:?}");
    }
    assert!(stage.read("pages/photinus-locate.1").contains("overlay\\-every"));
    assert_eq!(stage.run("man pages").code, 2, "what is there stays");
}
