//! The stages in order: read this first.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::background::Background;
use super::breadth::Breadths;
use super::detection_limit::{self, Step};
use super::grouping::Components;
use super::measuring::Meter;
use super::neighbourhood::Neighbourhood;
use super::odds::{self, Look};
use super::part::{Part, outline};
use super::rejection::Reason;
use super::runs::{Run, Runs};
use super::settings::{Brightness, Settings, SettingsError};
use super::splitting::{Ground, Splitter};
use super::{Detections, Extent, Rejected};
use crate::frame::{FrameError, FrameView, Mask};
use crate::optics::{LogLight, Optics};

/// Finds spots in frames. Keeps its room from frame to frame, so that a warm detector allocates nothing.
#[derive(Debug)]
pub struct Detector {
    settings: Settings,
    background: Background,
    runs: Runs,
    components: Components,
    splitter: Splitter,
    part_runs: Vec<Run>,
    parts: Vec<Part>,
    /// Components that were split, whole.
    split: Vec<Part>,
    neighbourhood: Neighbourhood,
    meter: Meter,
    /// How each spot looks by itself, and how wide they are.
    looks: Vec<Look>,
    breadths: Breadths,
    detections: Detections,
    /// The middle of the last frame, px.
    middle: Option<[usize; 2]>,
}

impl Detector {
    /// A detector with these settings.
    ///
    /// # Errors
    /// [`SettingsError`] when one of them has no meaning.
    pub fn new(settings: Settings) -> Result<Self, SettingsError> {
        Self::with_optics(settings, None)
    }

    /// The same for a camera whose optics were measured.
    ///
    /// # Errors
    /// [`SettingsError`] when a setting has no meaning.
    pub fn with_optics(settings: Settings, optics: Option<Arc<Optics>>) -> Result<Self, SettingsError> {
        settings.check()?;
        Ok(Self {
            settings,
            background: Background::default(),
            runs: Runs::default(),
            components: Components::default(),
            splitter: Splitter::default(),
            part_runs: Vec::new(),
            parts: Vec::new(),
            split: Vec::new(),
            neighbourhood: Neighbourhood::default(),
            meter: Meter::new(&settings, optics),
            looks: Vec::new(),
            breadths: Breadths::default(),
            detections: Detections::default(),
            middle: None,
        })
    }

    /// The settings in use.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Finds the spots of `frame`; where `mask` says to ignore, what is bright is rejected.
    ///
    /// # Errors
    /// [`FrameError::MaskSize`] when the mask is of another size than the frame.
    pub fn detect(&mut self, frame: &FrameView<'_>, mask: Option<&Mask>) -> Result<&Detections, FrameError> {
        if let Some(mask) = mask {
            mask.check_size(frame.width(), frame.height())?;
        }
        self.middle = Some([frame.width() / 2, frame.height() / 2]);
        self.background.measure(frame, self.settings.brightness);
        self.components.group(self.runs.find(frame, &self.background));
        self.outline_parts(frame, mask);
        self.judge_outlines(frame.width() * frame.height());
        self.measure_parts(frame);
        odds::weigh(&mut self.detections, &self.looks, &mut self.breadths, &self.settings.shape);
        self.detections.rejected.sort_unstable_by_key(|rejected| {
            let Extent { top, left, bottom, right } = rejected.extent;
            (top, left, bottom, right, rejected.area_px)
        });
        Ok(&self.detections)
    }

    /// Light at which a point is found half of the time in the frame that was handed last, grey levels, and how much that differs from point to point; in the
    /// middle of the image. `None` before a frame.
    pub fn detection_limit(&self) -> Option<LogLight> {
        self.middle.map(|middle| self.meter.detection_limit(self.background.step_above_dark(middle), middle))
    }

    /// The same of any detector with these settings, before any lens.
    pub(crate) fn any_detection_limit(settings: &Settings) -> LogLight {
        let (Brightness::Threshold(step) | Brightness::Contrast(step)) = settings.brightness;
        detection_limit::of_any_lens(Step { step_dn: f64::from(step), noise_dn: 0.0 })
    }

    /// Whether frames still tell something of the camera: its point spread, noise and full level are learnt from the first frames that
    /// show spots, unless they were measured.
    pub fn learns(&self) -> bool {
        self.meter.learns()
    }

    fn outline_parts(&mut self, frame: &FrameView<'_>, mask: Option<&Mask>) {
        self.parts.clear();
        self.split.clear();
        for component in 0..self.components.len() {
            let runs = self.components.runs(component);
            let level = self.background.level(usize::from(runs[0].start), usize::from(runs[0].v));
            let ground = Ground { level, noise: self.settings.noise };
            let Some(split) = self.splitter.split(frame, runs, ground) else {
                self.parts.push(outline(frame, &self.background, runs, mask));
                continue;
            };
            for part in split.chunk_by(|a, b| a.0 == b.0) {
                self.part_runs.clear();
                self.part_runs.extend(part.iter().map(|&(_, run)| run));
                let part = outline(frame, &self.background, &self.part_runs, mask);
                self.parts.push(Part { split_from: Some(self.split.len()), ..part });
            }
            self.split.push(outline(frame, &self.background, runs, mask));
        }
        self.meter.join_smeared(frame, &mut self.parts, &self.split);
        self.parts.sort_unstable_by_key(|part| part.first);
    }

    fn judge_outlines(&mut self, pixels: usize) {
        let shape = &self.settings.shape;
        for part in &mut self.parts {
            part.reason = part.outline.reject(shape);
            if part.outline.is_streak(shape) && !self.meter.is_smeared() {
                part.clutter_odds += odds::LONG_AND_THIN;
            }
            if part.outline.area_px == 1 && part.noise_dn > 0.0 {
                let sigmas = (f64::from(part.outline.peak) - part.dark_dn) / part.noise_dn;
                part.clutter_odds += odds::of_noise(sigmas, pixels);
            }
        }
        for i in 0..self.parts.len() {
            if self.parts[i].reason == Some(Reason::Sun) {
                let sun = self.parts[i].outline;
                for part in self.parts.iter_mut().filter(|part| part.outline.is_in_glare_of(&sun)) {
                    part.clutter_odds += odds::BESIDE_SUN;
                }
            }
        }
    }

    fn measure_parts(&mut self, frame: &FrameView<'_>) {
        self.neighbourhood.arrange(frame, self.parts.iter().map(|part| (part.guess, part.radius_px)));
        self.detections.spots.clear();
        self.detections.rejected.clear();
        self.looks.clear();
        self.meter.fit(frame, &self.parts, &self.neighbourhood);
        for i in 0..self.parts.len() {
            let part = self.parts[i];
            let measured = match part.reason {
                Some(reason) => Err(reason),
                None => {
                    let room_px = self.neighbourhood.room_px(i, part.most_room_px());
                    self.meter.measure(frame, i, &part, room_px, &self.settings)
                }
            };
            match measured {
                Ok(spot) => {
                    self.detections.spots.push(spot);
                    let size = [frame.width(), frame.height()];
                    let clutter_odds = part.clutter_odds + self.meter.clutter_odds(&part, size);
                    let (is_point, area) = (self.meter.is_point(i), self.meter.effective_area());
                    self.looks.push(Look { clutter_odds, is_point, area });
                }
                Err(reason) => self.detections.rejected.push(Rejected {
                    centre: part.guess,
                    area_px: part.outline.area_px,
                    peak: part.outline.peak,
                    reason,
                    extent: part.outline.extent,
                }),
            }
        }
    }
}
