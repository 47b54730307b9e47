//! Expressions.

use super::choices::Choices;

const NAMES: &[&str] = &["p", "q", "index", "site", "true", "robots"];

/// One that may come to a number; of this depth at most.
pub(super) fn number(choices: &mut Choices<'_>, deep: usize) -> String {
    match choices.below(if deep == 0 { 3 } else { 7 }) {
        0 => choices.of(&["1", "2", "0", "3", "9223372036854775807", "100001", "1000000000", "07"]).to_owned(),
        1 | 2 => choices.of(NAMES).to_owned(),
        3 => format!("({})", number(choices, deep - 1)),
        4 => format!("-{}", number(choices, deep - 1)),
        _ => {
            let sign = choices.of(&["+", "-", "*", "/", "%", " ", "=="]);
            format!("{} {sign} {}", number(choices, deep - 1), number(choices, deep - 1))
        }
    }
}

/// One that may come to true or false.
pub(super) fn condition(choices: &mut Choices<'_>, deep: usize) -> String {
    match choices.below(if deep == 0 { 3 } else { 6 }) {
        0 => choices.of(&["true", "false", "p", "not p", "site == 'north'", "site != \"\""]).to_owned(),
        1 | 2 => {
            let sign = choices.of(&["==", "!=", "<", "<=", ">", ">=", "=", "&&"]);
            format!("{} {sign} {}", number(choices, 1), number(choices, 1))
        }
        3 => format!("not ({})", condition(choices, deep - 1)),
        _ => {
            let word = choices.of(&["and", "or"]);
            format!("{} {word} {}", condition(choices, deep - 1), condition(choices, deep - 1))
        }
    }
}
