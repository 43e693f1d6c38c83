//! Every command with damaged inputs: it ends by itself, within bounds of memory and time, with an exit code of its own and
//! without a panic. In an ordinary run a few hundred cases; by hand more:
//! `PHOTINUS_CASES=20000 cargo test --release -p photinus-cli --test program mutated`.

use std::process::{Command, Stdio};

use crate::stage::{OCAM, Stage, video};

/// Memory that a command may ask for, KiB, and time that it may take, s: inputs here are a few kilobytes.
const MOST_KIB: u32 = 3_000_000;
const LONGEST_S: u32 = 60;

/// A command and the file that is damaged before it runs.
const CASES: [(&str, &str); 27] = [
    ("detect frame.png --overlay out", "frame.png"),
    ("detect colour.ppm", "colour.ppm"),
    ("detect v.y4m --out out", "v.y4m"),
    ("detect - --frames 2", "v.y4m"),
    ("detect frame.png --mask mask.pgm", "mask.pgm"),
    ("locate rec --out out", "rec/dataset.toml"),
    ("locate rec --csv out", "rec/frames.csv"),
    ("locate rec", "rec/images/000000.png"),
    ("locate frame.png --camera camera.toml --airframe hexa.toml --overlay out", "camera.toml"),
    ("locate frame.png --camera ocam.txt --airframe hexa.toml", "ocam.txt"),
    ("locate frame.png --camera camera.toml --airframe hexa.toml", "hexa.toml"),
    ("locate frame.png --camera camera.toml --airframe layout.txt", "layout.txt"),
    ("locate frame.png --camera camera.toml --airframe hexa.toml --spot-curve curve.toml", "curve.toml"),
    ("locate --spots spots.jsonl --camera camera.toml --airframe hexa.toml --out out", "spots.jsonl"),
    ("locate rec --out done.jsonl --resume", "done.jsonl"),
    ("evaluate rec done.jsonl --json out", "done.jsonl"),
    ("evaluate rec done.jsonl", "rec/truth.jsonl"),
    ("info rec frame.png camera.toml hexa.toml v.y4m done.jsonl codes.txt", "codes.txt"),
    ("info ocam.txt", "ocam.txt"),
    ("codes check codes.txt", "codes.txt"),
    ("convert camera.toml out.txt", "camera.toml"),
    ("convert layout.txt out.toml", "layout.txt"),
    ("convert done.jsonl out.csv", "done.jsonl"),
    ("convert rec out", "rec/frames.csv"),
    ("simulate scene.toml --out out --frames 1 --threads 1", "scene.toml"),
    (
        "calibrate camera corners.csv --size 96x64 --grid 3x3 --out out --splits 1 --bootstraps 1",
        "corners.csv",
    ),
    ("calibrate spot-size sizes.csv --out out", "sizes.csv"),
];

/// Numbers without end, the same every time.
struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % end.max(1)
    }
}

/// What goes wrong with files: bits, lengths, and numbers that somebody writes in place of others.
fn damage(bytes: &mut Vec<u8>, random: &mut Random) {
    const WORDS: [&str; 14] = [
        "1e308",
        "-1e308",
        "1e-308",
        "nan",
        "inf",
        "-1",
        "0",
        "99999999999999999999",
        "1e12",
        "\"\"",
        "[]",
        "{}",
        "\u{fe0f}",
        "65535",
    ];
    for _ in 0..=random.below(3) {
        let at = random.below(bytes.len());
        match random.below(6) {
            0 if !bytes.is_empty() => bytes[at] = random.below(256) as u8,
            1 if !bytes.is_empty() => bytes[at] ^= 1 << random.below(8),
            2 => bytes.truncate(at),
            3 => {
                let end = (at + random.below(40)).min(bytes.len());
                let piece = bytes[at..end].to_vec();
                bytes.splice(at..at, piece);
            }
            _ => {
                // The next number, replaced.
                let is_digit = |byte: &u8| byte.is_ascii_digit() || b".-+e".contains(byte);
                let start = bytes[at..].iter().position(u8::is_ascii_digit).map_or(at, |skip| at + skip);
                let length = bytes[start..].iter().take_while(|byte| is_digit(byte)).count();
                let word = WORDS[random.below(WORDS.len())];
                bytes.splice(start..start + length, word.bytes());
            }
        }
    }
}

