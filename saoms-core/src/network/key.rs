//! The keys under which programs put what they say on a network.
//!
//! | key | what is there |
//! | --- | --- |
//! | `saoms/2/topic/TOPIC/COMPONENT` | messages of components: CDR, with an [`Envelope`](super::exchange::wire::Envelope) beside it |
//! | `saoms/2/topic/TOPIC/COMPONENT/X/Y` | the same of a state topic with places, that concern this cell of 16 by 16 blocks |
//! | `saoms/2/alive/PROGRAM` | signs of life |
//! | `saoms/2/begins/PROGRAM` | what this program says before its components begin |
//! | `saoms/2/runs/PROGRAM` | answers to it: which of these run elsewhere |
//! | `saoms/2/ask/PROGRAM` | requests to this program to send messages again |
//! | `saoms/2/again/PROGRAM/TOPIC` | messages that this program asked for |
//! | `saoms/2/covered/PROGRAM` | answers that say which states are outdated |
//! | `saoms/2/look/PROGRAM` | requests to this program for the states of cells |
//! | `saoms/2/around/PROGRAM/TOPIC` | answers to requests of this program |
//! | `saoms/2/call/PROGRAM` | calls of its components |
//! | `saoms/2/reply/PROGRAM` | answers to its calls |
//! | `saoms/2/control/ASKER` | requests of operators to programs |
//! | `saoms/2/controlled/ASKER` | answers to this one |
//! | `saoms/2/access` | what the router lets users do |
//!
//! A program is a number in hexadecimal digits. In names, whatever is not an ASCII letter, a digit, `-`, `_` or `.` is
//! written as `%` and two hexadecimal digits for each byte of its UTF-8 form.

use std::fmt::Write as _;

use saoms_api::extension::Topics;

use super::exchange::Keys;
use super::rights::Grant;
use super::transport::UserKeys;
use crate::bus::Cell;

/// What all keys begin with: the version of what is said.
pub const PREFIX: &str = "saoms/2";

/// The version of what is said.
pub const VERSION: &str = "2";

/// The version of the program that put something under a key.
pub fn version(key: &str) -> Option<&str> {
    key.strip_prefix("saoms/")?.split('/').next()
}

/// The keys of the signs of life of all programs, those of other versions among them.
pub fn alive_of_all() -> String {
    "saoms/*/alive/*".to_owned()
}

/// A name as a part of a key.
pub fn part(name: &str) -> String {
    let mut part = String::with_capacity(name.len());
    for byte in name.bytes() {
        if byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_' | b'.') {
            part.push(char::from(byte));
        } else {
            let _ = write!(part, "%{byte:02X}");
        }
    }
    if part.is_empty() { "%".to_owned() } else { part }
}

/// The name that a part of a key is for; `None` where it is for none.
pub fn name(part: &str) -> Option<String> {
    if part == "%" {
        return Some(String::new());
    }
    let mut bytes = Vec::with_capacity(part.len());
    let mut rest = part.bytes();
    while let Some(byte) = rest.next() {
        if byte != b'%' {
            bytes.push(byte);
            continue;
        }
        let mut digit = || char::from(rest.next()?).to_digit(16);
        let (high, low) = (digit()?, digit()?);
        bytes.push(u8::try_from(high * 16 + low).ok()?);
    }
    String::from_utf8(bytes).ok()
}

/// The key of the messages of a component on a topic, or of those that concern a cell.
pub fn topic(topic: &str, component: &str, cell: Option<Cell>) -> String {
    let key = format!("{PREFIX}/topic/{}/{}", part(topic), part(component));
    match cell {
        Some((x, y)) => format!("{key}/{x}/{y}"),
        None => key,
    }
}

/// The keys of all messages on a topic.
pub fn of_topic(topic: &str) -> String {
    format!("{PREFIX}/topic/{}/**", part(topic))
}

/// The keys of those messages that a program asks for.
pub fn asked(keys: &Keys, program: u64) -> String {
    match keys {
        Keys::All(topic) => of_topic(topic),
        Keys::Elsewhere(topic) => format!("{PREFIX}/topic/{}/*", part(topic)),
        Keys::Cell(topic, (x, y)) => format!("{PREFIX}/topic/{}/*/{x}/{y}", part(topic)),
        Keys::Again(topic) => again(program, topic),
        Keys::Around(topic) => around(program, topic),
    }
}

