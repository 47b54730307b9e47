//! Following the messages of a topic in all programs of a network.

use std::collections::{BTreeMap, HashMap};
use std::time::{Duration, Instant};

use serde_json::Value;

use super::asking::AGAIN;
use super::collected::Collected;
use super::{Programs, heading};
use crate::Exit;
use crate::output::eprint;

/// Time within which the first program has to answer.
const PATIENCE: Duration = Duration::from_secs(5);

/// A message of a topic.
pub(in crate::command::control) struct Followed {
    /// The program that told of it.
    pub(in crate::command::control) program: String,
    /// True if the topic had retained it before.
    pub(in crate::command::control) is_retained: bool,
    /// The message, with its component and time.
    pub(in crate::command::control) message: Value,
}

/// What a program tells, as far as it has arrived.
#[derive(Default)]
struct Told {
    collected: Collected,
    text: String,
}

impl Programs<'_> {
    /// Follows the messages of a topic, until `each` says that it is enough, or all programs have ended. What
    /// components send reaches several programs: one of them tells of each component.
    ///
    /// # Errors
    /// No program has the topic, or none answers, which was reported.
    pub(in crate::command::control) fn follow(
        &mut self,
        path: &str,
        until: Option<Instant>,
        mut each: impl FnMut(Followed) -> bool,
    ) -> Result<(), Exit> {
        let ask = self.new_request("GET", path, "");
        let (begun, mut asked_at) = (Instant::now(), None::<Instant>);
        let mut told: BTreeMap<u64, Told> = BTreeMap::new();
        let mut tellers: HashMap<String, u64> = HashMap::new();
        let mut refusal = None;
        while until.is_none_or(|until| Instant::now() < until) {
            if asked_at.is_none_or(|at| at.elapsed() >= AGAIN) {
                if asked_at.replace(Instant::now()).is_none() && self.only.is_none() {
                    self.put(&ask, 0, 0);
                }
                let open = told.iter().filter(|(_, one)| !one.collected.is_whole);
                open.for_each(|(program, one)| self.put(&ask, *program, one.collected.next));
                let new =
                    self.known.iter().filter(|(program, one)| !told.contains_key(program) && self.is_meant(&one.name));
                new.for_each(|(program, _)| self.put(&ask, *program, 0));
                let now = Instant::now();
                self.known.retain(|_, one| now.duration_since(one.heard) < 2 * Duration::from_millis(one.patience));
            }
            let is_followed = told.values().any(|one| one.collected.is_accepted());
            let is_over = |(program, one): (&u64, &Told)| one.collected.is_whole || !self.known.contains_key(program);
            if is_followed && told.iter().all(is_over) {
                return Ok(());
            }
            if !is_followed && begun.elapsed() >= PATIENCE {
                break;
            }
            let Some(answer) = self.next(&ask) else { continue };
            let program = answer.program;
            let one = told.entry(program).or_default();
            for text in one.collected.take(answer) {
                one.text.push_str(&text);
            }
            if !one.collected.is_accepted() {
                refusal = refusal.or_else(|| {
                    let value: Value = serde_json::from_str(&one.text).ok()?;
                    value["error"].as_str().map(str::to_owned)
                });
                continue;
            }
            let lost = std::mem::take(&mut one.collected.lost);
            if lost > 0 {
                eprint(&format!("warning: {lost} parts of what {} told were lost\n", heading(&one.collected.name)));
            }
            let name = one.collected.name.clone();
            for (event, data) in take_events(&mut one.text) {
                if event == "lost" {
                    eprint(&format!("warning: {data} messages came faster than they were read, and were lost\n"));
                    continue;
                }
                let Ok(message) = serde_json::from_str::<Value>(&data) else { continue };
                let component = message["component"].as_str().unwrap_or_default().to_owned();
                if *tellers.entry(component).or_insert(program) != program {
                    continue;
                }
                let is_retained = event == "retained";
                if !each(Followed { program: name.clone(), is_retained, message }) {
                    return Ok(());
                }
            }
        }
        if told.values().any(|one| one.collected.is_accepted()) {
            return Ok(());
        }
        Err(match refusal {
            Some(why) => self.fleet.refuse(&why, Exit::WrongInput),
            None => self.nobody(&self.silent(|_| false)),
        })
    }
}

/// Takes the whole server-sent events off a text: the name and the data of each.
fn take_events(text: &mut String) -> Vec<(String, String)> {
    let mut events = Vec::new();
    while let Some(end) = text.find("\n\n") {
        let event: String = text.drain(..end + 2).collect();
        let field = |name: &str| event.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(':'));
        if let Some(data) = field("data") {
            let name = field("event").unwrap_or("message").trim();
            events.push((name.to_owned(), data.trim_start().to_owned()));
        }
    }
    events
}

#[cfg(test)]
mod tests {
    use super::take_events;

    #[test]
    fn events_are_taken_whole() {
        let mut text = "event: retained\ndata: {\"a\":1}\n\n:\n\ndata: {\"b\"".to_owned();
        assert_eq!(take_events(&mut text), [("retained".to_owned(), "{\"a\":1}".to_owned())]);
        text.push_str(":2}\n\n");
        assert_eq!(take_events(&mut text), [("message".to_owned(), "{\"b\":2}".to_owned())]);
        assert!(text.is_empty());
    }
}
