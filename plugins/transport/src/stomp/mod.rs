//! STOMP 1.2.
//!
//! A key `saoms/2/topic/A/B` is the destination `/topic/saoms.2.topic.A.B`. A message has the header `saoms` where
//! something is said beside it: the number of bytes of that, which stand at the end of the body; and `saoms-from`, by
//! which a program knows what it has sent itself. Nothing is kept by the broker: what it drops is sent again by the
//! program.

mod frame;

use std::io::BufRead;

use frame::Frame;

use crate::language::{Ended, Heard, Language, Message};
use crate::link::Link;
use crate::settings::Settings;

/// The header that tells how long what is said beside a message is.
const BESIDE: &str = "saoms";
/// The header with the name of the program that sends.
const FROM: &str = "saoms-from";
/// The destination at which a program tries whether it may send.
const TRIAL: &str = "/topic/saoms.joins";
/// How destinations of the fleet begin.
const TOPIC: &str = "/topic/";
/// Time without a word of a program after which the broker gives it up, and between two words of the broker, in
/// milliseconds.
const HEART_BEAT: &str = "10000,1000";
/// How a broker deals with a program that does not read, in the words of ActiveMQ: it keeps a part, drops the rest, and
/// lets no other program wait. Without that, one program that was stopped would hold up all that send.
const SLOW: &str = "activemq.prefetchSize:1000\nactivemq.maximumPendingMessageLimit:10000\nactivemq.noLocal:true";

/// A connection to a broker that speaks STOMP 1.2.
#[derive(Debug)]
pub struct Stomp;

impl Language for Stomp {
    const BROKER: &'static str = "a broker with STOMP";
    const NAME: &'static str = "STOMP";
    const WITH_TLS: &'static str = "stomp+ssl";
    const NO_ROUTER: &'static str = "a broker with STOMP is a program of its own, with users and access of its own, which a fleet joins and \
        does not start: leave this component out, start a broker, such as ActiveMQ with a connector `stomp://0.0.0.0:61613`, and name \
        it in the `url` of the components (docs/brokers.md)";
    const BEAT: &'static [u8] = b"\n";
    const BYE: &'static [u8] = b"DISCONNECT\n\n\0";

    fn join(settings: &Settings, _name: &str, from: &mut impl BufRead, to: &Link) -> Result<Stomp, Ended> {
        let mut connect = format!("CONNECT\naccept-version:1.2\nhost:{}\nheart-beat:{HEART_BEAT}\n", settings.host());
        // What is said first is written as it is; that each is one line was judged.
        for (header, value) in [("login", &settings.user), ("passcode", &settings.password)] {
            connect.extend(value.iter().map(|value| format!("{header}:{value}\n")));
        }
        to.write_all((connect + "\n\0").as_bytes())?;
        let first = from.fill_buf()?;
        if first.first().is_some_and(|byte| !b"CE\n\r".contains(byte)) {
            return Err(Ended::Foreign(first.to_owned()));
        }
        let answer = Frame::read(from)?;
        match answer.command() {
            "CONNECTED" => {}
            "ERROR" => {
                let why = answer.why();
                return Err(match why.to_ascii_lowercase() {
                    why if why.contains("password") || why.contains("credential") || why.contains("authent") => {
                        Ended::no_account(settings)
                    }
                    _ => Ended::Refused(format!("the broker refuses the program: {why}")),
                });
            }
            _ => return Err(Ended::Foreign(answer.command().as_bytes().to_owned())),
        }
        if answer.header("version").is_none_or(|version| version != "1.2") {
            return Err(Ended::Refused("the broker does not speak STOMP 1.2, but an earlier version".to_owned()));
        }
        if !settings.is_of_fleet {
            return Ok(Stomp);
        }
        to.write_all(format!("SEND\ndestination:{TRIAL}\nreceipt:joins\ncontent-length:0\n\n\0").as_bytes())?;
        match Frame::read(from)? {
            answer if answer.command() == "ERROR" => Err(refused(settings, &answer)),
            _ => Ok(Stomp),
        }
    }

    fn longest(&self) -> usize {
        frame::LONGEST
    }

    fn put(name: &str, message: Message<'_>) -> Result<Vec<u8>, String> {
        let Message { key, message: bytes, attachment } = message;
        let length = bytes.len() + attachment.len();
        if length > frame::LONGEST {
            return Err(format!("no message above {} bytes is sent over STOMP", frame::LONGEST));
        }
        let mut frame = format!("SEND\ndestination:{}\n{FROM}:{name}\n", destination(key)?);
        if !attachment.is_empty() {
            frame += &format!("{BESIDE}:{}\n", attachment.len());
        }
        frame += &format!("content-length:{length}\n\n");
        let mut frame = frame.into_bytes();
        frame.reserve_exact(length + 1);
        message.write(&mut frame);
        frame.push(0);
        Ok(frame)
    }

