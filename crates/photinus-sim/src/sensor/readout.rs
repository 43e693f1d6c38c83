//! From charge to grey levels: one pass over the rows of a frame.
//!
//! A pixel without a marker costs its background, its noise and its rounding, nothing else.

use super::noise::hash;
use super::overflow::Overflown;
use super::pattern::Map;
use super::pixel::{Pixels, Reading};
use super::{Background, Charge, ColumnSmear, NoiseTable, Overflow, Response, Sensor};

/// Reads frames out of a sensor.
#[derive(Clone, Debug)]
pub struct Readout {
    read_variance_e2: f32,
    dn_per_electron: f32,
    offset_dn: f32,
    well_dn: f32,
    ceiling_dn: Option<f32>,
    overflow: Overflow,
    full_well_e: f64,
    smear: ColumnSmear,
    /// Pixels that are not all alike: the longer way.
    pixels: Option<Pixels>,
    noise: NoiseTable,
    nodes_e: Vec<f32>,
    nodes_dn: Vec<f32>,
    nodes_sigma_dn: Vec<f32>,
}

pub(super) const LANE: usize = Background::STEP_PX;
const DARK: [f32; LANE] = [0.0; LANE];

impl Readout {
    /// A readout of `sensor` as unit number `unit` of its make: the number tells where its pattern lies. The image has
    /// `width` columns and `height` rows.
    pub fn of_unit(sensor: &Sensor, (width, height): (usize, usize), unit: u64) -> Self {
        let map = || Map::new(&sensor.pattern, (width, height), unit);
        Self { pixels: Pixels::new(sensor, map), ..Self::new(sensor) }
    }

    /// A readout of `sensor`, were its pixels all alike and its well and converter plain.
    pub fn new(sensor: &Sensor) -> Self {
        let dn_per_electron = 1.0 / sensor.electrons_per_dn;
        Self {
            read_variance_e2: (sensor.read_noise_e * sensor.read_noise_e) as f32,
            dn_per_electron: dn_per_electron as f32,
            offset_dn: sensor.dark_offset_dn as f32,
            well_dn: (sensor.full_well_e * dn_per_electron) as f32,
            ceiling_dn: match sensor.response {
                Response::Linear => None,
                Response::Soft { ceiling_dn } => Some(ceiling_dn as f32),
            },
            overflow: sensor.overflow,
            full_well_e: sensor.full_well_e,
            smear: sensor.smear,
            pixels: None,
            noise: NoiseTable::new(),
            nodes_e: Vec::new(),
            nodes_dn: Vec::new(),
            nodes_sigma_dn: Vec::new(),
        }
    }

    /// Lets the background be seen `brightness` times as bright in the pixels that are `hidden`, row by row.
    pub fn hide(&mut self, sensor: &Sensor, width: usize, hidden: &[bool], brightness: f64) {
        if hidden.is_empty() {
            return;
        }
        let plain = || Map::new(&sensor.pattern, (width, hidden.len() / width), 0);
        let pixels = self.pixels.get_or_insert_with(|| Pixels::unequal(sensor, plain()));
        pixels.map_mut().hide(hidden, brightness as f32);
    }

    /// Makes of the light of an exposure the charge that is read: smear along columns, the pattern of gains, shot noise, and
    /// what flows over. Says where charge went that is not read.
    pub fn expose(&self, charge: &mut Charge, key: u64) -> Overflown {
        self.smear.of_light(charge);
        let map = self.pixels.as_ref().map(Pixels::map);
        if let Some(map) = map {
            map.scale(charge);
        }
        self.shot(charge, key);
        match map.filter(|map| map.has_wells()) {
            Some(map) => {
                let well_e = self.full_well_e as f32;
                self.overflow.settle_each(charge, |u, v| well_e * map.well(u, v))
            }
            None => self.overflow.settle(charge, self.full_well_e),
        }
    }

    /// Adds to every pixel of a column, from column `first` on, what it picks up of this many electrons of light.
    pub fn smear_columns(&self, charge: &mut Charge, first: usize, light_e: &[f32]) {
        self.smear.of_columns(charge, first, light_e);
    }

    /// Adds to a background what its rows pick up on their way through the columns.
    pub fn smear_background(&self, background: &mut Background, height: usize) {
        self.smear.of_background(background, height);
    }

    /// Adds the shot noise of the charge: variance equal to the mean. The background's is added with its reading.
    pub fn shot(&self, charge: &mut Charge, key: u64) {
        for v in 0..charge.height() {
            let row_key = hash(key ^ 0x5407) ^ v as u64;
            let Some((first, pixels)) = charge.touched_row_mut(v) else { continue };
            for (run, chunk) in pixels.chunks_mut(NoiseTable::RUN).enumerate() {
                let normal = self.noise.run(row_key, (first + run * NoiseTable::RUN) as u64);
                chunk.iter_mut().zip(normal).for_each(|(e, n)| *e += e.max(0.0).sqrt() * n);
            }
        }
    }

