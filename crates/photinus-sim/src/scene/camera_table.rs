//! `[optics]` and `[sensor]`: what a scene changes of its preset's lens and sensor.
//!
//! Each table may name a file that holds the same keys; what stands beside it in the scene counts more. Every number is within
//! what lenses and sensors have, or its key is named.

use std::path::{Path, PathBuf};

use photinus_io::{Error, Result, table as toml_table};
use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::check::Check;
use crate::optics::{Gaussian, Lens, PointSpread, SampledSpread, Vignette};
use crate::sensor::{Converter, Response, Sensor, Shutter};

/// Keys of `[optics]`.
#[derive(Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OpticsTable {
    file: Option<PathBuf>,
    spread: Option<SpreadTable>,
    widening_per_rad2: Option<f64>,
    elongation_per_rad2: Option<f64>,
    coma_px_per_rad: Option<f64>,
    axis_coma_px: Option<[f64; 2]>,
    pupil_mm: Option<f64>,
    transmission: Option<f64>,
    side_illumination: Option<f64>,
    vignette: Option<VignetteTable>,
    veiling_glare: Option<f64>,
}

#[derive(Clone, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum SpreadTable {
    Gaussian { sigma_px: f64 },
    CoreAndHalo { core_px: f64, halo_px: f64, halo_share: f64 },
    Gaussians(Vec<PartTable>),
    Moffat { fwhm_px: f64, beta: f64 },
    Table { file: PathBuf },
}

#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct PartTable {
    share: f64,
    sigma_px: f64,
}

#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct VignetteTable {
    clear_deg: f64,
    dark_deg: f64,
}

/// A measured point spread.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SampledTable {
    samples_per_px: usize,
    rows: Vec<Vec<f64>>,
}

/// Keys of `[sensor]`.
#[derive(Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SensorTable {
    file: Option<PathBuf>,
    quantum_efficiency: Option<f64>,
    electrons_per_dn: Option<f64>,
    full_reads_dn: Option<f64>,
    full_spread: Option<f64>,
    full_noise_dn: Option<f64>,
    soft_ceiling_dn: Option<f64>,
    spill: Option<f64>,
    column_smear: Option<f64>,
    read_noise_e: Option<f64>,
    dark_offset_dn: Option<f64>,
    corner_offset_dn: Option<f64>,
    dark_current_e_per_s: Option<f64>,
    offset_pattern_dn: Option<f64>,
    column_pattern_dn: Option<f64>,
    gain_pattern: Option<f64>,
    hot_pixel_share: Option<f64>,
    hot_pixel_e_per_s: Option<f64>,
    bits: Option<u32>,
    rolling_line_us: Option<f64>,
}

/// Narrowest and widest part of a point spread, px.
const WIDTHS_PX: (f64, f64) = (0.05, 30.0);

impl OpticsTable {
    /// Changes a lens.
    pub(super) fn apply(&self, check: &Check<'_>, lens: &mut Lens) -> Result<()> {
        if let Some(file) = &self.file {
            let path = named(check, "optics.file", file)?;
            let table: Self = read(&path)?;
            no_file_in_a_file(&path, "file", table.file.is_none())?;
            table.change(&Check { path: &path }, "", lens)?;
        }
        self.change(check, "optics.", lens)
    }

    fn change(&self, check: &Check<'_>, owner: &str, lens: &mut Lens) -> Result<()> {
        let key = |name: &str| format!("{owner}{name}");
        let number = |name: &str, value: Option<f64>, range: (f64, f64), onto: &mut f64| -> Result<()> {
            value.map_or(Ok(()), |value| check.within(&key(name), value, range).map(|value| *onto = value))
        };
        let mut aberrations = *lens.spread.aberrations();
        number("widening_per_rad2", self.widening_per_rad2, (0.0, 10.0), &mut aberrations.widening_per_rad2)?;
        number(
            "elongation_per_rad2",
            self.elongation_per_rad2,
            (0.0, 10.0),
            &mut aberrations.elongation_per_rad2,
        )?;
        number("coma_px_per_rad", self.coma_px_per_rad, (-10.0, 10.0), &mut aberrations.coma_px_per_rad)?;
        for (axis, onto) in aberrations.axis_coma_px.iter_mut().enumerate() {
            number("axis_coma_px", self.axis_coma_px.map(|px| px[axis]), (-10.0, 10.0), onto)?;
        }
        let shape = match &self.spread {
            Some(table) => table.read(check, &key("spread"))?,
            None => lens.spread.clone(),
        };
        lens.spread = shape
            .with_aberrations(aberrations)
            .ok_or_else(|| check.refuse(&key("spread"), "no lens spreads light like that"))?;
        if let Some(pupil_mm) = self.pupil_mm {
            let pupil_mm = check.within(&key("pupil_mm"), pupil_mm, (0.01, 100.0))?;
            lens.pupil_m2 = core::f64::consts::FRAC_PI_4 * pupil_mm * pupil_mm * 1e-6;
        }
        number("transmission", self.transmission, (1e-6, 1.0), &mut lens.transmission)?;
        number("side_illumination", self.side_illumination, (0.0, 1.0), &mut lens.side_illumination)?;
        number("veiling_glare", self.veiling_glare, (0.0, 1.0), &mut lens.veiling_glare)?;
        if let Some(VignetteTable { clear_deg, dark_deg }) = self.vignette {
            let vignette = Vignette::new(clear_deg.to_radians(), dark_deg.to_radians()).ok_or_else(|| {
                let reason = format!("from {clear_deg} to {dark_deg} deg cuts off no light");
                check.refuse(&key("vignette"), reason).advise("give 0 <= clear_deg < dark_deg <= 180")
            })?;
            lens.vignette = Some(vignette);
        }
        Ok(())
    }
}

