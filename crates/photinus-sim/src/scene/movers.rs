//! Robots of a scene: how they move, how they are built, what of them hides LEDs.

use photinus_io::Result;
use photinus_io::airframe::read_airframe;

use super::Target;
use super::read::{LONGEST_S, Reader, wind_seed};
use super::table::{MotionTable, SolidTable, SpinTable, TargetTable};
use crate::motion::{Flight, Motion, Path as FlightPath, Recorded, Spin, Wander};
use crate::occlusion::Solid;

impl Reader<'_> {
    pub(super) fn target(&self, index: usize, table: TargetTable) -> Result<Target> {
        let key = |name: &str| format!("target[{index}].{name}");
        let airframe = read_airframe(self.named(&key("airframe"), &table.airframe)?)?.airframe;
        let how = (table.wind_m_s, table.heading_deg, table.spin);
        let motion = self.motion(&format!("target[{index}]"), table.motion, how, u64::from(table.id))?;
        let solids = table.solid.into_iter().enumerate();
        let solids = solids.map(|(i, solid)| self.solid(&format!("target[{index}].solid[{i}]"), solid));
        let blink = table.blink.map(|blink| self.blink(&key("blink"), blink, &airframe)).transpose()?;
        let lobe = table.lobe.map(|lobe| lobe.read(&self.check, &key("lobe"))).transpose()?;
        let faults = table.leds.read(&self.check, &key("leds"), &airframe, (self.seed, table.id))?;
        let mirrors = table.mirror.into_iter().enumerate();
        let mirrors = mirrors.map(|(i, mirror)| mirror.read(&self.check, &key(&format!("mirror[{i}]"))));
        Ok(Target {
            id: table.id,
            solids: solids.collect::<Result<_>>()?,
            lobe,
            faults,
            mirrors: mirrors.collect::<Result<_>>()?,
            motion,
            blink,
            airframe,
        })
    }

    pub(super) fn solid(&self, key: &str, table: SolidTable) -> Result<Solid> {
        let check = &self.check;
        Ok(match table {
            SolidTable::Sphere { centre_m, radius_m } => Solid::Sphere {
                centre_m: check.place(&format!("{key}.sphere.centre_m"), centre_m)?,
                radius_m: check.positive(&format!("{key}.sphere.radius_m"), radius_m, 100.0)?,
            },
            SolidTable::Cylinder { centre_m, radius_m, half_height_m } => Solid::Cylinder {
                centre_m: check.place(&format!("{key}.cylinder.centre_m"), centre_m)?,
                radius_m: check.positive(&format!("{key}.cylinder.radius_m"), radius_m, 100.0)?,
                half_height_m: check.positive(
                    &format!("{key}.cylinder.half_height_m"),
                    half_height_m,
                    100.0,
                )?,
            },
        })
    }

    pub(super) fn motion(
        &self,
        owner: &str,
        table: MotionTable,
        (wind_m_s, heading_deg, spins): (f64, f64, Vec<SpinTable>),
        salt: u64,
    ) -> Result<Motion> {
        let check = &self.check;
        let key = |name: &str| format!("{owner}.motion.{name}");
        let path = match table {
            MotionTable::Hover { position_m } => {
                FlightPath::Hover { position_m: check.place(&key("hover.position_m"), position_m)? }
            }
            MotionTable::Line { from_m, to_m, duration_s } => FlightPath::Line {
                from_m: check.place(&key("line.from_m"), from_m)?,
                to_m: check.place(&key("line.to_m"), to_m)?,
                duration_s: check.positive(&key("line.duration_s"), duration_s, LONGEST_S)?,
            },
            MotionTable::Circle { centre_m, radius_m, speed_m_s, phase_deg } => FlightPath::Circle {
                centre_m: check.place(&key("circle.centre_m"), centre_m)?,
                radius_m: check.positive(&key("circle.radius_m"), radius_m, 1e4)?,
                speed_m_s: check.within(&key("circle.speed_m_s"), speed_m_s, (-100.0, 100.0))?,
                phase_rad: check.angle(&key("circle.phase_deg"), phase_deg)?,
            },
            MotionTable::FigureEight { centre_m, half_size_m, period_s } => FlightPath::FigureEight {
                centre_m: check.place(&key("figure_eight.centre_m"), centre_m)?,
                half_size_m: [
                    check.positive(&key("figure_eight.half_size_m"), half_size_m[0], 1e4)?,
                    check.positive(&key("figure_eight.half_size_m"), half_size_m[1], 1e4)?,
                ],
                period_s: check.positive(&key("figure_eight.period_s"), period_s, LONGEST_S)?,
            },
            MotionTable::Recorded { file } => {
                let path = self.named(&key("recorded.file"), &file)?;
                return Recorded::read(&path).map(Motion::Recorded);
            }
        };
        let wind_m_s = check.within(&format!("{owner}.wind_m_s"), wind_m_s, (0.0, 40.0))?;
        let wander = Wander::new(wind_m_s, wind_seed(self.seed, salt));
        let heading_rad = check.angle(&format!("{owner}.heading_deg"), heading_deg)?;
        let spin = |(i, spin): (usize, SpinTable)| -> Result<Spin> {
            let key = |name: &str| format!("{owner}.spin[{i}].{name}");
            Ok(Spin {
                start_s: check.within(&key("start_s"), spin.start_s, (-LONGEST_S, LONGEST_S))?,
                duration_s: check.positive(&key("duration_s"), spin.duration_s, LONGEST_S)?,
                turns: check.within(&key("turns"), spin.turns, (-1e4, 1e4))?,
            })
        };
        let spins = spins.into_iter().enumerate().map(spin).collect::<Result<_>>()?;
        Ok(Motion::Flown(Flight { path, wander, heading_rad, spins }))
    }
}
