//! A page that shows what Photinus sees while it runs. It only looks: nothing that a browser sends changes anything.
//!
//! ```text
//! sketch    a located frame -> what the page draws of it, and a small picture    -> bytes
//! audience  whoever looks, each with a bounded queue of bytes
//! server    a port, a thread for each that connects; request: what they ask for
//! page.html everything that a browser needs
//! ```

mod audience;
#[cfg(test)]
mod malformed;
mod request;
mod server;
mod sketch;

use std::collections::{HashMap, VecDeque};
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::{Duration, Instant};

use photinus_io::Result;
use photinus_run::Entry;
use photinus_run::config::PageAddress;
use photinus_run::health::{Health, Notice};
use photinus_run::sink::Sink;
use serde::Serialize;

use audience::Audience;
use server::Server;

/// Pictures of a camera come no faster: a person sees no more, and a radio link carries no more.
const EVERY: Duration = Duration::from_millis(100);
/// Notices that somebody who comes later is told.
const KEPT: usize = 20;

/// The page, as a sink of a run.
pub struct Page {
    audience: Arc<Audience>,
    server: Server,
    last: HashMap<usize, Instant>,
    notices: VecDeque<Arc<Notice>>,
}

#[derive(Serialize)]
#[serde(rename_all = "lowercase")]
enum Told<'a> {
    Health(&'a Health),
    Notice(&'a Notice),
}

impl Page {
    /// Serves the page at this address.
    ///
    /// # Errors
    /// [`photinus_io::Error`] when the address is taken, or none of this machine.
    pub fn open(address: &PageAddress) -> Result<Self> {
        let audience = Arc::new(Audience::default());
        let server = Server::open(address, audience.clone())?;
        Ok(Self { audience, server, last: HashMap::new(), notices: VecDeque::new() })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.server.address()
    }
}

impl Sink for Page {
    fn name(&self) -> String {
        "page".to_owned()
    }

    fn frame(&mut self, entry: &Entry) -> Result<()> {
        if self.audience.is_empty() {
            return Ok(());
        }
        let now = Instant::now();
        let is_due = self.last.get(&entry.camera).is_none_or(|last| now - *last >= EVERY);
        if is_due {
            self.last.insert(entry.camera, now);
            self.audience.tell(sketch::message(entry));
        }
        Ok(())
    }

    fn health(&mut self, health: &Health) -> Result<()> {
        self.audience.tell(told(&Told::Health(health)));
        Ok(())
    }

    fn notice(&mut self, notice: &Notice) -> Result<()> {
        self.audience.tell(told(&Told::Notice(notice)));
        self.notices.push_back(Arc::new(notice.clone()));
        if self.notices.len() > KEPT {
            self.notices.pop_front();
        }
        self.audience.keep(self.notices.iter().map(|notice| told(&Told::Notice(notice))).collect());
        Ok(())
    }

    fn finish(&mut self) -> Result<()> {
        self.server.close();
        Ok(())
    }
}

/// A message without a picture.
fn told(what: &Told<'_>) -> Vec<u8> {
    sketch::packed(&serde_json::to_vec(what).unwrap_or_default(), &[])
}
