//! A port, and a thread for each that connects: requests are answered, WebSockets are sent what the audience is told.

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use photinus_io::{Error, Result};
use photinus_run::config::PageAddress;
use tungstenite::protocol::{Role, WebSocketConfig};
use tungstenite::{Error as SocketError, Message, WebSocket};

use crate::audience::{Audience, Seat};
use crate::request::{self, Answer};

const PAGE: &str = include_str!("page.html");
/// Connections at a time, those that only ask included.
const MOST_CONNECTIONS: usize = 32;
/// How long a head may take to arrive.
const HEAD_PATIENCE: Duration = Duration::from_secs(3);
/// How long one who looks may take no bytes.
const WRITE_PATIENCE: Duration = Duration::from_secs(3);
/// What one who looks may say: control frames only.
pub(crate) const LONGEST_MESSAGE: usize = 256;
/// How often the port looks whether it is to close.
const LOOK: Duration = Duration::from_millis(20);
/// Nothing but what is in the page, and nobody may frame it.
const HEADERS: &str = "Content-Type: text/html; charset=utf-8\r\nCache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n\
    Content-Security-Policy: default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src blob: data:; connect-src 'self'; frame-ancestors 'none'\r\n\
    Connection: close\r\n";

/// The port.
pub(crate) struct Server {
    address: SocketAddr,
    closed: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// What every connection knows.
struct House {
    audience: Arc<Audience>,
    token: Option<String>,
    is_local: bool,
    closed: Arc<AtomicBool>,
    connections: AtomicUsize,
}

impl Server {
    pub(crate) fn open(page: &PageAddress, audience: Arc<Audience>) -> Result<Self> {
        let refuse = |error: std::io::Error| {
            let advice = match error.kind() {
                ErrorKind::AddrInUse => "end the program that listens there, or choose another port",
                _ => "choose an address of this machine",
            };
            Error::new(page.listen.to_string(), error).advise(advice)
        };
        let listener = TcpListener::bind(page.listen).map_err(refuse)?;
        listener.set_nonblocking(true).map_err(refuse)?;
        let address = listener.local_addr().map_err(refuse)?;
        let closed = Arc::new(AtomicBool::new(false));
        let house = Arc::new(House {
            audience,
            token: page.token.clone(),
            is_local: page.listen.ip().is_loopback(),
            closed: closed.clone(),
            connections: AtomicUsize::new(0),
        });
        let work = move || serve(&listener, &house);
        let thread = thread::Builder::new().name("page".to_owned()).spawn(work).map_err(refuse)?;
        Ok(Self { address, closed, thread: Some(thread) })
    }

    pub(crate) fn address(&self) -> SocketAddr {
        self.address
    }

    /// Nobody comes in any more; who is there is told to leave.
    pub(crate) fn close(&mut self) {
        self.closed.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.close();
    }
}

fn serve(listener: &TcpListener, house: &Arc<House>) {
    while !house.closed.load(Ordering::Relaxed) {
        let Ok((stream, _)) = listener.accept() else {
            thread::sleep(LOOK);
            continue;
        };
        if house.connections.fetch_add(1, Ordering::Relaxed) >= MOST_CONNECTIONS {
            house.connections.fetch_sub(1, Ordering::Relaxed);
            continue;
        }
        let own = house.clone();
        let work = move || {
            // Who breaks off has left.
            let _ = attend(stream, &own);
            own.connections.fetch_sub(1, Ordering::Relaxed);
        };
        if thread::Builder::new().name("page".to_owned()).spawn(work).is_err() {
            house.connections.fetch_sub(1, Ordering::Relaxed);
        }
    }
}

fn attend(mut stream: TcpStream, house: &House) -> std::io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(WRITE_PATIENCE))?;
    let key = match asked(&mut stream, house)? {
        Answer::Page => {
            let length = PAGE.len();
            write!(stream, "HTTP/1.1 200 OK\r\n{HEADERS}Content-Length: {length}\r\n\r\n{PAGE}")?;
            return Ok(());
        }
        Answer::Live(key) => key,
        Answer::Refused(status) => return refuse(&mut stream, status),
        Answer::More => return Ok(()),
    };
    let Some(seat) = house.audience.join() else {
        return refuse(&mut stream, "503 Service Unavailable");
    };
    write!(
        stream,
        "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: {key}\r\n\r\n"
    )?;
    // Reading is only to notice who leaves.
    stream.set_read_timeout(Some(Duration::from_millis(1)))?;
    show(socket(stream), &seat, house);
    Ok(())
}

/// Our end of a WebSocket whose handshake is done; what they send may not be long.
pub(crate) fn socket<S>(stream: S) -> WebSocket<S> {
    let config = WebSocketConfig::default()
        .read_buffer_size(4096)
        .max_message_size(Some(LONGEST_MESSAGE))
        .max_frame_size(Some(LONGEST_MESSAGE));
    WebSocket::from_raw_socket(stream, Role::Server, Some(config))
}

fn refuse(stream: &mut TcpStream, status: &str) -> std::io::Result<()> {
    write!(stream, "HTTP/1.1 {status}\r\n{HEADERS}Content-Length: {}\r\n\r\n{status}", status.len())
}

/// Reads the head of a request, byte for byte no more than it may have.
fn asked(stream: &mut TcpStream, house: &House) -> std::io::Result<Answer> {
    let until = Instant::now() + HEAD_PATIENCE;
    let (mut head, mut part) = (Vec::new(), [0; 1024]);
    loop {
        let left = until.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Ok(Answer::Refused("408 Request Timeout"));
        }
        stream.set_read_timeout(Some(left))?;
        let room = (request::LONGEST - head.len()).min(part.len());
        match stream.read(&mut part[..room]) {
            Ok(0) => return Ok(Answer::More),
            Ok(read) => head.extend_from_slice(&part[..read]),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
        match request::answer(&head, house.token.as_deref(), house.is_local) {
            Answer::More if head.len() < request::LONGEST => {}
            answer => return Ok(answer),
        }
    }
}

/// Sends what comes until they leave or the run ends.
fn show(mut socket: WebSocket<TcpStream>, seat: &Seat, house: &House) {
    while !house.closed.load(Ordering::Relaxed) {
        if let Some(message) = seat.take(Duration::from_millis(50))
            && socket.send(Message::binary(message.to_vec())).is_err()
        {
            return;
        }
        match socket.read() {
            // What they say is not listened to.
            Ok(_) => {}
            Err(SocketError::Io(error))
                if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
            Err(_) => return,
        }
    }
    let _ = socket.close(None);
    let _ = socket.flush();
}
