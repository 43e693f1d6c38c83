//! YAML, with errors that name the line.

use std::collections::BTreeMap;
use std::path::Path;

use serde::de::{DeserializeOwned, IgnoredAny};

use super::advice_for;
use crate::error::in_plain_words;
use crate::{Error, Place, Result};

/// Reads a document; keys that `T` does not name are passed over, as these files carry many.
pub(super) fn parse<T: DeserializeOwned>(text: &str, path: &Path) -> Result<T> {
    serde_saphyr::from_str(text).map_err(|error| {
        let message = error.without_snippet().to_string();
        // the place says the line, with the file, as every error does
        let reason = in_plain_words(message.split(" at line ").next().unwrap_or_default());
        let advice = advice_for(&reason);
        let wrong = Error::format(path, reason).advise(advice);
        match error.location().and_then(|location| usize::try_from(location.line()).ok()) {
            Some(line) if line > 0 => wrong.at(Place::Line(line)),
            _ => wrong,
        }
    })
}

/// The keys at the top of a document.
pub(super) fn keys(text: &str, path: &Path) -> Result<Vec<String>> {
    Ok(parse::<BTreeMap<String, IgnoredAny>>(text, path)?.into_keys().collect())
}

/// A value that the format requires.
pub(super) fn required<T>(value: Option<T>, key: &str, path: &Path) -> Result<T> {
    value.ok_or_else(|| Error::format(path, format!("missing key `{key}`")).advise("add it"))
}

/// An error in the value of a key, and what to do.
pub(super) fn at_key(path: &Path, key: &str, reason: impl Into<String>, advice: &str) -> Error {
    Error::format(path, reason).at(Place::Key(key.to_owned())).advise(advice)
}