    fn subscribe(number: u16, keys: &str) -> Result<Vec<u8>, String> {
        let destination = destination(keys)?;
        Ok(format!("SUBSCRIBE\nid:{number}\ndestination:{destination}\n{SLOW}\n\n\0").into_bytes())
    }

    fn unsubscribe(number: u16, _keys: &str) -> Vec<u8> {
        format!("UNSUBSCRIBE\nid:{number}\n\n\0").into_bytes()
    }

    fn hear(&mut self, name: &str, from: &mut impl BufRead) -> Result<Heard, Ended> {
        let frame = Frame::read(from)?;
        match frame.command() {
            "MESSAGE" => {
                // A broker that is not ActiveMQ sends a program its own, too.
                if frame.header(FROM).is_some_and(|from| from == name) {
                    return Ok(Heard::Other);
                }
                let number = frame.header("subscription").and_then(|number| number.parse().ok());
                let attachment = frame.header(BESIDE).map_or(Ok(0), |length| length.parse());
                let key = frame.header("destination").and_then(|destination| key(&destination));
                match (number, attachment, key) {
                    (Some(number), Ok(attachment), Some(key)) => {
                        Ok(Heard::Message { number, key, bytes: frame.into_body(), attachment })
                    }
                    _ => Ok(Heard::Other),
                }
            }
            "ERROR" => Err(Ended::Refused(format!("the broker says: {}", frame.why()))),
            _ => Ok(Heard::Other),
        }
    }
}

/// Why a broker does not let a program send.
fn refused(settings: &Settings, answer: &Frame) -> Ended {
    let why = answer.why();
    if why.contains("not authorized") {
        Ended::no_right(settings)
    } else {
        Ended::Refused(format!("the broker says: {why}"))
    }
}

/// The destination of keys: parts stand between `.`, so that a `.` in one is written as `%2E`; `*` is one part in both,
/// and `**` at the end is `>`.
fn destination(keys: &str) -> Result<String, String> {
    let mut all = TOPIC.to_owned();
    for (place, part) in keys.split('/').enumerate() {
        if place > 0 {
            all.push('.');
        }
        match part {
            "*" => all.push('*'),
            "**" => all.push('>'),
            _ if part.contains("%2E")
                || !part.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-_.%".contains(&byte)) =>
            {
                return Err(format!("`{}` cannot be a destination", keys.escape_debug()));
            }
            _ => all += &part.replace('.', "%2E"),
        }
    }
    Ok(all)
}

/// The key of a destination, if it has one.
fn key(destination: &str) -> Option<String> {
    Some(destination.strip_prefix(TOPIC)?.replace('.', "/").replace("%2E", "."))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_destinations_and_back() {
        for (keys, expected) in [
            (
                "saoms/2/topic/Event%20luggage%20MS/hall%2FRobot.1",
                "saoms.2.topic.Event%20luggage%20MS.hall%2FRobot%2E1",
            ),
            ("saoms/*/alive/*", "saoms.*.alive.*"),
            ("saoms/2/topic/A/**", "saoms.2.topic.A.>"),
        ] {
            assert_eq!(destination(keys).unwrap(), format!("/topic/{expected}"));
        }
        let whole = "saoms/2/topic/A%252E/hall%2FRobot.1";
        assert_eq!(key(&destination(whole).unwrap()).unwrap(), whole);
        for wrong in ["a b", "a/%2E", "a>", "a,b", "a?b"] {
            assert!(destination(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_message_arrives_as_it_was_put_but_not_at_its_sender() {
        let message = Message { key: "saoms/2/topic/A/B", message: b"C\0DR\n", attachment: b"envelope" };
        let sent = String::from_utf8(Stomp::put("me", message).unwrap()).unwrap();
        let arrives = sent.replace("SEND\n", "\n\nMESSAGE\nsubscription:7\n");
        let heard = Stomp.hear("other", &mut arrives.as_bytes()).unwrap();
        let bytes = b"C\0DR\nenvelope".to_vec();
        assert_eq!(heard, Heard::Message { number: 7, key: message.key.to_owned(), bytes, attachment: 8 });
        assert_eq!(Stomp.hear("me", &mut arrives.as_bytes()).unwrap(), Heard::Other);
    }

    #[test]
    fn no_bytes_do_harm() {
        let whole = Stomp::put("me", Message { key: "a/b", message: b"m", attachment: b"xy" }).unwrap();
        for end in 0..whole.len() {
            for byte in [0, b'\n', b'\r', b':', b'\\', b'9', 255] {
                let mut bytes = whole.clone();
                bytes[end] = byte;
                let _ = Stomp.hear("", &mut bytes.as_slice());
                let _ = Stomp.hear("", &mut &bytes[..end]);
            }
        }
    }
}
