//! From the file as it stands to a scenario.

use std::path::Path;
use std::sync::Arc;

use nalgebra::{Unit, Vector3};
use photinus_io::{Error, Place, Result, physics, table as toml_table};
use photinus_sim::background::{Daylight, Sky};
use photinus_sim::preset::{BLUEFOX_FIT, SMALL_FISHEYE_FIT, bluefox, small_fisheye};
use photinus_sim::scene::Check;

use super::files::Library;
use super::kind;
use super::place::{Place as Layouts, Start};
use super::table::{
    DaylightTable, EventTable, FacingName, GroupTable, InstrumentsTable, ObstacleTable, PlaceTable,
    PresetName, ScenarioTable, SkyName, WindTable,
};
use super::{Codes, Event, Happening, Kind, Layout, Scenario, Vehicle};
use crate::vehicle::{Accuracy, Wind};
use crate::world::Obstacle;

/// Most vehicles of a scenario.
const MOST_VEHICLES: usize = 500;
/// Longest scenario, s.
const LONGEST_S: f64 = 3600.0;
/// Frames per second: fewer let a vehicle fly blind for a second, more no camera gives.
const RATE_HZ: (f64, f64) = (1.0, 240.0);

impl Scenario {
    /// Reads a scenario file and the files it names.
    ///
    /// # Errors
    /// [`Error`] with file, line or key and reason: see [`Scenario::parse`]; and when a file cannot be read.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path).map_err(|error| Error::io(path, error))?;
        Self::parse(&text, path)
    }

    /// Reads the text of a scenario.
    ///
    /// # Errors
    /// [`Error`] for unknown and missing keys, numbers that make no sense, controllers that there are not, a kind without cameras, vehicles that begin
    /// inside each other or an obstacle, events of vehicles that are not there, and for any error in a file that is named.
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let table: ScenarioTable = toml_table::parse(text, path).map_err(|error| advised(error, text))?;
        let reader = Reader { check: Check { path }, library: Library { scenario: path } };
        let scenario = reader.scenario(table)?;
        reader.apart(&scenario)?;
        Ok(scenario)
    }

    /// Where vehicles begin under its seed.
    ///
    /// # Errors
    /// [`Error`] with the key of the group where that many do not fit.
    pub(crate) fn starts(&self, path: &Path) -> Result<Vec<Start>> {
        let mut starts = Vec::with_capacity(self.vehicles.len());
        for (group, layout) in self.layouts.iter().enumerate() {
            let drawn = layout.starts(self.seed, group as u64).ok_or_else(|| {
                let refused = Check { path }
                    .refuse(&format!("group[{group}].place"), format!("{} do not fit", layout.count));
                refused.advise("give more room, or let them be nearer to each other")
            })?;
            starts.extend(drawn);
        }
        Ok(starts)
    }
}

/// The same error with what to do about it in a scenario.
fn advised(error: Error, text: &str) -> Error {
    let of_controller =
        |line: usize| text.lines().nth(line - 1).is_some_and(|line| line.contains("controller"));
    match error.place {
        Some(Place::Line(line)) if of_controller(line) && error.cause.to_string().starts_with("unknown") => {
            error.advise("that is no controller, or a key that it has not; docs/swarm.md lists them")
        }
        _ if error.advice.contains("file-formats.md") => {
            error.advise("correct it there; docs/swarm.md has every key")
        }
        _ => error,
    }
}

struct Reader<'a> {
    check: Check<'a>,
    library: Library<'a>,
}

