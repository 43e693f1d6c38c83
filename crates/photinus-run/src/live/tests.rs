use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use photinus::airframe::{Airframe, Ring};
use photinus::camera::{Ideal, IdealLaw, Model, Pixel};
use photinus::locator::{Kind, Settings};
use photinus_io::Error;
use photinus_io::frames::{Frame, Moved, Together};
use photinus_io::image::GreyImage;

use super::slot::Slot;
use super::*;
use crate::health::CameraState;
use crate::source::Next;

fn view() -> View {
    let lens = Ideal::new(IdealLaw::Equidistant, [20.0; 2], Pixel::new(31.5, 23.5)).unwrap();
    let camera = photinus::camera::Camera::new(Model::Ideal(lens), 64, 48, None).unwrap();
    let ring = Ring { arms: 4, radius_m: 0.3, leds_per_arm: 1, splay_rad: 0.0 };
    let settings = Settings::default();
    let quad = Kind::new(Airframe::from_ring("quad", ring).unwrap(), &settings.pose);
    View::new(camera, &[quad], None, settings, None).unwrap()
}

fn frame(index: u64, time_s: f64) -> Entry {
    let image = GreyImage::new(vec![0; 64 * 48], 64, 48).unwrap();
    let frame = Frame {
        image,
        index,
        time_s: Some(time_s),
        source: "fake".to_owned(),
        gravity: None,
        exposure_s: None,
        moved: Moved::default(),
        conversions: Vec::new(),
    };
    Entry { taken: Some(Instant::now()), ..Entry::from_frame(frame) }
}

/// What a camera does, step by step.
struct Script(VecDeque<Step>);

enum Step {
    Frame(u64, f64),
    Wait(Duration),
    Lose,
    Panic,
}

impl Source for Script {
    fn next(&mut self) -> Next {
        loop {
            match self.0.pop_front() {
                Some(Step::Frame(index, time_s)) => return Next::Frame(frame(index, time_s)),
                Some(Step::Wait(pause)) => std::thread::sleep(pause),
                Some(Step::Lose) => return Next::Lost(Error::format("fake", "somebody pulled the plug")),
                Some(Step::Panic) => panic!("a driver does not know what to do"),
                None => return Next::End,
            }
        }
    }
}

fn camera(name: &str, steps: impl IntoIterator<Item = Step>) -> Camera {
    let mut steps = Some(steps.into_iter().collect::<VecDeque<Step>>());
    let source: Opener = Box::new(move || {
        let script = steps.take().ok_or_else(|| Error::format("fake", "it is not there"))?;
        Ok(Box::new(Script(script)) as Box<dyn Source>)
    });
    Camera { name: name.to_owned(), source, view: view(), exposure: None }
}

/// Frames at a pace that every sink of a test keeps up with.
fn paced(count: u64) -> impl Iterator<Item = Step> {
    (0..count)
        .flat_map(|index| [Step::Wait(Duration::from_millis(3)), Step::Frame(index, 0.01 * index as f64)])
}

/// Frames that a sink was given: camera and number.
type Given = Arc<Mutex<Vec<(String, u64)>>>;

struct Good(Given, Arc<AtomicBool>);

impl Sink for Good {
    fn name(&self) -> String {
        "good".to_owned()
    }

    fn frame(&mut self, entry: &Entry) -> Result<()> {
        let camera = entry.record.camera.clone().unwrap_or_default();
        self.0.lock().unwrap().push((camera, entry.number()));
        Ok(())
    }

    fn finish(&mut self) -> Result<()> {
        self.1.store(true, Ordering::Relaxed);
        Ok(())
    }
}

/// A sink that does something bad with the frame of this number.
struct Bad(u64, fn() -> Result<()>);

impl Sink for Bad {
    fn name(&self) -> String {
        format!("bad {}", self.0)
    }

    fn frame(&mut self, entry: &Entry) -> Result<()> {
        if entry.number() == self.0 { (self.1)() } else { Ok(()) }
    }
}

fn until_the_end() -> IsOver {
    Arc::new(|| false)
}

#[test]
fn the_newest_frame_wins_and_every_older_one_is_counted() {
    let slot = Slot::default();
    (0..5).for_each(|index| slot.put(frame(index, 0.0)));
    let taken = slot.take(&|| false).unwrap().unwrap();
    assert_eq!((taken.number(), taken.dropped, slot.dropped()), (4, 4, 4));
    slot.put(frame(5, 0.0));
    assert_eq!(slot.take(&|| false).unwrap().unwrap().dropped, 0);
    assert!(slot.take(&|| true).is_none());
}

