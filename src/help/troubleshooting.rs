//! Troubleshooting as an article: the diagnosis' symptoms with their causes and next steps.

use std::fmt::Write;

use super::markdown::escaped;
use crate::diagnosis::Symptom;

const BEGIN: &str = include_str!("../../assets/help/troubleshooting.md");

/// What symptoms below one heading have in common.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Group {
    Port,
    Network,
    NoAnswer,
    WrongAnswers,
    Refusals,
}

impl Group {
    /// In the article's order.
    const ALL: [Self; 5] = [Self::Port, Self::Network, Self::NoAnswer, Self::WrongAnswers, Self::Refusals];

    fn title(self) -> &'static str {
        match self {
            Self::Port => "The port",
            Self::Network => "The network",
            Self::NoAnswer => "No answer",
            Self::WrongAnswers => "Answers that are not right",
            Self::Refusals => "The module refuses",
        }
    }

    fn of(symptom: Symptom) -> Self {
        use Symptom::*;
        match symptom {
            NoPermission | NoSuchPort | NoSerialPort | PortVanished | PortBusy | NotOpened | SlowAdapter => Self::Port,
            ConnectionLost | NotReached => Self::Network,
            SilentLine | SilentInOneProtocol | SilentAddress | Stopped | Lost | Late => Self::NoAnswer,
            Garbage | Noise | ChangingErrors | SameErrors | CutShort | Unusable | WrongAddress | DoubledAddress
            | DoubledOrNoise | Twice | Echo | Collision => Self::WrongAnswers,
            Refused | WatchdogTripped => Self::Refusals,
        }
    }
}

pub fn article() -> String {
    let mut text = BEGIN.to_owned();
    for group in Group::ALL {
        let title = group.title();
        let _ = writeln!(text, "\n## {title}\n\n| Symptom | Likely cause | Next step |\n|---|---|---|");
        for symptom in Symptom::ALL.iter().filter(|symptom| Group::of(**symptom) == group) {
            text.push_str(&row(*symptom));
        }
    }
    text
}

fn row(symptom: Symptom) -> String {
    // The diagnosis writes commands in backticks, as the articles do.
    let [title, cause, step] =
        [symptom.title(), symptom.cause(), &symptom.next_step()].map(|text| escaped(text).replace("\\`", "`"));
    format!("| **{title}** | {cause} | {step} |\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_symptom_of_the_diagnosis_stands_in_the_help_once() {
        let article = article();
        for symptom in Symptom::ALL {
            assert_eq!(article.matches(&row(*symptom)).count(), 1, "{symptom:?}");
        }
        assert_eq!(article.matches("\n| **").count(), Symptom::ALL.len());
    }
}
