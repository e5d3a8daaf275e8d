//! Every order in which bytes and timeouts can follow each other in exchanges with a module that answers in order, as
//! modules do, but as late and in as many pieces as it likes: whatever is accepted is the answer to its own question.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use super::debts::LATEST;
use super::*;
use crate::protocol::{AnswerFrom, modbus};

const WINDOW: Duration = Duration::from_millis(60);

/// How a module answers one request; all times are pauses.
#[derive(Debug, Clone, Copy)]
enum Manner {
    /// It has not heard it.
    Deaf,
    Answers {
        /// From the end of the request, or of its answer before, to the first byte.
        after: Duration,
        /// Before which byte it pauses once more, and for how long.
        pause: (usize, Duration),
        /// A stray byte precedes the answer.
        noise: bool,
    },
}

/// A line with one module, in virtual time.
struct Unpunctual {
    now: Instant,
    manners: VecDeque<Manner>,
    answers: VecDeque<Vec<u8>>,
    incoming: VecDeque<(Instant, u8)>,
    busy_until: Instant,
    character: Duration,
}

impl Line for Unpunctual {
    fn configure(&mut self, _: LineSettings) -> Result<(), LineLost> {
        Ok(())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LineLost> {
        let sent = self.now + self.character * bytes.len() as u32;
        let answer = self.answers.pop_front().unwrap_or_default();
        let Some(Manner::Answers { after, pause, noise }) = self.manners.pop_front() else { return Ok(()) };
        let mut at = sent.max(self.busy_until) + after;
        let bytes = noise.then_some(0).into_iter().chain(answer);
        for (index, byte) in bytes.enumerate() {
            at += self.character + if index == pause.0 { pause.1 } else { Duration::ZERO };
            self.incoming.push_back((at, byte));
        }
        self.busy_until = at;
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LineLost> {
        let Some(&(first, _)) = self.incoming.front().filter(|(at, _)| *at <= deadline.max(self.now)) else {
            self.now = self.now.max(deadline);
            return Ok(0);
        };
        self.now = self.now.max(first);
        let mut count = 0;
        while let Some((_, byte)) = self.incoming.pop_front_if(|(at, _)| *at <= self.now) {
            buffer[count] = byte;
            count += 1;
        }
        Ok(count)
    }

    fn purge(&mut self) -> Result<(), LineLost> {
        self.incoming.retain(|(at, _)| *at > self.now);
        Ok(())
    }

    fn look(&mut self) -> Result<(), LineLost> {
        Ok(())
    }

    fn now(&self) -> Instant {
        self.now
    }

    fn wait_until(&mut self, instant: Instant) {
        self.now = self.now.max(instant);
    }
}

/// A question, what is expected on it, and the only right answer to it.
struct Question {
    request: Vec<u8>,
    expected: Expected,
    answer: Vec<u8>,
}

/// Questions whose answers can be taken for each other.
type Language = [Question; 3];

fn dcon(from: AnswerFrom, content: Content) -> Expected {
    Expected::Dcon { checksum: false, from, content }
}

fn addressed(number: u8) -> Question {
    let (request, answer) = (format!("$01{number}\r").into_bytes(), format!("!010{number}\r").into_bytes());
    Question { request, expected: dcon(AnswerFrom::Addresses(vec![1]), Content::Any), answer }
}

fn languages() -> Vec<Language> {
    let rtu = |number: u8| Question {
        request: modbus::with_crc(&[1, 3, 0, number, 0, 1]),
        expected: Expected::Rtu { address: 1 },
        answer: modbus::with_crc(&[1, 3, 2, 0xA0, number]),
    };
    let bare = |number: u8| Question {
        request: format!("#01{number}\r").into_bytes(),
        expected: dcon(AnswerFrom::Anyone, Content::Any),
        answer: format!(">+02{number}.99\r").into_bytes(),
    };
    let name = || Question {
        request: b"$01M\r".to_vec(),
        expected: dcon(AnswerFrom::Addresses(vec![1]), Content::Name(b"!01PIR234".to_vec())),
        answer: b"!01PIR234\r".to_vec(),
    };
    vec![
        [0, 1, 2].map(rtu),
        [0, 1, 2].map(addressed),
        [0, 1, 2].map(bare),
        [name(), addressed(1), addressed(2)],
        [addressed(0), name(), addressed(2)],
        [name(), name(), addressed(2)],
    ]
}

/// Asks the questions one after the other. `Err` tells which answer was accepted for which question.
fn converse(language: &Language, manners: &[Manner]) -> Result<Vec<bool>, String> {
    let settings = LineSettings::default();
    let now = Instant::now();
    let line = Unpunctual {
        now,
        manners: manners.iter().copied().collect(),
        answers: language.iter().map(|question| question.answer.clone()).collect(),
        incoming: VecDeque::new(),
        busy_until: now,
        character: settings.wire_time(1),
    };
    let mut wire = Wire::new(Box::new(line), settings, Box::new(|_| {})).unwrap();
    let mut answered = Vec::new();
    for Question { request, expected, answer } in language.iter().take(manners.len()) {
        let began = wire.now();
        let outcome = wire.exchange(request, expected, WINDOW);
        let took = wire.now() - began;
        if took > LATEST + WINDOW + Duration::from_secs(2) {
            return Err(format!("{request:?} took {took:?}"));
        }
        match outcome {
            Ok(bytes) if answer.strip_suffix(b"\r").unwrap_or(answer) == bytes => answered.push(true),
            Ok(bytes) => return Err(format!("{bytes:?} was accepted for {request:?}")),
            Err(_) => answered.push(false),
        }
    }
    Ok(answered)
}

fn manners(afters: &[u64], pauses: &[u64], longest: usize) -> Vec<Manner> {
    let mut all = vec![Manner::Deaf];
    for &after in afters {
        for noise in [false, true] {
            for &pause in pauses {
                let places = if pause == 0 { 1 } else { longest };
                all.extend((0..places).map(|place| Manner::Answers {
                    after: Duration::from_millis(after),
                    pause: (place + 1, Duration::from_millis(pause)),
                    noise,
                }));
            }
        }
    }
    all
}

#[test]
fn whatever_the_pauses_before_and_within_two_answers_each_is_taken_for_its_own_question_only() {
    let all = manners(&[5, 58, 62, 130, 1_900], &[0, 20, 45, 300], 7);
    for language in languages() {
        for &first in &all {
            for &second in &all {
                converse(&language, &[first, second]).unwrap_or_else(|what| panic!("{first:?}, {second:?}: {what}"));
            }
        }
    }
}

#[test]
fn whatever_the_order_of_answers_and_timeouts_of_three_questions_each_is_taken_for_its_own_only() {
    let all = manners(&[5, 59, 61, 90, 250, 900, 1_950], &[0], 1);
    for language in languages() {
        for &first in &all {
            for &second in &all {
                for &third in &all {
                    let told = converse(&language, &[first, second, third]);
                    told.unwrap_or_else(|what| panic!("{first:?}, {second:?}, {third:?}: {what}"));
                }
            }
        }
    }
}

#[test]
fn after_any_late_or_missing_answer_a_punctual_one_is_taken() {
    let punctual = Manner::Answers { after: Duration::from_millis(5), pause: (0, Duration::ZERO), noise: false };
    // A late name is not waited for, so a module that is busy with it may not have come to the question after it.
    for language in languages().into_iter().filter(|[first, ..]| !first.expected.is_choosy()) {
        for first in manners(&[5, 62, 130, 1_900], &[0, 45], 7) {
            let answered = converse(&language, &[first, punctual]).expect("the right answers");
            assert_eq!(answered.last(), Some(&true), "{first:?}");
        }
    }
}
