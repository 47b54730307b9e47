//! The language of scenarios, for the checker and editors.

use saoms_api::event::EventCall;
use saoms_api::event::fault::FaultCall;
use saoms_api::extension::{
    Explanation, JudgedTexts, PropertyLanguage, PropertyText, PropertyTexts, RaisedEvent, RaisedFault, submit,
};

use super::complete::{complete, meaning};
use super::{EventSpec, Scenario, Vocabulary, line};

submit! { PropertyLanguage { name: "scenario", words: WORDS, check, complete, explain } }

/// The words of the language.
const WORDS: &[&str] = &[
    "at", "from", "then", "every", "times", "until", "random", "to", "luggage", "visit", "by", "landing", "takeoff",
    "breakdown", "gone", "end", "for", "lose", "violate", "delay", "jitter", "duplicate", "reorder", "cut", "part",
    "stall", "fail", "crash", "drift", "on", "restart",
];

/// Judges scenarios with the events that classes take.
fn check(texts: &PropertyTexts<'_>) -> JudgedTexts {
    let vocabulary = Vocabulary::with(texts.events).playing(texts.plays);
    let (scenario, findings) = Scenario::read_with(texts.property, texts.texts, vocabulary);
    let (mut raised, mut faults) = (Vec::new(), Vec::new());
    for line in &scenario.lines {
        let EventSpec::Raised(event) = &line.event else { continue };
        let (text, start) = (line.text as usize, line.bytes.start);
        if FaultCall::is_one(event) {
            // As it is written, so that its words have their places.
            let written = texts.texts.get(text).and_then(|all| line::split(&all[start..]).next());
            let call = written.and_then(|written| FaultCall::read(written).ok());
            faults.extend(call.map(|call| RaisedFault { text, call: call.moved(start) }));
        } else if let Ok(call) = EventCall::read(event) {
            raised.push(RaisedEvent { text, call: call.moved(start) });
        }
    }
    JudgedTexts { findings, raised, faults }
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
