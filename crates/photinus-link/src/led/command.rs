//! What a board can be told, and the bytes that say it.

use photinus::identity::CodeBook;

/// Which boards there are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Board {
    /// A sequence for each of four pairs of LEDs.
    #[default]
    Four,
    /// One sequence for all LEDs, and rates of one byte.
    Classic,
}

/// What LEDs do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// They blink the words that were selected for them.
    Words,
    /// They blink a message, bit by bit.
    Message,
}

/// A command to a board.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Command {
    /// Light, or none.
    Active(bool),
    /// Bits a second, whole ones only.
    Rate(u16),
    /// Bits of every word.
    Length(u8),
    /// The bits of the word of this number.
    Word(u8, Vec<bool>),
    /// The numbers of the words that each pair of LEDs blinks.
    Select(Vec<u8>),
    /// What LEDs do.
    Mode(Mode),
    /// A message, bit by bit.
    Message(Vec<bool>),
}

const ACTIVE: u8 = 0x90;
const MESSAGE: u8 = 0x93;
const RATE: u8 = 0x96;
const LENGTH: u8 = 0x97;
const SELECT: u8 = 0x98;
const WORD: u8 = 0x99;
const MODE: u8 = 0xF0;

impl Command {
    /// The payload of a frame that says it.
    #[must_use]
    pub fn payload(&self, board: Board) -> Vec<u8> {
        let bits = |bits: &[bool]| bits.iter().map(|bit| u8::from(*bit)).collect::<Vec<u8>>();
        match self {
            Self::Active(is_lit) => vec![ACTIVE, u8::from(*is_lit)],
            Self::Rate(hz) => match board {
                Board::Four => [vec![RATE], hz.to_le_bytes().to_vec()].concat(),
                Board::Classic => vec![RATE, u8::try_from(*hz).unwrap_or(u8::MAX)],
            },
            Self::Length(length) => vec![LENGTH, *length],
            Self::Word(number, word) => [vec![WORD, *number], bits(word)].concat(),
            Self::Select(numbers) => [vec![SELECT], numbers.clone()].concat(),
            Self::Mode(mode) => vec![MODE, u8::from(*mode == Mode::Message)],
            Self::Message(message) => [vec![MESSAGE], bits(message)].concat(),
        }
    }

    /// What a payload says; `None` where it is no command.
    #[must_use]
    pub fn of_payload(payload: &[u8]) -> Option<Self> {
        let bits = |bytes: &[u8]| bytes.iter().map(|byte| bit(*byte)).collect::<Option<Vec<bool>>>();
        match payload {
            [ACTIVE, state] => bit(*state).map(Self::Active),
            [RATE, hz] => Some(Self::Rate(u16::from(*hz))),
            [RATE, low, high] => Some(Self::Rate(u16::from_le_bytes([*low, *high]))),
            [LENGTH, length] => Some(Self::Length(*length)),
            [WORD, number, word @ ..] => Some(Self::Word(*number, bits(word)?)),
            [SELECT, numbers @ ..] => Some(Self::Select(numbers.to_vec())),
            [MODE, 0] => Some(Self::Mode(Mode::Words)),
            [MODE, 1] => Some(Self::Mode(Mode::Message)),
            [MESSAGE, message @ ..] => bits(message).map(Self::Message),
            _ => None,
        }
    }
}

fn bit(byte: u8) -> Option<bool> {
    (byte < 2).then_some(byte == 1)
}

/// What makes a board blink `words` of the book, by number, at `rate_hz` bits a second: the length of words, those that are blinked (or with
/// `whole_book` all), rate, selection, light. `words` are those of the airframe's signals in their order; one alone is blinked by every LED.
///
/// # Errors
/// What such a board cannot do.
pub fn start(
    book: &CodeBook,
    words: &[usize],
    rate_hz: u16,
    board: Board,
    whole_book: bool,
) -> Result<Vec<Command>, String> {
    let number = |word: usize| match book.words().get(word) {
        Some(_) => u8::try_from(word).map_err(|_| format!("a board has no room for word {word}")),
        None => Err(format!("the book has {} words, and no word {word}", book.words().len())),
    };
    let numbers: Vec<u8> = words.iter().map(|word| number(*word)).collect::<Result<_, _>>()?;
    let selected = match (board, numbers.as_slice()) {
        (Board::Four, [one]) => vec![*one; 4],
        (Board::Four, [_, _, _, _]) | (Board::Classic, [_]) => numbers.clone(),
        (Board::Four, other) => return Err(format!("a board blinks 1 or 4 signals, not {}", other.len())),
        (Board::Classic, other) => {
            return Err(format!("a classic board blinks 1 signal, not {}", other.len()));
        }
    };
    if rate_hz == 0 || board == Board::Classic && rate_hz > 255 {
        return Err(format!("a board cannot blink {rate_hz} bits a second"));
    }
    let length =
        u8::try_from(book.length()).map_err(|_| format!("words of {} bits are too long", book.length()))?;
    let mut written =
        if whole_book { (0..book.words().len()).map(number).collect::<Result<_, _>>()? } else { numbers };
    written.sort_unstable();
    written.dedup();
    let word = |number: u8| Command::Word(number, book.words()[usize::from(number)].bits().collect());
    let mut commands = vec![Command::Length(length)];
    commands.extend(written.into_iter().map(word));
    commands.extend([
        Command::Rate(rate_hz),
        Command::Mode(Mode::Words),
        Command::Select(selected),
        Command::Active(true),
    ]);
    Ok(commands)
}

