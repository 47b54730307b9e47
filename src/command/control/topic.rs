//! `saoms topic`: the topics of a running fleet, and their messages.

use std::time::{Duration, Instant};

use clap::{Args, Subcommand};
use saoms_api::host::one_line;
use serde_json::{Value, json};

use super::fleet::{RunningFleetArguments, escape};
use super::over_network::{Followed, Programs, UrlArguments};
use super::table::Table;
use crate::Exit;
use crate::arguments::{Format, duration};
use crate::output::{eprint, has_failed, print, print_json_line};

const EXIT_CODES: &str = "\
Exit codes:
  0  shown or published
  1  standard output could not be written, or a program on the network of `--url` does not answer
  2  there is no such topic, the message does not fit, no fleet runs, or it is not clear which one is meant";

/// Show the topics of a running fleet and their messages, or publish one
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct TopicArguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    List(ListArguments),
    Info(InfoArguments),
    Echo(EchoArguments),
    Hz(HzArguments),
    Pub(PubArguments),
}

/// List the topics with the numbers of their publishers and readers
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
struct ListArguments {
    #[command(flatten)]
    fleet: RunningFleetArguments,

    #[command(flatten)]
    network: UrlArguments,
}

/// Show the publishers and readers of a topic, the events that wait for each reader, and the fields of its messages
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
struct InfoArguments {
    /// The topic
    topic: String,

    #[command(flatten)]
    fleet: RunningFleetArguments,

    #[command(flatten)]
    network: UrlArguments,
}

/// Show the messages of a topic: first the retained messages of a state topic, then new messages, until the fleet ends
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
struct EchoArguments {
    /// The topic
    topic: String,

    /// End after this number of messages
    #[arg(long, short = 'n', value_name = "N")]
    count: Option<u64>,

    #[command(flatten)]
    fleet: RunningFleetArguments,

    #[command(flatten)]
    network: UrlArguments,
}

/// Measure the rate of a topic: messages per second
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
struct HzArguments {
    /// The topic
    topic: String,

    /// How long to count messages (a bare number is milliseconds; units us, ms, s, min, h)
    #[arg(long = "for", value_name = "DURATION", default_value = "3s", value_parser = duration)]
    limit: Duration,

    #[command(flatten)]
    fleet: RunningFleetArguments,

    #[command(flatten)]
    network: UrlArguments,
}

/// Publish a message on a topic
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
struct PubArguments {
    /// The topic
    topic: String,

    /// The message, as a JSON object with its fields; `saoms topic info` shows them
    message: String,

    #[command(flatten)]
    fleet: RunningFleetArguments,

    #[command(flatten)]
    network: UrlArguments,
}

pub(crate) fn topic(arguments: &TopicArguments) -> Exit {
    let done = match &arguments.action {
        Action::List(arguments) => list(arguments),
        Action::Info(arguments) => info(arguments),
        Action::Echo(arguments) => echo(arguments),
        Action::Hz(arguments) => hz(arguments),
        Action::Pub(arguments) => publish(arguments),
    };
    done.map_or_else(|exit| exit, |()| Exit::Done)
}

fn list(arguments: &ListArguments) -> Result<(), Exit> {
    if let Some(programs) = arguments.network.open(&arguments.fleet) {
        return show(&mut programs?, |_| true, table);
    }
    let topics = arguments.fleet.ask("GET", "/v1/topics", "")?;
    arguments.fleet.show(&topics, || table(&topics));
    Ok(())
}

/// Shows the topics of all programs of a network.
fn show(
    programs: &mut Programs<'_>,
    keep: impl Fn(&mut Value) -> bool,
    words: impl Fn(&Value) -> String,
) -> Result<(), Exit> {
    let (answers, silent) = programs.answers(("GET", "/v1/topics", ""), keep)?;
    programs.print(&answers, words);
    if silent { Err(Exit::Failed) } else { Ok(()) }
}

