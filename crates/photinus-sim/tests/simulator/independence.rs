//! The world shares nothing with what it tests: what renders light in pixels imports nothing of what finds and explains spots,
//! and no number that tells something stands in both.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

fn crates() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Rust files of a folder and those below it, without files of tests.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut found = Vec::new();
    for path in entries.map(|entry| entry.expect("an entry of a folder").path()) {
        let is_of_tests = path.file_stem().is_some_and(|stem| stem == "tests");
        if path.is_dir() && !is_of_tests {
            found.extend(files(&path));
        } else if path.extension().is_some_and(|end| end == "rs") && !is_of_tests {
            found.push(path);
        }
    }
    found
}

/// A file without its comments and its tests.
fn code(path: &Path) -> String {
    let text = std::fs::read_to_string(path).expect("a source file");
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// The numbers with a decimal point or an exponent, each with a file that it stands in.
fn numbers(rooms: &[&str]) -> BTreeMap<String, PathBuf> {
    let mut found = BTreeMap::new();
    for path in rooms.iter().flat_map(|room| files(&crates().join(room))) {
        let code = code(&path).replace("e-", "e~");
        let apart = |c: char| !(c.is_ascii_alphanumeric() || c == '.' || c == '_' || c == '~');
        for token in code.split(apart).filter(|token| token.starts_with(|c: char| c.is_ascii_digit())) {
            let plain = token.replace('_', "").replace('~', "-");
            if let Some(number) = plain.parse::<f64>().ok().filter(|_| plain.contains(['.', 'e'])) {
                found.insert(format!("{number:e}"), path.clone());
            }
        }
    }
    found
}

/// Whether a number is one that everybody has: one digit, odd quarters below ten, a dozen, the largest grey level.
fn is_trivial(number: &str) -> bool {
    let value: f64 = number.parse().expect("a number that was printed");
    let digits = number.split('e').next().unwrap_or_default().chars().filter(char::is_ascii_digit).count();
    let is_odd_quarter =
        value < 10.0 && (4.0 * value).fract().abs() <= 0.0 && (2.0 * value).fract().abs() > 0.0;
    digits == 1 || is_odd_quarter || [12.0, 255.0].iter().any(|known| (value - known).abs() <= 0.0)
}

#[test]
fn what_renders_imports_nothing_of_what_detects() {
    let mut imports = 0;
    for path in files(&crates().join("photinus-sim/src")) {
        let code = code(&path);
        for (place, _) in code.match_indices("photinus::") {
            let after = &code[place + "photinus::".len()..];
            let room: String = after.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '_').collect();
            let allowed = ["airframe", "camera", "frame"];
            // The words that LEDs blink are not what detects them.
            let is_word = after.starts_with("identity::CodeBook");
            assert!(is_word || allowed.contains(&room.as_str()), "{}: photinus::{room}", path.display());
            imports += 1;
        }
    }
    assert!(imports > 5, "imports are found where they are");
    let manifest = std::fs::read_to_string(crates().join("photinus-sim/Cargo.toml")).unwrap();
    for other in ["photinus-evaluate", "photinus-calibrate", "photinus-reproduce", "photinus-cli"] {
        assert!(!manifest.contains(other), "photinus-sim depends on {other}");
    }
    let method = std::fs::read_to_string(crates().join("photinus/Cargo.toml")).unwrap();
    assert!(!method.contains("photinus-sim"), "the method depends on its own test");
}

#[test]
fn no_number_that_tells_something_stands_in_both() {
    let renders = ["optics", "sensor", "render", "preset"].map(|room| format!("photinus-sim/src/{room}"));
    let renders = numbers(&renders.each_ref().map(String::as_str));
    let detects =
        numbers(&["photinus/src/optics", "photinus/src/spots", "photinus/src/locator", "photinus/src/pose"]);
    assert!(renders.len() > 30 && detects.len() > 50, "{} {}", renders.len(), detects.len());
    assert!(detects.contains_key("1.2e-1"), "what is least around a light in spots/measuring.rs is read");
    for (number, path) in renders.iter().filter(|(number, _)| !is_trivial(number)) {
        if let Some(other) = detects.get(number) {
            panic!("{number} stands in {} and in {}", path.display(), other.display());
        }
    }
}
