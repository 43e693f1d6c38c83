//! LEDs rendered at places and of lights drawn by chance, and the point spread that they were drawn with: the simulator's own code,
//! which shares nothing with what learns from its frames.

#![allow(dead_code, reason = "each test looks at a part")]

use nalgebra::{UnitQuaternion, Vector3};
use photinus::camera::{Bearing, Camera, Ideal, IdealLaw, Model, Pixel};
use photinus::frame::FrameView;
use photinus::optics::PointSpread;
use photinus_calibrate::optics::Collection;
use photinus_sim::cameras::World;
use photinus_sim::optics::PointLight;
use photinus_sim::preset::Preset;
use photinus_sim::sensor::{Background, Charge, Readout};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;

/// A camera with its lens and sensor.
pub(crate) struct Eye {
    pub(crate) camera: Camera,
    pub(crate) preset: Preset,
    /// Summit of the brightest LED in the middle of a pixel, were it never full, grey levels.
    pub(crate) brightest_dn: f64,
    /// Pixels that gather charge without light: column, row, grey levels.
    pub(crate) hot: Vec<(usize, usize, f64)>,
    /// Light of the sky in a pixel by column and row, grey levels.
    pub(crate) sky_dn: fn(f64, f64) -> f64,
}

/// An LED in a frame: column and row, and its light against that of the faintest.
pub(crate) type Led = (f64, f64, f64);

/// Lights of the faintest LEDs, likewise.
pub(crate) const FAINTEST_DN: f64 = 15.0;

impl Eye {
    /// A camera of the list.
    pub(crate) fn of(world: World) -> Self {
        Self {
            camera: world.camera,
            preset: world.preset,
            brightest_dn: 600.0,
            hot: Vec::new(),
            sky_dn: |_, _| 0.0,
        }
    }

    /// A camera of the list by its name.
    pub(crate) fn named(name: &str) -> Self {
        let mut worlds = photinus_sim::cameras::worlds().into_iter();
        Self::of(worlds.find(|world| world.name == name).expect("a camera of the list"))
    }

    /// The same with a smaller image: what a test can afford.
    pub(crate) fn cropped(self, width: usize, height: usize) -> Self {
        let Model::Ideal(lens) = self.camera.model() else { panic!("an ideal lens") };
        let centre = Pixel::new(0.5 * width as f64 - 0.5, 0.5 * height as f64 - 0.5);
        let lens = Ideal::new(lens.law(), lens.focal_px(), centre).expect("the same lens");
        let camera = Camera::new(Model::Ideal(lens), width, height, None).expect("a smaller image");
        Self { camera, ..self }
    }

    /// The same behind a lens that sees 160 deg across a small image.
    pub(crate) fn small_and_wide(self) -> Self {
        let lens = Ideal::new(IdealLaw::Equidistant, [140.0; 2], Pixel::new(199.5, 149.5)).expect("a lens");
        Self { camera: Camera::new(Model::Ideal(lens), 400, 300, None).expect("a small image"), ..self }
    }

    fn size(&self) -> (usize, usize) {
        (self.camera.width(), self.camera.height())
    }

    /// A point of light at a place of the image.
    fn light(&self, u_px: f64, v_px: f64, electrons: f64) -> Option<PointLight> {
        let bearing = self.camera.bearing(Pixel::new(u_px, v_px))?;
        let axis = self.camera.model().centre();
        let outward = PointLight::outward([u_px, v_px], [axis.u, axis.v]);
        let off_axis_rad = bearing.off_axis_rad();
        Some(PointLight { u_px, v_px, electrons, off_axis_rad, outward, among: 1.0, ..Default::default() })
    }

    /// What a recording of so many frames shows, with so many LEDs in each, at places and of lights drawn anew.
    pub(crate) fn recorded(&self, frames: u64, leds: usize, seed: u64) -> Collection {
        self.recorded_between([0.0, self.size().1 as f64], frames, leds, seed)
    }

