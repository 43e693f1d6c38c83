//! Tables -> their places in docs/world.md, which are marked by comments.

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/world.md");

/// Puts what was measured of `what` where the document has it, under the command that measures it again.
///
/// # Errors
/// Why the document cannot be read or written, or that it has no place for them.
pub(crate) fn update(what: &str, frames: u64, measured: &str) -> Result<(), String> {
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
    let section = format!("\n{command}\n{measured}\n");
    std::fs::write(FILE, [before, &begin, &section, &end, after].concat()).map_err(failed)
}
