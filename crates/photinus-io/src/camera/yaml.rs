//! YAML, with errors that name the line.

use std::collections::BTreeMap;
use std::path::Path;

use serde::de::{DeserializeOwned, IgnoredAny};
use serde_saphyr::{MessageFormatter, NonFiniteFloatPolicy, UserMessageFormatter};

use super::RENEW;
use crate::{ContentError, Error, Place, Result};

/// Reads a document; keys that `T` does not name are passed over, as these files carry many.
pub(super) fn parse<T: DeserializeOwned>(text: &str, path: &Path) -> Result<T> {
    serde_saphyr::from_str(text).map_err(|error| {
        let cause = cause::<T>(text, error.without_snippet());
        let advice = cause.advice().unwrap_or(RENEW);
        let wrong = Error::new(path, cause).advise(advice);
        match error.location().and_then(|location| usize::try_from(location.line()).ok()) {
            Some(line) if line > 0 => wrong.at(Place::Line(line)),
            _ => wrong,
        }
    })
}

fn cause<T: DeserializeOwned>(text: &str, error: &serde_saphyr::Error) -> ContentError {
    if let serde_saphyr::Error::DuplicateMappingKey { key: Some(key), .. } = error {
        return ContentError::DuplicateKey(key.clone());
    }
    let any_number = serde_saphyr::options! { non_finite_float_policy: NonFiniteFloatPolicy::PassThrough };
    let tree = serde_saphyr::from_str_with_options(text, any_number).ok();
    ContentError::of::<T>(tree, || UserMessageFormatter.format_message(error).into_owned())
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
