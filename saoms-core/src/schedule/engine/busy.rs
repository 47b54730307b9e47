//! What becomes of a component that called another one whose code was running: calls never wait.

use std::sync::Arc;

use saoms_api::Failure;

use super::slot::PendingRequest;
use super::trace::TraceStep;
use super::{Engine, RunPhase};
use crate::observe::Occurrence;
use crate::schedule::component::body::{Body, Job};
use crate::schedule::component::part::Part;
use crate::schedule::settings::nanos;

impl Engine {
    /// True if the job failed because a component that it called was busy, and is tried again.
    #[cold]
    pub(crate) fn tries_again(&self, index: u32, job: Job, failure: &Failure, part: &Part) -> bool {
        let slot = &self.slots[index as usize];
        part.busy_provider(failure).is_some()
            && !part.held
            && match job {
                Job::Execute | Job::React => true,
                Job::Start => self.phase == RunPhase::Running && slot.pending == PendingRequest::None,
                Job::Shutdown => part.retries_shutdown,
                Job::Ask | Job::Describe | Job::Sample | Job::Order | Job::Save => false,
            }
    }

    /// Skips an execution, and puts its messages back. A start and a shutdown are tried again.
    #[cold]
    pub(crate) fn skip(&mut self, index: u32, mut body: Box<Body>, job: Job, failure: &Failure, now: u64) {
        let provider = failure.busy_provider().unwrap_or_default();
        let slot = &mut self.slots[index as usize];
        slot.statistics.busy += 1;
        if !std::mem::replace(&mut slot.skipping, true) {
            self.emit(now, index, Occurrence::Busy { provider: Arc::from(provider) });
        }
        self.step(now, index, TraceStep::Skipped);
        body.part.collection.reset();
        self.note_saved(&body.part, false, now);
        self.note_inbox(index);
        if job == Job::Execute {
            self.deliver(&mut body.part, now);
            let mut back = 0;
            for (subscription, inbox) in body.part.subscriptions.iter_mut().zip(&mut body.inboxes) {
                if inbox.is_empty() && !self.bus.has_region(subscription) {
                    // It had no news, and was not looked at.
                    continue;
                }
                back += self.bus.put_back(subscription, inbox);
            }
            self.slots[index as usize].statistics.received -= back;
        } else if job == Job::React {
            // Its messages stay for the next one.
            self.deliver(&mut body.part, now);
        } else {
            // The next try sends and votes again.
            self.record(&mut body.part, now);
            body.part.outbox.clear();
            body.part.sent_bytes = 0;
        }
        if job == Job::Start {
            self.keep_subscriptions(&mut body);
        }
        let vote = body.part.vote.take().filter(|_| matches!(job, Job::Execute | Job::React));
        let slot = &mut self.slots[index as usize];
        slot.body = Some(body);
        let retry = if slot.policy.period > 0 { slot.policy.period } else { nanos(slot.policy.backoff).max(1) };
        if let Some(vote) = vote {
            self.vote(index, vote, now);
        }
        match job {
            Job::Execute | Job::React => {
                if job == Job::React {
                    self.react_again(index, now);
                }
                self.executed(index, now);
                self.slots[index as usize].skipping = true;
            }
            _ if self.phase != RunPhase::Stopping => self.enqueue(index, now.saturating_add(retry)),
            _ if self.out > 0 => self.ending_later.push(index),
            _ => self.ending.push_back(index),
        }
    }
}
