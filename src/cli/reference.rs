//! `reference`: every command and register of a model.

use clap::Args;

use super::stop::Stop;
use super::{Outcome, output, session};
use crate::help::reference;
use crate::module::Catalogue;

/// Options of `reference`.
#[derive(Debug, Clone, Args)]
#[command(
    about = "Print the command reference of a model",
    long_about = "Print the command reference of a model, or of all, as Markdown: every DCON command and Modbus register with \
                  name, range, unit, access, meaning and the manual's section, as its definition file tells them. Models of the \
                  configuration folder are known too.",
    after_help = "Examples:\n  dcon-bench reference pir-234\n  dcon-bench reference > reference.md"
)]
pub struct ReferenceArgs {
    /// The model's id, such as pir-234 [default: all]
    #[arg(value_name = "MODEL")]
    model: Option<String>,
}

pub fn run(args: &ReferenceArgs) -> Outcome {
    let catalogue = session::catalogue();
    let texts: Vec<String> = match &args.model {
        None => catalogue.iter().map(|definition| reference::whole(definition)).collect(),
        Some(id) => {
            let definition = catalogue.get(&id.to_lowercase()).ok_or_else(|| unknown(&catalogue, id))?;
            vec![reference::whole(&definition)]
        }
    };
    output::line(texts.join("\n").trim_end())
}

fn unknown(catalogue: &Catalogue, id: &str) -> Stop {
    let known: Vec<&str> = catalogue.iter().map(|definition| definition.id.as_str()).collect();
    Stop::usage(format!("There is no model {id} – known are {}", known.join(", ")))
}
