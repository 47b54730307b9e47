use std::collections::BTreeMap;
use std::path::PathBuf;

use clap::Args;
use saoms_api::host::one_line;
use saoms_recording::Part;
use serde_json::{Value, json};

use super::super::control::Table;
use super::{EXIT_CODES, Start, open, unreadable, warn_of_cut};
use crate::Exit;
use crate::arguments::Format;
use crate::output::{counted, displayed, print, print_json};

/// Show what a recording has: topics with their types, numbers of messages and times, files in it, and what was lost
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(super) struct InfoArguments {
    /// The recording
    #[arg(value_name = "FILE")]
    file: PathBuf,

    /// The format: for people, or a JSON object
    #[arg(long, value_enum, default_value_t = Format::Human)]
    format: Format,
}

/// What there is of a topic.
struct Topic {
    kind: String,
    messages: u64,
    first: f64,
    last: f64,
}

pub(super) fn info(arguments: &InfoArguments) -> Result<(), Exit> {
    let path = &arguments.file;
    let mut reader = open(path)?;
    let (mut topics, mut files, mut run) = (BTreeMap::<String, Topic>::new(), Vec::new(), BTreeMap::new());
    let mut start = Start::default();
    while let Some(part) = reader.next_part().map_err(|error| unreadable(&error))? {
        match part {
            Part::Message(message) => {
                let seconds = start.seconds(&reader, &message);
                let new = || Topic {
                    kind: message.channel.type_name().to_owned(),
                    messages: 0,
                    first: f64::INFINITY,
                    last: f64::NEG_INFINITY,
                };
                let topic = topics.entry(message.channel.topic().to_owned()).or_insert_with(new);
                topic.messages += 1;
                (topic.first, topic.last) = (topic.first.min(seconds), topic.last.max(seconds));
            }
            Part::File(file) => files.push((file.name, file.media_type, file.data.len())),
            Part::Values(_, values) => run.extend(values),
        }
    }
    let duration = topics.values().map(|topic| topic.last).fold(0.0, f64::max);
    let value = |name: &str| run.get(name).cloned();
    match arguments.format {
        Format::Json => {
            let of_topic = |(name, topic): (&String, &Topic)| {
                let Topic { kind, messages, first, last } = topic;
                json!({ "topic": name, "type": kind, "messages": messages, "first_s": first, "last_s": last })
            };
            let of_file = |(name, kind, bytes)| json!({ "name": name, "media_type": kind, "bytes": bytes });
            let files = files.into_iter().map(of_file);
            print_json(&json!({
                "name": value("name"),
                "version": value("version"),
                "seed": value("seed").and_then(|seed| seed.parse::<u64>().ok()),
                "clock": value("clock"),
                "node": value("node"),
                "part": value("part").and_then(|part| part.parse::<u32>().ok()),
                "start_ns": reader.start(),
                "duration_s": duration,
                "topics": topics.iter().map(of_topic).collect::<Vec<Value>>(),
                "files": files.collect::<Vec<Value>>(),
                "lost": reader.lost(),
                "cut": reader.cut(),
            }));
        }
        Format::Human => {
            let word = |name: &str| one_line(&value(name).unwrap_or_default()).into_owned();
            let mut text = format!("{}: {duration:.3} s", displayed(path));
            if value("name").is_some() {
                text.push_str(&format!(
                    " of `{}` in {} time, seed {}, saoms {}",
                    word("name"),
                    word("clock"),
                    word("seed"),
                    word("version")
                ));
            }
            if value("part").is_some() {
                text.push_str(&format!(", part {}", word("part")));
            }
            text.push('\n');
            let mut table = Table::new(&["TOPIC", "TYPE", "MESSAGES", "FIRST", "LAST"]).with_numbers([2, 3, 4]);
            for (name, Topic { kind, messages, first, last }) in &topics {
                let (name, kind) = (one_line(name).into_owned(), one_line(kind).into_owned());
                table.row([name, kind, messages.to_string(), format!("{first:.3} s"), format!("{last:.3} s")]);
            }
            text.push_str(&table.to_string());
            for (name, _, bytes) in &files {
                text.push_str(&format!("file {}: {}\n", one_line(name), counted(*bytes, "byte")));
            }
            if let Some(lost) = reader.lost() {
                let lost = counted(usize::try_from(lost).unwrap_or(usize::MAX), "message");
                text.push_str(&format!("lost: {lost}\n"));
            }
            print(&text);
        }
    }
    warn_of_cut(path, &reader);
    Ok(())
}
