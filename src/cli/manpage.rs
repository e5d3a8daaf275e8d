//! `manpage`: the help as pages for `man`, one for the program and one for each subcommand.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use clap::{Args, Command, CommandFactory};
use clap_mangen::Man;
use clap_mangen::roff::{Roff, bold, roman};

use super::stop::Stop;
use super::{Cli, EXIT_CODES, Outcome, output};
#[cfg(feature = "window")]
use crate::renderer::Renderer;
use crate::{folders, version};

/// Options of `manpage`.
#[derive(Debug, Clone, Args)]
#[command(
    about = "Print the manual page of the program or of a command",
    long_about = "Print the manual page of the program or of one of its commands, in the language that man reads. Packages bring \
                  all pages along.",
    after_help = "Examples:\n  dcon-bench manpage | man -l -\n  dcon-bench manpage scan | man -l -\n  \
                  dcon-bench manpage --out ~/.local/share/man/man1"
)]
pub struct ManpageArgs {
    /// Of this command; of the program if none is named
    #[arg(value_name = "COMMAND")]
    command: Option<String>,
    /// Write all pages into this folder, dcon-bench.1, dcon-bench-scan.1 and so on
    #[arg(long, value_name = "FOLDER", conflicts_with = "command")]
    out: Option<PathBuf>,
}

pub fn run(args: &ManpageArgs) -> Outcome {
    let pages = pages();
    if let Some(folder) = &args.out {
        let failed = |error| Stop::failed(format!("{} cannot be written: {error}", folder.display()));
        return write_all(&pages, folder).map_err(failed);
    }
    let wanted =
        args.command.as_deref().map_or_else(|| version::NAME.to_owned(), |name| format!("{}-{name}", version::NAME));
    match pages.iter().find(|page| page.get_display_name().unwrap_or_else(|| page.get_name()) == wanted) {
        Some(page) => output::bytes(&written(page)?),
        None => Err(Stop::usage(format!("there is no command of this name – {} --help lists them", version::NAME))),
    }
}

fn write_all(pages: &[Command], folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    pages.iter().try_for_each(|page| fs::write(folder.join(Man::new(page.clone()).get_filename()), written(page)?))
}

/// The program and its subcommands, each with its whole name.
fn pages() -> Vec<Command> {
    let mut program = Cli::command();
    program.build();
    let subcommands: Vec<_> = program.get_subcommands().filter(|command| !command.is_hide_set()).cloned().collect();
    [vec![program], subcommands].concat()
}

fn written(page: &Command) -> io::Result<Vec<u8>> {
    let whole = page.get_name() == version::NAME;
    // A date of one space, as one that is empty would not be written at all.
    let man = Man::new(page.clone()).date(" ").source(version::named()).manual("User Commands");
    let mut out = Vec::new();
    man.render_title(&mut out)?;
    man.render_name_section(&mut out)?;
    man.render_synopsis_section(&mut out)?;
    man.render_description_section(&mut out)?;
    man.render_options_section(&mut out)?;
    if whole {
        man.render_subcommands_section(&mut out)?;
        surroundings().to_writer(&mut out)?;
    }
    exit_status().to_writer(&mut out)?;
    examples(page).to_writer(&mut out)?;
    Ok(out)
}

/// Exit codes are the same for all.
fn exit_status() -> Roff {
    let mut roff = Roff::new();
    roff.control("SH", ["EXIT STATUS"]).text([roman(EXIT_CODES.trim_start_matches("Exit codes: "))]);
    roff
}

/// The examples of the help, line by line.
fn examples(page: &Command) -> Roff {
    let help =
        page.get_after_long_help().or_else(|| page.get_after_help()).map(ToString::to_string).unwrap_or_default();
    let mut roff = Roff::new();
    let Some((_, lines)) = help.split_once("Examples:\n") else { return roff };
    roff.control("SH", ["EXAMPLES"]).control("nf", []);
    lines.lines().for_each(|line| {
        roff.text([roman(line.trim_start())]);
    });
    roff.control("fi", []);
    roff
}

/// Variables and files that the program as a whole heeds.
fn surroundings() -> Roff {
    let mut roff = Roff::new();
    roff.control("SH", ["ENVIRONMENT"]);
    let variables = [
        #[cfg(feature = "window")]
        (Renderer::VARIABLE, "What the window is drawn with, in place of --renderer: auto, opengl or wgpu."),
        (folders::OVERRIDE, "The folder of settings, definitions and recordings, in place of those below."),
        ("RUST_LOG", "What is logged to standard error: error, warn (unless set), info, debug or trace."),
    ];
    let files = [
        ("~/.config/dcon-bench/settings.toml", "The window's choices."),
        ("~/.config/dcon-bench/modules/*.toml", "Definitions of further modules."),
        ("~/.local/share/dcon-bench/recordings/", "Recordings, unless another folder is chosen."),
    ];
    let list = |roff: &mut Roff, rows: &[(&str, &str)]| {
        for (name, meaning) in rows {
            roff.control("TP", []).text([bold(*name)]).text([roman(*meaning)]);
        }
    };
    list(&mut roff, &variables);
    roff.control("SH", ["FILES"]);
    list(&mut roff, &files);
    roff
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(page: &Command) -> String {
        String::from_utf8(written(page).unwrap()).unwrap()
    }

    #[test]
    fn the_page_of_the_program_names_every_command() {
        let pages = pages();
        let whole = text(&pages[0]);
        for command in &pages[1..] {
            assert!(whole.contains(&command.get_name().replace('-', "\\-")), "{}", command.get_name());
        }
    }

    #[test]
    fn the_page_of_the_program_names_every_variable_that_it_heeds() {
        let whole = text(&pages()[0]);
        let (_, environment) = whole.split_once(".SH ENVIRONMENT").unwrap();
        let mut variables = vec![folders::OVERRIDE, "RUST_LOG"];
        #[cfg(feature = "window")]
        variables.push(Renderer::VARIABLE);
        for variable in variables {
            assert!(environment.contains(&format!("\\fB{variable}\\fR")), "{variable}: {environment}");
        }
    }

    #[test]
    fn every_page_has_a_name_a_synopsis_and_examples() {
        for page in pages() {
            let text = text(&page);
            for section in ["NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "\"EXIT STATUS\"", "EXAMPLES"] {
                assert!(text.contains(&format!(".SH {section}\n")), "{}: {section}", page.get_name());
            }
        }
    }
}
