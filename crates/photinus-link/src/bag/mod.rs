//! Bags of ROS 1, format 2.0 (<https://wiki.ros.org/Bags/Format/2.0>): a file comes in, its topics and the messages of one of them come
//! out. Chunks are plain or LZ4; those of bzip2 are refused with advice, as are bags without an index.
//!
//! ```text
//! record    bytes -> fields
//! mod       the index at the end of the file -> which chunks hold a topic -> its messages
//! serial    what ROS 1 writes of a message -> its fields
//! images    topics with images -> frames
//! motion    its imu and odometry
//! ```

mod images;
mod motion;
mod record;
pub(crate) mod serial;

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use photinus_io::{Error, Result};

use crate::recording::{MOST_BYTES, Topic};
pub use images::{BagFrames, image_topics};
pub(crate) use motion::{imu, odometry};
use record::{Record, field, records};

const MAGIC: &[u8] = b"#ROSBAG V2.0\n";
/// What kinds of records say in their field `op`.
const MESSAGE: u8 = 0x02;
const BAG_HEADER: u8 = 0x03;
const CHUNK: u8 = 0x05;
const CHUNK_INFO: u8 = 0x06;
const CONNECTION: u8 = 0x07;
const REINDEX: &str = "`rosbag reindex` of ROS 1 makes it anew";

/// A bag whose index was read.
pub struct Bag {
    path: PathBuf,
    file: File,
    length: u64,
    connections: Vec<Connection>,
    chunks: Vec<Chunk>,
}

/// Who wrote messages on which topic.
struct Connection {
    number: u32,
    topic: String,
    /// `package/Name` of its messages.
    kind: String,
}

/// What the index says of a chunk.
struct Chunk {
    at: u64,
    from_ns: u64,
    to_ns: u64,
    /// Numbers of connections, and how many messages each has in it.
    counts: Vec<(u32, u32)>,
}

