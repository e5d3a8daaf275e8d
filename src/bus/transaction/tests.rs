//! One exchange after another on a line that plays what the test wrote down.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex};

use super::*;
use crate::bus::dialogue::Dialogue;
use crate::bus::target::{Patience, Target};
use crate::module::Ask;
use crate::protocol::{AnswerFrom, BaudRate, DataFormat, Protocol, Query, Reply, hex, modbus};

const WINDOW: Duration = Duration::from_millis(60);
const REQUEST: &[u8] = &[1, 3, 0, 0, 0, 1];

/// A line that plays what the test wrote down: after each request, bytes at times counted from its sending.
struct Scripted {
    now: Instant,
    answers: VecDeque<Vec<(u64, Vec<u8>)>>,
    incoming: VecDeque<(Instant, Vec<u8>)>,
    sent: Arc<Mutex<Vec<Instant>>>,
    /// The speed was changed, and nothing sent since.
    changing: bool,
}

impl Line for Scripted {
    fn configure(&mut self, _: LineSettings) -> Result<(), LineLost> {
        self.changing = true;
        Ok(())
    }

    fn send(&mut self, _: &[u8]) -> Result<(), LineLost> {
        self.changing = false;
        self.sent.lock().unwrap().push(self.now);
        let answers = self.answers.pop_front().expect("no further request was expected");
        let at = |ms| self.now + Duration::from_millis(ms);
        self.incoming.extend(answers.into_iter().map(|(ms, bytes)| (at(ms), bytes)));
        self.incoming.make_contiguous().sort();
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LineLost> {
        match self.incoming.front() {
            Some((at, _)) if *at <= deadline => {
                let (at, bytes) = self.incoming.pop_front().unwrap();
                self.now = self.now.max(at);
                buffer[..bytes.len()].copy_from_slice(&bytes);
                Ok(bytes.len())
            }
            _ => {
                self.now = self.now.max(deadline);
                Ok(0)
            }
        }
    }

    fn purge(&mut self) -> Result<(), LineLost> {
        assert!(self.changing, "between two questions at one speed nothing is dropped unseen");
        let now = self.now;
        self.incoming.retain(|(at, _)| *at > now);
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

fn wire(answers: &[&[(u64, &[u8])]]) -> (Wire, Arc<Mutex<Vec<Instant>>>) {
    let sent = Arc::<Mutex<Vec<Instant>>>::default();
    let script = answers.iter().map(|answer| answer.iter().map(|(ms, bytes)| (*ms, bytes.to_vec())).collect());
    let line = Scripted {
        now: Instant::now(),
        answers: script.collect(),
        incoming: VecDeque::new(),
        sent: sent.clone(),
        changing: false,
    };
    (Wire::new(Box::new(line), LineSettings::default(), Box::new(|_| {})).unwrap(), sent)
}

fn ask(wire: &mut Wire) -> Result<Vec<u8>, Failure> {
    wire.exchange(&modbus::with_crc(REQUEST), &Expected::Rtu { address: 1 }, WINDOW)
}

fn answer(value: u8) -> Vec<u8> {
    modbus::with_crc(&[1, 3, 2, 0, value])
}

#[test]
fn silence_costs_the_requests_wire_time_and_one_window_and_nothing_before_the_next_address() {
    let (mut wire, sent) = wire(&[&[], &[]]);
    assert_eq!(ask(&mut wire), Err(Failure::Silent));
    let other = modbus::with_crc(&[2, 3, 0, 0, 0, 1]);
    let _ = wire.exchange(&other, &Expected::Rtu { address: 2 }, WINDOW);
    let sent = sent.lock().unwrap();
    assert_eq!(sent[1] - sent[0], WINDOW + LineSettings::default().wire_time(8));
}

#[test]
fn a_late_answer_is_not_taken_for_the_next_request_of_the_same_shape() {
    let (late, right) = (answer(1), answer(2));
    let (mut wire, _) = wire(&[&[(100, &late)], &[(20, &right)]]);
    assert_eq!(ask(&mut wire), Err(Failure::Silent));
    assert_eq!(ask(&mut wire), Ok(right));
}

#[test]
fn an_answer_of_another_module_does_not_end_the_wait_for_a_late_one() {
    let neighbour = modbus::with_crc(&[2, 3, 2, 0, 9]);
    let (late, right) = (answer(1), answer(2));
    let (mut wire, _) = wire(&[&[(130, &late)], &[(20, &neighbour)], &[(30, &right)]]);
    assert_eq!(ask(&mut wire), Err(Failure::Silent));
    let other = modbus::with_crc(&[2, 3, 0, 0, 0, 1]);
    assert_eq!(wire.exchange(&other, &Expected::Rtu { address: 2 }, WINDOW), Ok(neighbour));
    assert_eq!(ask(&mut wire), Ok(right));
}

#[test]
fn a_stray_byte_does_not_shorten_the_window() {
    let right = answer(6);
    let (mut wire, _) = wire(&[&[(9, &[0x40]), (62, &right)]]);
    assert_eq!(ask(&mut wire), Ok(right));
}

#[test]
fn an_answer_in_two_pieces_is_whole_and_one_that_stops_is_cut() {
    let whole = answer(7);
    let (first, second) = whole.split_at(3);
    let (mut wire, _) = wire(&[&[(20, first), (45, second)], &[(20, first)]]);
    assert_eq!(ask(&mut wire), Ok(whole.clone()));
    assert_eq!(ask(&mut wire), Err(Failure::Cut { bytes: first.to_vec() }));
}

#[test]
fn after_garbage_nothing_is_sent_until_the_line_is_quiet() {
    let garbage = [0x55; 7];
    let right = answer(3);
    let (mut wire, sent) = wire(&[&[(20, &garbage), (45, &garbage), (70, &garbage)], &[(20, &right)]]);
    assert!(ask(&mut wire).unwrap_err().is_garbage());
    assert_eq!(ask(&mut wire), Ok(right));
    let sent = sent.lock().unwrap();
    assert!(sent[1] - sent[0] >= Duration::from_millis(70) + SETTLE, "{:?}", sent[1] - sent[0]);
}

#[test]
fn modbus_frames_are_kept_apart_by_three_and_a_half_characters() {
    let right = answer(4);
    let (mut wire, sent) = wire(&[&[(20, &right)], &[(20, &right)]]);
    ask(&mut wire).unwrap();
    ask(&mut wire).unwrap();
    let sent = sent.lock().unwrap();
    let gap = sent[1] - sent[0] - Duration::from_millis(20);
    assert_eq!(gap, LineSettings::default().frame_silence());
}

#[test]
fn an_echoing_adapter_is_learned_from_reads_and_does_not_spoil_writes() {
    let (read, write) = (modbus::with_crc(REQUEST), modbus::with_crc(&[1, 6, 2, 0, 0, 10]));
    let right = answer(5);
    let echoed = [read.clone(), right.clone()].concat();
    let twice = write.repeat(2);
    let (mut wire, _) = wire(&[&[(20, &echoed)], &[(9, &twice[..8]), (20, &twice[8..])]]);
    assert_eq!(ask(&mut wire), Ok(right));
    assert!(wire.echoes());
    assert_eq!(wire.exchange(&write, &Expected::Rtu { address: 1 }, WINDOW), Ok(write.clone()));
}

#[test]
fn a_stray_byte_in_front_of_an_echo_does_not_make_the_next_writes_echo_its_answer() {
    let (read, write) = (modbus::with_crc(REQUEST), modbus::with_crc(&[1, 5, 0, 0, 0xFF, 0]));
    let right = answer(5);
    let echoed = [read.clone(), right.clone()].concat();
    let disturbed = [&[0][..], &read, &right].concat();
    let (mut wire, _) = wire(&[&[(20, &echoed)], &[(20, &disturbed)], &[(9, &write)]]);
    for _ in 0..2 {
        assert_eq!(ask(&mut wire), Ok(right.clone()));
    }
    assert_eq!(wire.exchange(&write, &Expected::Rtu { address: 1 }, WINDOW), Err(Failure::Silent));
}

#[test]
fn an_echo_that_broke_off_leaves_the_answer_open() {
    let request = modbus::with_crc(&[1, 3, 1, 0xE0, 0, 1]);
    let expected = Expected::Rtu { address: 1 };
    let cut = answer(9);
    for (came, open) in [(&request[..6], true), (&cut[..5], false), (&[1, 3, 4, 0, 9, 0, 1][..], true)] {
        let (mut wire, _) = wire(&[&[(9, came)]]);
        assert!(wire.exchange(&request, &expected, WINDOW).is_err_and(|failure| failure.is_garbage()));
        let owed = wire.owed(Shape::of_request(&request, &expected).unwrap());
        assert_eq!(!owed.is_empty(), open, "{came:?}");
    }
}

#[test]
fn the_echo_of_a_broadcast_is_taken_off_and_the_line_is_not_distrusted_for_it() {
    let broadcast = Expected::Nothing { protocol: Protocol::Dcon, checksum: false };
    let any = addressed(Content::Any);
    let (mut wire, sent) = wire(&[&[(20, b"$012\r!01400600\r")], &[(5, b"~**\r")], &[(20, b"~01RD\r!0105\r")]]);
    wire.exchange(b"$012\r", &any, WINDOW).unwrap();
    wire.exchange(b"~**\r", &broadcast, WINDOW).unwrap();
    assert_eq!(wire.exchange(b"~01RD\r", &any, WINDOW), Ok(b"!0105".to_vec()));
    let sent = sent.lock().unwrap();
    assert!(sent[2] - sent[1] < WARY_QUIET, "{:?}", sent[2] - sent[1]);
}

#[test]
fn an_answer_that_comes_just_before_the_question_that_makes_certain_is_the_one_too_many() {
    let (first, second, coil) = (answer(1), answer(2), modbus::with_crc(&[1, 1, 1, 0]));
    let (wire, sent) = wire(&[&[(20, &first)], &[(5, &first), (6, &second)], &[(20, &coil)]]);
    let target =
        Target { address: 1, protocol: Protocol::ModbusRtu, settings: LineSettings::default(), checksum: false };
    let mut dialogue = Dialogue::on_wire(wire).unwrap();
    let mut speaker = dialogue.with(target, Patience::CONVERSATION);
    for place in [0, 9] {
        let answer = speaker.ask(&Query::ReadHoldingRegisters { first: place, count: 1 });
        assert_eq!(answer, Ok(Reply::Words(vec![1])), "nothing shows yet whose it is");
    }
    assert!(speaker.certain().is_err_and(|failure| failure.is_garbage()));
    assert_eq!(sent.lock().unwrap().len(), 3);
}

#[test]
fn a_modbus_module_is_asked_otherwise_until_nothing_is_owed() {
    let (value, coil) = (answer(3), modbus::with_crc(&[1, 1, 1, 0]));
    let prompt = |bytes: &[u8]| vec![(20, bytes.to_vec())];
    let script = [vec![], vec![], prompt(&coil), prompt(&coil), prompt(&value)];
    let script: Vec<Vec<(u64, &[u8])>> =
        script.iter().map(|answers| answers.iter().map(|(ms, bytes)| (*ms, bytes.as_slice())).collect()).collect();
    let script: Vec<&[(u64, &[u8])]> = script.iter().map(Vec::as_slice).collect();
    let (mut wire, sent) = wire(&script);
    // The coil's answer may be that to the first question, after which the second one is still open.
    let read_coil = modbus::with_crc(&[1, 1, 0, 0, 0, 1]);
    assert_eq!(wire.exchange(&read_coil, &Expected::Rtu { address: 1 }, WINDOW), Err(Failure::Silent));
    assert_eq!(ask(&mut wire), Err(Failure::Silent));
    let target =
        Target { address: 1, protocol: Protocol::ModbusRtu, settings: LineSettings::default(), checksum: false };
    let mut dialogue = Dialogue::on_wire(wire).unwrap();
    let mut speaker = dialogue.with(target, Patience::CONVERSATION);
    assert_eq!(speaker.ask(&Query::ReadHoldingRegisters { first: 0, count: 1 }), Ok(Reply::Words(vec![3])));
    let sent = sent.lock().unwrap();
    assert!(sent[4] - sent[2] < Duration::from_millis(500), "nothing is waited for: {:?}", sent[4] - sent[2]);
}

#[test]
fn a_second_stop_bit_hides_no_late_answer_and_another_speed_does() {
    let usual = LineSettings::default();
    let slower = LineSettings { baud_rate: BaudRate::new(1_200).unwrap(), ..usual };
    for (there, open) in [(LineSettings { data_format: DataFormat::N82, ..usual }, true), (slower, false)] {
        let (mut wire, _) = wire(&[&[]]);
        assert_eq!(ask(&mut wire), Err(Failure::Silent));
        wire.configure(there).unwrap();
        let shape = Shape::of_request(&modbus::with_crc(REQUEST), &Expected::Rtu { address: 1 }).unwrap();
        assert_eq!(!wire.owed(shape).is_empty(), open, "{there}");
    }
}

#[test]
fn what_was_owed_before_the_line_was_lost_is_still_owed_when_it_is_back() {
    let (mut before, _) = wire(&[&[]]);
    assert_eq!(ask(&mut before), Err(Failure::Silent));
    let (mut after, _) = wire(&[]);
    after.keep_debts(before.into_debts());
    let shape = Shape::of_request(&modbus::with_crc(REQUEST), &Expected::Rtu { address: 1 }).unwrap();
    assert!(!after.owed(shape).is_empty());
}

#[test]
fn a_broadcast_waits_for_no_answer() {
    let (mut wire, sent) = wire(&[&[], &[]]);
    let broadcast = Expected::Nothing { protocol: Protocol::Dcon, checksum: false };
    wire.exchange(b"~**\r", &broadcast, WINDOW).unwrap();
    wire.exchange(b"~**\r", &broadcast, WINDOW).unwrap();
    let sent = sent.lock().unwrap();
    assert_eq!(sent[1] - sent[0], LineSettings::default().wire_time(4));
}

#[test]
fn an_answer_of_a_neighbour_is_passed_over_while_the_right_one_is_awaited() {
    let expected = Expected::Dcon { checksum: false, from: AnswerFrom::Addresses(vec![1]), content: Content::Any };
    let (mut wire, _) = wire(&[&[(10, b"!02PIR130\r"), (40, b"!01PIR234\r")]]);
    let answer = wire.exchange(b"$01M\r", &expected, WINDOW).unwrap();
    assert_eq!(hex::escaped(&answer), "!01PIR234");
}

#[test]
fn an_answer_that_could_be_a_second_copy_is_not_believed_when_its_own_may_have_come_while_the_speed_was_changed() {
    let (first, second) = (answer(1), answer(2));
    let (mut wire, _) = wire(&[&[(20, &first)], &[(5, &first), (30, &second)]]);
    ask(&mut wire).unwrap();
    let other = modbus::with_crc(&[1, 3, 0, 9, 0, 1]);
    let expected = Expected::Rtu { address: 1 };
    assert_eq!(wire.exchange(&other, &expected, WINDOW), Ok(first), "nothing shows yet whose it is");
    let shape = Shape::of_request(&other, &expected).unwrap();
    assert_eq!(wire.doubts(shape), Doubts::Open(vec![shape]));
    let slower = LineSettings { baud_rate: BaudRate::new(1_200).unwrap(), ..LineSettings::default() };
    assert_eq!(wire.configure(slower), Ok(true));
    assert_eq!(wire.doubts(shape), Doubts::Spoiled);
}

#[test]
fn an_answer_that_carries_another_modules_address_is_not_waited_for_and_not_taken() {
    let addressed = Expected::Dcon { checksum: false, from: AnswerFrom::Addresses(vec![7]), content: Content::Any };
    let bare = Expected::Dcon { checksum: false, from: AnswerFrom::Anyone, content: Content::Any };
    let late: &[(u64, &[u8])] = &[(20, b"!070000\r"), (40, b">A200100\r")];
    let (mut wire, sent) = wire(&[&[], late, &[(20, b">A200100\r")]]);
    assert_eq!(wire.exchange(b"@07RAO\r", &addressed, WINDOW), Err(Failure::Silent));
    let refused = wire.exchange(b"@A2DI\r", &bare, WINDOW);
    assert!(refused.as_ref().is_err_and(Failure::is_garbage), "{refused:?}");
    assert_eq!(wire.exchange(b"@A2DI\r", &bare, WINDOW), Ok(b">A200100".to_vec()));
    let sent = sent.lock().unwrap();
    assert_eq!(sent[1] - sent[0], WINDOW + LineSettings::default().wire_time(7), "nothing is waited for");
    assert!(sent[2] - sent[1] >= Duration::from_millis(40), "the right answer was under way");
}

const NAME: &[u8] = b"!01PIR234";

fn addressed(content: Content) -> Expected {
    Expected::Dcon { checksum: false, from: AnswerFrom::Addresses(vec![1]), content }
}

#[test]
fn the_name_is_listened_for_behind_late_answers_and_ends_the_wait_for_them() {
    let (any, name) = (addressed(Content::Any), addressed(Content::Name(NAME.to_vec())));
    let late: &[(u64, &[u8])] = &[(50, b"!01400600\r"), (90, b"!01PIR234\r")];
    let (mut wire, sent) = wire(&[&[], late, &[(20, b"!0105\r")]]);
    assert_eq!(wire.exchange(b"$012\r", &any, WINDOW), Err(Failure::Silent));
    assert_eq!(wire.probe(b"$01M\r", &name, WINDOW), Ok((NAME.to_vec(), true)));
    assert_eq!(wire.exchange(b"~01RD\r", &any, WINDOW), Ok(b"!0105".to_vec()));
    let sent = sent.lock().unwrap();
    assert!(sent[2] - sent[1] < Duration::from_millis(150), "nothing more is waited for");
}

#[test]
fn a_known_name_that_is_owed_is_neither_waited_for_nor_taken_for_another_answer() {
    let (any, name) = (addressed(Content::Any), addressed(Content::Name(NAME.to_vec())));
    let late: &[(u64, &[u8])] = &[(40, b"!01PIR234\r"), (80, b"!01400600\r")];
    let (mut wire, sent) = wire(&[&[], late, &[(20, b"!0105\r")]]);
    assert_eq!(wire.probe(b"$01M\r", &name, WINDOW), Err(Failure::Silent));
    assert_eq!(wire.exchange(b"$012\r", &any, WINDOW), Ok(b"!01400600".to_vec()));
    assert_eq!(wire.exchange(b"~01RD\r", &any, WINDOW), Ok(b"!0105".to_vec()));
    let sent = sent.lock().unwrap();
    assert_eq!(sent[1] - sent[0], WINDOW + LineSettings::default().wire_time(5));
}

#[test]
fn another_name_is_an_answer_too_so_that_another_module_is_noticed() {
    let name = addressed(Content::Name(NAME.to_vec()));
    let (mut wire, _) = wire(&[&[(20, b"!01PIR130\r")]]);
    assert_eq!(wire.probe(b"$01M\r", &name, WINDOW), Ok((b"!01PIR130".to_vec(), false)));
}

#[test]
fn a_name_that_may_be_an_earlier_one_leaves_what_was_asked_in_between_open_until_it_is_asked_for_once_more() {
    let (any, name) = (addressed(Content::Any), addressed(Content::Name(NAME.to_vec())));
    let answer: &[(u64, &[u8])] = &[(20, b"!01PIR234\r")];
    let (mut wire, sent) = wire(&[&[], &[], answer, answer, &[(20, b"!0105\r")]]);
    let shape = Shape::of_request(b"$012\r", &any).unwrap();
    assert_eq!(wire.probe(b"$01M\r", &name, WINDOW), Err(Failure::Silent));
    assert_eq!(wire.exchange(b"$012\r", &any, WINDOW), Err(Failure::Silent));
    for still_open in [true, false] {
        assert_eq!(wire.probe(b"$01M\r", &name, WINDOW), Ok((NAME.to_vec(), false)));
        assert_eq!(!wire.owed(shape).is_empty(), still_open);
    }
    assert_eq!(wire.exchange(b"~01RD\r", &any, WINDOW), Ok(b"!0105".to_vec()));
    let sent = sent.lock().unwrap();
    assert!(sent[4] - sent[1] < Duration::from_millis(400), "nothing is waited for until it can come no more");
}