#[cfg(test)]
mod tests {
    use photinus_io::codes::parse_codes;
    use proptest::prelude::*;

    use super::*;

    fn commands() -> impl Strategy<Value = Command> {
        let bits = || proptest::collection::vec(any::<bool>(), 0..250);
        prop_oneof![
            any::<bool>().prop_map(Command::Active),
            any::<u16>().prop_map(Command::Rate),
            any::<u8>().prop_map(Command::Length),
            (any::<u8>(), bits()).prop_map(|(number, word)| Command::Word(number, word)),
            proptest::collection::vec(any::<u8>(), 0..250).prop_map(Command::Select),
            Just(Command::Mode(Mode::Words)),
            Just(Command::Mode(Mode::Message)),
            bits().prop_map(Command::Message),
        ]
    }

    proptest! {
        #[test]
        fn what_is_said_is_what_is_understood(command in commands()) {
            prop_assert_eq!(Command::of_payload(&command.payload(Board::Four)), Some(command.clone()));
            let fits = !matches!(command, Command::Rate(hz) if hz > 255);
            prop_assert!(!fits || Command::of_payload(&command.payload(Board::Classic)) == Some(command));
        }

        #[test]
        fn any_payload_is_a_command_or_none(payload in proptest::collection::vec(any::<u8>(), 0..64)) {
            if let Some(command) = Command::of_payload(&payload) {
                let board = if payload.len() == 2 { Board::Classic } else { Board::Four };
                prop_assert_eq!(command.payload(board), payload);
            }
        }
    }

    #[test]
    fn bytes_are_those_that_boards_are_sent_today() {
        let bytes = |command: Command| command.payload(Board::Four);
        assert_eq!(bytes(Command::Active(true)), [0x90, 1]);
        assert_eq!(bytes(Command::Rate(300)), [0x96, 0x2C, 0x01]);
        assert_eq!(bytes(Command::Length(18)), [0x97, 18]);
        assert_eq!(bytes(Command::Word(5, vec![true, false, true])), [0x99, 5, 1, 0, 1]);
        assert_eq!(bytes(Command::Select(vec![12, 13, 14, 15])), [0x98, 12, 13, 14, 15]);
        assert_eq!(bytes(Command::Mode(Mode::Message)), [0xF0, 1]);
        assert_eq!(bytes(Command::Message(vec![false, true])), [0x93, 0, 1]);
        assert_eq!(Command::Rate(60).payload(Board::Classic), [0x96, 60]);
    }

    #[test]
    fn a_start_writes_what_is_blinked_and_refuses_what_cannot_be() {
        let book = parse_codes("0,0,1\n0,1,1\n1,1,1\n0,1,0\n0,0,0\n", "t").unwrap();
        let told = start(&book, &[3, 1, 2, 0], 60, Board::Four, false).unwrap();
        let written = |commands: &[Command]| {
            commands.iter().filter(|command| matches!(command, Command::Word(..))).count()
        };
        assert_eq!((told.len(), written(&told), &told[0]), (9, 4, &Command::Length(3)));
        assert_eq!(told[1], Command::Word(0, vec![false, false, true]));
        assert_eq!(
            told[5..],
            [
                Command::Rate(60),
                Command::Mode(Mode::Words),
                Command::Select(vec![3, 1, 2, 0]),
                Command::Active(true)
            ]
        );
        assert_eq!(written(&start(&book, &[3], 60, Board::Four, true).unwrap()), 5);
        assert!(start(&book, &[3], 60, Board::Four, false).unwrap().contains(&Command::Select(vec![3; 4])));
        assert!(start(&book, &[3], 60, Board::Classic, false).unwrap().contains(&Command::Select(vec![3])));
        for (words, rate_hz, board) in [
            (&[5][..], 60, Board::Four),
            (&[0, 1], 60, Board::Four),
            (&[0, 1, 2, 3], 60, Board::Classic),
            (&[0], 0, Board::Four),
            (&[0], 300, Board::Classic),
        ] {
            assert!(start(&book, words, rate_hz, board, false).is_err(), "{words:?} {rate_hz} {board:?}");
        }
    }
}
