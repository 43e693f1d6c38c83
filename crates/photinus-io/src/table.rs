//! TOML with errors that say line, key and what is known.

use std::path::Path;

use serde::de::DeserializeOwned;

use crate::{ContentError, Error, Place, Result};

/// Reads TOML into `T`, which lists the keys it knows and refuses others; `path` is for the messages.
///
/// # Errors
/// [`Error`] with the line for what is no TOML, for unknown and missing keys, and for values of another kind.
pub fn parse<T: DeserializeOwned>(text: &str, path: impl AsRef<Path>) -> Result<T> {
    let path = path.as_ref();
    toml::from_str(text).map_err(|error| {
        let cause = ContentError::of::<T>(toml::from_str(text).ok(), || error.message().to_owned());
        let advice = cause.advice().unwrap_or("correct it there; docs/file-formats.md has an example");
        let error_at = Error::new(path, cause).advise(advice);
        match error.span() {
            Some(span) => error_at.at(Place::Line(line_of(text, span.start))),
            None => error_at,
        }
    })
}

fn line_of(text: &str, byte: usize) -> usize {
    1 + text.bytes().take(byte).filter(|&b| b == b'\n').count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    #[expect(dead_code, reason = "read by serde only")]
    struct Table {
        width: u32,
        name: Option<String>,
    }

    fn message(text: &str) -> String {
        parse::<Table>(text, Path::new("t.toml")).unwrap_err().to_string()
    }

    #[test]
    fn messages_name_line_key_and_what_to_do() {
        assert_eq!(
            message("width = 1\nwidht = 2\n"),
            "t.toml, line 2: unknown key `widht`, expected `width` or `name`; correct its name or remove it"
        );
        assert_eq!(message("\nname = \"a\"\n"), "t.toml, line 1: missing key `width`; add it");
        assert!(
            message("width = -1")
                .contains("line 1: `-1` where a whole number, 0 or more, is expected; correct")
        );
        assert!(message("width = 1\nwidth = 2").starts_with("t.toml, line 2: duplicate key"));
        assert!(message("width = [[[").starts_with("t.toml, line 1: "));
    }
}
