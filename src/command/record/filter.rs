use std::io;
use std::path::PathBuf;

use clap::Args;
use saoms_recording::{Excerpt, Part};

use super::{EXIT_CODES, PartArguments, Start, open, unreadable, warn_of_cut};
use crate::Exit;
use crate::output::{Asked, Outputs, eprint};

/// Write chosen topics or times of a recording to another file; the composite and the report stay
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(super) struct FilterArguments {
    #[command(flatten)]
    part: PartArguments,

    /// The file to write
    #[arg(long, short = 'o', value_name = "FILE.mcap")]
    output: PathBuf,
}

pub(super) fn filter(arguments: &FilterArguments) -> Result<(), Exit> {
    let FilterArguments { part, output } = arguments;
    if !part.topics.is_empty() {
        // Nothing is written if there is no such topic.
        let mut reader = open(&part.file)?;
        while reader.next_part().map_err(|error| unreadable(&error))?.is_some() {}
        part.check_topics(&reader)?;
    }
    let mut reader = open(&part.file)?;
    let asked = Asked { what: "recording", option: "--output", path: output, grows: false };
    let place = Outputs::beside([part.file.clone()]).add(asked).map_err(|refused| refused.told())?;
    let mut problem = None;
    let written = place.open().and_then(|sink| {
        sink.write(|to| {
            let (mut excerpt, mut start) = (Excerpt::begin(to), Start::default());
            loop {
                let found = reader.next_part().map_err(|error| {
                    let told = io::Error::other(error.to_string());
                    problem = Some(error);
                    told
                })?;
                let Some(found) = found else { return excerpt.finish() };
                let is_meant = match &found {
                    Part::Message(message) => part.mean(message, start.seconds(&reader, message)),
                    Part::File(_) | Part::Values(..) => true,
                };
                if is_meant {
                    excerpt.add(&found)?;
                }
            }
        })
    });
    match (written, problem) {
        (Ok(()), _) => {
            warn_of_cut(&part.file, &reader);
            Ok(())
        }
        (Err(_), Some(problem)) => Err(unreadable(&problem)),
        (Err(error), None) => {
            eprint(&asked.unwritable(&error));
            Err(Exit::Failed)
        }
    }
}
