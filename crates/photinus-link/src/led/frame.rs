//! A payload <-> bytes on the line: `b`, how many bytes, the bytes, and the sum of all before it modulo 256.

const BEGIN: u8 = b'b';

/// The bytes that carry a payload of 1 to 255 bytes.
///
/// # Panics
/// On a payload that no frame holds; commands are checked when they are made.
#[must_use]
pub fn framed(payload: &[u8]) -> Vec<u8> {
    let length = u8::try_from(payload.len()).expect("a payload has at most 255 bytes");
    let mut bytes = vec![BEGIN, length];
    bytes.extend_from_slice(payload);
    bytes.push(sum(&bytes));
    bytes
}

fn sum(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |sum, byte| sum.wrapping_add(*byte))
}

/// Finds frames in what comes from a line, whatever is between them.
#[derive(Clone, Debug, Default)]
pub struct Unframer {
    waiting: Vec<u8>,
}

impl Unframer {
    /// The payloads that are whole now. What begins a frame and is none is searched for the next beginning.
    pub fn take(&mut self, bytes: &[u8]) -> Vec<Vec<u8>> {
        self.waiting.extend_from_slice(bytes);
        let (mut found, mut at) = (Vec::new(), 0);
        while let Some(begin) = self.waiting[at..].iter().position(|byte| *byte == BEGIN) {
            at += begin;
            let Some(&length) = self.waiting.get(at + 1) else { break };
            let end = at + 2 + usize::from(length);
            let Some(&checked) = self.waiting.get(end) else { break };
            if length > 0 && sum(&self.waiting[at..end]) == checked {
                found.push(self.waiting[at + 2..end].to_vec());
                at = end + 1;
            } else {
                at += 1;
            }
        }
        // Without a beginning nothing of it is of use; with one, at most a frame waits.
        let is_begun = self.waiting[at..].contains(&BEGIN);
        self.waiting.drain(..if is_begun { at } else { self.waiting.len() });
        found
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_frame_is_what_boards_are_sent_today() {
        assert_eq!(framed(&[0x90, 0x01]), [b'b', 2, 0x90, 0x01, 0xF5]);
        assert_eq!(framed(&[0x97, 18]), [98, 2, 151, 18, 13]);
    }

    proptest! {
        #[test]
        fn frames_come_out_of_any_pieces(
            payloads in proptest::collection::vec(proptest::collection::vec(any::<u8>(), 1..=255), 1..6),
            piece in 1_usize..40,
        ) {
            let bytes: Vec<u8> = payloads.iter().flat_map(|payload| framed(payload)).collect();
            let mut unframer = Unframer::default();
            let found: Vec<Vec<u8>> = bytes.chunks(piece).flat_map(|piece| unframer.take(piece)).collect();
            prop_assert_eq!(found, payloads);
            prop_assert!(unframer.waiting.is_empty());
        }

        #[test]
        fn noise_is_passed_over_in_bounded_room(
            noise in proptest::collection::vec(any::<u8>(), 0..2000),
            payload in proptest::collection::vec(any::<u8>(), 1..20),
        ) {
            let mut unframer = Unframer::default();
            for piece in noise.chunks(7) {
                unframer.take(piece);
                prop_assert!(unframer.waiting.len() < 258 + 7);
            }
            // A beginning in the noise may claim what comes next, but not for longer than the longest frame.
            unframer.take(&[0; 258]);
            prop_assert_eq!(unframer.take(&framed(&payload)), [payload]);
        }
    }
}
