//! JSON-RPC over standard input and output, framed as the Language Server Protocol says.
//!
//! The types of messages are those of `lsp-server`. Reading is done here, since what is malformed is to be answered,
//! and not to end the session.

use std::io::{self, BufRead, Read, Write};

use lsp_server::{ErrorCode, Message};
use serde::Serialize;
use serde_json::{Value, json};

/// The longest message in bytes; files above it are refused anyway.
const LONGEST: u64 = 1 << 30;
/// The longest line of a header.
const LONGEST_HEADER: u64 = 4096;
const LENGTH: &str = "content-length:";

/// An incoming message.
#[derive(Debug)]
pub(super) enum Incoming {
    /// A message.
    Message(Message),
    /// Something that is none, with the answer to it.
    Malformed(Value),
}

/// Reads what comes next; `None` at the end of the input.
///
/// # Errors
/// The input cannot be read, or ends within a message.
pub(super) fn read(input: &mut impl BufRead) -> io::Result<Option<Incoming>> {
    let Some(length) = length(input)? else { return Ok(None) };
    let mut bytes = Vec::new();
    let is_too_long = length > LONGEST;
    // Memory is taken for what comes, not for what is promised.
    let found = match is_too_long {
        true => io::copy(&mut input.take(length), &mut io::sink())?,
        false => input.take(length).read_to_end(&mut bytes)? as u64,
    };
    match found == length {
        false => Err(io::ErrorKind::UnexpectedEof.into()),
        true if is_too_long => Ok(Some(refusal(Value::Null, ErrorCode::InvalidRequest, "the message is too long"))),
        true => Ok(Some(understood(&bytes))),
    }
}

/// The length of the next message. Lines that are no header are skipped, so that a broken message costs no more than
/// itself.
fn length(input: &mut impl BufRead) -> io::Result<Option<u64>> {
    let mut length = None;
    loop {
        let mut line = Vec::new();
        if input.take(LONGEST_HEADER).read_until(b'\n', &mut line)? == 0 {
            return Ok(None);
        }
        let line = String::from_utf8_lossy(&line).to_ascii_lowercase();
        if let Some(at) = line.rfind(LENGTH) {
            length = line[at + LENGTH.len()..].trim().parse().ok().or(length);
        } else if line.trim().is_empty()
            && let Some(length) = length
        {
            return Ok(Some(length));
        }
    }
}

fn understood(bytes: &[u8]) -> Incoming {
    let value: Value = match serde_json::from_slice(bytes) {
        Ok(value) => value,
        Err(error) => return refusal(Value::Null, ErrorCode::ParseError, &format!("not JSON: {error}")),
    };
    let id = value.get("id").cloned().unwrap_or_default();
    match serde_json::from_value(value) {
        // An identifier that is none makes a notification of a request.
        Ok(message) if id.is_null() || !matches!(message, Message::Notification(_)) => Incoming::Message(message),
        _ => {
            let what = "neither a request nor a response nor a notification";
            refusal(id, ErrorCode::InvalidRequest, what)
        }
    }
}

fn refusal(id: Value, code: ErrorCode, message: &str) -> Incoming {
    let error = json!({ "code": code as i32, "message": message });
    Incoming::Malformed(json!({ "jsonrpc": "2.0", "id": id, "error": error }))
}

/// Writes a message.
///
/// # Errors
/// The output cannot be written.
pub(super) fn write(output: &mut impl Write, message: &impl Serialize) -> io::Result<()> {
    let text = serde_json::to_string(message)?;
    write!(output, "Content-Length: {}\r\n\r\n{text}", text.len())?;
    output.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The messages read from this input, a line each.
    fn reads(input: &str) -> Vec<String> {
        let mut input = input.as_bytes();
        let mut all = Vec::new();
        loop {
            all.push(match read(&mut input) {
                Ok(Some(Incoming::Message(Message::Request(request)))) => {
                    format!("request {}", request.method)
                }
                Ok(Some(Incoming::Message(other))) => format!("{other:?}"),
                Ok(Some(Incoming::Malformed(answer))) => {
                    format!("{} for {}", answer["error"]["code"], answer["id"])
                }
                Ok(None) => return all,
                Err(error) => format!("ends: {:?}", error.kind()),
            });
        }
    }

    fn frame(text: &str) -> String {
        format!("Content-Length: {}\r\n\r\n{text}", text.len())
    }

    #[test]
    fn what_is_malformed_is_answered_and_the_next_message_read() {
        let good = frame(r#"{"jsonrpc":"2.0","id":1,"method":"ä"}"#);
        let says = |input: &str, expected: &[&str]| assert_eq!(reads(input), expected, "{input}");
        says("", &[]);
        says(&good, &["request ä"]);
        says(&format!("Content-Type: x\r\n{good}"), &["request ä"]);
        says(&format!("{}{good}", frame("{nonsense")), &["-32700 for null", "request ä"]);
        says(&format!("{}{good}", frame("[1, 2]")), &["-32600 for null", "request ä"]);
        says(&format!("{}{good}", frame(r#"{"id": 7}"#)), &["-32600 for 7", "request ä"]);
        says(&format!("{}{good}", frame(r#"{"id": 1.5, "method": "m"}"#)), &["-32600 for 1.5", "request ä"]);
        says(&format!("{{\"id\": 7}}\n\n{good}"), &["request ä"]);
        says(&format!("{{\"id\": 7}}{good}"), &["request ä"]);
        says("Content-Length: 99999999999999\r\n\r\n{}", &["ends: UnexpectedEof"]);
    }

    #[test]
    fn what_is_written_can_be_read() {
        let mut out = Vec::new();
        write(&mut out, &json!({ "id": 1, "method": "🤖" })).unwrap();
        assert_eq!(reads(&String::from_utf8(out).unwrap()), ["request 🤖"]);
    }
}
