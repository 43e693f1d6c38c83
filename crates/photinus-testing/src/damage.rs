//! What goes wrong with files: enters a valid one, leaves one that a parser must stand.

/// What a number is replaced with.
const NUMBERS: [&str; 8] = ["nan", "-inf", "1e999", "-1", "99999999999999999999", "0", "", "\"\""];

/// The bytes cut off at `at`, a byte there changed, its line twice, or the next number replaced, by `kind` (0, 1, 2, others);
/// `value` says how. `at` counts round and round.
#[must_use]
pub fn damage(mut bytes: Vec<u8>, kind: u8, at: usize, value: u8) -> Vec<u8> {
    if bytes.is_empty() {
        return bytes;
    }
    let place = at % bytes.len();
    match kind {
        0 => bytes.truncate(place),
        1 => bytes[place] ^= value.max(1),
        2 => {
            let start = bytes[..place].iter().rposition(|&b| b == b'\n').map_or(0, |end| end + 1);
            let end =
                bytes[place..].iter().position(|&b| b == b'\n').map_or(bytes.len(), |end| place + end + 1);
            let line = bytes[start..end].to_vec();
            bytes.splice(start..start, line);
        }
        _ => {
            let is_number = |b: &u8| b.is_ascii_digit() || matches!(b, b'.' | b'-');
            let start =
                bytes[place..].iter().position(is_number).map_or(bytes.len(), |skipped| place + skipped);
            let length = bytes[start..].iter().take_while(|b| is_number(b)).count();
            let number = NUMBERS[usize::from(value) % NUMBERS.len()];
            bytes.splice(start..start + length, number.bytes());
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::damage;

    #[test]
    fn every_kind_of_damage_is_done() {
        let file = b"a = 12.5\nb = -3\n".to_vec();
        let text = |kind, at, value| String::from_utf8(damage(file.clone(), kind, at, value)).expect("ASCII");
        assert_eq!(text(0, 4, 0), "a = ");
        assert_eq!(text(1, 0, 3), "b = 12.5\nb = -3\n");
        assert_eq!(text(2, 10, 0), "a = 12.5\nb = -3\nb = -3\n");
        assert_eq!(text(3, 9, 0), "a = 12.5\nb = nan\n");
        assert_eq!(text(3, file.len() + 1, 5), "a = 0\nb = -3\n");
        assert!(damage(Vec::new(), 3, 7, 7).is_empty());
    }
}
