//! Why a well-formed file is not what it should be, as a type rather than as a library's sentence.
//!
//! The libraries of TOML, JSON and YAML say what is wrong with a file in words of Rust. So a file is read as a plain tree of values ([`Tree`]),
//! and the tree as what was wanted, with errors of our own: TOML at once, for its tree says where each value stands; JSON and YAML once they were
//! refused, for they are read in bulk and by rules of their own.

mod read;
mod toml;
mod tree;

use std::fmt;

use serde::de::{DeserializeOwned, Expected, Unexpected};

pub(crate) use tree::Tree;

/// What is wrong with the content of a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContentError {
    /// The text does not follow the syntax of its format.
    #[error("{0}")]
    Syntax(String),
    /// A table has a key that means nothing there.
    #[error("unknown key `{key}`, {}", OneOf(.known))]
    UnknownKey {
        /// The key.
        key: String,
        /// The keys that it may have.
        known: Vec<&'static str>,
    },
    /// A table lacks a key.
    #[error("missing key `{0}`")]
    MissingKey(String),
    /// A table has a key twice.
    #[error("duplicate key `{0}`")]
    DuplicateKey(String),
    /// A name that means nothing there.
    #[error("unknown name `{name}`, {}", OneOf(.known))]
    UnknownName {
        /// The name.
        name: String,
        /// The names that may stand there.
        known: Vec<&'static str>,
    },
    /// A value of another kind than belongs there.
    #[error("{found} where {wanted} is expected")]
    Kind {
        /// What stands there.
        found: Found,
        /// What is expected.
        wanted: Wanted,
    },
    /// A value of the right kind that has no meaning.
    #[error("{0}")]
    Meaning(String),
}

/// What stands in a file.
#[derive(Clone, Debug, PartialEq)]
#[expect(missing_docs, reason = "the names say it")]
pub enum Found {
    Nothing,
    Flag(bool),
    Whole(i128),
    Number(f64),
    Text(String),
    List(usize),
    Table,
    Other(String),
}

/// What is expected in a file.
#[derive(Clone, Debug, PartialEq)]
#[expect(missing_docs, reason = "the names say it")]
pub enum Wanted {
    Flag,
    Number,
    Whole { least: i128, most: i128 },
    Text,
    List { length: Option<usize> },
    Table,
    Other(String),
}

impl ContentError {
    /// What is to be done about it, where that is more than to correct it.
    pub(crate) fn advice(&self) -> Option<&'static str> {
        match self {
            Self::MissingKey(_) => Some("add it"),
            Self::UnknownKey { .. } => Some("correct its name or remove it"),
            _ => None,
        }
    }

    /// Why the text of a tree is no `T`; `syntax` where it is not even a tree.
    pub(crate) fn of<T: DeserializeOwned>(tree: Option<Tree>, syntax: impl FnOnce() -> String) -> Self {
        let refusal = tree.and_then(|tree| T::deserialize(tree).err());
        refusal.map_or_else(|| Self::Syntax(syntax()), |refusal| refusal.why)
    }

    /// Why a JSON text is no `T`.
    pub(crate) fn of_json<T: DeserializeOwned>(text: &[u8], error: &serde_json::Error) -> Self {
        Self::of::<T>(serde_json::from_slice(text).ok(), || json_syntax(text, error))
    }
}

/// What is no JSON: the word or the sign at the place of the error.
fn json_syntax(text: &[u8], error: &serde_json::Error) -> String {
    if error.is_eof() {
        return "it ends too early".to_owned();
    }
    let line = text.split(|&byte| byte == b'\n').nth(error.line().saturating_sub(1)).unwrap_or_default();
    let is_word = |byte: &u8| !byte.is_ascii_whitespace() && !b",:[]{}\"".contains(byte);
    let at = error.column().saturating_sub(1).min(line.len());
    let start = line[..at].iter().rposition(|byte| !is_word(byte)).map_or(0, |before| before + 1);
    let end = line[at..].iter().position(|byte| !is_word(byte)).map_or(line.len(), |length| at + length);
    match (&line[start..end], line.get(at)) {
        ([], None) => "it goes on where a value, a comma or a closing bracket is expected".to_owned(),
        ([], Some(&sign)) => format!("`{}` does not belong there", char::from(sign).escape_default()),
        (word, _) => format!("`{:.40}` is no JSON", String::from_utf8_lossy(word)),
    }
}

/// The names of which one is expected.
struct OneOf<'a>(&'a [&'static str]);

impl fmt::Display for OneOf<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            [] => write!(f, "none is expected"),
            [one] => write!(f, "expected `{one}`"),
            [one, other] => write!(f, "expected `{one}` or `{other}`"),
            several => write!(f, "expected one of `{}`", several.join("`, `")),
        }
    }
}

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nothing => write!(f, "null"),
            Self::Flag(flag) => write!(f, "`{flag}`"),
            Self::Whole(number) => write!(f, "`{number}`"),
            Self::Number(number) => write!(f, "`{number:?}`"),
            Self::Text(text) => write!(f, "the text `{text:.40}`"),
            Self::List(length) => write!(f, "a list of {length}"),
            Self::Table => write!(f, "a table"),
            Self::Other(what) => write!(f, "{what}"),
        }
    }
}

