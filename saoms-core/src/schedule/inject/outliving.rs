//! What comes from outside, waits for its time, and outlives the program.

use saoms_api::{Level, Time};

use super::Due;
use crate::observe::Occurrence;
use crate::schedule::engine::Engine;
use crate::schedule::engine::memory::{InputForm, InputMessage, InputsForm};
use crate::schedule::order::{Order, PendingOrder};
use crate::schedule::topics::takers::EventMessage;

impl Engine {
    /// What comes from outside and waits for its time. Faults end with the program, and so does what they hold up.
    pub(in crate::schedule) fn waiting_inputs(&self) -> InputsForm {
        // They are due, and wait for code that runs.
        let orders = self.orders.accepted().map(|order| InputForm {
            at: 0,
            text: order.line(),
            is_order: true,
            is_event: false,
            messages: Vec::new(),
        });
        InputsForm { inputs: orders.chain(self.injected_inputs()).collect() }
    }

    /// The same without orders that are due.
    pub(in crate::schedule) fn injected_inputs(&self) -> Vec<InputForm> {
        let message = |topic: String, to: Option<u32>, bytes: &[u8]| {
            let to = to.and_then(|to| self.name_of(to)).map(|to| to.to_string()).unwrap_or_default();
            InputMessage { topic, to, bytes: bytes.to_vec() }
        };
        let input = |((at, _), due): (&(u64, u64), &Due)| {
            let (text, messages, is_order, is_event) = match due {
                Due::Message { topic, bytes, text, .. } => {
                    let topic = self.bus.name(*topic).to_string();
                    (text.clone(), vec![message(topic, None, bytes)], false, false)
                }
                Due::Event { messages, text } => {
                    let messages = messages.iter().map(|one| message(one.topic.clone(), one.to, &one.bytes));
                    (text.clone(), messages.collect(), false, true)
                }
                Due::Order(pending) => (pending.line(), Vec::new(), true, false),
                Due::Fault(..) | Due::Commit { .. } | Due::Late { .. } | Due::Settled => return None,
            };
            Some(InputForm { at: *at, text, is_order, is_event, messages })
        };
        self.injections.waiting.iter().filter_map(input).collect()
    }

    /// Lets what came from outside in an earlier program take effect at its time.
    pub(in crate::schedule) fn recall_inputs(&mut self, inputs: InputsForm, now: u64) {
        for InputForm { at, text, is_order, is_event, messages } in inputs.inputs {
            if is_order {
                match Order::read(&text) {
                    Some(Ok(read)) => {
                        let order = Due::Order(Box::new(PendingOrder::recalled(read.order)));
                        self.add_due(now, Some(Time::from_nanos(at)), order);
                    }
                    _ => self.note_forgotten(&text, now),
                }
                continue;
            }
            let mut recalled = Vec::new();
            for InputMessage { topic, to, bytes } in messages {
                let Some(id) = self.bus.find(&topic) else { continue };
                let to = if to.is_empty() { Some(None) } else { self.numbers.get(to.as_str()).copied().map(Some) };
                let schema = self.schema_of(id).1.clone().filter(|schema| schema.check(&bytes).is_ok());
                if let (Some(to), Some(schema)) = (to, schema) {
                    let marks = (schema.key(&bytes), schema.place(&bytes));
                    recalled.push((id, EventMessage { topic, to, bytes, marks }));
                }
            }
            let due = match recalled.len() {
                0 => {
                    self.note_forgotten(&text, now);
                    continue;
                }
                _ if is_event => Due::Event { messages: recalled.into_iter().map(|(_, one)| one).collect(), text },
                _ => {
                    let Some((topic, EventMessage { bytes, marks: (key, place), .. })) = recalled.pop() else {
                        continue;
                    };
                    Due::Message { topic, bytes, key, place, text }
                }
            };
            self.add_due(now, Some(Time::from_nanos(at)), due);
        }
    }

    fn note_forgotten(&mut self, text: &str, now: u64) {
        let text = format!("`{text}` was accepted before the restart, and the fleet has nobody for it any more");
        self.note(now, Occurrence::Note { level: Level::Warning, text });
    }
}
