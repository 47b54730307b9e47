use clap::Args;
use saoms_recording::Part;
use serde_json::json;

use super::{EXIT_CODES, PartArguments, Start, open, unreadable, warn_of_cut};
use crate::Exit;
use crate::output::{eprint, has_failed, print_json_line};

/// Print messages as lines of JSON, in the order in which they were recorded
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(super) struct CatArguments {
    #[command(flatten)]
    part: PartArguments,

    /// End after this number of messages
    #[arg(long, value_name = "N")]
    limit: Option<u64>,
}

pub(super) fn cat(arguments: &CatArguments) -> Result<(), Exit> {
    let part = &arguments.part;
    let mut reader = open(&part.file)?;
    let (mut start, mut left, mut unread) = (Start::default(), arguments.limit.unwrap_or(u64::MAX), 0_u64);
    while left > 0 && !has_failed() {
        let Some(found) = reader.next_part().map_err(|error| unreadable(&error))? else {
            warn_of_cut(&part.file, &reader);
            part.check_topics(&reader)?;
            break;
        };
        let Part::Message(message) = found else { continue };
        let seconds = start.seconds(&reader, &message);
        if !part.mean(&message, seconds) {
            continue;
        }
        left -= 1;
        let value = message.json();
        unread += u64::from(value.is_none());
        print_json_line(&json!({
            "time_s": seconds,
            "topic": message.channel.topic(),
            "component": message.component.as_deref(),
            "message": value,
        }));
    }
    if unread > 0 {
        eprint(&format!("warning: {unread} messages were written by another program, and are `null` here\n"));
    }
    Ok(())
}
