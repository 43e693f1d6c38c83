//! TODO
#[derive(Debug, clap::Args)]
pub(crate) struct Args {}
pub(crate) fn run(_args: &Args, _terminal: &crate::terminal::Terminal) -> Result<(), crate::failure::Failure> { Ok(()) }
