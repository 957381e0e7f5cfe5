//! `sandtable completions`: scripts that complete commands in shells, and the manual page.

use clap::{Args, CommandFactory, ValueEnum};
use clap_complete::Shell;
use clap_mangen::Man;

use crate::arguments::Arguments;
use crate::error::CliError;
use crate::output::stream;

#[derive(Debug, Args)]
#[command(after_help = "\
bash        sandtable completions bash > ~/.local/share/bash-completion/completions/sandtable
zsh         sandtable completions zsh > \"${fpath[1]}/_sandtable\"
fish        sandtable completions fish > ~/.config/fish/completions/sandtable.fish
powershell  sandtable completions powershell >> $PROFILE
man         sandtable completions man > ~/.local/share/man/man1/sandtable.1")]
pub struct CompletionsArguments {
    /// The shell, or the manual page
    #[arg(value_name = "SHELL")]
    pub target: CompletionTarget,
}

/// What `completions` prints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CompletionTarget {
    Bash,
    Zsh,
    Fish,
    #[value(name = "powershell")]
    PowerShell,
    /// The manual page, for section 1
    Man,
}

pub fn run(arguments: &CompletionsArguments) -> Result<(), CliError> {
    let shell = match arguments.target {
        CompletionTarget::Bash => Shell::Bash,
        CompletionTarget::Zsh => Shell::Zsh,
        CompletionTarget::Fish => Shell::Fish,
        CompletionTarget::PowerShell => Shell::PowerShell,
        CompletionTarget::Man => {
            let manual = Man::new(Arguments::command());
            return stream(|mut out| manual.render(&mut out));
        }
    };
    // `generate` panics where it cannot write.
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "sandtable", &mut script);
    stream(|out| out.write_all(&script))
}
