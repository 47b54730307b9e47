//! What can be counted in a running fleet.

use super::engine::Engine;
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
        lateness: locked(shared, Engine::lateness),
        numbers,
        loops: locked(shared, Engine::loops),
        queues: locked(shared, Engine::queues),
    }
}

fn locked<T>(shared: &Shared, count: impl FnOnce(&Engine) -> T) -> T {
    let engine = shared.lock();
    let counted = count(&engine);
    shared.release(engine);
    counted
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
