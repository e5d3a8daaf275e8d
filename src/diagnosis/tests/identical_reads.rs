//! What identical reads of one module show.

use super::*;
use crate::bus::{RawRequest, Tuning};
use crate::protocol::Failure;

fn judged(results: Vec<Result<Vec<u8>, Failure>>) -> Consistency {
    let mut test = ConsistencyTest::new(at(1), 20, Tuning::default());
    results.iter().for_each(|result| test.answered(result));
    test.outcome()
}

fn garbled(bytes: &[u8]) -> Result<Vec<u8>, Failure> {
    Err(Failure::Garbled { reason: "wrong CRC: 0000 was received".to_owned(), bytes: bytes.to_vec() })
}

#[test]
fn the_same_answer_each_time_is_fine() {
    let test = judged(vec![Ok(vec![1, 2]); 20]);
    assert_eq!((test.judgement, test.said.as_str()), (Judgement::Fine, "20 of 20 reads answered, all the same"));
}

#[test]
fn different_answers_are_two_modules() {
    let answers = (0..20).map(|index| Ok(vec![index % 2])).collect();
    assert_eq!(judged(answers).judgement, Judgement::Doubled);
}

#[test]
fn one_odd_answer_is_a_flipped_bit_and_two_alike_are_another_module() {
    let odd = |which: &[usize]| {
        let answer = |index| if which.contains(&index) { vec![2] } else { vec![1] };
        judged((0..50).map(|index| Ok(answer(index))).collect())
    };
    assert_eq!(odd(&[7]).judgement, Judgement::Noise);
    assert_eq!(odd(&[7, 30]).judgement, Judgement::Doubled);
}

#[test]
fn broken_answers_that_change_are_two_modules_or_noise_and_a_few_are_noise() {
    let mixed = |every: u8| (0..20).map(|i| if i % every == 0 { garbled(&[i]) } else { Ok(vec![1]) }).collect();
    let half = judged(mixed(2));
    assert_eq!(half.judgement, Judgement::DoubledOrNoise);
    let few = judged(mixed(10));
    assert_eq!((few.judgement, few.different_failures), (Judgement::Noise, 2));
    let mut line = Played::default();
    line.good(at(1), 10);
    line.diagnosis.note_test(half);
    let next_step = line.found(Symptom::DoubledOrNoise).next_step;
    assert!(next_step.contains("Switch off one module") && next_step.contains("120 Ω"), "both ways: {next_step}");
}

#[test]
fn the_same_broken_answer_each_time_is_a_matter_of_settings_and_not_noise() {
    let test = judged(vec![garbled(&[1, 3, 9]); 20]);
    assert_eq!(test.judgement, Judgement::SameErrors);
}

#[test]
fn bytes_without_sense_are_not_two_modules() {
    let reason = "no DCON answer is in it".to_owned();
    let garbage = |index| Err(Failure::Garbled { reason: reason.clone(), bytes: vec![0x80, index] });
    assert_eq!(judged((0..20).map(garbage).collect()).judgement, Judgement::Unreadable);
}

#[test]
fn a_read_that_was_not_sent_is_none() {
    let mut test = ConsistencyTest::new(at(1), 5, Tuning::default());
    let reason = "the wait for an answer that is late was cut short".to_owned();
    let postponed = Err(Failure::Garbled { reason, bytes: Vec::new() });
    test.answered(&postponed);
    assert_eq!((test.progress(), test.outcome().failures.len()), ((0, 5), 0));
    (0..4).for_each(|_| test.answered(&postponed));
    assert!(test.is_done(), "it does not wait for ever");
}

/// A test of the DCON module 1, behind whose answers `second` came.
fn followed_by(first: Verdict, second: &[u8]) -> Consistency {
    let (mut line, target) = (Played::default(), dcon_at(1));
    let mut test = ConsistencyTest::new(target, 5, Tuning::default());
    for _ in 0..5 {
        let (bytes, result): (&[u8], _) = match first {
            Verdict::Silent => (b"", Err(Failure::Silent)),
            _ => (b"!01PIR234\r", Ok(b"!01PIR234".to_vec())),
        };
        test.take(&line.frame(target, Direction::Sent, b"$01M\r", Verdict::Request));
        test.take(&line.frame(target, Direction::Received, bytes, first.clone()));
        test.answered(&result);
        test.take(&line.frame(target, Direction::Received, second, broken(UNASKED)));
    }
    test.outcome()
}

#[test]
fn second_copies_are_a_repeater_and_other_answers_another_module() {
    let copies = followed_by(Verdict::Answer, b"!01PIR234\r");
    assert_eq!((copies.judgement, copies.copies), (Judgement::Twice, 5));
    assert_eq!(copies.said, "5 of 5 reads answered, all the same; 5 came twice");
    let mut line = Played::default();
    line.good(dcon_at(1), 10);
    line.diagnosis.note_test(copies);
    assert_eq!(line.found(Symptom::Twice).title, "Answers come twice");
    assert_eq!(followed_by(Verdict::Answer, b"!01PIR130\r").judgement, Judgement::Doubled);
    assert_eq!(followed_by(Verdict::Answer, &[0xFF]).judgement, Judgement::Noise);
}

