//! A file as a plain tree of values, whatever its format.
//!
//! TOML is always read this way (`toml.rs`), for its tree says where each value stands. JSON and YAML are, by any deserializer that knows the
//! kinds of its values, where a file was refused; their libraries say themselves where.

use std::fmt;

use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use toml::value::Datetime;

/// A value and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tree {
    /// The byte of the text at which it begins, where that is known.
    pub(super) at: Option<usize>,
    pub(super) value: Value,
}

/// A value, or trees of them. A key that stands twice stays twice.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Nothing,
    Flag(bool),
    Whole(i128),
    Number(f64),
    Text(String),
    Time(Datetime),
    List(Vec<Tree>),
    Table(Vec<(Key, Tree)>),
}

/// The name of a value in a table.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Key {
    pub(super) at: Option<usize>,
    pub(super) name: String,
}

impl From<Value> for Tree {
    fn from(value: Value) -> Self {
        Self { at: None, value }
    }
}

impl<'de> Deserialize<'de> for Tree {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Grower).map(Self::from)
    }
}

struct Grower;

impl<'de> Visitor<'de> for Grower {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Nothing)
    }

    fn visit_bool<E>(self, flag: bool) -> Result<Value, E> {
        Ok(Value::Flag(flag))
    }

    fn visit_i64<E>(self, number: i64) -> Result<Value, E> {
        Ok(Value::Whole(number.into()))
    }

    fn visit_u64<E>(self, number: u64) -> Result<Value, E> {
        Ok(Value::Whole(number.into()))
    }

    fn visit_f64<E>(self, number: f64) -> Result<Value, E> {
        Ok(Value::Number(number))
    }

    fn visit_str<E>(self, text: &str) -> Result<Value, E> {
        Ok(Value::Text(text.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Value, A::Error> {
        let mut values = Vec::new();
        while let Some(value) = list.next_element()? {
            values.push(value);
        }
        Ok(Value::List(values))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut table: A) -> Result<Value, A::Error> {
        let mut entries = Vec::new();
        while let Some((name, value)) = table.next_entry()? {
            entries.push((Key { at: None, name }, value));
        }
        Ok(Value::Table(entries))
    }
}
