//! Tables -> their places in a document, which are marked by comments.

use std::fmt;

/// Tables of a document in `docs`, by the names of their places.
pub(crate) struct Document {
    pub(crate) file: &'static str,
    pub(crate) tables: Vec<(&'static str, String)>,
}

impl Document {
    /// Writes the tables where the document has them.
    ///
    /// # Errors
    /// Why it cannot be read or written, or that it has no place for a table.
    pub(crate) fn update(&self) -> Result<(), String> {
        let path = format!("{}/../../docs/{}", env!("CARGO_MANIFEST_DIR"), self.file);
        let failed = |error: std::io::Error| format!("{path}: {error}");
        let mut text = std::fs::read_to_string(&path).map_err(failed)?;
        for (name, table) in &self.tables {
            let (begin, end) =
                (format!("<!-- {name}: as generated -->\n"), format!("<!-- {name}: end -->\n"));
            let parts = text.split_once(&begin).and_then(|(before, rest)| {
                let (_, after) = rest.split_once(&end)?;
                Some((before, after))
            });
            let (before, after) = parts.ok_or_else(|| format!("{path}: there is no place marked {name}"))?;
            text = [before, &begin, "\n", table, "\n", &end, after].concat();
        }
        std::fs::write(&path, text).map_err(failed)
    }
}

impl fmt::Display for Document {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.tables.iter().try_for_each(|(name, table)| write!(f, "{name}\n\n{table}\n"))
    }
}

/// A table in Markdown.
pub(crate) fn markdown<S: AsRef<str>>(rows: impl IntoIterator<Item = Vec<S>>) -> String {
    let mut text = String::new();
    for (number, row) in rows.into_iter().enumerate() {
        let cells: Vec<&str> = row.iter().map(AsRef::as_ref).collect();
        text += &format!("| {} |\n", cells.join(" | "));
        if number == 0 {
            text += &format!("|{}\n", "---|".repeat(cells.len()));
        }
    }
    text
}
