//! What is particular about the light of a scene: lobes and faults of LEDs, mirrors, lamps, the observer's own airframe.

use nalgebra::Unit;
use photinus::airframe::Airframe;
use photinus_io::Result;
use serde::Deserialize;

use super::check::Check;
use super::table::SolidTable;
use super::{SceneLamp, Target};
use crate::occlusion::{Edge, Mirror, OwnAirframe, Solid, Surface};
use crate::source::{LedFaults, Lobe};

/// `lobe` of a target: in place of those of its airframe file, which is what the method is told.
#[derive(Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum LobeTable {
    Omni,
    Cosine(f64),
    Table { step_deg: f64, intensity: Vec<f64> },
}

/// `leds` of a target.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LedsTable {
    spread: Option<f64>,
    #[serde(default)]
    dead: Vec<usize>,
    #[serde(default)]
    dead_share: f64,
    #[serde(default)]
    weak: Vec<WeakTable>,
    #[serde(default)]
    misplaced_m: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WeakTable {
    led: usize,
    power: f64,
}

/// `mirror` of a target.
#[derive(Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum MirrorTable {
    Plate { centre_m: [f64; 3], normal: [f64; 3], radius_m: f64, reflectance: f64 },
    Cylinder { centre_m: [f64; 3], radius_m: f64, half_height_m: f64, reflectance: f64 },
    Sphere { centre_m: [f64; 3], radius_m: f64, reflectance: f64 },
}

/// `[[lamp]]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LampTable {
    position_m: [f64; 3],
    #[serde(default = "one")]
    power: f64,
    #[serde(default = "lamp_radius_m")]
    radius_m: f64,
    beside: Option<u32>,
}

fn one() -> f64 {
    1.0
}

fn lamp_radius_m() -> f64 {
    5e-3
}

/// `[own_airframe]`.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OwnTable {
    #[serde(default)]
    solid: Vec<SolidTable>,
    #[serde(default)]
    brightness: f64,
    #[serde(default)]
    edge: Vec<EdgeTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct EdgeTable {
    from_m: [f64; 3],
    to_m: [f64; 3],
    power_per_m: f64,
}

impl LobeTable {
    pub(super) fn read(&self, check: &Check<'_>, key: &str) -> Result<Lobe> {
        let lobe = match self {
            Self::Omni => Some(Lobe::Omni),
            Self::Cosine(power) => Lobe::cosine(*power),
            Self::Table { step_deg, intensity } => Lobe::table(step_deg.to_radians(), intensity),
        };
        lobe.ok_or_else(|| {
            check.refuse(key, "no LED shines like that").advise(
                "a cosine's power is 0 to 200; a table has two intensities or more, 0 to 10, and ends at 180 deg",
            )
        })
    }
}

impl LedsTable {
    /// The faults of the LEDs of a vehicle; its markers must still be an airframe where they sit.
    pub(super) fn read(
        self,
        check: &Check<'_>,
        key: &str,
        airframe: &Airframe,
        (seed, id): (u64, u32),
    ) -> Result<LedFaults> {
        let named = |name: &str| format!("{key}.{name}");
        let led = |name: String, led: usize| -> Result<usize> {
            let count = airframe.leds().len();
            (led < count).then_some(led).ok_or_else(|| {
                check
                    .refuse(&name, format!("there is no LED {led}"))
                    .advise(format!("give 0 to {}", count - 1))
            })
        };
        let weak = |(i, weak): (usize, WeakTable)| -> Result<(usize, f64)> {
            let power = check.within(&named(&format!("weak[{i}].power")), weak.power, (0.0, 10.0))?;
            Ok((led(named(&format!("weak[{i}].led")), weak.led)?, power))
        };
        let spread = |spread| check.within(&named("spread"), spread, (0.0, 2.0));
        let faults = LedFaults {
            spread: self.spread.map(spread).transpose()?,
            dead: self.dead.into_iter().map(|dead| led(named("dead"), dead)).collect::<Result<_>>()?,
            dead_share: check.within(&named("dead_share"), self.dead_share, (0.0, 1.0))?,
            weak: self.weak.into_iter().enumerate().map(weak).collect::<Result<_>>()?,
            misplaced_m: check.within(&named("misplaced_m"), self.misplaced_m, (0.0, 0.1))?,
        };
        match faults.built(airframe, seed, id) {
            Ok(_) => Ok(faults),
            Err(error) => Err(check.refuse(&named("misplaced_m"), error.to_string()).advise("misplace less")),
        }
    }
}

