//! A camera of this machine by V4L2: enters what is wanted of it, leaves frames with the kernel's times. Thin, over the crate `v4l`, which maps the
//! driver's buffers.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use photinus_io::frames::{Frame, Moved};
use photinus_io::{Error, Result};
use rustix::time::{ClockId, clock_gettime};
use v4l::buffer::{Flags, Metadata, Type};
use v4l::capability::Flags as Capabilities;
use v4l::control::{Control, Value};
use v4l::io::mmap::Stream;
use v4l::io::traits::CaptureStream;
use v4l::video::Capture;
use v4l::video::capture::Parameters;
use v4l::{Device, Format, FourCC, Fraction};

use super::{Next, PixelFormat, Source};
use crate::{Entry, HostClock};

// Controls of `v4l2-controls.h`.
const EXPOSURE_AUTO: u32 = 0x009a_0901;
const EXPOSURE_MANUAL: i64 = 1;
const EXPOSURE_ABSOLUTE: u32 = 0x009a_0902;
const EXPOSURE_AUTO_PRIORITY: u32 = 0x009a_0903;
const AUTO_GAIN: u32 = 0x0098_0912;
const GAIN: u32 = 0x0098_0913;
const ANALOGUE_GAIN: u32 = 0x009e_0903;
/// What one step of EXPOSURE_ABSOLUTE is, us.
const EXPOSURE_STEP_US: f64 = 100.0;

/// `POLLIN` of poll(2).
const READABLE: i16 = 1;
/// How often a wait looks whether it is to end.
const LOOK_MS: i32 = 50;
/// A camera that gives no frame for so long is lost.
const SILENCE: Duration = Duration::from_secs(5);
/// Buffers of the driver.
const BUFFERS: u32 = 4;

/// What is wanted of a camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// Such as `/dev/video0`.
    pub path: PathBuf,
    /// Width and height of its calibration, px.
    pub size: [usize; 2],
    /// How pixels are to be laid out; the best that the camera has where nothing is said.
    pub format: Option<PixelFormat>,
    /// Frames a second; as the camera is set where nothing is said.
    pub rate_hz: Option<f64>,
    /// How long frames are exposed, us; as the camera is set where nothing is said.
    pub exposure_us: Option<f64>,
    /// In the driver's own steps; as the camera is set where nothing is said.
    pub gain: Option<i64>,
}

/// A camera that gives frames.
pub struct V4l2 {
    wanted: Wanted,
    device: Device,
    stream: Stream<'static>,
    format: PixelFormat,
    stride: usize,
    clock: HostClock,
    exposure_us: Option<f64>,
    told: String,
    last: Option<u32>,
    is_ended: Arc<AtomicBool>,
}

impl V4l2 {
    /// Opens it and sets what is wanted. `assumed_us` is the exposure of a camera that does not tell it.
    ///
    /// # Errors
    /// [`Error`] when it is no camera, is used by another program, or has no such size, layout or rate.
    pub fn open(wanted: Wanted, clock: HostClock, assumed_us: f64) -> Result<Self> {
        let path = wanted.path.clone();
        let refuse = |error: std::io::Error| Error::new(&path, error);
        let device = Device::with_path(&path).map_err(|error| {
            refuse(error).advise(
                "check the cable, its name (`v4l2-ctl --list-devices`) and that you are in the group `video`",
            )
        })?;
        let no_camera = "it is no V4L2 camera with single planes; its neighbour, such as /dev/video1, may be";
        let caps = device.query_caps().map_err(|error| refuse(error).advise(no_camera))?.capabilities;
        if !caps.contains(Capabilities::VIDEO_CAPTURE | Capabilities::STREAMING) {
            return Err(Error::format(&path, "it gives no stream of frames").advise(no_camera));
        }
        let offered = device.enum_formats().map_err(refuse)?;
        let codes: Vec<[u8; 4]> = offered.iter().map(|format| format.fourcc.repr).collect();
        let (code, format) = chosen(wanted.format, &codes, &path)?;
        let [width, height] = wanted.size;
        let asked = Format::new(width as u32, height as u32, FourCC::new(&code));
        let got = device
            .set_format(&asked)
            .map_err(|error| refuse(error).advise("end the program that uses the camera"))?;
        check(&got, &asked, &device, &path)?;
        let rate =
            set_rate(&device, wanted.rate_hz).map_err(|error| refuse(error).advise("leave rate_hz out"))?;
        let gain = set_gain(&device, wanted.gain).map_err(|error| refuse(error).advise("leave gain out"))?;
        let exposure_us = wanted.exposure_us.map(|us| set_exposure(&device, us));
        let exposure_us = exposure_us.unwrap_or_else(|| read_exposure(&device)).or(wanted.exposure_us);
        let told = format!(
            "{} at {} Hz, exposure {}, gain {}",
            String::from_utf8_lossy(&code).trim_end(),
            or_unknown(rate),
            exposure_us
                .filter(|_| read_exposure(&device).is_some())
                .map_or("not told by the camera".to_owned(), |us| format!("{us} us")),
            or_unknown(gain),
        );
        let mut stream = Stream::with_buffers(&device, Type::VideoCapture, BUFFERS).map_err(refuse)?;
        stream.set_timeout(SILENCE);
        let stride = got.stride as usize;
        let exposure_us = Some(exposure_us.unwrap_or(assumed_us));
        let is_ended = Arc::default();
        Ok(Self { wanted, device, stream, format, stride, clock, exposure_us, told, last: None, is_ended })
    }