    /// The same of LEDs that are between two rows.
    pub(crate) fn recorded_between(
        &self,
        [top_px, bottom_px]: [f64; 2],
        frames: u64,
        leds: usize,
        seed: u64,
    ) -> Collection {
        let (width, _) = self.size();
        let mut uniform = uniform(seed, 0x1ed5);
        self.rendered(frames, seed, |_| {
            let mut draw = || {
                let (u_px, v_px) = (uniform() * width as f64, top_px + uniform() * (bottom_px - top_px));
                (u_px, v_px, libm::pow(self.brightest_dn / FAINTEST_DN, uniform()))
            };
            (0..leds).map(|_| draw()).collect()
        })
    }

    /// What a camera records that is turned before LEDs that stand still, as its lens dims them off its axis; their lights
    /// wander by `drift` of themselves from frame to frame.
    pub(crate) fn turned(&self, frames: u64, leds: usize, drift: f64, seed: u64) -> Collection {
        let mut uniform = uniform(seed, 0x7a3d);
        let mut normal = move || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
        let mut log_lights: Vec<f64> = (0..leds).map(|_| 1.5 + 0.5 * normal()).collect();
        let directions: Vec<Vector3<f64>> =
            (0..leds).map(|_| Vector3::new(normal(), normal(), normal()).normalize()).collect();
        let (mut turn, mut rate) = (UnitQuaternion::identity(), Vector3::zeros());
        self.rendered(frames, seed, |_| {
            rate = 0.98 * rate + 0.006 * Vector3::new(normal(), normal(), normal());
            turn *= UnitQuaternion::from_scaled_axis(rate);
            log_lights.iter_mut().for_each(|light| *light += drift * normal());
            let seen = directions.iter().zip(&log_lights).filter_map(|(direction, log_light)| {
                let bearing = Bearing::new(turn * direction)?;
                let pixel = self.camera.pixel(&bearing)?;
                let passes = self.preset.lens.illumination(bearing.off_axis_rad());
                Some((pixel.u, pixel.v, passes * libm::exp(*log_light)))
            });
            seen.collect()
        })
    }

    /// Frames of LEDs.
    fn rendered(&self, frames: u64, seed: u64, leds: impl FnMut(u64) -> Vec<Led>) -> Collection {
        let mut collection = Collection::of(&self.camera);
        self.each_frame(frames, seed, leds, |view, _| assert!(collection.add(view, None)));
        collection
    }

