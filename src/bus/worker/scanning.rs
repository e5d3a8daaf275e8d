//! The scan, one address at a time between other work.

use super::super::message::{BusEvent, RequestId};
use super::super::scan::{Scan, ScanPlan, ScanStep, ScanSummary};
use super::Worker;
use crate::protocol::Failure;

impl Worker {
    pub(super) fn begin_scan(&mut self, id: RequestId, plan: ScanPlan) {
        self.end_scan(true);
        self.scan = Some((id, Scan::new(plan)));
        self.tell_progress();
    }

    /// Asks at the next address of the scan. False if there is nothing to scan.
    pub(super) fn scan_step(&mut self) -> bool {
        let catalogue = self.catalogue.clone();
        let Some((id, scan)) = self.scan.as_mut().filter(|(_, scan)| !scan.paused) else { return false };
        let id = *id;
        let step = match self.line.as_mut().map(|line| line.dialogue_for_scan()) {
            Some(Ok(dialogue)) => scan.step(&catalogue, dialogue),
            Some(Err(reason)) => scan.lose(reason),
            None => scan.lose("no line is open".to_owned()),
        };
        let over = matches!(step, ScanStep::Ended) || scan.progress().is_none();
        if let ScanStep::Found(target, identified) = step {
            self.note_identity(target, &identified);
            self.tell(BusEvent::Found { id, target, identified: *identified });
        }
        self.tell_progress();
        if over {
            self.end_scan(false);
        }
        true
    }

    pub(super) fn pause_scan(&mut self, paused: bool) {
        if let Some((_, scan)) = &mut self.scan {
            scan.paused = paused;
            self.tell_progress();
        }
    }

    /// Ends the running scan, and those that wait for their turn.
    pub(super) fn cancel_scans(&mut self) {
        self.end_scan(true);
        for id in self.queue.take_scans() {
            let summary = ScanSummary { cancelled: true, ..ScanSummary::default() };
            self.tell(BusEvent::ScanEnded { id, summary });
        }
    }

    pub(super) fn end_scan(&mut self, cancelled: bool) {
        if let Some((id, scan)) = self.scan.take() {
            let summary = scan.end(cancelled);
            self.note_loss(summary.lost.clone().map(Failure::LineLost));
            self.tell(BusEvent::ScanEnded { id, summary });
        }
    }

    fn tell_progress(&mut self) {
        if let Some((id, scan)) = &self.scan
            && let Some(progress) = scan.progress()
        {
            let id = *id;
            self.tell(BusEvent::ScanProgress { id, progress });
        }
    }
}
