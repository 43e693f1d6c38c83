//! Faults wrap the input: frames that are in order enter, frames as a bad day gives them leave.
//!
//! ```text
//! light      gain, blur, smear, lamp, dead_led      what reaches the pixels
//! sensor     noise, hot, jpeg, mirror               what the camera makes of it
//! transport  dropped, duplicated, swapped, torn     what becomes of a frame on its way
//! told       gravity, scaled (airframe, focal)      what the method is told beside the pixels
//! ```
//!
//! A [`Fault`] is named by a word ([`Fault::WORDS`]); [`Faults`] are some of them in an order, with a seed. Every fault
//! takes 8-bit frames and gives 8-bit frames, so that it works on recordings as on simulations, and every one rounds. A
//! simulator can do better where light is concerned: it knows what a saturated pixel hides, and what an LED that is dead left
//! dark. Truth stays what it was, save that a painted-out LED no longer shines into the image; that of a dropped frame goes with it.
//! Random numbers are a function of seed, place of the fault in the list, frame and pixel.

mod blur;
mod chance;
mod dead_led;
mod gain;
mod gravity;
mod hot;
mod jpeg;
mod lamp;
mod mirror;
mod noise;
mod scaled;
mod smear;
mod transport;
mod words;

use photinus::airframe::{Airframe, AirframeError};
use photinus::camera::{Camera, CameraError};
use photinus_io::Result;
use photinus_io::dataset::TruthFrame;
use photinus_io::frames::Frame;
use photinus_io::image::GreyImage;

use chance::Chance;
pub use lamp::Lamp;
pub use words::WordError;

/// A frame and, where it is known, what was there.
#[derive(Clone, Debug, PartialEq)]
pub struct Shot {
    /// The frame.
    pub frame: Frame,
    /// Where everything was.
    pub truth: Option<TruthFrame>,
}

/// Shots on their way through faults; one that could not be read is an error in its place.
pub type Shots<'a> = Box<dyn Iterator<Item = Result<Shot>> + 'a>;

/// Something that goes wrong. The words in brackets are those of [`Fault::WORDS`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// Grey levels times this (`gain=0.5`).
    Gain(f64),
    /// Normal noise of this sigma on every pixel, grey levels (`noise=8`).
    Noise(f64),
    /// Written as a baseline JPEG of this quality, 1 to 100, and read back (`jpeg=50`).
    Jpeg(u8),
    /// A Gaussian blur of this sigma, px (`blur=1.5`).
    Blur(f64),
    /// Light drawn out evenly along a line (`smear=6`, `smear=6@90`).
    Smear {
        /// Its length, px.
        length_px: f64,
        /// Its direction in the image, from right towards down, rad.
        direction_rad: f64,
    },
    /// This many pixels of the sensor are hot: the same ones in every frame, each 60 to 255 grey levels up (`hot=30`).
    Hot(usize),
    /// A lamp that is not a marker (`lamp=fixed`, `lamp=400,200`, `lamp=25px-beside`).
    Lamp(Lamp),
    /// The LED of this number of every neighbour is painted out, by the truth (`dead-led=2`).
    DeadLed(u32),
    /// The direction of gravity is off by this angle, rad, the same way in every frame (`gravity=20`, in degrees).
    Gravity(f64),
    /// The airframe that is told is larger than the true one by this factor (`airframe=1.02`).
    Airframe(f64),
    /// The focal length that is told is longer than the true one by this factor (`focal=1.02`).
    Focal(f64),
    /// Left and right are exchanged (`mirrored`).
    Mirrored,
    /// This share of the frames never comes (`dropped=0.1`).
    Dropped(f64),
    /// This share of the frames shows the pixels of the one before (`duplicated=0.1`).
    Duplicated(f64),
    /// With this probability a frame and the next one have exchanged their pixels (`swapped=0.1`).
    Swapped(f64),
    /// This share of the frames shows the pixels of the one before from some row on (`torn=0.1`).
    Torn(f64),
}

/// Faults in the order in which they happen, and where their random numbers start.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Faults {
    /// What goes wrong.
    pub list: Vec<Fault>,
    /// The same seed gives the same bytes.
    pub seed: u64,
}

