//! Calls of services of the web, over HTTP with JSON.

use std::collections::HashMap;
use std::fmt;
use std::time::Instant;

use saoms_core::web::{WebCall, WebClient, WebError};
use saoms_lang::model::WebPath;
use serde_json::Value;

use crate::http::{self, Head, Patience};
use crate::token::Token;

/// The most bytes of a reply.
const LONGEST: usize = 4 << 20;
/// Characters of an answer that a message shows, at most.
const SHOWN: usize = 200;

/// The client of a fleet for services of the web: a `POST` for each call, with the operation behind the path of the
/// service, and the arguments as JSON. A connection serves one call.
#[derive(Default)]
pub struct HttpClient {
    /// By the names of environment variables.
    tokens: HashMap<String, Token>,
}

impl fmt::Debug for HttpClient {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("HttpClient").field("tokens", &self.tokens.keys()).finish()
    }
}

impl HttpClient {
    /// A client with the tokens in environment variables, by the names of these.
    pub fn new(tokens: HashMap<String, Token>) -> HttpClient {
        HttpClient { tokens }
    }

    /// The token in an environment variable.
    fn token(&self, name: &str) -> Result<&Token, WebError> {
        // Without it, the server would be asked in the name of somebody else.
        self.tokens.get(name).ok_or_else(|| {
            WebError::Failed(format!(
                "is not called: the environment variable `{name}` was not read when the run began"
            ))
        })
    }
}

impl WebClient for HttpClient {
    fn call(&self, call: &WebCall<'_>) -> Result<Value, WebError> {
        let address = &call.target.address;
        let path = format!("{}/{}", address.target.trim_end_matches('/'), WebPath::part(&call.operation.name));
        let token = call.target.token_env.as_deref().map(|name| self.token(name)).transpose()?;
        let request = http::post(address, &path, token, &call.arguments.to_string());
        let answer = http::places(address).and_then(|places| {
            let patience = Patience { until: Instant::now() + call.deadline, is_cancelled: call.is_cancelled };
            let mut exchange = http::send(&places, request.as_bytes(), patience)?;
            let head = exchange.head()?;
            let body = exchange.body(&head, LONGEST)?;
            Ok((head, body))
        });
        match answer {
            Ok((head, body)) => judged(call, &head, &body),
            Err(error) => Err(http::reason(&error).map_or(WebError::Late, WebError::Failed)),
        }
    }
}

/// The reply in an answer.
fn judged(call: &WebCall<'_>, head: &Head, body: &[u8]) -> Result<Value, WebError> {
    let name = &call.operation.name;
    match head.status {
        200..=299 if !call.operation.has_reply() => Ok(Value::Null),
        200..=299 => serde_json::from_slice(body).map_err(|error| {
            let kind = head.header("content-type").map(|kind| format!(" ({})", shown(kind))).unwrap_or_default();
            let found = String::from_utf8_lossy(body);
            let found = if body.is_empty() { "nothing".to_owned() } else { format!("`{}`", shown(&found)) };
            WebError::Failed(format!("answers `{name}` with {found}{kind}, which is not JSON: {error}"))
        }),
        429 | 503 if head.header("retry-after").is_some() => Err(WebError::Busy),
        status => {
            let mut why = format!("answers `{name}` with the status {status}");
            if (300..400).contains(&status) {
                why += ": write the address to which it redirects";
            } else if let Some(text) = said(body) {
                why = format!("{why}: {}", shown(&text));
            }
            Err(WebError::Failed(why))
        }
    }
}

/// What an answer says of a failure, in the ways in which servers say it; problem details (RFC 9457) come first.
fn said(body: &[u8]) -> Option<String> {
    let value: Value = serde_json::from_slice(body).ok()?;
    ["detail", "error", "message", "title"].into_iter().find_map(|name| value[name].as_str().map(str::to_owned))
}

/// A text on one line, which loses its end if it is long.
fn shown(text: &str) -> String {
    let line: String = text.chars().take(SHOWN).map(|letter| if letter.is_control() { ' ' } else { letter }).collect();
    if text.chars().count() > SHOWN { format!("{line}...") } else { line }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use std::net::TcpListener;
    use std::time::Duration;

    use saoms_lang::OperationSchema;
    use saoms_lang::assembly::WebTarget;
    use saoms_lang::model::{AddressHelp, HttpAddress};
    use saoms_lang::source::{FileId, Span};
    use serde_json::json;

    use super::*;

    #[test]
    fn a_server_that_is_to_get_a_token_is_never_called_without_it() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        listener.set_nonblocking(true).unwrap();
        let url = format!("http://{}/a", listener.local_addr().unwrap());
        let target = WebTarget {
            address: HttpAddress::parse(&url, &AddressHelp::SERVICES).unwrap(),
            token_env: Some("TOKEN".to_owned()),
            operations: [].into(),
            place: Span::empty(0).in_file(FileId(0)),
        };
        let operation = OperationSchema::of(&json!({"name": "clear", "arguments": []}), 0).unwrap();
        let arguments = json!({});
        let deadline = Duration::from_secs(20);
        let call = WebCall {
            target: &target,
            operation: &operation,
            arguments: &arguments,
            deadline,
            is_cancelled: &|| false,
        };
        let why = "is not called: the environment variable `TOKEN` was not read when the run began";
        assert_eq!(HttpClient::default().call(&call), Err(WebError::Failed(why.to_owned())));
        assert!(listener.accept().is_err(), "nothing came");
    }
}
