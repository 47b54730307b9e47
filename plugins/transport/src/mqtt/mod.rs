//! MQTT 5.
//!
//! A key of the fleet is a topic. A message has the user property `saoms` where something is said beside it: the number
//! of bytes of that, which stand at the end of the payload. Everything goes at quality of service 0: what a broker
//! drops is sent again by the program, which also numbers, orders and keeps; the acknowledgements of MQTT say nothing
//! of the readers.

mod packet;

use std::io::BufRead;

use packet::{Kind, Packet, Properties};

use crate::language::{Ended, Heard, Language, Message};
use crate::link::Link;
use crate::settings::Settings;

/// The name of the property that tells how long what is said beside a message is.
const BESIDE: &str = "saoms";
/// The topic at which a program tries whether it may send.
const TRIAL: &str = "saoms/joins";
/// Time without a word of a program after which the broker gives it up, in seconds.
const KEEP_ALIVE: u16 = 10;
/// Options of a subscription: quality of service 0, nothing that the program itself sends, nothing that is retained.
const OPTIONS: u8 = 0x04 | 0x20;

/// A connection to a broker that speaks MQTT 5.
#[derive(Debug)]
pub struct Mqtt {
    longest: usize,
}

impl Language for Mqtt {
    const BROKER: &'static str = "an MQTT broker";
    const NAME: &'static str = "MQTT";
    const WITH_TLS: &'static str = "mqtts";
    const NO_ROUTER: &'static str = "an MQTT broker is a program of its own, with users and access of its own, which a fleet joins and does \
        not start: leave this component out, start a broker, such as `mosquitto -c FILE`, and name it in the `url` of the components \
        (docs/brokers.md)";
    const BEAT: &'static [u8] = &[0xc0, 0];
    const BYE: &'static [u8] = &[0xe0, 0];

    fn join(settings: &Settings, name: &str, from: &mut impl BufRead, to: &Link) -> Result<Mqtt, Ended> {
        to.write_all(&connect(settings, name))?;
        let first = from.fill_buf()?;
        if first.first().is_some_and(|byte| *byte != 0x20) {
            return Err(Ended::Foreign(first.to_owned()));
        }
        let answer = Packet::read(from)?;
        let mut rest = answer.body();
        let (_, code) = (rest.byte()?, rest.byte()?);
        if code != 0 {
            return Err(match code {
                // 1 is what brokers of earlier versions answer.
                0x01 | 0x84 => Ended::Refused(
                    "the broker does not speak MQTT 5, but an earlier version: take one that does, such as mosquitto \
                     from 1.6 on"
                        .to_owned(),
                ),
                0x04 | 0x05 | 0x86 | 0x87 | 0x8c => Ended::no_account(settings),
                0x03 | 0x88 | 0x89 | 0x97 | 0x9f => {
                    Ended::NotNow(format!("the broker cannot serve this program now (MQTT: 0x{code:02x})"))
                }
                _ => Ended::Refused(format!("the broker refuses the program (MQTT: 0x{code:02x})")),
            });
        }
        let properties = rest.properties()?;
        if settings.is_of_fleet && properties.has_no_wildcards {
            return Err(Ended::Refused("the broker has no subscriptions with `+` and `#`, which a fleet needs".into()));
        }
        if settings.is_of_fleet && !properties.has_quality_0_alone {
            // Of messages that it may not send, a program is told at quality of service 1 alone.
            to.write_all(&publish(TRIAL, None, &[], Some(1)))?;
            let answer = Packet::read(from)?;
            let mut rest = answer.body();
            rest.skip(2)?;
            if answer.kind() == Kind::PublishAck && rest.byte().unwrap_or_default() >= 0x80 {
                return Err(Ended::no_right(settings));
            }
        }
        let longest = properties.longest.map_or(packet::LONGEST, |longest| longest.min(packet::LONGEST));
        Ok(Mqtt { longest })
    }

    fn longest(&self) -> usize {
        self.longest
    }

    fn put(_name: &str, message: Message<'_>) -> Result<Vec<u8>, String> {
        let Message { key, message: bytes, attachment } = message;
        if key.len() > usize::from(u16::MAX) || key.contains(['+', '#', '\0']) {
            return Err(format!("`{}` cannot be the topic of a message", key.escape_debug()));
        }
        if bytes.len() + attachment.len() + key.len() + 64 > packet::LONGEST {
            return Err(format!("MQTT has no message above {} bytes", packet::LONGEST));
        }
        let beside = (!attachment.is_empty()).then_some(attachment.len());
        Ok(publish(key, beside, &[bytes, attachment], None))
    }

    fn subscribe(number: u16, keys: &str) -> Result<Vec<u8>, String> {
        let filter = filter(keys);
        if filter.len() > usize::from(u16::MAX) {
            return Err("the keys are too long".to_owned());
        }
        let mut body = number.to_be_bytes().to_vec();
        body.push(0);
        packet::text(&mut body, &filter);
        body.push(OPTIONS);
        Ok(packet::framed(0x82, &body))
    }

    fn unsubscribe(number: u16, keys: &str) -> Vec<u8> {
        let mut body = number.to_be_bytes().to_vec();
        body.push(0);
        packet::text(&mut body, &filter(keys));
        packet::framed(0xa2, &body)
    }

