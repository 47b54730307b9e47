//! The lexical forms of types of XML Schema (XML Schema 1.0, part 2).

/// `2026-11-22`, with a time zone or without.
pub(crate) fn date(text: &str) -> bool {
    let text = without_zone(text);
    let mut parts = text.rsplitn(3, '-');
    let (Some(day), Some(month), Some(years)) = (parts.next(), parts.next(), parts.next()) else {
        return false;
    };
    is_year(years) && is_day_of(day, month)
}

/// `12:30:00`, with a part of a second and a time zone or without.
pub(crate) fn time(text: &str) -> bool {
    let mut parts = without_zone(text).split(':');
    let (Some(hours), Some(minutes), Some(seconds), None) =
        (parts.next(), parts.next(), parts.next(), parts.next())
    else {
        return false;
    };
    let (seconds, part) = seconds.split_once('.').unwrap_or((seconds, "0"));
    let is_midnight = hours == "24" && minutes == "00" && seconds == "00";
    (two(hours, 0..=23) || is_midnight) && two(minutes, 0..=59) && two(seconds, 0..=59) && is_digits(part)
}

/// `2026-11-22T12:30:00`.
pub(crate) fn date_time(text: &str) -> bool {
    text.split_once('T').is_some_and(|(day, hour)| {
        // The time zone stands at the end alone.
        without_zone(day) == day && date(day) && time(hour)
    })
}

/// `P1DT2H`.
pub(crate) fn duration(text: &str) -> bool {
    let Some(rest) = text.strip_prefix('-').unwrap_or(text).strip_prefix('P') else { return false };
    let (days, time) = rest.split_once('T').map_or((rest, None), |(days, time)| (days, Some(time)));
    let of_time = time.is_none_or(|time| !time.is_empty() && is_counted(time, "HMS"));
    !rest.is_empty() && is_counted(days, "YMD") && of_time
}

/// Numbers with these units, each once at most and in this order; the last unit of a time can have a part.
fn is_counted(text: &str, units: &str) -> bool {
    let (mut rest, mut left) = (text, units);
    while !rest.is_empty() {
        let Some(end) = rest.find(|letter: char| letter.is_ascii_alphabetic()) else { return false };
        let (number, unit) = (&rest[..end], &rest[end..=end]);
        let Some(place) = left.find(unit) else { return false };
        let (whole, part) = number.split_once('.').unwrap_or((number, "0"));
        if !is_digits(whole) || !is_digits(part) || number.contains('.') && unit != "S" {
            return false;
        }
        (rest, left) = (&rest[end + 1..], &left[place + 1..]);
    }
    true
}

/// `2026`.
pub(crate) fn year(text: &str) -> bool {
    is_year(without_zone(text))
}

/// `2026-11`.
pub(crate) fn year_month(text: &str) -> bool {
    without_zone(text).rsplit_once('-').is_some_and(|(years, month)| is_year(years) && two(month, 1..=12))
}

/// `--11`.
pub(crate) fn month(text: &str) -> bool {
    without_zone(text).strip_prefix("--").is_some_and(|month| two(month, 1..=12))
}

/// `--11-22`.
pub(crate) fn month_day(text: &str) -> bool {
    let parts = without_zone(text).strip_prefix("--").and_then(|rest| rest.split_once('-'));
    parts.is_some_and(|(month, day)| is_day_of(day, month))
}

/// `---22`.
pub(crate) fn day(text: &str) -> bool {
    without_zone(text).strip_prefix("---").is_some_and(|day| two(day, 1..=31))
}

/// A name without a prefix.
pub(crate) fn name(text: &str) -> bool {
    let mut letters = text.chars();
    let is_first = |letter: char| letter.is_alphabetic() || letter == '_';
    letters.next().is_some_and(is_first) && letters.all(is_inner)
}

/// A name with a prefix or without.
pub(crate) fn qualified(text: &str) -> bool {
    text.split_once(':').map_or_else(|| name(text), |(prefix, local)| name(prefix) && name(local))
}

/// Letters, digits and signs as names have them.
pub(crate) fn token(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|letter| is_inner(letter) || letter == ':')
}

/// `en` or `en-US`.
pub(crate) fn language(text: &str) -> bool {
    text.split('-').enumerate().all(|(place, part)| {
        let is_right = |letter: u8| letter.is_ascii_alphabetic() || place > 0 && letter.is_ascii_digit();
        (1..=8).contains(&part.len()) && part.bytes().all(is_right)
    })
}

/// Pairs of hexadecimal digits.
pub(crate) fn hexadecimal(text: &str) -> bool {
    text.len().is_multiple_of(2) && text.bytes().all(|digit| digit.is_ascii_hexdigit())
}

/// Groups of four signs of base 64.
pub(crate) fn base_64(text: &str) -> bool {
    let signs: String = text.split_whitespace().collect();
    let data = signs.trim_end_matches('=');
    let is_sign = |sign: u8| sign.is_ascii_alphanumeric() || matches!(sign, b'+' | b'/');
    signs.len().is_multiple_of(4) && signs.len() - data.len() <= 2 && data.bytes().all(is_sign)
}

/// Nearly everything: behind each `%` stand two hexadecimal digits.
pub(crate) fn uri(text: &str) -> bool {
    let is_hexadecimal =
        |part: &str| part.len() >= 2 && part.bytes().take(2).all(|digit| digit.is_ascii_hexdigit());
    text.split('%').skip(1).all(is_hexadecimal)
}

fn is_inner(letter: char) -> bool {
    letter.is_alphanumeric() || matches!(letter, '.' | '-' | '_' | '\u{b7}') || !letter.is_ascii()
}

/// A text without `Z`, `+01:00` or `-01:00` at its end.
fn without_zone(text: &str) -> &str {
    if let Some(rest) = text.strip_suffix('Z') {
        return rest;
    }
    let Some((rest, zone)) = text.len().checked_sub(6).and_then(|at| text.split_at_checked(at)) else {
        return text;
    };
    let parts = zone.strip_prefix(['+', '-']).and_then(|zone| zone.split_once(':'));
    let is_zone = parts.is_some_and(|(hours, minutes)| two(hours, 0..=14) && two(minutes, 0..=59));
    if is_zone { rest } else { text }
}

fn is_year(text: &str) -> bool {
    let digits = text.strip_prefix('-').unwrap_or(text);
    digits.len() >= 4 && is_digits(digits)
}

fn is_day_of(day: &str, month: &str) -> bool {
    let days = match month {
        "02" => 29,
        "04" | "06" | "09" | "11" => 30,
        _ => 31,
    };
    two(month, 1..=12) && two(day, 1..=days)
}

fn two(text: &str, range: std::ops::RangeInclusive<u32>) -> bool {
    text.len() == 2 && is_digits(text) && text.parse().is_ok_and(|number| range.contains(&number))
}

pub(crate) fn is_digits(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}
