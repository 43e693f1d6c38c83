//! Messages <-> the bytes that ROS 2 puts on wires and into recordings: plain CDR (OMG DDS-XTypes 1.3, 7.4.1) behind a header of four bytes.

use byteorder::{BigEndian, LittleEndian};
use serde::{Deserialize, Serialize};

/// Plain CDR, little endian, no options.
const HEADER: [u8; 4] = [0, 1, 0, 0];

/// Why bytes are no message.
#[derive(Debug, thiserror::Error)]
pub enum CdrError {
    /// There is no header, or it names another encoding.
    #[error("the bytes do not begin as plain CDR does")]
    Header,
    /// The bytes end too early, or hold what this type of message cannot hold.
    #[error("{0}")]
    Content(#[from] cdr_encoding::Error),
}

/// A message as ROS 2 writes it.
///
/// # Errors
/// [`CdrError`] for a text that is too long for its length to be written.
pub fn encode(message: &impl Serialize) -> Result<Vec<u8>, CdrError> {
    let mut bytes = Vec::new();
    encode_into(message, &mut bytes)?;
    Ok(bytes)
}

/// As [`encode`], in the place of what `bytes` holds: room that is there already is used again.
///
/// # Errors
/// As [`encode`].
pub fn encode_into(message: &impl Serialize, bytes: &mut Vec<u8>) -> Result<(), CdrError> {
    bytes.clear();
    bytes.extend_from_slice(&HEADER);
    Ok(cdr_encoding::to_writer::<_, LittleEndian, _>(bytes, message)?)
}

/// A message that ROS 2 wrote, of either byte order. Nothing is taken on trust: lengths beyond the bytes that are there are refused
/// before room is made for them.
///
/// # Errors
/// [`CdrError`] when the bytes are no such message.
pub fn decode<'a, M: Deserialize<'a>>(bytes: &'a [u8]) -> Result<M, CdrError> {
    let (header, content) = bytes.split_at_checked(4).ok_or(CdrError::Header)?;
    match header {
        [0, 0, ..] => Ok(cdr_encoding::from_bytes::<M, BigEndian>(content)?.0),
        [0, 1, ..] => Ok(cdr_encoding::from_bytes::<M, LittleEndian>(content)?.0),
        _ => Err(CdrError::Header),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::ros::{CameraInfo, Frame, Header, Image, Imu, NeighbourArray, Time};

    #[test]
    fn a_header_is_the_bytes_that_the_standard_says() {
        let header = Header { stamp: Time { sec: 1, nanosec: 2 }, frame_id: "cam".to_owned() };
        let bytes = encode(&header).unwrap();
        assert_eq!(bytes, [0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 4, 0, 0, 0, b'c', b'a', b'm', 0]);
        let big = [0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 4, b'c', b'a', b'm', 0];
        assert_eq!(decode::<Header>(&big).unwrap(), header);
        assert!(matches!(decode::<Header>(&[0, 7, 0, 0, 1]), Err(CdrError::Header)));
        assert!(matches!(decode::<Header>(&bytes[..bytes.len() - 3]), Err(CdrError::Content(_))));
    }

    #[test]
    fn eight_bytes_begin_where_eight_divide_their_place() {
        let frame = Frame { frame: 7, time: 0.5, gravity: vec![0.0, 1.0, 0.0], ..Frame::default() };
        assert_eq!(decode::<Frame>(&encode(&frame).unwrap()).unwrap(), frame);
        // stamp 8, two empty texts 4 + 1 + 3 and 4 + 1: the number stands at 24
        assert_eq!(encode(&frame).unwrap()[4 + 24], 7);
    }

    proptest! {
        #[test]
        fn random_bytes_are_a_message_or_an_error(mut bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
            if let Some(header) = bytes.first_chunk_mut() {
                *header = HEADER;
            }
            let _ = decode::<Image<'_>>(&bytes);
            let _ = decode::<CameraInfo>(&bytes);
            let _ = decode::<Imu>(&bytes);
            let _ = decode::<NeighbourArray>(&bytes);
        }

        #[test]
        fn a_length_beyond_the_bytes_is_refused(length in 4_u32.., rest in proptest::collection::vec(any::<u8>(), 0..3)) {
            let mut bytes = encode(&(0_u32, 0_u32)).unwrap();
            bytes.extend_from_slice(&length.to_le_bytes());
            bytes.extend_from_slice(&rest);
            prop_assert!(decode::<Header>(&bytes).is_err());
        }
    }
}
