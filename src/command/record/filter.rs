use std::io;
use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use saoms_recording::{Channel, Excerpt, Part};

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

/// Adds what was drawn last before the part, so that tools draw it from its first moment on.
fn add_all(excerpt: &mut Excerpt<'_>, before: &mut Vec<Part>) -> io::Result<()> {
    before.drain(..).try_for_each(|one| excerpt.add(&one))
}

fn is_of_channel(part: &Part, channel: &Arc<Channel>) -> bool {
    matches!(part, Part::Message(message) if Arc::ptr_eq(&message.channel, channel))
}

pub(super) fn filter(arguments: &FilterArguments) -> Result<(), Exit> {
    let FilterArguments { part, output } = arguments;
    if !part.topics.is_empty() {
        // Nothing is written if there is no such topic.
        let mut reader = open(&part.file)?;
        while reader.next_part().map_err(|error| unreadable(&error))?.is_some() {}
        warn_of_cut(&part.file, &reader);
        part.check_topics(&reader)?;
    }
    let mut reader = open(&part.file)?;
    let asked = Asked { what: "recording", option: "--output", path: output, grows: false };
    let place = Outputs::beside([part.file.clone()]).add(asked).map_err(|refused| refused.told())?;
    let mut problem = None;
    let written = place.open().and_then(|sink| {
        sink.write(|to| {
            let (mut excerpt, mut start, mut before) = (Excerpt::begin(to), Start::default(), Vec::new());
            loop {
                let found = reader.next_part().map_err(|error| {
                    let told = io::Error::other(error.to_string());
                    problem = Some(error);
                    told
                })?;
                let Some(found) = found else {
                    add_all(&mut excerpt, &mut before)?;
                    return excerpt.finish();
                };
                match &found {
                    Part::Message(message) => {
                        let seconds = start.seconds(&reader, message);
                        if part.mean(message, seconds) {
                            add_all(&mut excerpt, &mut before)?;
                            excerpt.add(&found)?;
                        } else if message.channel.is_drawing() && part.begin_after(message, seconds) {
                            before.retain(|one| !is_of_channel(one, &message.channel));
                            before.push(found);
                        }
                    }
                    Part::File(_) | Part::Values(..) => excerpt.add(&found)?,
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
