use std::fmt;

/// A part of all messages, in millionths, so that it is the same on every machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Rate(u32);

impl Rate {
    /// All of them.
    pub const ALL: Rate = Rate(1_000_000);

    /// So many millionths.
    pub const fn of_millionths(millionths: u32) -> Rate {
        Rate(millionths)
    }

    /// The number of millionths.
    pub const fn per_million(self) -> u32 {
        self.0
    }

    /// Reads a part such as `20 %`, `20%` or `0.2`, which may be greater than all.
    pub(super) fn read(number: &str, is_percent: bool) -> Option<Rate> {
        let (whole, part) = number.split_once('.').unwrap_or((number, ""));
        let is_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
        if whole.is_empty() && part.is_empty() || !is_digits(whole) || !is_digits(part) || whole.len() > 6 {
            return None;
        }
        let digits = if is_percent { 4 } else { 6 };
        let part: String = part.chars().chain("000000".chars()).take(digits).collect();
        format!("{whole}{part}").parse().ok().map(Rate)
    }
}

impl fmt::Display for Rate {
    /// The part in percent.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (whole, part) = (self.0 / 10_000, self.0 % 10_000);
        match part {
            0 => write!(formatter, "{whole} %"),
            part => write!(formatter, "{whole}.{} %", format!("{part:04}").trim_end_matches('0')),
        }
    }
}