fn table(topics: &Value) -> String {
    let mut table = Table::new(&["TOPIC", "KIND", "MESSAGE", "PUBLISHERS", "READERS", "WAITING"]);
    for topic in topics.as_array().into_iter().flatten() {
        let word = |field: &str| one_line(topic[field].as_str().unwrap_or_default()).into_owned();
        let count = |field: &str| topic[field].as_array().map_or(0, Vec::len).to_string();
        let waiting = topic["readers"].as_array().into_iter().flatten().filter_map(|one| one["waiting"].as_u64());
        let waiting = waiting.max().map_or_else(String::new, |most| most.to_string());
        table.row([word("name"), word("kind"), word("message"), count("publishers"), count("readers"), waiting]);
    }
    table.to_string()
}

/// The topic of this name in the list of all.
fn find(fleet: &RunningFleetArguments, name: &str) -> Result<Value, Exit> {
    let topics = fleet.ask("GET", "/v1/topics", "")?;
    let all = topics.as_array().map(Vec::as_slice).unwrap_or_default();
    match all.iter().find(|topic| topic["name"] == name) {
        Some(topic) => Ok(topic.clone()),
        None => Err(unknown(fleet, name, all.iter())),
    }
}

/// Reports that there is no topic of this name among all.
fn unknown<'a>(fleet: &RunningFleetArguments, name: &str, all: impl Iterator<Item = &'a Value>) -> Exit {
    let near = saoms_api::rule::nearest(name, all.filter_map(|topic| topic["name"].as_str()));
    let near = near.map(|near| format!("; did you mean `{near}`?")).unwrap_or_default();
    fleet.refuse(&format!("the fleet has no topic `{name}`{near}"), Exit::WrongInput)
}

/// The topic of this name in each program of a network that has it.
fn find_in_all(
    fleet: &RunningFleetArguments,
    programs: &mut Programs<'_>,
    name: &str,
) -> Result<Vec<(String, Value)>, Exit> {
    let (answers, _) = programs.answers(("GET", "/v1/topics", ""), |_| true)?;
    let topics = |answer: &Value| answer.as_array().cloned().unwrap_or_default();
    let of_name = |(program, answer): &(String, Value)| {
        let topic = topics(answer).into_iter().find(|topic| topic["name"] == name)?;
        Some((program.clone(), topic))
    };
    let found: Vec<(String, Value)> = answers.iter().filter_map(of_name).collect();
    let all: Vec<Value> = answers.iter().flat_map(|(_, answer)| topics(answer)).collect();
    if found.is_empty() { Err(unknown(fleet, name, all.iter())) } else { Ok(found) }
}

fn info(arguments: &InfoArguments) -> Result<(), Exit> {
    if let Some(programs) = arguments.network.open(&arguments.fleet) {
        let mut programs = programs?;
        let found = find_in_all(&arguments.fleet, &mut programs, &arguments.topic)?;
        programs.print(&found, described);
        return Ok(());
    }
    let topic = find(&arguments.fleet, &arguments.topic)?;
    arguments.fleet.show(&topic, || described(&topic));
    Ok(())
}

/// A topic in words.
fn described(topic: &Value) -> String {
    let word = |value: &Value| one_line(value.as_str().unwrap_or_default()).into_owned();
    let mut text =
        format!("{}: {} messages `{}`\n", word(&topic["name"]), word(&topic["kind"]), word(&topic["message"]));
    for field in topic["schema"]["fields"].as_array().into_iter().flatten() {
        let of = &field["type"];
        let of = of
            .as_str()
            .map_or_else(|| of["name"].as_str().map_or_else(|| of.to_string(), str::to_owned), str::to_owned);
        text.push_str(&format!("  {}: {}\n", word(&field["name"]), one_line(&of)));
    }
    for speaker in topic["speakers"].as_array().into_iter().flatten() {
        text.push_str(&format!("sender: {}\n", word(speaker)));
    }
    text.push_str("published by\n");
    for publisher in topic["publishers"].as_array().into_iter().flatten() {
        text.push_str(&format!("  {}\n", word(publisher)));
    }
    text.push_str("read by\n");
    for reader in topic["readers"].as_array().into_iter().flatten() {
        let waiting = match (reader["waiting"].as_u64(), reader["queue"].as_u64()) {
            (Some(waiting), Some(queue)) => format!(": {waiting} of at most {queue} events wait"),
            _ => String::new(),
        };
        text.push_str(&format!("  {}{waiting}\n", word(&reader["component"])));
    }
    text
}