    /// Waits for a frame; `None` when it is not to be waited for any more.
    fn wait(&self) -> Option<std::io::Result<()>> {
        // The first frame starts the stream: before it there is nothing to wait for.
        if self.last.is_none() {
            return Some(Ok(()));
        }
        let since = Instant::now();
        while !self.is_ended.load(Ordering::Relaxed) {
            match self.stream.handle().poll(READABLE, LOOK_MS) {
                Ok(0) if since.elapsed() > SILENCE => return Some(Err(std::io::ErrorKind::TimedOut.into())),
                Ok(0) => {}
                Ok(_) => return Some(Ok(())),
                Err(error) => return Some(Err(error)),
            }
        }
        None
    }

    fn take(&mut self) -> Next {
        let name = self.wanted.path.clone();
        let (read, meta) = match self.stream.next() {
            Ok((bytes, meta)) => {
                let used = match meta.bytesused as usize {
                    0 => bytes,
                    used => &bytes[..used.min(bytes.len())],
                };
                (self.format.grey(used, self.wanted.size, self.stride, &name), *meta)
            }
            Err(error) => return Next::Lost(Error::new(&name, error).advise("check the cable")),
        };
        let dropped = self.last.map_or(0, |last| meta.sequence.wrapping_sub(last).saturating_sub(1));
        self.last = Some(meta.sequence);
        if meta.flags.contains(Flags::ERROR) {
            return Next::Bad(
                Error::format(&name, "the driver says that a frame is damaged")
                    .advise("check the cable and the bandwidth"),
            );
        }
        let (image, conversions) = match read {
            Ok(read) => read,
            Err(error) => return Next::Bad(error),
        };
        let exposure_s = 1e-6 * self.exposure_us.unwrap_or(0.0);
        let taken = taken(&meta, exposure_s);
        let time_s = Some(self.clock.unix_s(taken) - exposure_s);
        let source = name.display().to_string();
        let (index, gravity, moved) = (u64::from(meta.sequence), None, Moved::default());
        let frame = Frame { image, index, time_s, source, exposure_s: None, gravity, moved, conversions };
        let mut entry = Entry::from_frame(frame);
        entry.taken = Some(taken);
        entry.exposure_s = Some(exposure_s);
        entry.dropped = u64::from(dropped);
        Next::Frame(entry)
    }
}

impl Source for V4l2 {
    fn next(&mut self) -> Next {
        match self.wait() {
            Some(Ok(())) => self.take(),
            Some(Err(error)) => Next::Lost(Error::new(&self.wanted.path, error).advise("check the cable")),
            None => Next::End,
        }
    }

    fn interrupter(&self) -> Option<Box<dyn Fn() + Send>> {
        let is_ended = Arc::clone(&self.is_ended);
        Some(Box::new(move || is_ended.store(true, Ordering::Relaxed)))
    }

    fn told(&self) -> Option<String> {
        Some(self.told.clone())
    }

    fn expose(&mut self, exposure_us: f64) -> Option<f64> {
        let set_us = set_exposure(&self.device, exposure_us)?;
        self.exposure_us = Some(set_us);
        Some(set_us)
    }
}

