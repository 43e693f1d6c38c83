//! A page for any browser, with no server: the pictures one after the other, the figure, and what came out.

use std::path::Path;

use photinus_io::{Error, Result};
use photinus_sim::Scene;

use super::{FIGURES, PICTURES};
use crate::overlay;

/// How long each picture stands, ms.
const PICTURE_MS: u32 = 150;

/// Writes `index.html` into `folder`, for pictures of the frames `drawn` and `told` in words.
///
/// # Errors
/// [`Error`] when it cannot be written.
pub(super) fn write(folder: &Path, scene: &Scene, drawn: &[u64], told: &str) -> Result<()> {
    let path = folder.join("index.html");
    std::fs::write(&path, text(scene, drawn, told)).map_err(|error| Error::io(&path, error))
}

fn text(scene: &Scene, drawn: &[u64], told: &str) -> String {
    let pictures: Vec<String> =
        drawn.iter().map(|&frame| format!("\"{PICTURES}/{}\"", overlay::file_name(frame))).collect();
    let figures: String = scene
        .targets
        .iter()
        .map(|target| {
            let name = format!("{FIGURES}/distance-over-time-{}.svg", target.id);
            format!("<img src=\"{name}\" alt=\"Distance of neighbour {} over time\">\n", target.id)
        })
        .collect();
    include_str!("page.html")
        .replace("{told}", told)
        .replace("{figures}", &figures)
        .replace("{picture_ms}", &PICTURE_MS.to_string())
        .replace("{pictures}", &pictures.join(",\n"))
}
