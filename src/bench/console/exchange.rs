//! What was sent and what came back, and commands that are sent again and again.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use jiff::Timestamp;

use super::command::RawCommand;
use crate::bus::RequestId;
use crate::protocol::Failure;

/// Exchanges that are kept; the oldest go first.
pub const EXCHANGES_KEPT: usize = 2_000;

/// A command and its answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Exchange {
    pub id: RequestId,
    /// When it was sent.
    pub at: Timestamp,
    pub sent: RawCommand,
    /// `None` while the answer is awaited.
    pub result: Option<Result<Vec<u8>, Failure>>,
    /// From sending to the answer, or to the end of waiting for it.
    pub took: Option<Duration>,
    /// The line of the script that sent it, 1-based.
    pub line: Option<usize>,
    /// Whether the script found what it expected, or why not.
    pub verdict: Option<Result<(), String>>,
}

impl Exchange {
    /// The answer for people: text, bytes or the failure; `None` while it is awaited.
    pub fn answer_text(&self) -> Option<String> {
        Some(match self.result.as_ref()? {
            Ok(answer) if answer.is_empty() && self.sent.is_broadcast() => "sent to all, nobody answers".to_owned(),
            Ok(answer) => self.sent.show_answer(answer),
            Err(failure) => failure.to_string(),
        })
    }
}

/// The last exchanges, oldest first.
#[derive(Debug, Clone, Default)]
pub struct ExchangeLog {
    exchanges: VecDeque<Exchange>,
}

impl ExchangeLog {
    /// Notes that `command` was sent as request `id`.
    pub fn sent(&mut self, id: RequestId, at: Timestamp, command: RawCommand) {
        while self.exchanges.len() >= EXCHANGES_KEPT {
            self.exchanges.pop_front();
        }
        self.exchanges.push_back(Exchange {
            id,
            at,
            sent: command,
            result: None,
            took: None,
            line: None,
            verdict: None,
        });
    }

    /// [`Self::sent`], by a line of a script.
    pub fn sent_by_script(&mut self, id: RequestId, at: Timestamp, command: RawCommand, line: Option<usize>) {
        self.sent(id, at, command);
        if let Some(exchange) = self.exchanges.back_mut() {
            exchange.line = line;
        }
    }

    /// What a script thinks of the last answer that it got.
    pub fn judge(&mut self, verdict: Result<(), String>) {
        if let Some(exchange) = self.exchanges.iter_mut().rev().find(|exchange| exchange.line.is_some()) {
            exchange.verdict = Some(verdict);
        }
    }

    /// The line's own times of a question that waits, which are more exact than when it was asked for.
    pub fn correct_time(&mut self, id: RequestId, at: Timestamp) {
        let waiting = |exchange: &&mut Exchange| exchange.id == id && exchange.result.is_none();
        if let Some(exchange) = self.exchanges.iter_mut().rev().find(waiting) {
            exchange.at = at;
        }
    }

    /// The question that waits for its answer as `id`.
    pub fn waiting(&self, id: RequestId) -> Option<&Exchange> {
        self.exchanges.iter().rev().find(|exchange| exchange.id == id && exchange.result.is_none())
    }

    /// No answer comes any more.
    pub fn give_up(&mut self, failure: &Failure) {
        for exchange in self.exchanges.iter_mut().filter(|exchange| exchange.result.is_none()) {
            exchange.result = Some(Err(failure.clone()));
        }
    }

    /// Notes the answer to request `id`. False if no such request waits.
    pub fn answered(&mut self, id: RequestId, at: Timestamp, result: Result<Vec<u8>, Failure>) -> bool {
        let waiting = |exchange: &&mut Exchange| exchange.id == id && exchange.result.is_none();
        let Some(exchange) = self.exchanges.iter_mut().rev().find(waiting) else { return false };
        exchange.took = Some(at.duration_since(exchange.at).try_into().unwrap_or_default());
        exchange.result = Some(result);
        true
    }

    /// Oldest first.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &Exchange> + ExactSizeIterator {
        self.exchanges.iter()
    }

    /// The exchange at `index` from the oldest, for tables of many rows.
    pub fn get(&self, index: usize) -> Option<&Exchange> {
        self.exchanges.get(index)
    }

    pub fn len(&self) -> usize {
        self.exchanges.len()
    }

    pub fn is_empty(&self) -> bool {
        self.exchanges.is_empty()
    }

    /// Forgets what is answered; what is under way stays, so that its answer finds its place.
    pub fn clear(&mut self) {
        self.exchanges.retain(|exchange| exchange.result.is_none());
    }
}

/// A command that is sent again and again, one at a time.
#[derive(Debug, Clone, PartialEq)]
pub struct RepeatPlan {
    pub command: RawCommand,
    /// From one sending to the next; an answer that takes longer delays the next.
    pub period: Duration,
    /// How often it was sent.
    pub sent: u64,
    /// How many of these brought an answer.
    pub answered: u64,
    /// When the next is due; `None` before the first.
    next: Option<Instant>,
    waiting: bool,
}

