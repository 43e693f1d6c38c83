//! A thread and a bounded queue for each sink: one that is slow, stuck or dead costs its own frames and nobody else's.

use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use photinus_io::Result;

use super::Sink;
use crate::health::{Health, Level, Notice, Recent, SinkHealth};
use crate::{Entry, fault};

/// What may wait for a sink: half a second of a camera with 60 frames a second, and the memory of as many frames.
const MOST_WAITING: usize = 32;
/// How long a sink that nothing comes for sleeps.
const IDLE: Duration = Duration::from_millis(20);

/// What happens when a queue is full.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FullQueue {
    /// The oldest frame in it gives way, and is counted: on a robot, what is new matters.
    DropOldest,
    /// The loop waits: of files, nothing is lost.
    Wait,
}

#[derive(Clone)]
enum Event {
    Frame(Arc<Entry>),
    Health(Arc<Health>),
    Notice(Arc<Notice>),
}

struct Queue {
    name: String,
    full: FullQueue,
    state: Mutex<State>,
    /// Something came, or the end.
    came: Condvar,
    /// There is room again, or no need of it.
    went: Condvar,
}

struct State {
    events: VecDeque<Event>,
    closed: bool,
    running: bool,
    finished: bool,
    written: u64,
    dropped: u64,
    age_ms: Recent,
}

/// Hands everything to every sink. A clone hands to the same sinks.
#[derive(Clone)]
pub struct Fan(Arc<[Arc<Queue>]>);

/// Sinks with their threads.
pub struct Outlets {
    fan: Fan,
    threads: Vec<std::thread::JoinHandle<()>>,
}

impl Outlets {
    /// Gives each sink a thread. `told` is called, by that thread, when one fails.
    ///
    /// # Errors
    /// When the system gives no thread.
    pub fn open(
        sinks: Vec<Box<dyn Sink>>,
        full: FullQueue,
        told: impl Fn(Level, String) + Clone + Send + 'static,
    ) -> std::io::Result<Self> {
        let (mut queues, mut threads) = (Vec::new(), Vec::new());
        for mut sink in sinks {
            let queue = Arc::new(Queue::new(sink.name(), full));
            queues.push(queue.clone());
            let told = told.clone();
            let work = move || {
                let work = || queue.serve(sink.as_mut());
                let ended = catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|payload| {
                    Err(photinus_io::Error::format(&queue.name, fault::told(payload.as_ref()))
                        .advise(fault::ADVICE))
                });
                queue.end();
                if let Err(error) = ended {
                    told(Level::Error, format!("{error}; nothing more goes there, the other outputs go on"));
                }
            };
            threads.push(std::thread::Builder::new().name("sink".to_owned()).spawn(work)?);
        }
        Ok(Self { fan: Fan(queues.into()), threads })
    }

    /// What hands to them.
    pub fn fan(&self) -> Fan {
        self.fan.clone()
    }

    /// Lets every sink take what waits for it and finish, and says which did not within the patience: those are left alone.
    pub fn finish(self, patience: Duration) -> Vec<String> {
        self.fan.0.iter().for_each(|queue| queue.close());
        let until = Instant::now() + patience;
        let mut stuck = Vec::new();
        for (thread, queue) in self.threads.into_iter().zip(self.fan.0.iter()) {
            while !thread.is_finished() && Instant::now() < until {
                std::thread::sleep(Duration::from_millis(2));
            }
            match thread.is_finished() {
                true => drop(thread.join()),
                false => stuck.push(queue.name.clone()),
            }
        }
        stuck
    }
}

impl Fan {
    /// Hands a located frame to every sink.
    pub fn frame(&self, entry: Entry) {
        let entry = Arc::new(entry);
        self.0.iter().for_each(|queue| queue.put(Event::Frame(entry.clone())));
    }

    /// Tells every sink how the run is doing.
    pub fn health(&self, health: &Arc<Health>) {
        self.0.iter().for_each(|queue| queue.put(Event::Health(health.clone())));
    }

    /// Tells every sink what a person should know.
    pub fn notice(&self, notice: &Arc<Notice>) {
        self.0.iter().for_each(|queue| queue.put(Event::Notice(notice.clone())));
    }

    /// How each sink is doing.
    pub fn sinks(&self) -> Vec<SinkHealth> {
        self.0.iter().map(|queue| queue.health()).collect()
    }
}

impl Queue {
    fn new(name: String, full: FullQueue) -> Self {
        let state = State {
            events: VecDeque::new(),
            closed: false,
            running: true,
            finished: false,
            written: 0,
            dropped: 0,
            age_ms: Recent::default(),
        };
        Self { name, full, state: Mutex::new(state), came: Condvar::new(), went: Condvar::new() }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn put(&self, event: Event) {
        let mut state = self.state();
        while state.running && state.events.len() >= MOST_WAITING {
            match self.full {
                FullQueue::DropOldest => state.make_room(),
                FullQueue::Wait => state = self.went.wait(state).unwrap_or_else(PoisonError::into_inner),
            }
        }
        match state.running {
            true => state.events.push_back(event),
            false => state.count_dropped(&event),
        }
        drop(state);
        self.came.notify_one();
    }

    /// The next event; `None` when nothing came for a moment, or at the end.
    fn take(&self) -> Option<Event> {
        let mut state = self.state();
        if state.events.is_empty() && !state.closed {
            state = self.came.wait_timeout(state, IDLE).unwrap_or_else(PoisonError::into_inner).0;
        }
        let event = state.events.pop_front();
        drop(state);
        self.went.notify_all();
        event
    }

    fn serve(&self, sink: &mut dyn Sink) -> Result<()> {
        loop {
            match self.take() {
                Some(Event::Frame(entry)) => {
                    sink.frame(&entry)?;
                    let mut state = self.state();
                    state.written += 1;
                    if let Some(taken) = entry.taken {
                        state.age_ms.add(1e3 * taken.elapsed().as_secs_f64());
                    }
                }
                Some(Event::Health(health)) => sink.health(&health)?,
                Some(Event::Notice(notice)) => sink.notice(&notice)?,
                None if self.is_done() => {
                    sink.finish()?;
                    self.state().finished = true;
                    return Ok(());
                }
                None => sink.idle()?,
            }
        }
    }

    fn is_done(&self) -> bool {
        let state = self.state();
        state.closed && state.events.is_empty()
    }

    fn close(&self) {
        self.state().closed = true;
        self.came.notify_all();
    }

    /// Nothing is taken any more.
    fn end(&self) {
        let mut state = self.state();
        state.running = false;
        for event in std::mem::take(&mut state.events) {
            state.count_dropped(&event);
        }
        drop(state);
        self.went.notify_all();
    }

    fn health(&self) -> SinkHealth {
        let state = self.state();
        SinkHealth {
            name: self.name.clone(),
            running: state.running,
            finished: state.finished,
            written: state.written,
            dropped: state.dropped,
            waiting: state.events.len(),
            age_ms: state.age_ms.spread(),
        }
    }
}

impl State {
    /// The oldest frame gives way; where there is none, the oldest of the rest.
    fn make_room(&mut self) {
        let oldest = self.events.iter().position(|event| matches!(event, Event::Frame(_))).unwrap_or(0);
        if let Some(event) = self.events.remove(oldest) {
            self.count_dropped(&event);
        }
    }

    fn count_dropped(&mut self, event: &Event) {
        self.dropped += u64::from(matches!(event, Event::Frame(_)));
    }
}