impl Faults {
    /// The shots, with all that goes wrong with them.
    pub fn inject<'a>(&self, shots: impl Iterator<Item = Result<Shot>> + 'a) -> Shots<'a> {
        let wrap = |shots, (place, fault): (u64, &Fault)| fault.wrap(shots, Chance::new(self.seed, place));
        (0..).zip(&self.list).fold(Box::new(shots), wrap)
    }

    /// The airframe as it is told.
    ///
    /// # Errors
    /// [`AirframeError`] when what is told makes no airframe.
    pub fn airframe(&self, airframe: &Airframe) -> std::result::Result<Airframe, AirframeError> {
        self.list.iter().try_fold(airframe.clone(), |airframe, fault| match fault {
            Fault::Airframe(factor) => scaled::airframe(&airframe, *factor),
            _ => Ok(airframe),
        })
    }

    /// The camera as it is told.
    ///
    /// # Errors
    /// [`CameraError`] when what is told makes no camera.
    pub fn camera(&self, camera: &Camera) -> std::result::Result<Camera, CameraError> {
        self.list.iter().try_fold(camera.clone(), |camera, fault| match fault {
            Fault::Focal(factor) => scaled::camera(&camera, *factor),
            _ => Ok(camera),
        })
    }
}

impl Fault {
    /// Whether it needs to know where markers are.
    pub fn needs_truth(&self) -> bool {
        matches!(self, Self::DeadLed(_) | Self::Lamp(Lamp::Beside { .. }))
    }

    fn wrap(self, shots: Shots<'_>, chance: Chance) -> Shots<'_> {
        match self {
            Self::Gain(factor) => pictures(shots, move |image, _| gain::apply(image, factor)),
            Self::Noise(sigma_dn) => {
                pictures(shots, move |image, frame| noise::apply(image, sigma_dn, &chance.of_frame(frame)))
            }
            Self::Jpeg(quality) => {
                Box::new(shots.map(move |shot| shot.and_then(|shot| jpeg::apply(shot, quality))))
            }
            Self::Blur(sigma_px) => {
                let kernel = blur::Kernel::new(sigma_px);
                pictures(shots, move |image, _| kernel.apply(image))
            }
            Self::Smear { length_px, direction_rad } => {
                let kernel = smear::Kernel::new(length_px, direction_rad);
                pictures(shots, move |image, _| kernel.apply(image))
            }
            Self::Hot(count) => pictures(shots, move |image, _| hot::apply(image, count, &chance)),
            Self::Lamp(lamp) => each(shots, move |shot| lamp.light(shot, &chance)),
            Self::DeadLed(led) => each(shots, move |shot| dead_led::paint_out(shot, led)),
            Self::Gravity(angle_rad) => each(shots, move |shot| {
                shot.frame.gravity = shot.frame.gravity.map(|down| gravity::turn(&down, angle_rad, &chance));
            }),
            Self::Airframe(_) | Self::Focal(_) => shots,
            Self::Mirrored => pictures(shots, |image, _| mirror::apply(image)),
            Self::Dropped(share) => transport::dropped(shots, share, chance),
            Self::Duplicated(share) => transport::duplicated(shots, share, chance),
            Self::Swapped(share) => Box::new(transport::Swapped::new(shots, share, chance)),
            Self::Torn(share) => transport::torn(shots, share, chance),
        }
    }
}

/// What happens to every shot by itself.
fn each<'a>(shots: Shots<'a>, mut happen: impl FnMut(&mut Shot) + 'a) -> Shots<'a> {
    Box::new(shots.map(move |shot| {
        shot.map(|mut shot| {
            happen(&mut shot);
            shot
        })
    }))
}

/// What happens to every image by itself; the number of the frame goes along.
fn pictures<'a>(shots: Shots<'a>, change: impl Fn(&GreyImage, u64) -> GreyImage + 'a) -> Shots<'a> {
    each(shots, move |shot| shot.frame.image = change(&shot.frame.image, shot.frame.index))
}

/// The image of the same size with these pixels.
fn repainted(image: &GreyImage, pixels: Vec<u8>) -> GreyImage {
    GreyImage::new(pixels, image.width(), image.height()).expect("as many pixels as before")
}

/// The nearest grey level.
fn to_grey(level: f64) -> u8 {
    // Saturates at both ends.
    level.round() as u8
}

#[cfg(test)]
mod tests;
