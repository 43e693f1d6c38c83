//! Whoever connects to a socket and reads along: each has room of its own, and who does not read is sent away.

use std::fmt;
use std::io::{ErrorKind, Write};
use std::net::{SocketAddr, TcpListener};
#[cfg(unix)]
use std::os::unix::net::UnixListener;
use std::path::PathBuf;

use photinus_io::{Error, Result};

/// This many may read along.
const MOST: usize = 16;
/// What may wait for one of them, bytes: some seconds of results.
const MOST_WAITING: usize = 1 << 20;

/// Where a socket listens.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Address {
    /// TCP. Who can reach the address can read along.
    Tcp(SocketAddr),
    /// A unix socket, made at this path.
    Unix(PathBuf),
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tcp(address) => write!(f, "{address}"),
            Self::Unix(path) => write!(f, "{}", path.display()),
        }
    }
}

/// Whoever reads along.
pub struct Bystanders {
    listener: Listener,
    all: Vec<Bystander>,
}

enum Listener {
    Tcp(TcpListener),
    #[cfg(unix)]
    Unix(UnixListener, PathBuf),
}

struct Bystander {
    pipe: Box<dyn Write + Send>,
    waiting: Vec<u8>,
}

impl Bystanders {
    /// Listens.
    ///
    /// # Errors
    /// [`Error`] when the address is taken, or none of this machine.
    pub fn listen(address: &Address) -> Result<Self> {
        let refuse = |error: std::io::Error| {
            let advice = match error.kind() {
                ErrorKind::AddrInUse => "end the program that listens there, or choose another",
                _ => "choose another address",
            };
            Error::new(address.to_string(), error).advise(advice)
        };
        let listener = match address {
            Address::Tcp(address) => {
                let listener = TcpListener::bind(address).map_err(refuse)?;
                listener.set_nonblocking(true).map_err(refuse)?;
                Listener::Tcp(listener)
            }
            Address::Unix(path) => unix(path, refuse)?,
        };
        Ok(Self { listener, all: Vec::new() })
    }

    /// Where it listens, of TCP.
    pub fn port(&self) -> Option<u16> {
        match &self.listener {
            Listener::Tcp(listener) => listener.local_addr().ok().map(|address| address.port()),
            #[cfg(unix)]
            Listener::Unix(..) => None,
        }
    }

    /// Sends a whole line to everybody, as far as they read; nobody is waited for.
    pub fn send(&mut self, line: &[u8]) {
        while let Some(pipe) = self.listener.accept() {
            if self.all.len() < MOST {
                self.all.push(Bystander { pipe, waiting: Vec::new() });
            }
        }
        self.all.retain_mut(|bystander| bystander.send(line));
    }
}

impl Listener {
    fn accept(&self) -> Option<Box<dyn Write + Send>> {
        match self {
            Self::Tcp(listener) => {
                let (stream, _) = listener.accept().ok()?;
                stream.set_nonblocking(true).ok()?;
                stream.set_nodelay(true).ok()?;
                Some(Box::new(stream))
            }
            #[cfg(unix)]
            Self::Unix(listener, _) => {
                let (stream, _) = listener.accept().ok()?;
                stream.set_nonblocking(true).ok()?;
                Some(Box::new(stream))
            }
        }
    }
}

impl Bystander {
    /// Whether it still reads.
    fn send(&mut self, line: &[u8]) -> bool {
        self.waiting.extend_from_slice(line);
        while !self.waiting.is_empty() {
            match self.pipe.write(&self.waiting) {
                Ok(0) => return false,
                Ok(written) => drop(self.waiting.drain(..written)),
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) => return false,
            }
        }
        self.waiting.len() <= MOST_WAITING
    }
}

#[cfg(unix)]
fn unix(path: &std::path::Path, refuse: impl Fn(std::io::Error) -> Error) -> Result<Listener> {
    // One that a killed run left behind is in the way; one that somebody listens at is not taken from them.
    if std::os::unix::net::UnixStream::connect(path).is_err() && is_socket(path) {
        std::fs::remove_file(path).map_err(&refuse)?;
    }
    let listener = UnixListener::bind(path).map_err(&refuse)?;
    listener.set_nonblocking(true).map_err(&refuse)?;
    Ok(Listener::Unix(listener, path.to_owned()))
}

#[cfg(unix)]
fn is_socket(path: &std::path::Path) -> bool {
    use std::os::unix::fs::FileTypeExt;
    std::fs::symlink_metadata(path).is_ok_and(|found| found.file_type().is_socket())
}

#[cfg(not(unix))]
fn unix(path: &std::path::Path, _refuse: impl Fn(std::io::Error) -> Error) -> Result<Listener> {
    Err(Error::format(path, "this system has no unix sockets").advise("use tcp"))
}

#[cfg(unix)]
impl Drop for Listener {
    fn drop(&mut self) {
        if let Self::Unix(_, path) = self {
            let _ = std::fs::remove_file(path);
        }
    }
}
