//! A dialogue, held on a serial line.

use std::io::ErrorKind;
use std::path::Path;
use std::time::{Duration, Instant};

use photinus_io::{Error, Result};
use serial2::SerialPort;

use super::{Dialogue, Outcome, Step};

/// Of boards of UVDAR, bits a second.
const BAUD: u32 = 115_200;
/// How long is listened before it is looked what is due.
const LISTEN: Duration = Duration::from_millis(5);

/// Opens a serial port such as `/dev/ttyUSB0`.
///
/// # Errors
/// [`Error`] when it is not there, or may not be used.
pub fn open(path: &Path) -> Result<SerialPort> {
    let advice = "check the cable, its name (`ls /dev/tty*`) and that you are in the group `dialout`";
    let mut port = SerialPort::open(path, BAUD).map_err(|error| Error::new(path, error).advise(advice))?;
    port.set_read_timeout(LISTEN).map_err(|error| Error::new(path, error))?;
    Ok(port)
}

/// Holds the dialogue; `None` when `is_over` ended it.
///
/// # Errors
/// [`Error`] when the port fails; `name` is for the message.
pub fn drive(
    port: &SerialPort,
    name: &Path,
    mut dialogue: Dialogue,
    is_over: &dyn Fn() -> bool,
) -> Result<Option<Outcome>> {
    let began = Instant::now();
    let (mut room, mut count) = ([0; 256], 0);
    while !is_over() {
        match dialogue.step(began.elapsed().as_secs_f64(), &room[..count]) {
            Step::Send(bytes) => port.write_all(&bytes).map_err(|error| Error::new(name, error))?,
            Step::Wait => {}
            Step::Done(outcome) => return Ok(Some(outcome)),
        }
        count = match port.read(&mut room) {
            Ok(count) => count,
            Err(error)
                if matches!(
                    error.kind(),
                    ErrorKind::TimedOut | ErrorKind::Interrupted | ErrorKind::WouldBlock
                ) =>
            {
                0
            }
            Err(error) => return Err(Error::new(name, error)),
        };
    }
    Ok(None)
}
