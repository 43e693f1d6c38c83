//! An MCAP file, whoever wrote it -> its topics and, by its index, its messages in the order of their arrival.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use mcap::Summary;
use mcap::sans_io::indexed_reader::{IndexedReadEvent, IndexedReader, IndexedReaderOptions};
use mcap::sans_io::summary_reader::{SummaryReadEvent, SummaryReader, SummaryReaderOptions};
use photinus_io::{Error, Result};

use super::{MEND, MESSAGE_ENCODING, guarded, short_name};

/// Records above this are no frames of a camera: a file that claims such a one is damaged.
pub(crate) const MOST_BYTES: usize = 256 << 20;

/// What a topic carries.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topic {
    /// Its name.
    pub name: String,
    /// `package/Name` of its messages.
    pub kind: String,
    /// How many messages it has, where the file counts them.
    pub messages: Option<u64>,
}

/// An MCAP file whose index was read.
pub struct Recording {
    path: PathBuf,
    file: File,
    summary: Summary,
}

impl Recording {
    /// Reads the index of a file.
    ///
    /// # Errors
    /// [`Error`] when it is no MCAP file, was cut off, or has no index.
    pub fn open(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        guarded(path, || Self::read(path))
    }

    fn read(path: &Path) -> Result<Self> {
        let mut file = File::open(path).map_err(|error| Error::io(path, error))?;
        let length = file.metadata().map_err(|error| Error::io(path, error))?.len();
        let options =
            SummaryReaderOptions::default().with_file_size(length).with_record_length_limit(MOST_BYTES);
        let mut reader = SummaryReader::new_with_options(options);
        while let Some(event) = reader.next_event() {
            match event.map_err(|error| damaged(path, &error))? {
                SummaryReadEvent::ReadRequest(need) => {
                    let read = file.read(reader.insert(need)).map_err(|error| Error::io(path, error))?;
                    reader.notify_read(read);
                }
                SummaryReadEvent::SeekRequest(to) => {
                    reader.notify_seeked(file.seek(to).map_err(|error| Error::io(path, error))?);
                }
            }
        }
        let summary = reader.finish().filter(|summary| !summary.chunk_indexes.is_empty());
        let summary =
            summary.ok_or_else(|| Error::format(path, "it has no index of its messages").advise(MEND))?;
        Ok(Self { path: path.to_owned(), file, summary })
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What it carries, by name. Topics that are not written as ROS 2 does are left out.
    #[must_use]
    pub fn topics(&self) -> Vec<Topic> {
        let counts = self.summary.stats.as_ref().map(|stats| &stats.channel_message_counts);
        let ours =
            self.summary.channels.values().filter(|channel| channel.message_encoding == MESSAGE_ENCODING);
        let topic = |channel: &std::sync::Arc<mcap::Channel<'_>>| {
            Some(Topic {
                name: channel.topic.clone(),
                kind: short_name(&channel.schema.as_ref()?.name),
                messages: counts.and_then(|counts| counts.get(&channel.id).copied()),
            })
        };
        let mut topics: Vec<Topic> = ours.filter_map(topic).collect();
        topics.sort_by(|a, b| a.name.cmp(&b.name));
        topics
    }

    /// When the first and the last message arrived, ns, where the file says.
    #[must_use]
    pub fn span_ns(&self) -> Option<(u64, u64)> {
        let stats = self.summary.stats.as_ref().filter(|stats| stats.message_count > 0)?;
        Some((stats.message_start_time, stats.message_end_time))
    }

    /// The messages of these topics in the order of their arrival, from `after_ns` on.
    ///
    /// # Errors
    /// [`Error`] when the index contradicts itself.
    pub(crate) fn messages<'a>(
        self,
        topics: impl IntoIterator<Item = &'a str>,
        after_ns: u64,
    ) -> Result<Messages> {
        let options = IndexedReaderOptions::new()
            .include_topics(topics.into_iter().map(str::to_owned))
            .starting_at(after_ns)
            .with_record_length_limit(MOST_BYTES);
        let index = || IndexedReader::new_with_options(&self.summary, options);
        let reader = guarded(&self.path, || index().map_err(|error| damaged(&self.path, &error)))?;
        Ok(Messages { recording: self, reader, chunk: Vec::new(), is_lost: false })
    }
}

/// Messages of a file.
pub(crate) struct Messages {
    recording: Recording,
    reader: IndexedReader,
    chunk: Vec<u8>,
    /// Whether the index led nowhere: nothing follows.
    is_lost: bool,
}

impl Messages {
    /// The file.
    pub(super) fn path(&self) -> &Path {
        &self.recording.path
    }

    /// Hands the next message, of this topic and with these bytes, to `take`; `None` at the end.
    pub(crate) fn next<T>(&mut self, take: impl FnOnce(&str, &[u8]) -> T) -> Option<Result<T>> {
        if self.is_lost {
            return None;
        }
        let path = self.path().to_owned();
        let next = guarded(&path, || self.read(take)).transpose();
        self.is_lost = matches!(next, Some(Err(_)));
        next
    }

    fn read<T>(&mut self, take: impl FnOnce(&str, &[u8]) -> T) -> Result<Option<T>> {
        let Recording { path, file, summary } = &mut self.recording;
        while let Some(event) = self.reader.next_event() {
            match event.map_err(|error| damaged(path, &error))? {
                IndexedReadEvent::ReadChunkRequest { offset, length } => {
                    self.chunk.resize(length, 0);
                    let read =
                        file.seek(SeekFrom::Start(offset)).and_then(|_| file.read_exact(&mut self.chunk));
                    read.map_err(|error| Error::io(&*path, error).advise(MEND))?;
                    let inserted = self.reader.insert_chunk_record_data(offset, &self.chunk);
                    inserted.map_err(|error| damaged(path, &error))?;
                }
                IndexedReadEvent::Message { header, data } => {
                    let Some(channel) = summary.channels.get(&header.channel_id) else { continue };
                    return Ok(Some(take(&channel.topic, data)));
                }
            }
        }
        Ok(None)
    }
}

fn damaged(path: &Path, error: &mcap::McapError) -> Error {
    match error {
        mcap::McapError::UnsupportedCompression(how) => {
            Error::format(path, format!("it is compressed with {how}, which is not read"))
                .advise("write it anew with LZ4 or without compression: `mcap compress --compression lz4`")
        }
        error => Error::format(path, error.to_string()).advise(MEND),
    }
}
