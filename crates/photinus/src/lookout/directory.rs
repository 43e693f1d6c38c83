//! Who blinks which word: a word -> the vehicle of the fleet, and the signal of its airframe.

use alloc::vec::Vec;

use super::fleet::Fleet;
use crate::identity::decoder::Who;

/// Whose a word is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Entry {
    pub(super) vehicle: u32,
    /// `None` where several signals of the vehicle blink it.
    pub(super) signal: Option<u32>,
}

/// By word of the book whose it is, where it is one vehicle's, and whether it is anybody's.
#[derive(Debug)]
pub(super) struct Directory(Vec<(Option<Entry>, bool)>);

impl Directory {
    pub(super) fn of(fleet: &Fleet) -> Self {
        let whose = |word: usize| {
            let mut all = fleet.vehicles().iter().filter(|vehicle| vehicle.words.contains(&word));
            let one = match (all.next(), all.next()) {
                (Some(one), None) => one,
                (any, _) => return (None, any.is_some()),
            };
            let mut signals = (0..).zip(&one.words).filter(|own| *own.1 == word).map(|own| own.0);
            let first = signals.next();
            (Some(Entry { vehicle: one.id, signal: first.filter(|_| signals.next().is_none()) }), true)
        };
        Self((0..fleet.book().words().len()).map(whose).collect())
    }

    /// Whose marker blinks so; `None` where it is nobody's alone.
    pub(super) fn entry(&self, who: Who) -> Option<Entry> {
        match who {
            Who::Word(word) => self.0.get(word)?.0,
            Who::Unknown | Who::Steady | Who::Dark => None,
        }
    }

    /// Whether a marker that shines so is nobody's.
    pub(super) fn is_stranger(&self, who: Who) -> bool {
        match who {
            Who::Word(word) => self.0.get(word).is_none_or(|own| !own.1),
            Who::Unknown | Who::Steady => true,
            Who::Dark => false,
        }
    }
}
