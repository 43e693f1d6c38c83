//! `lobe` of an LED: a name, `{ cosine_power = 3.0 }`, or `{ table_deg = [...], intensity = [...] }`.

use std::fmt;

use photinus::airframe::{Lobe, LobeError, LobeTable};
use serde::de::value::{MapAccessDeserializer, StrDeserializer};
use serde::de::{Deserializer, IntoDeserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize};

/// Angles are written to this many parts of a degree: what was written in degrees comes back as it was.
const PARTS_OF_A_DEGREE: f64 = 1e9;

/// The lobe as it stands in the file.
#[derive(Serialize)]
#[serde(untagged)]
pub(super) enum LobeEntry {
    Name(LobeName),
    Cosine(CosineEntry),
    Table(TableEntry),
}

#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum LobeName {
    Lambertian,
    Omni,
}

#[derive(Serialize)]
pub(super) struct CosineEntry {
    cosine_power: f64,
}

#[derive(Serialize)]
pub(super) struct TableEntry {
    table_deg: Vec<f64>,
    intensity: Vec<f64>,
}

/// Either of the two kinds of table.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AnyEntry {
    cosine_power: Option<f64>,
    table_deg: Option<Vec<f64>>,
    intensity: Option<Vec<f64>>,
}

impl LobeEntry {
    pub(super) fn of(lobe: &Lobe) -> Self {
        let written_deg = |at_rad: f64| (at_rad.to_degrees() * PARTS_OF_A_DEGREE).round() / PARTS_OF_A_DEGREE;
        match lobe {
            Lobe::Lambertian => Self::Name(LobeName::Lambertian),
            Lobe::Omni => Self::Name(LobeName::Omni),
            Lobe::Cosine { power } => Self::Cosine(CosineEntry { cosine_power: *power }),
            Lobe::Table(table) => {
                let entries = table.entries().map(|(at_rad, intensity)| (written_deg(at_rad), intensity));
                let (table_deg, intensity) = entries.unzip();
                Self::Table(TableEntry { table_deg, intensity })
            }
        }
    }

    pub(super) fn read(self) -> Result<Lobe, LobeError> {
        match self {
            Self::Name(LobeName::Lambertian) => Ok(Lobe::Lambertian),
            Self::Name(LobeName::Omni) => Ok(Lobe::Omni),
            Self::Cosine(CosineEntry { cosine_power }) => Ok(Lobe::Cosine { power: cosine_power }),
            Self::Table(TableEntry { table_deg, intensity }) => {
                let angles_rad: Vec<f64> = table_deg.into_iter().map(f64::to_radians).collect();
                LobeTable::new(&angles_rad, &intensity).map(Lobe::Table)
            }
        }
    }
}

impl<'de> Deserialize<'de> for LobeEntry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(EntryVisitor)
    }
}

/// Tells a name from a table, so that errors are about the one that is meant.
struct EntryVisitor;

impl<'de> Visitor<'de> for EntryVisitor {
    type Value = LobeEntry;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a name of a lobe, or a table with `cosine_power`, or with `table_deg` and `intensity`")
    }

    fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<LobeEntry, E> {
        let name: StrDeserializer<'_, E> = name.into_deserializer();
        LobeName::deserialize(name).map(LobeEntry::Name)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<LobeEntry, A::Error> {
        match AnyEntry::deserialize(MapAccessDeserializer::new(map))? {
            AnyEntry { cosine_power: Some(cosine_power), table_deg: None, intensity: None } => {
                Ok(LobeEntry::Cosine(CosineEntry { cosine_power }))
            }
            AnyEntry { cosine_power: None, table_deg: Some(table_deg), intensity: Some(intensity) } => {
                Ok(LobeEntry::Table(TableEntry { table_deg, intensity }))
            }
            _ => {
                Err(serde::de::Error::custom("a lobe has a `cosine_power`, or `table_deg` with `intensity`"))
            }
        }
    }
}
