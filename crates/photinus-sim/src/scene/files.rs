//! Which files a scene is read from: enters the path of the scene, leaves it and every file that it names, and that those name.

use std::path::{Path, PathBuf};

use photinus_io::{Error, Result};
use toml::Value;

/// The scene file and the files that it is read from. Any text of it that is the path of a file counts.
///
/// # Errors
/// [`Error`] when the scene cannot be read.
pub fn files_of(scene: impl AsRef<Path>) -> Result<Vec<PathBuf>> {
    let scene = scene.as_ref();
    let text = std::fs::read_to_string(scene).map_err(|error| Error::io(scene, error))?;
    let mut files = vec![scene.to_owned()];
    name(&text, scene, &mut files);
    Ok(files)
}

/// Adds what the text of a file names; what is no TOML names nothing.
fn name(text: &str, path: &Path, files: &mut Vec<PathBuf>) {
    let Ok(table) = text.parse::<toml::Table>() else { return };
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut left: Vec<Value> = table.into_iter().map(|(_, value)| value).collect();
    while let Some(value) = left.pop() {
        match value {
            Value::Table(table) => left.extend(table.into_iter().map(|(_, value)| value)),
            Value::Array(values) => left.extend(values),
            Value::String(named) => {
                let named = folder.join(named);
                if named.is_file() && !files.contains(&named) {
                    files.push(named.clone());
                    let text = std::fs::read_to_string(&named).unwrap_or_default();
                    name(&text, &named, files);
                }
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_of_a_scene_is_named() {
        let scenes = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes"));
        let files = files_of(scenes.join("crossing.toml")).unwrap();
        let named = [
            "crossing.toml",
            "cameras/bluefox-dsl215.toml",
            "airframes/hexarotor-0.4.toml",
            "codes/two-words.txt",
        ];
        for name in named {
            assert!(files.contains(&scenes.join(name)), "{name} of {files:?}");
        }
        assert_eq!(files.len(), named.len(), "once each");
        assert!(files_of(scenes.join("none.toml")).is_err());
    }
}
