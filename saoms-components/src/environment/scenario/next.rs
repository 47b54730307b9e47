//! What can follow the beginning of a line: what editors offer.

use super::event::KINDS;
use super::line::{STARTS, UNITS};
use super::words::{DOTS, Words};

/// Something that a line can go on with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// This word.
    Word(&'static str),
    /// A time such as `6s`.
    Time,
    /// How often it happens, such as `100 times`.
    Times,
    /// How many pieces of luggage are expected.
    Pieces,
    /// A block, or `random`.
    Place,
    /// A robot.
    Robot,
}

/// What can follow the words of a line; nothing where it is at its end, or wrong.
///
/// ```
/// use saoms_components::environment::{Next, next};
///
/// assert_eq!(next("from 10s "), [Next::Word("every")]);
/// assert_eq!(next("at 6s luggage (3,1) to "), [Next::Place]);
/// ```
pub fn next(line: &str) -> Vec<Next> {
    follow(&mut Words::of(line, line)).err().unwrap_or_default()
}

/// Goes through the words; what is expected behind the last one is the error.
fn follow(words: &mut Words<'_>) -> Result<(), Vec<Next>> {
    let start = taken(words, || STARTS.map(Next::Word).into())?;
    if !STARTS.contains(&start) {
        return Ok(());
    }
    drawn(words, Next::Time)?;
    let repeats = words.take("every");
    if repeats {
        drawn(words, Next::Time)?;
    } else if start == "from" && words.peek().is_none() {
        return Err(vec![Next::Word("every")]);
    }
    let mut is_counted = false;
    if words.peek().is_some_and(|word| word.parse::<u64>().is_ok()) {
        let _ = words.next("");
        taken(words, || vec![Next::Word("times")])?;
        is_counted = true;
    }
    let ends = words.take("until");
    if ends {
        drawn(words, Next::Time)?;
    }
    let kind = taken(words, || {
        let times = (!is_counted && !ends).then_some(Next::Times);
        let until = (repeats && !ends).then_some(Next::Word("until"));
        let every = (start == "then" && !repeats && !is_counted).then_some(Next::Word("every"));
        KINDS.map(Next::Word).into_iter().chain(every).chain(times).chain(until).collect()
    })?;
    match kind {
        "luggage" => {
            drawn(words, Next::Place)?;
            if taken(words, || vec![Next::Word("to")])? == "to" {
                drawn(words, Next::Place)?;
            }
        }
        "landing" | "takeoff" => drawn(words, Next::Pieces)?,
        "breakdown" => drawn(words, Next::Robot)?,
        _ => {}
    }
    Ok(())
}

/// The next word, or what is expected in its place.
fn taken<'a>(words: &mut Words<'a>, expected: impl FnOnce() -> Vec<Next>) -> Result<&'a str, Vec<Next>> {
    words.next("").map_err(|_| expected())
}

/// One value, or two with `..` between them; a unit may stand apart from its number.
fn drawn(words: &mut Words<'_>, what: Next) -> Result<(), Vec<Next>> {
    loop {
        taken(words, || vec![what])?;
        if what == Next::Time && words.peek().is_some_and(|unit| UNITS.contains(&unit)) {
            let _ = words.next("");
        }
        if !words.take(DOTS) {
            return Ok(());
        }
    }
}