impl Reader<'_> {
    fn scenario(&self, table: ScenarioTable) -> Result<Scenario> {
        let check = &self.check;
        let rate_hz = check.within("rate_hz", table.rate_hz, RATE_HZ)?;
        let kinds = table.kind.into_iter().enumerate();
        let kinds = kinds.map(|(index, kind)| kind::read(check, &self.library, index, kind).map(Arc::new));
        let kinds: Vec<Arc<Kind>> = kinds.collect::<Result<_>>()?;
        let mut vehicles = Vec::new();
        let mut layouts = Vec::new();
        for (index, group) in table.group.into_iter().enumerate() {
            let key = |name: &str| format!("group[{index}].{name}");
            let kind = kinds.iter().find(|kind| kind.name == group.kind).ok_or_else(|| {
                let names = kinds.iter().map(|kind| kind.name.as_str()).collect::<Vec<_>>().join(", ");
                let refused = check.refuse(&key("kind"), format!("there is no kind `{}`", group.kind));
                refused.advise(format!("there are: {names}"))
            })?;
            let mind = group.controller.clone().read(check, &key("controller"))?;
            let height = |height_m| check.within(&key("height_m"), height_m, (-1e4, 1e4));
            let height_m = group.height_m.map(height).transpose()?;
            let safety =
                group.safety.as_ref().map(|safety| safety.read(check, &key("safety"))).transpose()?;
            layouts.push(self.layout(&key, &group)?);
            for _ in 0..group.count {
                vehicles.push(Vehicle {
                    id: vehicles.len() as u32,
                    kind: Arc::clone(kind),
                    mind: mind.clone(),
                    height_m,
                    safety: safety.clone(),
                });
            }
        }
        if vehicles.is_empty() || vehicles.len() > MOST_VEHICLES {
            let refused = check.refuse("group", format!("{} vehicles", vehicles.len()));
            return Err(refused.advise(format!("let there be 1 to {MOST_VEHICLES}")));
        }
        let exposure_us = self.exposure("exposure_us", table.exposure_us, rate_hz)?;
        let codes = match table.codes {
            None => None,
            Some(codes) => {
                let book = self.library.codes("codes.file", &codes.file)?;
                if book.words().len() < vehicles.len() {
                    let reason = format!("{} words for {} vehicles", book.words().len(), vehicles.len());
                    return Err(check.refuse("codes.file", reason).advise("name a larger book"));
                }
                Some(Codes { book, rate_hz: check.rate("codes.rate_hz", codes.rate_hz)? })
            }
        };
        let obstacles = table.obstacle.into_iter().enumerate();
        let obstacles = obstacles.map(|(index, table)| self.obstacle(&format!("obstacle[{index}]"), table));
        let obstacles: Vec<Vec<Obstacle>> = obstacles.collect::<Result<_>>()?;
        let mut events = Vec::new();
        for (index, event) in table.event.into_iter().enumerate() {
            events.push(self.event(&format!("event[{index}]"), event, &vehicles, rate_hz)?);
        }
        events.sort_by(|a: &Event, b| a.at_s.total_cmp(&b.at_s));
        let formation = table.formation_m.iter().map(|place| check.place("formation_m", *place));
        let formation: Vec<Vector3<f64>> = formation.collect::<Result<_>>()?;
        if formation.len() > vehicles.len() || formation.len() == 1 {
            let reason = format!("{} places for {} vehicles", formation.len(), vehicles.len());
            let refused = check.refuse("formation_m", reason);
            return Err(refused.advise("give a place to each of the first vehicles, to two at least"));
        }
        self.formations(&vehicles, formation.len(), codes.is_some())?;
        Ok(Scenario {
            name: table.name,
            about: table.about,
            seed: table.seed,
            duration_s: check.positive("duration_s", table.duration_s, LONGEST_S)?,
            rate_hz,
            exposure_us,
            preset: match table.preset {
                PresetName::Bluefox => bluefox(&BLUEFOX_FIT),
                PresetName::SmallFisheye => small_fisheye(&SMALL_FISHEYE_FIT),
            },
            daylight: table.daylight.map(|daylight| self.daylight(&daylight)).transpose()?,
            wind: self.wind(&table.wind)?,
            accuracy: self.accuracy(&table.instruments)?,
            grade: table.perception,
            range_m: check.positive("range_m", table.range_m, 1e3)?,
            codes,
            vehicles,
            obstacles: obstacles.into_iter().flatten().collect(),
            events,
            formation,
            layouts,
        })
    }

    /// Refuses those who fly in formation without a place in it, or without names.
    fn formations(&self, vehicles: &[Vehicle], places: usize, has_codes: bool) -> Result<()> {
        let outside = |vehicle: &&Vehicle| vehicle.mind.needs_formation() && vehicle.id as usize >= places;
        if let Some(vehicle) = vehicles.iter().find(outside) {
            let reason = format!("vehicle {} flies in formation and has no place in it", vehicle.id);
            return Err(self
                .check
                .refuse("formation_m", reason)
                .advise("give a place to each of the first vehicles"));
        }
        if !has_codes && vehicles.iter().any(|vehicle| vehicle.mind.needs_formation()) {
            let refused = self.check.refuse("codes", "a formation needs to know who is who");
            return Err(refused.advise("add [codes] with file and rate_hz"));
        }
        Ok(())
    }

    /// An exposure that fits between two frames.
    fn exposure(&self, key: &str, exposure_us: f64, rate_hz: f64) -> Result<f64> {
        let exposure_us = physics::within(self.check.path, key, exposure_us, &physics::EXPOSURE_US)?;
        if exposure_us <= 1e6 / rate_hz {
            return Ok(exposure_us);
        }
        let reason = format!("an exposure of {exposure_us} us is longer than {:.1} us", 1e6 / rate_hz);
        Err(self.check.refuse(key, reason).advise("that is the time between frames at rate_hz"))
    }

    fn layout(&self, key: &dyn Fn(&str) -> String, group: &GroupTable) -> Result<Layout> {
        let check = &self.check;
        let centre = |centre_m| check.place(&key("place"), centre_m);
        let angle = |value_deg| check.angle(&key("place"), value_deg);
        let place = match &group.place {
            PlaceTable::At { positions_m, headings_deg } => {
                if positions_m.len() != group.count {
                    let reason = format!("{} places for {} vehicles", positions_m.len(), group.count);
                    return Err(check
                        .refuse(&key("place.at.positions_m"), reason)
                        .advise("give one to each"));
                }
                Layouts::At {
                    places_m: positions_m.iter().map(|place| centre(*place)).collect::<Result<_>>()?,
                    headings_rad: headings_deg.iter().map(|deg| angle(*deg)).collect::<Result<_>>()?,
                }
            }
            PlaceTable::Ring { centre_m, radius_m, facing } => Layouts::Ring {
                centre_m: centre(*centre_m)?,
                radius_m: check.positive(&key("place.ring.radius_m"), *radius_m, 1e4)?,
                facing_rad: match facing {
                    FacingName::Inwards => core::f64::consts::PI,
                    FacingName::Outwards => 0.0,
                    FacingName::Along => core::f64::consts::FRAC_PI_2,
                },
            },
            PlaceTable::Grid { centre_m, spacing_m, heading_deg } => Layouts::Grid {
                centre_m: centre(*centre_m)?,
                spacing_m: check.positive(&key("place.grid.spacing_m"), *spacing_m, 1e3)?,
                heading_rad: angle(*heading_deg)?,
            },
            PlaceTable::Random { centre_m, half_m, apart_m, heading_deg } => {
                for value in half_m {
                    check.within(&key("place.random.half_m"), *value, (0.0, 1e4))?;
                }
                Layouts::Random {
                    centre_m: centre(*centre_m)?,
                    half_m: Vector3::from(*half_m),
                    apart_m: check.positive(&key("place.random.apart_m"), *apart_m, 1e3)?,
                    heading_rad: heading_deg.map(angle).transpose()?,
                }
            }
        };
        let jitter_m = check.within(&key("jitter_m"), group.jitter_m, (0.0, 100.0))?;
        Ok(Layout { count: group.count, place, jitter_m })
    }

    fn daylight(&self, table: &DaylightTable) -> Result<Daylight> {
        let azimuth_rad = self.check.angle("daylight.sun_azimuth_deg", table.sun_azimuth_deg)?;
        let elevation = ("daylight.sun_elevation_deg", table.sun_elevation_deg);
        let elevation_rad = self.check.within(elevation.0, elevation.1, (-90.0, 90.0))?.to_radians();
        let ((sin_a, cos_a), (sin_e, cos_e)) = (libm::sincos(azimuth_rad), libm::sincos(elevation_rad));
        let sun = Unit::new_normalize(Vector3::new(cos_a * cos_e, sin_a * cos_e, sin_e));
        let sky = match table.sky {
            SkyName::Clear => Sky::Clear,
            SkyName::Overcast => Sky::Overcast,
        };
        Ok(Daylight::new(sky, sun))
    }

    fn wind(&self, table: &WindTable) -> Result<Wind> {
        for value in table.mean_m_s {
            self.check.within("wind.mean_m_s", value, (-40.0, 40.0))?;
        }
        Ok(Wind {
            mean_m_s: Vector3::from(table.mean_m_s),
            gust_m_s: self.check.within("wind.gust_m_s", table.gust_m_s, (0.0, 20.0))?,
            gust_s: self.check.positive("wind.gust_s", table.gust_s, 1e3)?,
            common: self.check.share("wind.common", table.common)?,
        })
    }

    fn accuracy(&self, table: &InstrumentsTable) -> Result<Accuracy> {
        let usual = Accuracy::default();
        let sigma = |name: &str, value: Option<f64>, usual: f64, most: f64| {
            value.map_or(Ok(usual), |value| {
                self.check.within(&format!("instruments.{name}"), value, (0.0, most))
            })
        };
        let angle = |name: &str, value: Option<f64>, usual: f64| {
            sigma(name, value, usual.to_degrees(), 90.0).map(f64::to_radians)
        };
        Ok(Accuracy {
            tilt_bias_rad: angle("tilt_bias_deg", table.tilt_bias_deg, usual.tilt_bias_rad)?,
            tilt_noise_rad: angle("tilt_noise_deg", table.tilt_noise_deg, usual.tilt_noise_rad)?,
            heading_bias_rad: angle("heading_bias_deg", table.heading_bias_deg, usual.heading_bias_rad)?,
            gyro_bias_rad_s: sigma("gyro_bias_rad_s", table.gyro_bias_rad_s, usual.gyro_bias_rad_s, 1.0)?,
            gyro_noise_rad_s: sigma("gyro_noise_rad_s", table.gyro_noise_rad_s, usual.gyro_noise_rad_s, 1.0)?,
            velocity_bias_m_s: sigma(
                "velocity_bias_m_s",
                table.velocity_bias_m_s,
                usual.velocity_bias_m_s,
                10.0,
            )?,
            velocity_noise_m_s: sigma(
                "velocity_noise_m_s",
                table.velocity_noise_m_s,
                usual.velocity_noise_m_s,
                10.0,
            )?,
            height_noise_m: sigma("height_noise_m", table.height_noise_m, usual.height_noise_m, 10.0)?,
        })
    }

    /// One obstacle, or those that a gate is made of.
    fn obstacle(&self, key: &str, table: ObstacleTable) -> Result<Vec<Obstacle>> {
        let check = &self.check;
        let place = |name: &str, place_m| check.place(&format!("{key}.{name}"), place_m);
        let length = |name: &str, value| check.positive(&format!("{key}.{name}"), value, 1e3);
        let bar = |from_m, to_m, radius_m| -> Result<Vec<Obstacle>> {
            Ok(vec![Obstacle { from_m, to_m, radius_m: length("radius_m", radius_m)? }])
        };
        match table {
            ObstacleTable::Ball { centre_m, radius_m } => {
                let centre_m = place("ball.centre_m", centre_m)?;
                bar(centre_m, centre_m, radius_m)
            }
            ObstacleTable::Pillar { foot_m, height_m, radius_m } => {
                let foot_m = place("pillar.foot_m", foot_m)?;
                bar(foot_m, foot_m + Vector3::z() * length("pillar.height_m", height_m)?, radius_m)
            }
            ObstacleTable::Bar { from_m, to_m, radius_m } => {
                bar(place("bar.from_m", from_m)?, place("bar.to_m", to_m)?, radius_m)
            }
            ObstacleTable::Gate { centre_m, width_m, height_m, radius_m } => {
                let size_m = [length("gate.width_m", width_m)?, length("gate.height_m", height_m)?];
                Ok(gate(place("gate.centre_m", centre_m)?, size_m, length("gate.radius_m", radius_m)?))
            }
        }
    }

    fn event(&self, key: &str, table: EventTable, vehicles: &[Vehicle], rate_hz: f64) -> Result<Event> {
        let check = &self.check;
        let of = |name: &str| format!("{key}.{name}");
        let at_s = check.within(&of("at_s"), table.at_s, (0.0, LONGEST_S))?;
        let what = match (table.exposure_us, table.vehicle) {
            (Some(exposure_us), None) => {
                Happening::Exposure(self.exposure(&of("exposure_us"), exposure_us, rate_hz)?)
            }
            (None, Some(vehicle)) => {
                let kind = &vehicles
                    .get(vehicle)
                    .ok_or_else(|| {
                        let reason = format!("vehicle {vehicle} of {}", vehicles.len());
                        check.refuse(&of("vehicle"), reason).advise("they are counted from 0")
                    })?
                    .kind;
                match (table.led_fails, table.camera_fails, table.controller) {
                    (Some(led), None, None) => {
                        if led >= kind.airframe.leds().len() {
                            let reason = format!("LED {led} of {}", kind.airframe.leds().len());
                            return Err(check
                                .refuse(&of("led_fails"), reason)
                                .advise("they are counted from 0"));
                        }
                        Happening::LedFails { vehicle, led }
                    }
                    (None, Some(name), None) => {
                        let found = kind.cameras.iter().position(|camera| camera.name == name);
                        let camera = found.ok_or_else(|| {
                            let names: Vec<&str> = kind.cameras.iter().map(|c| c.name.as_str()).collect();
                            check
                                .refuse(&of("camera_fails"), format!("it has no camera `{name}`"))
                                .advise(format!("it has {}", names.join(", ")))
                        })?;
                        Happening::CameraFails { vehicle, camera }
                    }
                    (None, None, Some(mind)) => {
                        Happening::Mind { vehicle, mind: mind.read(check, &of("controller"))? }
                    }
                    _ => {
                        return Err(check
                            .refuse(key, "it does not say one thing that happens to the vehicle")
                            .advise("give one of led_fails, camera_fails and controller"));
                    }
                }
            }
            _ => {
                return Err(check
                    .refuse(key, "it does not say one thing that happens")
                    .advise("give exposure_us, or vehicle and what happens to it"));
            }
        };
        Ok(Event { at_s, what })
    }

    /// Refuses vehicles that begin inside each other or an obstacle, under the scenario's own seed.
    fn apart(&self, scenario: &Scenario) -> Result<()> {
        let starts = scenario.starts(self.check.path)?;
        let radius_m = |index: usize| scenario.vehicles[index].kind.build.radius_m;
        let mut groups = Vec::new();
        for (group, layout) in scenario.layouts.iter().enumerate() {
            groups.extend((0..layout.count).map(|_| group));
        }
        for (index, start) in starts.iter().enumerate() {
            let refuse = |reason: String| {
                let key = format!("group[{}].place", groups[index]);
                Err(self.check.refuse(&key, reason).advise("move them apart"))
            };
            for (before, other) in starts[..index].iter().enumerate() {
                let gap_m = (start.position_m - other.position_m).norm();
                if gap_m < radius_m(index) + radius_m(before) {
                    return refuse(format!(
                        "vehicle {index} begins inside vehicle {before}: {gap_m:.2} m between centres, they need {:.2} m",
                        radius_m(index) + radius_m(before)
                    ));
                }
            }
            let inside = |obstacle: &Obstacle| obstacle.distance_m(&start.position_m) < radius_m(index);
            if let Some(obstacle) = scenario.obstacles.iter().position(inside) {
                return refuse(format!("vehicle {index} begins inside obstacle {obstacle}"));
            }
        }
        Ok(())
    }
}

/// An opening across the x axis: two posts and two beams, whose axes are so far apart.
fn gate(centre_m: Vector3<f64>, [width_m, height_m]: [f64; 2], radius_m: f64) -> Vec<Obstacle> {
    let corner = |y: f64, z: f64| centre_m + Vector3::new(0.0, y * width_m / 2.0, z * height_m / 2.0);
    let corners = [corner(1.0, 1.0), corner(-1.0, 1.0), corner(-1.0, -1.0), corner(1.0, -1.0)];
    (0..4).map(|at| Obstacle { from_m: corners[at], to_m: corners[(at + 1) % 4], radius_m }).collect()
}
