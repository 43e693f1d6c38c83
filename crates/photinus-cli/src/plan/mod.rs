//! `photinus plan`: a set-up that nobody has built yet -> how far and how exactly it will see.
//!
//! ```text
//! told      the plan in words and tables, to read
//! figures   found, errors and aspects over distance, drawn
//! page      both on a page, with the figures beside it
//! ```

mod figures;
mod page;
mod told;

use std::path::PathBuf;

use photinus_plan::{EXAMPLE, PARTS, Plan, Setup};

use crate::failure::Failure;
use crate::targets::{Targets, WriteArgs};
use crate::terminal::Terminal;

const EXAMPLES: &str = "\
Examples:
  # a set-up to begin with, every key explained: the founding paper's
  photinus plan --example > set-up.toml
  # LEDs, filters, lenses and sensors that a set-up may name
  photinus plan --parts
  photinus plan set-up.toml
  # with pictures: plan/index.html
  photinus plan set-up.toml --out plan
  photinus plan set-up.toml --json > plan.json

Errors are the least that the light and the pixels allow; docs/planning.md shows
how near to them rendered and located frames come, and what is left out. Limits
for eyes are those of IEC 62471 and ICNIRP: they are no safety assessment.";

/// Tell how far and how exactly LEDs, lens, sensor and airframe will see, before they are built
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// A set-up, as --example writes it
    #[arg(value_name = "SETUP.toml", required_unless_present_any = ["example", "parts"])]
    setup: Option<PathBuf>,
    /// Print a set-up with every key explained
    #[arg(long, conflicts_with_all = ["setup", "parts", "json", "out"])]
    example: bool,
    /// Print the parts that are known, with where their numbers come from
    #[arg(long, conflicts_with_all = ["setup", "json", "out"])]
    parts: bool,
    /// Print the plan as JSON
    #[arg(long)]
    json: bool,
    /// Where to write a page with pictures: a new folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print results and errors only
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    write: WriteArgs,
}

impl Args {
    /// Whether only errors and results are to be printed.
    pub(crate) fn quiet(&self) -> bool {
        self.quiet
    }
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &Terminal) -> Result<(), Failure> {
    let path = match &args.setup {
        Some(path) => path,
        None if args.example => return terminal.result(EXAMPLE.trim_end()),
        None => return terminal.result(PARTS.trim_end()),
    };
    let setup = Setup::read(path).map_err(Failure::input)?;
    let mut targets = Targets::new(args.write, [path.clone()]);
    let target = args.out.as_deref().map(|out| targets.folder(out)).transpose()?;
    let plan = Plan::new(&setup);
    if let Some(target) = target {
        let making = target.whole().map_err(Failure::input)?;
        page::write(making.path(), &plan).map_err(|error| Failure::running(making.tell(error)))?;
        making.keep().map_err(Failure::running)?;
        terminal.summary(format_args!("Open {}/index.html in a browser.", target.path().display()));
    }
    match args.json {
        true => {
            let json = serde_json::to_string_pretty(&plan);
            terminal.result(json.map_err(|error| Failure::Running(error.to_string()))?)
        }
        false => terminal.result(told::whole(&plan)),
    }
}
