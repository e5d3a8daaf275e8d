//! What is said of a file that does not take what is measured.

use crate::record::RecordingStatus;

/// What was said, so that it is said once.
#[derive(Default)]
pub struct Trouble {
    problem: Option<String>,
    /// It was said that the problem costs samples.
    is_losing: bool,
    /// Samples and events that were lost, when it was looked last.
    lost: u64,
    /// The same before the trouble began.
    lost_before: u64,
}

impl Trouble {
    /// What is to be said now. Samples that wait in memory are told apart from those that are refused or given up.
    pub fn look(&mut self, status: &RecordingStatus) -> Option<String> {
        let lost = std::mem::replace(&mut self.lost, status.lost);
        let before = std::mem::replace(&mut self.problem, status.problem.clone());
        let is_new = before != status.problem;
        if before.is_none() {
            self.lost_before = lost;
        }
        let was_losing = self.is_losing && !is_new;
        self.is_losing = was_losing || status.lost > lost;
        match &status.problem {
            Some(problem) if self.is_losing && !was_losing => Some(format!("samples are lost: {problem}")),
            Some(problem) if is_new => Some(format!("nothing is written: {problem}; what is measured waits in memory")),
            None if is_new => Some(match status.lost.saturating_sub(self.lost_before) {
                0 => "the file is written again, and complete".to_owned(),
                lost => format!("the file is written again, but {lost} samples or events are lost"),
            }),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(trouble: &mut Trouble, problem: &str, lost: u64) -> Option<String> {
        let problem = (!problem.is_empty()).then(|| problem.to_owned());
        trouble.look(&RecordingStatus { problem, lost, ..RecordingStatus::default() })
    }

    #[test]
    fn what_waited_is_complete_afterwards() {
        let mut trouble = Trouble::default();
        assert_eq!(said(&mut trouble, "", 0), None);
        let text = "nothing is written: it is full; what is measured waits in memory";
        assert_eq!(said(&mut trouble, "it is full", 0).as_deref(), Some(text));
        assert_eq!(said(&mut trouble, "it is full", 0), None);
        assert_eq!(said(&mut trouble, "", 0).as_deref(), Some("the file is written again, and complete"));
        assert_eq!(said(&mut trouble, "", 0), None);
    }

    #[test]
    fn what_is_refused_is_lost_and_stays_so() {
        let mut trouble = Trouble::default();
        let text = "samples are lost: the clock is early";
        assert_eq!(said(&mut trouble, "the clock is early", 3).as_deref(), Some(text));
        assert_eq!(said(&mut trouble, "the clock is early", 9), None);
        let text = "the file is written again, but 9 samples or events are lost";
        assert_eq!(said(&mut trouble, "", 9).as_deref(), Some(text));
        let text = "nothing is written: it is full; what is measured waits in memory";
        assert_eq!(said(&mut trouble, "it is full", 9).as_deref(), Some(text));
        assert_eq!(said(&mut trouble, "it is full", 10).as_deref(), Some("samples are lost: it is full"));
        assert_eq!(said(&mut trouble, "it is full", 11), None);
        let text = "the file is written again, but 2 samples or events are lost";
        assert_eq!(said(&mut trouble, "", 11).as_deref(), Some(text));
    }
}
