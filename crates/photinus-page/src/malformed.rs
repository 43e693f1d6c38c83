//! What reads heads of requests and WebSocket messages, fed with what nobody should send: 1,000,000 of each, `PHOTINUS_CASES` says how many.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::io::{Cursor, Read, Result, Write};

use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;

use crate::request::{Answer, LONGEST, answer};
use crate::server::{LONGEST_MESSAGE, socket};

fn cases() -> u64 {
    std::env::var("PHOTINUS_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(1_000_000)
}

fn below(random: &mut Pcg64, most: usize) -> usize {
    (random.next_u64() % most.max(1) as u64) as usize
}

/// Whole bytes with a few of them changed, cut, or followed by others.
fn spoilt(random: &mut Pcg64, whole: &[u8]) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    for _ in 0..1 + below(random, 4) {
        let at = below(random, bytes.len());
        match below(random, 4) {
            0 => bytes[at] = random.next_u64() as u8,
            1 => bytes.truncate(at + 1),
            2 => bytes.insert(at, random.next_u64() as u8),
            _ => bytes.splice(at..at, whole.to_vec()).for_each(drop),
        }
    }
    bytes
}

#[test]
fn a_head_that_nobody_should_send_is_answered_by_an_error_or_as_a_good_one() {
    let good = b"GET /live?token=12345678 HTTP/1.1\r\nHost: 127.0.0.1:8080\r\nOrigin: http://127.0.0.1:8080\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
    let mut random = Pcg64::new(8, 1);
    let (mut live, mut refused) = (0, 0);
    for case in 0..cases() {
        let mut head = spoilt(&mut random, good);
        head.truncate(LONGEST);
        match answer(&head, Some("12345678"), true) {
            Answer::Live(key) => {
                live += 1;
                assert!(key.len() == 28, "case {case}: {key}");
            }
            Answer::Refused(_) => refused += 1,
            Answer::More => assert!(head.len() < LONGEST, "case {case} is waited for without end"),
            Answer::Page => panic!("case {case}: nobody asked for the page: {}", head.escape_ascii()),
        }
    }
    assert!(live > 0 && refused > cases() / 10, "{live} {refused}");
}

/// What they send; what is answered goes nowhere.
struct Wire(Cursor<Vec<u8>>);

impl Read for Wire {
    fn read(&mut self, to: &mut [u8]) -> Result<usize> {
        self.0.read(to)
    }
}

impl Write for Wire {
    fn write(&mut self, from: &[u8]) -> Result<usize> {
        Ok(from.len())
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

#[test]
fn a_socket_that_says_what_nobody_should_ends_and_gives_nothing_long() {
    // A text, a ping, a message in two parts, a message that says it is as long as there are bytes, an end: masked as clients must (RFC 6455, 5.2).
    let good: [&[u8]; 5] = [
        b"\x81\x83\0\0\0\0abc",
        b"\x89\x80\0\0\0\0",
        b"\x01\x81\0\0\0\0a\x80\x81\0\0\0\0b",
        b"\x82\xff\0\0\0\xff\xff\xff\xff\xff\0\0\0\0abc",
        b"\x88\x82\0\0\0\0\x03\xe8",
    ];
    let mut random = Pcg64::new(8, 2);
    let (mut messages, mut ended) = (0_u64, 0_u64);
    for case in 0..cases() {
        let whole: Vec<u8> = (0..3).flat_map(|_| good[below(&mut random, 5)].to_vec()).collect();
        let said = spoilt(&mut random, &whole);
        let most = said.len();
        let mut socket = socket(Wire(Cursor::new(said)));
        for _ in 0..=most {
            match socket.read() {
                Ok(message) => {
                    messages += 1;
                    assert!(message.len() <= LONGEST_MESSAGE, "case {case}");
                }
                Err(_) => {
                    ended += 1;
                    break;
                }
            }
        }
    }
    assert_eq!(ended, cases(), "each comes to its end");
    assert!(messages > cases() / 10, "{messages}");
}