    fn hear(&mut self, _name: &str, from: &mut impl BufRead) -> Result<Heard, Ended> {
        let packet = Packet::read(from)?;
        let mut rest = packet.body();
        match packet.kind() {
            Kind::Publish { has_number } => {
                let key = rest.text()?.to_owned();
                if has_number {
                    rest.skip(2)?;
                }
                let Properties { beside, .. } = rest.properties()?;
                // No subscription has its number at an MQTT broker: those fit whose keys do.
                Ok(Heard::Message { number: 0, key, bytes: rest.rest().to_owned(), attachment: beside })
            }
            Kind::SubscribeAck => {
                let number = u16::from_be_bytes([rest.byte()?, rest.byte()?]);
                rest.properties()?;
                match rest.byte()? {
                    0x80.. => Err(Ended::NotRead(number)),
                    _ => Ok(Heard::Other),
                }
            }
            Kind::Disconnect => Err(match rest.byte().unwrap_or_default() {
                0x8b => Ended::NotNow("the broker ends".to_owned()),
                0x8d => Ended::NotNow("the broker has heard nothing of this program for too long".to_owned()),
                code => Ended::NotNow(format!("the broker ends the connection (MQTT: 0x{code:02x})")),
            }),
            _ => Ok(Heard::Other),
        }
    }
}

/// What a program says first: that it begins anew, as who.
fn connect(settings: &Settings, name: &str) -> Vec<u8> {
    let mut body = Vec::new();
    packet::text(&mut body, "MQTT");
    let (user, password) = (settings.user.as_deref(), settings.password.as_deref());
    let flags = 0x02 | if user.is_some() { 0x80 } else { 0 } | if password.is_some() { 0x40 } else { 0 };
    body.extend([5, flags]);
    body.extend(KEEP_ALIVE.to_be_bytes());
    body.push(0);
    packet::text(&mut body, name);
    user.iter().chain(password.iter()).for_each(|text| packet::text(&mut body, text));
    packet::framed(0x10, &body)
}

/// A message; with a number it is acknowledged.
fn publish(topic: &str, beside: Option<usize>, parts: &[&[u8]], number: Option<u16>) -> Vec<u8> {
    let mut properties = Vec::new();
    if let Some(length) = beside {
        properties.push(packet::USER_PROPERTY);
        packet::text(&mut properties, BESIDE);
        packet::text(&mut properties, &length.to_string());
    }
    let mut head = Vec::with_capacity(64 + topic.len());
    packet::text(&mut head, topic);
    head.extend(number.iter().flat_map(|number| number.to_be_bytes()));
    packet::variable(&mut head, properties.len());
    head.extend(properties);
    let length = head.len() + parts.iter().map(|part| part.len()).sum::<usize>();
    let mut all = Vec::with_capacity(length + 5);
    all.push(if number.is_some() { 0x32 } else { 0x30 });
    packet::variable(&mut all, length);
    all.extend(head);
    parts.iter().for_each(|part| all.extend_from_slice(part));
    all
}

/// The filter of keys: `*` for one part is `+`, and `**` at the end is `#`.
fn filter(keys: &str) -> String {
    let parts = keys.split('/').map(|part| match part {
        "*" => "+",
        "**" => "#",
        part => part,
    });
    parts.collect::<Vec<_>>().join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_arrives_as_it_was_put() {
        let message = Message { key: "saoms/2/topic/A/B", message: b"CDR", attachment: b"envelope" };
        let sent = Mqtt::put("", message).unwrap();
        let mut mqtt = Mqtt { longest: 0 };
        let heard = mqtt.hear("", &mut sent.as_slice()).unwrap();
        let bytes = b"CDRenvelope".to_vec();
        assert_eq!(heard, Heard::Message { number: 0, key: message.key.to_owned(), bytes, attachment: 8 });
        assert!(Mqtt::put("", Message { key: "a/+", ..message }).is_err());
    }

    #[test]
    fn keys_that_may_not_be_read_are_known_by_their_number() {
        let heard = Mqtt { longest: 0 }.hear("", &mut &[0x90, 4, 1, 2, 0, 0x87][..]);
        assert!(matches!(heard, Err(Ended::NotRead(0x102))), "{heard:?}");
    }

    #[test]
    fn parts_of_keys_are_levels_of_topics() {
        assert_eq!(filter("saoms/*/alive/*"), "saoms/+/alive/+");
        assert_eq!(filter("saoms/2/topic/A%20B/**"), "saoms/2/topic/A%20B/#");
    }

    /// A broker may say anything.
    #[test]
    fn no_bytes_do_harm() {
        let whole = Mqtt::put("", Message { key: "a/b", message: b"m", attachment: b"xy" }).unwrap();
        for end in 0..whole.len() {
            for byte in 0..=255 {
                let mut bytes = whole.clone();
                bytes[end] = byte;
                let _ = Mqtt { longest: 0 }.hear("", &mut bytes.as_slice());
                let _ = Mqtt { longest: 0 }.hear("", &mut &bytes[..end]);
            }
        }
    }
}
