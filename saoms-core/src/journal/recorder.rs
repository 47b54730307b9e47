use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};

use saoms_api::host::Phase;
use saoms_api::{Cause, Record, Value};

use super::batch::{Batch, Note, OUTSIDE};
use super::fingerprint::{fingerprint, fingerprint_of_change};

/// The journal records of a component while its code runs, and the state of each of its loops on the way from
/// symptom to effect.
#[derive(Debug, Default)]
pub(crate) struct Recorder {
    present: Option<u16>,
    /// The number of the present execution, from 1.
    execution: u64,
    /// State of the component outside all loops.
    outside: CauseChain,
    loops: Vec<LoopState>,
    /// The newest change of each entry by each loop. Code of a library may name any number of entries.
    changes: HashMap<&'static str, Vec<(u16, Cause)>>,
    /// Records to be delivered.
    pub(crate) batch: Batch,
    pub(crate) notices: Vec<Notice>,
}

/// Notices that are delivered beside the records.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Notice {
    /// The name of the loop at this place.
    Name(u16, String),
    /// A decision of this loop, made in an earlier execution, has now had an effect.
    Acted(u16),
}

/// Origin of records: the run's counter of records, the component and the time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stamp<'a> {
    pub(crate) ids: &'a AtomicU64,
    pub(crate) component: u32,
    pub(crate) time: u64,
}

/// The causal chain of one execution of one loop: symptom, decision, newest effect.
#[derive(Clone, Copy, Debug, Default)]
struct CauseChain {
    because: Cause,
    symptom: Option<RecordRef>,
    decision: Option<RecordRef>,
    newest: Cause,
}

/// A reference to a record that was written.
#[derive(Clone, Copy, Debug)]
struct RecordRef {
    fingerprint: u64,
    id: Cause,
    /// Its index in the batch, if it is new.
    at: Option<u32>,
    acted: bool,
}

/// The state of a loop in the last execution in which it wrote, and in the one before.
#[derive(Debug, Default)]
struct LoopState {
    /// The number of the execution, from 1.
    execution: u64,
    chain: CauseChain,
    last: CauseChain,
    /// Digests, causes and numbers of its effects.
    effects: Vec<(u64, Cause, Cause)>,
    /// Those of the execution before, in order.
    last_effects: Vec<(u64, Cause, Cause)>,
}