impl SpreadTable {
    fn read(&self, check: &Check<'_>, owner: &str) -> Result<PointSpread> {
        let width = |name: &str, px: f64| check.within(&format!("{owner}.{name}"), px, WIDTHS_PX);
        let parts = match self {
            Self::Gaussian { sigma_px } => {
                vec![Gaussian { share: 1.0, sigma_px: width("gaussian.sigma_px", *sigma_px)? }]
            }
            Self::CoreAndHalo { core_px, halo_px, halo_share } => {
                let halo_share = check.within(
                    &format!("{owner}.core_and_halo.halo_share"),
                    *halo_share,
                    (1e-6, 0.999_999),
                )?;
                vec![
                    Gaussian { share: 1.0 - halo_share, sigma_px: width("core_and_halo.core_px", *core_px)? },
                    Gaussian { share: halo_share, sigma_px: width("core_and_halo.halo_px", *halo_px)? },
                ]
            }
            Self::Gaussians(parts) => {
                let part = |(i, part): (usize, &PartTable)| -> Result<Gaussian> {
                    let share = format!("{owner}.gaussians[{i}].share");
                    let share = check.within(&share, part.share, (1e-9, 1.0))?;
                    Ok(Gaussian {
                        share,
                        sigma_px: width(&format!("gaussians[{i}].sigma_px"), part.sigma_px)?,
                    })
                };
                parts.iter().enumerate().map(part).collect::<Result<_>>()?
            }
            Self::Moffat { fwhm_px, beta } => {
                let fwhm_px = width("moffat.fwhm_px", *fwhm_px)?;
                let key = format!("{owner}.moffat.beta");
                let beta = check.within(&key, *beta, (1.25, 20.0))?;
                return PointSpread::moffat(fwhm_px, beta)
                    .ok_or_else(|| check.refuse(&key, "no such profile"));
            }
            Self::Table { file } => {
                return read_sampled(&named(check, &format!("{owner}.table.file"), file)?)
                    .map(PointSpread::sampled);
            }
        };
        PointSpread::new(parts, 0.0).ok_or_else(|| {
            check.refuse(owner, "the shares do not sum to 1").advise("correct the shares of the parts")
        })
    }
}

/// Reads a measured point spread: `samples_per_px` and `rows`, see docs/scenes.md.
fn read_sampled(path: &Path) -> Result<SampledSpread> {
    let text = std::fs::read_to_string(path).map_err(|error| Error::io(path, error))?;
    parse_sampled(&text, path)
}

/// The same from its text; `path` is for messages.
pub(crate) fn parse_sampled(text: &str, path: &Path) -> Result<SampledSpread> {
    let SampledTable { samples_per_px, rows } = toml_table::parse(text, path)?;
    SampledSpread::new(samples_per_px, &rows).ok_or_else(|| {
        Error::format(path, "the rows make no point spread").advise(
            "give a square of numbers, none negative, with an odd side of more than 2 pixels and 1 to 16 samples per pixel",
        )
    })
}

impl SensorTable {
    /// Changes a sensor.
    pub(super) fn apply(&self, check: &Check<'_>, sensor: &mut Sensor) -> Result<()> {
        if let Some(file) = &self.file {
            let path = named(check, "sensor.file", file)?;
            let table: Self = read(&path)?;
            no_file_in_a_file(&path, "file", table.file.is_none())?;
            table.change(&Check { path: &path }, "", sensor)?;
        }
        self.change(check, "sensor.", sensor)
    }