fn stage() -> Stage {
    let stage = Stage::new("mutated");
    stage.dataset("rec", 2);
    stage.file("v.y4m", video(2));
    stage.file("ocam.txt", OCAM);
    stage.file("layout.txt", "0.4 0 0 0 1.5 0 0\n-0.4 0 0 0 1.5 3.14 1\n0 0.4 0 0 1.5 1.57 2\n");
    stage
        .file("curve.toml", "exposure_us = 2000\nupper = { offset_px = 1, scale_px_m2 = 30, shift_m = 0 }\n");
    stage.file("spots.jsonl", "{\"frame\":3,\"spots\":[{\"u_px\":40.5,\"v_px\":30,\"sigma_px\":0.2},{\"u_px\":50,\"v_px\":30.5}]}\n");
    stage.file("codes.txt", "0,1,1,0,1\n1,0,0,1,1\n");
    stage.file("sizes.csv", "distance_m,area_px\n1,30\n2,9\n3,5\n4,3\n5,2\n6,2\n8,1\n");
    let grey = crate::stage::frame();
    let ppm = format!("P6\n{} {}\n255\n", grey.width(), grey.height());
    stage.file(
        "colour.ppm",
        [ppm.as_bytes(), &grey.pixels().iter().flat_map(|&level| [level; 3]).collect::<Vec<u8>>()].concat(),
    );
    stage.file(
        "mask.pgm",
        [format!("P5\n{} {}\n255\n", grey.width(), grey.height()).as_bytes(), grey.pixels()].concat(),
    );
    let corners = (0..3).flat_map(|photo| (0..9).map(move |led| (photo, led))).map(|(photo, led)| {
        format!("{photo}.png,{},{}\n", 20 + 9 * (led % 3) + 3 * photo, 15 + 8 * (led / 3) + photo * (led % 3))
    });
    stage.file("corners.csv", format!("image,u,v\n{}", corners.collect::<String>()));
    let scene =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/crossing.toml")).unwrap();
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes");
    let scene = ["cameras/", "airframes/", "codes/"]
        .iter()
        .fold(scene, |scene, folder| scene.replace(&format!("\"{folder}"), &format!("\"{scenes}/{folder}")));
    stage.file("scene.toml", scene);
    assert_eq!(stage.run("locate rec -q --out done.jsonl").code, 0);
    stage
}

#[test]
fn no_damaged_input_panics_or_takes_more_than_its_share() {
    let cases: usize = std::env::var("PHOTINUS_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(500);
    let stage = stage();
    let mut random = Random(20_261_122);
    let sound: Vec<Vec<u8>> =
        CASES.iter().map(|(_, file)| std::fs::read(stage.path(file)).unwrap()).collect();
    for case in 0..cases {
        let ((words, file), sound) = (CASES[case % CASES.len()], &sound[case % CASES.len()]);
        let mut bytes = sound.clone();
        damage(&mut bytes, &mut random);
        stage.file(file, &bytes);
        for name in ["out", "out.txt", "out.toml", "out.csv"] {
            let path = stage.path(name);
            let _ = std::fs::remove_dir_all(&path).or_else(|_| std::fs::remove_file(&path));
        }
        let line = format!("ulimit -v {MOST_KIB}; exec timeout {LONGEST_S} \"$0\" {words}");
        let input = std::fs::File::open(stage.path("v.y4m")).unwrap();
        let done = Command::new("sh")
            .args(["-c", &line, env!("CARGO_BIN_EXE_photinus")])
            .current_dir(stage.path(""))
            .env_remove("RUST_BACKTRACE")
            .stdin(Stdio::from(input))
            .output()
            .unwrap();
        let told = String::from_utf8_lossy(&done.stderr);
        let is_well = matches!(done.status.code(), Some(0..=2)) && !told.contains("a fault in Photinus");
        let is_told = done.status.code() == Some(0) || told.contains("error: ") || words.starts_with("info");
        if !(is_well && is_told) {
            let kept = std::env::temp_dir().join(format!("photinus-mutated-{case}"));
            std::fs::write(&kept, &bytes).unwrap();
            panic!("case {case}: {words}, with {file} as in {}: {:?}\n{told}", kept.display(), done.status);
        }
        stage.file(file, sound);
    }
}
