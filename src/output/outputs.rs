//! The outputs of a command, which must be no inputs of it, and apart from each other.

use std::collections::HashMap;
use std::fs;
use std::io;
use std::os::fd::RawFd;
use std::path::{Path, PathBuf};

use saoms_lang::project::INPUT;

use super::displayed;
use super::place::{Identity, Place};
use super::replace::make_folder;
use super::standard::{eprint, print};
use crate::Exit;

/// An output that a command was asked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asked<'a> {
    /// Its name, as `report`.
    pub(crate) what: &'static str,
    /// The option that asks for it.
    pub(crate) option: &'static str,
    pub(crate) path: &'a Path,
    /// True if it is written as it comes, and not whole at the end.
    pub(crate) grows: bool,
}

/// The reason why an output is not taken: a message for people.
#[derive(Debug)]
pub(crate) enum Refused {
    /// It is read, or another output as well.
    Taken(String),
    /// It cannot be written.
    Unwritable(String),
}

/// The outputs of a command.
#[derive(Debug, Default)]
pub(crate) struct Outputs {
    /// The regular files that are read, each with the path that it was read by.
    read: HashMap<Identity, PathBuf>,
    /// The outputs so far.
    written: Vec<(&'static str, Place, Option<Identity>)>,
}

/// The streams that a command writes beside the outputs that it is asked for.
const STREAMS: [(&str, RawFd); 2] = [("standard output", libc::STDOUT_FILENO), ("standard error", libc::STDERR_FILENO)];

impl Outputs {
    /// The outputs of a command that reads these files.
    pub(crate) fn beside(read: impl IntoIterator<Item = PathBuf>) -> Outputs {
        let mut outputs = Outputs::default();
        for path in read {
            let about = fs::metadata(if path == Path::new(INPUT) { Path::new("/proc/self/fd/0") } else { &path });
            if let Ok(about) = about
                && about.is_file()
            {
                outputs.read.entry(Identity::of(&about)).or_insert(path);
            }
        }
        outputs
    }

    /// Refuses standard output and standard error where they would be written over a file that is read, as in
    /// `saoms expand site.composite >> site.composite`.
    ///
    /// # Errors
    /// One of them is such a file, which was told on the other one.
    pub(crate) fn with_streams(self) -> Result<Outputs, Exit> {
        let read = |descriptor| self.read.get(&Place::Descriptor(descriptor).identity()?);
        let told = |(stream, descriptor)| Some(stream_is_read(stream, read(descriptor)?));
        match STREAMS.map(told) {
            [None, None] => return Ok(self),
            [Some(output), None] => eprint(&output),
            [None, Some(errors)] => print(&errors),
            [Some(_), Some(_)] => {}
        }
        Err(Exit::WrongInput)
    }

    /// Adds an output.
    ///
    /// # Errors
    /// It cannot be written, is read, or is another output as well.
    pub(crate) fn add(&mut self, asked: Asked<'_>) -> Result<Place, Refused> {
        let unwritable = |error| Refused::Unwritable(asked.unwritable(&error));
        let place = Place::of(asked.path).map_err(unwritable)?;
        let identity = place.identity();
        if let Some(read) = identity.as_ref().and_then(|identity| self.read.get(identity)) {
            return Err(Refused::Taken(asked.is_read(read)));
        }
        let is_same = |other: &Option<Identity>| identity.is_some() && *other == identity;
        // What is sent to a descriptor stands beside what others send there.
        let is_shared = matches!(place, Place::Descriptor(_));
        let stream = STREAMS.iter().find(|(_, of)| !is_shared && is_same(&Place::Descriptor(*of).identity()));
        if let Some((stream, _)) = stream {
            return Err(Refused::Taken(asked.is_taken_by(stream)));
        }
        let other = self.written.iter().find(|(_, other, known)| is_same(known) || is_shared && *other == place);
        if let Some((other, ..)) = other {
            return Err(Refused::Taken(asked.is_taken_by(&format!("the {other}"))));
        }
        place.try_out(asked.grows).map_err(unwritable)?;
        self.written.push((asked.what, place.clone(), identity));
        Ok(place)
    }

