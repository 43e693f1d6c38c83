//! The command line: enters what stands there, leaves the command; or what is wrong, in words that say what to give.

use std::num::{ParseFloatError, ParseIntError};

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, Parser};

/// Reads the command line, or ends the program with what is wrong in it, or with the help that was asked for.
pub(crate) fn read<P: Parser>() -> P {
    P::try_parse().unwrap_or_else(|error| in_plain_words::<P>(error).exit())
}

/// What a parser of numbers complains of becomes what number is expected.
fn in_plain_words<P: CommandFactory>(error: clap::Error) -> clap::Error {
    let wanted = match std::error::Error::source(&error) {
        Some(source) if source.is::<ParseIntError>() => "give a whole number, without a point or a unit",
        Some(source) if source.is::<ParseFloatError>() => "give a number, without a unit",
        _ => return error,
    };
    let told = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => text.clone(),
        _ => String::new(),
    };
    let (value, argument) = (told(ContextKind::InvalidValue), told(ContextKind::InvalidArg));
    P::command()
        .error(ErrorKind::ValueValidation, format!("invalid value '{value}' for '{argument}': {wanted}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Parser)]
    struct Numbers {
        #[arg(long, value_parser = clap::value_parser!(u8).range(1..))]
        level: Option<u8>,
        #[arg(long)]
        metres: Option<f64>,
    }

    #[test]
    fn numbers_that_are_none_are_told_with_what_to_give() {
        for (words, expected) in [
            (
                ["x", "--level", "0.1"],
                "invalid value '0.1' for '--level <LEVEL>': give a whole number, without a point",
            ),
            (["x", "--level", "a"], "give a whole number"),
            (["x", "--level", "0"], "0 is not in 1..=255"),
            (
                ["x", "--metres", "3m"],
                "invalid value '3m' for '--metres <METRES>': give a number, without a unit",
            ),
        ] {
            let told = in_plain_words::<Numbers>(Numbers::try_parse_from(words).unwrap_err()).to_string();
            assert!(told.contains(expected), "{told}");
        }
    }
}
