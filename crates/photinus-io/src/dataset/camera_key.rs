//! The key `camera` of dataset.toml: a file, or a list of tables.

use std::fmt;
use std::path::PathBuf;

use serde::Deserialize;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserializer, SeqAccess, Visitor};

use super::info::RigCamera;

/// What stands at the key. Written out rather than derived: an error names the line and the key inside a `[[camera]]`.
pub(super) enum CameraKey {
    One(PathBuf),
    Several(Vec<RigCamera>),
}

impl<'de> Deserialize<'de> for CameraKey {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = CameraKey;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a camera file, or [[camera]] tables")
            }

            fn visit_str<E>(self, path: &str) -> Result<CameraKey, E> {
                Ok(CameraKey::One(path.into()))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, cameras: A) -> Result<CameraKey, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(cameras)).map(CameraKey::Several)
            }
        }
        deserializer.deserialize_any(Either)
    }
}
