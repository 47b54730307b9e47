use saoms_api::event::fault::{FAULTS, FaultCall};
use saoms_api::event::{EventCall, is_event_name};
use saoms_api::extension::LineFault;
use saoms_api::rule::nearest;

use super::line::drawn;
use super::random::{RandomRange, Spot};
use super::tokenizer::Tokenizer;
use super::vocabulary::Vocabulary;
use super::{EventSpec, Spanned, strain};
use crate::grid::Block;
use crate::text::TextFault;

pub(super) const KINDS: [&str; 7] = ["luggage", "visit", "landing", "takeoff", "breakdown", "gone", "end"];
const BLOCK: &str = "a block such as `(3,1)`, two corners such as `(1,0)..(10,10)`, or `random`";
const ROBOT: &str = "a robot such as `Robot002` or `2`, or numbers such as `1..10` to draw one of";

const RANDOM: &str = "random";

/// Reads an event, which ends the line.
pub(super) fn read(words: &mut Tokenizer<'_>, vocabulary: Vocabulary<'_>) -> Result<EventSpec, TextFault> {
    let name = words.peek().unwrap_or_default();
    let event = match KINDS.contains(&name) {
        true if !vocabulary.plays(name) => {
            let message = format!("found `{name}`, an event that this class does not support");
            return Err(words.fault(name, message).help(format!("it supports {}", vocabulary.expected())));
        }
        true => own(words)?,
        false if FaultCall::is_one(name) => return of_fleet(words),
        false => return of_class(words, vocabulary),
    };
    match words.peek() {
        Some(more) => Err(words.wrong(more, "the end of the line, or `;` before the next event")),
        None => Ok(event),
    }
}

/// An example of a line with the event that a wrong line has.
pub(super) fn example(line: &str) -> &'static str {
    if line.split_whitespace().any(|word| FAULTS.contains(&word)) {
        return "as in `at 10s for 30s lose 20 % on POSTOPIC`";
    }
    match line.split_whitespace().find(|word| KINDS.contains(word)) {
        Some("landing" | "takeoff") => "as in `at 3s landing 4`",
        Some("visit") => "as in `at 6s visit (3,1) then (5,2) by Robot002`",
        Some("breakdown" | "gone") => "as in `at 9s breakdown Robot002`",
        Some("end") => "as in `at 60s end`",
        None if line.contains("repair") => "a robot that broke down is not repaired",
        _ => "as in `at 6s luggage (3,1) to (3,10)`",
    }
}

/// Reads an event that other classes take: the rest of the line.
fn of_class(words: &mut Tokenizer<'_>, vocabulary: Vocabulary<'_>) -> Result<EventSpec, TextFault> {
    let expected = vocabulary.expected();
    let name = words.next(&expected)?;
    let unknown = |words: &Tokenizer<'_>| match words.peek() {
        // The robot first.
        Some(event @ ("breakdown" | "gone")) if number(name).is_some() => {
            let swapped = format!("{event} {name}");
            words.wrong(words.span(name, event), "the event before the robot").instead(Some(swapped))
        }
        _ => words.wrong(name, &expected).instead(nearest(name, vocabulary.names().chain(FAULTS))),
    };
    let rest = words.rest(name);
    let start = words.bytes(name).start;
    let call = match vocabulary.events() {
        None if !is_event_name(name) => return Err(unknown(words)),
        // Whether there is such an event is not known here: what cannot be one is another mistake.
        None => EventCall::read(rest).map_err(|_| unknown(words))?,
        Some(events) => {
            let Some(event) = events.get(name) else { return Err(unknown(words)) };
            let judge = |call| event.check(&call).and_then(|()| strain::check(event, &call)).map(|()| call);
            let call = EventCall::read(rest).and_then(judge);
            call.map_err(|fault| text_fault(fault.moved(start)))?
        }
    };
    words.skip_rest();
    // Its words are read again where it happens: a scenario may have hundreds of thousands of lines.
    Ok(EventSpec::Raised(rest[..call.bytes().end].into()))
}

/// Reads a fault of messages or executions, which the fleet plays: the rest of the line.
fn of_fleet(words: &mut Tokenizer<'_>) -> Result<EventSpec, TextFault> {
    let name = words.next("a fault")?;
    let rest = words.rest(name);
    let start = words.bytes(name).start;
    let call = FaultCall::read(rest).map_err(|fault| text_fault(fault.moved(start)))?;
    words.skip_rest();
    Ok(EventSpec::Raised(call.to_string().into()))
}

fn text_fault(LineFault { bytes, message, instead, help, .. }: LineFault) -> TextFault {
    TextFault { bytes, message, instead, help }
}

