//! sensor_msgs. Pixels that are written are borrowed from whoever has them.

use std::borrow::Cow;

use photinus_io::image::{GreyImage, MAX_PIXELS};
use serde::{Deserialize, Serialize};

use super::{Header, Matrix3, Quaternion, Vector3};

/// sensor_msgs/Image.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct Image<'a> {
    pub header: Header,
    pub height: u32,
    pub width: u32,
    pub encoding: String,
    pub is_bigendian: u8,
    pub step: u32,
    #[serde(with = "bytes")]
    pub data: Cow<'a, [u8]>,
}

impl Image<'_> {
    /// The pixels as 8-bit grey: `mono8` as they are, of `mono16` the upper byte.
    ///
    /// # Errors
    /// Why they are no such image: another encoding, or sizes that contradict each other.
    pub fn grey(&self) -> Result<GreyImage, String> {
        let (width, height, step) = (self.width as usize, self.height as usize, self.step as usize);
        let bytes_per_pixel = match self.encoding.as_str() {
            "mono8" | "8UC1" => 1,
            "mono16" | "16UC1" => 2,
            other => return Err(format!("images are encoded as {other}, not mono8 or mono16")),
        };
        if width.checked_mul(height).is_none_or(|pixels| pixels == 0 || pixels > MAX_PIXELS) {
            return Err(format!("no image has {width} x {height} pixels"));
        }
        if step < width * bytes_per_pixel || self.data.len() < step * height {
            return Err(format!("{} bytes are no {width} x {height} pixels", self.data.len()));
        }
        let mut pixels = Vec::with_capacity(width * height);
        for row in self.data.chunks_exact(step).take(height) {
            match bytes_per_pixel {
                1 => pixels.extend_from_slice(&row[..width]),
                _ => {
                    let upper = usize::from(self.is_bigendian == 0);
                    pixels.extend(row[..2 * width].chunks_exact(2).map(|sample| sample[upper]));
                }
            }
        }
        GreyImage::new(pixels, width, height).map_err(|error| error.to_string())
    }
}

/// sensor_msgs/CompressedImage.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct CompressedImage<'a> {
    pub header: Header,
    pub format: String,
    #[serde(with = "bytes")]
    pub data: Cow<'a, [u8]>,
}

/// sensor_msgs/RegionOfInterest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct RegionOfInterest {
    pub x_offset: u32,
    pub y_offset: u32,
    pub height: u32,
    pub width: u32,
    pub do_rectify: bool,
}

/// sensor_msgs/CameraInfo.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct CameraInfo {
    pub header: Header,
    pub height: u32,
    pub width: u32,
    pub distortion_model: String,
    pub d: Vec<f64>,
    pub k: [f64; 9],
    pub r: [f64; 9],
    pub p: [f64; 12],
    pub binning_x: u32,
    pub binning_y: u32,
    pub roi: RegionOfInterest,
}

/// sensor_msgs/Imu.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct Imu {
    pub header: Header,
    pub orientation: Quaternion,
    pub orientation_covariance: Matrix3,
    pub angular_velocity: Vector3,
    pub angular_velocity_covariance: Matrix3,
    pub linear_acceleration: Vector3,
    pub linear_acceleration_covariance: Matrix3,
}

/// Many bytes at once, where serde would write and read them one by one.
mod bytes {
    use std::borrow::Cow;
    use std::fmt;

    use serde::de::{Error, Visitor};
    use serde::{Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer>(bytes: &[u8], to: S) -> Result<S::Ok, S::Error> {
        to.serialize_bytes(bytes)
    }

    pub(super) fn deserialize<'a, 'de, D: Deserializer<'de>>(from: D) -> Result<Cow<'a, [u8]>, D::Error> {
        struct Bytes;
        impl Visitor<'_> for Bytes {
            type Value = Vec<u8>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("bytes")
            }

            fn visit_bytes<E: Error>(self, bytes: &[u8]) -> Result<Vec<u8>, E> {
                Ok(bytes.to_vec())
            }

            fn visit_byte_buf<E: Error>(self, bytes: Vec<u8>) -> Result<Vec<u8>, E> {
                Ok(bytes)
            }
        }
        from.deserialize_byte_buf(Bytes).map(Cow::Owned)
    }
}
