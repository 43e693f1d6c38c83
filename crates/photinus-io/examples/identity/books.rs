//! Books: how many words were found and how many there can be, what those that come with Photinus have, and those in use.

use std::path::Path;

use photinus::identity::design::{Designed, Effort, Requirements, design};
use photinus::identity::{CodeBook, Properties};
use photinus_io::codes::{PRESETS, parse_codes, read_codes};

use crate::document::{Document, markdown};

const LENGTHS: [usize; 6] = [8, 10, 12, 14, 16, 18];
const DISTANCES: [u32; 3] = [3, 4, 5];
const RUNS: [usize; 3] = [2, 3, 4];

/// What a greedy search finds: length, distance, longest run, words.
const GREEDY: [(usize, u32, usize, usize); 10] = [
    (8, 2, 3, 7),
    (10, 3, 3, 6),
    (12, 3, 3, 11),
    (12, 3, 5, 16),
    (14, 3, 3, 25),
    (16, 4, 3, 33),
    (16, 5, 4, 10),
    (18, 3, 2, 36),
    (18, 5, 4, 21),
    (18, 3, 3, 136),
];

/// How many words there can be.
pub(crate) fn most_words() -> Document {
    Document { file: "codes.md", tables: vec![("most", most()), ("greedy", greedy())] }
}

/// What books have.
pub(crate) fn properties() -> Document {
    let mut tables = vec![("presets", presets())];
    if let Some(folder) = std::env::var_os("PHOTINUS_DATA") {
        tables.push(("in use", in_use(&Path::new(&folder).join("blink-codes"))));
    }
    Document { file: "codes.md", tables }
}

fn designed(length: usize, distance: u32, run: usize) -> Option<Designed> {
    eprintln!("{length} bits, distance {distance}, runs up to {run}");
    let requirements = Requirements::new(length, distance).ok()?.with_longest_run(run);
    let found = design(&requirements, Effort::default()).ok()?;
    assert!(requirements.are_met_by(&found.book), "a book is as asked for");
    Some(found)
}

fn cell(designed: Option<Designed>) -> String {
    designed.map_or("0".to_owned(), |found| match found.is_the_most() {
        true => format!("**{}**", found.at_most),
        false => format!("{} of {}", found.book.words().len(), found.at_most),
    })
}

fn most() -> String {
    let heads = DISTANCES.iter().flat_map(|d| RUNS.map(|run| format!("d {d}, runs {run}")));
    let mut rows = vec![std::iter::once("bits".to_owned()).chain(heads).collect::<Vec<_>>()];
    for length in LENGTHS {
        let cells = DISTANCES.iter().flat_map(|&d| RUNS.map(|run| cell(designed(length, d, run))));
        rows.push(std::iter::once(length.to_string()).chain(cells).collect());
    }
    markdown(rows)
}

fn greedy() -> String {
    let mut rows =
        vec![["bits", "distance", "runs", "greedy", "found", "at most"].map(String::from).to_vec()];
    for (length, distance, run, words) in GREEDY {
        let Some(found) = designed(length, distance, run) else { continue };
        assert!(found.book.words().len() >= words, "never fewer than greedy");
        let numbers = [length, distance as usize, run, words, found.book.words().len(), found.at_most];
        rows.push(numbers.map(|number| number.to_string()).to_vec());
    }
    markdown(rows)
}

const HAS: [&str; 9] = [
    "book",
    "words",
    "bits",
    "distance",
    "from own shifts",
    "longest run dark / lit",
    "duty",
    "word known after",
    "phase known after",
];

fn has(name: String, book: &CodeBook) -> Vec<String> {
    let has = Properties::of(book);
    let after = |bits: Option<usize>| bits.map_or("never".to_owned(), |bits| bits.to_string());
    vec![
        name,
        book.words().len().to_string(),
        book.length().to_string(),
        has.distance.map_or(String::new(), |(distance, _)| distance.to_string()),
        has.self_distance.map_or(String::new(), |(distance, _)| distance.to_string()),
        format!("{} / {}", has.longest_dark, has.longest_lit),
        format!("{:.2} to {:.2}", has.duty[0], has.duty[1]),
        after(has.unique_after),
        after(has.in_phase_after),
    ]
}

fn presets() -> String {
    let books = PRESETS.iter().map(|preset| {
        let book = parse_codes(preset.text, preset.name).expect("a book that comes with Photinus");
        has(preset.name.to_owned(), &book)
    });
    markdown(std::iter::once(HAS.map(String::from).to_vec()).chain(books))
}

fn in_use(folder: &Path) -> String {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<_> = entries.map(|entry| entry.path()).collect();
    files.sort();
    let books = files.iter().map(|path| {
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        has(format!("`{name}`"), &read_codes(path).expect("a book that is in use"))
    });
    markdown(std::iter::once(HAS.map(String::from).to_vec()).chain(books))
}
