//! Alerts by HTTP: a request for each change, on a connection of its own.

use std::io::{self, ErrorKind};
use std::time::{Duration, Instant};

use saoms_lang::model::HttpAddress;

use super::delivery::{End, Failed};
use crate::http::{self, Patience};
use crate::token::Token;

/// Time for a request, without the look-up of its name.
const PATIENCE: Duration = Duration::from_secs(5);

/// Posts a text of JSON; `Err` says why nobody took it.
pub(super) fn post(address: &HttpAddress, token: Option<&Token>, body: &str, end: &End) -> Result<(), Failed> {
    let failed = |error: io::Error| Failed::ForNow(reason(&error));
    let places = http::places(address).map_err(failed)?;
    let until = end.deadline().unwrap_or_else(|| Instant::now() + PATIENCE).min(Instant::now() + PATIENCE);
    let patience = Patience { until, is_cancelled: &|| false };
    let request = http::post(address, &address.target, token, body);
    let status = http::send(&places, request.as_bytes(), patience).and_then(|mut exchange| exchange.status());
    judged(status.map_err(failed)?)
}

/// What the status of an answer means.
fn judged(status: u16) -> Result<(), Failed> {
    let text = format!("it answers with the status {status}");
    match status {
        200..=299 => Ok(()),
        300..=399 => Err(Failed::ForGood(format!("{text}: use the address to which it redirects"))),
        // Too early, too slow or too many.
        408 | 425 | 429 => Err(Failed::ForNow(text)),
        400..=499 => Err(Failed::ForGood(text)),
        _ => Err(Failed::ForNow(text)),
    }
}

/// What an error of a connection means.
fn reason(error: &io::Error) -> String {
    match http::reason(error) {
        None => format!("it does not answer within {} s", PATIENCE.as_secs()),
        Some(why) if error.kind() == ErrorKind::InvalidData => format!("it {why}"),
        Some(_) => error.to_string(),
    }
}
