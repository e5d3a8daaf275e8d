//! Reading many items in as few questions as the protocol permits.

use std::collections::{BTreeSet, VecDeque};
use std::sync::Arc;

use jiff::Timestamp;

use super::access::{self, numbers_of};
use super::definition::{Access, Definition, ModbusPlace};
use super::value::Value;
use super::{Ask, Item};
use crate::protocol::{Failure, Protocol, Query, Reply};

/// Registers or coils asked for in one question at most; well below every limit of the modules.
const MOST_TOGETHER: u16 = 64;

/// Runs after which a refused item is asked for again: the module may have been changed meanwhile.
const ASK_AGAIN_AFTER: u16 = 60;
/// Runs in which a question stayed without answer while others were answered, before another way is tried.
const SILENCES_ALLOWED: u8 = 2;

/// Questions in a row to which a module is silent that has answered before in the same run, until it is taken for gone.
/// One answer that is late by 1.5 s holds back those behind it, and so two or three questions with their repeats; where a
/// fifth of all answers are late, a second and a third late one among these are common. Whoever asks may lose patience earlier.
const SILENCES_SHOW_ABSENCE: u8 = 8;

/// What became of one item that was asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Of the item.
    pub id: String,
    /// When the answer's last byte had arrived; where none came, when the wait for it was given up. What was not asked,
    /// because it was refused before or because the module was silent to another question, has the time at which that
    /// was settled.
    pub at: Timestamp,
    pub result: Result<Value, Failure>,
}

/// A result with its time; `None` for what is not asked in this run.
type Outcome = (Option<Timestamp>, Result<Value, Failure>);

/// A set of items of one module, and what was learned about how to read them.
#[derive(Debug, Clone)]
pub struct ReadPlan {
    definition: Arc<Definition>,
    protocol: Protocol,
    entries: Vec<Entry>,
    /// Which question a run begins with: another one after a run in which nothing was answered.
    first: usize,
}

#[derive(Debug, Clone)]
struct Entry {
    /// Index into the definition's items.
    item: usize,
    /// Which of the item's accesses is tried next, among those that serve the protocol.
    access: usize,
    /// Asked for by itself, because a question that joined it with others was refused.
    alone: bool,
    /// Runs in a row in which it stayed without answer.
    silences: u8,
    /// Refused in every way, and for how many runs it is not asked again.
    given_up: Option<(Failure, u16)>,
}

/// One question and the entries that its answer serves.
#[derive(Debug, Clone)]
struct Question {
    query: Query,
    /// First 0-based number of a range of coils or registers.
    start: u16,
    entries: Vec<usize>,
}

/// A plan being carried out, one question at a time.
#[derive(Debug, Clone)]
pub struct ReadRun {
    results: Vec<Option<Outcome>>,
    questions: VecDeque<Question>,
    /// Entries to be asked in another way when the questions are through.
    again: Vec<usize>,
    answered: bool,
    silent_in_a_row: u8,
}

impl ReadRun {
    /// Whether anything in this run has shown that the module is there.
    pub fn is_answered(&self) -> bool {
        self.answered
    }

    /// Whether the module did not answer the last question.
    pub fn is_silent(&self) -> bool {
        self.silent_in_a_row > 0
    }

    /// Ends the run: what was not read shares this failure and its time.
    pub fn fail(&mut self, failure: &Failure, at: Timestamp) {
        for slot in self.results.iter_mut().filter(|slot| slot.is_none()) {
            *slot = Some((Some(at), Err(failure.clone())));
        }
        self.questions.clear();
    }
}

