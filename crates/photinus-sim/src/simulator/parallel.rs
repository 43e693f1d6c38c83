//! Frames rendered by several threads, handed over in order.

use std::ops::Range;
use std::sync::mpsc::{Receiver, sync_channel};

use super::Simulator;
use crate::render::Rendered;

/// Frames that a thread may be ahead of the one that takes them.
const AHEAD: usize = 4;

impl Simulator {
    /// Renders `frames` on `threads` threads, at least one, and hands them to `take` in order; they are the same whatever
    /// the number of threads. Stops at the first error of `take`.
    ///
    /// # Errors
    /// That of `take`.
    pub fn render<E>(
        &self,
        frames: Range<u64>,
        threads: usize,
        mut take: impl FnMut(Rendered) -> Result<(), E>,
    ) -> Result<(), E> {
        let threads = threads.max(1);
        std::thread::scope(|scope| {
            let start = |first: u64| -> Receiver<Rendered> {
                let (sender, receiver) = sync_channel(AHEAD);
                let (mut simulator, numbers) =
                    (self.clone(), frames.clone().skip(first as usize).step_by(threads));
                scope.spawn(move || {
                    for number in numbers {
                        if sender.send(simulator.frame(number)).is_err() {
                            return; // nobody takes frames any more
                        }
                    }
                });
                receiver
            };
            let receivers: Vec<_> = (0..threads as u64).map(start).collect();
            for (_, receiver) in frames.clone().zip(receivers.iter().cycle()) {
                let Ok(rendered) = receiver.recv() else { break };
                take(rendered)?;
            }
            Ok(())
        })
    }
}
