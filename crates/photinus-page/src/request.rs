//! What a browser asks for: enters the head of an HTTP request, leaves what is answered. It is read by `httparse`, up to 8 KiB of it.

use tungstenite::handshake::derive_accept_key;

/// The longest head that is read, bytes.
pub(crate) const LONGEST: usize = 8192;
/// The most headers.
const MOST_HEADERS: usize = 64;

/// What is answered.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    /// The head is not whole yet.
    More,
    /// The page.
    Page,
    /// A WebSocket, with the key that proves that the request was understood.
    Live(String),
    /// An error: its status line.
    Refused(&'static str),
}

const BAD: Answer = Answer::Refused("400 Bad Request");
const FORBIDDEN: Answer = Answer::Refused("403 Forbidden");

/// What is answered to a head; `token` is what must be known, if anything, and `is_local` whether only this machine can reach the port.
pub(crate) fn answer(head: &[u8], token: Option<&str>, is_local: bool) -> Answer {
    let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
    let mut request = httparse::Request::new(&mut headers);
    match request.parse(head) {
        Ok(httparse::Status::Complete(_)) => {}
        Ok(httparse::Status::Partial) if head.len() < LONGEST => return Answer::More,
        Ok(httparse::Status::Partial) => return Answer::Refused("431 Request Header Fields Too Large"),
        Err(_) => return BAD,
    }
    if request.method != Some("GET") {
        return Answer::Refused("405 Method Not Allowed");
    }
    let header = |name: &str| {
        let found = request.headers.iter().find(|header| header.name.eq_ignore_ascii_case(name));
        found.and_then(|header| std::str::from_utf8(header.value).ok())
    };
    let Some(host) = header("host") else { return BAD };
    // Another page in the same browser must not read along under a name of its own.
    if is_local && !is_loopback(host) {
        return FORBIDDEN;
    }
    if header("origin").is_some_and(|origin| origin != format!("http://{host}")) {
        return FORBIDDEN;
    }
    let (path, query) =
        request.path.unwrap_or("/").split_once('?').unwrap_or((request.path.unwrap_or("/"), ""));
    let given = query.split('&').find_map(|pair| pair.strip_prefix("token="));
    if token.is_some_and(|token| !is_same(token, given.unwrap_or_default())) {
        return Answer::Refused("401 Unauthorized");
    }
    match path {
        "/" => Answer::Page,
        "/live" => {
            let is_socket = header("upgrade").is_some_and(|value| value.eq_ignore_ascii_case("websocket"))
                && header("sec-websocket-version") == Some("13");
            match header("sec-websocket-key").filter(|_| is_socket) {
                Some(key) => Answer::Live(derive_accept_key(key.as_bytes())),
                None => Answer::Refused("426 Upgrade Required"),
            }
        }
        _ => Answer::Refused("404 Not Found"),
    }
}

fn is_loopback(host: &str) -> bool {
    let name = match host.strip_prefix('[') {
        Some(rest) => rest.split(']').next(),
        None => host.split(':').next(),
    };
    name.is_some_and(|name| {
        name == "localhost" || name.parse::<std::net::IpAddr>().is_ok_and(|address| address.is_loopback())
    })
}

/// Compares in a time that does not tell how much of it is right.
fn is_same(token: &str, given: &str) -> bool {
    let differs = token.bytes().zip(given.bytes()).fold(0, |differs, (a, b)| differs | (a ^ b));
    token.len() == given.len() && differs == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn get(path: &str, headers: &str, token: Option<&str>) -> Answer {
        answer(format!("GET {path} HTTP/1.1\r\n{headers}\r\n").as_bytes(), token, true)
    }

    #[test]
    fn only_the_page_and_its_socket_are_served() {
        let host = "Host: localhost:8080\r\n";
        assert_eq!(get("/", host, None), Answer::Page);
        assert_eq!(get("/live", host, None), Answer::Refused("426 Upgrade Required"));
        assert_eq!(get("/../etc/passwd", host, None), Answer::Refused("404 Not Found"));
        let socket = format!(
            "{host}Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
        );
        // The example of RFC 6455, section 1.3.
        assert_eq!(get("/live", &socket, None), Answer::Live("s3pPLMBiTxaQ9kYGzzhZRbK+xOo=".to_owned()));
        let post = b"POST / HTTP/1.1\r\nHost: localhost\r\n\r\n";
        assert_eq!(answer(post, None, true), Answer::Refused("405 Method Not Allowed"));
        assert_eq!(answer(b"GET / HTTP/1.1\r\nHo", None, true), Answer::More);
        assert_eq!(answer(b"\0\0", None, true), BAD);
    }

    #[test]
    fn strangers_are_sent_away() {
        let token = Some("long enough");
        let host = "Host: 127.0.0.1:1\r\n";
        assert_eq!(get("/", host, token), Answer::Refused("401 Unauthorized"));
        assert_eq!(get("/?token=long%20enough", host, token), Answer::Refused("401 Unauthorized"));
        assert_eq!(get("/?x=1&token=abcdefgh", host, Some("abcdefgh")), Answer::Page);
        assert_eq!(get("/?token=abcdefg", host, Some("abcdefgh")), Answer::Refused("401 Unauthorized"));
        for other in [
            "Host: evil.example\r\n",
            "Host: localhost.evil.example\r\n",
            "Host: 127.0.0.1:1\r\nOrigin: http://evil.example\r\n",
        ] {
            assert_eq!(get("/", other, None), FORBIDDEN, "{other}");
        }
        assert_eq!(get("/", "", None), BAD);
        assert_eq!(answer(b"GET / HTTP/1.1\r\nHost: robot:80\r\n\r\n", None, false), Answer::Page);
    }
}
