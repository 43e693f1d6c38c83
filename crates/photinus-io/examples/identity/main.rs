//! What identity holds: code books against bounds, and decoding against the ideal decoder of the same evidence.
//!
//! ```text
//! cargo run --release -p photinus-io --example identity -- most|books|decoding [--update]
//! ```
//!
//! Prints tables; with `--update` they take the place of those in docs/codes.md or docs/identity.md, which explain them. Books that are
//! in use are read from the folder `blink-codes` in that which PHOTINUS_DATA names; without, their table is left as it is.

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "an example prints its table")]

mod books;
mod changes;
mod clocks;
mod decoding;
mod document;
mod ideal;
mod led;
mod reliability;
mod right;

use std::process::ExitCode;

fn main() -> ExitCode {
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    let update = words.iter().any(|word| word == "--update");
    words.retain(|word| word != "--update");
    let document = match words.first().map(String::as_str) {
        Some("most") => books::most_words(),
        Some("books") => books::properties(),
        Some("decoding") => decoding::document(),
        _ => {
            eprintln!("say most, books or decoding, and --update to write the document");
            return ExitCode::from(2);
        }
    };
    let written = if update { document.update() } else { Ok(()) };
    if let Err(reason) = written {
        eprintln!("error: {reason}");
        return ExitCode::FAILURE;
    }
    println!("{document}");
    ExitCode::SUCCESS
}
