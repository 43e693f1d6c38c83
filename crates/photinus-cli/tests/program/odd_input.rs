//! Inputs that are legal for an operating system and nothing for Photinus: each is told, none stops the others.

use crate::stage::{SIZE, Stage, frame, video};

/// A PNG of 4x4 pixels with a palette whose length is no multiple of 3, all check sums right.
fn png_with_bad_palette() -> Vec<u8> {
    let chunk = |name: &[u8], data: &[u8]| {
        let body = [name, data].concat();
        [&(data.len() as u32).to_be_bytes(), body.as_slice(), &crc(&body).to_be_bytes()].concat()
    };
    let header = [0, 0, 0, 4, 0, 0, 0, 4, 8, 3, 0, 0, 0];
    // zlib: one stored block of four rows of four indices
    let rows = [[0_u8, 0, 1, 0, 1]; 4].concat();
    let mut data = vec![0x78, 1, 1, 20, 0, !20, 0xff];
    data.extend(&rows);
    data.extend(adler(&rows).to_be_bytes());
    let chunks = [
        chunk(b"IHDR", &header),
        chunk(b"PLTE", &[0, 0, 0, 255, 255]),
        chunk(b"IDAT", &data),
        chunk(b"IEND", &[]),
    ];
    [b"\x89PNG\r\n\x1a\n".to_vec(), chunks.concat()].concat()
}

fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0_u32, |crc, &byte| {
        (0..8).fold(
            crc ^ u32::from(byte),
            |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 },
        )
    })
}

fn adler(bytes: &[u8]) -> u32 {
    let (a, b) = bytes
        .iter()
        .fold((1, 0), |(a, b), &byte| ((a + u32::from(byte)) % 65_521, (a + u32::from(byte) + b) % 65_521));
    b << 16 | a
}