    /// Hands over frames of LEDs, and where these are.
    pub(crate) fn each_frame(
        &self,
        frames: u64,
        seed: u64,
        mut leds: impl FnMut(u64) -> Vec<Led>,
        mut with: impl FnMut(&FrameView<'_>, &[Led]),
    ) {
        let (width, height) = self.size();
        let sensor = &self.preset.sensor;
        let mut readout = Readout::of_unit(sensor, (width, height), 1);
        let (mut charge, mut background) = (Charge::new(width, height), Background::new(width, height));
        let electrons = |u: usize, v: usize| (self.sky_dn)(u as f64, v as f64) * sensor.electrons_per_dn;
        background.fill(|u, v| electrons(u, v) as f32);
        let mut pixels = vec![0; width * height];
        let summit = self.truth([0.5 * width as f64, 0.5 * height as f64]).share(0.0, 0.0);
        for frame in 0..frames {
            charge.clear();
            let leds = leds(frame);
            for &(u_px, v_px, brighter) in &leds {
                let levels = FAINTEST_DN * brighter / summit;
                if let Some(light) = self.light(u_px, v_px, levels * sensor.electrons_per_dn) {
                    self.preset.lens.spread.draw(&light, &mut charge);
                }
            }
            for &(column, row, level_dn) in &self.hot {
                charge.add(column, row, (level_dn * sensor.electrons_per_dn) as f32);
            }
            let key = seed << 20 | frame;
            readout.expose(&mut charge, key);
            for (row, pixels) in pixels.chunks_exact_mut(width).enumerate() {
                readout.read_row(row, &background, &charge, key, pixels);
            }
            with(&FrameView::packed(&pixels, width, height).expect("whole rows"), &leds);
        }
    }

    /// The point spread at a place, its light's centroid at the point.
    pub(crate) fn truth(&self, place: [f64; 2]) -> PointSpread {
        const MIDDLE: usize = 20;
        let drawn = |x: f64, y: f64| -> Charge {
            let mut charge = Charge::new(2 * MIDDLE + 1, 2 * MIDDLE + 1);
            let light = self.light(place[0], place[1], 1e7).expect("a place in the field");
            let (u_px, v_px) = (MIDDLE as f64 + x, MIDDLE as f64 + y);
            self.preset.lens.spread.draw(&PointLight { u_px, v_px, ..light }, &mut charge);
            charge
        };
        let mut centroid = [0.0; 2];
        let mut light = 0.0;
        for phase in 0..64 {
            let (x, y) = (f64::from(phase % 8) / 8.0, f64::from(phase / 8) / 8.0);
            let charge = drawn(x, y);
            for v in 0..charge.height() {
                for (u, &electrons) in charge.row(v).iter().enumerate() {
                    let electrons = f64::from(electrons);
                    light += electrons;
                    centroid[0] += electrons * (u as f64 - MIDDLE as f64 - x);
                    centroid[1] += electrons * (v as f64 - MIDDLE as f64 - y);
                }
            }
        }
        let [off_u, off_v] = centroid.map(|sum| sum / light);
        let per_px = PointSpread::SAMPLES_PER_PX;
        let half = per_px * PointSpread::REACH_PX;
        let mut samples = vec![0.0; PointSpread::SIDE * PointSpread::SIDE];
        for phase in 0..per_px * per_px {
            let (a, b) = (phase % per_px, phase / per_px);
            // the centroid lies so many quarters of a pixel left of and above the middle
            let charge = drawn(-(a as f64) / per_px as f64 - off_u, -(b as f64) / per_px as f64 - off_v);
            for (index, sample) in samples.iter_mut().enumerate() {
                let (column, row) = (index % PointSpread::SIDE, index / PointSpread::SIDE);
                let from = |at: usize, phase: usize| {
                    let offset = at as isize - half as isize - phase as isize;
                    (offset.rem_euclid(per_px as isize) == 0)
                        .then(|| (MIDDLE as isize + offset / per_px as isize) as usize)
                };
                if let (Some(u), Some(v)) = (from(column, a), from(row, b)) {
                    *sample = f64::from(charge.at(u, v)) / (light / 64.0);
                }
            }
        }
        PointSpread::new(samples).expect("a point spread")
    }
}

/// Even numbers from 0 to 1.
pub(crate) fn uniform(seed: u64, stream: u128) -> impl FnMut() -> f64 {
    let mut random = Pcg64::new(u128::from(seed), stream);
    move || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

/// How a table differs from the truth: rms over its summit, within so many px; and its width over the true one, less 1.
pub(crate) fn difference(found: &PointSpread, truth: &PointSpread, within_px: f64) -> (f64, f64) {
    let summit = truth.share(0.0, 0.0);
    let (mut square, mut count) = (0.0, 0.0);
    let mut widths = [[0.0; 2]; 2];
    for (index, (found, truth)) in found.samples().iter().zip(truth.samples()).enumerate() {
        let place = |at: usize| at as f64 / PointSpread::SAMPLES_PER_PX as f64 - PointSpread::REACH_PX as f64;
        let (x, y) = (place(index % PointSpread::SIDE), place(index / PointSpread::SIDE));
        if x.abs().max(y.abs()) <= within_px {
            square += ((found - truth) / summit) * ((found - truth) / summit);
            count += 1.0;
        }
        if libm::hypot(x, y) <= 5.0 {
            for (width, share) in widths.iter_mut().zip([found, truth]) {
                *width = [width[0] + share, width[1] + share * (x * x + y * y)];
            }
        }
    }
    let [found_px, true_px] = widths.map(|[sum, second]| (0.5 * second / sum).sqrt());
    (f64::sqrt(square / count), found_px / true_px - 1.0)
}
