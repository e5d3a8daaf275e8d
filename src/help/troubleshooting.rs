//! Troubleshooting as an article: the diagnosis' symptoms with their causes and next steps.

use std::fmt::Write;

use super::markdown::escaped;
use crate::diagnosis::Symptom;

const BEGIN: &str = include_str!("../../assets/help/troubleshooting.md");

/// What the symptoms below a heading have in common, and which they are.
const GROUPS: [(&str, &[Symptom]); 4] = [
    (
        "The port",
        &[Symptom::NoPermission, Symptom::PortVanished, Symptom::PortBusy, Symptom::NotOpened, Symptom::SlowAdapter],
    ),
    (
        "No answer",
        &[
            Symptom::SilentLine,
            Symptom::SilentInOneProtocol,
            Symptom::SilentAddress,
            Symptom::Stopped,
            Symptom::Lost,
            Symptom::Late,
        ],
    ),
    (
        "Answers that are not right",
        &[
            Symptom::Garbage,
            Symptom::Noise,
            Symptom::ChangingErrors,
            Symptom::SameErrors,
            Symptom::CutShort,
            Symptom::Unusable,
            Symptom::WrongAddress,
            Symptom::DoubledAddress,
            Symptom::DoubledOrNoise,
            Symptom::Twice,
            Symptom::Echo,
            Symptom::Collision,
        ],
    ),
    ("The module refuses", &[Symptom::Refused, Symptom::WatchdogTripped]),
];

pub fn article() -> String {
    let mut text = BEGIN.to_owned();
    for (title, symptoms) in GROUPS {
        let _ = writeln!(text, "\n## {title}\n\n| Symptom | Likely cause | Next step |\n|---|---|---|");
        for symptom in symptoms {
            // The diagnosis writes commands in backticks, as the articles do.
            let [title, cause, step] =
                [symptom.title(), symptom.cause(), &symptom.next_step()].map(|text| escaped(text).replace("\\`", "`"));
            let _ = writeln!(text, "| **{title}** | {cause} | {step} |");
        }
    }
    text
}
