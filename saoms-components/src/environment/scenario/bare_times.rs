//! Times of a scenario that are written without a unit, and are probably seconds.

use super::line::{STARTS, UNITS, split};

/// Number from which on a time without a unit is probably one of milliseconds, as it says.
const MILLISECONDS: u32 = 100;

/// The times of a text that are small numbers without a unit, as they are written: `6` in `at 6 luggage`.
pub(crate) fn bare_times(text: &str) -> impl Iterator<Item = &str> {
    split(text).flat_map(|line| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let times = words.windows(2).enumerate().filter_map(|(at, pair)| {
            let has_time = STARTS.contains(&pair[0]) || ["every", "until"].contains(&pair[0]);
            let unit = words.get(at + 2).is_some_and(|next| UNITS.contains(next));
            (has_time && !unit && is_bare(pair[1])).then_some(pair[1])
        });
        times.collect::<Vec<_>>()
    })
}

/// True if a word is a small number, or two as the ends of a range, without a unit.
fn is_bare(word: &str) -> bool {
    let is_small = |number: &str| number.parse().is_ok_and(|number: u32| (1..MILLISECONDS).contains(&number));
    word.split("..").all(is_small)
}

#[cfg(test)]
mod tests {
    use super::bare_times;

    #[test]
    fn small_numbers_without_a_unit_are_found() {
        for (text, found) in [
            ("at 6 luggage (3,1) to (3,10)", vec!["6"]),
            ("from 1s every 5 3 times landing 2; then 2..4 end # at 7", vec!["5", "2..4"]),
            (
                "at 6s landing 4; at 500 landing 3; at 0 landing 1; at 6 s landing 2; from 1s every 2s until 20 landing 1",
                vec!["20"],
            ),
        ] {
            assert_eq!(bare_times(text).collect::<Vec<_>>(), found, "{text}");
        }
    }
}
