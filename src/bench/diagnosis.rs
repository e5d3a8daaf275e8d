//! What is known of the health of the line that is open, and the test of a module's consistency.

use std::io;
use std::ops::Range;

use super::traffic::{FrameRef, TrafficLog, append_csv, write_csv};
use super::{Bench, LineState, Severity};
use crate::bus::{BusCommand, Frame, LatencyTimer, LineAddress, LineProblem, RequestId, Target, Tuning};
use crate::diagnosis::bundle::{self, Bundle, Traffic};
use crate::diagnosis::{ConsistencyTest, Diagnosis, Report};
use crate::protocol::Failure;

/// Tells what a frame means, given the request that it answers.
type Explain<'a> = &'a dyn Fn(&FrameRef<'_>, Option<&FrameRef<'_>>) -> String;

impl TrafficLog {
    /// Adds the frames `seqs` to a bundle's traffic; those that were forgotten are passed over.
    ///
    /// # Errors
    /// If a frame cannot be written.
    pub fn add_to_bundle(&self, seqs: Range<u64>, explain: Explain<'_>, to: &mut Traffic) -> io::Result<()> {
        if to.csv.is_empty() {
            write_csv(self, seqs.clone(), explain, &mut to.csv)?;
        } else {
            append_csv(self, seqs.clone(), explain, &mut to.csv)?;
        }
        seqs.filter_map(|seq| self.get(seq)).try_for_each(|frame| to.frame(&frame.to_frame()))
    }
}

/// The live diagnosis with the test under way.
#[derive(Default)]
pub struct LiveDiagnosis {
    pub(super) known: Diagnosis,
    test: Option<Running>,
    /// The line that all this is of, as people call it.
    line: String,
}

/// A test with its request that waits for an answer.
struct Running {
    test: ConsistencyTest,
    id: RequestId,
}

impl LiveDiagnosis {
    pub(super) fn take(&mut self, frame: &Frame) {
        self.known.take(frame);
        if let Some(running) = &mut self.test {
            running.test.take(frame);
        }
    }

    /// Nothing that was known is true of another line.
    pub(super) fn begin(&mut self, line: &LineAddress, tuning: Tuning) {
        *self = Self { line: line.to_string(), ..Self::default() };
        self.known.note_tuning(tuning);
    }
}

impl Bench {
    /// What is known of the line that is open, or was open last.
    pub fn diagnosis(&self) -> &Diagnosis {
        &self.diagnosis.known
    }

    /// The same as a report, made now.
    pub fn diagnosis_report(&self) -> Report {
        let name = |target: &Target| self.module(target).map(|module| module.label().to_owned());
        let line = if self.diagnosis.line.is_empty() { "no line" } else { &self.diagnosis.line };
        self.diagnosis.known.report(self.now(), line, name)
    }

    /// What goes into one file for asking others for help, with this traffic.
    ///
    /// # Errors
    /// If the traffic cannot be ended.
    pub fn support_bundle(&self, traffic: Traffic) -> io::Result<Bundle> {
        bundle::gather(self.diagnosis_report(), self.ports.present.clone(), traffic)
    }

    /// The test under way.
    pub fn consistency_test(&self) -> Option<&ConsistencyTest> {
        self.diagnosis.test.as_ref().map(|running| &running.test)
    }

    /// Asks `target` the same so many times; reads only. Polls and other requests go on between.
    pub(super) fn test_consistency(&mut self, target: Target, reads: u32) {
        if !self.line.is_open() {
            let text = "The consistency cannot be tested: no line is open – scan to open it";
            return self.notify(Severity::Warning, text.to_owned());
        }
        if self.diagnosis.test.is_none() {
            self.ask_again(ConsistencyTest::new(target, reads, self.tuning));
        }
    }

    /// Ends the test under way; what it brought so far is judged.
    pub(super) fn stop_test(&mut self) {
        if let Some(Running { test, .. }) = self.diagnosis.test.take()
            && test.progress().0 > 0
        {
            self.diagnosis.known.note_test(test.outcome());
        }
    }

    fn ask_again(&mut self, test: ConsistencyTest) {
        let id = self.bus.next_id();
        let (request, settings) = (test.request(), test.target().settings);
        if self.try_send(BusCommand::Raw { id, request, settings }) {
            self.diagnosis.test = Some(Running { test, id });
        }
    }

