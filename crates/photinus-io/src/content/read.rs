//! A tree as what is wanted of it: whatever is of another kind is told with what stands there and what is expected.

use serde::de::value::{MapAccessDeserializer, MapDeserializer, SeqDeserializer, StringDeserializer};
use serde::de::{Deserializer, IntoDeserializer, Visitor};
use serde::forward_to_deserialize_any;
use toml_datetime::de::DatetimeDeserializer;

use super::tree::{Key, Tree, Value};
use super::{ContentError, Found, Refusal, Wanted};

type Result<T> = std::result::Result<T, Refusal>;

impl Tree {
    fn is_no<T>(&self, wanted: Wanted) -> Result<T> {
        let found = match &self.value {
            Value::Nothing => Found::Nothing,
            Value::Flag(flag) => Found::Flag(*flag),
            Value::Whole(number) => Found::Whole(*number),
            Value::Number(number) => Found::Number(*number),
            Value::Text(text) => Found::Text(text.clone()),
            Value::Time(time) => Found::Other(format!("the time `{time}`")),
            Value::List(values) => Found::List(values.len()),
            Value::Table(_) => Found::Table,
        };
        Err(Refusal { why: ContentError::Kind { found, wanted }, at: self.at })
    }
}

impl<'de> IntoDeserializer<'de, Refusal> for Tree {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

impl<'de> IntoDeserializer<'de, Refusal> for Key {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

impl Key {
    fn name_a_kind<'de, V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        let name: StringDeserializer<Refusal> = self.name.into_deserializer();
        visitor.visit_enum(name).map_err(|refusal: Refusal| refusal.or_at(self.at))
    }
}

/// A key is a text; where it means nothing, it says where it stands.
impl<'de> Deserializer<'de> for Key {
    type Error = Refusal;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        visitor.visit_string(self.name).map_err(|refusal: Refusal| refusal.or_at(self.at))
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value> {
        self.name_a_kind(visitor)
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit unit_struct newtype_struct seq tuple
        tuple_struct map struct identifier ignored_any
    }
}

/// A whole number within the limits of its type.
macro_rules! whole {
    ($($deserialize:ident $visit:ident $number:ty),*) => {$(
        fn $deserialize<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
            match self.value {
                Value::Whole(number) if <$number>::try_from(number).is_ok() => {
                    visitor.$visit(number as $number).map_err(|refusal: Refusal| refusal.or_at(self.at))
                }
                _ => self.is_no(Wanted::Whole { least: <$number>::MIN.into(), most: <$number>::MAX.into() }),
            }
        }
    )*};
}

impl<'de> Deserializer<'de> for Tree {
    type Error = Refusal;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        let read = match self.value {
            Value::Nothing => visitor.visit_unit(),
            Value::Flag(flag) => visitor.visit_bool(flag),
            Value::Whole(number) => match (i64::try_from(number), u64::try_from(number)) {
                (Ok(number), _) => visitor.visit_i64(number),
                (_, Ok(number)) => visitor.visit_u64(number),
                _ => visitor.visit_i128(number),
            },
            Value::Number(number) => visitor.visit_f64(number),
            Value::Text(text) => visitor.visit_string(text),
            Value::Time(time) => visitor.visit_map(DatetimeDeserializer::new(time)),
            Value::List(values) => visitor.visit_seq(SeqDeserializer::new(values.into_iter())),
            Value::Table(entries) => visitor.visit_map(MapDeserializer::new(entries.into_iter())),
        };
        read.map_err(|refusal: Refusal| refusal.or_at(self.at))
    }

    whole! {
        deserialize_i8 visit_i8 i8, deserialize_i16 visit_i16 i16, deserialize_i32 visit_i32 i32,
        deserialize_i64 visit_i64 i64, deserialize_u8 visit_u8 u8, deserialize_u16 visit_u16 u16,
        deserialize_u32 visit_u32 u32, deserialize_u64 visit_u64 u64
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        match self.value {
            Value::Flag(_) => self.deserialize_any(visitor),
            _ => self.is_no(Wanted::Flag),
        }
    }

    fn deserialize_f32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        self.deserialize_f64(visitor)
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        match self.value {
            Value::Whole(_) | Value::Number(_) => self.deserialize_any(visitor),
            _ => self.is_no(Wanted::Number),
        }
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        match self.value {
            Value::Text(_) => self.deserialize_any(visitor),
            _ => self.is_no(Wanted::Text),
        }
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        self.deserialize_str(visitor)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        match self.value {
            Value::List(_) => self.deserialize_any(visitor),
            _ => self.is_no(Wanted::List { length: None }),
        }
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value> {
        match self.value {
            Value::List(ref values) if values.len() == length => self.deserialize_any(visitor),
            _ => self.is_no(Wanted::List { length: Some(length) }),
        }
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        length: usize,
        visitor: V,
    ) -> Result<V::Value> {
        self.deserialize_tuple(length, visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        match self.value {
            Value::Table(_) => self.deserialize_any(visitor),
            _ => self.is_no(Wanted::Table),
        }
    }

    /// A list of the values without their keys is one, too, as it is in JSON.
    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value> {
        match self.value {
            Value::Table(_) | Value::Time(_) | Value::List(_) => self.deserialize_any(visitor),
            _ => self.is_no(Wanted::Table),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        match self.value {
            Value::Nothing => visitor.visit_none(),
            _ => visitor.visit_some(self),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> Result<V::Value> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value> {
        match self.value {
            Value::Text(name) => Key { at: self.at, name }.name_a_kind(visitor),
            Value::Table(entries) if entries.len() == 1 => {
                let one = MapAccessDeserializer::new(MapDeserializer::new(entries.into_iter()));
                visitor.visit_enum(one).map_err(|refusal: Refusal| refusal.or_at(self.at))
            }
            Value::Table(entries) => {
                let found = Found::Other(format!("a table of {} keys", entries.len()));
                let wanted = Wanted::Other("one name with its values".to_owned());
                Err(Refusal { why: ContentError::Kind { found, wanted }, at: self.at })
            }
            _ => self.is_no(Wanted::Text),
        }
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        visitor.visit_unit()
    }

    forward_to_deserialize_any! { i128 u128 char bytes byte_buf unit unit_struct identifier }
}