    fn change(&self, check: &Check<'_>, owner: &str, sensor: &mut Sensor) -> Result<()> {
        let key = |name: &str| format!("{owner}{name}");
        let number = |name: &str, value: Option<f64>, range: (f64, f64), onto: &mut f64| -> Result<()> {
            value.map_or(Ok(()), |value| check.within(&key(name), value, range).map(|value| *onto = value))
        };
        // what a full pixel reads stays as it was when gain and offset change
        let mut full_dn = sensor.full_well_e / sensor.electrons_per_dn + sensor.dark_offset_dn;
        let mut full_noise_dn = sensor.well_noise_e / sensor.electrons_per_dn;
        number("quantum_efficiency", self.quantum_efficiency, (1e-3, 1.0), &mut sensor.quantum_efficiency)?;
        number("electrons_per_dn", self.electrons_per_dn, (0.1, 1e4), &mut sensor.electrons_per_dn)?;
        number("dark_offset_dn", self.dark_offset_dn, (0.0, 100.0), &mut sensor.dark_offset_dn)?;
        number("corner_offset_dn", self.corner_offset_dn, (0.0, 100.0), &mut sensor.corner_offset_dn)?;
        number("full_reads_dn", self.full_reads_dn, (101.0, 1e5), &mut full_dn)?;
        number("full_noise_dn", self.full_noise_dn, (0.0, 50.0), &mut full_noise_dn)?;
        number("full_spread", self.full_spread, (0.0, 0.3), &mut sensor.pattern.well)?;
        number("spill", self.spill, (0.0, 1.0), &mut sensor.overflow.spill)?;
        number("column_smear", self.column_smear, (0.0, 0.1), &mut sensor.smear.share)?;
        number("read_noise_e", self.read_noise_e, (0.0, 1e4), &mut sensor.read_noise_e)?;
        number(
            "dark_current_e_per_s",
            self.dark_current_e_per_s,
            (0.0, 1e7),
            &mut sensor.dark_current_e_per_s,
        )?;
        number("offset_pattern_dn", self.offset_pattern_dn, (0.0, 50.0), &mut sensor.pattern.offset_dn)?;
        number(
            "column_pattern_dn",
            self.column_pattern_dn,
            (0.0, 50.0),
            &mut sensor.pattern.column_offset_dn,
        )?;
        number("gain_pattern", self.gain_pattern, (0.0, 0.3), &mut sensor.pattern.gain)?;
        number("hot_pixel_share", self.hot_pixel_share, (0.0, 0.1), &mut sensor.hot_pixel_share)?;
        number("hot_pixel_e_per_s", self.hot_pixel_e_per_s, (0.0, 1e10), &mut sensor.hot_pixel_e_per_s)?;
        sensor.full_well_e = (full_dn - sensor.dark_offset_dn) * sensor.electrons_per_dn;
        sensor.well_noise_e = full_noise_dn * sensor.electrons_per_dn;
        if let Some(ceiling_dn) = self.soft_ceiling_dn {
            let ceiling_dn = check.within(&key("soft_ceiling_dn"), ceiling_dn, (50.0, 1e4))?;
            sensor.response = Response::Soft { ceiling_dn };
        }
        if let Some(bits) = self.bits {
            sensor.converter = Converter::new(bits).ok_or_else(|| {
                check.refuse(&key("bits"), format!("{bits} is out of range")).advise("give 8 to 12")
            })?;
        }
        if let Some(line_us) = self.rolling_line_us {
            let line_us = check.within(&key("rolling_line_us"), line_us, (0.0, 1000.0))?;
            let line_s = line_us * 1e-6;
            sensor.shutter = if line_s > 0.0 { Shutter::Rolling { line_s } } else { Shutter::Global };
        }
        Ok(())
    }
}

fn read<T: DeserializeOwned>(path: &Path) -> Result<T> {
    let text = std::fs::read_to_string(path).map_err(|error| Error::io(path, error))?;
    toml_table::parse(&text, path)
}

/// A file that the file at hand names, from its folder.
fn named(check: &Check<'_>, key: &str, file: &Path) -> Result<PathBuf> {
    let path = check.path.parent().map_or_else(|| file.to_owned(), |folder| folder.join(file));
    if path.is_file() {
        return Ok(path);
    }
    let reason = format!("there is no file {}", path.display());
    Err(check.refuse(key, reason).advise("paths are taken from the folder of the file that names them"))
}

fn no_file_in_a_file(path: &Path, key: &str, is_plain: bool) -> Result<()> {
    let check = Check { path };
    is_plain
        .then_some(())
        .ok_or_else(|| check.refuse(key, "a file names another one").advise("name that one in the scene"))
}