#[test]
fn an_answer_behind_a_read_that_was_given_up_is_late_and_no_second_one() {
    let late = followed_by(Verdict::Silent, b"!01PIR234\r");
    assert_eq!((late.judgement, late.late, late.copies), (Judgement::Late, 5, 0));
    assert!(late.said.contains("5 came later than the timeout of 200 ms"), "{}", late.said);
    let mut line = Played::default();
    line.good(dcon_at(1), 10);
    line.diagnosis.note_test(late);
    assert_eq!(line.found(Symptom::Late).severity, Severity::Fault);
    let suggested = line.report().modules[0].suggested_timeout.clone().unwrap();
    assert_eq!(suggested.verdict(), "200 ms in use, 400 ms suggested");
}

#[test]
fn silence_is_loss_or_absence() {
    let some = (0..20).map(|i| if i == 3 { Err(Failure::Silent) } else { Ok(vec![1]) }).collect();
    assert_eq!(judged(some).judgement, Judgement::Lossy);
    let mut test = ConsistencyTest::new(at(1), 50, Tuning::default());
    (0..10).for_each(|_| test.answered(&Err(Failure::Silent)));
    assert!(test.is_done(), "nobody is asked fifty times in vain");
    assert_eq!(test.outcome().judgement, Judgement::NoAnswer);
}

#[test]
fn a_dcon_answer_with_another_address_is_another_modules() {
    let mut test = ConsistencyTest::new(dcon_at(1), 5, Tuning::default());
    test.answered(&Ok(b"!02PIR234".to_vec()));
    assert_eq!(test.outcome().failures[&FailureKind::WrongAddress], 1);
}

#[test]
fn its_own_frames_are_told_from_those_of_polls() {
    let mut line = Played::default();
    let mut test = ConsistencyTest::new(dcon_at(1), 5, Tuning::default());
    assert_eq!(test.request(), RawRequest::Dcon { text: "$01M".to_owned(), checksum: false });
    for (request, answer) in [(&b"$01M\r"[..], &b"!01PIR234\r"[..]), (b"#01\r", b">+025.00\r")] {
        test.take(&line.frame(dcon_at(1), Direction::Sent, request, Verdict::Request));
        test.take(&line.frame(dcon_at(1), Direction::Received, answer, Verdict::Answer));
    }
    assert_eq!(test.outcome().times.unwrap().count, 1);
}

#[test]
fn the_number_of_reads_stays_within_reason() {
    assert_eq!(ConsistencyTest::new(at(1), 0, Tuning::default()).progress(), (0, 5));
    assert_eq!(ConsistencyTest::new(at(1), u32::MAX, Tuning::default()).progress(), (0, 1_000));
}

#[test]
fn a_bad_test_is_a_finding_of_its_module() {
    let mut line = Played::default();
    line.good(at(1), 10);
    line.diagnosis.note_test(judged((0..20).map(|index| Ok(vec![index / 2])).collect()));
    let finding = line.found(Symptom::DoubledAddress);
    assert!(finding.evidence.contains("10 different ones"), "{finding:?}");
}

/// A test as patient as `tuning` says, each of whose reads has a good answer after so many milliseconds or none.
fn answered_after(tuning: Tuning, times: &[Option<u64>]) -> Consistency {
    let (mut line, target) = (Played::default(), dcon_at(1));
    let mut test = ConsistencyTest::new(target, 20, tuning);
    for time in times {
        test.take(&line.frame(target, Direction::Sent, b"$01M\r", Verdict::Request));
        let verdict = if time.is_some() { Verdict::Answer } else { Verdict::Silent };
        let mut frame = line.frame(target, Direction::Received, b"!01PIR234\r", verdict);
        frame.first_byte = time.map(Duration::from_millis);
        test.take(&frame);
        test.answered(&time.map(|_| b"!01PIR234".to_vec()).ok_or(Failure::Silent));
    }
    test.outcome()
}

#[test]
fn an_answer_later_than_the_timeout_in_use_is_too_late_and_its_time_is_known() {
    let tuning = Tuning { timeout: Duration::from_millis(50), repeats: 2 };
    let times: Vec<_> = (0..20).map(|read| Some(if read == 7 { 120 } else { 10 })).collect();
    let test = answered_after(tuning, &times);
    assert_eq!((test.judgement, test.late, test.times.unwrap().max_ms), (Judgement::Late, 1, 120.0));
    assert_eq!(
        test.said,
        "20 of 20 reads answered, all the same; 1 came later than the timeout of 50 ms; asked again at most 2 times, as is \
         set, every read would have succeeded"
    );
    assert_eq!(answered_after(Tuning::default(), &times).judgement, Judgement::Fine);
}

#[test]
fn what_the_repeats_in_use_would_not_have_helped_is_told() {
    let times: Vec<_> = (0..20).map(|read| (!(5..8).contains(&read)).then_some(10)).collect();
    let told = |repeats| {
        let test = answered_after(Tuning { repeats, ..Tuning::default() }, &times);
        assert_eq!(test.judgement, Judgement::Lossy);
        test.said
    };
    assert!(told(0).ends_with("without asking again, as is set, 3 reads would have failed"), "{}", told(0));
    assert!(told(1).ends_with("asked again once, as is set, 1 read would have failed"), "{}", told(1));
    assert!(told(3).ends_with("at most 3 times, as is set, every read would have succeeded"), "{}", told(3));
}
