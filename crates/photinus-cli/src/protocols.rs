//! Sinks that are linked elsewhere: enters a table of the configuration, leaves what takes results there. Each protocol is a feature of this program.

use photinus_io::Error;
use photinus_run::config::Config;
use photinus_run::motion::Motion;
use photinus_run::sink::Sink;

use crate::failure::Failure;

/// The page, if one is asked for, and its address.
pub(crate) fn page(config: &Config) -> Result<Option<(Box<dyn Sink>, String)>, Failure> {
    let Some(address) = config.page() else { return Ok(None) };
    #[cfg(feature = "page")]
    {
        let page = photinus_page::Page::open(&address).map_err(Failure::input)?;
        let token = address.token.map_or(String::new(), |token| format!("?token={token}"));
        let told = format!("http://{}/{token}", page.address());
        Ok(Some((Box::new(page), told)))
    }
    #[cfg(not(feature = "page"))]
    {
        let _ = address;
        Err(missing(config, "page"))
    }
}

/// The sinks of a table such as `[mavlink]`; what arrives of the vehicle's own motion goes to `motion`.
pub(crate) fn sinks(config: &Config, table: &str, _motion: &Motion) -> Result<Vec<Box<dyn Sink>>, Failure> {
    // Each protocol that is linked has a line here, behind its feature.
    Err(missing(config, table))
}

fn missing(config: &Config, table: &str) -> Failure {
    let reason = format!("[{table}] is not in this program");
    let advice = format!("remove the table, or build with --features {table}");
    Failure::input(Error::format(config.path(), reason).advise(advice))
}
