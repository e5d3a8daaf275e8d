//! Reads the recording back, as any other program would, and judges every sample in it.

use std::path::Path;

use super::line::is_checked;
use super::truth::Judgement;
use super::watch::{Watch, judge_sample, time};
use crate::bus::Target;
use crate::record::{Archive, Micros, Recording, StoreError};

/// What stands in the recording.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Recorded {
    pub samples: u64,
    pub wrong: u64,
    pub wrong_without_check: u64,
    pub of_twins: u64,
}

/// # Errors
/// If the file cannot be read.
pub fn read_back(path: &Path, targets: &[Target], watch: &mut Watch) -> Result<Recorded, StoreError> {
    let mut recording = Recording::open(path)?;
    let history = recording.load()?;
    let mut recorded = Recorded::default();
    for (id, series) in history.series() {
        let Some(module) = history.module_info(series.info.module) else { continue };
        let checked = targets.iter().any(|target| target.address == module.address && is_checked(target));
        for sample in recording.samples(id, Micros::MIN, Micros::MAX)? {
            let value = series.info.text(sample.value);
            let item = series.info.item.as_str();
            let judgement = judge_sample(&watch.truth, &watch.twins, module.address, item, &value, sample.at);
            recorded.count(judgement, checked);
            if judgement == Judgement::Wrong {
                let at = time(sample.at);
                watch.tell(format!("recorded: {module}: {item} = {value} at {at}, which the module never had"));
            }
        }
    }
    Ok(recorded)
}

impl Recorded {
    fn count(&mut self, judgement: Judgement, checked: bool) {
        self.samples = self.samples.saturating_add(1);
        let count = match judgement {
            Judgement::Right | Judgement::NotKnown => return,
            Judgement::Outdated => &mut self.of_twins,
            Judgement::Wrong if checked => &mut self.wrong,
            Judgement::Wrong => &mut self.wrong_without_check,
        };
        *count = count.saturating_add(1);
    }
}
