//! Tables of text whose columns align.

use std::fmt;

/// Which side of a column its cells stand at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Left,
    Right,
}

/// Rows of cells; two spaces stand between columns, and every row begins with an indent.
#[derive(Debug, Default)]
pub(crate) struct Aligned {
    indent: usize,
    sides: Vec<Side>,
    rows: Vec<Vec<String>>,
}

impl Aligned {
    /// A table with columns of these sides; further ones are at the left.
    pub(crate) fn new(indent: usize, sides: &[Side]) -> Self {
        Self { indent, sides: sides.to_vec(), rows: Vec::new() }
    }

    /// Adds a row.
    pub(crate) fn row<S: Into<String>>(&mut self, cells: impl IntoIterator<Item = S>) {
        self.rows.push(cells.into_iter().map(Into::into).collect());
    }

    fn widths(&self) -> Vec<usize> {
        let mut widths = Vec::new();
        for row in &self.rows {
            widths.resize(widths.len().max(row.len()), 0);
            for (cell, width) in row.iter().zip(&mut widths) {
                *width = (*width).max(cell.chars().count());
            }
        }
        widths
    }
}

impl fmt::Display for Aligned {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let widths = self.widths();
        for (number, row) in self.rows.iter().enumerate() {
            let mut line = " ".repeat(self.indent);
            for (column, (cell, &width)) in row.iter().zip(&widths).enumerate() {
                let gap = if column == 0 { "" } else { "  " };
                line += &match self.sides.get(column) {
                    Some(Side::Right) => format!("{gap}{cell:>width$}"),
                    _ => format!("{gap}{cell:<width$}"),
                };
            }
            let end = if number == 0 { "" } else { "\n" };
            write!(f, "{end}{}", line.trim_end())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_align_and_no_line_ends_in_spaces() {
        let mut table = Aligned::new(1, &[Side::Left, Side::Right]);
        table.row(["a", "12.5°", "x"]);
        table.row(["long", "3°", ""]);
        assert_eq!(table.to_string(), " a     12.5°  x\n long     3°");
    }
}
