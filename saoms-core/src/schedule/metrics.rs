//! What can be counted in a running fleet.

use std::sync::atomic::Ordering;
use std::time::Duration;

use super::engine::Engine;
use super::os::sys;
use super::shared::Shared;
use crate::journal::LoopCounts;
use crate::report::LatenessSteps;
use crate::status::{FleetMetrics, FleetStatus, TopicReaderStatus};

/// The counts of a fleet of which this is the status. The engine is locked for one kind of them after the other, so
/// that its timer goes on between them.
pub(super) fn metrics(status: FleetStatus, shared: &Shared) -> FleetMetrics {
    let numbers = shared.sections().numbers().map(|(path, number)| (path.to_owned(), number)).collect();
    FleetMetrics {
        status,
        lateness: shared.look(Engine::lateness),
        numbers,
        loops: shared.look(Engine::loops),
        queues: shared.look(Engine::queues),
        networks: shared.look(|engine| engine.networks.lost().map(|(url, lost)| (url.to_owned(), lost)).collect()),
    }
}

/// A sign of life of the thread with the timer's work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimerSign {
    /// Number of the pieces of component code that it has begun: while it grows, the timer is alive.
    pub pieces: u64,
    /// Time for which the timer should have done something. A component that hangs does not hold it up for long, since
    /// another thread takes its work over. Zero in virtual time.
    pub overdue: Duration,
}

/// The sign of life at present, which waits for no lock.
pub(super) fn timer_sign(shared: &Shared) -> TimerSign {
    let present = shared.pulse.present();
    let is_watched = !shared.clock.is_virtual() && !shared.ended.load(Ordering::Acquire);
    let due = if is_watched { present.since.unwrap_or(present.next) } else { u64::MAX };
    TimerSign { pieces: present.piece, overdue: Duration::from_nanos(sys::monotonic().saturating_sub(due)) }
}

impl Engine {
    fn lateness(&self) -> Vec<(String, LatenessSteps)> {
        let measured = self.slots.iter().filter(|slot| self.real && slot.is_member() && slot.policy.periodic);
        measured.map(|slot| (slot.name.to_string(), slot.statistics.late.steps())).collect()
    }

    fn loops(&self) -> Vec<LoopCounts> {
        let members = self.slots.iter().filter(|slot| slot.is_member());
        members.flat_map(|slot| LoopCounts::of_ring(&slot.name, &slot.journal)).collect()
    }

    fn queues(&self) -> Vec<(String, TopicReaderStatus)> {
        let alive = self.slots.iter().filter(|slot| slot.is_member() && slot.is_alive());
        let bodies = alive.filter_map(|slot| slot.body.as_ref().map(|body| (slot, body)));
        let queues = bodies.flat_map(|(slot, body)| {
            body.part.subscriptions.iter().filter_map(|reader| {
                let (waiting, queue) = self.bus.waiting(reader)?;
                let topic = self.bus.name(self.bus.topic_of(reader)).to_string();
                let (waiting, queue) = (Some(waiting), Some(queue));
                Some((topic, TopicReaderStatus { component: slot.name.to_string(), waiting, queue }))
            })
        });
        queues.collect()
    }
}
