//! The key `airframe` of dataset.toml: a file, or a list of files where neighbours are of several kinds.

use std::fmt;
use std::path::PathBuf;

use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserializer, SeqAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};

/// The airframes of a dataset, a file for each kind of vehicle; paths are relative to its folder.
#[derive(Clone, Debug, PartialEq)]
pub struct AirframeFiles {
    /// The first kind, of most datasets the only one.
    pub first: PathBuf,
    /// Further kinds.
    pub more: Vec<PathBuf>,
}

impl AirframeFiles {
    /// All of them, the first one first.
    pub fn iter(&self) -> impl Iterator<Item = &PathBuf> {
        std::iter::once(&self.first).chain(&self.more)
    }

    /// The same kinds under other names.
    #[must_use]
    pub fn map(&self, change: impl FnMut(&PathBuf) -> PathBuf) -> Self {
        let mut files = self.iter().map(change);
        Self { first: files.next().unwrap_or_default(), more: files.collect() }
    }

    /// The same kinds under other names.
    ///
    /// # Errors
    /// The first that `change` gives.
    pub fn try_map<E>(&self, mut change: impl FnMut(&PathBuf) -> Result<PathBuf, E>) -> Result<Self, E> {
        let first = change(&self.first)?;
        Ok(Self { first, more: self.more.iter().map(change).collect::<Result<_, E>>()? })
    }
}

impl<P: Into<PathBuf>> From<P> for AirframeFiles {
    fn from(only: P) -> Self {
        Self { first: only.into(), more: Vec::new() }
    }
}

impl Serialize for AirframeFiles {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.more.is_empty() {
            true => self.first.serialize(serializer),
            false => serializer.collect_seq(self.iter()),
        }
    }
}

impl<'de> Deserialize<'de> for AirframeFiles {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = AirframeFiles;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an airframe file, or a list of them")
            }

            fn visit_str<E>(self, path: &str) -> Result<AirframeFiles, E> {
                Ok(path.into())
            }

            fn visit_seq<A: SeqAccess<'de>>(self, files: A) -> Result<AirframeFiles, A::Error> {
                let mut files = Vec::<PathBuf>::deserialize(SeqAccessDeserializer::new(files))?.into_iter();
                let nobody = || serde::de::Error::invalid_length(0, &"at least one airframe file");
                Ok(AirframeFiles { first: files.next().ok_or_else(nobody)?, more: files.collect() })
            }
        }
        deserializer.deserialize_any(Either)
    }
}
