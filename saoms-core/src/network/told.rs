//! What happened to a network, for people.

use std::sync::Arc;

use saoms_api::Level;

use super::exchange::News;
use super::fleet::Membership;

/// Components that are named of a program that is not heard, at most.
const MOST_NAMED: usize = 3;

/// What is said of a program that is not heard.
fn unheard(name: &str, components: &[Arc<str>]) -> String {
    let text = format!("program `{name}` gives no sign of life");
    let named: Vec<String> = components.iter().take(MOST_NAMED).map(|one| format!("`{one}`")).collect();
    match components.len().saturating_sub(named.len()) {
        _ if named.is_empty() => text,
        0 => format!("{text}: nothing is heard of {}", named.join(", ")),
        more => format!("{text}: nothing is heard of {} and {more} more", named.join(", ")),
    }
}

/// Components with a word before them, such as `component `A` and 2 more`.
fn components(all: &[String]) -> String {
    match all {
        [] => "its components".to_owned(),
        [one] => format!("component `{one}`"),
        [first, rest @ ..] => format!("component `{first}` and {} more", rest.len()),
    }
}

/// What happened to the network of a program with this name, for people.
pub(super) fn told(news: &News, membership: &Membership, own: &str) -> (Level, String) {
    match news {
        News::Joined { name, .. } => (Level::Info, format!("program `{name}` is on the network")),
        News::GoesOn { name, .. } => {
            (Level::Info, format!("program `{name}` is on the network again, and goes on from its state"))
        }
        News::Older { name, topic, after } => (
            Level::Warning,
            format!(
                "program `{name}` goes on from an older state, without {after} messages on topic `{topic}` that were received: it \
                 has begun anew there"
            ),
        ),
        News::Left { name, .. } => (Level::Info, format!("program `{name}` has left the network")),
        News::Unreachable { name, components, .. } => (Level::Error, unheard(name, components)),
        News::Back { name, .. } => (Level::Info, format!("program `{name}` gives signs of life again")),
        News::GivenUp { name, count: 0, .. } => {
            (Level::Warning, format!("program `{name}` was away for so long that no more events are kept for it"))
        }
        News::GivenUp { name, count, .. } => (
            Level::Error,
            format!(
                "program `{name}` was away for so long that no more events are kept for it: {count} messages are lost for it, \
                 and those that follow until it is there again"
            ),
        ),
        News::NotKept { name, count } => (
            Level::Error,
            format!("{count} more messages are lost for program `{name}`, which were sent while it was away"),
        ),
        News::Replaced { name } => (
            Level::Info,
            format!("components of program `{name}` have begun in another program: nothing is kept for that one"),
        ),
        News::Stays { name, topic, count } => (
            Level::Warning,
            format!(
                "{count} messages of program `{name}` on topic `{topic}` have not arrived: they stay in its state folder, and come \
                 when it starts again"
            ),
        ),
        News::Unreceived { name, topic, count } => (
            Level::Error,
            format!("program `{name}` has not received {count} messages on topic `{topic}`, and this program ends"),
        ),
        News::Later { name, topic, count } => (
            Level::Warning,
            format!(
                "program `{name}` has not received {count} messages on topic `{topic}`: they stay in the state folder, and it \
                 receives them when this program starts again"
            ),
        ),
        News::Superseded { component, name } => (
            Level::Error,
            format!(
                "component `{component}` runs in program `{name}` by now, which began while this one was not heard: this one ends, \
                 since a component runs once in a fleet"
            ),
        ),
        News::Twice { component, name, .. } => (
            Level::Error,
            format!(
                "component `{component}` runs in program `{name}`, and in another one: the messages of the one that began first are ignored; a component \
                 runs once in a fleet"
            ),
        ),
        News::Anew { component, name, after, .. } => (
            Level::Warning,
            format!("component `{component}` has begun anew in program `{name}`, after {after} messages"),
        ),
        News::Differs { name, component, topic, .. } => (
            Level::Error,
            format!(
                "component `{component}` of program `{name}` sends other messages on topic `{topic}` of the network `{}` than {} of this \
                 program, `{own}`, reads there: they are ignored; build both programs from one version",
                membership.url,
                components(&membership.readers(topic))
            ),
        ),
        News::Lost { name, topic, count, .. } => (
            Level::Error,
            format!("{count} messages of program `{name}` on topic `{topic}` are lost: it does not have them any more"),
        ),
        News::Overflow { topic, count } => (
            Level::Error,
            format!(
                "{count} messages on topic `{topic}` are lost for programs that did not receive them in time: too many \
                 waited for them"
            ),
        ),
    }
}
