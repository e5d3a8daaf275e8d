//! What is asked of a line to learn what is wrong with it.

use std::collections::BTreeMap;

use jiff::Timestamp;

use crate::bench::traffic::TrafficLog;
use crate::bus::{BusCommand, BusEvent, Frame, ScanPlan, ScanSummary, Target};
use crate::cli::line_args::LineArgs;
use crate::cli::session::Session;
use crate::cli::{Outcome, Stop, output};
use crate::diagnosis::{ConsistencyTest, Diagnosis, Report};
use crate::module::Identified;
use crate::protocol::BaudRate;

/// A line that is being looked at.
#[derive(Default)]
pub struct Examination {
    pub diagnosis: Diagnosis,
    pub traffic: TrafficLog,
    /// How the modules found call themselves.
    names: BTreeMap<Target, String>,
}

impl Examination {
    pub fn report(&self, line: &str, at: Timestamp) -> Report {
        self.diagnosis.report(at, line, |target| self.names.get(target).cloned())
    }

    fn take(&mut self, frame: Frame) {
        self.diagnosis.take(&frame);
        self.traffic.push(frame);
    }

    /// Asks at each of these until a module answers.
    pub fn find(&mut self, session: &Session, places: &[Target]) -> Outcome<Option<Target>> {
        for &target in places {
            let result = session.ask(
                |id| BusCommand::Identify { id, target },
                |id, event| match event {
                    BusEvent::Identified { id: of, result, .. } if of == id => Some(result),
                    BusEvent::Traffic(frame) => {
                        self.take(frame);
                        None
                    }
                    _ => None,
                },
            )?;
            if let Ok(identified) = result {
                self.note_name(target, &identified);
                return Ok(Some(target));
            }
            // Somebody is there who cannot be read: the test tells more.
            if self.diagnosis.station(&target).is_some() {
                return Ok(Some(target));
            }
        }
        Ok(None)
    }

    /// Looks where modules are out of the box, and at other speeds if nobody is there.
    pub fn search(&mut self, session: &Session, line: &LineArgs) -> Outcome<Vec<Target>> {
        let base = if line.is_tcp() { ScanPlan::tcp() } else { ScanPlan::quick() };
        let settings = line.settings();
        let plan = ScanPlan { baud_rates: vec![settings.baud_rate], data_formats: vec![settings.data_format], ..base };
        let found = self.scan(session, plan.clone())?;
        if !found.is_empty() || line.is_tcp() {
            return Ok(found);
        }
        let others: Vec<BaudRate> = BaudRate::ALL.into_iter().filter(|rate| *rate != settings.baud_rate).collect();
        let plan = ScanPlan { baud_rates: others, stop_at_first: true, ..plan };
        let seconds = plan.duration().as_secs();
        output::message(&format!(
            "Nothing answers at {settings}; the other speeds are tried, which takes about {seconds} s"
        ));
        self.scan(session, plan)
    }

    fn scan(&mut self, session: &Session, plan: ScanPlan) -> Outcome<Vec<Target>> {
        let mut found = Vec::new();
        let summary: ScanSummary = session.ask(
            |id| BusCommand::Scan { id, plan },
            |id, event| match event {
                BusEvent::Found { id: of, target, identified } if of == id => {
                    self.note_name(target, &identified);
                    found.push(target);
                    None
                }
                BusEvent::Traffic(frame) => {
                    self.take(frame);
                    None
                }
                BusEvent::ScanEnded { id: of, summary } if of == id => Some(summary),
                _ => None,
            },
        )?;
        match summary.lost {
            Some(reason) => Err(Stop::failed(format!("the line was lost: {reason}"))),
            None => Ok(found),
        }
    }

    fn note_name(&mut self, target: Target, identified: &Identified) {
        let label = identified.definition.as_ref().map_or("Unknown module", |definition| definition.label.as_str());
        self.names.insert(target, label.to_owned());
    }

    /// Asks `target` the same many times.
    pub fn test(&mut self, session: &Session, target: Target, reads: u32) -> Outcome {
        let mut test = ConsistencyTest::new(target, reads);
        while !test.is_done() {
            let answer = session.raw(test.request(), target.settings, |frame| {
                test.take(&frame);
                self.take(frame);
            })?;
            test.answered(&answer);
        }
        self.diagnosis.note_test(test.outcome());
        Ok(())
    }
}
