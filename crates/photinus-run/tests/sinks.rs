//! JSON lines where others read them: a socket whose reader is stuck or gone, a file, a unix socket left behind.

use std::io::{BufRead, BufReader};
use std::net::TcpStream;

use photinus_run::sink::{Address, Bystanders};

const LINE: &[u8] = &[b'x'; 1000];

#[test]
fn whoever_connects_reads_whole_lines_and_who_does_not_read_is_sent_away() {
    let mut all = Bystanders::listen(&Address::Tcp("127.0.0.1:0".parse().unwrap())).unwrap();
    let port = all.port().unwrap();
    let connect = || TcpStream::connect(("127.0.0.1", port)).unwrap();
    let (reads, stuck, gone) = (connect(), connect(), connect());
    drop(gone);
    let counting = std::thread::spawn(move || {
        let lines = BufReader::new(reads).lines();
        lines.map(|line| line.unwrap()).inspect(|line| assert_eq!(line.len(), 999)).count()
    });
    let mut line = LINE.to_vec();
    line[999] = b'\n';
    // More than what the system and we keep for one that does not read.
    let count = 40_000;
    for number in 0..count {
        all.send(&line);
        if number % 50 == 0 {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
    }
    for _ in 0..200 {
        all.send(&[]);
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    drop(all);
    let read = counting.join().unwrap();
    assert!(read > 0 && read <= count, "{read}");
    stuck.set_nonblocking(true).unwrap();
    // The one that never read has the connection closed in front of it, after what the system kept.
    let mut rest = BufReader::new(stuck);
    let mut bytes = 0;
    while let Ok(taken @ 1..) = rest.fill_buf().map(<[u8]>::len) {
        bytes += taken;
        rest.consume(taken);
    }
    assert!(bytes < count * line.len(), "{bytes}");
}

#[cfg(unix)]
#[test]
fn a_socket_that_a_killed_run_left_behind_is_taken_over_and_one_in_use_is_not() {
    let path = std::env::temp_dir().join(format!("photinus-{}.sock", std::process::id()));
    drop(std::os::unix::net::UnixListener::bind(&path).unwrap());
    assert!(path.exists());
    let address = Address::Unix(path.clone());
    let first = Bystanders::listen(&address).unwrap();
    assert!(Bystanders::listen(&address).is_err());
    drop(first);
    assert!(!path.exists());
    // A file of another kind is left alone.
    std::fs::write(&path, "kept").unwrap();
    assert!(Bystanders::listen(&address).is_err());
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "kept");
    std::fs::remove_file(&path).unwrap();
}
