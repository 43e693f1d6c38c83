//! Where the results of many recordings go: enters a folder and what the recordings are called, leaves a place for each, and whether the
//! folder may be gone on with.

use std::collections::{BTreeMap, HashMap};
use std::ffi::OsString;
use std::path::{Component, Path, PathBuf};

use clap::parser::ValueSource;
use clap::{ArgMatches, CommandFactory};
use photinus_io::whole::{Existing, read_text, write_whole};
use photinus_io::{Error, Result};
use serde::{Deserialize, Serialize};

use crate::Program;

/// The file that says how the results of a folder were made.
const MADE_BY: &str = "photinus.json";
/// What does not change results.
const WITHOUT_EFFECT: [&str; 6] = ["inputs", "out_dir", "jobs", "parquet", "force", "quiet"];

/// A recording, and where its results go.
pub(super) struct Place {
    /// As it was named.
    pub(super) input: PathBuf,
    /// There when it is located, and not before.
    pub(super) results: PathBuf,
}

impl Place {
    /// The place of its table.
    #[cfg(feature = "parquet")]
    pub(super) fn table(&self) -> PathBuf {
        self.results.with_extension("parquet")
    }
}

/// A place below `folder` for each input, by the name that it was given: what else is located with it changes nothing.
///
/// # Errors
/// [`Error`] when an input is a stream, or two would have one place.
pub(super) fn places(folder: &Path, inputs: &[PathBuf]) -> Result<Vec<Place>> {
    let mut taken: HashMap<PathBuf, &Path> = HashMap::new();
    let mut places = Vec::with_capacity(inputs.len());
    for input in inputs {
        let results = folder.join(name(input)?);
        if let Some(other) = taken.insert(results.clone(), input) {
            let reason = format!("its results would be those of {}, too", other.display());
            return Err(Error::format(input, reason).advise("name each recording once, and without `..`"));
        }
        places.push(Place { input: input.clone(), results });
    }
    Ok(places)
}

/// The path as it was given without its root and `..`, and `.jsonl`.
fn name(input: &Path) -> Result<PathBuf> {
    if input.as_os_str() == "-" {
        return Err(Error::format(input, "a stream has no name that its results could have")
            .advise("use --out in place of --out-dir"));
    }
    let normal = |path: &Path| -> PathBuf {
        path.components().filter(|part| matches!(part, Component::Normal(_))).collect()
    };
    let named = match normal(input) {
        // `.`, or a chain of `..`.
        empty if empty.as_os_str().is_empty() => {
            normal(&input.canonicalize().map_err(|error| Error::io(input, error))?)
        }
        named => named,
    };
    let mut name = OsString::from(named);
    name.push(".jsonl");
    Ok(name.into())
}

/// How results were made: one folder has results of one kind alone.
#[derive(PartialEq, Serialize, Deserialize)]
struct MadeBy {
    photinus: String,
    options: BTreeMap<String, Vec<String>>,
}

impl MadeBy {
    /// By the options of this command line that have an effect, as they were written.
    fn this() -> Self {
        let matches = Program::command().get_matches();
        let command = Program::command();
        let locate = command.find_subcommand("locate").zip(matches.subcommand_matches("locate"));
        let given = |(command, matches): (&clap::Command, &ArgMatches)| {
            let names = command.get_arguments().map(|argument| argument.get_id().as_str());
            names.filter_map(|name| Some((name.to_owned(), values(matches, name)?))).collect()
        };
        Self {
            photinus: env!("CARGO_PKG_VERSION").to_owned(),
            options: locate.map(given).unwrap_or_default(),
        }
    }
}

/// What was given for an option that has an effect.
fn values(matches: &ArgMatches, name: &str) -> Option<Vec<String>> {
    let is_given = matches.value_source(name) == Some(ValueSource::CommandLine);
    let raw = (is_given && !WITHOUT_EFFECT.contains(&name)).then(|| matches.get_raw(name))??;
    Some(raw.map(|value| value.to_string_lossy().into_owned()).collect())
}

/// Opens the folder for results of this run's options: a new one, or one of the same options, or any if it may be replaced.
///
/// # Errors
/// [`Error`] when it holds something else, or cannot be written to.
pub(super) fn open(folder: &Path, replace: bool) -> Result<()> {
    let note = folder.join(MADE_BY);
    let this = MadeBy::this();
    if note.is_file() && !replace {
        let made: Option<MadeBy> = serde_json::from_str(&read_text(&note)?).ok();
        if made.is_some_and(|made| made == this) {
            return Ok(());
        }
        return Err(Error::format(&note, "the results here were made by other options, or another version")
            .advise("give the options that stand there, name another folder, or do all anew with --force"));
    }
    let is_empty = |mut entries: std::fs::ReadDir| entries.next().is_none();
    if folder.exists() && !replace && !std::fs::read_dir(folder).is_ok_and(is_empty) {
        return Err(Error::format(folder, "it is there already, with something else in it")
            .advise("name another folder, or write into it with --force"));
    }
    std::fs::create_dir_all(folder).map_err(|error| Error::io(folder, error))?;
    let text =
        serde_json::to_string_pretty(&this).map_err(|error| Error::format(&note, error.to_string()))?;
    write_whole(&note, text.as_bytes(), Existing::Replace)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_recording_has_its_place_by_its_own_name_alone() {
        let named = |inputs: &[&str]| {
            let inputs: Vec<PathBuf> = inputs.iter().map(PathBuf::from).collect();
            places(Path::new("out"), &inputs).map(|places| {
                places.into_iter().map(|place| place.results.display().to_string()).collect::<Vec<_>>()
            })
        };
        assert_eq!(
            named(&["/data/a/1", "./b/1/", "v.y4m"]).unwrap(),
            ["out/data/a/1.jsonl", "out/b/1.jsonl", "out/v.y4m.jsonl"]
        );
        let message = named(&["a", "../a"]).unwrap_err().to_string();
        assert!(message.contains("its results would be those of a, too"), "{message}");
        assert!(named(&["a", "-"]).is_err());
        assert!(named(&["."]).unwrap()[0].len() > "out/.jsonl".len());
    }
}
