//! The page from outside: what a browser gets, and what somebody with bad intentions does not.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::PoisonError;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use photinus_io::frames::{Frame, Moved};
use photinus_io::image::GreyImage;
use photinus_page::Page;
use photinus_run::Entry;
use photinus_run::config::PageAddress;
use photinus_run::health::{Health, Level, Notice};
use photinus_run::sink::Sink;
use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;
use tungstenite::Message;

fn page() -> Page {
    Page::open(&PageAddress { listen: "127.0.0.1:0".parse().unwrap(), token: None }).unwrap()
}

fn frame(index: u64) -> Entry {
    let image = GreyImage::new(vec![9; 752 * 480], 752, 480).unwrap();
    Entry::from_frame(Frame {
        image,
        index,
        time_s: Some(0.01),
        source: "t".to_owned(),
        gravity: None,
        exposure_s: None,
        moved: Moved::default(),
        conversions: Vec::new(),
    })
}

fn get(address: SocketAddr) -> String {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.write_all(format!("GET / HTTP/1.1\r\nHost: {address}\r\n\r\n").as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    answer
}

/// What stands before the picture in a message.
fn json(message: &[u8]) -> serde_json::Value {
    let length = u32::from_le_bytes(message[..4].try_into().unwrap()) as usize;
    serde_json::from_slice(&message[4..4 + length]).unwrap()
}

#[test]
fn a_browser_gets_the_page_and_then_frames_health_and_earlier_notices() {
    let _others = crate::MEMORY.read();
    let mut page = page();
    let address = page.address();
    let answer = get(address);
    assert!(answer.starts_with("HTTP/1.1 200 OK") && answer.contains("frame-ancestors 'none'"));
    let links = answer.matches("http").count();
    assert_eq!(links, "HTTP/1.1".matches("http").count(), "everything is in the page");

    page.notice(&Notice { level: Level::Warning, up_s: 1.0, text: "left is gone".to_owned() }).unwrap();
    let (mut socket, _) = tungstenite::connect(format!("ws://{address}/live")).unwrap();
    let notice = json(&socket.read().unwrap().into_data());
    assert_eq!(notice["notice"]["text"], "left is gone");
    page.frame(&frame(7)).unwrap();
    let message = socket.read().unwrap().into_data();
    let sketch = json(&message);
    assert_eq!((&sketch["frame"], &sketch["size"][0]), (&7.into(), &752.into()));
    let length = u32::from_le_bytes(message[..4].try_into().unwrap()) as usize;
    assert_eq!(message[4 + length..][..2], [0xff, 0xd8], "a JPEG follows");
    // Pictures are not sent faster than they can be looked at.
    (8..20).for_each(|index| page.frame(&frame(index)).unwrap());
    page.health(&Health { up_s: 2.0, wake_up_ms: None, cameras: Vec::new(), sinks: Vec::new() }).unwrap();
    assert_eq!(json(&socket.read().unwrap().into_data())["health"]["up_s"], 2.0);
    page.finish().unwrap();
    assert!(TcpStream::connect(address).is_err(), "the port is free again");
}

#[test]
fn one_who_looks_may_say_little_and_changes_nothing() {
    let _others = crate::MEMORY.read();
    let page = page();
    let url = format!("ws://{}/live", page.address());
    let (mut socket, _) = tungstenite::connect(&url).unwrap();
    socket.send(Message::text("delete everything")).unwrap();
    socket.send(Message::binary(vec![0; 1 << 20])).unwrap();
    // The connection ends; others are served.
    assert!((0..10).any(|_| socket.read().is_err()));
    assert!(tungstenite::connect(&url).is_ok());
    drop(page);
}

/// Memory of this process, bytes.
fn memory() -> u64 {
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    4096 * text.split(' ').nth(1).and_then(|pages| pages.parse::<u64>().ok()).unwrap_or_default()
}

/// How many bad messages are sent; `PHOTINUS_CASES` changes it.
fn cases() -> u64 {
    std::env::var("PHOTINUS_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(20_000)
}

#[test]
fn bad_traffic_neither_ends_it_nor_fills_memory() {
    let _alone = crate::MEMORY.write().unwrap_or_else(PoisonError::into_inner);
    let mut page = page();
    let address = page.address();
    let over = AtomicBool::new(false);
    let before = memory();
    std::thread::scope(|scope| {
        scope.spawn(|| {
            // Somebody who connects, asks properly and then never reads.
            let (socket, _) = tungstenite::connect(format!("ws://{address}/live")).unwrap();
            while !over.load(Ordering::Relaxed) {
                std::thread::sleep(Duration::from_millis(5));
            }
            drop(socket);
        });
        let senders: Vec<_> = (0..4)
            .map(|seed| scope.spawn(move || (0..cases() / 4).for_each(|case| bother(address, seed, case))))
            .collect();
        while senders.iter().any(|sender| !sender.is_finished()) {
            page.frame(&frame(1)).unwrap();
            std::thread::sleep(Duration::from_millis(20));
        }
        over.store(true, Ordering::Relaxed);
    });
    let grown = memory().saturating_sub(before);
    assert!(grown < 64 << 20, "{} MB more", grown >> 20);
    // Those who left are forgotten, and there is room again.
    let until = Instant::now() + Duration::from_secs(20);
    while !std::panic::catch_unwind(|| get(address).starts_with("HTTP/1.1 200")).unwrap_or(false) {
        assert!(Instant::now() < until);
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// Sends what nobody should.
fn bother(address: SocketAddr, seed: u64, case: u64) {
    let mut random = Pcg64::new(u128::from(seed), u128::from(case));
    let Ok(mut stream) = TcpStream::connect(address) else { return };
    let garbage = |random: &mut Pcg64, most: u64| {
        let mut bytes = vec![0; (random.next_u64() % most) as usize];
        random.fill_bytes(&mut bytes);
        bytes
    };
    let message = match random.next_u64() % 5 {
        0 => garbage(&mut random, 200),
        1 => [b"GET / HTTP/1.1\r\nHost: ", &garbage(&mut random, 20_000)[..]].concat(),
        2 => format!(
            "GET /{} HTTP/1.1\r\nHost: localhost\r\n\r\n",
            "a".repeat((random.next_u64() % 9000) as usize)
        )
        .into_bytes(),
        3 => {
            let mut head = format!("GET /live HTTP/1.1\r\nHost: {address}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n").into_bytes();
            head.extend(garbage(&mut random, 3000));
            head
        }
        _ => {
            let mut head = format!("GET / HTTP/1.1\r\nHost: {address}\r\n\r\n").into_bytes();
            let at = random.next_u64() as usize % head.len();
            head[at] = random.next_u64() as u8;
            head
        }
    };
    // It may hang up at any moment.
    let _ = stream.write_all(&message);
    if random.next_u64().is_multiple_of(4) {
        let _ = stream.set_read_timeout(Some(Duration::from_millis(20)));
        let _ = stream.read(&mut [0; 512]);
    }
}