impl RepeatPlan {
    /// Shorter periods would only fill the bus thread's queue.
    pub const SHORTEST: Duration = Duration::from_millis(10);

    pub fn new(command: RawCommand, period: Duration) -> Self {
        Self { command, period: period.max(Self::SHORTEST), sent: 0, answered: 0, next: None, waiting: false }
    }

    /// Whether the command is to be sent now; [`Self::note_sent`] then says that it was.
    pub fn due(&self, now: Instant) -> bool {
        !self.waiting && self.next.is_none_or(|next| now >= next)
    }

    /// When to look again; `None` while an answer is awaited or nothing was sent yet.
    pub fn next_at(&self) -> Option<Instant> {
        self.next.filter(|_| !self.waiting)
    }

    /// The command was sent. Periods that were missed are left out, not made up for.
    pub fn note_sent(&mut self, now: Instant) {
        self.sent = self.sent.saturating_add(1);
        self.waiting = true;
        let on_time = self.next.and_then(|next| next.checked_add(self.period)).filter(|next| *next > now);
        self.next = on_time.or_else(|| now.checked_add(self.period));
    }

    /// The awaited answer came, or did not come. Ignored while none is awaited.
    pub fn note_answered(&mut self, result: &Result<Vec<u8>, Failure>) {
        if std::mem::take(&mut self.waiting) && result.is_ok() {
            self.answered = self.answered.saturating_add(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn command(text: &str) -> RawCommand {
        RawCommand::parse(text, false).unwrap()
    }

    fn at(milliseconds: i64) -> Timestamp {
        Timestamp::from_millisecond(milliseconds).unwrap()
    }

    #[test]
    fn an_answer_finds_its_question_and_the_time_between_is_told() {
        let mut log = ExchangeLog::default();
        log.sent(RequestId(1), at(1_000), command("$01M"));
        log.sent(RequestId(2), at(1_001), command("hex 01 03 00 00 00 01"));
        assert!(log.answered(RequestId(1), at(1_025), Ok(b"!01PIR234".to_vec())));
        assert!(!log.answered(RequestId(1), at(1_026), Err(Failure::Silent)), "it has its answer");
        assert!(!log.answered(RequestId(7), at(1_026), Err(Failure::Silent)), "nobody asked this");
        let first = log.get(0).unwrap();
        assert_eq!(first.took, Some(Duration::from_millis(25)));
        assert_eq!(first.answer_text().as_deref(), Some("!01PIR234"));
        assert_eq!(log.get(1).unwrap().answer_text(), None);
        assert!(log.answered(RequestId(2), at(1_000), Err(Failure::Silent)));
        let second = log.get(1).unwrap();
        assert_eq!((second.took, second.answer_text().as_deref()), (Some(Duration::ZERO), Some("no answer")));
    }

    #[test]
    fn the_log_keeps_the_last_exchanges_and_clearing_spares_what_is_under_way() {
        let mut log = ExchangeLog::default();
        for number in 0..2_500 {
            log.sent(RequestId(number), at(0), command("$01M"));
            log.answered(RequestId(number), at(1), Ok(Vec::new()));
        }
        assert_eq!((log.len(), log.get(0).unwrap().id), (EXCHANGES_KEPT, RequestId(500)));
        log.sent(RequestId(9_000), at(2), command("~**"));
        log.clear();
        assert_eq!(log.iter().map(|exchange| exchange.id).collect::<Vec<_>>(), [RequestId(9_000)]);
        log.answered(RequestId(9_000), at(2), Ok(Vec::new()));
        assert!(log.get(0).unwrap().answer_text().unwrap().contains("nobody answers"));
    }

    #[test]
    fn a_repeated_command_waits_for_its_answer_and_keeps_its_beat() {
        let start = Instant::now();
        let after = |ms| start + Duration::from_millis(ms);
        let mut plan = RepeatPlan::new(command("$01M"), Duration::from_millis(100));
        assert!(plan.due(start));
        plan.note_sent(start);
        assert!(!plan.due(after(150)), "the answer is awaited");
        assert_eq!(plan.next_at(), None);
        plan.note_answered(&Ok(Vec::new()));
        plan.note_answered(&Ok(Vec::new()));
        assert!(!plan.due(after(99)));
        assert_eq!(plan.next_at(), Some(after(100)));
        assert!(plan.due(after(103)));
        plan.note_sent(after(103));
        plan.note_answered(&Err(Failure::Silent));
        assert_eq!(plan.next_at(), Some(after(200)), "a late look does not shift the beat");
        plan.note_sent(after(750));
        plan.note_answered(&Ok(Vec::new()));
        assert_eq!(plan.next_at(), Some(after(850)), "missed beats are left out");
        assert_eq!((plan.sent, plan.answered), (3, 2));
    }

    #[test]
    fn a_period_of_zero_does_not_flood_the_line() {
        assert_eq!(RepeatPlan::new(command("$01M"), Duration::ZERO).period, RepeatPlan::SHORTEST);
    }
}