impl ReadPlan {
    /// A plan for the named items; names that `protocol` does not offer are left out.
    pub fn new<'a>(definition: &Arc<Definition>, protocol: Protocol, ids: impl IntoIterator<Item = &'a str>) -> Self {
        let position = |id: &str| definition.items.iter().position(|item| item.id == id && item.is_offered(protocol));
        let entries = ids
            .into_iter()
            .filter_map(position)
            .map(|item| Entry { item, access: 0, alone: false, silences: 0, given_up: None })
            .collect();
        Self { definition: definition.clone(), protocol, entries, first: 0 }
    }

    /// How many questions a run asks of the module at `address` if none is refused.
    pub fn questions(&self, address: u8) -> usize {
        let all: Vec<usize> = (0..self.entries.len()).collect();
        self.compile(address, &all).len()
    }

    /// Asks everything once and tells of each item its value or why there is none.
    pub fn run(&mut self, address: u8, ask: &mut dyn Ask) -> Vec<Answer> {
        let mut run = self.begin(address);
        while self.step(&mut run, address, ask) {}
        self.finish(run, ask.answered_at())
    }

    /// Starts to ask everything once.
    pub fn begin(&mut self, address: u8) -> ReadRun {
        for entry in &mut self.entries {
            entry.given_up = entry.given_up.take().and_then(|(why, runs)| Some((why, runs.checked_sub(1)?)));
        }
        let given_up = |entry: &Entry| entry.given_up.as_ref().map(|(failure, _)| (None, Err(failure.clone())));
        let results: Vec<_> = self.entries.iter().map(given_up).collect();
        let open: Vec<usize> =
            (0..self.entries.len()).filter(|index| matches!(results.get(*index), Some(None))).collect();
        let mut questions = VecDeque::from(self.compile(address, &open));
        let first = self.first.checked_rem(questions.len()).unwrap_or(0);
        questions.rotate_left(first);
        ReadRun { results, questions, again: Vec::new(), answered: false, silent_in_a_row: 0 }
    }

    /// Asks the next question. False when there is none left.
    ///
    /// A module that answers nothing costs one waiting time only: the items that were not asked share the failure. One
    /// that has answered before is asked the others, until it has been silent [`SILENCES_SHOW_ABSENCE`] times in a row.
    pub fn step(&mut self, run: &mut ReadRun, address: u8, ask: &mut dyn Ask) -> bool {
        let Some(question) = run.questions.pop_front() else { return false };
        let reply = ask.ask(&question.query);
        let at = ask.answered_at();
        match &reply {
            Err(failure) if !failure.shows_presence() => {
                run.silent_in_a_row = run.silent_in_a_row.saturating_add(1);
                let gone = matches!(failure, Failure::LineLost(_))
                    || !run.answered
                    || run.silent_in_a_row >= SILENCES_SHOW_ABSENCE;
                if gone {
                    self.first = if run.answered { self.first } else { self.first.wrapping_add(1) };
                    run.fail(failure, at);
                    return false;
                }
                self.take_silence(&question, at, failure, run);
            }
            reply => {
                run.answered = true;
                run.silent_in_a_row = 0;
                self.take_answer(address, &question, at, reply, run);
            }
        }
        if run.questions.is_empty() {
            let again = std::mem::take(&mut run.again);
            run.questions = self.compile(address, &again).into();
        }
        !run.questions.is_empty()
    }

    /// What the run brought, by item; it ended `at`.
    pub fn finish(&self, run: ReadRun, at: Timestamp) -> Vec<Answer> {
        self.name(run.results, at)
    }

    /// The values that the run has brought so far, each with its time.
    pub fn so_far(&self, run: &ReadRun) -> Vec<Answer> {
        let brought = |outcome: &Option<Outcome>| match outcome {
            Some((Some(at), Ok(value))) => Some((*at, value.clone())),
            _ => None,
        };
        let named = |(entry, outcome): (&Entry, &Option<Outcome>)| {
            let ((at, value), item) = (brought(outcome)?, self.definition.items.get(entry.item)?);
            Some(Answer { id: item.id.clone(), at, result: Ok(value) })
        };
        self.entries.iter().zip(&run.results).filter_map(named).collect()
    }

    /// Takes over the items of `other` that it has not; what was learned about its own stays known.
    pub fn complete(&mut self, other: Self) {
        let known: BTreeSet<usize> = self.entries.iter().map(|entry| entry.item).collect();
        self.entries.extend(other.entries.into_iter().filter(|entry| !known.contains(&entry.item)));
        self.entries.sort_by_key(|entry| entry.item);
    }

    /// Whether a run would ask nothing, because everything was refused.
    pub fn is_idle(&self) -> bool {
        self.entries.iter().all(|entry| entry.given_up.is_some())
    }

    /// What a run tells when there is no line to ask on.
    pub fn all_failed(&self, failure: &Failure, at: Timestamp) -> Vec<Answer> {
        self.name(self.entries.iter().map(|_| Some((Some(at), Err(failure.clone())))).collect(), at)
    }

    /// The module answers, but not this: perhaps it does not know the command, perhaps the answer was lost.
    fn take_silence(&mut self, question: &Question, at: Timestamp, failure: &Failure, run: &mut ReadRun) {
        for &index in &question.entries {
            let silences = self.entries.get_mut(index).map_or(0, |entry| {
                entry.silences = entry.silences.saturating_add(1);
                entry.silences
            });
            if silences >= SILENCES_ALLOWED && self.has_another_way(index, false) {
                run.again.push(index);
            } else {
                self.give_up(index, failure);
                set(&mut run.results, index, at, Err(failure.clone()));
            }
        }
    }

    fn take_answer(
        &mut self,
        address: u8,
        question: &Question,
        at: Timestamp,
        reply: &Result<Reply, Failure>,
        run: &mut ReadRun,
    ) {
        let joined = question.entries.len() > 1 && reply.is_err();
        for &index in &question.entries {
            let outcome = match reply {
                Ok(reply) => self.decode(address, index, question.start, reply),
                Err(failure) => Err(failure.clone()),
            };
            if let Some(entry) = self.entries.get_mut(index) {
                entry.silences = 0;
            }
            match outcome {
                Err(_) if self.has_another_way(index, joined) => run.again.push(index),
                Err(failure) => {
                    self.give_up(index, &failure);
                    set(&mut run.results, index, at, Err(failure));
                }
                value => set(&mut run.results, index, at, value),
            }
        }
    }

    /// Moves the entry to its next way of being read, if there is one.
    fn has_another_way(&mut self, index: usize, joined: bool) -> bool {
        let ways = self.entries.get(index).map(|entry| self.ways(entry.item).count()).unwrap_or(0);
        let Some(entry) = self.entries.get_mut(index) else { return false };
        if joined && !entry.alone {
            entry.alone = true;
            return true;
        }
        entry.access = entry.access.saturating_add(1);
        entry.alone = false;
        entry.access < ways
    }

    fn give_up(&mut self, index: usize, failure: &Failure) {
        if let Some(entry) = self.entries.get_mut(index) {
            entry.access = 0;
            let known_refusal = matches!(failure, Failure::Refused { .. } | Failure::Exception { code: 1..=3 });
            if known_refusal || matches!(failure, Failure::NotOffered(_)) {
                entry.given_up = Some((failure.clone(), ASK_AGAIN_AFTER));
            }
        }
    }

    fn ways(&self, item: usize) -> impl Iterator<Item = &Access> {
        let accesses = self.definition.items.get(item).into_iter().flat_map(|item| &item.accesses);
        accesses.filter(|access| access.serves(self.protocol))
    }

    fn decode(&self, address: u8, index: usize, start: u16, reply: &Reply) -> Result<Value, Failure> {
        let nothing = || Failure::NotOffered("the definition has no way to read it".to_owned());
        let entry = self.entries.get(index).ok_or_else(nothing)?;
        let item = self.definition.items.get(entry.item).ok_or_else(nothing)?;
        match self.ways(entry.item).nth(entry.access).ok_or_else(nothing)? {
            Access::Command(access) => {
                let command = self.definition.commands.get(access.command).ok_or_else(nothing)?;
                let fields = access::read_fields(command, address, reply)?;
                access::value_in_fields(&self.definition, item, access, command, &fields)
            }
            Access::Modbus(access) => access::value_in_reply(&self.definition, item, access, start, reply),
        }
    }

    /// The questions for `open` entries: one for each command, one for each run of neighbouring coils or registers.
    fn compile(&self, address: u8, open: &[usize]) -> Vec<Question> {
        let mut questions: Vec<Question> = Vec::new();
        let mut places: BTreeSet<(u8, u16, u16, usize)> = BTreeSet::new();
        for &index in open {
            let Some(entry) = self.entries.get(index) else { continue };
            match self.ways(entry.item).nth(entry.access) {
                Some(Access::Command(access)) => {
                    let command = self.definition.commands.get(access.command);
                    let Some(query) = command.and_then(|command| access::read_query(command, address)) else {
                        continue;
                    };
                    match questions.iter_mut().find(|question| question.query == query) {
                        Some(question) => question.entries.push(index),
                        None => questions.push(Question { query, start: 0, entries: vec![index] }),
                    }
                }
                Some(Access::Modbus(access)) if entry.alone => {
                    questions.push(range_question(access.place, vec![index]));
                }
                Some(Access::Modbus(access)) => {
                    let (first, count) = numbers_of(access.place);
                    places.insert((space(access.place), first, count, index));
                }
                None => {}
            }
        }
        questions.extend(join_neighbours(places));
        questions
    }

    fn name(&self, results: Vec<Option<Outcome>>, end: Timestamp) -> Vec<Answer> {
        let ids = self.entries.iter().map(|entry| self.definition.items.get(entry.item).map(|item| item.id.clone()));
        let unread = || (None, Err(Failure::NotOffered("the definition has no way to read it".to_owned())));
        let named = |(id, outcome): (Option<String>, Option<Outcome>)| {
            let (at, result) = outcome.unwrap_or_else(unread);
            Some(Answer { id: id?, at: at.unwrap_or(end), result })
        };
        ids.zip(results).filter_map(named).collect()
    }
}

