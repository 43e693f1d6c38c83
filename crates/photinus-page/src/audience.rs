//! Whoever looks: each has a bounded queue; who is slow misses what is old, and nobody waits for them.

use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, Weak};
use std::time::Duration;

/// What may wait for one of them: about a second of three cameras.
const MOST_WAITING: usize = 32;
/// This many may look.
const MOST: usize = 8;

/// Whoever looks.
#[derive(Default)]
pub(crate) struct Audience(Mutex<Everybody>);

#[derive(Default)]
struct Everybody {
    seats: Vec<Weak<Seat>>,
    /// What who comes later is told first.
    kept: Vec<Arc<[u8]>>,
}

/// The place of one who looks. Whoever lets go of it has left.
#[derive(Default)]
pub(crate) struct Seat {
    waiting: Mutex<VecDeque<Arc<[u8]>>>,
    came: Condvar,
}

impl Audience {
    /// A place, if one is free.
    pub(crate) fn join(&self) -> Option<Arc<Seat>> {
        let mut all = locked(&self.0);
        all.seats.retain(|seat| seat.strong_count() > 0);
        if all.seats.len() >= MOST {
            return None;
        }
        let seat = Arc::new(Seat::default());
        all.kept.iter().for_each(|message| seat.put(message.clone()));
        all.seats.push(Arc::downgrade(&seat));
        Some(seat)
    }

    /// Whether nobody looks.
    pub(crate) fn is_empty(&self) -> bool {
        locked(&self.0).seats.iter().all(|seat| seat.strong_count() == 0)
    }

    /// Tells everybody.
    pub(crate) fn tell(&self, message: Vec<u8>) {
        let message: Arc<[u8]> = message.into();
        let seats = locked(&self.0).seats.clone();
        seats.iter().filter_map(Weak::upgrade).for_each(|seat| seat.put(message.clone()));
    }

    /// Who comes later is told these first.
    pub(crate) fn keep(&self, messages: Vec<Vec<u8>>) {
        locked(&self.0).kept = messages.into_iter().map(Into::into).collect();
    }
}

impl Seat {
    fn put(&self, message: Arc<[u8]>) {
        let mut waiting = locked(&self.waiting);
        if waiting.len() >= MOST_WAITING {
            waiting.pop_front();
        }
        waiting.push_back(message);
        self.came.notify_one();
    }

    /// The next message, waited for a moment.
    pub(crate) fn take(&self, moment: Duration) -> Option<Arc<[u8]>> {
        let mut waiting = locked(&self.waiting);
        if waiting.is_empty() {
            waiting = self.came.wait_timeout(waiting, moment).unwrap_or_else(PoisonError::into_inner).0;
        }
        waiting.pop_front()
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_is_slow_misses_what_is_old_and_places_are_limited() {
        let audience = Audience::default();
        audience.keep(vec![vec![7]]);
        let slow = audience.join().unwrap();
        (0..100_u8).for_each(|number| audience.tell(vec![number]));
        let first = slow.take(Duration::ZERO).unwrap();
        assert_eq!(&*first, [100 - MOST_WAITING as u8]);
        let others: Vec<_> = std::iter::from_fn(|| audience.join()).collect();
        assert_eq!(others.len(), MOST - 1);
        assert_eq!(others[0].take(Duration::ZERO).as_deref(), Some(&[7][..]));
        drop((slow, others));
        assert!(audience.is_empty() && audience.join().is_some());
    }
}