    /// Reads row `v` into `onto`, with the noise of frame `key`.
    pub fn read_row(
        &mut self,
        v: usize,
        background: &Background,
        charge: &Charge,
        key: u64,
        onto: &mut [u8],
    ) {
        background.row(v, &mut self.nodes_e);
        let (gain, variance) = (self.dn_per_electron, self.read_variance_e2);
        self.nodes_dn.clear();
        self.nodes_dn.extend(self.nodes_e.iter().map(|e| e * gain));
        self.nodes_sigma_dn.clear();
        self.nodes_sigma_dn.extend(self.nodes_e.iter().map(|e| (e.max(0.0) + variance).sqrt() * gain));
        let row_key = hash(key) ^ ((v as u64) << 20);
        let touched = charge.touched(v).unwrap_or((0, 0));
        let light = charge.row(v);
        for (run, pixels) in onto.chunks_mut(NoiseTable::RUN).enumerate() {
            let normal = self.noise.run(row_key, run as u64);
            for (lane, pixels) in pixels.chunks_mut(LANE).enumerate() {
                let node = run * (NoiseTable::RUN / LANE) + lane;
                let first = node * LANE;
                let is_lit = first < touched.1 && first + LANE > touched.0;
                let lit_dn = if is_lit { self.respond(&light[first..first + pixels.len()]) } else { DARK };
                let normal = &normal[lane * LANE..][..LANE];
                match &self.pixels {
                    None => self.read_lane(node, &lit_dn, normal, pixels),
                    Some(each) => {
                        let reading = self.reading(node);
                        let second = &self.noise.run(hash(row_key), run as u64)[lane * LANE..][..LANE];
                        each.read(&reading, (first, v), (&lit_dn, normal, second), pixels);
                    }
                }
            }
        }
    }

    /// What a lane of pixels has in common.
    fn reading(&self, node: usize) -> Reading {
        Reading {
            background_e: [self.nodes_e[node], self.nodes_e[node + 1]],
            read_variance_e2: self.read_variance_e2,
            dn_per_electron: self.dn_per_electron,
            well_dn: self.well_dn,
            offset_dn: self.offset_dn,
        }
    }

    #[inline]
    fn read_lane(&self, node: usize, lit_dn: &[f32; LANE], normal: &[f32], onto: &mut [u8]) {
        const STEP: f32 = 1.0 / LANE as f32;
        let (mean, sigma) = (self.nodes_dn[node], self.nodes_sigma_dn[node]);
        let mean_step = (self.nodes_dn[node + 1] - mean) * STEP;
        let sigma_step = (self.nodes_sigma_dn[node + 1] - sigma) * STEP;
        for (i, ((pixel, lit), normal)) in onto.iter_mut().zip(lit_dn).zip(normal).enumerate() {
            let at = i as f32;
            let level = (mean + mean_step * at + lit).min(self.well_dn) + (sigma + sigma_step * at) * normal;
            *pixel = to_grey(level + self.offset_dn);
        }
    }

    /// Grey levels of markers' light. A background is far below the ceiling of a soft response and not bent by it.
    fn respond(&self, light_e: &[f32]) -> [f32; LANE] {
        let mut levels = DARK;
        for (level, electrons) in levels.iter_mut().zip(light_e) {
            let linear = electrons * self.dn_per_electron;
            *level = match self.ceiling_dn {
                Some(ceiling) => -ceiling * libm::expm1f(-linear.max(0.0) / ceiling) + linear.min(0.0),
                None => linear,
            };
        }
        levels
    }
}

/// The nearest grey level: adding 2^23 leaves the rounded number in the low bits of a float.
#[inline]
pub(super) fn to_grey(level: f32) -> u8 {
    (level.clamp(0.0, 255.0) + 8_388_608.0).to_bits() as u8
}

#[cfg(test)]
mod tests {
    use super::super::{Converter, Overflow, Pattern, Response, Shutter};
    use super::*;

    fn sensor() -> Sensor {
        Sensor {
            quantum_efficiency: 0.34,
            response: Response::Linear,
            electrons_per_dn: 20.0,
            full_well_e: 4000.0,
            well_noise_e: 0.0,
            overflow: Overflow { spill: 0.9 },
            smear: ColumnSmear::NONE,
            read_noise_e: 30.0,
            dark_offset_dn: 10.0,
            corner_offset_dn: 0.0,
            dark_current_e_per_s: 0.0,
            hot_pixel_share: 0.0,
            hot_pixel_e_per_s: 0.0,
            pattern: Pattern::NONE,
            converter: Converter::EIGHT_BITS,
            shutter: Shutter::Global,
        }
    }