fn set(results: &mut [Option<Outcome>], index: usize, at: Timestamp, result: Result<Value, Failure>) {
    if let Some(slot) = results.get_mut(index) {
        *slot = Some((Some(at), result));
    }
}

/// Coils, holding and input registers are read by different functions and cannot be joined.
fn space(place: ModbusPlace) -> u8 {
    match place {
        ModbusPlace::Coils { .. } => 0,
        ModbusPlace::Holding { .. } => 1,
        ModbusPlace::Input { .. } => 2,
    }
}

fn place_in(space: u8, first: u16, count: u16) -> ModbusPlace {
    match space {
        0 => ModbusPlace::Coils { first, count },
        1 => ModbusPlace::Holding { first, count },
        _ => ModbusPlace::Input { first, count },
    }
}

fn range_question(place: ModbusPlace, entries: Vec<usize>) -> Question {
    Question { query: access::place_query(place), start: numbers_of(place).0.saturating_sub(1), entries }
}

/// Joins ranges that touch or overlap. Holes are never bridged: a module refuses a range with an unknown register.
fn join_neighbours(places: BTreeSet<(u8, u16, u16, usize)>) -> Vec<Question> {
    let mut joined: Vec<(u8, u16, u16, Vec<usize>)> = Vec::new();
    for (space, first, count, index) in places {
        let end = first.saturating_add(count);
        match joined.last_mut() {
            Some((last_space, start, last_end, entries))
                if *last_space == space && first <= *last_end && end.saturating_sub(*start) <= MOST_TOGETHER =>
            {
                *last_end = end.max(*last_end);
                entries.push(index);
            }
            _ => joined.push((space, first, end, vec![index])),
        }
    }
    joined
        .into_iter()
        .map(|(space, first, end, entries)| range_question(place_in(space, first, end.saturating_sub(first)), entries))
        .collect()
}

