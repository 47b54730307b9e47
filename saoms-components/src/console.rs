//! Formats that the lines of the original's console share.

use std::fmt;
use std::time::Duration;

use saoms_api::Context;
use saoms_api::host::calendar_date;

/// A list as Java prints it: `[a, b]`.
pub struct JavaList<I>(pub I);

impl<I> fmt::Display for JavaList<I>
where
    I: Iterator + Clone,
    I::Item: fmt::Display,
{
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("[")?;
        for (place, item) in self.0.clone().enumerate() {
            let comma = if place > 0 { ", " } else { "" };
            write!(formatter, "{comma}{item}")?;
        }
        formatter.write_str("]")
    }
}

impl<I> fmt::Debug for JavaList<I> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("JavaList")
    }
}

/// A date and time of day, as time since 1970-01-01 00:00, printed as in the manual's figures: trailing zeros of the
/// fraction are left out, but one digit always stays.
#[derive(Clone, Copy, Debug)]
pub struct Timestamp(pub Duration);

/// 2015-01-23 14:32:35: the second in which the run of the manual's figure 8.1 started.
const START: Duration = Duration::from_secs(1_422_023_555);

impl Timestamp {
    /// The current date and time. A run in virtual time has none: it starts at the date of the manual's figure 8.1.
    pub fn now(context: &Context<'_>) -> Timestamp {
        Timestamp(context.date().unwrap_or_else(|| START + Duration::from_nanos(context.now().as_nanos())))
    }
}

impl fmt::Display for Timestamp {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (seconds, millis) = (self.0.as_secs(), self.0.subsec_millis());
        let (year, month, day) = calendar_date(seconds / 86_400);
        let (hour, minute, second) = (seconds / 3600 % 24, seconds / 60 % 60, seconds % 60);
        write!(formatter, "{year}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02}.")?;
        match millis {
            0 => formatter.write_str("0"),
            tenths if tenths % 100 == 0 => write!(formatter, "{}", tenths / 100),
            hundredths if hundredths % 10 == 0 => write!(formatter, "{:02}", hundredths / 10),
            thousandths => write!(formatter, "{thousandths:03}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(millis: u64) -> String {
        Timestamp(START + Duration::from_millis(millis)).to_string()
    }

    #[test]
    fn a_timestamp_looks_like_those_of_the_figures() {
        assert_eq!(shown(0), "2015-01-23 14:32:35.0");
        assert_eq!(shown(274), "2015-01-23 14:32:35.274");
        assert_eq!(shown(5_340), "2015-01-23 14:32:40.34");
        assert_eq!(shown(5_300), "2015-01-23 14:32:40.3");
        assert_eq!(shown(5_005), "2015-01-23 14:32:40.005");
        assert_eq!(shown(86_400_000 * 37), "2015-03-01 14:32:35.0");
        assert_eq!(shown(86_400_000 * (365 + 403)), "2017-03-01 14:32:35.0");
    }

    #[test]
    fn a_list_looks_like_javas() {
        assert_eq!(JavaList([1, 2].iter()).to_string(), "[1, 2]");
        assert_eq!(JavaList([0; 0].iter()).to_string(), "[]");
    }
}
