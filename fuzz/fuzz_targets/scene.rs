//! Any text as a scene, with the project's airframes and cameras within its reach.
#![no_main]

use std::path::Path;

use photinus_sim::scene::Scene;

libfuzzer_sys::fuzz_target!(|text: &str| {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/fuzz.toml");
    if let Err(error) = Scene::parse(text, path) {
        assert!(!error.to_string().is_empty());
    }
});
