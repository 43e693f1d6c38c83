//! A camera of a scene while it flies: what it is asked to expose comes in, frames rendered with that come out, so that what sets the exposure can be
//! tried in a closed loop.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use photinus_io::frames::{Frame, Moved};
use photinus_io::{Error, Result};
use photinus_run::Entry;
use photinus_run::source::{Next, Opener, Source, Takeoff};
use photinus_sim::scene::Scene;
use photinus_sim::snapshot::Exposure;
use photinus_sim::{Rendered, Simulator};

/// One camera of a scene.
pub(crate) struct Simulated {
    scene: Arc<Scene>,
    camera: usize,
    simulator: Simulator,
    /// The frame that comes next.
    number: u64,
    /// When the scene's clock showed 0 by ours; without, frames come as fast as they are taken.
    began: Option<Instant>,
    repeat: bool,
}

impl Simulated {
    /// What opens a camera of a scene, `name` where it has several. `exposure_us` stands in place of what the scene says; with `repeat` the scene goes on
    /// past its duration.
    ///
    /// # Errors
    /// [`Error`] when the scene cannot be read, or has several cameras or none of that name.
    pub(crate) fn opener(
        path: &Path,
        name: Option<&str>,
        exposure_us: Option<f64>,
        takeoff: Option<Takeoff>,
        repeat: bool,
    ) -> Result<Opener> {
        let scene = Arc::new(Scene::read(path)?);
        let names: Vec<&str> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
        let place = match (names.as_slice(), name) {
            ([_], None) => Some(0),
            _ => names.iter().position(|camera| Some(*camera) == name),
        };
        let simulator = place.and_then(|camera| Some((camera, Simulator::new(scene.clone(), camera)?)));
        let Some((camera, mut simulator)) = simulator else {
            let advice = format!("give `camera` in the source, one of: {}", names.join(", "));
            return Err(
                Error::format(path, "the scene has several cameras, or none of this name").advise(advice)
            );
        };
        exposure_us.into_iter().for_each(|exposure_us| simulator.set_exposure_us(exposure_us));
        let opened = move || Self {
            scene: scene.clone(),
            camera,
            simulator: simulator.clone(),
            number: 0,
            began: takeoff.as_ref().map(Takeoff::at),
            repeat,
        };
        Ok(Box::new(move || Ok(Box::new(opened()) as Box<dyn Source>)))
    }

    /// Frames that a camera had taken while this one rendered are passed over: how many.
    fn skip(&mut self) -> u64 {
        let Some(began) = self.began else { return 0 };
        let first = self.number;
        while due(began, &self.simulator.exposure(self.number + 1)) < Instant::now() {
            self.number += 1;
        }
        self.number - first
    }

    /// As a recording of the scene says it, with the pixels that it shows; `None` of a frame that is lost.
    fn entry(&mut self, rendered: Rendered, exposure: &Exposure) -> Option<Entry> {
        let taken = self.scene.take(self.camera, self.scene.frames, &rendered)?;
        let Rendered { image, .. } = match taken.shown == rendered.truth.frame {
            true => rendered,
            false => self.simulator.frame(taken.shown),
        };
        let frame = Frame {
            image,
            index: taken.truth.frame,
            // Cameras that fly tell when an exposure began, scenes its middle.
            time_s: Some(taken.truth.time_s - 0.5 * exposure.length_s),
            source: self.scene.name.clone(),
            gravity: Some(taken.gravity),
            exposure_s: None,
            moved: Moved::default(),
            conversions: Vec::new(),
        };
        Some(Entry { exposure_s: Some(exposure.length_s), ..Entry::from_frame(frame) })
    }
}

impl Source for Simulated {
    fn next(&mut self) -> Next {
        let mut dropped = 0;
        loop {
            dropped += self.skip();
            if self.number >= self.scene.frames && !self.repeat {
                return Next::End;
            }
            let exposure = self.simulator.exposure(self.number);
            let rendered = self.simulator.frame(self.number);
            self.number += 1;
            let Some(mut entry) = self.entry(rendered, &exposure) else {
                dropped += 1;
                continue;
            };
            entry.dropped = dropped;
            if let Some(began) = self.began {
                let (due, now) = (due(began, &exposure), Instant::now());
                std::thread::sleep(due.saturating_duration_since(now));
                entry.taken = Some(due.max(now));
            }
            return Next::Frame(entry);
        }
    }

    fn expose(&mut self, exposure_us: f64) -> Option<f64> {
        self.simulator.set_exposure_us(exposure_us);
        Some(exposure_us)
    }
}

/// When an exposure ends by our clock.
fn due(began: Instant, exposure: &Exposure) -> Instant {
    began + Duration::try_from_secs_f64(exposure.start_s + exposure.span_s()).unwrap_or_default()
}
