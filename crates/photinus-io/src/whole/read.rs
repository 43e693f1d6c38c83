//! A file read whole: enters a path, leaves its bytes or its text.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::{Error, Result};

/// Larger than the largest image that is accepted; a device that never ends stops here.
const MAX_FILE_BYTES: u64 = 1 << 30;

/// The bytes of a file that is neither missing nor empty nor endless; `-` is standard input.
pub(crate) fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    match path.as_os_str() == "-" {
        true => bytes_of(std::io::stdin(), path),
        false => bytes_of(open_regular(path)?, path),
    }
}

/// Opens a file that has an end: a pipe would be waited for, a device may never end.
///
/// # Errors
/// [`Error`] when it is missing, a pipe or a device.
pub fn open_regular(path: impl AsRef<Path>) -> Result<File> {
    let path = path.as_ref();
    let metadata = std::fs::metadata(path).map_err(|error| Error::io(path, error))?;
    if !metadata.is_file() && !metadata.is_dir() {
        return Err(Error::format(path, "this is a pipe or a device, no file")
            .advise("name a file; what comes through a pipe is read from standard input, as `-`"));
    }
    File::open(path).map_err(|error| Error::io(path, error))
}

fn bytes_of(source: impl Read, path: &Path) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    source.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes).map_err(|error| Error::io(path, error))?;
    if bytes.is_empty() {
        return Err(Error::format(path, "the file is empty").advise("write it again: a copy may have failed"));
    }
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(Error::format(path, format!("the file is larger than {MAX_FILE_BYTES} bytes"))
            .advise("check that this is the file that was meant"));
    }
    Ok(bytes)
}

/// The text of a file, without the byte order mark that some editors add.
pub fn read_text(path: impl AsRef<Path>) -> Result<String> {
    let path = path.as_ref();
    let text = String::from_utf8(read_bytes(path)?).map_err(|error| {
        Error::format(path, format!("byte {} is not UTF-8 text", error.utf8_error().valid_up_to()))
            .advise("check that this is the text file that was meant, and save it as UTF-8")
    })?;
    Ok(match text.strip_prefix('\u{feff}') {
        Some(rest) => rest.to_owned(),
        None => text,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_file_says_what_to_check() {
        let message = read_text(Path::new("no/such/file.txt")).unwrap_err().to_string();
        assert!(message.starts_with("no/such/file.txt: "), "{message}");
        assert!(message.ends_with("; check the path, which is taken from the current folder"), "{message}");
    }

    #[cfg(unix)]
    #[test]
    fn a_device_is_no_file() {
        let message = read_bytes(Path::new("/dev/zero")).unwrap_err().to_string();
        assert!(message.starts_with("/dev/zero: this is a pipe or a device, no file; "), "{message}");
    }

    #[test]
    fn an_empty_file_and_bytes_that_are_no_text_are_refused() {
        let folder = crate::scratch::Folder::new("whole");
        let (empty, binary) = (folder.file("empty", b""), folder.file("binary", b"ab\xff\xfe"));
        assert!(read_bytes(&empty).unwrap_err().to_string().contains("the file is empty; "));
        assert!(read_text(&binary).unwrap_err().to_string().contains("byte 2 is not UTF-8 text; "));
    }

    #[test]
    fn a_byte_order_mark_is_dropped() {
        let folder = crate::scratch::Folder::new("bom");
        assert_eq!(read_text(folder.file("bom", b"\xef\xbb\xbfname")).unwrap(), "name");
    }
}
