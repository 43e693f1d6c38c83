//! Cameras while they run: each is read by a thread and located by another, with room for one frame between them, and all hand to the same sinks.
//!
//! ```text
//! reader   opens the source, opens it anew when it is lost     -> frames
//! slot     room for one frame, the newest wins                 -> the newest frame
//! lane     what is counted of the camera                       -> its health
//! merged   without threads: frames of files by their times     -> every frame
//! ```
//! Every camera is located by itself today: nothing is fused between them but the frame of the body that results are told in.

mod check;
mod lane;
mod merged;
mod reader;
mod slot;
#[cfg(test)]
mod tests;

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use photinus_io::{Error, Result};

use crate::exposure::Exposure;
use crate::health::{Health, Level, Notice, Recent};
use crate::sink::{Fan, FullQueue, Outlets, Sink};
use crate::source::{Opener, Source};
use crate::{Clock, Entry, HostClock, Oddity, Outlet, Quantiles, View, source_name};
use lane::Lane;
use merged::Merged;

/// Health is told so often.
const EVERY: Duration = Duration::from_secs(1);
/// How long the thread that supervises sleeps at a time.
const NAP: Duration = Duration::from_millis(5);
/// So long may sinks take to write what waits for them at the end.
const PATIENCE: Duration = Duration::from_secs(2);
/// So long may a camera take to end its wait.
const READER_PATIENCE: Duration = Duration::from_millis(500);
/// After this many failed frames of a camera the others are only counted.
const REPORTED_FAILURES: u64 = 10;

/// A camera that is to run.
pub struct Camera {
    /// What it is called.
    pub name: String,
    /// Opens its frames.
    pub source: Opener,
    /// What looks through it.
    pub view: View,
    /// What sets its exposure, where something does.
    pub exposure: Option<Exposure>,
}

/// How fast frames are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pace {
    /// As they come: of each camera the newest wins.
    #[default]
    Live,
    /// As fast as possible, for files: nothing is dropped, and frames of all cameras come in the order of their times.
    Fast,
}

/// What a run came to.
#[derive(Clone, Debug)]
pub struct Report {
    /// How it was doing at its end.
    pub health: Health,
    /// From the end of the exposure until the result was handed to the sinks, of each camera, ms.
    pub latencies_ms: Vec<Quantiles>,
    /// How late a thread that had nothing to do woke up, ms: what of the latencies is the machine's.
    pub wake_up_ms: Quantiles,
    /// Sinks that did not end in time; what waited for them is lost.
    pub stuck: Vec<String>,
}

/// Whether a run is to end.
pub type IsOver = Arc<dyn Fn() -> bool + Send + Sync>;

/// Runs the cameras until their frames are at their end, or `is_over`; `told` hears what a person should know.
///
/// # Errors
/// [`Error`] when the system gives no threads, or in fast pace a source cannot be opened.
pub fn run(
    cameras: Vec<Camera>,
    sinks: Vec<Box<dyn Sink>>,
    pace: Pace,
    is_over: IsOver,
    told: &mut dyn FnMut(&Notice),
) -> Result<Report> {
    let clock = HostClock::start();
    let (sender, notices) = channel();
    let shared = Arc::new(Shared { is_over, clock, notices: Mutex::new(sender) });
    let full = if pace == Pace::Live { FullQueue::DropOldest } else { FullQueue::Wait };
    let teller = shared.clone();
    let outlets = Outlets::open(sinks, full, move |level, text| teller.tell(level, text));
    let outlets = outlets.map_err(|error| Error::io("threads", error))?;
    let name = |(number, camera): (usize, &Camera)| Arc::new(Lane::new(camera.name.clone(), number));
    let lanes: Vec<Arc<Lane>> = cameras.iter().enumerate().map(name).collect();
    let desk = Desk {
        lanes: lanes.clone(),
        fan: outlets.fan(),
        shared: shared.clone(),
        exposures: Vec::new(),
        at: Arc::default(),
        late_ms: Arc::default(),
    };
    let threads = match pace {
        Pace::Live => live(cameras, &lanes, &desk, &shared)?,
        Pace::Fast => vec![fast(cameras, desk.clone())?],
    };
    let wake_up_ms = supervise(&desk, &notices, &threads.iter().collect::<Vec<_>>(), told);
    threads.into_iter().for_each(|thread| drop(thread.join()));
    let health = Arc::new(desk.health());
    desk.fan.health(&health);
    let latencies_ms = lanes.iter().map(|lane| lane.latencies_ms()).collect();
    let fan = outlets.fan();
    let stuck = outlets.finish(PATIENCE);
    notices.try_iter().for_each(|notice| told(&notice));
    Ok(Report { health: Health { sinks: fan.sinks(), ..(*health).clone() }, latencies_ms, wake_up_ms, stuck })
}

/// What all threads of a run know.
pub(super) struct Shared {
    is_over: IsOver,
    clock: HostClock,
    notices: Mutex<Sender<Notice>>,
}

impl Shared {
    fn is_over(&self) -> bool {
        (self.is_over)()
    }

    fn tell(&self, level: Level, text: String) {
        let notice = Notice { level, up_s: self.clock.up_s(), text };
        // Nobody listens any more at the very end.
        let _ = self.notices.lock().unwrap_or_else(PoisonError::into_inner).send(notice);
    }
}

