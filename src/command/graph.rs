//! `saoms graph`: draws a composite.

use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use saoms_lang::diagnostic::{Diagnostic, Severity, codes};
use saoms_lang::project::{INPUT, SET, SEVERITY};
use saoms_tools::diagnostics::Human;
use saoms_tools::graph::{Diagram, dot, mermaid, svg};

use crate::Exit;
use crate::arguments::FleetArguments;
use crate::fleet::{compiled, files_read};
use crate::output::{Asked, Outputs, displayed, eprint, eprint_coloured};

const EXIT_CODES: &str = "Exit codes:
  0  drawn; missing parts of a faulty composite are marked in the picture
  1  the picture could not be written
  2  the file cannot be read or is not a composite, the format is missing, or the picture would overwrite a
     file that was read";

/// Draw composites: components, services, references, properties, wires, promotions, topics
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct GraphArguments {
    #[command(flatten)]
    pub(crate) fleet: FleetArguments,

    /// File of the picture; its ending selects the format (`.svg`, `.mmd`, `.dot`), `-` is standard output
    #[arg(short, long, value_name = "PICTURE")]
    pub(crate) output: Option<PathBuf>,

    /// The format, if the file has no such ending; SVG by default
    #[arg(long, value_enum)]
    pub(crate) format: Option<PictureFormat>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PictureFormat {
    /// A picture in the notation of SCA
    Svg,
    /// A flowchart for Mermaid, as Markdown viewers draw it
    Mermaid,
    /// A graph for Graphviz
    Dot,
}

pub(crate) fn graph(arguments: &GraphArguments) -> Exit {
    let path = arguments.output.as_deref().filter(|path| *path != Path::new("-"));
    let picture = match (arguments.format, path) {
        (Some(format), Some(path)) if by_ending(path).is_some_and(|other| other != format) => {
            eprint(&format!(
                "error: `--format` differs from the ending of `{}`\n  = help: remove `--format`, or change the \
                ending of the file\n",
                displayed(path)
            ));
            return Exit::WrongInput;
        }
        (Some(format), _) => format,
        (None, None) => PictureFormat::Svg,
        (None, Some(path)) => match by_ending(path) {
            Some(format) => format,
            None => {
                eprint(&format!(
                    "error: the ending of `{}` is not that of a format\n  = help: use `.svg`, `.mmd` or `.dot`, or \
                    give the format with `--format`\n",
                    displayed(path)
                ));
                return Exit::WrongInput;
            }
        },
    };
    let fleet = &arguments.fleet;
    let compilation = match compiled(fleet, |project, classes| project.census(classes)) {
        Ok(compilation) => compilation,
        Err(exit) => return exit,
    };
    let (contribution, sources) = (&compilation.contribution, &compilation.sources);
    let found: Vec<&Diagnostic> = compilation.reported().collect();
    let is_of_option = |one: &&&Diagnostic| matches!(sources.get(one.location.file).path(), SET | SEVERITY);
    let of_options: Vec<&Diagnostic> = found.iter().filter(is_of_option).copied().collect();
    // A file of the command that is not there has no part in a picture.
    let is_unread = |one: &&&Diagnostic| {
        let path = Path::new(sources.get(one.location.file).path());
        one.code == &codes::FILE_NOT_FOUND && one.location.span.end == 0 && fleet.files.iter().any(|file| file == path)
    };
    let unread: Vec<&Diagnostic> = found.iter().filter(is_unread).copied().collect();
    let refused = [of_options, unread].concat();
    let census = match &compilation.output {
        Some(census) if !contribution.composites().is_empty() && refused.is_empty() => census,
        _ => {
            let shown = if refused.is_empty() { found } else { refused };
            eprint_coloured(&Human::of(shown, sources, io::stderr().is_terminal()));
            return Exit::WrongInput;
        }
    };
    // How many there are, a check finds: a picture asks for no more than it needs.
    if found.iter().any(|one| one.severity == Severity::Error) {
        let names: Vec<String> = fleet.files.iter().map(|file| displayed(file)).collect();
        let name = names.join(" ");
        eprint(&format!(
            "warning: the picture is incomplete, since the composite has errors; `saoms check {name}` shows them\n"
        ));
    }
    let diagram = Diagram::of(contribution, &compilation.registry, census);
    let path = arguments.output.as_deref().unwrap_or(Path::new(INPUT));
    let asked = Asked { what: "picture", option: "--output", path, grows: false };
    let place = match Outputs::beside(files_read(&compilation, fleet)).add(asked) {
        Ok(place) => place,
        Err(refused) => return refused.told(),
    };
    // A picture of a large composite needs the memory.
    drop(compilation);
    let text = match picture {
        PictureFormat::Svg => svg(&diagram),
        PictureFormat::Mermaid => mermaid(&diagram),
        PictureFormat::Dot => dot(&diagram),
    };
    match place.open().and_then(|sink| sink.write(|to| write!(to, "{text}"))) {
        Ok(()) => Exit::Done,
        Err(error) => {
            eprint(&asked.unwritable(&error));
            Exit::Failed
        }
    }
}

fn by_ending(path: &Path) -> Option<PictureFormat> {
    match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
        "svg" => Some(PictureFormat::Svg),
        "mmd" | "mermaid" => Some(PictureFormat::Mermaid),
        "dot" | "gv" => Some(PictureFormat::Dot),
        _ => None,
    }
}