/// Reads the named items once.
pub fn read_items<'a>(
    definition: &Arc<Definition>,
    protocol: Protocol,
    address: u8,
    ids: impl IntoIterator<Item = &'a str>,
    ask: &mut dyn Ask,
) -> Vec<Answer> {
    ReadPlan::new(definition, protocol, ids).run(address, ask)
}

/// Which optional parts the module has: those whose probe is answered with a value. An error means that a probe was
/// neither answered nor refused, so that nothing is known.
pub fn present_options(definition: &Definition, protocol: Protocol, ask: &mut dyn Ask) -> Result<Vec<String>, Failure> {
    let mut present = Vec::new();
    for part in definition.optional.iter().filter(|_| protocol.is_modbus()) {
        match ask.ask(&access::place_query(part.probe)) {
            Ok(_) => present.push(part.id.clone()),
            Err(failure) if failure.is_refusal() => {}
            Err(failure) => return Err(failure),
        }
    }
    Ok(present)
}

/// Ids of the items that a look at the whole module reads: all that the protocol offers and the module has,
/// except those whose reading changes something.
impl Definition {
    pub fn readable_ids(&self, protocol: Protocol, options: &[String]) -> Vec<&str> {
        let has = |item: &&Item| item.optional.as_ref().is_none_or(|part| options.contains(part));
        self.items_over(protocol).filter(|item| !item.on_request).filter(has).map(|item| item.id.as_str()).collect()
    }

    /// Ids of the items polled while the module is watched.
    pub fn live_ids(&self, protocol: Protocol, options: &[String]) -> Vec<&str> {
        let has = |item: &&Item| item.optional.as_ref().is_none_or(|part| options.contains(part));
        self.live_items(protocol).filter(has).map(|item| item.id.as_str()).collect()
    }
}