/// Reads an event of the language itself.
fn own(words: &mut Tokenizer<'_>) -> Result<EventSpec, TextFault> {
    Ok(match words.one_of(&KINDS, "an event")? {
        "luggage" => {
            let from = spot(words)?;
            words.one_of(&["to"], "`to` and the block to bring it to")?;
            let to = spot(words)?;
            if let (Some(start), Some(end)) = (from.value.block(), to.value.block())
                && start == end
            {
                let message = format!("found {end}, where the luggage starts: expected another block");
                return Err(words.fault(words.text(&to.bytes), message).help("write two different blocks"));
            }
            EventSpec::Luggage { from, to }
        }
        "visit" => visit(words)?,
        "landing" => EventSpec::Landing(drawn(words, pieces).and_then(|drawn| some(words, drawn))?),
        "takeoff" => EventSpec::Takeoff(drawn(words, pieces).and_then(|drawn| some(words, drawn))?),
        "end" => EventSpec::End,
        "gone" => EventSpec::Gone(robots(words)?),
        _ => EventSpec::Breakdown(robots(words)?),
    })
}

/// Blocks to visit, and perhaps the robot that does.
fn visit(words: &mut Tokenizer<'_>) -> Result<EventSpec, TextFault> {
    let mut stops = vec![spot(words)?];
    while words.take("then") {
        stops.push(spot(words)?);
    }
    let by = if words.take("by") { Some(robots(words)?) } else { None };
    Ok(EventSpec::Visit { stops, by })
}

/// A robot, or numbers to draw one of.
fn robots(words: &mut Tokenizer<'_>) -> Result<Spanned<RandomRange<u32>>, TextFault> {
    let first = words.peek().unwrap_or_default();
    several(words, first)?;
    let value = drawn(words, robot)?;
    Ok(Spanned { value, bytes: words.bytes(words.span(first, words.last())) })
}

fn spot(words: &mut Tokenizer<'_>) -> Result<Spanned<Spot>, TextFault> {
    let first = words.next(BLOCK)?;
    let value = match first {
        RANDOM => Spot::Anywhere,
        _ => {
            let corner = block(words, first).map_err(|fault| match words.peek() {
                Some(next) if first.parse::<u32>().is_ok() && next.starts_with('(') => {
                    fault.help(format!("write `{first} times` before `luggage` for {first} pieces"))
                }
                _ => fault,
            })?;
            if words.take_dots()? {
                let second = words.next("the opposite corner, such as `(10,10)`")?;
                Spot::between(corner, block(words, second)?)
            } else {
                Spot::between(corner, corner)
            }
        }
    };
    Ok(Spanned { value, bytes: words.bytes(words.span(first, words.last())) })
}

fn block(words: &Tokenizer<'_>, word: &str) -> Result<Block, TextFault> {
    let block: Block = word.parse().map_err(|_| words.wrong(word, BLOCK).instead(nearest(word, [RANDOM])))?;
    if block.x < 0 || block.y < 0 {
        return Err(words.fault(word, format!("found `{word}`, but every area starts at (0,0)")));
    }
    Ok(block)
}

fn pieces(words: &mut Tokenizer<'_>) -> Result<u32, TextFault> {
    const EXPECTED: &str = "a number of pieces of luggage, such as `4`";
    let word = words.next(EXPECTED)?;
    word.parse().map_err(|_| words.wrong(word, EXPECTED))
}

/// Refuses an airplane for which no robot is woken.
fn some(words: &Tokenizer<'_>, drawn: RandomRange<u32>) -> Result<RandomRange<u32>, TextFault> {
    let last = words.last();
    match drawn.most {
        0 => Err(words.fault(last, format!("found `{last}`, expected at least 1 piece"))),
        _ => Ok(drawn),
    }
}

/// Refuses several robots in one event.
fn several(words: &Tokenizer<'_>, first: &str) -> Result<(), TextFault> {
    let rest = if first.is_empty() { "" } else { words.rest(first).trim_end() };
    let robots = || rest.split([',', ' ', '\t']).filter(|word| !matches!(*word, "" | "and" | "&"));
    if robots().nth(1).is_none() || !robots().all(|word| number(word).is_some()) {
        return Ok(());
    }
    let each: Vec<&str> = robots().collect();
    let fault = words.fault(rest, format!("found {} robots, expected one in an event", each.len()));
    let start = words.before(first).trim();
    // The time since the event before is counted once.
    let mut of_start = start.split_whitespace();
    let again = match (of_start.next(), of_start.nth(1), of_start.next()) {
        (Some("then"), Some(event), None) => format!("then 0s {event}"),
        (Some("then"), ..) => return Err(fault.help("write an event for each of them, in a line of its own")),
        _ => start.to_owned(),
    };
    Err(fault.instead(Some(each.join(&format!("; {again} ")))))
}

/// The number of a robot, written as a number or as a name that ends with it.
fn robot(words: &mut Tokenizer<'_>) -> Result<u32, TextFault> {
    let word = words.next(ROBOT)?;
    if let Some(number) = words.peek().filter(|next| word.eq_ignore_ascii_case("robot") && next.parse::<u32>().is_ok())
    {
        let span = words.span(word, number);
        return Err(words.wrong(span, ROBOT).instead(Some(number)));
    }
    number(word).ok_or_else(|| words.wrong(word, ROBOT))
}

/// The number at the end of a word.
fn number(word: &str) -> Option<u32> {
    let digits = &word[word.trim_end_matches(|sign: char| sign.is_ascii_digit()).len()..];
    digits.parse().ok().filter(|number| *number > 0 && !word.starts_with(['-', '+', '(']))
}
