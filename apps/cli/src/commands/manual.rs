//! `aquafuse completions` and `aquafuse man`.

use std::path::PathBuf;

use aquafuse_data::files::{make_folder, write_text};
use clap::{Args, Command};
use clap_complete::Shell;

use crate::args::common::Common;
use crate::failure::Failure;
use crate::report::output;

/// Print a completion script for a shell.
#[derive(Args)]
#[command(
    after_help = "Example:\n  aquafuse completions bash > ~/.local/share/bash-completion/completions/aquafuse"
)]
pub(crate) struct Completions {
    /// The shell.
    #[arg(value_enum)]
    shell: Shell,
}

impl Completions {
    pub(crate) fn run(&self, mut command: Command) -> Result<(), Failure> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut command, "aquafuse", &mut script);
        output::print(&String::from_utf8_lossy(&script))
    }
}

/// Write the manual pages: aquafuse.1 and one per command.
#[derive(Args)]
#[command(after_help = "Example:\n  aquafuse man -o ~/.local/share/man/man1 && man aquafuse-fuse")]
pub(crate) struct Man {
    /// Output folder; created if missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Replace existing pages.
    #[arg(long)]
    overwrite: bool,
}

impl Man {
    pub(crate) fn run(&self, mut command: Command, common: &Common) -> Result<(), Failure> {
        make_folder(&self.output)?;
        command.build();
        self.write(&command, "aquafuse")?;
        output::written(&self.output, common.quiet)
    }

    fn write(&self, command: &Command, name: &str) -> Result<(), Failure> {
        let mut page = Vec::new();
        clap_mangen::Man::new(command.clone()).title(name).render(&mut page).map_err(Failure::work)?;
        let path = self.output.join(format!("{name}.1"));
        write_text(&path, &String::from_utf8_lossy(&page), self.overwrite)?;
        let mut commands = command.get_subcommands().filter(|command| command.get_name() != "help");
        commands.try_for_each(|command| self.write(command, &format!("{name}-{}", command.get_name())))
    }
}
