//! Running a script: a state machine without clock or line. Whoever runs it asks [`ScriptRun::next`] what to do, and
//! tells it every answer.

use std::time::Instant;

use super::command::RawCommand;
use super::script::{Expectation, ExpectedAnswer, Kind, Script};
use crate::protocol::Failure;

/// What is to be done next.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// Send this once, then tell [`ScriptRun::answered`] what came.
    Send(RawCommand),
    /// Ask again at this time.
    WaitUntil(Instant),
    /// Ask again when the answer is told.
    WaitForAnswer,
    /// The script has come to its end.
    Done,
    /// The script was stopped.
    Failed {
        /// 1-based.
        line: usize,
        reason: String,
    },
}

/// How far a run has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Sends, waits and expects that are done.
    pub done: u64,
    pub total: u64,
}

impl Progress {
    /// 0 to 1.
    pub fn fraction(self) -> f32 {
        if self.total == 0 { 1.0 } else { self.done as f32 / self.total as f32 }
    }
}

/// A script under way. A failed `expect` stops it, and so does a line that is lost; a `send` without an `expect` takes
/// any answer, and silence.
#[derive(Debug, Clone, PartialEq)]
pub struct ScriptRun {
    script: Script,
    /// Whether DCON commands carry a checksum.
    checksum: bool,
    /// The next instruction.
    at: usize,
    /// Of the repeats that are open, how often each has still to be done after this time.
    left: Vec<u32>,
    state: State,
    /// The last command and what came back.
    last: Option<(RawCommand, Result<Vec<u8>, Failure>)>,
    done: u64,
    /// Expectations that were met.
    met: u64,
}

#[derive(Debug, Clone, PartialEq)]
enum State {
    Ready,
    Waiting { until: Instant },
    Asking { command: RawCommand },
    Failed { line: usize, reason: String },
}

impl ScriptRun {
    /// Begins at the first line. `checksum` says whether DCON commands carry one.
    pub fn new(script: Script, checksum: bool) -> Self {
        Self { script, checksum, at: 0, left: Vec::new(), state: State::Ready, last: None, done: 0, met: 0 }
    }

    /// What is to be done at `now`. A [`Step::Send`] comes once; [`Step::Done`] and [`Step::Failed`] stay.
    pub fn next(&mut self, now: Instant) -> Step {
        match &self.state {
            State::Failed { line, reason } => return Step::Failed { line: *line, reason: reason.clone() },
            State::Asking { .. } => return Step::WaitForAnswer,
            State::Waiting { until } if now < *until => return Step::WaitUntil(*until),
            State::Waiting { .. } => self.finish_instruction(),
            State::Ready => {}
        }
        loop {
            let Some(instruction) = self.script.instructions.get(self.at) else { return Step::Done };
            let line = instruction.line;
            match &instruction.kind {
                Kind::Send(command) => {
                    let command = self.with_checksum(command);
                    self.state = State::Asking { command: command.clone() };
                    return Step::Send(command);
                }
                Kind::Wait(duration) => {
                    let until = now.checked_add(*duration).unwrap_or(now);
                    self.state = State::Waiting { until };
                    return Step::WaitUntil(until);
                }
                Kind::Expect(expectation) => match self.check(expectation) {
                    Ok(()) => {
                        self.met = self.met.saturating_add(1);
                        self.finish_instruction();
                    }
                    Err(reason) => return self.fail(line, reason),
                },
                Kind::Repeat { count } => {
                    self.left.push(count.saturating_sub(1));
                    self.at = self.at.saturating_add(1);
                }
                Kind::End { start } => {
                    let start = *start;
                    self.end_of_repeat(start);
                }
            }
        }
    }

    /// What came back on the last [`Step::Send`]; ignored if nothing was sent.
    pub fn answered(&mut self, result: Result<Vec<u8>, Failure>) {
        let State::Asking { command } = &self.state else { return };
        let command = command.clone();
        self.finish_instruction();
        if let Err(failure @ (Failure::LineLost(_) | Failure::NotOffered(_))) = &result {
            let reason = format!("{command} could not be sent: {failure}");
            let line = self.line_of(self.at.saturating_sub(1)).unwrap_or_default();
            self.fail(line, reason);
        }
        self.last = Some((command, result));
    }

    /// The line that is being carried out, 1-based; `None` at the end.
    pub fn current_line(&self) -> Option<usize> {
        match &self.state {
            State::Failed { line, .. } => Some(*line),
            _ => self.line_of(self.at),
        }
    }

    pub fn progress(&self) -> Progress {
        Progress { done: self.done, total: self.script.steps() }
    }

    /// Expectations that were met so far.
    pub fn met(&self) -> u64 {
        self.met
    }

