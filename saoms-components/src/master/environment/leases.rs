//! What robots of other programs have on a lease.

use std::time::Duration;

use saoms_api::{Context, Failure, record, warn};

use super::MasterEnvironment;

/// Number of periods after which a master counts as held up: what robots said meanwhile may be on its way.
const HELD_UP: u32 = 4;

impl MasterEnvironment {
    /// Answers robots that have luggage on a lease, and gives luggage to others whose robot was not heard for the time
    /// of its lease. What robots said about luggage has been heard before: who takes it without a lease goes first.
    pub(super) fn hear_leases(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let now = context.now();
        for (header, lease) in context.receive(&self.leases).with_headers() {
            if self.knowledge.accepts(lease, header, context)
                && let Some(answer) = self.knowledge.hear_lease(lease, now)
            {
                context.because(header.cause);
                context.send(&self.assignments, answer)?;
            }
        }
        context.because(saoms_api::Cause::default());
        let since_last = self.executed_at.replace(now).map_or(Duration::ZERO, |last| now.since(last));
        let held_up = if since_last > context.period() * HELD_UP { since_last } else { Duration::ZERO };
        for (lapsed, told) in self.knowledge.take_lapsed(now, held_up) {
            let (luggage, from, robot) = (lapsed.request.luggage, lapsed.request.from, lapsed.robot);
            let record = record!(
                passes_luggage_on: "luggage {luggage} waits again at {from}: nothing was heard of robot {robot} for the time of its lease",
                luggage,
                from,
                robot
            );
            warn!(context, "{record}");
            context.effect(record);
            told.map_or(Ok(()), |told| context.send(&self.assignments, told))?;
            self.request(lapsed.request, context)?;
        }
        Ok(())
    }
}