impl MirrorTable {
    pub(super) fn read(self, check: &Check<'_>, key: &str) -> Result<Mirror> {
        let size = |name: &str, value: f64| check.positive(&format!("{key}.{name}"), value, 100.0);
        let share = |name: &str, value: f64| check.within(&format!("{key}.{name}"), value, (0.0, 1.0));
        let place = |name: &str, value: [f64; 3]| check.place(&format!("{key}.{name}"), value);
        Ok(match self {
            Self::Plate { centre_m, normal, radius_m, reflectance } => Mirror {
                surface: Surface::Plate {
                    centre_m: place("plate.centre_m", centre_m)?,
                    normal: Unit::try_new(place("plate.normal", normal)?, 1e-9).ok_or_else(|| {
                        check
                            .refuse(&format!("{key}.plate.normal"), "it points nowhere")
                            .advise("give a direction")
                    })?,
                    radius_m: size("plate.radius_m", radius_m)?,
                },
                reflectance: share("plate.reflectance", reflectance)?,
            },
            Self::Cylinder { centre_m, radius_m, half_height_m, reflectance } => Mirror {
                surface: Surface::Cylinder {
                    centre_m: place("cylinder.centre_m", centre_m)?,
                    radius_m: size("cylinder.radius_m", radius_m)?,
                    half_height_m: size("cylinder.half_height_m", half_height_m)?,
                },
                reflectance: share("cylinder.reflectance", reflectance)?,
            },
            Self::Sphere { centre_m, radius_m, reflectance } => Mirror {
                surface: Surface::Sphere {
                    centre_m: place("sphere.centre_m", centre_m)?,
                    radius_m: size("sphere.radius_m", radius_m)?,
                },
                reflectance: share("sphere.reflectance", reflectance)?,
            },
        })
    }
}

impl LampTable {
    pub(super) fn read(self, check: &Check<'_>, key: &str, targets: &[Target]) -> Result<SceneLamp> {
        let beside = |id: u32| {
            targets.iter().position(|target| target.id == id).ok_or_else(|| {
                check
                    .refuse(&format!("{key}.beside"), format!("there is no target {id}"))
                    .advise("name a target's id")
            })
        };
        Ok(SceneLamp {
            position_m: check.place(&format!("{key}.position_m"), self.position_m)?,
            power: check.within(&format!("{key}.power"), self.power, (0.0, 1e6))?,
            radius_m: check.positive(&format!("{key}.radius_m"), self.radius_m, 10.0)?,
            beside: self.beside.map(beside).transpose()?,
        })
    }
}

impl OwnTable {
    pub(super) fn read(
        self,
        check: &Check<'_>,
        solid: impl Fn(&str, SolidTable) -> Result<Solid>,
    ) -> Result<OwnAirframe> {
        let solids = self.solid.into_iter().enumerate();
        let edge = |(i, edge): (usize, EdgeTable)| -> Result<Edge> {
            let key = |name: &str| format!("own_airframe.edge[{i}].{name}");
            Ok(Edge {
                from_m: check.place(&key("from_m"), edge.from_m)?,
                to_m: check.place(&key("to_m"), edge.to_m)?,
                power_per_m: check.within(&key("power_per_m"), edge.power_per_m, (0.0, 1e6))?,
            })
        };
        Ok(OwnAirframe {
            solids: solids
                .map(|(i, table)| solid(&format!("own_airframe.solid[{i}]"), table))
                .collect::<Result<_>>()?,
            brightness: check.within("own_airframe.brightness", self.brightness, (0.0, 1.0))?,
            edges: self.edge.into_iter().enumerate().map(edge).collect::<Result<_>>()?,
        })
    }
}
