//! Scripts of several lines: send, wait, expect, repeat.
//!
//! ```text
//! // comment
//! $01M                          a DCON command, also as: send $01M
//! expect !01PIR*                what its answer has to look like; * any characters, ? one
//! send hex 01 03 00 00 00 05    a Modbus request, address first; the CRC is added
//! expect hex 01 03 0A *         the same over bytes
//! expect nothing                nobody may answer
//! wait 500 ms                   or: wait 2 s
//! repeat 10                     what stands between is done ten times; at most three in each other
//! end
//! ```

use std::time::Duration;

use super::command::{RawCommand, after_word, check_typed};
use super::pattern::Pattern;

/// Repeats in each other.
const MOST_NESTED: usize = 3;
const MOST_REPEATS: u32 = 100_000;
/// The shortest wait in milliseconds; with none a script could run without an end in no time.
const SHORTEST_WAIT: u64 = 1;
/// The longest wait in milliseconds: a day.
const LONGEST_WAIT: u64 = 86_400_000;

/// A line that is no instruction.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {reason}")]
pub struct ScriptError {
    /// 1-based.
    pub line: usize,
    /// What is wrong and what to write instead.
    pub reason: String,
}

/// Something in a script that may not be meant so.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScriptHint {
    /// 1-based.
    pub line: usize,
    pub text: String,
}

