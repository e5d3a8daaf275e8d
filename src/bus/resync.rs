//! Makes certain which answer belongs to which question, where neither protocol numbers them.
//!
//! A module answers in the order in which it was asked. So after an answer that did not come, the module is first asked
//! something whose answer cannot be mistaken: over Modbus RTU by another function, over DCON its name, which is known. And
//! where an answer could have been a second one to the question before, such a question shows afterwards whether all were
//! in step.

use std::time::Duration;

use super::codec;
use super::dialogue::{Dialogue, Link};
use super::judge::Expected;
use super::name::{self, Name, is_name};
use super::probes::PROBES;
use super::target::{Patience, Target};
use super::transaction::{Doubts, Shape, Wire};
use crate::module::Ask;
use crate::protocol::{Failure, Protocol, Query, dcon};

const INIT_ADDRESS: u8 = 0;
/// After so many answers that may have been earlier ones it is waited until none can come any more.
const MOST_ROUNDS: usize = 8;
/// Names remembered; more modules are not on one line.
const MOST_NAMES: usize = 1024;

impl Dialogue {
    /// Before `query`: lets the modules whose late answers could be taken for its answer show that none will come.
    ///
    /// # Errors
    /// If the module that is to be asked does not.
    pub(super) fn come_into_step(&mut self, target: &Target, query: &Query, window: Duration) -> Result<(), Failure> {
        let Some(shape) = Shape::of_query(target, query) else { return Ok(()) };
        let owed = match &self.link {
            Link::Wire(wire) => wire.owed(shape),
            Link::Tcp(_) => return Ok(()),
        };
        match target.protocol {
            Protocol::ModbusRtu if !owed.is_empty() => self.ask_otherwise_until_paid(target, shape, window),
            Protocol::Dcon => {
                let mut asked: Vec<(u8, bool)> = owed.into_iter().filter_map(Shape::dcon_module).collect();
                asked.dedup();
                for (address, checksum) in asked {
                    let owing = Target { address, checksum, ..*target };
                    if address == target.address {
                        self.ask_until_paid(&owing, shape, window)?;
                    } else {
                        self.ask_another(&owing, shape, window);
                    }
                }
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// As [`Self::ask_until_paid`], for a Modbus module: an answer by another function may be that to an earlier such question.
    fn ask_otherwise_until_paid(&mut self, target: &Target, shape: Shape, window: Duration) -> Result<(), Failure> {
        for _ in 0..MOST_ROUNDS {
            let Link::Wire(wire) = &self.link else { return Ok(()) };
            let owed = wire.owed(shape);
            if owed.is_empty() {
                return Ok(());
            }
            self.ask_otherwise(target, &owed, window, Alone::Waived)?;
        }
        Ok(())
    }

    /// Asks another module until it shows that no late answer of it will come, or until none can come any more: the line is
    /// back as soon as that module is.
    fn ask_another(&mut self, owing: &Target, shape: Shape, window: Duration) {
        while self.can_pay(owing, shape) && !self.is_in_a_hurry() {
            if let Err(Failure::LineLost(_)) = self.ask_until_paid(owing, shape, window) {
                return;
            }
        }
    }

    /// Asks a DCON module for its name. What comes may be the answer to an earlier such question, so that others which were
    /// asked in between are still open: then it is asked once more.
    fn ask_until_paid(&mut self, owing: &Target, shape: Shape, window: Duration) -> Result<(), Failure> {
        while self.can_pay(owing, shape) {
            self.ask_for_known_name(owing, window, Alone::Waived)?;
        }
        Ok(())
    }

    /// Whether a late answer of `owing` could be taken for one to `shape`, and its name is known, which would show that none comes.
    fn can_pay(&self, owing: &Target, shape: Shape) -> bool {
        let Link::Wire(wire) = &self.link else { return false };
        let asked = Some((owing.address, owing.checksum));
        self.names.contains_key(owing) && wire.owed(shape).into_iter().any(|owed| owed.dcon_module() == asked)
    }

    /// After questions to `target`: makes certain that their answers were not each one question late. On failure the
    /// answers since the last time must not be used.
    ///
    /// # Errors
    /// If they may have been, or if it cannot be told.
    pub fn verify(&mut self, target: &Target, patience: Patience) -> Result<(), Failure> {
        let mut repeated = 0u8;
        loop {
            let outcome = self.verify_once(target, patience.window);
            // After silence alone nothing has come that could have been an answer too late.
            if outcome != Err(Failure::Silent) || repeated >= patience.after_silence {
                self.forget_doubts(target);
                return outcome;
            }
            repeated = repeated.saturating_add(1);
        }
    }

    fn verify_once(&mut self, target: &Target, window: Duration) -> Result<(), Failure> {
        match (self.doubts(target), target.protocol) {
            (Doubts::Spoiled, _) => {}
            (Doubts::Open(shapes), _) if shapes.is_empty() => {}
            // Others may have been asked at another speed meanwhile.
            (Doubts::Open(_), _) if self.configure(target.settings)? => {}
            (Doubts::Open(shapes), Protocol::ModbusRtu) => {
                self.ask_otherwise(target, &shapes, window, Alone::Required)?;
            }
            (Doubts::Open(_), _) => self.ask_for_known_name(target, window, Alone::Required)?,
        }
        // What came just before that question may have been the right answer to an earlier one.
        if self.doubts(target) == Doubts::Spoiled { Err(out_of_step(Vec::new())) } else { Ok(()) }
    }

    fn doubts(&self, target: &Target) -> Doubts {
        match (&self.link, Shape::of_module(target)) {
            (Link::Wire(wire), Some(shape)) => wire.doubts(shape),
            _ => Doubts::Open(Vec::new()),
        }
    }

    /// Before a module that was silent is asked anything: whether it is there, by a question whose answer cannot be taken
    /// for one of another module.
    ///
    /// # Errors
    /// If it is not.
    pub fn greet(&mut self, target: &Target, window: Duration) -> Result<(), Failure> {
        if target.protocol != Protocol::Dcon {
            return Ok(());
        }
        let changed = self.configure(target.settings)?;
        match self.ask_for_known_name(target, window, Alone::Waived) {
            // Some adapters lose what follows a change of speed.
            Err(Failure::Silent) if changed => self.ask_for_known_name(target, window, Alone::Waived),
            outcome => outcome,
        }
    }

    /// Asks by a function that none of `shapes` has.
    fn ask_otherwise(
        &mut self,
        target: &Target,
        shapes: &[Shape],
        window: Duration,
        alone: Alone,
    ) -> Result<(), Failure> {
        let Link::Wire(wire) = &mut self.link else { return Ok(()) };
        let unlike = |query: &&Query| Shape::of_query(target, query).is_some_and(|shape| !shapes.contains(&shape));
        let Some(query) = PROBES.iter().find(unlike) else { return Ok(()) };
        let expected = Expected::Rtu { address: target.address };
        let outcome =
            codec::transact(&self.runtime, target.address, query, |frame| alone.probe(wire, frame, &expected, window));
        match outcome {
            Err(failure) if !failure.is_refusal() => Err(failure),
            _ => {
                self.clear_up(target, query);
                Ok(())
            }
        }
    }

    /// Asks a DCON module for its name. Without one that is known there is nothing to compare, and nothing is asked.
    fn ask_for_known_name(&mut self, target: &Target, window: Duration, alone: Alone) -> Result<(), Failure> {
        let Some(name) = self.names.get(target).cloned() else { return Ok(()) };
        let Link::Wire(wire) = &mut self.link else { return Ok(()) };
        let request = dcon::encode(&name::question(target.address), target.checksum);
        let answer = alone.probe(wire, &request, &name.expected(target), window)?;
        if answer != name.known() {
            let reason = "another module answers here now: scan the line again".to_owned();
            return Err(Failure::Garbled { reason, bytes: answer });
        }
        self.clear_up(target, &name::query(target.address));
        Ok(())
    }

    /// Nothing is made of the answers of `target` that could belong to other questions.
    pub(super) fn forget_doubts(&mut self, target: &Target) {
        if let Link::Wire(wire) = &mut self.link
            && let Some(shape) = Shape::of_module(target)
        {
            wire.forget_doubts(shape);
        }
    }

    fn clear_up(&mut self, target: &Target, query: &Query) {
        if let Link::Wire(wire) = &mut self.link
            && let Some(shape) = Shape::of_query(target, query)
        {
            wire.clear_up(shape);
        }
    }

    /// A module has moved: what it was called before carries another address.
    pub(super) fn learn_name_anew(&mut self, from: &Target, to: &Target, patience: Patience) {
        self.names.remove(to);
        if self.names.remove(from).is_some() {
            // Without an answer it is not known, and nothing is compared.
            let _ = self.with(*to, patience).ask(&name::query(to.address));
        }
    }

    /// Another module is at `target` now: what it calls itself was heard a moment ago.
    pub(super) fn believe_name(&mut self, target: &Target) {
        if let Some(name) = self.names.get_mut(target) {
            name.believe();
        }
    }

    /// Remembers what a DCON module calls itself.
    pub(super) fn note_name(&mut self, target: &Target, query: &Query, answer: &[u8]) {
        let asked_for_name = matches!(query, Query::Dcon { text, .. } if *text == name::question(target.address));
        // In INIT mode the answer may carry another address, and whoever is there is not for long.
        if asked_for_name && is_name(answer) && target.address != INIT_ADDRESS {
            if self.names.len() >= MOST_NAMES {
                self.names.clear();
            }
            self.names.entry(*target).or_insert_with(|| Name::new(answer)).hear(answer);
        }
    }
}

/// Whether other bytes may come with the answer to a probe. In the right order they come before it, as a late answer
/// does, and prove nothing; but where all answers had come already, one more shows that they were out of step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Alone {
    Required,
    Waived,
}

impl Alone {
    fn probe(self, wire: &mut Wire, request: &[u8], expected: &Expected, window: Duration) -> Result<Vec<u8>, Failure> {
        let (bytes, surplus) = wire.probe(request, expected, window)?;
        if surplus && self == Self::Required {
            return Err(out_of_step(bytes));
        }
        Ok(bytes)
    }
}

fn out_of_step(bytes: Vec<u8>) -> Failure {
    let reason = "an answer too many came, so it is not certain which question each belongs to".to_owned();
    Failure::Garbled { reason, bytes }
}