#[test]
fn a_sink_that_is_stuck_fails_or_panics_disturbs_no_other() {
    let (given, finished) = (Given::default(), Arc::new(AtomicBool::new(false)));
    let stuck: fn() -> Result<()> = || {
        std::thread::sleep(Duration::from_secs(3600));
        Ok(())
    };
    let sinks: Vec<Box<dyn Sink>> = vec![
        Box::new(Bad(3, stuck)),
        Box::new(Bad(5, || Err(Error::format("disk", "no space is left")))),
        Box::new(Bad(7, || panic!("of its own making"))),
        Box::new(Good(given.clone(), finished.clone())),
    ];
    let mut told = Vec::new();
    let report = run(vec![camera("a", paced(100))], sinks, Pace::Live, until_the_end(), &mut |notice| {
        told.push(notice.clone());
    })
    .unwrap();
    let sinks = &report.health.sinks;
    let camera = &report.health.cameras[0];
    assert_eq!(camera.frames + camera.dropped, 100, "every frame is located or counted");
    assert_eq!(given.lock().unwrap().len() as u64, camera.frames, "the good sink has all of them");
    assert_eq!((sinks[3].dropped, sinks[3].finished, finished.load(Ordering::Relaxed)), (0, true, true));
    assert_eq!(report.stuck, ["bad 3"]);
    assert!(sinks[0].running && sinks[0].dropped > 0 && sinks[0].waiting <= 32, "{:?}", sinks[0]);
    assert!(
        !sinks[1].running && !sinks[2].running && sinks[1].dropped + sinks[1].written < camera.frames + 1
    );
    let errors = told.iter().filter(|notice| notice.level == Level::Error).map(|notice| notice.text.as_str());
    let errors = errors.collect::<Vec<_>>().join("\n");
    assert!(
        errors.contains("no space is left; nothing more goes there") && errors.contains("of its own making"),
        "{errors}"
    );
}

#[test]
fn a_camera_that_vanishes_is_tried_again_and_said_so_while_others_go_on() {
    let opened = Arc::new(AtomicUsize::new(0));
    let count = opened.clone();
    let source: Opener = Box::new(move || match count.fetch_add(1, Ordering::Relaxed) {
        0 => Ok(Box::new(Script(VecDeque::from([
            Step::Frame(0, 0.0),
            Step::Wait(Duration::from_millis(20)),
            Step::Lose,
        ]))) as Box<dyn Source>),
        1 | 2 => Err(Error::format("fake", "it is not there")),
        _ => {
            Ok(Box::new(Script(VecDeque::from([Step::Frame(1, 1.0), Step::Wait(Duration::from_millis(20))]))))
        }
    });
    let lost = Camera { name: "lost".to_owned(), source, view: view(), exposure: None };
    let given = Given::default();
    let good = Good(given.clone(), Arc::default());
    let mut told = Vec::new();
    let report = run(
        vec![lost, camera("other", paced(50))],
        vec![Box::new(good)],
        Pace::Live,
        until_the_end(),
        &mut |notice| {
            told.push(notice.text.clone());
        },
    )
    .unwrap();
    assert_eq!(opened.load(Ordering::Relaxed), 4);
    let [lost, other] = &report.health.cameras[..] else { panic!("two") };
    assert_eq!((lost.frames, lost.lost, lost.state), (2, 1, CameraState::Ended));
    assert_eq!((other.frames + other.dropped, other.lost), (50, 0));
    assert_eq!(
        told.iter().filter(|text| text.contains("pulled the plug; tried again")).count(),
        1,
        "{told:?}"
    );
    assert_eq!(told.iter().filter(|text| text.contains("lost: it is back")).count(), 1, "{told:?}");
    assert_eq!(given.lock().unwrap().iter().filter(|(camera, _)| camera == "lost").count(), 2);
}

#[test]
fn fast_drops_nothing_and_takes_all_cameras_in_the_order_of_time() {
    let steps = |from_s: f64| (0..200).map(move |index| Step::Frame(index, from_s + 0.1 * index as f64));
    let given = Given::default();
    let slow = Good(given.clone(), Arc::default());
    let report = run(
        vec![camera("a", steps(0.05)), camera("b", steps(0.0))],
        vec![Box::new(slow)],
        Pace::Fast,
        until_the_end(),
        &mut |_| (),
    )
    .unwrap();
    let expected: Vec<(String, u64)> =
        (0..200).flat_map(|index| [("b".to_owned(), index), ("a".to_owned(), index)]).collect();
    assert_eq!(*given.lock().unwrap(), expected);
    assert!(report.health.cameras.iter().all(|camera| camera.dropped == 0 && camera.frames == 200));
}

