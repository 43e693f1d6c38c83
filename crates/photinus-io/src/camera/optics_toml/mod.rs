//! The table `[optics]` of Photinus's own camera file: lens and sensor as measured.
//!
//! Numbers stand with their sigmas, `[value, sigma]`. The point spread is text (`samples.rs`): a block of whole numbers for
//! every zone of the image.

mod samples;

use std::path::Path;

use photinus::camera::Camera;
use photinus::optics::{
    HotPixel, HotPixels, Measured, Optics, OpticsError, Response, Saturation, Sensor, SourceSize,
    SpreadField, Vignetting,
};
use serde::{Deserialize, Serialize};

use super::OpticsSummary;
use super::numbers::{Finite, degrees, values};
use crate::{Error, Place, Result};

/// The table as it stands.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OpticsTable {
    frames: Option<u64>,
    spots: Option<u64>,
    unseen: Option<Vec<String>>,
    dark_dn: Option<[Finite; 2]>,
    read_noise_dn: [Finite; 2],
    shot: [Finite; 2],
    response_bend: Option<[Finite; 2]>,
    saturation_dn: Finite,
    saturation_sigma_dn: Option<Finite>,
    saturation_spread_dn: Finite,
    spill: [Finite; 2],
    full_well_dn: Option<[Finite; 2]>,
    column_smear: Option<[Finite; 2]>,
    /// Column, row, level and its sigma; absent where there is none.
    hot_pixels: Option<Vec<(u32, u32, Finite, Finite)>>,
    vignetting: Option<VignettingTable>,
    sources: Option<SourcesTable>,
    point_spread: PointSpreadTable,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct VignettingTable {
    off_axis_deg: Vec<Finite>,
    share: Vec<Finite>,
    sigma: Vec<Finite>,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct PointSpreadTable {
    shape_error: Finite,
    shape_error_sigma: Option<Finite>,
    wings_error: Option<Finite>,
    unknown_below: Option<Finite>,
    place_error_px: Option<Finite>,
    columns: usize,
    /// Row by row. Written by hand, so that rows are lines.
    #[serde(skip_serializing)]
    zones: Vec<String>,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct SourcesTable {
    light_dn: Finite,
    growth_px2: [Finite; 2],
    scatter_px2: Finite,
}

impl OpticsTable {
    /// What the file says of a camera, but for the samples of its point spread.
    pub(super) fn of(optics: &Optics, summary: Option<&OpticsSummary>) -> Self {
        let pair = |measured: Measured| [Finite(measured.value), Finite(measured.sigma)];
        let finite = |number: Option<f64>| number.map(Finite);
        let sensor = &optics.sensor;
        Self {
            frames: summary.map(|summary| summary.frames),
            spots: summary.map(|summary| summary.spots),
            unseen: summary.map(|summary| summary.unseen.clone()),
            dark_dn: sensor.dark_dn.map(pair),
            read_noise_dn: pair(sensor.read_noise_dn),
            shot: pair(sensor.shot),
            response_bend: sensor.response.map(|response| pair(response.bend_per_dn)),
            saturation_dn: Finite(sensor.saturation.level_dn),
            saturation_sigma_dn: finite(summary.and_then(|summary| summary.saturation_sigma_dn)),
            saturation_spread_dn: Finite(sensor.saturation.spread_dn),
            spill: pair(sensor.spill),
            full_well_dn: sensor.full_well_dn.map(pair),
            column_smear: sensor.column_smear.map(pair),
            hot_pixels: (optics.hot_pixels.iter().len() > 0).then(|| listed(&optics.hot_pixels)),
            vignetting: optics.vignetting.as_ref().map(VignettingTable::of),
            sources: Some(SourcesTable::of(optics.spread.source_size())),
            point_spread: PointSpreadTable {
                shape_error: Finite(optics.spread.shape_error()),
                shape_error_sigma: finite(summary.and_then(|summary| summary.shape_error_sigma)),
                wings_error: Some(Finite(optics.spread.wings_error())),
                unknown_below: Some(Finite(optics.spread.unknown_below())),
                place_error_px: Some(Finite(optics.spread.place_error_px())),
                columns: optics.spread.columns(),
                zones: Vec::new(),
            },
        }
    }

    /// The camera with these optics, and what their calibration says about itself.
    pub(super) fn install(self, camera: Camera, path: &Path) -> Result<(Camera, OpticsSummary)> {
        let summary = OpticsSummary {
            frames: self.frames.unwrap_or(0),
            spots: self.spots.unwrap_or(0),
            saturation_sigma_dn: self.saturation_sigma_dn.map(|n| n.0),
            shape_error_sigma: self.point_spread.shape_error_sigma.map(|n| n.0),
            unseen: self.unseen.clone().unwrap_or_default(),
        };
        let size = [camera.width(), camera.height()];
        let sensor = self.sensor();
        sensor.check().map_err(|error| wrong(path, "optics", &error))?;
        let hot_pixels = self.hot_pixels.as_deref().unwrap_or_default();
        let hot_pixels =
            read_hot_pixels(hot_pixels, size).map_err(|error| wrong(path, "optics.hot_pixels", &error))?;
        let vignetting = self.vignetting.map(VignettingTable::read).transpose();
        let sources = self.sources.as_ref().map_or(SourceSize::UNKNOWN, SourcesTable::read);
        let spread = self.point_spread.read(size, path)?.with_source_size(sources);
        let optics = Optics {
            spread: spread.map_err(|error| wrong(path, "optics.sources", &error))?,
            sensor,
            vignetting: vignetting.map_err(|error| wrong(path, "optics.vignetting", &error))?,
            hot_pixels,
        };
        Ok((camera.with_optics(optics), summary))
    }

    fn sensor(&self) -> Sensor {
        let measured = |[value, sigma]: [Finite; 2]| Measured { value: value.0, sigma: sigma.0 };
        Sensor {
            dark_dn: self.dark_dn.map(measured),
            read_noise_dn: measured(self.read_noise_dn),
            shot: measured(self.shot),
            response: self.response_bend.map(|bend| Response { bend_per_dn: measured(bend) }),
            saturation: Saturation { level_dn: self.saturation_dn.0, spread_dn: self.saturation_spread_dn.0 },
            spill: measured(self.spill),
            full_well_dn: self.full_well_dn.map(measured),
            column_smear: self.column_smear.map(measured),
        }
    }
}

fn listed(hot_pixels: &HotPixels) -> Vec<(u32, u32, Finite, Finite)> {
    let one = |hot: &HotPixel| (hot.column, hot.row, Finite(hot.level_dn.value), Finite(hot.level_dn.sigma));
    hot_pixels.iter().map(one).collect()
}

/// Hot pixels within an image of this size.
fn read_hot_pixels(
    listed: &[(u32, u32, Finite, Finite)],
    [width, height]: [usize; 2],
) -> std::result::Result<HotPixels, OpticsError> {
    let outside =
        listed.iter().find(|(column, row, ..)| *column as usize >= width || *row as usize >= height);
    if let Some((column, ..)) = outside {
        let (name, must) = ("the column or row of a hot pixel", "within the image");
        return Err(OpticsError::Number { name, value: f64::from(*column), must });
    }
    let one = |&(column, row, ref level, ref sigma): &(u32, u32, Finite, Finite)| HotPixel {
        column,
        row,
        level_dn: Measured { value: level.0, sigma: sigma.0 },
    };
    HotPixels::new(listed.iter().map(one).collect())
}

impl VignettingTable {
    fn of(vignetting: &Vignetting) -> Self {
        let (angles_rad, shares, sigmas) = vignetting.table();
        let finite = |numbers: &[f64]| numbers.iter().copied().map(Finite).collect();
        let off_axis_deg = angles_rad.iter().map(|rad| Finite(degrees(*rad))).collect();
        Self { off_axis_deg, share: finite(shares), sigma: finite(sigmas) }
    }

    fn read(self) -> std::result::Result<Vignetting, OpticsError> {
        let angles_rad: Vec<f64> = self.off_axis_deg.iter().map(|deg| deg.0.to_radians()).collect();
        Vignetting::new(&angles_rad, &values(&self.share), &values(&self.sigma))
    }
}

impl SourcesTable {
    fn of(size: &SourceSize) -> Self {
        let Measured { value, sigma } = size.growth_px2;
        Self {
            light_dn: Finite(size.light_dn),
            growth_px2: [Finite(value), Finite(sigma)],
            scatter_px2: Finite(size.scatter_px2),
        }
    }

    fn read(&self) -> SourceSize {
        let [value, sigma] = &self.growth_px2;
        SourceSize {
            light_dn: self.light_dn.0,
            growth_px2: Measured { value: value.0, sigma: sigma.0 },
            scatter_px2: self.scatter_px2.0,
        }
    }
}

impl PointSpreadTable {
    fn read(self, [width, height]: [usize; 2], path: &Path) -> Result<SpreadField> {
        const KEY: &str = "optics.point_spread";
        let zones = self.zones.iter().enumerate().map(|(number, text)| {
            samples::read(text).map_err(|reason| {
                Error::format(path, format!("zone {number}: {reason}"))
                    .at(Place::Key("optics.point_spread.zones".to_owned()))
                    .advise("write it with photinus calibrate optics")
            })
        });
        let mut zones: Vec<_> = zones.collect::<Result<_>>()?;
        let error = self.shape_error.0;
        let field = match (zones.len(), zones.pop()) {
            (1, Some(only)) => SpreadField::even(only, error),
            (_, last) => {
                zones.extend(last);
                if zones.is_empty() {
                    return Err(Error::format(path, "a point spread without a zone")
                        .at(Place::Key(KEY.to_owned()))
                        .advise("write it with photinus calibrate optics"));
                }
                SpreadField::new(zones, self.columns, width as f64, height as f64, error)
            }
        };
        let wings_error = self.wings_error.map_or(error, |error| error.0);
        let unknown_below = self.unknown_below.map_or(0.0, |share| share.0);
        let place_error_px = self.place_error_px.map_or(0.0, |px| px.0);
        let field = field
            .and_then(|field| field.with_wings_error(wings_error))
            .and_then(|field| field.with_unknown_below(unknown_below))
            .and_then(|field| field.with_place_error_px(place_error_px));
        field.map_err(|error| wrong(path, KEY, &error))
    }
}

/// The samples of every zone, to stand at the end of the file.
pub(super) fn zones_text(optics: &Optics) -> String {
    let zones = optics.spread.zones().iter().map(|zone| format!("\"\"\"\n{}\"\"\",\n", samples::text(zone)));
    format!("zones = [\n{}]\n", zones.collect::<String>())
}

fn wrong(path: &Path, key: &str, error: &OpticsError) -> Error {
    Error::format(path, error.to_string()).at(Place::Key(key.to_owned())).advise("correct it there")
}

#[cfg(test)]
mod tests {
    use photinus::optics::{Gaussian, PointSpread};
    use proptest::prelude::*;

    use super::super::tests_of_optics::{bare_camera, round_trip};
    use super::*;

    /// A table as a file keeps it: whole millionths.
    fn kept(parts: &[Gaussian]) -> PointSpread {
        let samples = PointSpread::gaussians(parts).unwrap().samples().to_vec();
        PointSpread::new(samples.iter().map(|share| samples::rounded(*share)).collect()).unwrap()
    }

    fn measured() -> impl Strategy<Value = Measured> {
        (0.0..0.9_f64, 0.0..0.5_f64).prop_map(|(value, sigma)| Measured { value, sigma })
    }

    fn optics() -> impl Strategy<Value = Optics> {
        let numbers = prop::array::uniform4(measured());
        let options = prop::array::uniform4(prop::option::of(measured()));
        let hot = prop::collection::btree_map((0..752_u32, 0..480_u32), measured(), 0..5);
        let zones = prop::collection::vec((0.3..2.0_f64, 0.1..0.9_f64), 1..7);
        (numbers, options, zones, (prop::bool::ANY, hot), 0.0..0.1_f64).prop_map(
            |([noise, shot, spill, full], [dark, well, smear, bend], zones, (is_dim, hot), error)| {
                let spread = |(sigma_px, share): (f64, f64)| {
                    kept(&[
                        Gaussian { share, sigma_px },
                        Gaussian { share: 1.0 - share, sigma_px: 2.0 * sigma_px },
                    ])
                };
                let zones: Vec<PointSpread> = zones.into_iter().map(spread).collect();
                let columns = if zones.len().is_multiple_of(2) { 2 } else { zones.len() };
                let spread = match zones.as_slice() {
                    [only] => SpreadField::even(only.clone(), error).unwrap(),
                    _ => SpreadField::new(zones, columns, 752.0, 480.0, error).unwrap(),
                };
                let spread = spread
                    .with_wings_error(noise.value)
                    .and_then(|spread| spread.with_unknown_below(spill.value))
                    .and_then(|spread| spread.with_place_error_px(0.1 * noise.value))
                    .unwrap();
                let sources =
                    SourceSize { light_dn: 100.0 + shot.value, growth_px2: shot, scatter_px2: noise.sigma };
                let spread = spread.with_source_size(sources).unwrap();
                let angles = [0.0, (17.0 + noise.value).to_radians(), 80.0_f64.to_radians()];
                let vignetting =
                    is_dim.then(|| Vignetting::new(&angles, &[1.0, 0.9, 0.4], &[0.0, 0.01, 0.1]).unwrap());
                let well = well.map(|well| Measured { value: 1.0 + well.value, ..well });
                let sensor = Sensor {
                    dark_dn: dark,
                    read_noise_dn: noise,
                    shot,
                    response: bend
                        .map(|bend| Response { bend_per_dn: Measured { value: 0.05 * bend.value, ..bend } }),
                    saturation: Saturation { level_dn: 230.0 + full.value, spread_dn: full.sigma },
                    spill,
                    full_well_dn: well,
                    column_smear: smear,
                };
                let hot = hot.into_iter().map(|((column, row), level_dn)| HotPixel { column, row, level_dn });
                let hot_pixels = HotPixels::new(hot.collect()).unwrap();
                Optics { spread, sensor, vignetting, hot_pixels }
            },
        )
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        #[test]
        fn optics_read_back_the_same(optics in optics(), sigma in prop::option::of(0.0..1.0_f64)) {
            let summary = OpticsSummary {
                frames: 200,
                spots: 1234,
                saturation_sigma_dn: sigma,
                shape_error_sigma: sigma,
                unseen: vec!["vignetting".to_owned()],
            };
            let camera = bare_camera().with_optics(optics);
            let file = round_trip(&camera, &summary);
            prop_assert!(file.optics == Some(summary));
            prop_assert!(file.camera == camera, "some of ten thousand samples, or another number");
        }
    }
}
