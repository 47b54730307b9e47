//! `saoms new`: a plugin crate, a site or a composite that works, to start from.

mod files;
mod messages;

use std::fs;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand, ValueEnum};

use crate::Exit;
use crate::output::{eprint, print, replace};

use files::Names;

const EXIT_CODES: &str = "\
Exit codes:
  0  made
  1  created, but standard output could not be written
  2  one of the files is there already, the name cannot be used, or a file could not be written";

/// Make a working plugin, site or composite to start from
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct NewArguments {
    #[command(subcommand)]
    pub(crate) what: NewKind,
}

#[derive(Debug, Subcommand)]
pub(crate) enum NewKind {
    /// Make the crate of a plugin: its code, its tests, and a composite that uses it
    #[command(after_help = EXIT_CODES)]
    Plugin {
        /// The folder to make; its name becomes that of the package
        path: PathBuf,

        /// Kind of plugin: a component, the hardware of a robot, a loop of robots, a robot that extends the one that
        /// ships, a master that does, or a component in C or in Python
        #[arg(long, value_enum, default_value_t = PluginKind::Component)]
        kind: PluginKind,

        /// Source of saoms-api: a folder with a checkout, a git URL, or a version; by default the checkout that made
        /// this program
        #[arg(long, value_name = "SOURCE")]
        api: Option<String>,
    },
    /// Make a folder with a small fleet: a composite, a map, a scenario, and a table of the robots
    #[command(after_help = EXIT_CODES)]
    Site {
        /// The folder to make; its name becomes that of the composite
        path: PathBuf,
    },
    /// Make declarations in Rust of interfaces of ROS 2: files `.msg` and `.srv`
    #[command(after_help = EXIT_CODES)]
    Messages {
        /// The files, with those of all types that they name; the package is the folder above `msg` or `srv`
        #[arg(required = true, value_name = "FILE")]
        files: Vec<PathBuf>,

        /// The file to make, in Rust
        #[arg(short, long, value_name = "FILE")]
        output: PathBuf,

        /// The package of files that lie in no folder `msg` or `srv`
        #[arg(long, value_name = "NAME")]
        package: Option<String>,
    },
    /// Make a composite with one robot
    #[command(after_help = EXIT_CODES)]
    Composite {
        /// The file to make
        path: PathBuf,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PluginKind {
    Component,
    Robot,
    Loop,
    Extension,
    Master,
    C,
    Python,
}

/// Creates the files. Existing files are never changed.
pub(crate) fn new(arguments: &NewArguments) -> Exit {
    let made = match &arguments.what {
        NewKind::Plugin { path, kind, api } => plugin(path, *kind, api.as_deref()),
        NewKind::Site { path } => site(path),
        NewKind::Composite { path } => composite(path),
        NewKind::Messages { files, output, package } => declarations(files, output, package.as_deref()),
    };
    match made {
        Ok(next) => {
            print(&next);
            Exit::Done
        }
        Err(problem) => {
            eprint(&format!("error: {problem}\n"));
            Exit::WrongInput
        }
    }
}

fn plugin(path: &Path, kind: PluginKind, api: Option<&str>) -> Result<String, String> {
    let names = Names::of(&file_name(path)?, kind)?;
    let (files, next) = match kind {
        PluginKind::C => {
            (files::plugin_in_c(&names), "make test\n  saoms run fleet.composite --virtual --for 10s --plugin build")
        }
        PluginKind::Python => (
            files::plugin_in_python(&names),
            "python3 -m unittest\n  saoms run fleet.composite --virtual --for 10s --plugin .",
        ),
        kind => (
            files::plugin(&names, kind, &files::source(api)?, unlisted_program().as_deref()),
            "cargo test\n  cargo build\n  saoms run fleet.composite --virtual --for 10s --plugin target/debug",
        ),
    };
    write_all(path, files)?;
    let path = path.display();
    Ok(format!("Made the plugin `{}` in {path}. Next:\n\n  cd {path}\n  {next}\n", names.package))
}

/// This program, where no `saoms` is found in `PATH`: so that the tests of a plugin find it.
fn unlisted_program() -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let is_listed = std::env::split_paths(&path).any(|folder| folder.join("saoms").is_file());
    std::env::current_exe().ok().filter(|_| !is_listed)
}

fn composite(path: &Path) -> Result<String, String> {
    let path = if path.extension().is_some() || path.file_name().is_none() {
        path.to_owned()
    } else {
        path.with_extension("composite")
    };
    let Some(stem) = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()) else {
        return Err(format!("found `{}`, expected the file to make, such as `hall.composite`", path.display()));
    };
    composite_name(&stem)?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let name = path.file_name().map(PathBuf::from).unwrap_or_default();
    write_all(folder, vec![(name, files::composite(&stem))])?;
    let path = path.display();
    Ok(format!("Made {path}. Next:\n\n  saoms check {path}\n  saoms run {path} --virtual\n"))
}

fn declarations(files: &[PathBuf], output: &Path, package: Option<&str>) -> Result<String, String> {
    let text = messages::declarations(files, package)?;
    let folder = output.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let name = output.file_name().map(PathBuf::from);
    let name = name.ok_or_else(|| format!("found `{}`, expected the file to make", output.display()))?;
    write_all(folder, vec![(name, text)])?;
    Ok(format!("Made {}\n", output.display()))
}

fn site(path: &Path) -> Result<String, String> {
    let name = file_name(path)?;
    composite_name(&name)?;
    write_all(path, files::site(&name))?;
    let path = path.display();
    Ok(format!(
        "Made the site `{name}` in {path}. Next:\n\n  cd {path}\n  saoms check site.composite\n  saoms run site.composite --virtual\n"
    ))
}

fn composite_name(name: &str) -> Result<(), String> {
    if is_ncname(name) {
        return Ok(());
    }
    Err(format!(
        "found the name `{name}`, expected a letter and then letters, digits, `-`, `_` or `.`: it becomes the name of the composite"
    ))
}

fn file_name(path: &Path) -> Result<String, String> {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
    name.ok_or_else(|| format!("found `{}`, expected the folder to make, such as `my-robot`", path.display()))
}

fn is_ncname(text: &str) -> bool {
    let mut signs = text.chars();
    signs.next().is_some_and(|first| first.is_alphabetic() || first == '_')
        && signs.all(|sign| sign.is_alphanumeric() || matches!(sign, '-' | '_' | '.'))
}

/// Writes files below a folder, if none of them is there.
fn write_all(folder: &Path, files: Vec<(PathBuf, String)>) -> Result<(), String> {
    for (name, _) in &files {
        let path = folder.join(name);
        // A link that leads nowhere is there, too.
        if path.symlink_metadata().is_ok() {
            return Err(format!("`{}` is there already: nothing was made", path.display()));
        }
    }
    if folder.is_file() {
        return Err(format!("`{}` is a file, expected the folder to make", folder.display()));
    }
    for (name, text) in files {
        let path = folder.join(name);
        let written = path.parent().map_or(Ok(()), fs::create_dir_all);
        let written = written.and_then(|()| replace(&path, |to| to.write_all(text.as_bytes())));
        written.map_err(|error| format!("`{}` cannot be written: {error}", path.display()))?;
    }
    Ok(())
}
