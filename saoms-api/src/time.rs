mod meant;

use std::fmt;
use std::ops::{Add, Sub};
use std::time::Duration;

pub use meant::meant_duration;

use crate::host::declaration::trim;

/// A point in the time of a run: nanoseconds since the run started.
///
/// In real time it follows the machine's monotonic clock, in virtual time it jumps from one due execution to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Time(u64);

impl Time {
    /// The start of the run.
    pub const START: Time = Time(0);

    /// The time that many nanoseconds after the start.
    pub const fn from_nanos(nanos: u64) -> Time {
        Time(nanos)
    }

    /// Nanoseconds since the start.
    pub const fn as_nanos(self) -> u64 {
        self.0
    }

    /// Seconds since the start.
    pub fn as_secs_f64(self) -> f64 {
        self.0 as f64 / 1e9
    }

    /// Duration since `earlier`; zero if this time is not after it.
    pub const fn since(self, earlier: Time) -> Duration {
        Duration::from_nanos(self.0.saturating_sub(earlier.0))
    }
}

impl Add<Duration> for Time {
    type Output = Time;

    /// Saturates at the end of time, some 584 years after the start.
    fn add(self, duration: Duration) -> Time {
        Time(self.0.saturating_add(u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)))
    }
}

impl Sub<Time> for Time {
    type Output = Duration;

    fn sub(self, earlier: Time) -> Duration {
        self.since(earlier)
    }
}

impl fmt::Display for Time {
    /// In seconds with three decimals: `12.500 s`.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}.{:03} s", self.0 / 1_000_000_000, self.0 / 1_000_000 % 1_000)
    }
}

/// Reads a duration as composite files write it: a bare number is milliseconds, otherwise the unit is one of `ns`,
/// `us`, `ms`, `s`, `min` and `h`. Decimals are allowed; the result is rounded to nanoseconds.
///
/// ```
/// use std::time::Duration;
/// assert_eq!(saoms_api::host::parse_duration("500"), Ok(Duration::from_millis(500)));
/// assert_eq!(saoms_api::host::parse_duration("100us"), Ok(Duration::from_micros(100)));
/// assert_eq!(saoms_api::host::parse_duration("1.5 s"), Ok(Duration::from_millis(1500)));
/// assert!(saoms_api::host::parse_duration("soon").is_err());
/// ```
///
/// # Errors
/// The message with found and expected text, if the text is no duration, is negative, or is longer than 584 years.
pub fn parse_duration(text: &str) -> Result<Duration, String> {
    const EXPECTED: &str = "a number of milliseconds, or a number with one of the units ns, us, ms, s, min, h";
    let text = trim(text);
    match read_duration(text) {
        Ok(duration) => Ok(duration),
        Err(WrongDuration::Negative) => Err(format!("`{text}` is negative: expected {EXPECTED}")),
        Err(WrongDuration::TooLong) => Err(format!("`{text}` is longer than any run can last")),
        Err(WrongDuration::Other) => match text.strip_suffix('m').filter(|number| read_duration(number).is_ok()) {
            Some(number) => Err(format!(
                "`{text}` is not a duration: expected `{number}min`, for minutes, or `{number}ms`, for milliseconds"
            )),
            None => Err(format!("`{text}` is not a duration: expected {EXPECTED}")),
        },
    }
}

/// A fault of a text that is not a duration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WrongDuration {
    /// A duration with a minus.
    Negative,
    /// More nanoseconds than 64 bits hold.
    TooLong,
    /// Something else.
    Other,
}

/// The units of durations that [`parse_duration`] reads, with their names; the most frequent come first.
pub const DURATION_UNITS: [(&str, &str); 6] = [
    ("ms", "milliseconds"),
    ("s", "seconds"),
    ("us", "microseconds"),
    ("min", "minutes"),
    ("h", "hours"),
    ("ns", "nanoseconds"),
];

/// [`parse_duration`] that can run while a program is compiled. The arithmetic is exact.
pub(crate) const fn read_duration(text: &str) -> Result<Duration, WrongDuration> {
    let text = text.as_bytes().trim_ascii();
    if let [b'-', rest @ ..] = text {
        return Err(match read_nanos(rest) {
            Ok(_) | Err(WrongDuration::TooLong) => WrongDuration::Negative,
            Err(error) => error,
        });
    }
    match read_nanos(text) {
        Ok(nanos) => Ok(Duration::from_nanos(nanos)),
        Err(error) => Err(error),
    }
}

const fn read_nanos(mut rest: &[u8]) -> Result<u64, WrongDuration> {
    // A whole part beyond this is too long in any unit, and decimals behind these do not change a nanosecond of an
    // hour.
    const MOST: u128 = 10_u128.pow(20);
    const FINEST: u128 = 10_u128.pow(18);
    let (mut whole, mut fraction, mut scale) = (0_u128, 0_u128, 1_u128);
    let (mut digits, mut decimals) = (false, false);
    while let [byte, tail @ ..] = rest {
        match *byte {
            digit @ b'0'..=b'9' => {
                digits = true;
                if decimals && scale < FINEST {
                    (fraction, scale) = (fraction * 10 + (digit - b'0') as u128, scale * 10);
                } else if !decimals && whole < MOST {
                    whole = whole * 10 + (digit - b'0') as u128;
                }
            }
            b'.' if !decimals => decimals = true,
            _ => break,
        }
        rest = tail;
    }
    let unit: u128 = match rest.trim_ascii_start() {
        b"ns" => 1,
        b"us" | [0xc2, 0xb5, b's'] => 1_000,
        b"" | b"ms" => 1_000_000,
        b"s" => 1_000_000_000,
        b"min" => 60_000_000_000,
        b"h" => 3_600_000_000_000,
        _ => return Err(WrongDuration::Other),
    };
    // Dividing 128 bits takes longer than all else.
    let behind = if fraction == 0 { 0 } else { (fraction * unit + scale / 2) / scale };
    let nanos = whole * unit + behind;
    match digits {
        false => Err(WrongDuration::Other),
        true if nanos > u64::MAX as u128 => Err(WrongDuration::TooLong),
        true => Ok(nanos as u64),
    }
}

/// Writes a duration as [`parse_duration`] reads it, with the largest unit that needs no decimals.
///
/// ```
/// use std::time::Duration;
/// assert_eq!(saoms_api::host::format_duration(Duration::from_micros(100)), "100us");
/// assert_eq!(saoms_api::host::format_duration(Duration::from_millis(1500)), "1500ms");
/// assert_eq!(saoms_api::host::format_duration(Duration::from_secs(2)), "2s");
/// ```
pub fn format_duration(duration: Duration) -> String {
    let nanos = duration.as_nanos();
    let units = [("s", 1_000_000_000), ("ms", 1_000_000), ("us", 1_000)];
    match units.iter().find(|(_, scale)| nanos.is_multiple_of(*scale)) {
        Some((unit, scale)) => format!("{}{unit}", nanos / scale),
        None => format!("{nanos}ns"),
    }
}

#[cfg(test)]
mod tests;
