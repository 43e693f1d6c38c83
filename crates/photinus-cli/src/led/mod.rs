//! `photinus led`: a book of words and who a vehicle is -> its LED board blinks; and whether it truly does, as a camera sees it.
//!
//! ```text
//! lights    spots, frame by frame -> lights that stay where they are, when each was lit
//! reading   when a light was lit  -> which word it blinks, and where in it the board was
//! placing   where lights are, how the vehicle is built -> which LEDs are dark, which blink the signal of another
//! verify    all of these -> what is in order and what is not
//! ```

mod lights;
mod placing;
mod reading;
mod verify;

use std::path::PathBuf;

use photinus_io::codes::read_codes;
use photinus_link::led::{Board, Command, Dialogue, Outcome, drive, open, start};

use crate::failure::Failure;
use crate::terminal::Terminal;
use crate::{interrupt, number};

const EXAMPLES: &str = "\
Examples:
  # vehicle 3 blinks words 12 to 15, one on each arm
  photinus led /dev/ttyUSB0 --book book.txt --vehicle 3
  # one word on all LEDs
  photinus led /dev/ttyUSB0 --book book.txt --vehicle 3 --signals 1
  photinus led /dev/ttyUSB0 --off
  # whether it does: a second or two of it, vehicle and camera at rest
  photinus led --book book.txt --vehicle 3 --verify recording

Boards of UVDAR answer nothing; one that sends commands back has acknowledged
them. Words are written into the board's memory: --pause says how long it needs.

Exit codes: 0 done, in order, 1 the board refused or LEDs are not in order, 2 bad
usage or input, 130 interrupted.";

/// Make the LEDs of a vehicle blink its words, and see by a camera whether they do
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Serial port of the LED board, such as /dev/ttyUSB0
    #[arg(value_name = "PORT", required_unless_present = "verify")]
    port: Option<PathBuf>,
    /// Words that may be blinked
    #[arg(long, value_name = "FILE", required_unless_present = "off")]
    book: Option<PathBuf>,
    /// Who it is: its first word is N times the number of signals
    #[arg(long, value_name = "N", required_unless_present = "off", value_parser = vehicle)]
    vehicle: Option<usize>,
    /// Signals of the airframe: words from its first one on
    #[arg(long, value_name = "COUNT", default_value_t = 4, value_parser = signals)]
    signals: usize,
    /// Bits a second, as many as the cameras take frames
    #[arg(long, value_name = "HZ", default_value_t = 60, value_parser = rate)]
    rate: u16,
    /// The board is of the first kind: one word for all LEDs
    #[arg(long)]
    classic: bool,
    /// Write all words of the book to the board, not only those that it blinks
    #[arg(long)]
    whole_book: bool,
    /// What the board needs after a command; words take longer
    #[arg(long, value_name = "SECONDS", default_value_t = 0.25, value_parser = pause)]
    pause: f64,
    /// Switch the LEDs off
    #[arg(long, conflicts_with_all = ["book", "vehicle", "verify", "whole_book"])]
    off: bool,
    #[command(flatten)]
    verify: verify::VerifyArgs,
    /// Print errors and results only
    #[arg(short, long)]
    quiet: bool,
}

impl Args {
    /// Whether only errors and results are to be printed.
    pub(crate) fn quiet(&self) -> bool {
        self.quiet
    }

    /// The words of the vehicle's signals.
    fn words(&self) -> Vec<usize> {
        let first = self.vehicle.unwrap_or_default() * self.signals;
        (first..first + self.signals).collect()
    }

    fn commands(&self, board: Board) -> Result<Vec<Command>, Failure> {
        let Some(book) = self.book.as_ref().filter(|_| !self.off) else {
            return Ok(vec![Command::Active(false)]);
        };
        let words = read_codes(book).map_err(Failure::input)?;
        start(&words, &self.words(), self.rate, board, self.whole_book)
            .map_err(|reason| Failure::Input(format!("{}: {reason}", book.display())))
    }
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &mut Terminal) -> Result<(), Failure> {
    if let Some(path) = &args.port {
        let board = if args.classic { Board::Classic } else { Board::Four };
        let dialogue = Dialogue::new(&args.commands(board)?, board, args.pause);
        let port = open(path).map_err(Failure::input)?;
        terminal.note(format_args!("{}: {:.1} s at most", path.display(), dialogue.longest_s()));
        let outcome = drive(&port, path, dialogue, &interrupt::is_asked).map_err(Failure::running)?;
        let name = path.display();
        match outcome {
            None => return Err(Failure::Interrupted(format!("{name}: the board was told a part"))),
            Some(Outcome::Acknowledged) => {
                terminal.result(format_args!("{name}: the board acknowledged all of it"))?;
            }
            Some(Outcome::Unanswered) => terminal.result(format_args!(
                "{name}: all was said, the board answers nothing; --verify sees what the LEDs do"
            ))?,
            Some(Outcome::Refused(command)) => {
                return Err(Failure::Running(format!(
                    "{name}: the board did not take command {command}; check the line and --classic"
                )));
            }
        }
    }
    match &args.book {
        Some(book) if args.verify.is_wanted() => {
            let book = read_codes(book).map_err(Failure::input)?;
            verify::run(&args.verify, &book, &args.words(), f64::from(args.rate), terminal)
        }
        _ => Ok(()),
    }
}

fn vehicle(text: &str) -> Result<usize, String> {
    number::whole(text, 0..=255, "a vehicle")
}

fn signals(text: &str) -> Result<usize, String> {
    number::whole(text, 1..=64, "signals")
}

fn rate(text: &str) -> Result<u16, String> {
    number::whole(text, 1..=65_535, "bits a second")
}

fn pause(text: &str) -> Result<f64, String> {
    number::within(text, 0.0..=60.0, "seconds")
}
