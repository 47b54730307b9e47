use super::Engine;
use super::ending::EndCause;
use super::slot::Slot;
use super::trace::Trace;
use crate::journal::Journal;
use crate::report::{
    ComponentReport, Label, LatenessSummary, MessageCounts, Outcome, RunReport, RunStatus, Sections, Votes,
};

/// Maximum number of components that a reason names; the votes name all.
const REASON_NAMES: usize = 3;

impl Engine {
    /// The report of a run that has ended.
    pub(crate) fn report(&self, sections: &Sections) -> RunReport {
        let mut sections = sections.clone();
        for (kind, count) in self.faults.counts() {
            sections.add(&format!("faults.applied.{kind}"), i64::try_from(count).unwrap_or(i64::MAX));
        }
        let lost: u64 = self.networks.lost().map(|(_, count)| count).sum();
        if lost > 0 {
            sections.add("networks.lost", i64::try_from(lost).unwrap_or(i64::MAX));
        }
        RunReport {
            seed: self.seed,
            time_s: self.ended.0 as f64 / 1e9,
            periods: self.slots.iter().map(|slot| slot.statistics.executions).sum(),
            sections: sections.to_json(),
            components: self.components(),
            journal: self.journal(),
            adaptation: None,
            votes: self.votes_report(),
            standstill: self.standstill.told.clone(),
            outcome: self.outcome(),
            trace_hash: self.trace.as_ref().map(Trace::digits),
            recording: None,
            part: self.networks.elsewhere.part().cloned(),
            nodes: Vec::new(),
        }
    }

    fn journal(&self) -> Journal {
        let rings = self.slots.iter().filter(|slot| slot.joined).map(|slot| (&slot.name, &slot.journal));
        let mut journal = Journal::of_rings(rings, &self.outside);
        journal.lost = self.lost_records;
        journal
    }

    fn components(&self) -> Vec<ComponentReport> {
        // All components that ever joined the fleet.
        let joined = self.slots.iter().filter(|slot| slot.joined);
        joined.map(|slot| self.component_report(slot)).collect()
    }

    pub(super) fn component_report(&self, slot: &Slot) -> ComponentReport {
        let (statistics, Label { name, id, class }) = (&slot.statistics, &slot.label);
        ComponentReport {
            name: name.clone(),
            id: id.clone(),
            class: class.clone(),
            executions: statistics.executions,
            missed: statistics.missed,
            reactions: statistics.reactions,
            late_us: if self.real { statistics.late.summary() } else { LatenessSummary::default() },
            deadline_misses: statistics.deadline_misses,
            slow: statistics.slow,
            busy: statistics.busy,
            restarts: slot.restarts,
            replaced: slot.statistics.replaced,
            failures: statistics.failures,
            dropped: statistics.dropped + statistics.unkept,
            messages: MessageCounts { sent: statistics.sent, received: statistics.received },
        }
    }

    fn votes_report(&self) -> Votes {
        let names = |has_voted: fn(&Slot) -> bool| {
            self.slots.iter().filter(|slot| has_voted(slot)).map(|slot| slot.name.to_string()).collect()
        };
        Votes {
            done: self.votes.done as u64,
            open: names(|slot| slot.sees_work == Some(true)),
            given_up: names(|slot| slot.gave_up),
        }
    }

    /// The names of some components for a reason; `None` where there are none.
    fn names(&self, are_meant: impl Fn(&Slot) -> bool) -> Option<String> {
        let mut names = self.slots.iter().filter(|slot| are_meant(slot)).map(|slot| format!("`{}`", slot.name));
        let shown: Vec<String> = names.by_ref().take(REASON_NAMES).collect();
        let more = names.count();
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        (!shown.is_empty()).then(|| format!("{}{more}", shown.join(", ")))
    }

    fn outcome(&self) -> Outcome {
        let mut reasons = self.reasons.clone();
        reasons.extend(self.networks.losses());
        let status = match self.cause {
            Some(EndCause::Interrupted) => RunStatus::Interrupted,
            cause if !reasons.is_empty() => {
                // What the failure left behind.
                let standstill = self.standstill.told.as_ref().filter(|_| cause == Some(EndCause::Standstill));
                reasons.extend(standstill.map(ToString::to_string));
                RunStatus::Failed
            }
            _ if let Some(names) = self.names(|slot| slot.gave_up) => {
                reasons.push(format!("work was given up, reported by {names}"));
                RunStatus::Incomplete
            }
            Some(EndCause::Standstill) => {
                reasons.extend(self.standstill.told.as_ref().map(ToString::to_string));
                RunStatus::Incomplete
            }
            Some(EndCause::Elapsed) => RunStatus::Elapsed,
            Some(EndCause::Stopped) => RunStatus::Stopped,
            Some(EndCause::Idle) => {
                let has_run = self.slots.iter().any(|slot| slot.statistics.executions > 0);
                let left_out = self.names(|slot| !has_run && slot.is_left_out());
                let which = left_out.as_ref().map(|names| format!(": nobody starts {names}")).unwrap_or_default();
                reasons.push(format!("no component is scheduled, and in virtual time nothing else happens{which}"));
                if left_out.is_some() { RunStatus::Incomplete } else { RunStatus::Done }
            }
            Some(EndCause::Done | EndCause::Lost | EndCause::Failed) | None => RunStatus::Done,
        };
        Outcome { status, reasons }
    }
}
