//! `controller` of a group: its name, and the numbers that it takes.

use nalgebra::{Unit, Vector3};
use photinus_control::Controller;
use photinus_control::controllers::{
    BearingFormation, Boids, Follower, PoseFormation, RangeTest, Restraint, VelocityConsensus, WantedBearing,
    WantedOffset,
};
use photinus_io::Result;
use photinus_sim::scene::Check;
use serde::Deserialize;

use super::{Mind, Script};
use crate::scenario::Scenario;

/// `controller` as it stands.
#[derive(Clone, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum MindTable {
    Boids {
        near_m: f64,
        far_m: f64,
        #[serde(default = "inline")]
        near_by: RangeName,
        #[serde(default = "perpendicular")]
        far_by: RangeName,
        alignment: Option<f64>,
        #[serde(default)]
        cruise_m_s: [f64; 3],
        speed_m_s: Option<f64>,
    },
    Follow {
        leader: Option<u32>,
        distance_m: f64,
        speed_m_s: Option<f64>,
    },
    BearingFormation {
        speed_m_s: Option<f64>,
        #[serde(default)]
        cruise_m_s: [f64; 3],
    },
    PoseFormation {
        restraint_sigmas: Option<f64>,
        gain_per_s: Option<f64>,
        speed_m_s: Option<f64>,
        #[serde(default)]
        cruise_m_s: [f64; 3],
    },
    VelocityConsensus {},
    Hover {},
    Cruise {
        velocity_m_s: [f64; 3],
    },
    Way {
        places_m: Vec<[f64; 3]>,
        speed_m_s: f64,
    },
    FigureEight {
        half_m: [f64; 2],
        period_s: f64,
    },
    Hunt {
        speed_m_s: f64,
    },
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum RangeName {
    Inline,
    Perpendicular,
    Estimate,
    SpotSize { at_metre_px: f64 },
}

fn inline() -> RangeName {
    RangeName::Inline
}

fn perpendicular() -> RangeName {
    RangeName::Perpendicular
}

/// How a vehicle shall decide.
#[derive(Clone, Debug, PartialEq)]
pub enum Plan {
    /// As a flock, by near and far margins.
    Boids(Boids),
    /// Behind a leader.
    Follow(Follower),
    /// In the scenario's formation, by bearings alone but for one distance. The bearings that each keeps are filled in.
    BearingFormation(BearingFormation),
    /// In the scenario's formation, by relative positions. The bearings that each keeps are filled in.
    PoseFormation(PoseFormation),
    /// With the velocity of the others.
    VelocityConsensus,
    /// By a script.
    Script(Script),
}

/// What a controller has to know of the group.
#[derive(Clone, Copy, Debug)]
pub struct Needs<'a> {
    /// Which vehicle it is.
    pub vehicle: usize,
    /// Where vehicles are wanted, m.
    pub formation_m: &'a [Vector3<f64>],
}

impl<'a> Needs<'a> {
    /// Those of a vehicle of a scenario.
    pub(crate) fn of(scenario: &'a Scenario, vehicle: usize) -> Self {
        Self { vehicle, formation_m: &scenario.formation }
    }

    /// Where each other vehicle of the formation is wanted, from this one's place, m.
    fn offsets(&self) -> impl Iterator<Item = (u32, Vector3<f64>)> {
        let own = self.formation_m.get(self.vehicle).copied();
        let others = self.formation_m.iter().enumerate().filter(|(other, _)| *other != self.vehicle);
        others.filter_map(move |(other, place_m)| Some((other as u32, place_m - own?)))
    }
}

/// Places and times of scripts are within this, m and s.
const FARTHEST: f64 = 1e4;

/// Numbers of a controller that keep their default where they are not given.
struct Numbers<'a> {
    check: &'a Check<'a>,
    key: String,
}

impl Numbers<'_> {
    fn positive(&self, name: &str, value: f64) -> Result<f64> {
        self.check.positive(&format!("{}.{name}", self.key), value, FARTHEST)
    }

    fn or(&self, name: &str, value: Option<f64>, usual: f64) -> Result<f64> {
        value.map_or(Ok(usual), |value| self.positive(name, value))
    }

    fn velocity(&self, name: &str, velocity_m_s: [f64; 3]) -> Result<Vector3<f64>> {
        for value in velocity_m_s {
            self.check.within(&format!("{}.{name}", self.key), value, (-100.0, 100.0))?;
        }
        Ok(Vector3::from(velocity_m_s))
    }

    fn place(&self, name: &str, place_m: [f64; 3]) -> Result<Vector3<f64>> {
        self.check.place(&format!("{}.{name}", self.key), place_m)
    }
}