/// The layout that is wanted, or else the best one, if the camera offers it.
fn chosen(wanted: Option<PixelFormat>, offered: &[[u8; 4]], path: &Path) -> Result<([u8; 4], PixelFormat)> {
    let fits = offered.iter().copied().filter(|code| {
        wanted.is_none_or(|wanted| PixelFormat::best([*code]).is_some_and(|(_, format)| format == wanted))
    });
    PixelFormat::best(fits).ok_or_else(|| {
        let names: Vec<String> =
            offered.iter().map(|code| String::from_utf8_lossy(code).trim_end().to_owned()).collect();
        let reason = match wanted {
            Some(wanted) => format!(
                "it has no {}, but {}",
                String::from_utf8_lossy(&wanted.code()).trim_end(),
                names.join(", ")
            ),
            None => format!("none of its formats has a grey frame in it: {}", names.join(", ")),
        };
        Error::format(path, reason).advise("name another format, or convert it by a `command`")
    })
}

/// Whether the driver took what was asked for.
fn check(got: &Format, asked: &Format, device: &Device, path: &Path) -> Result<()> {
    if (got.width, got.height) == (asked.width, asked.height) && got.fourcc == asked.fourcc {
        return Ok(());
    }
    let reason = format!(
        "it gives {} x {} px of {} where its calibration is of {} x {} px",
        got.width, got.height, got.fourcc, asked.width, asked.height
    );
    let sizes = device.enum_framesizes(asked.fourcc).unwrap_or_default();
    let discrete = sizes.into_iter().flat_map(|size| size.size.to_discrete());
    let sizes: Vec<String> = discrete.map(|size| format!("{} x {}", size.width, size.height)).collect();
    let advice = match sizes.is_empty() {
        true => "give the calibration of this camera at a size that it has".to_owned(),
        false => format!("give the calibration of this camera at a size that it has: {}", sizes.join(", ")),
    };
    Err(Error::format(path, reason).advise(advice))
}

/// Sets the rate where one is wanted, and reads it back.
fn set_rate(device: &Device, wanted_hz: Option<f64>) -> std::io::Result<Option<f64>> {
    let params = match wanted_hz {
        Some(hz) => device.set_params(&Parameters::new(Fraction::new(1000, (1000.0 * hz).round() as u32)))?,
        None => match device.params() {
            Ok(params) => params,
            // Not every driver knows it.
            Err(_) => return Ok(None),
        },
    };
    let Fraction { numerator, denominator } = params.interval;
    Ok((numerator > 0).then(|| f64::from(denominator) / f64::from(numerator)))
}

/// Sets the gain where one is wanted, and reads it back.
fn set_gain(device: &Device, wanted: Option<i64>) -> std::io::Result<Option<i64>> {
    let Some(wanted) = wanted else { return Ok(read(device, GAIN).or_else(|| read(device, ANALOGUE_GAIN))) };
    // Cameras without automatic gain have no such control.
    let _ = set(device, AUTO_GAIN, 0);
    set(device, GAIN, wanted).or_else(|_| set(device, ANALOGUE_GAIN, wanted))?;
    Ok(read(device, GAIN).or_else(|| read(device, ANALOGUE_GAIN)))
}

/// Sets the exposure, us, by hand, and reads it back; `None` where the camera does not take it in units of time.
fn set_exposure(device: &Device, wanted_us: f64) -> Option<f64> {
    let _ = set(device, EXPOSURE_AUTO, EXPOSURE_MANUAL);
    // The rate must not give way to the exposure.
    let _ = set(device, EXPOSURE_AUTO_PRIORITY, 0);
    let steps = (wanted_us / EXPOSURE_STEP_US).round().max(1.0) as i64;
    set(device, EXPOSURE_ABSOLUTE, steps).ok()?;
    read_exposure(device)
}

fn read_exposure(device: &Device) -> Option<f64> {
    read(device, EXPOSURE_ABSOLUTE).map(|steps| steps as f64 * EXPOSURE_STEP_US)
}

fn set(device: &Device, id: u32, value: i64) -> std::io::Result<()> {
    device.set_control(Control { id, value: Value::Integer(value) })
}

fn read(device: &Device, id: u32) -> Option<i64> {
    match device.control(id).ok()?.value {
        Value::Integer(value) => Some(value),
        Value::Boolean(value) => Some(i64::from(value)),
        _ => None,
    }
}