impl fmt::Display for Wanted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flag => write!(f, "true or false"),
            Self::Number => write!(f, "a number"),
            // What 32 bits hold is our limit; nobody who writes a file thinks of it.
            Self::Whole { least: 0, most } if *most >= i128::from(u32::MAX) => {
                write!(f, "a whole number, 0 or more,")
            }
            Self::Whole { least, most } if *most >= i128::from(i32::MAX) && *least < 0 => {
                write!(f, "a whole number")
            }
            Self::Whole { least, most } => write!(f, "a whole number of {least} to {most}"),
            Self::Text => write!(f, "a text"),
            Self::List { length: None } => write!(f, "a list"),
            Self::List { length: Some(length) } => write!(f, "a list of {length}"),
            Self::Table => write!(f, "a table"),
            Self::Other(what) => write!(f, "{what}"),
        }
    }
}

impl From<Unexpected<'_>> for Found {
    fn from(unexpected: Unexpected<'_>) -> Self {
        match unexpected {
            Unexpected::Bool(flag) => Self::Flag(flag),
            Unexpected::Unsigned(number) => Self::Whole(number.into()),
            Unexpected::Signed(number) => Self::Whole(number.into()),
            Unexpected::Float(number) => Self::Number(number),
            Unexpected::Str(text) => Self::Text(text.to_owned()),
            Unexpected::Unit | Unexpected::Option => Self::Nothing,
            Unexpected::Map => Self::Table,
            other => Self::Other(other.to_string()),
        }
    }
}

/// What is wrong with a tree, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{why}")]
pub(crate) struct Refusal {
    pub(crate) why: ContentError,
    /// The byte of the text at which it stands, where that is known.
    pub(crate) at: Option<usize>,
}

impl Refusal {
    /// The same, there unless something deeper has said where it stands.
    fn or_at(self, at: Option<usize>) -> Self {
        Self { at: self.at.or(at), ..self }
    }
}

impl From<ContentError> for Refusal {
    fn from(why: ContentError) -> Self {
        Self { why, at: None }
    }
}

impl serde::de::Error for Refusal {
    fn custom<T: fmt::Display>(reason: T) -> Self {
        ContentError::Meaning(reason.to_string()).into()
    }

    fn invalid_type(unexpected: Unexpected<'_>, expected: &dyn Expected) -> Self {
        ContentError::Kind { found: unexpected.into(), wanted: Wanted::Other(expected.to_string()) }.into()
    }

    fn invalid_value(unexpected: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::invalid_type(unexpected, expected)
    }

    fn invalid_length(length: usize, expected: &dyn Expected) -> Self {
        ContentError::Kind { found: Found::List(length), wanted: Wanted::Other(expected.to_string()) }.into()
    }

    fn unknown_variant(name: &str, known: &'static [&'static str]) -> Self {
        ContentError::UnknownName { name: name.to_owned(), known: known.to_vec() }.into()
    }

    fn unknown_field(key: &str, known: &'static [&'static str]) -> Self {
        ContentError::UnknownKey { key: key.to_owned(), known: known.to_vec() }.into()
    }

    fn missing_field(key: &'static str) -> Self {
        ContentError::MissingKey(key.to_owned()).into()
    }

    fn duplicate_field(key: &'static str) -> Self {
        ContentError::DuplicateKey(key.to_owned()).into()
    }
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[expect(dead_code, reason = "read by serde only")]
    struct Thing {
        level: u8,
        count: Option<u32>,
        place: [f64; 3],
        name: Name,
        list: Option<Vec<bool>>,
    }

    #[derive(Debug, Deserialize)]
    #[serde(rename_all = "lowercase")]
    #[expect(dead_code, reason = "read by serde only")]
    enum Name {
        Ring,
        Quad(f64),
    }

    fn told(text: &str) -> String {
        let error = serde_json::from_str::<Thing>(text).unwrap_err();
        ContentError::of_json::<Thing>(text.as_bytes(), &error).to_string()
    }

    #[test]
    fn every_mistake_is_told_in_the_words_of_a_file() {
        let good = "{\"level\":1,\"place\":[0,0.5,-1],\"name\":\"ring\"}";
        assert!(serde_json::from_str::<Thing>(good).is_ok());
        for (from, to, expected) in [
            (":1", ":300", "`300` where a whole number of 0 to 255 is expected"),
            (":1", ":-1", "`-1` where a whole number of 0 to 255 is expected"),
            (":1", ":0.5", "`0.5` where a whole number of 0 to 255 is expected"),
            (":1", ":1,\"count\":-1", "`-1` where a whole number, 0 or more, is expected"),
            (":1", ":null", "null where a whole number of 0 to 255 is expected"),
            ("[0,0.5,-1]", "[0,0.5]", "a list of 2 where a list of 3 is expected"),
            ("[0,0.5,-1]", "[0,0.5,1,2]", "a list of 4 where a list of 3 is expected"),
            ("[0,0.5,-1]", "7", "`7` where a list of 3 is expected"),
            ("0.5", "\"far\"", "the text `far` where a number is expected"),
            ("0.5", "{}", "a table where a number is expected"),
            ("\"ring\"", "\"rink\"", "unknown name `rink`, expected `ring` or `quad`"),
            ("\"ring\"", "{\"quad\":true}", "`true` where a number is expected"),
            (
                "\"level\":1",
                "\"levl\":1",
                "unknown key `levl`, expected one of `level`, `count`, `place`, `name`, `list`",
            ),
            ("\"level\":1,", "", "missing key `level`"),
            (":1", ":1,\"level\":2", "duplicate key `level`"),
            (":1", ":1,\"list\":[0]", "`0` where true or false is expected"),
            ("0.5", "NaN", "`NaN` is no JSON"),
            ("0.5", "1e400", "`1e400` is no JSON"),
            (",\"place\"", ",,\"place\"", "`,` does not belong there"),
            ("\"}", "\"", "it ends too early"),
        ] {
            let text = good.replace(from, to);
            assert_ne!(text, good, "{from}");
            assert_eq!(told(&text), expected, "{text}");
        }
    }
}
