//! The images of a recording as frames: those of our own bit for bit with all that was known of them, those of others with their stamps.

use std::path::Path;

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use photinus::tracking::{Moving, Turned};
use photinus_io::frames::{Frame, Moved, Together};
use photinus_io::image::{GreyImage, decode_image};
use photinus_io::{Error, Place, Result};
use serde::Deserialize;

use super::Topic;
use super::read::{Messages, Recording};
use crate::cdr::{self, CdrError};
use crate::ros::{self, CompressedImage, Image};
use crate::topics;

pub(crate) const RAW: &str = "sensor_msgs/Image";
pub(crate) const COMPRESSED: &str = "sensor_msgs/CompressedImage";
const KNOWN: &str = "photinus_msgs/Frame";

/// A topic with images.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImageTopic {
    /// Its name.
    pub name: String,
    /// How many images it has, where the file counts them.
    pub frames: Option<u64>,
    /// The topic that tells of each image what the image does not.
    known: Option<String>,
}

/// The topics of a recording that hold images, by name.
#[must_use]
pub fn image_topics(recording: &Recording) -> Vec<ImageTopic> {
    topics_of_images(&recording.topics())
}

/// Those of these topics that hold images.
pub(crate) fn topics_of_images(topics: &[Topic]) -> Vec<ImageTopic> {
    let images = topics.iter().filter(|topic| topic.kind == RAW || topic.kind == COMPRESSED);
    let topic = |image: &Topic| {
        let camera = image.name.strip_suffix("/image/compressed").or(image.name.strip_suffix("/image"));
        let known = camera.map(|camera| format!("{camera}/frame"));
        let is_there = |name: &String| topics.iter().any(|topic| topic.kind == KNOWN && topic.name == *name);
        ImageTopic { name: image.name.clone(), frames: image.messages, known: known.filter(is_there) }
    };
    images.map(topic).collect()
}

/// The images of one topic, in order.
pub struct Frames {
    messages: Messages,
    topic: ImageTopic,
    known: Option<ros::Frame>,
    next: u64,
}

/// What one message was.
enum Heard {
    Known(ros::Frame),
    Image(ros::Header, GreyImage),
}

impl Frames {
    /// The frames of `topic`, or of the only one that there is.
    ///
    /// # Errors
    /// [`Error`] when it cannot be opened, has no such topic, or several and none is named.
    pub fn open(path: impl AsRef<Path>, topic: Option<&str>) -> Result<Self> {
        let path = path.as_ref();
        let recording = Recording::open(path)?;
        let topic = chosen(image_topics(&recording), topic, path)?;
        let names = [Some(topic.name.clone()), topic.known.clone()];
        let messages = recording.messages(names.iter().flatten().map(String::as_str), 0)?;
        Ok(Self { messages, topic, known: None, next: 0 })
    }

    /// How many frames there are, where the file counts them.
    #[must_use]
    pub fn total(&self) -> Option<u64> {
        self.topic.frames
    }

    fn frame(&mut self, header: &ros::Header, image: GreyImage) -> Frame {
        let known = self.known.take().filter(|known| known.header == *header);
        let source = || format!("{}:{}", self.messages.path().display(), self.topic.name);
        let frame = Frame {
            image,
            index: known.as_ref().map_or(self.next, |known| known.frame),
            time_s: match &known {
                Some(known) => Some(known.time).filter(|time| time.is_finite()),
                None => Some(header.stamp.seconds()),
            },
            source: known.as_ref().map_or_else(source, |known| known.source.clone()),
            exposure_s: known
                .as_ref()
                .map(|known| known.exposure)
                .filter(|exposure_s| exposure_s.is_finite()),
            gravity: known.as_ref().and_then(|known| down(&known.gravity)),
            moved: known.as_ref().map(moved).unwrap_or_default(),
            conversions: Vec::new(),
        };
        self.next = frame.index + 1;
        frame
    }
}

impl Iterator for Frames {
    type Item = Result<Frame>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let (path, known) = (self.messages.path().to_owned(), self.topic.known.clone());
            let heard = self.messages.next(|topic, bytes| match known.as_deref() == Some(topic) {
                true => {
                    known_of(bytes).map(Heard::Known).map_err(|error| Error::format(&path, error.to_string()))
                }
                false => image(bytes, &path).map(|(header, image)| Heard::Image(header, image)),
            })?;
            match heard.and_then(|heard| heard) {
                Ok(Heard::Known(known)) => self.known = Some(known),
                Ok(Heard::Image(header, image)) => return Some(Ok(self.frame(&header, image))),
                Err(error) => {
                    self.next += 1;
                    return Some(Err(error.at(Place::Frame(self.next - 1))));
                }
            }
        }
    }
}

/// The one that is named, or the only one.
///
/// # Errors
/// [`Error`] when there is none, or several and none is named.
pub(crate) fn chosen(topics: Vec<ImageTopic>, named: Option<&str>, path: &Path) -> Result<ImageTopic> {
    let names = topics.iter().map(|topic| topic.name.as_str()).collect::<Vec<_>>().join(", ");
    let is_meant = |topic: &ImageTopic| {
        let of_camera = |camera| ["image", "image/compressed"].map(|what| topics::of_camera(camera, what));
        named.is_none_or(|named| topic.name == named || of_camera(named).contains(&topic.name))
    };
    let mut meant = topics.into_iter().filter(is_meant);
    match (meant.next(), meant.next(), named) {
        (Some(topic), None, _) => Ok(topic),
        (None, _, _) if names.is_empty() => Err(Error::format(path, "it holds no images")
            .advise("record sensor_msgs/Image, or with `pixels = \"png\"`")),
        (None, _, _) => Err(Error::format(path, format!("it has no images of that name, but {names}"))),
        _ => Err(Error::format(path, format!("it holds several cameras: {names}"))
            .advise("name one of them with --only")),
    }
}

