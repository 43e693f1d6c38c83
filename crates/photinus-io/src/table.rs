//! TOML with errors that say line, key and what is known.

use std::path::Path;

use serde::de::DeserializeOwned;

use crate::content::{Refusal, Tree};
use crate::{Error, Place, Result};

/// Reads TOML into `T`, which lists the keys it knows and refuses others; `path` is for the messages.
///
/// # Errors
/// [`Error`] with the line for what is no TOML, for unknown and missing keys, and for values of another kind.
pub fn parse<T: DeserializeOwned>(text: &str, path: impl AsRef<Path>) -> Result<T> {
    let path = path.as_ref();
    Tree::of_toml(text).and_then(T::deserialize).map_err(|refusal| told(refusal, text, path))
}

fn told(Refusal { why, at }: Refusal, text: &str, path: &Path) -> Error {
    let advice = why.advice().unwrap_or("correct it there; docs/file-formats.md has an example");
    let error = Error::new(path, why).advise(advice);
    match at {
        Some(byte) => error.at(Place::Line(line_of(text, byte))),
        None => error,
    }
}

fn line_of(text: &str, byte: usize) -> usize {
    1 + text.bytes().take(byte).filter(|&b| b == b'\n').count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    #[expect(dead_code, reason = "read by serde only")]
    struct Table {
        width: u32,
        name: Option<String>,
    }

    fn message(text: &str) -> String {
        parse::<Table>(text, Path::new("t.toml")).unwrap_err().to_string()
    }

    #[test]
    fn messages_name_line_key_and_what_to_do() {
        assert_eq!(
            message("width = 1\nwidht = 2\n"),
            "t.toml, line 2: unknown key `widht`, expected `width` or `name`; correct its name or remove it"
        );
        assert_eq!(message("\nname = \"a\"\n"), "t.toml, line 1: missing key `width`; add it");
        assert!(
            message("width = -1")
                .contains("line 1: `-1` where a whole number, 0 or more, is expected; correct")
        );
        assert!(message("width = 1\nwidth = 2").starts_with("t.toml, line 2: duplicate key"));
        assert!(message("width = [[[").starts_with("t.toml, line 1: "));
    }

    #[derive(Debug, PartialEq, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Scene {
        begin: Option<toml::value::Datetime>,
        share: f64,
        #[serde(default)]
        target: Vec<Target>,
    }

    #[derive(Debug, PartialEq, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Target {
        id: u64,
        motion: Motion,
    }

    #[derive(Debug, PartialEq, serde::Deserialize)]
    #[serde(rename_all = "snake_case", deny_unknown_fields)]
    enum Motion {
        Still,
        Hover { place_m: [f64; 3] },
        Fall(f64),
    }

    const SCENE: &str = "begin = 2026-11-23T17:00:00Z\nshare = 1\n\n[[target]]\nid = 0xff\nmotion = \"still\"\n\n\
                         [[target]]\nid = 18446744073709551615\nmotion = { hover = { place_m = [1, -2.5, +3e2] } }\n\n\
                         [[target]]\nid = 1\nmotion.fall = inf\n";

    #[test]
    fn a_table_is_read_as_it_is_meant() {
        let read: Scene = parse(SCENE, "s.toml").unwrap();
        let target = |id, motion| Target { id, motion };
        let targets = vec![
            target(255, Motion::Still),
            target(u64::MAX, Motion::Hover { place_m: [1.0, -2.5, 300.0] }),
            target(1, Motion::Fall(f64::INFINITY)),
        ];
        let begin = Some("2026-11-23T17:00:00Z".parse().unwrap());
        assert_eq!(read, Scene { begin, share: 1.0, target: targets });
    }

    #[test]
    fn what_is_wrong_deep_in_a_table_is_told_where_it_stands() {
        for (from, to, expected) in [
            ("0xff", "-1", "line 5: `-1` where a whole number, 0 or more, is expected"),
            ("id = 0xff\n", "", "line 4: missing key `id`"),
            (
                "0xff",
                "2026-11-23",
                "line 5: the time `2026-11-23` where a whole number, 0 or more, is expected",
            ),
            (
                "\"still\"",
                "\"stil\"",
                "line 6: unknown name `stil`, expected one of `still`, `hover`, `fall`",
            ),
            ("place_m", "place", "line 10: unknown key `place`, expected `place_m`"),
            ("[1, -2.5, +3e2]", "[1, -2.5]", "line 10: a list of 2 where a list of 3 is expected"),
            ("-2.5", "false", "line 10: `false` where a number is expected"),
            ("+3e2", "1e400", "line 10: `1e400` is larger than any number that is read"),
            (
                "18446744073709551615",
                "18446744073709551616",
                "line 9: `18446744073709551616` where a whole number, 0 or more, is expected",
            ),
            (
                "motion.fall = inf",
                "motion.fall = 1\nmotion.rise = 2",
                "line 14: a table of 2 keys where one name with its values is expected",
            ),
            ("2026-11-23T17:00:00Z", "\"now\"", "line 1: "),
        ] {
            let text = SCENE.replacen(from, to, 1);
            assert_ne!(text, SCENE, "{from}");
            let told = parse::<Scene>(&text, "s.toml").unwrap_err().to_string();
            assert!(told.starts_with(&format!("s.toml, {expected}")), "{to}: {told}");
        }
    }

    #[test]
    fn tables_without_bottom_are_refused() {
        let lists = format!("share = {}{}", "[".repeat(100_000), "]".repeat(100_000));
        let keys = format!("{} = 1", vec!["a"; 100_000].join("."));
        for text in [lists, keys] {
            let told = parse::<Scene>(&text, "s.toml").unwrap_err().to_string();
            assert!(told.contains("recur"), "{told}");
        }
    }
}
