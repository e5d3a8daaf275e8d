//! A module whose answers are the fuzzer's bytes, and what has to hold of every value that is read from it.

use dcon_bench::module::{Answer, Ask, Definition, Item, Kind, Value};
use dcon_bench::protocol::{AnswerFrom, Failure, Query, Reply, dcon};
use jiff::Timestamp;

use crate::{take_byte, take_bytes};

/// More than the questions that any module is asked in one run.
const MOST_QUESTIONS: usize = 4_000;

/// Plays the bytes, one piece for each question; silence when they are used up.
pub struct Played<'a> {
    rest: &'a [u8],
    /// DCON answers carry a checksum.
    checksum: bool,
    /// What came on each question.
    pub exchanges: Vec<(Query, Result<Reply, Failure>)>,
    /// DCON: the bytes that came, carriage return included.
    pub frames: Vec<(Vec<u8>, Vec<u8>)>,
}

impl<'a> Played<'a> {
    pub fn new(rest: &'a [u8], checksum: bool) -> Self {
        Self { rest, checksum, exchanges: Vec::new(), frames: Vec::new() }
    }

    /// Whether anything that can hold a value came back.
    pub fn brought_something(&self) -> bool {
        self.exchanges.iter().any(|(_, outcome)| outcome.is_ok())
    }

    /// Up to the next carriage return, judged as the bus does.
    fn dcon(&mut self, request: &str) -> Result<Reply, Failure> {
        let length = self.rest.iter().position(|byte| *byte == dcon::CR).ok_or(Failure::Silent)?;
        let frame = take_bytes(&mut self.rest, length + 1);
        self.frames.push((dcon::encode(request, self.checksum), frame.to_vec()));
        let garbled = |reason: String| Failure::Garbled { reason, bytes: frame.to_vec() };
        let range = dcon::find_answer(frame).ok_or_else(|| garbled("no answer".to_owned()))?;
        match dcon::decode(&frame[range], self.checksum) {
            Ok(dcon::Answer::Refused { text }) => Err(Failure::Refused { answer: format!("?{text}") }),
            Ok(dcon::Answer::Ignored) => Err(Failure::Ignored),
            Ok(answer) => Ok(Reply::Text(answer.to_text())),
            Err(error) => Err(garbled(error.to_string())),
        }
    }

    /// A first byte that says what comes, then the data.
    fn modbus(&mut self, query: &Query) -> Result<Reply, Failure> {
        if self.rest.is_empty() {
            return Err(Failure::Silent);
        }
        match take_byte(&mut self.rest) {
            0xFF => Err(Failure::Silent),
            0xFE => Err(Failure::Exception { code: take_byte(&mut self.rest) }),
            // More or less than was asked for, or something else: the module room relies on nobody for that.
            0xFD => Ok(Reply::Done),
            0xFC => {
                let count = usize::from(take_byte(&mut self.rest));
                Ok(self.words(count))
            }
            length => Ok(self.asked_for(query, usize::from(length))),
        }
    }

    fn asked_for(&mut self, query: &Query, length: usize) -> Reply {
        match query {
            Query::ReadCoils { count, .. } => {
                let bytes = take_bytes(&mut self.rest, usize::from(*count).div_ceil(8));
                let bit = |at: usize| bytes.get(at / 8).is_some_and(|byte| byte >> (at % 8) & 1 == 1);
                Reply::Bits((0..usize::from(*count)).map(bit).collect())
            }
            Query::ReadHoldingRegisters { count, .. } | Query::ReadInputRegisters { count, .. } => {
                self.words(usize::from(*count))
            }
            Query::Custom { .. } => Reply::Bytes(take_bytes(&mut self.rest, length).to_vec()),
            Query::Dcon { .. } => Reply::Text(String::from_utf8_lossy(take_bytes(&mut self.rest, length)).into_owned()),
            _ => Reply::Done,
        }
    }

    fn words(&mut self, count: usize) -> Reply {
        let bytes = take_bytes(&mut self.rest, count * 2);
        let word = |at: usize| [at * 2, at * 2 + 1].map(|at| bytes.get(at).copied().unwrap_or_default());
        Reply::Words((0..count).map(|at| u16::from_be_bytes(word(at))).collect())
    }
}

impl Ask for Played<'_> {
    fn ask(&mut self, query: &Query) -> Result<Reply, Failure> {
        assert!(self.exchanges.len() < MOST_QUESTIONS, "the questions do not end: {query:?}");
        let outcome = match query {
            Query::Dcon { from: AnswerFrom::Nobody, .. } => Ok(Reply::Done),
            Query::Dcon { text, .. } => self.dcon(text),
            query => self.modbus(query),
        };
        self.exchanges.push((query.clone(), outcome.clone()));
        outcome
    }

    fn answered_at(&self) -> Timestamp {
        Timestamp::UNIX_EPOCH
    }

    fn follow(&mut self, _: u8) {}
}

/// Every value is of the kind that its item declares, whatever the module said.
pub fn check_values(definition: &Definition, answers: &[Answer]) {
    for answer in answers {
        let item = definition.item(&answer.id).expect("only items of the definition are answered");
        match &answer.result {
            Ok(value) => check_value(item, value),
            Err(failure) => assert!(!failure.to_string().is_empty()),
        }
    }
}

fn check_value(item: &Item, value: &Value) {
    let fits = match (&item.kind, value) {
        (Kind::Bool, Value::Bool(_)) => true,
        (Kind::Number { min, .. }, Value::Number(number)) => number.decimals == min.decimals,
        (Kind::Choice(choices), Value::Choice(word)) => choices.iter().any(|choice| choice.word == *word),
        (Kind::Text { .. } | Kind::Ipv4, Value::Text(_)) => true,
        _ => false,
    };
    assert!(fits, "{} took {value:?}", item.id);
    assert!(!matches!(value, Value::Number(_)) || !item.text(value).is_empty());
}
