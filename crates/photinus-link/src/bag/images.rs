//! The images of a bag as frames, with their stamps as times.

use std::path::Path;

use photinus_io::frames::{Frame, Moved};
use photinus_io::image::{GreyImage, decode_image};
use photinus_io::{Error, Place, Result};

use super::record::Record;
use super::serial::Fields;
use super::{Bag, MESSAGE};
use crate::recording::{COMPRESSED, ImageTopic, RAW, chosen, topics_of_images};
use crate::ros::{Header, Image};

/// The topics of a bag that hold images, by name.
#[must_use]
pub fn image_topics(bag: &Bag) -> Vec<ImageTopic> {
    topics_of_images(&bag.topics())
}

/// The images of one topic, in the order of the file; one chunk is in memory at a time.
pub struct BagFrames {
    bag: Bag,
    topic: ImageTopic,
    /// Numbers of its connections, and whether their images are compressed.
    connections: Vec<(u32, bool)>,
    /// Which chunk comes next.
    next_chunk: usize,
    /// The records of this chunk, and where the next one begins.
    chunk: (Vec<u8>, usize),
    next: u64,
}

impl BagFrames {
    /// The frames of `topic`, or of the only one that there is.
    ///
    /// # Errors
    /// [`Error`] when it cannot be opened, has no such topic, or several and none is named.
    pub fn open(path: impl AsRef<Path>, topic: Option<&str>) -> Result<Self> {
        let bag = Bag::open(path)?;
        let topic = chosen(image_topics(&bag), topic, bag.path())?;
        let of_topic = bag.connections.iter().filter(|connection| connection.topic == topic.name);
        let of_images = of_topic.filter(|connection| [RAW, COMPRESSED].contains(&connection.kind.as_str()));
        let connections =
            of_images.map(|connection| (connection.number, connection.kind == COMPRESSED)).collect();
        Ok(Self { bag, topic, connections, next_chunk: 0, chunk: (Vec::new(), 0), next: 0 })
    }

    /// How many frames there are.
    #[must_use]
    pub fn total(&self) -> Option<u64> {
        self.topic.frames
    }

    /// The next image, wherever it is; `None` at the end.
    fn image(&mut self) -> Option<Result<(Header, GreyImage)>> {
        loop {
            let (bytes, at) = &mut self.chunk;
            while *at < bytes.len() {
                let Some((record, rest)) = Record::split(&bytes[*at..]) else {
                    // Nothing of the rest of this chunk can be told.
                    *at = bytes.len();
                    return Some(Err(self.bag.damaged()));
                };
                *at = bytes.len() - rest.len();
                let connection = record.u32("conn").filter(|_| record.kind() == Some(MESSAGE));
                let mut connections = self.connections.iter();
                if let Some((_, is_compressed)) = connections.find(|(number, _)| Some(*number) == connection)
                {
                    return Some(match is_compressed {
                        true => compressed(record.data, self.bag.path()),
                        false => raw(record.data, self.bag.path()),
                    });
                }
            }
            let is_meant = |&(number, _): &(u32, u32)| self.connections.iter().any(|(one, _)| *one == number);
            let chunk = loop {
                let chunk = self.bag.chunks.get(self.next_chunk)?;
                self.next_chunk += 1;
                if chunk.counts.iter().any(is_meant) {
                    break chunk;
                }
            };
            match self.bag.chunk(chunk) {
                Ok(bytes) => self.chunk = (bytes, 0),
                Err(error) => return Some(Err(error)),
            }
        }
    }
}

impl Iterator for BagFrames {
    type Item = Result<Frame>;

    fn next(&mut self) -> Option<Self::Item> {
        let image = self.image()?;
        let index = self.next;
        self.next += 1;
        Some(image.map_err(|error| error.at(Place::Frame(index))).map(|(header, image)| Frame {
            image,
            index,
            time_s: Some(header.stamp.seconds()),
            source: format!("{}:{}", self.bag.path().display(), self.topic.name),
            gravity: None,
            exposure_s: None,
            moved: Moved::default(),
            conversions: Vec::new(),
        }))
    }
}

/// sensor_msgs/Image of ROS 1.
fn raw(bytes: &[u8], path: &Path) -> Result<(Header, GreyImage)> {
    let fields = |mut fields: Fields<'_>| {
        let header = fields.header()?;
        let (height, width) = (fields.u32()?, fields.u32()?);
        let encoding = fields.text()?.to_owned();
        let (is_bigendian, step) = (fields.u8()?, fields.u32()?);
        let data = fields.bytes()?.to_vec().into();
        Some(Image { header, height, width, encoding, is_bigendian, step, data })
    };
    let message = fields(Fields(bytes)).ok_or_else(|| Error::format(path, "a message is no image"))?;
    let image = message.grey().map_err(|reason| Error::format(path, reason))?;
    Ok((message.header, image))
}

/// sensor_msgs/CompressedImage of ROS 1.
fn compressed(bytes: &[u8], path: &Path) -> Result<(Header, GreyImage)> {
    let mut fields = Fields(bytes);
    let mut parts = || Some((fields.header()?, fields.text()?, fields.bytes()?));
    let (header, _, file) = parts().ok_or_else(|| Error::format(path, "a message is no image"))?;
    Ok((header, decode_image(file, path)?.image))
}
