//! What may be wrong: with the LEDs, with what the program is told of them, and with the times of frames.

/// What the program is told of words.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Told {
    /// What is blinked.
    Right,
    /// A book whose words are of another length.
    OtherLength,
    /// Words of the same length from another book.
    OtherWords,
}

/// How times go back.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Back {
    /// From this time on, s, ...
    pub(crate) at_s: f64,
    /// ... they are so much earlier, s.
    pub(crate) by_s: f64,
}

/// All that may be wrong at once.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fault {
    pub(crate) name: &'static str,
    /// An LED of every vehicle is dead.
    pub(crate) has_dead_leds: bool,
    pub(crate) told: Told,
    /// Vehicles 1 and 2 blink the word of 1.
    pub(crate) is_copied: bool,
    /// How much faster the clocks of the LEDs run, as a share.
    pub(crate) faster: f64,
    /// How much faster the clock of the frames' times runs, as a share.
    pub(crate) stamps_faster: f64,
    /// The share of frames that get lost.
    pub(crate) dropped: f64,
    pub(crate) back: Option<Back>,
}

const NONE: Fault = Fault {
    name: "nothing",
    has_dead_leds: false,
    told: Told::Right,
    is_copied: false,
    faster: 0.0,
    stamps_faster: 0.0,
    dropped: 0.0,
    back: None,
};
const fn back(by_s: f64) -> Option<Back> {
    Some(Back { at_s: 3.0, by_s })
}

/// One after the other, then some that come together.
pub(crate) const FAULTS: [Fault; 16] = [
    NONE,
    Fault { name: "a dead LED each", has_dead_leds: true, ..NONE },
    Fault { name: "words of another length", told: Told::OtherLength, ..NONE },
    Fault { name: "words of another book", told: Told::OtherWords, ..NONE },
    Fault { name: "two carry an id", is_copied: true, ..NONE },
    Fault { name: "LEDs 5 % fast", faster: 0.05, ..NONE },
    Fault { name: "LEDs 5 % slow", faster: -0.05, ..NONE },
    Fault { name: "times 5 % fast", stamps_faster: 0.05, ..NONE },
    Fault { name: "30 % of frames dropped", dropped: 0.3, ..NONE },
    Fault { name: "times 100 s back", back: back(100.0), ..NONE },
    Fault { name: "times 2 s back", back: back(2.0), ..NONE },
    Fault { name: "times 0.3 s back", back: back(0.3), ..NONE },
    Fault { name: "dead, dropped", has_dead_leds: true, dropped: 0.3, ..NONE },
    Fault { name: "two carry, dropped", is_copied: true, dropped: 0.3, ..NONE },
    Fault { name: "5 % slow, dropped", faster: -0.05, dropped: 0.3, ..NONE },
    Fault {
        name: "dead, two carry, dropped, back",
        has_dead_leds: true,
        is_copied: true,
        dropped: 0.3,
        back: back(100.0),
        ..NONE
    },
];