impl MindTable {
    /// Checks every number.
    pub(crate) fn read(self, check: &Check<'_>, key: &str) -> Result<Plan> {
        let of = |name: &str| Numbers { check, key: format!("{key}.{name}") };
        Ok(match self {
            Self::Boids { near_m, far_m, near_by, far_by, alignment, cruise_m_s, speed_m_s } => {
                let numbers = of("boids");
                let usual =
                    Boids::new(numbers.positive("near_m", near_m)?, numbers.positive("far_m", far_m)?);
                Plan::Boids(Boids {
                    near_by: near_by.test(&numbers)?,
                    far_by: far_by.test(&numbers)?,
                    alignment: match alignment {
                        Some(alignment) => check.share(&format!("{key}.boids.alignment"), alignment)?,
                        None => usual.alignment,
                    },
                    cruise_m_s: numbers.velocity("cruise_m_s", cruise_m_s)?,
                    speed_m_s: numbers.or("speed_m_s", speed_m_s, usual.speed_m_s)?,
                    ..usual
                })
            }
            Self::Follow { leader, distance_m, speed_m_s } => {
                let numbers = of("follow");
                let mut follower = Follower::new(leader, numbers.positive("distance_m", distance_m)?);
                follower.speed_m_s = numbers.or("speed_m_s", speed_m_s, follower.speed_m_s)?;
                Plan::Follow(follower)
            }
            Self::BearingFormation { speed_m_s, cruise_m_s } => {
                let (numbers, usual) = (of("bearing_formation"), BearingFormation::new(Vec::new()));
                Plan::BearingFormation(BearingFormation {
                    speed_m_s: numbers.or("speed_m_s", speed_m_s, usual.speed_m_s)?,
                    cruise_m_s: numbers.velocity("cruise_m_s", cruise_m_s)?,
                    ..usual
                })
            }
            Self::PoseFormation { restraint_sigmas, gain_per_s, speed_m_s, cruise_m_s } => {
                let (numbers, mut part) = (of("pose_formation"), PoseFormation::new(Vec::new()));
                part.restraint = match restraint_sigmas {
                    Some(sigmas) if sigmas <= 0.0 => Restraint::None,
                    Some(sigmas) => Restraint::Sigmas(numbers.positive("restraint_sigmas", sigmas)?),
                    None => part.restraint,
                };
                part.gain_per_s = numbers.or("gain_per_s", gain_per_s, part.gain_per_s)?;
                part.speed_m_s = numbers.or("speed_m_s", speed_m_s, part.speed_m_s)?;
                part.cruise_m_s = numbers.velocity("cruise_m_s", cruise_m_s)?;
                Plan::PoseFormation(part)
            }
            Self::VelocityConsensus {} => Plan::VelocityConsensus,
            Self::Hover {} => Plan::Script(Script::Hover),
            Self::Cruise { velocity_m_s } => Plan::Script(Script::Cruise {
                velocity_m_s: of("cruise").velocity("velocity_m_s", velocity_m_s)?,
            }),
            Self::Way { places_m, speed_m_s } => {
                let numbers = of("way");
                if places_m.is_empty() {
                    let refused = check.refuse(&format!("{key}.way.places_m"), "there is none");
                    return Err(refused.advise("add a place"));
                }
                let place = |place_m| numbers.place("places_m", place_m);
                Plan::Script(Script::Way {
                    places_m: places_m.into_iter().map(place).collect::<Result<_>>()?,
                    speed_m_s: numbers.positive("speed_m_s", speed_m_s)?,
                })
            }
            Self::FigureEight { half_m: [length_m, width_m], period_s } => {
                let numbers = of("figure_eight");
                let half_m = [numbers.positive("half_m", length_m)?, numbers.positive("half_m", width_m)?];
                let period_s = numbers.positive("period_s", period_s)?;
                Plan::Script(Script::FigureEight { half_m, period_s })
            }
            Self::Hunt { speed_m_s } => {
                Plan::Script(Script::Hunt { speed_m_s: of("hunt").positive("speed_m_s", speed_m_s)? })
            }
        })
    }
}

impl RangeName {
    fn test(self, numbers: &Numbers<'_>) -> Result<RangeTest> {
        Ok(match self {
            Self::Inline => RangeTest::Inline,
            Self::Perpendicular => RangeTest::Perpendicular,
            Self::Estimate => RangeTest::Estimate,
            Self::SpotSize { at_metre_px } => {
                RangeTest::SpotSize { at_metre_px: numbers.positive("at_metre_px", at_metre_px)? }
            }
        })
    }
}

impl Plan {
    /// Whether it flies by a formation and by names.
    pub(crate) fn needs_formation(&self) -> bool {
        matches!(self, Self::BearingFormation(_) | Self::PoseFormation(_))
    }

    /// What decides.
    pub fn mind(&self, needs: &Needs<'_>) -> Mind {
        let seeing = |controller: Box<dyn Controller + Send>| Mind::Seeing(controller);
        match self {
            Self::Boids(boids) => seeing(Box::new(*boids)),
            Self::Follow(follower) => seeing(Box::new(*follower)),
            Self::BearingFormation(part) => {
                let wanted = if needs.vehicle == 0 { Vec::new() } else { wanted_bearings(needs) };
                seeing(Box::new(BearingFormation { wanted, ..part.clone() }))
            }
            Self::PoseFormation(part) => {
                let mut part = part.clone();
                let wanted = |(identity, offset_m)| WantedOffset { identity, offset_m };
                part.wanted = needs.offsets().map(wanted).collect();
                seeing(Box::new(part))
            }
            Self::VelocityConsensus => seeing(Box::new(VelocityConsensus::new())),
            Self::Script(script) => Mind::Scripted(script.clone()),
        }
    }
}

/// Vehicle 0 leads; each other is answerable for the bearings to those before it, two at most: a Henneberg construction, minimal and rigid. The bearing
/// from 1 to 0 has a distance, too: it sets the size.
fn wanted_bearings(needs: &Needs<'_>) -> Vec<WantedBearing> {
    let before = needs.offsets().filter(|(other, _)| (*other as usize) < needs.vehicle).take(2);
    before
        .map(|(identity, offset_m)| WantedBearing {
            identity,
            direction: Unit::new_normalize(offset_m),
            distance_m: (needs.vehicle == 1).then(|| offset_m.norm()),
        })
        .collect()
}