/// A script that can be run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Script {
    pub(super) instructions: Vec<Instruction>,
    total: u64,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Instruction {
    /// 1-based.
    pub line: usize,
    pub kind: Kind,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Kind {
    Send(RawCommand),
    Wait(Duration),
    Expect(Expectation),
    Repeat {
        count: u32,
    },
    /// The end of the repeat that began at `start`.
    End {
        start: usize,
    },
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Expectation {
    /// As it was written, for telling.
    pub source: String,
    pub answer: ExpectedAnswer,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum ExpectedAnswer {
    Fits(Pattern),
    Nothing,
}

impl Script {
    /// Reads a script. The first line that is wrong is told.
    pub fn parse(text: &str) -> Result<Self, ScriptError> {
        let mut reader = Reader::default();
        for (at, source) in text.lines().enumerate() {
            let line = at.saturating_add(1);
            let source = source.split_once("//").map_or(source, |(before, _)| before).trim();
            if !source.is_empty() {
                reader.take(line, source).map_err(|reason| ScriptError { line, reason })?;
            }
        }
        reader.finish()
    }

    /// Sends, waits and expects of one run, with every repetition counted.
    pub fn steps(&self) -> u64 {
        self.total
    }

    /// Whether there is nothing to do.
    pub fn is_empty(&self) -> bool {
        self.instructions.is_empty()
    }

    /// What it sends, with the lines, 1-based.
    pub fn commands(&self) -> impl Iterator<Item = (usize, &RawCommand)> {
        self.instructions.iter().filter_map(|instruction| match &instruction.kind {
            Kind::Send(command) => Some((instruction.line, command)),
            _ => None,
        })
    }

    /// What [`check_typed`] says of the lines that send. `checksum` says whether DCON commands get one.
    pub fn hints(&self, checksum: bool) -> Vec<ScriptHint> {
        let of = |instruction: &Instruction| {
            let Kind::Send(command) = &instruction.kind else { return Vec::new() };
            let hints = check_typed(&command.to_string(), checksum).into_iter();
            hints.map(|hint| ScriptHint { line: instruction.line, text: hint.text }).collect()
        };
        self.instructions.iter().flat_map(of).collect()
    }
}

/// What has been read so far.
#[derive(Default)]
struct Reader {
    instructions: Vec<Instruction>,
    open: Vec<Open>,
    sends: bool,
    /// Steps so far, with those of ended repeats counted as often as they are done.
    steps: u64,
}

/// A repeat whose `end` has not come yet.
struct Open {
    start: usize,
    line: usize,
    count: u32,
    /// Steps before it.
    steps_before: u64,
    /// Something in it takes time.
    takes_time: bool,
}

impl Reader {
    fn take(&mut self, line: usize, source: &str) -> Result<(), String> {
        let (word, rest) = source.split_once(char::is_whitespace).unwrap_or((source, ""));
        let rest = rest.trim();
        let kind = match word.to_ascii_lowercase().as_str() {
            _ if source.starts_with(['$', '#', '%', '@', '~']) => Kind::Send(RawCommand::parse(source, false)?),
            "send" => Kind::Send(RawCommand::parse(rest, false)?),
            "wait" => Kind::Wait(duration(rest)?),
            "expect" => self.expectation(rest)?,
            "repeat" => self.begin_repeat(line, rest)?,
            "end" => return self.end_repeat(line, rest),
            _ => return Err(unknown_line(source)),
        };
        self.sends |= matches!(kind, Kind::Send(_));
        if matches!(kind, Kind::Send(_) | Kind::Wait(_)) {
            self.open.iter_mut().for_each(|open| open.takes_time = true);
        }
        if !matches!(kind, Kind::Repeat { .. }) {
            self.steps = self.steps.saturating_add(1);
        }
        self.instructions.push(Instruction { line, kind });
        Ok(())
    }

    fn expectation(&self, source: &str) -> Result<Kind, String> {
        if source.is_empty() {
            return Err("what is expected is missing – write expect !01*, expect hex 01 03 * or expect nothing".into());
        }
        if !self.sends {
            return Err("nothing was sent before this line – put a command before what is expected".to_owned());
        }
        let answer = if source.eq_ignore_ascii_case("nothing") {
            ExpectedAnswer::Nothing
        } else if let Some(bytes) = after_word(source, "hex") {
            if bytes.is_empty() {
                return Err("the bytes are missing – write for example expect hex 01 03 0A *".to_owned());
            }
            ExpectedAnswer::Fits(Pattern::bytes(bytes)?)
        } else {
            ExpectedAnswer::Fits(Pattern::text(source)?)
        };
        Ok(Kind::Expect(Expectation { source: source.to_owned(), answer }))
    }

    fn begin_repeat(&mut self, line: usize, source: &str) -> Result<Kind, String> {
        if self.open.len() >= MOST_NESTED {
            return Err(format!("at most {MOST_NESTED} repeats may stand in each other – take one out"));
        }
        let count = source.parse().ok().filter(|count| (1..=MOST_REPEATS).contains(count));
        let count = count.ok_or_else(|| {
            format!("\"{source}\" is not how often to repeat – write a number from 1 to {MOST_REPEATS}, as repeat 10")
        })?;
        let (start, steps_before) = (self.instructions.len(), self.steps);
        self.open.push(Open { start, line, count, steps_before, takes_time: false });
        Ok(Kind::Repeat { count })
    }

    fn end_repeat(&mut self, line: usize, rest: &str) -> Result<(), String> {
        if !rest.is_empty() {
            return Err(format!("\"{rest}\" follows end – let end stand alone"));
        }
        let open =
            self.open.pop().ok_or("there is no repeat that ends here – take this line out, or write repeat 10")?;
        if !open.takes_time {
            return Err(format!(
                "the repeat of line {} neither sends nor waits – put a command or a wait between",
                open.line
            ));
        }
        let once = self.steps.saturating_sub(open.steps_before);
        self.steps = open.steps_before.saturating_add(once.saturating_mul(u64::from(open.count)));
        self.instructions.push(Instruction { line, kind: Kind::End { start: open.start } });
        Ok(())
    }

    fn finish(self) -> Result<Script, ScriptError> {
        if let Some(open) = self.open.last() {
            let reason = "this repeat has no end – write end after the last line to repeat".to_owned();
            return Err(ScriptError { line: open.line, reason });
        }
        Ok(Script { instructions: self.instructions, total: self.steps })
    }
}

fn unknown_line(source: &str) -> String {
    match RawCommand::parse(source, false) {
        // What tells of another kind of command is more help than the list of instructions.
        Err(reason) if source.starts_with(|first: char| first.is_ascii_digit() || "!>?".contains(first)) => reason,
        _ if after_word(source, "hex").is_some() => format!("bytes are sent with the word send – write send {source}"),
        _ => format!(
            "\"{source}\" is no instruction – write send, wait, expect, repeat or end, or a command such as $01M"
        ),
    }
}

/// `500 ms`, `2 s`, `0.5 s`, with or without the space.
fn duration(text: &str) -> Result<Duration, String> {
    let wrong = || format!("\"{text}\" is not a time – write for example wait 500 ms or wait 2 s");
    if text.is_empty() {
        return Err("how long is missing – write for example wait 500 ms or wait 2 s".to_owned());
    }
    let digits =
        text.len() - text.trim_start_matches(|character: char| character.is_ascii_digit() || character == '.').len();
    let (number, unit) = text.split_at_checked(digits).ok_or_else(wrong)?;
    let thousandths = match unit.trim().to_ascii_lowercase().as_str() {
        "ms" => thousandths(number).filter(|_| !number.contains('.')).and_then(|value| value.checked_div(1_000)),
        "s" => thousandths(number),
        "" => return Err(format!("\"{text}\" has no unit – write wait {text} ms or wait {text} s")),
        _ => None,
    };
    let milliseconds = thousandths.ok_or_else(wrong)?;
    if !(SHORTEST_WAIT..=LONGEST_WAIT).contains(&milliseconds) {
        return Err(format!("{text} is out of range – a wait takes {SHORTEST_WAIT} ms to 86400 s"));
    }
    Ok(Duration::from_millis(milliseconds))
}

/// A decimal number times 1000; at most three decimals.
fn thousandths(number: &str) -> Option<u64> {
    let (whole, fraction) = number.split_once('.').unwrap_or((number, "0"));
    let digits = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    if !digits(whole) || !digits(fraction) || fraction.len() > 3 {
        return None;
    }
    let whole: u64 = whole.parse().ok()?;
    whole.checked_mul(1_000)?.checked_add(format!("{fraction:0<3}").parse().ok()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn error(text: &str) -> ScriptError {
        Script::parse(text).unwrap_err()
    }

    #[test]
    fn every_kind_of_line_is_understood() {
        let text = "// a comment\n\n  $01M // and one behind\nexpect !01PIR*\nSEND hex 01 03 00 00 00 05\nexpect hex 01 03 *\n\
                    wait 500 ms\nwait 0.5s\nrepeat 10\n  send #01\n  wait 2 s\nend\n~**\nexpect nothing\n";
        let script = Script::parse(text).unwrap();
        let lines: Vec<_> = script.instructions.iter().map(|instruction| instruction.line).collect();
        assert_eq!(lines, [3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14]);
        assert_eq!(script.steps(), 6 + 20 + 2);
        let half_a_second = Kind::Wait(Duration::from_millis(500));
        assert!(script.instructions[4].kind == half_a_second && script.instructions[5].kind == half_a_second);
    }

    #[test]
    fn an_empty_script_is_a_script() {
        assert!(Script::parse("").unwrap().is_empty());
        assert_eq!(Script::parse(" // nothing\r\n").unwrap().steps(), 0);
    }

    #[test]
    fn a_wrong_line_is_told_with_its_number_and_what_to_write() {
        for (text, line, expected) in [
            ("$01M\nsned $01M", 2, "write send, wait, expect"),
            ("send", 1, "nothing to send"),
            ("send 01M", 1, "$ # % @ ~"),
            ("01 03 00 00 00 01", 1, "for Modbus write hex"),
            ("hex 01 03", 1, "write send hex 01 03"),
            ("!01PIR", 1, "looks like an answer"),
            ("send hex 01 0", 1, "\"0\""),
            ("wait", 1, "how long is missing"),
            ("wait 500", 1, "wait 500 ms or wait 500 s"),
            ("wait soon", 1, "is not a time"),
            ("wait 0 ms", 1, "1 ms to 86400 s"),
            ("wait 1.5 ms", 1, "is not a time"),
            ("wait 100000 s", 1, "out of range"),
            ("expect !01", 1, "nothing was sent before"),
            ("$01M\nexpect", 2, "expect nothing"),
            ("$01M\nexpect hex", 2, "bytes are missing"),
            ("$01M\nexpect hex 0G", 2, "\"0G\""),
            ("end", 1, "no repeat that ends here"),
            ("$01M\n\nrepeat 2\n$01M", 3, "has no end"),
            ("repeat\n$01M\nend", 1, "1 to 100000"),
            ("repeat 0\n$01M\nend", 1, "1 to 100000"),
            ("repeat 100001\n$01M\nend", 1, "1 to 100000"),
            ("repeat 2\n$01M\nend now", 3, "let end stand alone"),
            ("repeat 1\nrepeat 1\nrepeat 1\nrepeat 1\n$01M", 4, "at most 3"),
            ("$01M\nrepeat 5\nexpect *\nend", 4, "the repeat of line 2 neither sends nor waits"),
            ("repeat 5\nend", 2, "neither sends nor waits"),
        ] {
            let error = error(text);
            assert_eq!(error.line, line, "{text}: {error}");
            assert!(error.reason.contains(expected), "{text}: {error}");
        }
        assert!(error("x").to_string().starts_with("line 1: "));
    }

    #[test]
    fn repeats_in_each_other_multiply_their_steps() {
        let script =
            Script::parse("repeat 100000\nrepeat 100000\nrepeat 100000\n$01M\nend\nend\nwait 1 ms\nend").unwrap();
        assert_eq!(script.steps(), 100_000 * (100_000u64 * 100_000 + 1));
    }

    #[test]
    fn hints_are_told_with_their_lines() {
        let hints = Script::parse("$01M\n\n$01FCB").unwrap().hints(true);
        assert_eq!(hints.len(), 1);
        assert!(hints[0].line == 3 && hints[0].text.contains("sent twice"));
    }

    proptest! {
        #[test]
        fn no_text_makes_the_parser_panic(text: String) {
            let _ = Script::parse(&text);
        }

        #[test]
        fn nothing_that_looks_like_a_script_makes_the_parser_panic(
            text in "((send |expect |wait |repeat |end|hex |nothing|\\$01M|[0-9.]{1,4}| ms| s|//|[*?ü]|\n){0,30})"
        ) {
            if let Err(error) = Script::parse(&text) {
                prop_assert!(error.line >= 1 && error.line <= text.lines().count());
                prop_assert!(!error.reason.is_empty());
            }
        }
    }
}
