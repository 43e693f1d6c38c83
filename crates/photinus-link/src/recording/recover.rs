//! A recording that was cut off -> a whole one with everything that can be read of it, in the same order, and an index.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, BufWriter, Read};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use mcap::records::Record;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{Attachment, Compression, WriteOptions, Writer, parse_record};
use photinus_io::{Error, Result};

use super::read::MOST_BYTES;

/// What was saved.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Recovered {
    /// How many messages.
    pub messages: u64,
    /// When the first and the last arrived, ns.
    pub arrived_ns: Option<(u64, u64)>,
    /// Why reading ended before the end of the file; `None` where nothing was wrong.
    pub damage: Option<String>,
}

/// Reads `from` as far as it goes and writes a whole file at `to`.
///
/// # Errors
/// [`Error`] when `from` is no MCAP file at all, or `to` is there already or cannot be written.
pub fn recover(from: impl AsRef<Path>, to: impl AsRef<Path>) -> Result<Recovered> {
    let (from, to) = (from.as_ref(), to.as_ref());
    let file = File::open(from).map_err(|error| Error::io(from, error))?;
    let mut source = BufReader::new(file);
    let mut magic = [0; 5];
    let begins = source.read_exact(&mut magic).is_ok() && magic == *b"\x89MCAP";
    if !begins {
        let refused = Error::format(from, "it is no MCAP recording");
        return Err(refused.advise("name the file that `[record]` or `photinus convert` wrote"));
    }
    let file = File::open(from).map_err(|error| Error::io(from, error))?;
    let target = File::create_new(to).map_err(|error| Error::io(to, error))?;
    let library = format!("photinus {} recover", env!("CARGO_PKG_VERSION"));
    let options = WriteOptions::new().profile("ros2").library(library).compression(Some(Compression::Lz4));
    let refuse = |error: mcap::McapError| Error::format(to, error.to_string());
    let mut salvage = Salvage {
        writer: options.create(BufWriter::new(target)).map_err(refuse)?,
        channels: BTreeMap::new(),
        told: Recovered::default(),
    };
    // The reader of MCAP is other people's code, bytes are anybody's.
    let read = AssertUnwindSafe(|| salvage.all(BufReader::new(file)));
    let damage = catch_unwind(read)
        .unwrap_or_else(|_| Err(Broken::Source("its records contradict themselves".to_owned())));
    salvage.writer.finish().map_err(refuse)?;
    match damage {
        Err(Broken::Source(reason)) => salvage.told.damage = Some(reason),
        Err(Broken::Target(error)) => return Err(refuse(error)),
        Ok(()) => {}
    }
    Ok(salvage.told)
}

struct Salvage {
    writer: Writer<BufWriter<File>>,
    /// Number of a channel in the old file -> in the new one.
    channels: BTreeMap<u16, u16>,
    told: Recovered,
}

enum Broken {
    Source(String),
    Target(mcap::McapError),
}

impl Salvage {
    fn all(&mut self, mut source: impl Read) -> std::result::Result<(), Broken> {
        let options =
            LinearReaderOptions::default().with_skip_end_magic(true).with_record_length_limit(MOST_BYTES);
        let mut reader = LinearReader::new_with_options(options);
        let mut schemas = BTreeMap::new();
        while let Some(event) = reader.next_event() {
            match event.map_err(|error| Broken::Source(error.to_string()))? {
                LinearReadEvent::ReadRequest(need) => {
                    let read = source.read(reader.insert(need));
                    reader.notify_read(read.map_err(|error| Broken::Source(error.to_string()))?);
                }
                LinearReadEvent::Record { data, opcode } => {
                    let record =
                        parse_record(opcode, data).map_err(|error| Broken::Source(error.to_string()))?;
                    if matches!(record, Record::DataEnd(_)) {
                        return Ok(());
                    }
                    self.keep(record, &mut schemas).map_err(Broken::Target)?;
                }
            }
        }
        Ok(())
    }

    fn keep(
        &mut self,
        record: Record<'_>,
        schemas: &mut BTreeMap<u16, u16>,
    ) -> std::result::Result<(), mcap::McapError> {
        match record {
            Record::Schema { header, data } => {
                let id = self.writer.add_schema(&header.name, &header.encoding, &data)?;
                schemas.insert(header.id, id);
            }
            Record::Channel(channel) => {
                let schema = schemas.get(&channel.schema_id).copied().unwrap_or(0);
                let id = self.writer.add_channel(
                    schema,
                    &channel.topic,
                    &channel.message_encoding,
                    &channel.metadata,
                )?;
                self.channels.insert(channel.id, id);
            }
            Record::Message { mut header, data } => {
                let Some(&id) = self.channels.get(&header.channel_id) else { return Ok(()) };
                header.channel_id = id;
                self.writer.write_to_known_channel(&header, &data)?;
                self.told.messages += 1;
                let (first, last) = self.told.arrived_ns.unwrap_or((header.log_time, header.log_time));
                self.told.arrived_ns = Some((first.min(header.log_time), last.max(header.log_time)));
            }
            Record::Attachment { header, data, .. } => self.writer.attach(&Attachment {
                log_time: header.log_time,
                create_time: header.create_time,
                name: header.name,
                media_type: header.media_type,
                data,
            })?,
            Record::Metadata(metadata) => self.writer.write_metadata(&metadata)?,
            _ => {}
        }
        Ok(())
    }
}
