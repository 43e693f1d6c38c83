//! What a user may choose, with the program's names and defaults: a structure of C -> settings of the method.

use std::ffi::c_char;

use photinus::locator::Settings;
use photinus::pose;
use photinus::ranging::SpotCurve;
use photinus::spots::{self, Brightness};
use photinus_io::airframe::Tolerances;
use photinus_io::spot_curve::{SpotCurveFile, read_spot_curve};

use crate::border::{Refusal, Result, Status, cross};
use crate::camera::file;
use crate::pointers::{self, Place};

/// What a user may choose about locating. Get one from `photinus_default_options`, then change what should be different.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// `sizeof(PhotinusOptions)`, by which the library knows that caller and library mean the same structure.
    pub size: usize,
    /// Grey levels above the measured background from which on a pixel is bright, 0 to 255; negative: the default.
    pub contrast: i32,
    /// Fixed grey level from which on a pixel is bright, 0 to 255, in place of contrast; negative: none.
    pub threshold: i32,
    /// Share of the brightest spot's light at which a fainter one is as likely a reflection as a marker.
    pub reflection_ratio: f64,
    /// Largest tilt of a neighbour that the bounds allow for where gravity is known, deg.
    pub max_tilt_deg: f64,
    /// Neighbours less likely are left out, 0 to 1.
    pub min_probability: f64,
    /// Most looks at a handful of spots per frame.
    pub budget: u32,
    /// Not 0: leave brightness out of the pose.
    pub no_brightness: u32,
    /// How far neighbours tilt, standard deviation, deg.
    pub tilt_sigma_deg: f64,
    /// How far LEDs are from where the airframe says, m; NaN: what its file says, else 0.003.
    pub marker_sigma_m: f64,
    /// Spread of the power of LEDs, a share; NaN: what the airframe's file says, else 0.2.
    pub power_spread: f64,
    /// Spread of the size of the airframe, a share.
    pub scale_sigma: f64,
    /// How often a marker does not show, a share, before frames tell it.
    pub miss_rate: f64,
    /// A TOML file with the curve of spot sizes, or "paper" for the paper's; null: none. Needed while the locator is opened only.
    pub spot_curve: *const c_char,
    /// Not 0: follow vehicles from frame to frame; every frame then needs its time.
    pub tracks: u32,
}

impl Options {
    fn new() -> Self {
        let (spots, pose) = (spots::Settings::default(), pose::Settings::default());
        Self {
            size: size_of::<Self>(),
            contrast: -1,
            threshold: -1,
            reflection_ratio: spots.shape.reflection_ratio,
            max_tilt_deg: 15.0,
            min_probability: Settings::DEFAULT_MIN_PROBABILITY,
            budget: Settings::DEFAULT_BUDGET,
            no_brightness: 0,
            tilt_sigma_deg: 5.0,
            marker_sigma_m: f64::NAN,
            power_spread: f64::NAN,
            scale_sigma: pose.scale_sigma,
            miss_rate: pose.missed,
            spot_curve: std::ptr::null(),
            tracks: 0,
        }
    }

    /// The options behind a pointer; the defaults where it is null.
    ///
    /// # Safety
    /// As [`pointers::read`].
    pub(crate) unsafe fn read(pointer: *const Self) -> Result<Self> {
        if pointer.is_null() {
            return Ok(Self::new());
        }
        // The size stands first, so that a shorter structure is not read past its end.
        // SAFETY: the caller promises it.
        let size = unsafe { pointers::read(pointer.cast::<usize>(), "the options")? };
        if size != size_of::<Self>() {
            return refuse(format!(
                "the options have a size of {size} bytes, this library's have {}; fill them by photinus_default_options, and compile \
                 with the header of this library",
                size_of::<Self>()
            ));
        }
        // SAFETY: the caller promises it.
        unsafe { pointers::read(pointer, "the options") }
    }

    /// The settings of the method, and the curve of spot sizes.
    ///
    /// # Safety
    /// `spot_curve` is null or a text that ends with a zero.
    pub(crate) unsafe fn settings(&self, tolerances: Tolerances) -> Result<(Settings, Option<SpotCurve>)> {
        let given = |value: f64| (!value.is_nan()).then_some(value);
        let brightness = self.brightness()?;
        let mut settings = Settings::default();
        settings.spots.brightness = brightness;
        settings.spots.shape.reflection_ratio = self.reflection_ratio;
        settings.max_tilt_rad = self.max_tilt_deg.to_radians();
        let pose = &mut settings.pose;
        pose.tilt_sigma_rad = self.tilt_sigma_deg.to_radians();
        pose.marker_sigma_m =
            given(self.marker_sigma_m).or(tolerances.position_sigma_m).unwrap_or(pose.marker_sigma_m);
        pose.unit_sigma = given(self.power_spread).or(tolerances.power_sigma).unwrap_or(pose.unit_sigma);
        pose.scale_sigma = self.scale_sigma;
        pose.missed = self.miss_rate;
        pose.use_brightness = self.no_brightness == 0;
        settings.min_probability = self.min_probability;
        settings.budget = self.budget;
        if self.spot_curve.is_null() {
            return Ok((settings, None));
        }
        // SAFETY: the caller promises it.
        let name = unsafe { pointers::text(self.spot_curve, "the spot curve's path")? };
        Ok((settings, Some(spot_curve(name, brightness)?)))
    }

    fn brightness(&self) -> Result<Brightness> {
        let level = |value: i32, name: &str| match u8::try_from(value) {
            Ok(level) => Ok(Some(level)),
            Err(_) if value < 0 => Ok(None),
            Err(_) => refuse(format!("a {name} of {value}: it must be 0 to 255, or negative for none")),
        };
        match (level(self.threshold, "threshold")?, level(self.contrast, "contrast")?) {
            (Some(_), Some(_)) => refuse("contrast and threshold are given: keep one of them".to_owned()),
            (Some(level), None) => Ok(Brightness::Threshold(level)),
            (None, Some(step)) => Ok(Brightness::Contrast(step)),
            (None, None) => Ok(Brightness::default()),
        }
    }
}

fn refuse<T>(message: String) -> Result<T> {
    Err(Refusal::new(Status::Setting, message))
}

/// The curve of a file. C has no warnings, so that one measured with another threshold is an error: bounds by it would be wrong.
fn spot_curve(name: &str, brightness: Brightness) -> Result<SpotCurve> {
    let curve = match name {
        "paper" => SpotCurveFile::paper_1000_us(),
        path => read_spot_curve(path).map_err(file)?,
    };
    match curve.threshold {
        Some(level) if brightness != Brightness::Threshold(level) => refuse(format!(
            "the spot curve was measured with a threshold of {level}: set threshold to {level}, or bounds that come from spot sizes are wrong"
        )),
        _ => Ok(curve.curve),
    }
}

/// Fills in what the program `photinus locate` takes by default.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn photinus_default_options(options: *mut Options) -> Status {
    cross(|| {
        // SAFETY: as the header asks of its pointers.
        unsafe { Place::new(options, "the options")? }.put(Options::new());
        Ok(())
    })
}