fn or_unknown(value: Option<impl std::fmt::Display>) -> String {
    value.map_or("an unknown number of".to_owned(), |value| value.to_string())
}

/// When the exposure ended, by the clock of this machine.
fn taken(meta: &Metadata, exposure_s: f64) -> Instant {
    let now = Instant::now();
    let monotonic = clock_gettime(ClockId::Monotonic);
    let now_monotonic = Duration::new(monotonic.tv_sec as u64, monotonic.tv_nsec as u32);
    ended(meta, exposure_s)
        .and_then(|ended| now.checked_sub(now_monotonic.saturating_sub(ended)))
        .unwrap_or(now)
}

/// When the exposure ended by the kernel's steady clock, where its stamp is of that: a stamp is of the end of the frame, or of the start of its exposure.
fn ended(meta: &Metadata, exposure_s: f64) -> Option<Duration> {
    let is_monotonic = meta.flags & Flags::TIMESTAMP_MASK == Flags::TIMESTAMP_MONOTONIC;
    let stamp = Duration::from_secs(u64::try_from(meta.timestamp.sec).ok()?)
        .checked_add(Duration::from_micros(u64::try_from(meta.timestamp.usec).ok()?))?;
    let is_start = meta.flags & Flags::TSTAMP_SRC_MASK == Flags::TSTAMP_SRC_SOE;
    let exposure = if is_start { Duration::try_from_secs_f64(exposure_s).ok()? } else { Duration::ZERO };
    is_monotonic.then_some(stamp + exposure)
}

#[cfg(test)]
mod tests {
    use v4l::Timestamp;

    use super::*;

    fn refused(path: &str) -> String {
        let wanted = Wanted {
            path: path.into(),
            size: [752, 480],
            format: None,
            rate_hz: None,
            exposure_us: None,
            gain: None,
        };
        V4l2::open(wanted, HostClock::start(), 1000.0).err().expect("no camera").to_string()
    }

    #[test]
    fn what_is_no_camera_is_refused_with_what_to_do() {
        let absent = refused("/dev/no-such-camera");
        assert!(
            absent.contains("/dev/no-such-camera: No such file") && absent.contains("check the cable"),
            "{absent}"
        );
        let other = refused("/dev/null");
        assert!(other.contains("/dev/null: ") && other.contains("it is no V4L2 camera"), "{other}");
    }

    #[test]
    fn a_layout_that_the_camera_has_not_is_told_with_those_that_it_has() {
        let offered = [*b"MJPG", *b"YUYV"];
        assert_eq!(chosen(None, &offered, Path::new("c")).unwrap(), (*b"YUYV", PixelFormat::Yuyv));
        assert_eq!(chosen(Some(PixelFormat::Jpeg), &offered, Path::new("c")).unwrap().0, *b"MJPG");
        let told = chosen(Some(PixelFormat::Grey), &offered, Path::new("c")).unwrap_err().to_string();
        assert!(told.contains("it has no GREY, but MJPG, YUYV"), "{told}");
        assert!(chosen(None, &[*b"BA81"], Path::new("c")).unwrap_err().to_string().contains("BA81"));
    }

    #[test]
    fn a_stamp_counts_where_it_is_of_the_steady_clock() {
        let meta =
            |flags: Flags| Metadata { flags, timestamp: Timestamp::new(7, 250_000), ..Metadata::default() };
        let end = Duration::from_millis(7250);
        assert_eq!(ended(&meta(Flags::TIMESTAMP_MONOTONIC), 0.01), Some(end));
        let start = Flags::TIMESTAMP_MONOTONIC | Flags::TSTAMP_SRC_SOE;
        assert_eq!(ended(&meta(start), 0.01), Some(end + Duration::from_millis(10)));
        assert_eq!(ended(&meta(Flags::TIMESTAMP_COPY), 0.01), None);
        assert_eq!(ended(&meta(Flags::TIMESTAMP_UNKNOWN), 0.01), None);
        // A frame that was stamped a moment ago was taken a moment ago.
        let now = clock_gettime(ClockId::Monotonic);
        let recent = Metadata {
            flags: Flags::TIMESTAMP_MONOTONIC,
            timestamp: Timestamp::new(now.tv_sec, now.tv_nsec / 1000),
            ..Metadata::default()
        };
        assert!(taken(&recent, 0.01).elapsed() < Duration::from_secs(1));
    }
}