#[test]
fn a_decoder_that_panics_costs_its_frame_only() {
    let stage = Stage::new("palette");
    stage.file("bad.png", png_with_bad_palette());
    let done = stage.run("detect frame.png bad.png frame.png -q --out s.jsonl");
    assert_eq!((done.code, stage.read("s.jsonl").lines().count()), (1, 2), "{}", done.err);
    assert!(
        done.err.contains("error: bad.png: ") && done.err.contains("copy or record it again"),
        "{}",
        done.err
    );
    for words in [
        "info bad.png",
        "locate bad.png --camera camera.toml --airframe hexa.toml",
        "detect frame.png --mask bad.png",
    ] {
        assert_eq!(stage.run(words).code, 2, "{words}");
    }
    assert_eq!(stage.run("calibrate camera bad.png frame.png --grid 7x5 --out c.toml").code, 2);
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_no_images() {
    let stage = Stage::new("pipes");
    assert_eq!(stage.shell("mkfifo pipe.png").code, 0);
    let part = "this is a pipe or a device, no file; name a file; what comes through a pipe is read from standard input";
    for victim in ["pipe.png", "/dev/zero"] {
        for words in [
            format!("detect {victim}"),
            format!("detect frame.png {victim}"),
            format!("detect frame.png --mask {victim}"),
            format!("info {victim}"),
            format!("convert {victim} out.y4m"),
            format!("calibrate camera {victim} --grid 7x5 --out c.toml"),
        ] {
            let done = stage.run(&words);
            assert!(done.code == 2 && done.err.contains(part), "{words}: {}", done.err);
        }
    }
    stage.dataset("rec", 2);
    std::fs::remove_file(stage.path("rec/images/000001.png")).unwrap();
    assert_eq!(stage.shell("mkfifo rec/images/000001.png").code, 0);
    let done = stage.run("locate rec -q --out r.jsonl");
    assert!(done.code == 1 && done.err.contains("frame 1: this is a pipe"), "{}", done.err);
    stage.file("v.y4m", video(2));
    assert_eq!(stage.shell("cat v.y4m | $photinus detect - -q").code, 0, "a pipe is asked for by -");
}

#[test]
fn samples_above_their_maximum_are_no_image() {
    let stage = Stage::new("maximum");
    let pgm = |maximum: u32, word: fn(u16) -> [u8; 2]| {
        let mut bytes = format!("P5\n{} {}\n{maximum}\n", SIZE.0, SIZE.1).into_bytes();
        bytes.extend(frame().pixels().iter().flat_map(|&level| word(4 * u16::from(level))));
        bytes
    };
    stage.file("right.pgm", pgm(1023, u16::to_be_bytes));
    stage.file("swapped.pgm", pgm(1023, u16::to_le_bytes));
    assert_eq!(stage.run("detect right.pgm -q --out s.jsonl").code, 0);
    assert!(stage.read("s.jsonl").contains("\"spots\":[{"));
    let parts = ["swapped.pgm: ", "above the maximum of 1023", "the byte with the higher bits first"];
    stage.refuses("detect swapped.pgm", &parts);
    stage.file("text.pgm", "P2\n2 1\n100\n7 101\n");
    stage.refuses("detect text.pgm", &["a sample is 101, above the maximum of 100"]);
    let mut y4m = b"YUV4MPEG2 W2 H1 F20:1 Ip A1:1 Cmono10\nFRAME\n".to_vec();
    y4m.extend([0x10, 0xff, 0, 0]);
    stage.file("deep.y4m", y4m);
    stage.refuses("detect deep.y4m", &["frame 0: a sample is 65296, above the maximum of 1023"]);
}

#[test]
fn frames_that_no_marker_can_be_found_in_are_told() {
    let stage = Stage::new("white");
    let pgm = |level: u8| {
        [format!("P5\n{} {}\n255\n", SIZE.0, SIZE.1).into_bytes(), vec![level; SIZE.0 * SIZE.1]].concat()
    };
    stage.file("white.pgm", pgm(255));
    stage.file("grey.pgm", pgm(60));
    stage.file("black.pgm", pgm(0));
    let done = stage.run("detect white.pgm grey.pgm white.pgm frame.png black.pgm --out s.jsonl");
    assert_eq!(done.code, 0);
    for part in [
        "warning: white.pgm, frame 0: 100 % of the pixels are saturated",
        "warning: grey.pgm, frame 1: every pixel is 60",
        "2 frames are saturated",
        "1 frames are of one level",
    ] {
        assert!(done.err.contains(part), "{}\nlacks {part}", done.err);
    }
    assert_eq!(done.err.matches("warning: ").count(), 2, "said once of each kind");
}

#[test]
fn an_input_without_frames_is_no_input() {
    let stage = Stage::new("none");
    stage.file("none.y4m", video(0));
    for words in [
        "detect none.y4m",
        "locate none.y4m --camera camera.toml --airframe hexa.toml --out r.jsonl",
        "convert none.y4m out.y4m",
        "info none.y4m",
    ] {
        let done = stage.run(words);
        assert!(
            done.code == 2 && done.err.contains("it holds no frame")
                || done.out.contains("it holds no frame"),
            "{words}"
        );
        assert_eq!(done.code, 2, "{words}");
    }
    assert!(!stage.path("out.y4m").exists());
    stage.refuses("detect frame.png --frames 0", &["--frames"]);
    stage.refuses("simulate none.toml --out x --frames 0", &["--frames"]);
}

#[test]
fn what_is_missing_is_not_in_order() {
    let stage = Stage::new("missing-images");
    stage.dataset("rec", 3);
    assert_eq!(stage.run("info rec").code, 0);
    std::fs::remove_file(stage.path("rec/images/000001.png")).unwrap();
    let done = stage.run("info rec");
    assert!(
        done.code == 2 && done.out.contains("1 image missing, the first is images/000001.png"),
        "{}",
        done.out
    );
    stage.dataset("other", 1);
    std::fs::remove_file(stage.path("other/hexa.toml")).unwrap();
    assert_eq!(stage.run("info other").code, 2);
}

#[test]
fn a_dataset_names_no_file_of_somebody_else() {
    let stage = Stage::new("outside");
    for (number, image) in ["../frame.png", "images/../../frame.png", "/etc/passwd"].into_iter().enumerate() {
        let name = format!("rec{number}");
        stage.dataset(&name, 1);
        stage.file(&format!("{name}/frames.csv"), format!("frame,time_s,image,gx,gy,gz\n0,0,{image},,,\n"));
        let part = "line 2: ";
        for words in [format!("locate {name}"), format!("detect {name}"), format!("convert {name} copy")] {
            stage.refuses(
                &words,
                &["frames.csv, ", part, "is outside of the dataset's folder", "--allow-outside"],
            );
        }
    }
    stage.refuses("inject rec0 --fault noise=3 --out noisy", &["frames.csv, line 2: ", "--allow-outside"]);
    assert_eq!(stage.run("locate rec0 -q --allow-outside").code, 0);
    assert_eq!(stage.run("convert rec0 copy --allow-outside").code, 0);
    assert_eq!(stage.run("locate copy -q").code, 0, "a copy holds its images");
}

#[test]
fn values_that_nothing_in_the_world_has_are_refused() {
    let stage = Stage::new("physics");
    stage.file("s.jsonl", "{\"spots\":[{\"u_px\":4,\"v_px\":4,\"sigma_px\":1e155}]}\n");
    let words = "locate --spots s.jsonl --camera camera.toml --airframe hexa.toml";
    stage.refuses(words, &["s.jsonl, line 1: ", "sigma_px is", "a centre is known to"]);
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/crossing.toml");
    for threads in ["0", "100000", "-1", "many"] {
        stage.refuses(&format!("simulate {scene} --out x --threads={threads}"), &["--threads", "1 to 256"]);
    }
}
