//! Continuations of an unfinished line, which editors offer.

use saoms_api::event::fault::{FAULTS, LASTING};

use super::event::KINDS;
use super::fault_words;
use super::line::{STARTS, UNITS};
use super::tokenizer::Tokenizer;

/// A possible continuation of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Continuation {
    /// This word.
    Word(&'static str),
    /// A time such as `6s`.
    Time,
    /// A number of repetitions, such as `100 times`.
    Times,
    /// A number of pieces of luggage.
    Pieces,
    /// A block, or `random`.
    Place,
    /// A robot.
    Robot,
    /// How long a fault lasts, or by how much it is late: one time such as `300ms`.
    Duration,
    /// A part such as `20 %`.
    Rate,
    /// A component of any class.
    Component,
    /// A topic.
    Topic,
}

/// Possible continuations of a line; none if the line is complete or wrong.
///
/// ```
/// use saoms_components::environment::{Continuation, continuations};
///
/// assert_eq!(continuations("from 10s "), [Continuation::Word("every")]);
/// assert_eq!(continuations("at 6s luggage (3,1) to "), [Continuation::Place]);
/// ```
pub fn continuations(line: &str) -> Vec<Continuation> {
    follow(&mut Tokenizer::of(line, line)).err().unwrap_or_default()
}

/// Parses the words. The error lists what is expected after the last word.
fn follow(words: &mut Tokenizer<'_>) -> Result<(), Vec<Continuation>> {
    let start = taken(words, || STARTS.map(Continuation::Word).into())?;
    if !STARTS.contains(&start) {
        return Ok(());
    }
    drawn(words, Continuation::Time)?;
    let repeats = words.take("every");
    if repeats {
        drawn(words, Continuation::Time)?;
    } else if start == "from" && words.peek().is_none() {
        return Err(vec![Continuation::Word("every")]);
    }
    let mut is_counted = false;
    if words.peek().is_some_and(|word| word.parse::<u64>().is_ok()) {
        let _ = words.next("");
        taken(words, || vec![Continuation::Word("times")])?;
        is_counted = true;
    }
    let ends = words.take("until");
    if ends {
        drawn(words, Continuation::Time)?;
    }
    let kind = taken(words, || {
        let times = (!is_counted && !ends).then_some(Continuation::Times);
        let until = (repeats && !ends).then_some(Continuation::Word("until"));
        let every = (start == "then" && !repeats && !is_counted).then_some(Continuation::Word("every"));
        // `stall` needs to know how long.
        let faults = [LASTING].into_iter().chain(FAULTS).filter(|word| *word != "stall").map(Continuation::Word);
        KINDS.map(Continuation::Word).into_iter().chain(every).chain(times).chain(until).chain(faults).collect()
    })?;
    match kind {
        "luggage" => {
            drawn(words, Continuation::Place)?;
            if taken(words, || vec![Continuation::Word("to")])? == "to" {
                drawn(words, Continuation::Place)?;
            }
        }
        "visit" => loop {
            drawn(words, Continuation::Place)?;
            match taken(words, || ["then", "by"].map(Continuation::Word).into())? {
                "then" => {}
                "by" => break drawn(words, Continuation::Robot)?,
                _ => break,
            }
        },
        "landing" | "takeoff" => drawn(words, Continuation::Pieces)?,
        "breakdown" | "gone" => drawn(words, Continuation::Robot)?,
        fault if fault == LASTING || FAULTS.contains(&fault) => {
            let rest = &words.rest(fault)[fault.len()..];
            return Err(fault_words::follow(fault, rest));
        }
        _ => {}
    }
    Ok(())
}

/// The next word, or the continuations that are expected in its place.
fn taken<'a>(
    words: &mut Tokenizer<'a>,
    expected: impl FnOnce() -> Vec<Continuation>,
) -> Result<&'a str, Vec<Continuation>> {
    words.next("").map_err(|_| expected())
}

/// One value, or two with `..` between them; a blank may separate a number from its unit.
fn drawn(words: &mut Tokenizer<'_>, what: Continuation) -> Result<(), Vec<Continuation>> {
    loop {
        taken(words, || vec![what])?;
        if what == Continuation::Time && words.peek().is_some_and(|unit| UNITS.contains(&unit)) {
            let _ = words.next("");
        }
        // Nothing continues a line with a fault.
        if !words.take_dots().map_err(|_| Vec::new())? {
            return Ok(());
        }
    }
}