/// The pixels of a message of either type: what begins as an image file is one.
fn image(bytes: &[u8], path: &Path) -> Result<(ros::Header, GreyImage)> {
    let refuse = |reason: String| Error::format(path, reason);
    if let Ok(message) = cdr::decode::<Image<'_>>(bytes)
        && !message.encoding.is_empty()
        && message.data.len() == message.step as usize * message.height as usize
    {
        let image = message.grey().map_err(refuse)?;
        return Ok((message.header, image));
    }
    let message: CompressedImage<'_> =
        cdr::decode(bytes).map_err(|error| refuse(format!("a message is no image: {error}")))?;
    let file = decode_image(&message.data, path)?;
    Ok((message.header, file.image))
}

/// What is known of a frame, also as it stood in recordings of before motions were kept, and of before cameras were followed together.
fn known_of(bytes: &[u8]) -> std::result::Result<ros::Frame, CdrError> {
    cdr::decode(bytes)
        .or_else(|error| cdr::decode(bytes).map(WithMotion::whole).map_err(|_| error))
        .or_else(|error| cdr::decode(bytes).map(Beside::whole).map_err(|_| error))
}

/// photinus_msgs/Frame without motions.
#[derive(Deserialize)]
struct Beside {
    header: ros::Header,
    camera: String,
    frame: u64,
    time: f64,
    exposure: f64,
    source: String,
    gravity: Vec<f64>,
}

/// photinus_msgs/Frame of a camera that is followed by itself.
#[derive(Deserialize)]
struct WithMotion {
    beside: Beside,
    turned: Vec<f64>,
    moving: Vec<f64>,
}

impl Beside {
    fn whole(self) -> ros::Frame {
        let Self { header, camera, frame, time, exposure, source, gravity } = self;
        ros::Frame { header, camera, frame, time, exposure, source, gravity, ..ros::Frame::default() }
    }
}

impl WithMotion {
    fn whole(self) -> ros::Frame {
        ros::Frame { turned: self.turned, moving: self.moving, ..self.beside.whole() }
    }
}

/// How the camera moved, to the bit.
fn moved(known: &ros::Frame) -> Moved {
    let is_sigma = |sigma: f64| sigma.is_finite() && sigma >= 0.0;
    let moving = match *known.moving {
        [x, y, z, sigma_m_s] => Some(Moving { velocity_m_s: Vector3::new(x, y, z), sigma_m_s }),
        _ => None,
    };
    let together = |&order: &u64| Together { order, turned: turned(&known.turned_since_any) };
    Moved {
        turned: turned(&known.turned),
        moving: moving.filter(|own| is_sigma(own.sigma_m_s) && own.velocity_m_s.norm().is_finite()),
        together: known.order.first().map(together),
    }
}

fn turned(numbers: &[f64]) -> Option<Turned> {
    let [a, b, c, d, e, f, g, h, i, sigma_rad] = *numbers else { return None };
    let matrix = Matrix3::new(a, b, c, d, e, f, g, h, i);
    let is_rotation = (matrix * matrix.transpose() - Matrix3::identity()).norm() < 1e-6;
    let is_known = is_rotation && sigma_rad.is_finite() && sigma_rad >= 0.0;
    is_known.then_some(Turned { now_from_before: Rotation3::from_matrix_unchecked(matrix), sigma_rad })
}

fn down(gravity: &[f64]) -> Option<Unit<Vector3<f64>>> {
    let [x, y, z] = *gravity else { return None };
    let down = Vector3::new(x, y, z);
    // As it was told, to the bit; what is not a unit vector is left out.
    ((down.norm() - 1.0).abs() < 0.01).then(|| Unit::new_unchecked(down))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_known_of_a_frame_is_read_from_recordings_made_before_motions_were_kept() {
        for gravity in [vec![], vec![0.0, 1.0, 0.0]] {
            let frame =
                ros::Frame { frame: 7, time: 0.5, source: "a".to_owned(), gravity, ..ros::Frame::default() };
            let now = cdr::encode(&frame).unwrap();
            // Lists without an entry are their lengths.
            let [before, with_motion] = [16, 8].map(|lists| &now[..now.len() - lists]);
            assert_eq!(known_of(before).unwrap(), frame);
            assert_eq!(known_of(with_motion).unwrap(), frame);
            assert_eq!(known_of(&now).unwrap(), frame);
            assert!(known_of(&before[..before.len() - 5]).is_err());
            assert_eq!(moved(&frame), Moved::default());
        }
    }

    #[test]
    fn motions_that_are_none_are_left_out() {
        let of = |turned: [f64; 10], moving: [f64; 4]| {
            moved(&ros::Frame { turned: turned.to_vec(), moving: moving.to_vec(), ..ros::Frame::default() })
        };
        let still = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1e-3];
        let told = of(still, [1.0, 2.0, 3.0, 0.1]);
        assert!(
            told.turned.is_some_and(|turned| (turned.sigma_rad - 1e-3).abs() < 1e-15)
                && told.moving.is_some()
        );
        let stretched = [2.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1e-3];
        assert_eq!(of(stretched, [f64::NAN, 2.0, 3.0, 0.1]), Moved::default());
        assert_eq!(of([f64::NAN; 10], [1.0, 2.0, 3.0, -0.1]), Moved::default());
    }
}
