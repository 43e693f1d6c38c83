//! What ROS 1 writes of a message (<https://wiki.ros.org/msg>): its fields one after the other, little endian, nothing between them; texts and
//! lists behind their length.

use super::record::sized;
use crate::ros::{Header, Time};

/// Fields of a message that are left to be read; each `None` says that the bytes are no such message.
pub(crate) struct Fields<'a>(pub(crate) &'a [u8]);

impl<'a> Fields<'a> {
    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (array, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*array)
    }

    pub(crate) fn u8(&mut self) -> Option<u8> {
        self.array().map(|[byte]| byte)
    }

    pub(crate) fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(crate) fn f64(&mut self) -> Option<f64> {
        self.array().map(f64::from_le_bytes)
    }

    /// A list of bytes.
    pub(crate) fn bytes(&mut self) -> Option<&'a [u8]> {
        let (bytes, rest) = sized(self.0)?;
        self.0 = rest;
        Some(bytes)
    }

    pub(crate) fn text(&mut self) -> Option<&'a str> {
        std::str::from_utf8(self.bytes()?).ok()
    }

    /// std_msgs/Header, which has a number of its own in ROS 1.
    pub(crate) fn header(&mut self) -> Option<Header> {
        let _number = self.u32()?;
        let stamp = Time { sec: i32::try_from(self.u32()?).ok()?, nanosec: self.u32()? };
        Some(Header { stamp, frame_id: self.text()?.to_owned() })
    }
}
