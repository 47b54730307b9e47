//! `saoms lsp`: serves editors.

use clap::Args;

use crate::Exit;
use crate::arguments::PluginArguments;

const EXIT_CODES: &str = "Exit codes:
  0  the editor ended the session
  1  the editor closed the connection without ending the session";

/// Serve editors over standard input and output: diagnostics, completion, and more (Language Server Protocol)
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct LspArguments {
    #[command(flatten)]
    pub(crate) plugins: PluginArguments,

    /// Accept unknown classes, as `saoms check --assume-classes` does
    #[arg(long)]
    pub(crate) assume_classes: bool,

    /// Also read files outside the folders and contributions of the composites, as `saoms check --allow-outside` does
    #[arg(long)]
    pub(crate) allow_outside: bool,
}

pub(super) fn lsp(arguments: &LspArguments) -> Exit {
    crate::lsp::lsp(arguments)
}
