//! Reading many items in as few questions as the protocol permits.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::access::{self, numbers_of};
use super::definition::{Access, Definition, ModbusPlace};
use super::value::Value;
use super::{Ask, Item};
use crate::protocol::{Failure, Protocol, Query, Reply};

/// Registers or coils asked for in one question at most; well below every limit of the modules.
const MOST_TOGETHER: u16 = 64;

/// A set of items of one module, and what was learned about how to read them.
#[derive(Debug, Clone)]
pub struct ReadPlan {
    definition: Arc<Definition>,
    protocol: Protocol,
    entries: Vec<Entry>,
}

#[derive(Debug, Clone)]
struct Entry {
    /// Index into the definition's items.
    item: usize,
    /// Which of the item's accesses is tried next, among those that serve the protocol.
    access: usize,
    /// Asked for by itself, because a question that joined it with others was refused.
    alone: bool,
    /// Refused in every way: not asked again.
    given_up: Option<Failure>,
}

/// One question and the entries that its answer serves.
struct Question {
    query: Query,
    /// First 0-based number of a range of coils or registers.
    start: u16,
    entries: Vec<usize>,
}

impl ReadPlan {
    /// A plan for the named items; names that `protocol` does not offer are left out.
    pub fn new<'a>(definition: &Arc<Definition>, protocol: Protocol, ids: impl IntoIterator<Item = &'a str>) -> Self {
        let position = |id: &str| definition.items.iter().position(|item| item.id == id && item.is_offered(protocol));
        let entries = ids
            .into_iter()
            .filter_map(position)
            .map(|item| Entry { item, access: 0, alone: false, given_up: None })
            .collect();
        Self { definition: definition.clone(), protocol, entries }
    }

    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// How many questions one run asks if all goes well.
    pub fn questions(&self, address: u8) -> usize {
        self.compile(address, &self.all_indices()).len()
    }

    /// Asks everything once and tells of each item its value or why there is none.
    ///
    /// A silent module ends the run: the remaining items share its failure, so that it costs one waiting time only.
    pub fn run(&mut self, address: u8, ask: &mut dyn Ask) -> Vec<(String, Result<Value, Failure>)> {
        let mut results: Vec<Option<Result<Value, Failure>>> =
            self.entries.iter().map(|entry| entry.given_up.clone().map(Err)).collect();
        let mut open: Vec<usize> = self.all_indices();
        open.retain(|index| self.entries.get(*index).is_some_and(|entry| entry.given_up.is_none()));
        while !open.is_empty() {
            let mut again = Vec::new();
            for question in self.compile(address, &open) {
                let reply = ask.ask(&question.query);
                if let Err(failure) = &reply
                    && !failure.shows_presence()
                {
                    fill_open(&mut results, failure);
                    return self.name(results);
                }
                self.take_answer(address, &question, &reply, &mut results, &mut again);
            }
            open = again;
        }
        self.name(results)
    }

    /// What a run tells when there is no line to ask on.
    pub fn all_failed(&self, failure: &Failure) -> Vec<(String, Result<Value, Failure>)> {
        self.name(self.entries.iter().map(|_| Some(Err(failure.clone()))).collect())
    }

    fn all_indices(&self) -> Vec<usize> {
        (0..self.entries.len()).collect()
    }

    fn take_answer(
        &mut self,
        address: u8,
        question: &Question,
        reply: &Result<Reply, Failure>,
        results: &mut [Option<Result<Value, Failure>>],
        again: &mut Vec<usize>,
    ) {
        for &index in &question.entries {
            let outcome = match reply {
                Ok(reply) => self.decode(address, index, question.start, reply),
                Err(failure) => Err(failure.clone()),
            };
            let joined = question.entries.len() > 1 && reply.is_err();
            match outcome {
                Ok(value) => set(results, index, Ok(value)),
                Err(failure) => {
                    if self.has_another_way(index, joined) {
                        again.push(index);
                    } else {
                        self.give_up(index, &failure);
                        set(results, index, Err(failure));
                    }
                }
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
            if matches!(failure, Failure::Refused { .. } | Failure::Exception { .. } | Failure::NotOffered(_)) {
                entry.given_up = Some(failure.clone());
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

    fn name(&self, results: Vec<Option<Result<Value, Failure>>>) -> Vec<(String, Result<Value, Failure>)> {
        let ids = self.entries.iter().map(|entry| self.definition.items.get(entry.item).map(|item| item.id.clone()));
        let unread = || Err(Failure::NotOffered("the definition has no way to read it".to_owned()));
        ids.zip(results).filter_map(|(id, result)| Some((id?, result.unwrap_or_else(unread)))).collect()
    }
}

fn set(results: &mut [Option<Result<Value, Failure>>], index: usize, result: Result<Value, Failure>) {
    if let Some(slot) = results.get_mut(index) {
        *slot = Some(result);
    }
}

fn fill_open(results: &mut [Option<Result<Value, Failure>>], failure: &Failure) {
    for slot in results.iter_mut().filter(|slot| slot.is_none()) {
        *slot = Some(Err(failure.clone()));
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
) -> Vec<(String, Result<Value, Failure>)> {
    ReadPlan::new(definition, protocol, ids).run(address, ask)
}

/// Which optional parts the module has: those whose probe is answered with a value.
pub fn present_options(definition: &Definition, protocol: Protocol, ask: &mut dyn Ask) -> Vec<String> {
    if !protocol.is_modbus() {
        return Vec::new();
    }
    let parts = definition.optional.iter();
    parts.filter(|part| ask.ask(&access::place_query(part.probe)).is_ok()).map(|part| part.id.clone()).collect()
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
