//! `photinus codes design`: what words must have -> a book with as many as can be found.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use photinus::identity::design::{Designed, Effort, Requirements, Unmet, design};
use photinus_io::codes::codes_text;

use super::duty;
use crate::ending::Content;
use crate::failure::Failure;
use crate::number;
use crate::targets::{Targets, WriteArgs};
use crate::terminal::Terminal;

const EXAMPLES: &str = "\
Examples:
  photinus codes design --length 12 --distance 3 --longest-run 3 --out book.txt
  photinus codes design --length 18 --distance 5 --longest-run 4 \\
      --duty 0.4..0.6 --effort 10 --out book.txt

Long runs of dark bits make a marker harder to follow, long words take longer to
read; a distance of 3 corrects one wrong bit in a round, 5 two. A camera meets
words at any bit: every distance holds at any shift. How many words there can be
at most is said with the book. The same options give the same book everywhere.";

/// Search for a book with as many words as can be found
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Bits of a word
    #[arg(long, value_name = "BITS")]
    length: usize,
    /// The fewest bits in which two words differ, at any shift
    #[arg(long, value_name = "BITS")]
    distance: u32,
    /// The most equal bits that follow each other
    #[arg(long, value_name = "BITS")]
    longest_run: Option<usize>,
    /// The fewest bits in which a word differs from its own shifts
    #[arg(long, value_name = "BITS", default_value_t = 2)]
    self_distance: u32,
    /// The share of bits that are on, such as 0.4..0.6
    #[arg(long, value_name = "FROM..TO", value_parser = duty)]
    duty: Option<RangeInclusive<f64>>,
    /// How many times longer to search than usual
    #[arg(long, value_name = "TIMES", default_value_t = 1, value_parser = times)]
    effort: u32,
    /// Seed of the search
    #[arg(long, value_name = "NUMBER", default_value_t = Effort::default().seed)]
    seed: u64,
    /// Where to write the book; standard output without
    #[arg(long, value_name = "FILE", default_value = "-")]
    out: PathBuf,
    /// Print errors and results only
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    write: WriteArgs,
}

fn times(text: &str) -> Result<u32, String> {
    number::whole(text, 1..=100_000, "times")
}

impl Args {
    pub(super) fn quiet(&self) -> bool {
        self.quiet
    }

    fn requirements(&self) -> Result<Requirements, Unmet> {
        let mut requirements =
            Requirements::new(self.length, self.distance)?.with_self_distance(self.self_distance);
        if let Some(longest) = self.longest_run {
            requirements = requirements.with_longest_run(longest);
        }
        if let Some(duty) = &self.duty {
            requirements = requirements.with_duty(duty.clone());
        }
        Ok(requirements)
    }

    /// The command that makes this book again.
    fn command(&self) -> String {
        let mut command =
            format!("photinus codes design --length {} --distance {}", self.length, self.distance);
        if let Some(longest) = self.longest_run {
            command += &format!(" --longest-run {longest}");
        }
        command += &format!(" --self-distance {}", self.self_distance);
        if let Some(duty) = &self.duty {
            command += &format!(" --duty {}..{}", duty.start(), duty.end());
        }
        command + &format!(" --effort {} --seed {}", self.effort, self.seed)
    }

    fn claim(&self, designed: &Designed) -> String {
        let runs = self.longest_run.map_or(String::new(), |longest| format!(", runs of up to {longest}"));
        format!(
            "{} words of {} bits, {} apart at any shift, {} from their own shifts{runs}; {}",
            designed.book.words().len(),
            self.length,
            self.distance,
            self.self_distance,
            if designed.is_the_most() {
                "no book has more".to_owned()
            } else {
                format!("no book has more than {}", designed.at_most)
            }
        )
    }
}

/// Runs the command.
pub(super) fn run(args: &Args, terminal: &Terminal) -> Result<(), Failure> {
    let target = Targets::new(args.write, []).file(&args.out, Content::Codes)?;
    let times = u64::from(args.effort);
    let mut effort = Effort::default();
    effort.seed = args.seed;
    effort.work *= times;
    effort.branches *= times;
    let designed =
        args.requirements().and_then(|asked| design(&asked, effort)).map_err(|unmet| told(&unmet))?;
    let claim = args.claim(&designed);
    let text = format!("# {claim}\n# {}\n{}", args.command(), codes_text(&designed.book));
    match target.is_standard() {
        true => terminal.result(text.trim_end())?,
        false => target.write(text.as_bytes()).map_err(Failure::running)?,
    }
    terminal.summary(format_args!("{}: {claim}", target.name().display()));
    Ok(())
}

fn told(unmet: &Unmet) -> Failure {
    let advice = match unmet {
        Unmet::Length(_) => "give another --length",
        Unmet::NoWord => "allow longer runs, another duty or a smaller --self-distance",
        Unmet::TooMany(_) => "give a smaller --longest-run, a narrower --duty, or a smaller --length",
    };
    Failure::Input(format!("{unmet}; {advice}"))
}
