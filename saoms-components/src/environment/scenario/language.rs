//! The language of scenarios, for the checker and editors.

use saoms_api::event::EventCall;
use saoms_api::extension::{
    Explanation, JudgedTexts, PropertyLanguage, PropertyText, PropertyTexts, RaisedEvent, submit,
};

use super::complete::{complete, meaning};
use super::{EventSpec, Scenario, Vocabulary};

submit! { PropertyLanguage { name: "scenario", words: WORDS, check, complete, explain } }

/// The words of the language.
const WORDS: &[&str] = &[
    "at", "from", "then", "every", "times", "until", "random", "to", "luggage", "visit", "by", "landing", "takeoff",
    "breakdown", "gone", "end",
];

/// Judges scenarios with the events that classes take.
fn check(texts: &PropertyTexts<'_>) -> JudgedTexts {
    let vocabulary = Vocabulary::with(texts.events).playing(texts.plays);
    let (scenario, findings) = Scenario::read_with(texts.property, texts.texts, vocabulary);
    let raised = scenario.lines.iter().filter_map(|line| match &line.event {
        EventSpec::Raised(event) => {
            let call = EventCall::read(event).ok()?;
            Some(RaisedEvent { text: line.text as usize, call: call.moved(line.bytes.start) })
        }
        _ => None,
    });
    JudgedTexts { findings, raised: raised.collect() }
}

/// The meaning of the word at a place.
fn explain(scenario: &PropertyText<'_>) -> Option<Explanation> {
    let PropertyText { text, at, events, .. } = *scenario;
    let is_part = |sign: char| sign.is_alphanumeric() || matches!(sign, '_' | '-');
    let start = text[..at].rfind(|sign| !is_part(sign)).map_or(0, |place| place + 1);
    let end = at + text[at..].find(|sign| !is_part(sign)).unwrap_or(text.len() - at);
    let line = text[..start].rfind(['\n', '\r']).map_or(0, |place| place + 1);
    if text[line..start].contains('#') {
        return None;
    }
    let word = &text[start..end];
    let meant = match events.get(word) {
        Some(event) => event.described(),
        None => Some(format!("`{word}`: {}", meaning(word))).filter(|_| !meaning(word).is_empty())?,
    };
    Some(Explanation { text: meant, bytes: start..end })
}
