//! One file of a recording: messages with their topics in, flushed each second.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use mcap::records::MessageHeader;
use mcap::{Compression, McapError, WriteOptions, Writer};
use photinus_io::{Error, Result};

use super::write::Split;
use super::{MESSAGE_ENCODING, SCHEMA_ENCODING, long_name};
use crate::ros;

/// What was written is on its way to the disk after this long, on the clock of the messages.
const FLUSH_NS: u64 = 1_000_000_000;
/// A chunk of this size is written before its second is over.
const CHUNK_BYTES: u64 = 4 << 20;

/// One file.
pub(super) struct Part {
    path: PathBuf,
    writer: Writer<BufWriter<File>>,
    channels: BTreeMap<String, Channel>,
    bytes: u64,
    began_ns: u64,
    flushed_ns: u64,
}

struct Channel {
    id: u16,
    kind: &'static str,
    sequence: u32,
}

impl Part {
    pub(super) fn create(path: &Path) -> Result<Self> {
        let file = File::create_new(path).map_err(|error| Error::io(path, error))?;
        let library = format!("photinus {}", env!("CARGO_PKG_VERSION"));
        let options = WriteOptions::new()
            .profile("ros2")
            .library(library)
            .compression(Some(Compression::Lz4))
            .chunk_size(Some(CHUNK_BYTES));
        let writer = options.create(BufWriter::new(file)).map_err(|error| refuse(path, error))?;
        Ok(Self {
            path: path.to_owned(),
            writer,
            channels: BTreeMap::new(),
            bytes: 0,
            began_ns: 0,
            flushed_ns: 0,
        })
    }

    /// Whether nothing was written yet: its first message comes now.
    pub(super) fn begins(&mut self, now_ns: u64) -> bool {
        if self.bytes == 0 {
            (self.began_ns, self.flushed_ns) = (now_ns, now_ns);
        }
        self.bytes == 0
    }

    /// Whether nothing was written.
    pub(super) fn is_empty(&self) -> bool {
        self.bytes == 0
    }

    /// Takes the file away.
    pub(super) fn remove(self) {
        let path = self.path;
        drop(self.writer);
        // Where that fails, an empty file stays.
        let _ = std::fs::remove_file(path);
    }

    pub(super) fn flush(&mut self) -> Result<()> {
        self.writer.flush().map_err(|error| refuse(&self.path, error))
    }

    pub(super) fn is_full(&self, split: &Split, now_ns: u64) -> bool {
        let seconds = now_ns.saturating_sub(self.began_ns) as f64 * 1e-9;
        self.bytes > 0
            && (split.bytes.is_some_and(|most| self.bytes >= most)
                || split.seconds.is_some_and(|most| seconds >= most))
    }

    pub(super) fn write(
        &mut self,
        topic: &str,
        kind: &'static str,
        bytes: &[u8],
        (made_ns, arrived_ns): (u64, u64),
    ) -> Result<()> {
        let refused = |error| refuse(&self.path, error);
        if !self.channels.contains_key(topic) {
            let definition = ros::schema(kind).unwrap_or_default();
            let schema = self
                .writer
                .add_schema(&long_name(kind), SCHEMA_ENCODING, definition.as_bytes())
                .map_err(refused)?;
            let id = self
                .writer
                .add_channel(schema, topic, MESSAGE_ENCODING, &BTreeMap::new())
                .map_err(refused)?;
            self.channels.insert(topic.to_owned(), Channel { id, kind, sequence: 0 });
        }
        let Some(channel) = self.channels.get_mut(topic).filter(|channel| channel.kind == kind) else {
            return Err(Error::format(&self.path, format!("{topic} cannot carry {kind}, too")));
        };
        let header = MessageHeader {
            channel_id: channel.id,
            sequence: channel.sequence,
            log_time: arrived_ns,
            publish_time: made_ns,
        };
        channel.sequence = channel.sequence.wrapping_add(1);
        self.writer.write_to_known_channel(&header, bytes).map_err(refused)?;
        self.bytes += bytes.len() as u64;
        // A clock that was set back is due, too.
        if arrived_ns.abs_diff(self.flushed_ns) >= FLUSH_NS {
            self.writer.flush().map_err(refused)?;
            self.flushed_ns = arrived_ns;
        }
        Ok(())
    }

    pub(super) fn finish(mut self) -> Result<()> {
        self.writer.finish().map(drop).map_err(|error| refuse(&self.path, error))
    }
}

fn refuse(path: &Path, error: McapError) -> Error {
    match error {
        McapError::Io(error) => Error::io(path, error),
        error => Error::format(path, error.to_string()),
    }
}
