use std::fmt;

/// Numbers of records that were not there yet when later ones were: a component writes its records at the end of an
/// execution, and others write theirs meanwhile. Those that were lost never come.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Gaps(Vec<(i64, i64)>);

/// The number of ranges that are known; the oldest are given up for more. Only records that were lost make many.
const MOST: usize = 1_000;

impl Gaps {
    /// Adds the numbers from one to another, which are behind all that are known.
    pub(crate) fn add(&mut self, from: i64, to: i64) {
        if from <= to {
            self.0.push((from, to));
        }
        if self.0.len() > MOST {
            self.0.remove(0);
        }
    }

    /// Takes a number out, as its record is there.
    pub(crate) fn close(&mut self, number: i64) {
        let Some(place) = self.0.iter().position(|(from, to)| (*from..=*to).contains(&number)) else { return };
        let (from, to) = self.0[place];
        let rest = [(from, number - 1), (number + 1, to)].into_iter().filter(|(from, to)| from <= to);
        self.0.splice(place..=place, rest);
    }

    /// The ranges, with their first and last numbers.
    pub(crate) fn ranges(&self) -> &[(i64, i64)] {
        &self.0
    }

    /// The ranges of a text that [`Display`](fmt::Display) made.
    pub(crate) fn read(text: &str) -> Gaps {
        let range = |range: &str| {
            let (from, to) = range.split_once('-')?;
            Some((from.parse().ok()?, to.parse().ok()?))
        };
        Gaps(text.split(' ').filter_map(range).collect())
    }
}

impl fmt::Display for Gaps {
    /// As `17-17 101-105`.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, (from, to)) in self.0.iter().enumerate() {
            let between = if place > 0 { " " } else { "" };
            write!(formatter, "{between}{from}-{to}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_close_from_any_side() {
        let mut gaps = Gaps::default();
        gaps.add(1, 0);
        gaps.add(3, 3);
        gaps.add(5, 9);
        for (number, expected) in [(4, "3-3 5-9"), (7, "3-3 5-6 8-9"), (3, "5-6 8-9"), (8, "5-6 9-9"), (6, "5-5 9-9")] {
            gaps.close(number);
            assert_eq!(gaps.to_string(), expected);
            assert_eq!(Gaps::read(expected), gaps);
        }
        assert_eq!(Gaps::read(""), Gaps::default());
    }
}