/// The key of requests to a program for the states of cells.
pub fn look(program: u64) -> String {
    format!("{PREFIX}/look/{program:x}")
}

/// The key of answers to these requests of a program.
pub fn around(program: u64, topic: &str) -> String {
    format!("{PREFIX}/around/{program:x}/{}", part(topic))
}

/// The key of the signs of life of a program.
pub fn alive(program: u64) -> String {
    format!("{PREFIX}/alive/{program:x}")
}

/// The key of what a program says before its components begin.
pub fn begins(program: u64) -> String {
    format!("{PREFIX}/begins/{program:x}")
}

/// The keys of what all programs say then.
pub fn begins_of_all() -> String {
    format!("{PREFIX}/begins/*")
}

/// The key of answers to it.
pub fn runs(program: u64) -> String {
    format!("{PREFIX}/runs/{program:x}")
}

/// The key of requests to a program.
pub fn ask(program: u64) -> String {
    format!("{PREFIX}/ask/{program:x}")
}

/// The key of messages of a topic that a program asked for.
pub fn again(program: u64, topic: &str) -> String {
    format!("{PREFIX}/again/{program:x}/{}", part(topic))
}

/// The key of what the router lets users do.
pub fn access() -> String {
    format!("{PREFIX}/access")
}

/// The key of requests of who has this number.
pub fn control(asker: u64) -> String {
    format!("{PREFIX}/control/{asker:x}")
}

/// The keys of the requests of all.
pub fn control_of_all() -> String {
    format!("{PREFIX}/control/*")
}

/// The key of answers to who has this number.
pub fn controlled(asker: u64) -> String {
    format!("{PREFIX}/controlled/{asker:x}")
}

/// The keys that a user may use who is granted this.
pub fn of_user(Grant { access, calls: may_call }: &Grant) -> UserKeys {
    let names = |topics: &Topics| match topics {
        Topics::All => vec!["*".to_owned()],
        Topics::Some(names) => names.iter().map(|name| part(name)).collect(),
    };
    // Everybody is there, asks and answers.
    let common = || {
        let asked = ["begins", "runs", "ask", "covered", "look"].map(|what| format!("{PREFIX}/{what}/*"));
        [alive_of_all()].into_iter().chain(asked)
    };
    let of = |topics: &Topics| {
        let of_topic = |name: &String| {
            let answers = ["again", "around"].map(|what| format!("{PREFIX}/{what}/*/{name}"));
            [format!("{PREFIX}/topic/{name}/**")].into_iter().chain(answers)
        };
        common().chain(names(topics).iter().flat_map(of_topic)).collect::<Vec<String>>()
    };
    let (mut put, mut subscribe) = (of(&access.writes), of(&access.reads));
    subscribe.push(self::access());
    // A call can do anything, and an answer says what was done: both are for who may everything, and for the nodes
    // whose components call others.
    let calls = [format!("{PREFIX}/call/*"), format!("{PREFIX}/reply/*")];
    if *may_call {
        put.extend(calls.clone());
        subscribe.extend(calls);
    }
    // Each program can be asked, and answers.
    subscribe.push(control_of_all());
    put.push(format!("{PREFIX}/controlled/*"));
    if access.controls {
        put.push(control_of_all());
        subscribe.push(format!("{PREFIX}/controlled/*"));
    }
    UserKeys { user: access.user.clone(), put, subscribe }
}

/// The key of answers to a program about states.
pub fn covered(program: u64) -> String {
    format!("{PREFIX}/covered/{program:x}")
}

/// The key of calls of components of a program.
pub fn call(program: u64) -> String {
    format!("{PREFIX}/call/{program:x}")
}

/// The key of answers to calls of a program.
pub fn reply(program: u64) -> String {
    format!("{PREFIX}/reply/{program:x}")
}

#[cfg(test)]
mod tests {
    use super::{name, part};

    #[test]
    fn any_name_is_a_part_of_a_key_and_back() {
        for text in ["POSTOPIC", "Event luggage MS", "hall/Robot001", "", "50%", "größe", "*", "a$b#c?"] {
            let part = part(text);
            assert!(!part.contains(['/', '*', '$', '#', '?', ' ']) && !part.is_empty(), "{part}");
            assert_eq!(name(&part).as_deref(), Some(text));
        }
        assert_eq!(name("a%2"), None);
        assert_eq!(name("%FF"), None);
    }
}