    fn moments(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
        let count = values.clone().count() as f64;
        let mean = values.clone().sum::<f64>() / count;
        (mean, values.map(|x| (x - mean) * (x - mean)).sum::<f64>() / count)
    }

    fn read(background: &Background, charge: &Charge, key: u64) -> Vec<u8> {
        let mut readout = Readout::new(&sensor());
        let mut frame = vec![0; charge.width() * charge.height()];
        for (v, row) in frame.chunks_mut(charge.width()).enumerate() {
            readout.read_row(v, background, charge, key, row);
        }
        frame
    }

    #[test]
    fn levels_round_to_the_nearest_and_stay_in_8_bits() {
        for (level, grey) in
            [(-3.0, 0), (0.4, 0), (0.6, 1), (99.4, 99), (254.6, 255), (1e9, 255), (f32::NAN, 0)]
        {
            assert_eq!(to_grey(level), grey, "{level}");
        }
    }

    #[test]
    fn a_soft_response_is_linear_in_the_dark_and_ends_at_its_ceiling() {
        let soft = Sensor {
            response: Response::Soft { ceiling_dn: 200.0 },
            full_well_e: 1e6,
            read_noise_e: 0.0,
            ..sensor()
        };
        let mut charge = Charge::new(64, 1);
        [100.0, 4000.0, 1e5].iter().zip([5, 20, 40]).for_each(|(&e, u)| _ = charge.add(u, 0, e));
        let mut row = [0; 64];
        Readout::new(&soft).read_row(0, &Background::new(64, 1), &charge, 1, &mut row);
        // 200 (1 - exp(-x / 200)) + 10 for x of 5, 200 and 5000 levels
        assert_eq!([row[5], row[20], row[40]], [15, 136, 210]);
        assert!((soft.electrons_at(136.424) / 4000.0 - 1.0).abs() < 1e-4);
        assert!(soft.electrons_at(211.0).is_infinite());
    }

    #[test]
    fn variance_of_shot_noise_equals_the_mean() {
        let readout = Readout::new(&sensor());
        for mean_e in [4.0_f32, 100.0, 5000.0] {
            let mut charge = Charge::new(256, 256);
            (0..256).for_each(|v| charge.add_row(v, 0, &[1.0; 256], mean_e));
            readout.shot(&mut charge, 3);
            let pixels = (0..256).flat_map(|v| charge.row(v).iter().map(|&e| f64::from(e)));
            let (mean, variance) = moments(pixels.clone());
            assert!((mean / f64::from(mean_e) - 1.0).abs() < 0.01, "{mean} of {mean_e}");
            assert!((variance / f64::from(mean_e) - 1.0).abs() < 0.02, "{variance} of {mean_e}");
        }
    }

    #[test]
    fn a_dark_pixel_has_offset_read_noise_and_rounding() {
        let frame = read(&Background::new(320, 200), &Charge::new(320, 200), 1);
        let (mean, variance) = moments(frame.iter().map(|&g| f64::from(g)));
        assert!((mean - 10.0).abs() < 0.02, "{mean}");
        assert!((variance - (1.5 * 1.5 + 1.0 / 12.0)).abs() < 0.05, "{variance}");
    }

    #[test]
    fn background_is_linear_between_nodes_and_brings_its_shot_noise() {
        let mut background = Background::new(320, 200);
        background.fill(|u, v| 1000.0 + 5.0 * u as f32 + 2.0 * v as f32);
        let charge = Charge::new(320, 200);
        let frames: Vec<Vec<u8>> = (0..400).map(|key| read(&background, &charge, key)).collect();
        for (u, v) in [(0, 0), (37, 55), (319, 199), (8, 199)] {
            let expected_e = 1000.0 + 5.0 * u as f64 + 2.0 * v as f64;
            let (mean, variance) = moments(frames.iter().map(|frame| f64::from(frame[v * 320 + u])));
            assert!((mean - 10.0 - expected_e / 20.0).abs() < 0.6, "{mean} at {u} {v}");
            let expected = (expected_e + 900.0) / 400.0 + 1.0 / 12.0;
            assert!((variance / expected - 1.0).abs() < 0.3, "{variance} not {expected} at {u} {v}");
        }
    }

    #[test]
    fn light_is_read_where_it_fell_and_stops_at_the_full_well() {
        let mut charge = Charge::new(100, 3);
        charge.add(17, 1, 2000.0);
        charge.add(99, 1, 1e6);
        let frame = read(&Background::new(100, 3), &charge, 5);
        assert!((f64::from(frame[117]) - 110.0).abs() < 7.0, "{}", frame[117]);
        assert!((f64::from(frame[199]) - 210.0).abs() < 7.0, "full at 200 levels: {}", frame[199]);
        assert!(frame.iter().enumerate().all(|(i, g)| *g < 20 || i == 117 || i == 199));
    }
}
