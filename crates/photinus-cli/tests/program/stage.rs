//! A folder for one test, with the files of a small scene in it, and the program run there.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use photinus_io::image::{GreyImage, write_png};

/// Columns and rows of the scene's camera.
pub(crate) const SIZE: (usize, usize) = (96, 64);

/// A camera with 2 deg per pixel in the middle.
pub(crate) const CAMERA: &str = "model = \"equidistant\"\nwidth_px = 96\nheight_px = 64\ncentre_px = [47.5, 31.5]\n\
                                 focal_px = [60.0, 60.0]\n";
pub(crate) const AIRFRAME: &str =
    "name = \"hexa\"\nring = { arms = 6, radius_m = 0.4, leds_per_arm = 1, splay_deg = 0.0 }\n";
/// OCamCalib text.
pub(crate) const OCAM: &str = "5 -60 0 1.6e-3 0 0\n\n2 94 60\n\n31.5 47.5\n\n1 0 0\n\n64 96\n";

/// A folder in the system's temporary folder, gone with the value.
pub(crate) struct Stage(PathBuf);

/// What the program did.
#[derive(Debug)]
pub(crate) struct Done {
    pub(crate) code: i32,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Stage {
    /// A folder with camera.toml, hexa.toml and frame.png: two markers of one neighbour, 2.4 m away.
    pub(crate) fn new(test: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("photinus-cli-{}-{test}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let stage = Self(folder);
        stage.file("camera.toml", CAMERA);
        stage.file("hexa.toml", AIRFRAME);
        write_png(stage.path("frame.png"), &frame().view()).unwrap();
        stage
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    pub(crate) fn file(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    /// A dataset folder of so many frames, with truth.
    pub(crate) fn dataset(&self, name: &str, frames: usize) {
        std::fs::create_dir_all(self.path(name).join("images")).unwrap();
        let (mut rows, mut truth) = ("frame,time_s,image,gx,gy,gz\n".to_owned(), String::new());
        for number in 0..frames {
            let image = format!("images/{number:06}.png");
            write_png(self.path(name).join(&image), &frame().view()).unwrap();
            let time_s = number as f64 / 20.0;
            rows += &format!("{number},{time_s},{image},0,1,0\n");
            truth += &format!("{{\"frame\":{number},\"time_s\":{time_s},\"neighbours\":[]}}\n");
        }
        let table = "camera = \"camera.toml\"\nairframe = \"hexa.toml\"\nexposure_us = 1000\nrate_hz = 20\n";
        for (file, text) in [
            ("dataset.toml", table),
            ("frames.csv", &rows),
            ("truth.jsonl", &truth),
            ("camera.toml", CAMERA),
            ("hexa.toml", AIRFRAME),
        ] {
            self.file(&format!("{name}/{file}"), text);
        }
    }

    /// The names of what a folder holds, sorted.
    pub(crate) fn names(&self, folder: &str) -> Vec<String> {
        let entries = std::fs::read_dir(self.path(folder)).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// The program, to be started in the folder with these words.
    pub(crate) fn command(&self, words: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_photinus"));
        command.args(words.split_whitespace()).current_dir(&self.0).env_remove("RUST_BACKTRACE");
        command
    }

    /// Runs a line of shell in the folder, with `$photinus` for the program.
    pub(crate) fn shell(&self, line: &str) -> Done {
        let done = Command::new("sh")
            .args(["-c", line])
            .current_dir(&self.0)
            .env("photinus", env!("CARGO_BIN_EXE_photinus"))
            .env_remove("RUST_BACKTRACE")
            .stdin(Stdio::null())
            .output()
            .unwrap();
        self.told(line, done)
    }

    fn told(&self, words: &str, done: std::process::Output) -> Done {
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        let code = done.status.code().unwrap_or_else(|| panic!("{words}: ended by {}", done.status));
        let done = Done { code, out: text(done.stdout), err: text(done.stderr) };
        println!("$ {words}\n{}{}[exit {}]", done.out, done.err, done.code);
        assert!(!done.err.contains("panicked") && !done.err.contains("a fault in Photinus"), "{}", done.err);
        done
    }

    /// Runs `photinus` with these words, separated by spaces, in the folder.
    pub(crate) fn run(&self, words: &str) -> Done {
        self.run_with(words, &[])
    }

    /// The same with bytes on standard input.
    pub(crate) fn run_with(&self, words: &str, input: &[u8]) -> Done {
        self.file(".stdin", input);
        let stdin = std::fs::File::open(self.path(".stdin")).unwrap();
        let done = self.command(words).stdin(Stdio::from(stdin)).output().unwrap();
        self.told(&format!("photinus {words}"), done)
    }
}

impl Stage {
    /// Runs and expects to be refused with these parts.
    pub(crate) fn refuses(&self, words: &str, parts: &[&str]) {
        let done = self.run(words);
        assert_eq!(done.code, 2, "{words}: {}", done.err);
        for part in parts {
            assert!(done.err.contains(part), "{words}\n{}\nlacks `{part}`", done.err);
        }
    }
}

impl Drop for Stage {
    fn drop(&mut self) {
        // A folder left behind in the system's temporary folder harms nobody.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A dark frame with two markers, 10 px apart.
pub(crate) fn frame() -> GreyImage {
    let (width, height) = SIZE;
    let mut pixels = vec![3_u8; width * height];
    for (u, v) in [(40, 30), (50, 30)] {
        for (du, dv, level) in [(0, 0, 220), (1, 0, 90), (0, 1, 80), (1, 1, 40)] {
            pixels[(v + dv) * width + u + du] = level;
        }
    }
    GreyImage::new(pixels, width, height).unwrap()
}

/// A Y4M stream of so many frames.
pub(crate) fn video(frames: usize) -> Vec<u8> {
    let mut bytes = format!("YUV4MPEG2 W{} H{} F20:1 Ip A1:1 Cmono\n", SIZE.0, SIZE.1).into_bytes();
    for _ in 0..frames {
        bytes.extend(b"FRAME\n");
        bytes.extend(frame().pixels());
    }
    bytes
}
