//! `saoms top`: what each component of a running fleet does, as a table that is always new.

mod feed;
mod picture;
mod terminal;

use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use saoms_api::host::{one_line, parse_duration};
use saoms_control::ClientError;
use serde_json::Value;

use super::fleet::RunningFleetArguments;
use crate::Exit;
use crate::arguments::Format;
use crate::output::{has_failed, has_reader, print, print_json_line};
use feed::Feed;
use picture::Picture;
use terminal::{Input, Terminal};

const EXIT_CODES: &str = "\
Exit codes:
  0    shown, until `q`, Ctrl-C in a terminal, the last refresh of -n, or the end of the fleet
  1    standard output could not be written
  2    no fleet runs, it is not clear which one is meant, or the command line is wrong
  130  ended by SIGTERM or SIGHUP, or outside a terminal by Ctrl-C";

/// The shortest time between two refreshes: the answers of a fleet are up to so old.
const SHORTEST: Duration = Duration::from_millis(100);

/// Show a table of what the components of a running fleet do, and refresh it until `q` is pressed
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct TopArguments {
    /// The time between two refreshes, at least 100ms (a bare number is milliseconds; units us, ms, s, min, h)
    #[arg(long, value_name = "DURATION", default_value = "1s", value_parser = interval)]
    every: Duration,

    /// End after this number of refreshes
    #[arg(long = "number", short = 'n', value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    number: Option<u64>,

    /// The order of the components; without it, that of the composite. In a terminal the keys `l`, `m`, `n` and `c`
    /// change it
    #[arg(long, value_enum)]
    sort: Option<Sort>,

    #[command(flatten)]
    fleet: RunningFleetArguments,
}

/// Orders of the components.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Sort {
    /// By the lateness that 99 % of the executions keep (p99), the greatest first
    Late,
    /// By missed executions, the most first
    Missed,
    /// By name
    Name,
}

fn interval(text: &str) -> Result<Duration, String> {
    let every = parse_duration(text).map_err(|error| error.to_string())?;
    if every < SHORTEST { Err("expected at least 100ms".to_owned()) } else { Ok(every) }
}

pub(crate) fn top(arguments: &TopArguments) -> Exit {
    let client = match arguments.fleet.client() {
        Ok(client) => client,
        Err(exit) => return exit,
    };
    let feed = match Feed::of(client) {
        Ok(feed) => feed,
        Err(error) => return arguments.fleet.refuse(&error.to_string(), Exit::Failed),
    };
    // Before the terminal changes: a fleet that does not answer is an error as of any other command.
    feed.ask();
    let first = match feed.wait() {
        Ok(first) => first,
        Err(error) => return arguments.fleet.refuse(&error.to_string(), Exit::WrongInput),
    };
    if arguments.fleet.format == Format::Human && Terminal::is_there() {
        match Terminal::enter(&feed) {
            Ok(terminal) => return watched(arguments, &feed, first, terminal),
            Err(error) => {
                let message = format!("the terminal cannot be used: {error}");
                return arguments.fleet.refuse(&message, Exit::Failed);
            }
        }
    }
    printed(arguments, &feed, first)
}

/// One table after the other, or one line of JSON.
fn printed(arguments: &TopArguments, feed: &Feed, mut answer: Value) -> Exit {
    let (mut due, mut left) = (Instant::now(), arguments.number.unwrap_or(u64::MAX));
    loop {
        sort(&mut answer, arguments.sort);
        match arguments.fleet.format {
            Format::Json => print_json_line(&answer),
            Format::Human => print(&format!("{}\n", Picture::of(&answer).whole())),
        }
        left -= 1;
        if left == 0 || has_failed() {
            return Exit::Done;
        }
        due = next(due, arguments.every);
        while let Some(time) = due.checked_duration_since(Instant::now()).filter(|time| !time.is_zero()) {
            // Who reads no more, as `head`, is noticed at once.
            std::thread::sleep(time.min(SHORTEST));
            if !has_reader() {
                return Exit::Done;
            }
        }
        feed.ask();
        answer = match feed.wait() {
            Ok(answer) => answer,
            Err(error) => return ended(arguments, &error),
        };
    }
}

/// A table that fills the terminal.
fn watched(arguments: &TopArguments, feed: &Feed, mut answer: Value, mut terminal: Terminal) -> Exit {
    let (mut by, mut due) = (arguments.sort, Instant::now() + arguments.every);
    let (mut taken, mut is_asked) = (1, false);
    loop {
        sort(&mut answer, by);
        let (rows, columns) = terminal.size();
        if terminal.show(&Picture::of(&answer).within(rows, columns)).is_err() {
            return Exit::Failed;
        }
        if arguments.number == Some(taken) {
            return Exit::Done;
        }
        let left = (!is_asked).then(|| due.saturating_duration_since(Instant::now()));
        match terminal.wait(left) {
            Input::End(exit) => return exit,
            Input::Sort(key) => by = key,
            Input::Changed => {}
            Input::Time => {
                is_asked = true;
                feed.ask();
            }
            Input::Woken => match feed.next() {
                Some(Ok(new)) => {
                    (answer, is_asked) = (new, false);
                    taken += 1;
                    due = next(due, arguments.every);
                }
                Some(Err(error)) => {
                    drop(terminal);
                    let exit = ended(arguments, &error);
                    if exit == Exit::Done {
                        print("the fleet has ended\n");
                    }
                    return exit;
                }
                // A signal: the window may have another size.
                None => {}
            },
        }
    }
}

/// The end of a fleet that answered before is no error of who watches it.
fn ended(arguments: &TopArguments, error: &ClientError) -> Exit {
    match error {
        ClientError::Refused(reason) => arguments.fleet.refuse(reason, Exit::WrongInput),
        ClientError::NotReached(..) | ClientError::Malformed(_) => Exit::Done,
    }
}

/// The time of the next refresh: what was too slow for one is not made up for.
fn next(due: Instant, every: Duration) -> Instant {
    (due + every).max(Instant::now())
}

/// Sorts the components of an answer.
fn sort(answer: &mut Value, by: Option<Sort>) {
    let Some(by) = by else { return };
    let Some(components) = answer["status"]["components"].as_array_mut() else { return };
    let number = |value: &Value| std::cmp::Reverse(value.as_u64().unwrap_or_default());
    match by {
        Sort::Late => components.sort_by_key(|one| (number(&one["late_us"]["p99"]), number(&one["late_us"]["max"]))),
        Sort::Missed => components.sort_by_key(|one| number(&one["missed"])),
        Sort::Name => {
            components.sort_by_cached_key(|one| one_line(one["name"].as_str().unwrap_or_default()).into_owned())
        }
    }
}
