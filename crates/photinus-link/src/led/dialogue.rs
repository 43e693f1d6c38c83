//! Commands, one after the other, with the pauses that boards need, and what came back. Pure: whoever holds the line tells the time.

use super::{Board, Command, Unframer, framed};

/// How often a command is said that a board, which answers otherwise, does not answer.
const TRIES: u32 = 3;
/// How much of the pause a bit of a word adds: boards write words into their flash.
const PER_BIT: f64 = 0.4;

/// Commands on their way to a board.
#[derive(Clone, Debug)]
pub struct Dialogue {
    commands: Vec<Said>,
    pause_s: f64,
    at: usize,
    sent_s: Option<f64>,
    tries: u32,
    unframer: Unframer,
}

#[derive(Clone, Debug)]
struct Said {
    payload: Vec<u8>,
    bits: usize,
    is_answered: bool,
}

/// What to do now.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// These bytes are due.
    Send(Vec<u8>),
    /// The board needs time, or may still answer.
    Wait,
    /// It is over.
    Done(Outcome),
}

/// How it went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The board answered every command.
    Acknowledged,
    /// All was said; the board answers nothing.
    Unanswered,
    /// The board answers, but not this command, by number.
    Refused(usize),
}

impl Dialogue {
    /// For a board that needs `pause_s` after a command, and more after a word.
    #[must_use]
    pub fn new(commands: &[Command], board: Board, pause_s: f64) -> Self {
        let said = |command: &Command| Said {
            payload: command.payload(board),
            bits: if let Command::Word(_, bits) = command { bits.len() } else { 0 },
            is_answered: false,
        };
        let commands = commands.iter().map(said).collect();
        Self { commands, pause_s, at: 0, sent_s: None, tries: 0, unframer: Unframer::default() }
    }

    /// How long it takes with a board that answers nothing, s.
    #[must_use]
    pub fn longest_s(&self) -> f64 {
        self.commands.iter().map(|said| self.pause(said)).sum()
    }

    /// What to do at a time, with the bytes that came since the step before.
    pub fn step(&mut self, now_s: f64, heard: &[u8]) -> Step {
        let answers = self.unframer.take(heard);
        let Some(said) = self.commands.get_mut(self.at) else { return Step::Done(self.outcome()) };
        if self.sent_s.is_some() && answers.contains(&said.payload) {
            said.is_answered = true;
            self.go_on();
            return self.step(now_s, &[]);
        }
        let said = &self.commands[self.at];
        match self.sent_s {
            None => self.say(now_s),
            Some(sent_s) if now_s - sent_s < self.pause(said) => Step::Wait,
            Some(_) if !self.answers() => {
                self.go_on();
                self.step(now_s, &[])
            }
            Some(_) if self.tries < TRIES => self.say(now_s),
            Some(_) => Step::Done(Outcome::Refused(self.at)),
        }
    }

    fn say(&mut self, now_s: f64) -> Step {
        self.sent_s = Some(now_s);
        self.tries += 1;
        Step::Send(framed(&self.commands[self.at].payload))
    }

    fn go_on(&mut self) {
        self.at += 1;
        self.sent_s = None;
        self.tries = 0;
    }

    /// Whether the board has answered anything.
    fn answers(&self) -> bool {
        self.commands.iter().any(|said| said.is_answered)
    }

    fn outcome(&self) -> Outcome {
        match self.answers() {
            true => Outcome::Acknowledged,
            false => Outcome::Unanswered,
        }
    }

    fn pause(&self, said: &Said) -> f64 {
        self.pause_s * (1.0 + PER_BIT * said.bits as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps of 10 ms; `answer` says what a board sends back for the bytes that it gets, and how often it got some.
    fn hold(commands: &[Command], mut answer: impl FnMut(&[u8], usize) -> Vec<u8>) -> (Outcome, usize, f64) {
        let mut dialogue = Dialogue::new(commands, Board::Four, 0.25);
        let (mut heard, mut sent) = (Vec::new(), 0);
        for step in 0..10_000 {
            let now_s = 0.01 * f64::from(step);
            match dialogue.step(now_s, &std::mem::take(&mut heard)) {
                Step::Send(bytes) => {
                    sent += 1;
                    heard = answer(&bytes, sent);
                }
                Step::Wait => {}
                Step::Done(outcome) => return (outcome, sent, now_s),
            }
        }
        panic!("it does not end");
    }

    fn commands() -> [Command; 3] {
        [Command::Length(3), Command::Word(7, vec![true, false, true]), Command::Active(true)]
    }

    #[test]
    fn a_board_that_answers_nothing_gets_every_command_once_with_its_pause() {
        let (outcome, sent, took_s) = hold(&commands(), |_, _| Vec::new());
        assert_eq!((outcome, sent), (Outcome::Unanswered, 3));
        // 0.25, 0.25 * 2.2 and 0.25.
        assert!((took_s - 1.05).abs() < 0.05, "{took_s}");
        assert!((Dialogue::new(&commands(), Board::Four, 0.25).longest_s() - 1.05).abs() < 1e-9);
    }

    #[test]
    fn a_board_that_sends_commands_back_is_not_waited_for() {
        let (outcome, sent, took_s) = hold(&commands(), |bytes, _| [b"noise\n", bytes].concat());
        assert_eq!((outcome, sent), (Outcome::Acknowledged, 3));
        assert!(took_s < 0.1, "{took_s}");
    }

    #[test]
    fn a_command_that_was_lost_is_said_again_and_one_that_is_refused_is_told() {
        let (outcome, sent, _) =
            hold(&commands(), |bytes, sent| if sent == 2 { Vec::new() } else { bytes.to_vec() });
        assert_eq!((outcome, sent), (Outcome::Acknowledged, 4));
        let (outcome, sent, _) =
            hold(&commands(), |bytes, sent| if sent == 1 { bytes.to_vec() } else { Vec::new() });
        assert_eq!((outcome, sent), (Outcome::Refused(1), 4));
    }

    #[test]
    fn an_answer_to_something_else_is_none() {
        let (outcome, ..) = hold(&commands(), |_, _| framed(&[0x90, 0]));
        assert_eq!(outcome, Outcome::Unanswered);
    }
}
