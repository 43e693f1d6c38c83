//! Tables -> their places in docs/world.md, which are marked by comments.

use crate::table::Table;

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/world.md");

/// Puts the tables of `what` where the document has them, and notes under them.
///
/// # Errors
/// Why the document cannot be read or written, or that it has no place for them.
pub(crate) fn update(
    what: &str,
    frames: u64,
    [neighbours, spots]: &[Table; 2],
    notes: &str,
) -> Result<(), String> {
    let failed = |error: std::io::Error| format!("{FILE}: {error}");
    let text = std::fs::read_to_string(FILE).map_err(failed)?;
    let (begin, end) = (format!("<!-- {what}: as generated -->\n"), format!("<!-- {what}: end -->\n"));
    let parts = text.split_once(&begin).and_then(|(before, rest)| {
        let (_, after) = rest.split_once(&end)?;
        Some((before, after))
    });
    let (before, after) = parts.ok_or_else(|| format!("{FILE}: there is no place marked {what}"))?;
    let command =
        format!("    cargo run --release -p photinus-evaluate --example world -- {what} {frames} --update\n");
    let tables = format!("\n{command}\n{}\nSpots:\n\n{}\n{notes}", neighbours.markdown(), spots.markdown());
    std::fs::write(FILE, [before, &begin, &tables, &end, after].concat()).map_err(failed)
}
