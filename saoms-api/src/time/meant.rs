//! What is probably meant by a text that is no duration.

use std::time::Duration;

use super::{format_duration, parse_duration};

/// The duration that is probably meant by a text that is none, as [`parse_duration`] reads it: of a unit that is
/// written out, of several units, of a time of day, of a frequency, or with a decimal comma.
///
/// ```
/// use saoms_api::host::meant_duration;
///
/// assert_eq!(meant_duration("1m30s").as_deref(), Some("90s"));
/// assert_eq!(meant_duration("00:01:00").as_deref(), Some("60s"));
/// assert_eq!(meant_duration("5 Hz").as_deref(), Some("200ms"));
/// assert_eq!(meant_duration("soon"), None);
/// ```
pub fn meant_duration(text: &str) -> Option<String> {
    // Nobody means a long text.
    if text.len() > 60 {
        return None;
    }
    let lower = text.trim().to_lowercase();
    let plain = lower.trim_start_matches(['~', '≈', '+', '=']).trim_end_matches([';', ',', '.', ':']).trim();
    // As in XML Schema.
    let plain = plain.strip_prefix("pt").unwrap_or(plain);
    let found = frequency(plain).or_else(|| clock(plain)).or_else(|| number_and_unit(plain)).or_else(|| sum(plain))?;
    (found != text && parse_duration(&found).is_ok()).then_some(found)
}

/// The number at the start of a text, and what follows it.
fn number(text: &str) -> Option<(String, &str)> {
    let end = text.find(|sign: char| !sign.is_ascii_digit() && !matches!(sign, '.' | ',')).unwrap_or(text.len());
    let (number, rest) = text.split_at(end);
    number.bytes().any(|sign| sign.is_ascii_digit()).then(|| (number.replace(',', "."), rest.trim_start()))
}

/// A number with its unit.
fn number_and_unit(text: &str) -> Option<String> {
    let (mut written, unit) = number(text)?;
    // Of `1e3`, the power of ten.
    let (power, unit) = match unit.strip_prefix('e').and_then(number) {
        Some((power, unit)) => (power.parse().ok()?, unit),
        None => (0, unit),
    };
    if power > 0 {
        written = format!("{}", written.parse::<f64>().ok()? * 10_f64.powi(power));
    }
    match unit {
        "" => Some(written),
        unit => short(unit).map(|unit| format!("{written}{unit}")),
    }
}

/// The usual form of a unit.
fn short(unit: &str) -> Option<&'static str> {
    Some(match unit {
        "ns" | "nsec" | "nanosecond" | "nanoseconds" => "ns",
        "us" | "usec" | "usecs" | "\u{b5}s" | "\u{3bc}s" | "micros" | "microsecond" | "microseconds" => "us",
        "ms" | "msec" | "msecs" | "millis" | "millisecond" | "milliseconds" => "ms",
        "s" | "sec" | "secs" | "second" | "seconds" => "s",
        "min" | "mins" | "minute" | "minutes" => "min",
        "h" | "hr" | "hrs" | "hour" | "hours" => "h",
        _ => return None,
    })
}

/// Several numbers with units, such as `1m30s`: their sum.
fn sum(text: &str) -> Option<String> {
    let (mut rest, mut sum) = (text, Duration::ZERO);
    while !rest.is_empty() {
        // `2s.8s` is no sum.
        if !rest.starts_with(|sign: char| sign.is_ascii_digit()) {
            return None;
        }
        let (number, behind) = number(rest)?;
        let end = behind.find(|sign: char| !sign.is_alphabetic()).unwrap_or(behind.len());
        let unit = match &behind[..end] {
            "m" => "min",
            unit => short(unit)?,
        };
        sum = sum.checked_add(parse_duration(&format!("{number}{unit}")).ok()?)?;
        let behind = behind[end..].trim_start();
        rest = behind.strip_prefix("and ").unwrap_or(behind).trim_start();
    }
    // A single `m` may be milliseconds as well.
    let is_one = text.bytes().filter(u8::is_ascii_alphabetic).count() < 2;
    (!is_one).then(|| format_duration(sum))
}

/// Hours, minutes and seconds with colons between them.
fn clock(text: &str) -> Option<String> {
    let parts: Vec<&str> = text.split(':').collect();
    let &[hours, minutes, seconds] = &parts[..] else { return None };
    let part = |number: &str, unit: &str| parse_duration(&format!("{number}{unit}")).ok();
    let sum = part(hours, "h")?.checked_add(part(minutes, "min")?)?.checked_add(part(seconds, "s")?)?;
    Some(format_duration(sum))
}

/// The period of a frequency.
fn frequency(text: &str) -> Option<String> {
    let often: f64 = text.strip_suffix("hz")?.trim().parse().ok()?;
    (often > 0.0).then(|| format_duration(Duration::from_micros((1e6 / often).round() as u64)))
}