/// The messages of a topic as they come, in JSON, each with whether the topic had retained it before.
fn messages(fleet: &RunningFleetArguments, topic: &str) -> Result<impl Iterator<Item = (bool, String)> + use<>, Exit> {
    let response = fleet.request("GET", &path_of(topic), "")?;
    Ok(response.events().filter_map(|(name, data)| {
        if name == "lost" {
            eprint(&format!("warning: {data} messages came faster than they were read, and were lost\n"));
            return None;
        }
        Some((name == "retained", data))
    }))
}

fn path_of(topic: &str) -> String {
    format!("/v1/topics/{}/messages", escape(topic))
}

/// Prints a message.
fn print_message(format: Format, sent: &Value) {
    match format {
        Format::Human => {
            let time = sent["time_s"].as_f64().unwrap_or_default();
            let component = one_line(sent["component"].as_str().unwrap_or_default()).into_owned();
            print(&format!("[{time:.3} s] {component}: {}\n", one_line(&sent["message"].to_string())));
        }
        Format::Json => print_json_line(sent),
    }
}

fn echo(arguments: &EchoArguments) -> Result<(), Exit> {
    let most = arguments.count.map_or(usize::MAX, |count| usize::try_from(count).unwrap_or(usize::MAX));
    if let Some(programs) = arguments.network.open(&arguments.fleet) {
        let mut left = most;
        if left == 0 {
            return Ok(());
        }
        return programs?.follow(&path_of(&arguments.topic), None, |Followed { program, mut message, .. }| {
            message["program"] = program.into();
            print_message(arguments.fleet.format, &message);
            left -= 1;
            left > 0 && !has_failed()
        });
    }
    for (_, message) in messages(&arguments.fleet, &arguments.topic)?.take(most) {
        let Ok(sent) = serde_json::from_str::<Value>(&message) else { continue };
        print_message(arguments.fleet.format, &sent);
        if has_failed() {
            break;
        }
    }
    Ok(())
}

fn hz(arguments: &HzArguments) -> Result<(), Exit> {
    if let Some(programs) = arguments.network.open(&arguments.fleet) {
        let mut programs = programs?;
        find_in_all(&arguments.fleet, &mut programs, &arguments.topic)?;
        let (start, mut number) = (Instant::now(), 0_u64);
        programs.follow(&path_of(&arguments.topic), Some(start + arguments.limit), |followed| {
            number += u64::from(!followed.is_retained);
            true
        })?;
        show_rate(arguments, &arguments.topic, number, start.elapsed());
        return Ok(());
    }
    let topic = find(&arguments.fleet, &arguments.topic)?;
    let name = topic["name"].as_str().unwrap_or_default().to_owned();
    let mut messages = messages(&arguments.fleet, &name)?.filter(|(is_retained, _)| !is_retained);
    let (sender, counted) = std::sync::mpsc::channel();
    // It ends with the process: no message may come for long.
    let count = move || while messages.next().is_some_and(|_| sender.send(()).is_ok()) {};
    std::thread::spawn(count);
    let (start, mut number) = (Instant::now(), 0_u64);
    while let Some(left) = arguments.limit.checked_sub(start.elapsed()) {
        match counted.recv_timeout(left) {
            Ok(()) => number += 1,
            Err(_) => break,
        }
    }
    show_rate(arguments, &name, number, start.elapsed());
    Ok(())
}

fn show_rate(arguments: &HzArguments, topic: &str, number: u64, time: Duration) {
    let seconds = time.as_secs_f64();
    let rate = number as f64 / seconds;
    let answer = json!({"topic": topic, "messages": number, "seconds": seconds, "per_second": rate});
    arguments.fleet.show(&answer, || format!("{rate:.1} messages a second: {number} in {seconds:.1} s\n"));
}

fn publish(arguments: &PubArguments) -> Result<(), Exit> {
    let path = path_of(&arguments.topic);
    if let Some(programs) = arguments.network.open(&arguments.fleet) {
        let mut programs = programs?;
        let accepted = programs.give(("POST", &path, &arguments.message))?;
        programs.print(&[accepted], |_| "published\n".to_owned());
        return Ok(());
    }
    let answer = arguments.fleet.ask("POST", &path, &arguments.message)?;
    arguments.fleet.show(&answer, || "published\n".to_owned());
    Ok(())
}