    /// True if a path leads to a file that is read, or to an output.
    pub(crate) fn hold(&self, path: &Path) -> bool {
        let identity = Place::of(path).ok().and_then(|place| place.identity());
        let is_written = |(_, _, known): &(&str, Place, Option<Identity>)| *known == identity;
        identity.as_ref().is_some_and(|one| self.read.contains_key(one) || self.written.iter().any(is_written))
    }
}

impl Refused {
    /// Tells it.
    pub(crate) fn told(self) -> Exit {
        let (problem, exit) = match self {
            Refused::Taken(problem) => (problem, Exit::WrongInput),
            Refused::Unwritable(problem) => (problem, Exit::Failed),
        };
        eprint(&problem);
        exit
    }

    /// The message.
    pub(crate) fn into_text(self) -> String {
        match self {
            Refused::Taken(problem) | Refused::Unwritable(problem) => problem,
        }
    }
}

impl Asked<'_> {
    /// The message about an output that cannot be written.
    pub(crate) fn unwritable(&self, error: &io::Error) -> String {
        format!("error: the {} cannot be written to `{}`: {error}\n", self.what, displayed(self.path))
    }

    fn is_read(&self, read: &Path) -> String {
        let Asked { what, option, path, .. } = self;
        let which = match () {
            () if read == *path => ", which is an input".to_owned(),
            () if read == Path::new(INPUT) => ": it is read from standard input".to_owned(),
            () => format!(": it is `{}`, which is an input", displayed(read)),
        };
        let path = displayed(path);
        format!("error: the {what} cannot be written to `{path}`{which}\n  = help: give `{option}` another file\n")
    }

    fn is_taken_by(&self, other: &str) -> String {
        let Asked { what, option, path, .. } = self;
        let path = displayed(path);
        format!(
            "error: {other} and the {what} cannot both be written to `{path}`\n  = help: give `{option}` another file\n"
        )
    }
}

fn stream_is_read(stream: &str, read: &Path) -> String {
    let which = match () {
        () if read == Path::new(INPUT) => "the file that standard input reads".to_owned(),
        () => format!("`{}`, which is an input", displayed(read)),
    };
    format!("error: {stream} is {which}\n  = help: send {stream} to another file\n")
}

/// Writes texts into a folder and those in it, which are made if they are not there, beside files that are read. None
/// is written where one cannot be.
///
/// # Errors
/// One cannot be written, or would be written over another file.
pub(crate) fn write_into(
    what: &'static str,
    folder: &Path,
    texts: &[(PathBuf, impl AsRef<[u8]>)],
    read: Vec<PathBuf>,
) -> Result<(), Refused> {
    let asked = |path| Asked { what, option: "--output", path, grows: false };
    let refused = |why: &str| {
        let folder = folder.display();
        let help = "give `--output` a folder; it is made if it is not there";
        Err(Refused::Taken(format!("error: the {what}s cannot be written to `{folder}`, {why}\n  = help: {help}\n")))
    };
    if folder == Path::new("-") {
        return refused("which is standard output: they are several files");
    }
    if fs::metadata(folder).is_ok_and(|about| !about.is_dir()) {
        return refused("which is a file");
    }
    let inner = texts.iter().filter_map(|(path, _)| path.parent());
    for folder in std::iter::once(folder).chain(inner) {
        make_folder(folder).map_err(|error| Refused::Unwritable(asked(folder).unwritable(&error)))?;
    }
    let mut outputs = Outputs::beside(read);
    let places: Vec<Place> = texts.iter().map(|(path, _)| outputs.add(asked(path))).collect::<Result<_, _>>()?;
    for (place, (path, text)) in places.into_iter().zip(texts) {
        let written = place.open().and_then(|sink| sink.write(|to| to.write_all(text.as_ref())));
        written.map_err(|error| Refused::Unwritable(asked(path).unwritable(&error)))?;
    }
    Ok(())
}