/// Two threads per camera; those that locate.
fn live(
    cameras: Vec<Camera>,
    lanes: &[Arc<Lane>],
    desk: &Desk,
    shared: &Arc<Shared>,
) -> Result<Vec<std::thread::JoinHandle<()>>> {
    let mut locating = Vec::new();
    for (camera, lane) in cameras.into_iter().zip(lanes) {
        let (own, common) = (lane.clone(), shared.clone());
        let reading = spawn("read", move || reader::read(&own, camera.source, &common))?;
        let (lane, shared, mut view) = (lane.clone(), shared.clone(), camera.view);
        let at = Arc::new(AtomicUsize::new(lane.number));
        let mut desk = Desk { exposures: vec![camera.exposure], at, ..desk.clone() };
        locating.push(spawn("locate", move || {
            let entries = std::iter::from_fn(|| lane.slot.take(&|| shared.is_over()));
            let Ok(()) = crate::run(entries, &mut view, &mut desk, &mut Clock::new());
            lane.interrupt();
            let until = Instant::now() + READER_PATIENCE;
            // One that waits for a pipe that never ends is left alone.
            while !reading.is_finished() && Instant::now() < until {
                std::thread::sleep(Duration::from_millis(2));
            }
        })?);
    }
    Ok(locating)
}

/// One thread for all cameras.
fn fast(cameras: Vec<Camera>, desk: Desk) -> Result<std::thread::JoinHandle<()>> {
    let (mut sources, mut views, mut exposures) = (Vec::<Box<dyn Source>>::new(), Vec::new(), Vec::new());
    for mut camera in cameras {
        sources.push((camera.source)()?);
        views.push(camera.view);
        exposures.push(camera.exposure);
    }
    let mut desk = Desk { exposures, ..desk };
    spawn("locate", move || {
        let Ok(()) = crate::run(
            Merged::new(sources, desk.lanes.clone(), desk.at.clone()),
            &mut views,
            &mut desk,
            &mut Clock::new(),
        );
        desk.lanes.iter().for_each(|lane| lane.end());
    })
}

fn spawn(name: &str, work: impl FnOnce() + Send + 'static) -> Result<std::thread::JoinHandle<()>> {
    let thread = std::thread::Builder::new().name(name.to_owned()).spawn(work);
    thread.map_err(|error| Error::io("threads", error))
}

/// Hands on notices and tells health until the threads have ended; leaves how late it woke up, ms.
fn supervise(
    desk: &Desk,
    notices: &Receiver<Notice>,
    threads: &[&std::thread::JoinHandle<()>],
    told: &mut dyn FnMut(&Notice),
) -> Quantiles {
    let mut next = Instant::now() + EVERY;
    let mut all_ms = Quantiles::default();
    while threads.iter().any(|thread| !thread.is_finished()) {
        let asleep = Instant::now();
        match notices.recv_timeout(NAP) {
            Ok(notice) => {
                told(&notice);
                desk.fan.notice(&Arc::new(notice));
            }
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => {
                let late_ms = 1e3 * asleep.elapsed().saturating_sub(NAP).as_secs_f64();
                all_ms.add(late_ms);
                desk.late_ms.lock().unwrap_or_else(PoisonError::into_inner).add(late_ms);
            }
        }
        if Instant::now() >= next {
            desk.fan.health(&Arc::new(desk.health()));
            next += EVERY;
        }
    }
    all_ms
}

/// Stands at the end of the loop: frames are counted and handed to the sinks.
#[derive(Clone)]
struct Desk {
    lanes: Vec<Arc<Lane>>,
    fan: Fan,
    shared: Arc<Shared>,
    /// Of the cameras whose frames come here: of all in their order, or of the only one.
    exposures: Vec<Option<Exposure>>,
    /// Which camera the frame is of that is worked on.
    at: Arc<AtomicUsize>,
    late_ms: Arc<Mutex<Recent>>,
}

impl Desk {
    fn health(&self) -> Health {
        let cameras = self.lanes.iter().map(|lane| lane.health()).collect();
        let wake_up_ms = self.late_ms.lock().unwrap_or_else(PoisonError::into_inner).spread();
        Health { up_s: self.shared.clock.up_s(), wake_up_ms, cameras, sinks: self.fan.sinks() }
    }
}

/// Nothing ends a run but its end.
type Never = std::convert::Infallible;

impl Outlet for Desk {
    type End = Never;

    fn is_over(&mut self) -> bool {
        self.shared.is_over()
    }

    fn frame(
        &mut self,
        entry: Entry,
        oddity: Option<Oddity>,
        _clock: &mut Clock,
    ) -> std::result::Result<(), Never> {
        let lane = self.lanes[entry.camera].clone();
        lane.count(&entry);
        let own = if self.exposures.len() == 1 { 0 } else { entry.camera };
        if let Some(Some(exposure)) = self.exposures.get_mut(own)
            && let Some(exposure_us) = exposure.after(&entry)
        {
            lane.slot.wish(exposure_us);
        }
        if let Some(oddity) = oddity
            && lane.is_first(oddity)
        {
            let (source, frame) = (source_name(&entry), entry.number());
            let told = format!("{}: {source}, frame {frame}: {oddity} (said once)", lane.name);
            self.shared.tell(Level::Warning, told);
        }
        self.fan.frame(entry);
        Ok(())
    }

    fn failed(&mut self, error: Error) {
        let lane = &self.lanes[self.at.load(Ordering::Relaxed)];
        if lane.count_failed() <= REPORTED_FAILURES {
            self.shared.tell(Level::Error, format!("{}: {error}", lane.name));
        }
    }

    fn note(&mut self, text: String) {
        self.shared.tell(Level::Note, text);
    }

    fn warn(&mut self, text: String) {
        self.shared.tell(Level::Warning, text);
    }
}