/// Frames whose times and places in a run are given.
struct Taken(VecDeque<(f64, u64)>);

impl Source for Taken {
    fn next(&mut self) -> Next {
        let Some((time_s, order)) = self.0.pop_front() else { return Next::End };
        let mut entry = frame(order, time_s);
        entry.moved.together = Some(Together { order, turned: None });
        Next::Frame(entry)
    }
}

#[test]
fn frames_that_a_run_followed_together_come_as_it_took_them_in() {
    let taken = |name: &str, frames: &[(f64, u64)]| {
        let frames: VecDeque<(f64, u64)> = frames.iter().copied().collect();
        Camera { source: Box::new(move || Ok(Box::new(Taken(frames.clone())))), ..camera(name, []) }
    };
    let given = Given::default();
    let cameras = vec![
        taken("a", &[(0.00, 0), (0.05, 3), (0.10, 4)]),
        taken("b", &[(0.02, 2), (0.07, 5)]),
        taken("c", &[(0.01, 1), (0.06, 6)]),
    ];
    let sink = Good(given.clone(), Arc::default());
    run(cameras, vec![Box::new(sink)], Pace::Fast, until_the_end(), &mut |_| ()).unwrap();
    let orders: Vec<u64> = given.lock().unwrap().iter().map(|(_, number)| *number).collect();
    assert_eq!(orders, [0, 1, 2, 3, 4, 5, 6]);
}

#[test]
fn a_run_ends_when_it_is_asked_even_where_a_camera_waits_for_ever() {
    let asked = Arc::new(AtomicBool::new(false));
    let is_over = asked.clone();
    let steps = [Step::Frame(0, 0.0), Step::Wait(Duration::from_secs(3600))];
    let (given, finished) = (Given::default(), Arc::new(AtomicBool::new(false)));
    let wanted = asked.clone();
    struct Asks(Arc<AtomicBool>);
    impl Sink for Asks {
        fn name(&self) -> String {
            "asks".to_owned()
        }
        fn frame(&mut self, _entry: &Entry) -> Result<()> {
            self.0.store(true, Ordering::Relaxed);
            Ok(())
        }
    }
    let sinks: Vec<Box<dyn Sink>> =
        vec![Box::new(Good(given.clone(), finished.clone())), Box::new(Asks(wanted))];
    let is_over: IsOver = Arc::new(move || is_over.load(Ordering::Relaxed));
    let report = run(vec![camera("a", steps)], sinks, Pace::Live, is_over, &mut |_| ()).unwrap();
    assert!(report.stuck.is_empty() && finished.load(Ordering::Relaxed));
    assert_eq!(given.lock().unwrap().len(), 1);
}

#[test]
fn a_source_that_panics_is_a_camera_that_is_lost() {
    let mut opened = 0;
    let source: Opener = Box::new(move || {
        opened += 1;
        let steps = match opened {
            1 => VecDeque::from([Step::Frame(0, 0.0), Step::Panic]),
            _ => VecDeque::from([Step::Frame(1, 1.0)]),
        };
        Ok(Box::new(Script(steps)) as Box<dyn Source>)
    });
    let camera = Camera { name: "a".to_owned(), source, view: view(), exposure: None };
    let mut told = Vec::new();
    let sinks: Vec<Box<dyn Sink>> = vec![Box::new(Good(Given::default(), Arc::default()))];
    let report = run(vec![camera], sinks, Pace::Live, until_the_end(), &mut |notice| {
        told.push(notice.text.clone());
    });
    let report = report.unwrap();
    let [camera] = &report.health.cameras[..] else { panic!("one") };
    assert_eq!((camera.lost, camera.state), (1, CameraState::Ended));
    assert!(told.iter().any(|text| text.contains("does not know what to do")), "{told:?}");
}

#[test]
fn what_a_camera_dropped_by_itself_is_counted_with_what_gave_way() {
    let slot = Slot::default();
    for dropped in [0, 3, 2] {
        slot.put(Entry { dropped, ..frame(0, 0.0) });
    }
    let last = slot.take(&|| false).unwrap().unwrap();
    assert_eq!((slot.dropped(), last.dropped), (7, 7));
}