impl Bag {
    /// Reads the index of a bag.
    ///
    /// # Errors
    /// [`Error`] when it is no bag of format 2.0, was not closed, or its index is damaged.
    pub fn open(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref().to_owned();
        let file = File::open(&path).map_err(|error| Error::io(&path, error))?;
        let length = file.metadata().map_err(|error| Error::io(&path, error))?.len();
        let mut bag = Self { path, file, length, connections: Vec::new(), chunks: Vec::new() };
        if bag.bytes(0, MAGIC.len() as u64)? != MAGIC {
            let refused = Error::format(&bag.path, "it does not begin as a bag of format 2.0 does");
            return Err(refused.advise(REINDEX));
        }
        let header = bag.record(MAGIC.len() as u64)?;
        let header = whole(&header).filter(|record| record.kind() == Some(BAG_HEADER));
        let index = header.and_then(|record| record.u64("index_pos"));
        match index {
            Some(0) => Err(Error::format(&bag.path, "it was not closed and has no index").advise(REINDEX)),
            Some(at) if (1..=bag.length).contains(&at) => bag.index(at).map(|()| bag),
            _ => Err(bag.damaged()),
        }
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What it carries, by name.
    #[must_use]
    pub fn topics(&self) -> Vec<Topic> {
        let mut topics: Vec<Topic> = Vec::new();
        for connection in &self.connections {
            let counts = self.chunks.iter().flat_map(|chunk| &chunk.counts);
            let of_connection = counts.filter(|(number, _)| *number == connection.number);
            let messages: u64 = of_connection.map(|(_, count)| u64::from(*count)).sum();
            let same = |topic: &&mut Topic| topic.name == connection.topic && topic.kind == connection.kind;
            match topics.iter_mut().find(same) {
                Some(topic) => topic.messages = topic.messages.map(|before| before + messages),
                None => topics.push(Topic {
                    name: connection.topic.clone(),
                    kind: connection.kind.clone(),
                    messages: Some(messages),
                }),
            }
        }
        topics.sort_by(|a, b| a.name.cmp(&b.name));
        topics
    }

    /// When the first and the last message arrived, ns; `None` of an empty bag.
    #[must_use]
    pub fn span_ns(&self) -> Option<(u64, u64)> {
        let from = self.chunks.iter().map(|chunk| chunk.from_ns).min()?;
        Some((from, self.chunks.iter().map(|chunk| chunk.to_ns).max()?))
    }

    /// Hands the bytes of each message of a topic to `take`, in the order of the file.
    ///
    /// # Errors
    /// [`Error`] of `take`, for damaged chunks, and for chunks that are compressed in a way that is not read.
    pub fn messages(&self, topic: &Topic, mut take: impl FnMut(&[u8]) -> Result<()>) -> Result<()> {
        let is_meant = |number: u32| {
            let mut connections = self.connections.iter();
            connections.any(|one| one.number == number && one.topic == topic.name && one.kind == topic.kind)
        };
        for chunk in
            self.chunks.iter().filter(|chunk| chunk.counts.iter().any(|&(number, _)| is_meant(number)))
        {
            for record in records(&self.chunk(chunk)?) {
                let record = record.ok_or_else(|| self.damaged())?;
                if record.kind() == Some(MESSAGE) && record.u32("conn").is_some_and(is_meant) {
                    take(record.data)?;
                }
            }
        }
        Ok(())
    }

    /// Reads connections and chunks from the end of the file.
    fn index(&mut self, at: u64) -> Result<()> {
        let bytes = self.bytes(at, self.length - at)?;
        for record in records(&bytes) {
            let record = record.ok_or_else(|| self.damaged())?;
            match record.kind() {
                Some(CONNECTION) => {
                    self.connections.push(Connection::of(&record).ok_or_else(|| self.damaged())?);
                }
                Some(CHUNK_INFO) => self.chunks.push(Chunk::of(&record).ok_or_else(|| self.damaged())?),
                _ => {}
            }
        }
        Ok(())
    }

    /// The records in a chunk.
    fn chunk(&self, chunk: &Chunk) -> Result<Vec<u8>> {
        let bytes = self.record(chunk.at)?;
        let record = whole(&bytes).filter(|record| record.kind() == Some(CHUNK));
        let record = record.ok_or_else(|| self.damaged())?;
        let size = record.u32("size").map(u64::from).filter(|&size| size <= MOST_BYTES as u64);
        let size = size.ok_or_else(|| self.damaged())?;
        match record.field("compression") {
            Some(b"none") => Ok(record.data.to_vec()),
            Some(b"lz4") => {
                let mut unpacked = Vec::new();
                let read = lz4::Decoder::new(record.data)
                    .and_then(|unpacker| unpacker.take(size + 1).read_to_end(&mut unpacked));
                match read {
                    Ok(read) if read as u64 == size => Ok(unpacked),
                    _ => Err(self.damaged()),
                }
            }
            other => {
                let how = String::from_utf8_lossy(other.unwrap_or(b"nothing known"));
                Err(Error::format(&self.path, format!("it is compressed with {how}, which is not read"))
                    .advise("`rosbag decompress` of ROS 1 writes it anew"))
            }
        }
    }

    /// The bytes of the record at a place of the file.
    fn record(&self, at: u64) -> Result<Vec<u8>> {
        let length_at = |at: u64| -> Result<u64> {
            let bytes = self.bytes(at, 4)?;
            Ok(u64::from(u32::from_le_bytes(bytes.try_into().map_err(|_| self.damaged())?)))
        };
        let header = 4 + length_at(at)?;
        let data = 4 + length_at(at.saturating_add(header))?;
        self.bytes(at, header + data)
    }

    /// This many bytes of the file; no room is made for more than it has.
    fn bytes(&self, at: u64, count: u64) -> Result<Vec<u8>> {
        if count > MOST_BYTES as u64 || at.checked_add(count).is_none_or(|end| end > self.length) {
            return Err(self.damaged());
        }
        let mut bytes = vec![0; count as usize];
        let mut file = &self.file;
        file.seek(SeekFrom::Start(at))
            .and_then(|_| file.read_exact(&mut bytes))
            .map_err(|error| Error::io(&self.path, error))?;
        Ok(bytes)
    }

    fn damaged(&self) -> Error {
        Error::format(&self.path, "it was cut off, or its records contradict each other").advise(REINDEX)
    }
}

impl Connection {
    fn of(record: &Record<'_>) -> Option<Self> {
        let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).ok();
        Some(Self {
            number: record.u32("conn")?,
            topic: text(record.field("topic")?)?,
            kind: text(field(record.data, "type")?)?,
        })
    }
}

impl Chunk {
    fn of(record: &Record<'_>) -> Option<Self> {
        let number = |bytes: &[u8]| Some(u32::from_le_bytes(*bytes.first_chunk()?));
        let pairs = record.data.chunks_exact(8);
        let counts = pairs.map(|pair| Some((number(pair)?, number(&pair[4..])?))).collect::<Option<_>>()?;
        Some(Self {
            at: record.u64("chunk_pos")?,
            from_ns: record.time_ns("start_time")?,
            to_ns: record.time_ns("end_time")?,
            counts,
        })
    }
}

/// The one record that these bytes are.
fn whole(bytes: &[u8]) -> Option<Record<'_>> {
    Record::split(bytes).map(|(record, _)| record)
}
