//! Counts of the fleet in reports, their summary, and its curves over time.

mod curves;
mod history;

use saoms_api::extension::{Counts, RunSummary, submit};

use crate::messages::{is_visit, job_name};

submit! {
    RunSummary {
        counts: &[
            "luggage.requested",
            "luggage.delivered",
            "luggage.open",
            "luggage.given_up",
            "luggage.ignored",
            "collisions.vertex",
            "collisions.swap",
            "stranded",
        ],
        result,
        progress,
        voters: "a world and an environment with a scenario",
    }
}

/// `1 of 1 pieces of luggage delivered, no collision, 0 stranded`; `None` if nothing was requested.
fn result(count: &Counts<'_>) -> Option<String> {
    let delivered = progress(count)?;
    let given_up = match count("luggage.given_up") + count("errands.given_up") {
        0 => String::new(),
        several => format!(", {several} given up"),
    };
    let collisions = match count("collisions.vertex") + count("collisions.swap") {
        0 => "no collision".to_owned(),
        several => counted(usize::try_from(several).unwrap_or_default(), "collision"),
    };
    Some(format!("{delivered}{given_up}, {collisions}, {} stranded", count("stranded")))
}

/// The pieces that are to be delivered: those that masters asked robots for, or more where masters did not hear of all
/// that scenarios put down. A master that lost its memory may have asked twice for what was published again.
fn asked_for(count: &Counts<'_>) -> i64 {
    let requested = count("luggage.requested") - count("scenario.repeated");
    requested.max(count("scenario.luggage") - (count("luggage.ignored") - count("scenario.known")))
}

/// `1 of 1 pieces of luggage delivered`, `3 of 5 errands finished`; `None` if nothing was requested.
fn progress(count: &Counts<'_>) -> Option<String> {
    let (luggage, errands) = (asked_for(count), count("errands.requested"));
    // Robots of other programs count what they deliver there; the environment hears of it.
    let delivered = count("luggage.delivered").max(count("scenario.delivered"));
    let delivered = format!("{delivered} of {luggage} pieces of luggage delivered");
    let finished = format!("{} of {errands} errands finished", count("errands.finished"));
    match (luggage > 0, errands > 0) {
        (true, true) => Some(format!("{delivered}, {finished}")),
        (true, false) => Some(delivered),
        (false, true) => Some(finished),
        (false, false) => None,
    }
}

/// `1 collision`, `2 collisions`.
pub(crate) fn counted(number: usize, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}

/// `luggage 3`, `luggage 3 and 2 more pieces`, `visit 1`: the first of several pieces, and how many others there are.
pub(crate) fn pieces(first: u32, more: usize) -> String {
    let (first, other) = (job_name(first), if is_visit(first) { "visit" } else { "piece" });
    match more {
        0 => first,
        more => format!("{first} and {more} more {other}{}", if more == 1 { "" } else { "s" }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_result_tells_deliveries_collisions_and_stranded_robots() {
        let counts = |requested: i64, swaps: i64| {
            move |path: &str| match path {
                "luggage.requested" => requested,
                "luggage.delivered" => 3,
                "luggage.given_up" => requested / 5,
                "collisions.swap" => swaps,
                "stranded" => 2,
                _ => 0,
            }
        };
        let text = |requested, swaps| result(&counts(requested, swaps));
        assert_eq!(text(0, 1), None);
        assert_eq!(text(4, 0).unwrap(), "3 of 4 pieces of luggage delivered, no collision, 2 stranded");
        assert_eq!(text(5, 0).unwrap(), "3 of 5 pieces of luggage delivered, 1 given up, no collision, 2 stranded");
        assert_eq!(text(4, 1).unwrap(), "3 of 4 pieces of luggage delivered, 1 collision, 2 stranded");
        assert_eq!(text(4, 5).unwrap(), "3 of 4 pieces of luggage delivered, 5 collisions, 2 stranded");
        assert_eq!(progress(&counts(4, 0)).unwrap(), "3 of 4 pieces of luggage delivered");
        let unheard = |path: &str| match path {
            "scenario.luggage" => 31,
            "luggage.ignored" => 1,
            _ => counts(2, 0)(path),
        };
        assert_eq!(progress(&unheard).unwrap(), "3 of 30 pieces of luggage delivered");
        let twice = |path: &str| match path {
            "scenario.luggage" => 24,
            "scenario.repeated" => 2,
            "luggage.ignored" => 3,
            "scenario.known" => 3,
            _ => counts(25, 0)(path),
        };
        assert_eq!(progress(&twice).unwrap(), "3 of 24 pieces of luggage delivered");
    }
}
