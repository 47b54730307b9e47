//! The answer for people.

use std::borrow::Cow;
use std::collections::HashSet;
use std::fmt::Write;

use saoms_api::host::one_line;
use saoms_api::{Cause, Time};
use saoms_core::journal::{Chain, JournalDocument, JournalEntry, Why};

/// Reasons that are shown at most; of a longer chain, the first and the last ones.
const SHOWN: usize = 40;
/// The last ones among them.
const LAST: usize = 8;

/// The answer: actions, the reasons for them, and the knowledge at that time.
pub(super) fn human(component: &str, asked: Option<Time>, why: &Why<'_>, document: &JournalDocument) -> String {
    let component = &one_line(component);
    let Some(time) = why.time else { return nothing(component, asked, document) };
    let mut text = match asked.filter(|asked| *asked != time) {
        Some(asked) => {
            format!("The last action of {component} until {asked} was at {time}; this led to it:\n")
        }
        None => format!("{component} acted at {time}; this led to it:\n"),
    };
    for (place, chain) in why.chains.iter().enumerate() {
        text.push('\n');
        text.push_str(&table(chain, &why.chains[..place]));
    }
    if !why.knowledge.is_empty() {
        let when = asked.or(document.end).unwrap_or(time);
        let _ = writeln!(text, "\nWhat it knew at {when}:\n");
        let shown: Vec<(String, String)> = why
            .knowledge
            .iter()
            .map(|known| {
                let since = known.since.map_or("from before".to_owned(), |since| format!("since {since}"));
                (one_line(&known.shown()).into_owned(), since)
            })
            .collect();
        let names = why.knowledge.iter().map(|known| known.entry.chars().count()).max().unwrap_or(0);
        let values = shown.iter().map(|(value, _)| value.chars().count()).max().unwrap_or(0);
        for (known, (value, since)) in why.knowledge.iter().zip(&shown) {
            let _ = writeln!(text, "  {:names$}  {value:values$}  {since}", known.entry);
        }
    }
    text
}

fn nothing(component: &str, asked: Option<Time>, document: &JournalDocument) -> String {
    let own = document.journal.of(component);
    match (asked, own.first()) {
        (Some(asked), Some(first)) => {
            format!(
                "{component} had done nothing until {asked}: its first record in the journal is at {}\n",
                first.time()
            )
        }
        _ => {
            format!("{component} has no records in the journal of this run: none of its loops found a reason to act\n")
        }
    }
}

/// One line in the table.
struct Row<'a> {
    number: String,
    entry: Option<&'a JournalEntry>,
    text: String,
}

/// The number of reasons of a chain that are shown: up to the first record, that one included, which an earlier chain
/// goes through as well.
fn shown_anew(chain: &Chain<'_>, earlier: &[Chain<'_>]) -> usize {
    let known: HashSet<Cause> =
        earlier.iter().flat_map(|chain| chain.acts.iter().chain(&chain.reasons)).map(|one| one.id()).collect();
    let all = chain.reasons.len();
    let common = chain.reasons.iter().position(|reason| known.contains(&reason.id()));
    // The line that replaces the omitted ones has to save at least one line.
    common.map(|common| common + 1).filter(|anew| anew + 1 < all).unwrap_or(all)
}

/// A chain line by line, without the records that earlier chains have shown.
fn table(chain: &Chain<'_>, earlier: &[Chain<'_>]) -> String {
    let mut rows: Vec<Row<'_>> = Vec::new();
    for (place, act) in chain.acts.iter().enumerate() {
        let number = if place == 0 { "1".to_owned() } else { String::new() };
        rows.push(Row { number, entry: Some(act), text: one_line(&act.text()).into_owned() });
    }
    let anew = shown_anew(chain, earlier);
    let elided = anew.saturating_sub(SHOWN);
    let kept = SHOWN - LAST;
    for (place, reason) in chain.reasons[..anew].iter().enumerate() {
        if elided > 0 && place == kept {
            let text = format!("... {elided} more; --format json shows all ...");
            rows.push(Row { number: String::new(), entry: None, text });
        }
        if elided == 0 || place < kept || place >= kept + elided {
            rows.push(Row {
                number: (place + 2).to_string(),
                entry: Some(reason),
                text: one_line(&reason.text()).into_owned(),
            });
        }
    }
    if anew < chain.reasons.len() {
        rows.push(Row { number: String::new(), entry: None, text: "... and so on as above ...".to_owned() });
    } else if chain.missing.is_some() {
        let text = "... earlier causes are not in the journal any more ...".to_owned();
        rows.push(Row { number: String::new(), entry: None, text });
    }
    let width = |cell: &dyn Fn(&Row<'_>) -> usize| rows.iter().map(cell).max().unwrap_or(0);
    let number = width(&|row| row.number.len());
    let time = width(&|row| row.entry.map_or(0, |entry| entry.time().to_string().len()));
    let component = width(&|row| row.entry.map_or(0, |entry| one_line(entry.component()).chars().count()));
    let by = width(&|row| row.entry.map_or(0, |entry| loop_of(entry).chars().count()));
    let mut text = String::new();
    for row in &rows {
        let _ = match row.entry {
            Some(entry) => writeln!(
                text,
                "  {:>number$}  {:>time$}  {:component$}  {:by$}  {:8}  {}",
                row.number,
                entry.time().to_string(),
                one_line(entry.component()),
                loop_of(entry),
                entry.phase().name(),
                row.text
            ),
            None => writeln!(text, "  {:>number$}  {}", "", row.text),
        };
    }
    text
}

fn loop_of(entry: &JournalEntry) -> Cow<'_, str> {
    one_line(entry.loop_name().unwrap_or("-"))
}