impl Recorder {
    /// True if there is nothing to deliver.
    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        self.batch.is_empty() && self.notices.is_empty()
    }

    /// Begins an execution, or a call whose caller has this cause.
    #[inline]
    pub(crate) fn begin(&mut self, because: Cause) {
        self.present = None;
        self.outside = CauseChain::because(because);
    }

    /// Clears the state, for a new instance of the component.
    pub(crate) fn reset(&mut self) {
        self.loops.clear();
        self.changes.clear();
    }

    pub(crate) fn name(&mut self, place: u32, name: &str) {
        self.notices.push(Notice::Name(bounded(place), name.to_owned()));
    }

    /// Sets the loop that writes from now on in this execution. Its state is brought to this execution when it writes:
    /// most loops write nothing in most executions.
    #[inline]
    pub(crate) fn enter(&mut self, place: Option<u32>, execution: u64) {
        self.present = place.map(bounded);
        self.execution = execution + 1;
    }

    pub(crate) fn because(&mut self, cause: Cause) {
        match self.loop_state() {
            Some(state) => state.chain.because = cause,
            None => self.outside = CauseChain::because(cause),
        }
    }

    #[inline]
    pub(crate) fn cause(&self) -> Cause {
        let chain = match self.present {
            Some(place) if self.has_chain() => &self.loops[usize::from(place)].chain,
            Some(_) => return Cause::default(),
            None => &self.outside,
        };
        if chain.newest == Cause::default() { chain.because } else { chain.newest }
    }

    fn loop_state(&mut self) -> Option<&mut LoopState> {
        self.present.map(|place| self.state_of(place))
    }

    /// The state of a loop, brought to the present execution.
    fn state_of(&mut self, place: u16) -> &mut LoopState {
        let place = usize::from(place);
        if self.loops.len() <= place {
            self.loops.resize_with(place + 1, LoopState::default);
        }
        let state = &mut self.loops[place];
        state.come_to(self.execution);
        state
    }

    fn chain(&mut self) -> &mut CauseChain {
        match self.present {
            Some(place) => &mut self.state_of(place).chain,
            None => &mut self.outside,
        }
    }

    /// True if the present loop wrote in this execution, or no loop writes.
    fn has_chain(&self) -> bool {
        self.present.is_none_or(|place| {
            self.loops.get(usize::from(place)).is_some_and(|state| state.execution == self.execution)
        })
    }

    /// The loop that writes at present.
    pub(crate) fn present(&self) -> Option<u16> {
        self.present
    }

    /// Writes a symptom, decision or effect of the present loop, unless its last execution wrote the same. A symptom
    /// without a given cause follows from the newest change that another loop made to an entry which this one `senses`.
    pub(crate) fn write(&mut self, stamp: Stamp<'_>, phase: Phase, record: &Record, senses: &[String]) {
        let fingerprint = fingerprint(phase, record);
        match phase {
            Phase::Symptom => self.symptom(stamp, fingerprint, record, senses),
            Phase::Decision => self.decision(stamp, fingerprint, record),
            Phase::Effect => self.effect(stamp, fingerprint, record),
        }
    }

    fn symptom(&mut self, stamp: Stamp<'_>, fingerprint: u64, record: &Record, senses: &[String]) {
        let before = self.loop_state().and_then(|state| state.last.symptom);
        let reference = match before.filter(|before| before.fingerprint == fingerprint) {
            Some(before) => before,
            None => {
                let because = self.chain().because;
                let cause = if because == Cause::default() { self.newest_sensed(senses) } else { because };
                self.push(stamp, Phase::Symptom, fingerprint, cause, false, record)
            }
        };
        *self.chain() =
            CauseChain { because: Cause::default(), symptom: Some(reference), decision: None, newest: reference.id };
    }

    /// The newest change of one of these entries by another loop.
    fn newest_sensed(&self, senses: &[String]) -> Cause {
        let Some(present) = self.present else { return Cause::default() };
        let sensed = senses.iter().filter_map(|entry| self.changes.get(entry.as_str())).flatten();
        let by_others = sensed.filter(|(by, _)| *by != present);
        by_others.map(|(_, cause)| *cause).max().unwrap_or_default()
    }

    fn decision(&mut self, stamp: Stamp<'_>, fingerprint: u64, record: &Record) {
        let cause = self.chain().reason();
        let before =
            self.loop_state().and_then(|state| state.last.decision.filter(|_| state.last.symptom_id() == cause));
        let reference = match before.filter(|before| before.fingerprint == fingerprint) {
            Some(before) => RecordRef { at: None, ..before },
            None => self.push(stamp, Phase::Decision, fingerprint, cause, false, record),
        };
        let chain = self.chain();
        (chain.decision, chain.newest) = (Some(reference), reference.id);
    }

    fn effect(&mut self, stamp: Stamp<'_>, fingerprint: u64, record: &Record) {
        self.acted();
        let cause = self.chain().cause_of_effect();
        let before = self.loop_state().and_then(|state| state.repeated(fingerprint, cause));
        let effect = before.unwrap_or_else(|| {
            let reference = self.push(stamp, Phase::Effect, fingerprint, cause, false, record);
            (fingerprint, cause, reference.id)
        });
        self.chain().newest = effect.2;
        if let Some(state) = self.loop_state() {
            state.effects.push(effect);
        }
    }

    /// Records a change of an entry of the knowledge by the present loop.
    pub(crate) fn changed(&mut self, stamp: Stamp<'_>, entry: &'static str, before: Value, after: Value) {
        if before.is_same(after) {
            return;
        }
        self.acted();
        let values = [Value::Word(entry), before, after];
        let record = Record::new(entry, "{entry}: {before} -> {after}", "entry,before,after,", &values);
        let cause = self.chain().cause_of_effect();
        let fingerprint = fingerprint_of_change(entry, before, after);
        let id = self.push(stamp, Phase::Effect, fingerprint, cause, true, &record).id;
        if cause == Cause::default() {
            // A measured value explains nothing: what follows has its own reasons.
            return;
        }
        self.chain().newest = id;
        let by = self.present.unwrap_or(OUTSIDE);
        let changes = self.changes.entry(entry).or_default();
        match changes.iter_mut().find(|(place, _)| *place == by) {
            Some(known) => known.1 = id,
            None => changes.push((by, id)),
        }
    }

    /// Marks the present decision as one with an effect, a message or a call.
    #[inline]
    pub(crate) fn acted(&mut self) {
        if !self.has_chain() {
            return;
        }
        let Some(decision) = self.chain().decision.as_mut().filter(|decision| !decision.acted) else {
            return;
        };
        decision.acted = true;
        match decision.at {
            Some(at) => {
                if let Some(head) = self.batch.head_mut(at) {
                    head.acted = true;
                }
            }
            None => self.notices.push(Notice::Acted(self.present.unwrap_or(OUTSIDE))),
        }
    }

    fn push(
        &mut self,
        stamp: Stamp<'_>,
        phase: Phase,
        fingerprint: u64,
        cause: Cause,
        change: bool,
        record: &Record,
    ) -> RecordRef {
        let Stamp { ids, component, time } = stamp;
        let id = Cause(ids.fetch_add(1, Ordering::Relaxed) + 1);
        let at = Some(self.batch.len() as u32);
        let place = self.present.unwrap_or(OUTSIDE);
        self.batch.push(&Note { id, time, cause, fingerprint, component, place, phase, change, record });
        RecordRef { fingerprint, id, at, acted: false }
    }
}

