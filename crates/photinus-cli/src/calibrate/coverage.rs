//! `photinus calibrate coverage`: where in the image photos of the grid are still missing.

use photinus_calibrate::camera::{Coverage, Part};

use super::advice;
use super::photos::PhotoArgs;
use crate::failure::Failure;
use crate::terminal::Terminal;

const EXAMPLES: &str = "\
Examples:
  photinus calibrate coverage photos/*.png --grid 7x5

Run it while photographing: it takes a fraction of a second.";

/// Say where in the image photos of the grid are still missing
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    #[command(flatten)]
    photos: PhotoArgs,
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &mut Terminal) -> Result<(), Failure> {
    let searched = args.photos.search(terminal)?;
    for (photo, error) in &searched.refused {
        let name = &searched.photos[*photo].name;
        terminal.warning(format_args!("{name}: not counted: {error}; {}", advice::on(error)));
    }
    let coverage = Coverage::of(&searched.views, searched.size_px);
    terminal.result(format_args!(
        "{} of {} photos show the grid; photos that show it",
        coverage.photos(),
        searched.photos.len()
    ))?;
    let parts: Vec<Part> = Part::all().collect();
    for row in parts.chunks(3) {
        let seen: Vec<String> = row.iter().map(|part| format!("{:>4}", coverage.seen(*part))).collect();
        terminal.result(format_args!("  {}", seen.join("")))?;
    }
    let lacks = coverage.lacks();
    for lack in &lacks {
        terminal.result(lack)?;
    }
    if lacks.is_empty() {
        terminal.result("every part of the image is covered")?;
    }
    Ok(())
}