    /// Takes the answer if it is the test's, and asks again until the test is done. False if it is someone else's.
    pub(super) fn take_test_answer(&mut self, id: RequestId, result: &Result<Vec<u8>, Failure>) -> bool {
        let Some(Running { mut test, .. }) = self.diagnosis.test.take_if(|running| running.id == id) else {
            return false;
        };
        test.answered(result);
        if test.is_done() {
            self.diagnosis.known.note_test(test.outcome());
        } else {
            self.ask_again(test);
        }
        true
    }

    /// The line is open: what the system tells of its adapter.
    pub(super) fn note_adapter(&mut self) {
        let timer = match self.line.line() {
            Some(LineAddress::Serial { port }) => LatencyTimer::of_port(port, &self.ports.present),
            _ => None,
        };
        self.diagnosis.known.note_adapter(timer);
    }

    pub(super) fn note_problem(&mut self, problem: LineProblem) {
        self.diagnosis.known.note_problem(problem);
    }

    /// Whether a module can be tested now; the reason if not.
    pub fn test_obstacle(&self) -> Option<&'static str> {
        match &self.line {
            LineState::Open { .. } if self.diagnosis.test.is_some() => Some("A test is running"),
            LineState::Open { .. } if self.is_scanning() => Some("A scan is running"),
            LineState::Open { .. } => None,
            _ => Some("No line is open: scan to open it"),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;
    use crate::bench::Action;
    use crate::bus::{Bus, Direction, ScanPlan};
    use crate::module::Catalogue;
    use crate::protocol::{LineSettings, Protocol};
    use crate::sim::{ModuleSpec, Pace, Sim};

    /// Far more than anything here takes; reaching it is a failure.
    const LIMIT: Duration = Duration::from_secs(60);

    /// A bench that has found the PIR-234 of a clean simulated line, and polls it as fast as it can.
    fn polling(sim: &Sim) -> Bench {
        let catalogue = std::sync::Arc::new(Catalogue::built_in().0);
        let bus = Bus::start(catalogue.clone(), || {}).unwrap();
        let mut bench = Bench::new(bus, catalogue, &[]);
        let line = LineAddress::Simulated { label: "Simulated line".to_owned(), sim: sim.clone() };
        bench.apply(Action::Scan { line, settings: LineSettings::default(), plan: ScanPlan::quick() });
        until(&mut bench, |bench| !bench.modules().is_empty());
        let target = bench.modules()[0].target;
        bench.apply(Action::SetInterval(target, Duration::ZERO));
        bench
    }

    #[track_caller]
    fn until(bench: &mut Bench, mut reached: impl FnMut(&Bench) -> bool) {
        let start = Instant::now();
        while !reached(bench) {
            assert!(start.elapsed() < LIMIT, "not reached");
            bench.drain();
            std::thread::yield_now();
        }
    }

    /// Whether an answer has come whose CRC ends with the byte of a line feed.
    fn has_heard_line_feed(bench: &Bench) -> bool {
        let log = bench.traffic();
        let frames = (log.first_seq()..log.next_seq()).filter_map(|seq| log.get(seq)).map(|frame| frame.to_frame());
        let is_rtu = |frame: &Frame| frame.protocol == Protocol::ModbusRtu && frame.direction == Direction::Received;
        frames.filter(is_rtu).any(|frame| frame.bytes.ends_with(b"\n"))
    }

    #[test]
    fn a_clean_line_shows_no_noise_whatever_its_modules_measure() {
        let specs: Vec<ModuleSpec> = vec!["pir-234@1:modbus_rtu:9600".parse().unwrap()];
        let sim = Sim::new(&specs, Pace::Skip);
        let mut bench = polling(&sim);
        let mut hundredths = 0u32;
        until(&mut bench, |bench| {
            hundredths = (hundredths + 1) % 5_000;
            sim.set_temperature(1, f64::from(hundredths) / 100.0);
            has_heard_line_feed(bench)
        });
        let report = bench.diagnosis_report();
        assert_eq!((report.line.noisy_answers, report.line.unasked_bytes), (0, 0));
        assert_eq!(report.conclusion(), "Nothing is wrong.");
        assert!(report.to_string().contains("Noise          none seen"), "{report}");
    }
}