impl LoopState {
    /// Begins an execution, unless it has begun.
    fn come_to(&mut self, execution: u64) {
        if self.execution == execution {
            return;
        }
        let chain = std::mem::take(&mut self.chain);
        std::mem::swap(&mut self.effects, &mut self.last_effects);
        self.effects.clear();
        // One execution may have very many: each is looked up by halves. Of equal ones the oldest comes first.
        self.last_effects.sort_unstable();
        // A loop that did not write in the execution before starts with an empty state.
        self.last = if self.execution + 1 == execution { chain } else { CauseChain::default() };
        if self.execution + 1 != execution {
            self.last_effects.clear();
        }
        self.execution = execution;
    }

    /// The effect of this digest and cause in the execution before.
    fn repeated(&self, fingerprint: u64, cause: Cause) -> Option<(u64, Cause, Cause)> {
        let place = self.last_effects.partition_point(|(digest, reason, _)| (*digest, *reason) < (fingerprint, cause));
        self.last_effects.get(place).copied().filter(|(digest, reason, _)| (*digest, *reason) == (fingerprint, cause))
    }
}

impl CauseChain {
    fn because(cause: Cause) -> CauseChain {
        CauseChain { because: cause, ..CauseChain::default() }
    }

    fn symptom_id(&self) -> Cause {
        self.symptom.map_or(Cause::default(), |symptom| symptom.id)
    }

    /// Cause of a decision.
    fn reason(&self) -> Cause {
        self.symptom.map_or(self.because, |symptom| symptom.id)
    }

    fn cause_of_effect(&self) -> Cause {
        self.decision.map_or_else(|| self.reason(), |decision| decision.id)
    }
}

/// No component has so many loops.
fn bounded(place: u32) -> u16 {
    u16::try_from(place).unwrap_or(OUTSIDE).min(OUTSIDE - 1)
}
