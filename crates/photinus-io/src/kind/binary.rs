//! Kinds that show in the first bytes.

use super::{Foreign, Kind};

/// What begins with these bytes, unless it is text.
pub(super) fn kind(head: &[u8]) -> Option<Kind> {
    const IMAGES: [&[u8]; 5] = [b"\x89PNG", b"\xff\xd8\xff", b"BM", b"II*\0", b"MM\0*"];
    const FOREIGN: [(&[u8], Foreign); 5] = [
        (b"\x1a\x45\xdf\xa3", Foreign::Matroska),
        (b"SQLite format 3", Foreign::Sqlite),
        (b"\x1f\x8b", Foreign::Gzip),
        (b"PK\x03\x04", Foreign::Zip),
        (b"%PDF-", Foreign::Pdf),
    ];
    if head.starts_with(b"YUV4MPEG2") {
        return Some(Kind::Video);
    }
    if head.starts_with(b"\x89MCAP") {
        return Some(Kind::Recording);
    }
    if head.starts_with(b"#ROSBAG") {
        return Some(Kind::Bag);
    }
    if let Some((_, foreign)) = FOREIGN.iter().find(|(magic, _)| head.starts_with(magic)) {
        return Some(Kind::Foreign(*foreign));
    }
    if head.get(4..8) == Some(b"ftyp") {
        return Some(Kind::Foreign(Foreign::Mp4));
    }
    if head.starts_with(b"RIFF") && head.get(8..12) == Some(b"AVI ") {
        return Some(Kind::Foreign(Foreign::Avi));
    }
    if is_pnm(head) || IMAGES.iter().any(|magic| head.starts_with(magic)) {
        return Some(Kind::Image);
    }
    (head.contains(&0) || !is_utf8_so_far(head)).then_some(Kind::Binary)
}

fn is_pnm(head: &[u8]) -> bool {
    matches!(head, [b'P', b'1'..=b'7', space, ..] if space.is_ascii_whitespace())
}

/// Whether it is UTF-8 but for a letter that the end may have cut.
fn is_utf8_so_far(head: &[u8]) -> bool {
    std::str::from_utf8(head).map_or_else(|error| error.error_len().is_none(), |_| true)
}