    /// How many times the innermost open repeat has still to be done after this time.
    pub fn repeats_left(&self) -> Option<u32> {
        self.left.last().copied()
    }

    pub fn is_over(&self) -> bool {
        let at_end = self.state == State::Ready && self.at >= self.script.instructions.len();
        at_end || matches!(self.state, State::Failed { .. })
    }

    fn line_of(&self, instruction: usize) -> Option<usize> {
        self.script.instructions.get(instruction).map(|instruction| instruction.line)
    }

    fn with_checksum(&self, command: &RawCommand) -> RawCommand {
        match command {
            RawCommand::Dcon { text, .. } => RawCommand::Dcon { text: text.clone(), checksum: self.checksum },
            modbus => modbus.clone(),
        }
    }

    fn finish_instruction(&mut self) {
        self.state = State::Ready;
        self.at = self.at.saturating_add(1);
        self.done = self.done.saturating_add(1);
    }

    fn end_of_repeat(&mut self, start: usize) {
        self.at = match self.left.last_mut() {
            Some(left) if *left > 0 => {
                *left = left.saturating_sub(1);
                start.saturating_add(1)
            }
            _ => {
                self.left.pop();
                self.at.saturating_add(1)
            }
        };
    }

    fn fail(&mut self, line: usize, reason: String) -> Step {
        self.state = State::Failed { line, reason: reason.clone() };
        Step::Failed { line, reason }
    }

