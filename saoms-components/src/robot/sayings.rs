//! Messages of a robot about itself and its job.

use saoms_api::{Context, Failure, Publisher};

use super::{JobEnd, RobotKnowledge};
use crate::messages::{CriticalKind, CriticalSituation, EventLuggage, LuggageStage, Position, Priority, RobotList};

impl RobotKnowledge {
    /// Reports the outcome of a job. Luggage that this robot could not collect waits again for the others, or for the
    /// master that assigned it.
    pub(super) fn report_outcome(
        &mut self,
        luggage: Publisher<EventLuggage>,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let Some(JobEnd { job, stage }) = self.untold.take() else { return Ok(()) };
        context.send(&luggage, job.response(self.number, self.block, stage))?;
        if stage == LuggageStage::Refused {
            self.lists.requests.refuse(job.luggage, Some(job.from));
            if self.visits || self.is_assigned {
                // The master asks the others.
                return Ok(());
            }
            context.send(&luggage, EventLuggage::request(job.luggage, job.from, job.to))?;
        }
        Ok(())
    }

    /// Its position message if it wants no block beyond those that it holds.
    pub fn position(&self) -> Position {
        Position {
            robot: self.number,
            block: self.block,
            next: self.next,
            wanted: self.next,
            priority: Priority { rank: 0, robot: self.number },
        }
    }

    /// Kind of its critical situation.
    pub fn critical_kind(&self) -> CriticalKind {
        match self.job {
            // Nobody takes over blocks to visit: the master asks for them again.
            Some(_) if self.visits => CriticalKind::Idle,
            Some(_) if self.variables.has_luggage => CriticalKind::CarriesLuggage,
            Some(_) => CriticalKind::OnTheWay,
            None => CriticalKind::Idle,
        }
    }

    /// Its request for a healer.
    pub fn situation(&self, kind: CriticalKind) -> CriticalSituation {
        let job = self.job.filter(|_| !self.visits);
        let (luggage, from, to) = job.map_or((0, self.block, self.block), |job| (job.luggage, job.from, job.to));
        CriticalSituation {
            critical: self.number,
            block: self.block,
            luggage,
            from,
            to,
            kind,
            ..CriticalSituation::default()
        }
    }

    /// Its state message.
    pub fn robot(&self, active: bool) -> RobotList {
        RobotList {
            robot: self.number,
            active,
            battery: self.battery.percent(),
            in_charge: self.variables.in_charge,
            asleep: self.variables.asleep,
            charger: self.charge_block,
            period: self.period,
            block: self.block,
            policy: self.policy,
            began: self.began,
        }
    }
}
