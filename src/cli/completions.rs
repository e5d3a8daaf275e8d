//! `completions`: what shells need to know to complete commands and options.

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use super::{Cli, Outcome, output};
use crate::version;

/// Options of `completions`.
#[derive(Debug, Clone, Args)]
#[command(
    about = "Print the completions of a shell",
    long_about = "Print the script by which a shell completes commands and options with the Tab key. Packages bring it along; \
                  elsewhere it goes where the shell looks for it.",
    after_help = "Examples:\n  dcon-bench completions bash > ~/.local/share/bash-completion/completions/dcon-bench\n  \
                  dcon-bench completions fish > ~/.config/fish/completions/dcon-bench.fish\n  \
                  dcon-bench completions zsh > ~/.zfunc/_dcon-bench      with fpath+=~/.zfunc before compinit in ~/.zshrc\n  \
                  dcon-bench completions powershell >> $PROFILE"
)]
pub struct CompletionsArgs {
    /// Whose completions
    shell: Shell,
}

pub fn run(args: &CompletionsArgs) -> Outcome {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), version::NAME, &mut script);
    output::bytes(&script)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::ValueEnum;

    #[test]
    fn every_shell_completes_every_command() {
        for shell in Shell::value_variants() {
            let mut script = Vec::new();
            clap_complete::generate(*shell, &mut Cli::command(), version::NAME, &mut script);
            let script = String::from_utf8(script).unwrap();
            for command in Cli::command().get_subcommands() {
                assert!(script.contains(command.get_name()), "{shell}: {}", command.get_name());
            }
        }
    }
}
