//! Records of a bag, each a header of fields `name=value` and data, both behind their length: bytes in, fields out. All numbers are little
//! endian.

/// A record in the bytes that hold it.
#[derive(Clone, Copy)]
pub(super) struct Record<'a> {
    fields: &'a [u8],
    /// What follows the header.
    pub(super) data: &'a [u8],
}

impl<'a> Record<'a> {
    /// The record at the beginning of `bytes`, and what follows it; `None` where they hold no whole one.
    pub(super) fn split(bytes: &'a [u8]) -> Option<(Self, &'a [u8])> {
        let (fields, rest) = sized(bytes)?;
        let (data, rest) = sized(rest)?;
        Some((Self { fields, data }, rest))
    }

    /// The value of a field of its header.
    pub(super) fn field(&self, name: &str) -> Option<&'a [u8]> {
        field(self.fields, name)
    }

    /// What kind of record it is.
    pub(super) fn kind(&self) -> Option<u8> {
        let [kind] = *self.field("op")? else { return None };
        Some(kind)
    }

    /// A field that is a number of four bytes.
    pub(super) fn u32(&self, name: &str) -> Option<u32> {
        self.field(name)?.try_into().ok().map(u32::from_le_bytes)
    }

    /// A field that is a number of eight bytes.
    pub(super) fn u64(&self, name: &str) -> Option<u64> {
        self.field(name)?.try_into().ok().map(u64::from_le_bytes)
    }

    /// A field that is a time, in ns.
    pub(super) fn time_ns(&self, name: &str) -> Option<u64> {
        let (seconds, rest) = self.field(name)?.split_first_chunk()?;
        let nanoseconds = u32::from_le_bytes(rest.try_into().ok()?);
        Some(u64::from(u32::from_le_bytes(*seconds)) * 1_000_000_000 + u64::from(nanoseconds))
    }
}

/// All records of these bytes, with `None` in the place of what is not a record.
pub(super) fn records(mut bytes: &[u8]) -> impl Iterator<Item = Option<Record<'_>>> {
    std::iter::from_fn(move || {
        if bytes.is_empty() {
            return None;
        }
        let split = Record::split(bytes);
        bytes = split.map_or(&[], |(_, rest)| rest);
        Some(split.map(|(record, _)| record))
    })
}

/// The value of a field in the bytes of a header.
pub(super) fn field<'a>(mut fields: &'a [u8], name: &str) -> Option<&'a [u8]> {
    loop {
        let (field, rest) = sized(fields)?;
        if let Some(value) = field.strip_prefix(name.as_bytes()).and_then(|rest| rest.strip_prefix(b"=")) {
            return Some(value);
        }
        fields = rest;
    }
}

/// The bytes behind a length of four bytes, and what follows them.
pub(super) fn sized(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = bytes.split_first_chunk()?;
    rest.split_at_checked(u32::from_le_bytes(*length) as usize)
}
