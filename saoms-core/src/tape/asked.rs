use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use super::{Act, ActKind, Step, StepKind};

/// The tape of a component that is recorded, while it is written.
#[derive(Debug, Default)]
pub(crate) struct Tape {
    /// The numbers of the observers that want it.
    pub(crate) observers: Arc<[u32]>,
    /// The number of the next step.
    number: u64,
    /// The step that is open.
    step: Option<Step>,
    /// The last answer to each question: only another one is noted.
    known: HashMap<(ActKind, u64, String), Vec<u8>>,
    /// How often it asked in the present step what may be answered otherwise each time.
    asked: [u64; 3],
    has_drawn: bool,
    /// Names that loops gave themselves, by their places.
    pub(crate) loops: BTreeMap<u16, String>,
    /// The topics of its publishers, by their numbers.
    pub(crate) publishers: Vec<String>,
}

impl Tape {
    pub(crate) fn new(observers: Vec<u32>) -> Tape {
        Tape { observers: observers.into(), ..Tape::default() }
    }

    /// True while a step is open.
    #[inline]
    pub(crate) fn is_open(&self) -> bool {
        self.step.is_some()
    }

    /// Begins a step.
    pub(crate) fn begin(&mut self, kind: StepKind, (time, due): (u64, u64), execution: u64, cause: u64) {
        let (number, heard, acts, failure) = (self.number, Vec::new(), Vec::new(), None);
        self.number += 1;
        self.asked = [0; 3];
        self.has_drawn = false;
        if kind == StepKind::Start {
            // Whoever reads the tape from here on knows nothing of what was before.
            self.known.clear();
            self.loops.clear();
            self.publishers.clear();
        }
        // Time stands still unless the component sees that it does not.
        self.known.insert((ActKind::Now, 0, String::new()), time.to_le_bytes().to_vec());
        self.step = Some(Step { number, kind, time, due, execution, cause, heard, acts, failure });
    }

    /// The step that is open.
    pub(crate) fn open(&mut self) -> Option<&mut Step> {
        self.step.as_mut()
    }

    /// Notes something in the step that is open.
    pub(crate) fn note(&mut self, act: Act) {
        if let Some(step) = &mut self.step {
            step.acts.push(act);
        }
    }

    /// Notes that what was noted last was refused, if it was.
    pub(crate) fn note_refusal<T, E: std::fmt::Display>(&mut self, result: &Result<T, E>) {
        if let Err(error) = result {
            self.note(Act::new(ActKind::Refused, 0, "").with(error.to_string()));
        }
    }

    /// Notes the answer to a question, unless it is known.
    pub(crate) fn answered(&mut self, what: ActKind, number: u64, name: &str, answer: &[u8]) {
        let fleeting = [ActKind::Now, ActKind::Date, ActKind::Cancelled].iter().position(|one| *one == what);
        let place = fleeting.map_or(0, |place| {
            self.asked[place] += 1;
            self.asked[place] - 1
        });
        let key = (what, number, name.to_owned());
        if self.known.get(&key).is_none_or(|known| known != answer) {
            self.known.insert(key, answer.to_vec());
            self.note(Act::new(what, number, name).other(place).with(answer));
        }
    }

    /// Notes the source of chance before the first number is drawn in a step.
    pub(crate) fn draws(&mut self, state: impl FnOnce() -> Vec<u8>) {
        if !std::mem::replace(&mut self.has_drawn, true) {
            self.note(Act::new(ActKind::Chance, 0, "").with(state()));
        }
    }

    /// Ends the step that is open.
    pub(crate) fn end(&mut self, failure: Option<String>) -> Option<Step> {
        let mut step = self.step.take()?;
        step.failure = failure;
        Some(step)
    }
}