    /// `Err` says what was expected and what came. Checksum and CRC need not be written.
    fn check(&self, expectation: &Expectation) -> Result<(), String> {
        let Some((command, result)) = &self.last else { return Err("nothing was sent before this line".to_owned()) };
        let expected = &expectation.source;
        let differs = |came: String| Err(format!("{expected} was expected, but {came} (sent: {command})"));
        match (&expectation.answer, result) {
            (ExpectedAnswer::Nothing, Err(Failure::Silent)) => Ok(()),
            (ExpectedAnswer::Nothing, Ok(answer)) if answer.is_empty() => Ok(()),
            (ExpectedAnswer::Fits(pattern), Ok(answer))
                if pattern.fits(answer) || pattern.fits(command.without_check(answer)) =>
            {
                Ok(())
            }
            (_, Ok(answer)) => differs(format!("{} came", command.show_answer(answer))),
            (_, Err(Failure::Silent)) => differs("no answer came".to_owned()),
            (_, Err(failure)) => differs(failure.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::protocol::modbus;
    use proptest::prelude::*;

    fn run(text: &str) -> ScriptRun {
        ScriptRun::new(Script::parse(text).unwrap(), false)
    }

    fn sent(step: Step) -> String {
        if let Step::Send(command) = step { command.to_string() } else { panic!("{step:?}") }
    }

    fn text(answer: &str) -> Result<Vec<u8>, Failure> {
        Ok(answer.as_bytes().to_vec())
    }

    #[test]
    fn a_script_sends_checks_and_waits_in_order() {
        let start = Instant::now();
        let mut run = run("$01M\nexpect !01PIR*\nwait 500 ms\n$01F");
        assert_eq!(run.current_line(), Some(1));
        assert_eq!(sent(run.next(start)), "$01M");
        assert_eq!(run.next(start), Step::WaitForAnswer);
        run.answered(text("!01PIR234"));
        let until = start + Duration::from_millis(500);
        assert_eq!(run.next(start), Step::WaitUntil(until));
        assert_eq!(run.current_line(), Some(3));
        assert_eq!(run.next(start + Duration::from_millis(499)), Step::WaitUntil(until));
        assert_eq!(sent(run.next(until)), "$01F");
        assert!(!run.is_over());
        run.answered(Err(Failure::Silent));
        assert_eq!(run.next(until), Step::Done, "silence is accepted where nothing is expected");
        assert_eq!((run.current_line(), run.is_over()), (None, true));
        assert_eq!(run.progress(), Progress { done: 4, total: 4 });
    }

    #[test]
    fn a_failed_expectation_stops_and_says_what_was_expected_and_what_came() {
        let failed = |script: &str, answer: Result<Vec<u8>, Failure>| {
            let mut run = run(script);
            let now = Instant::now();
            sent(run.next(now));
            run.answered(answer);
            let step = run.next(now);
            assert_eq!(run.next(now), step, "it stays stopped");
            if let Step::Failed { line, reason } = step { (line, reason) } else { panic!("{step:?}") }
        };
        let (line, reason) = failed("$01M\n\nexpect !01PIR130\n$01F", text("!01PIR234"));
        assert_eq!((line, reason.as_str()), (3, "!01PIR130 was expected, but !01PIR234 came (sent: $01M)"));
        let (_, reason) = failed("$01M\nexpect !01*", Err(Failure::Silent));
        assert!(reason.contains("but no answer came"), "{reason}");
        let (_, reason) = failed("$01M\nexpect nothing", text("!01PIR234"));
        assert!(reason.contains("nothing was expected, but !01PIR234 came"), "{reason}");
        let garbled = Failure::Garbled { reason: "wrong checksum".into(), bytes: b"!01".to_vec() };
        let (_, reason) = failed("$01M\nexpect *", Err(garbled));
        assert!(reason.contains("wrong checksum (21 30 31)"), "{reason}");
        let (_, reason) = failed("send hex 01 03 00 00 00 01\nexpect hex 01 03 *", Ok(modbus::with_crc(&[1, 0x83, 2])));
        assert!(reason.contains("hex 01 03 * was expected, but 01 83 02 C0 F1 came"), "{reason}");
    }

    #[test]
    fn checksum_and_crc_need_not_be_written() {
        let now = Instant::now();
        let mut run = ScriptRun::new(Script::parse("$02M\nexpect !02PIR130").unwrap(), true);
        let Step::Send(command) = run.next(now) else { panic!("nothing sent") };
        assert_eq!(command.on_wire(), b"$02MD3\r");
        run.answered(text("!02PIR13002"));
        assert_eq!(run.next(now), Step::Done);
        for answer in [vec![1, 6, 0, 0, 0, 7], modbus::with_crc(&[1, 6, 0, 0, 0, 7])] {
            let mut run = self::run("send hex 01 06 00 00 00 07\nexpect hex 01 06 00 00 00 07");
            sent(run.next(now));
            run.answered(Ok(answer));
            assert_eq!(run.next(now), Step::Done);
        }
    }

    #[test]
    fn silence_is_what_expect_nothing_wants() {
        let now = Instant::now();
        for answer in [Err(Failure::Silent), Ok(Vec::new())] {
            let mut run = run("~**\nexpect nothing");
            sent(run.next(now));
            run.answered(answer);
            assert_eq!(run.next(now), Step::Done);
        }
    }

    #[test]
    fn repeats_in_each_other_are_done_as_often_as_they_say() {
        let now = Instant::now();
        let mut run = run("repeat 3\n$01M\nrepeat 2\n#01\nexpect *\nend\nend\n~01RD");
        let mut commands = Vec::new();
        loop {
            match run.next(now) {
                Step::Send(command) => commands.push(command.to_string()),
                Step::Done => break,
                step => panic!("{step:?}"),
            }
            run.answered(text("!01"));
        }
        let expected = ["$01M", "#01", "#01"].repeat(3);
        assert_eq!(commands, [expected, vec!["~01RD"]].concat());
        assert_eq!(run.progress().fraction(), 1.0);
    }

    #[test]
    fn a_lost_line_stops_the_script_at_the_line_that_sent() {
        let now = Instant::now();
        let mut run = run("\n$01M\n$01F");
        sent(run.next(now));
        run.answered(Err(Failure::LineLost("unplugged".into())));
        let Step::Failed { line, reason } = run.next(now) else { panic!("it goes on") };
        assert!(line == 2 && reason.contains("unplugged"), "{line}: {reason}");
        assert!(run.is_over());
    }

    #[test]
    fn an_answer_that_nobody_waits_for_changes_nothing() {
        let mut run = run("$01M");
        let before = run.clone();
        run.answered(text("!01"));
        assert_eq!(run, before);
    }

    proptest! {
        #[test]
        fn whatever_is_answered_every_script_comes_to_its_end(
            lines in prop::collection::vec(
                prop::sample::select(vec!["$01M", "expect *", "expect nothing", "wait 1 ms", "repeat 3", "end"]), 0..20
            ),
            answers in prop::collection::vec(prop::option::of(any::<Vec<u8>>()), 1..10),
        ) {
            let Ok(script) = Script::parse(&lines.join("\n")) else { return Ok(()) };
            let mut run = ScriptRun::new(script, true);
            let mut now = Instant::now();
            let mut answers = answers.into_iter().cycle();
            for _ in 0..5_000 {
                match run.next(now) {
                    Step::Send(_) => run.answered(answers.next().flatten().ok_or(Failure::Silent)),
                    Step::WaitUntil(until) => now = until,
                    Step::WaitForAnswer => prop_assert!(false, "every send was answered"),
                    Step::Done => {
                        prop_assert_eq!(run.progress().done, run.progress().total);
                        return Ok(());
                    }
                    Step::Failed { line, .. } => {
                        prop_assert!(lines[line - 1].starts_with("expect"));
                        return Ok(());
                    }
                }
            }
            prop_assert!(false, "it did not end");
        }
    }
}
