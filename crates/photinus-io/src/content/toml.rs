//! TOML as a tree that says where each value stands.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::tree::{Key, Tree, Value};
use super::{ContentError, Refusal};

impl Tree {
    /// Of a TOML text.
    pub(crate) fn of_toml(text: &str) -> Result<Self, Refusal> {
        let table = DeTable::parse(text).map_err(|error| Refusal {
            why: ContentError::Syntax(error.message().to_owned()),
            at: error.span().map(|span| span.start),
        })?;
        let at = Some(table.span().start);
        Ok(Self { at, value: of_table(table.into_inner())? })
    }
}

fn of_table(table: DeTable<'_>) -> Result<Value, Refusal> {
    let entry = |(key, value): (Spanned<_>, Spanned<DeValue<'_>>)| {
        let at = Some(key.span().start);
        let name = std::borrow::Cow::into_owned(key.into_inner());
        Ok((Key { at, name }, tree(value)?))
    };
    table.into_iter().map(entry).collect::<Result<_, _>>().map(Value::Table)
}

fn tree(value: Spanned<DeValue<'_>>) -> Result<Tree, Refusal> {
    let at = Some(value.span().start);
    let too_large = |number: &str| Refusal {
        why: ContentError::Meaning(format!("`{number:.40}` is larger than any number that is read")),
        at,
    };
    let value = match value.into_inner() {
        DeValue::String(text) => Value::Text(text.into_owned()),
        DeValue::Integer(number) => {
            let read = i128::from_str_radix(number.as_str(), number.radix());
            Value::Whole(read.map_err(|_| too_large(number.as_str()))?)
        }
        DeValue::Float(number) => {
            let is_meant =
                |read: &f64| read.is_finite() || !number.as_str().contains(|c: char| c.is_ascii_digit());
            let read = number.as_str().parse().ok().filter(is_meant);
            Value::Number(read.ok_or_else(|| too_large(number.as_str()))?)
        }
        DeValue::Boolean(flag) => Value::Flag(flag),
        DeValue::Datetime(time) => Value::Time(time),
        DeValue::Array(values) => Value::List(values.into_iter().map(tree).collect::<Result<_, _>>()?),
        DeValue::Table(table) => of_table(table)?,
    };
    Ok(Tree { at, value })
}
