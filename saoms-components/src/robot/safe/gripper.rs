use saoms_api::{Context, Failure, Loop, LoopClass, Publisher, Record, Recordable, record};

use crate::grid::Block;
use crate::hardware::Action;
use crate::messages::{EVENT_LUGGAGE, EventLuggage, FIRST_VISIT, LuggageStage, Position};
use crate::robot::{Job, JobEnd, RobotKnowledge};

use super::leg::Urgency;

/// Uses the gripper: collects luggage at its block and deposits it at its destination. Notes blocks that the robot
/// visits.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.GripperMS",
    knowledge = RobotKnowledge,
    senses("block", "busy", "hasLuggage", "job", "stops", "moving", "handling", "lasts", "wayHome"),
    effects("grip", "untold", "stops")
)]
pub struct SafeGripper {
    #[publishes(EVENT_LUGGAGE)]
    luggage: Publisher<EventLuggage>,
}

/// Work for the gripper.
#[derive(Clone, Copy, Debug)]
pub enum SafeGripperSymptom {
    /// The robot is at the block of its luggage.
    AtLuggage(Job),
    /// The robot is at the destination of its luggage.
    AtDestination(Job),
    /// The robot is at the next block that it visits.
    AtStop(Job, Block),
    /// Luggage was deposited, which is not reported yet.
    Deposited(Job),
    /// Luggage could not be collected, which is not reported yet.
    Failed(Job),
}

/// Action of the gripper.
#[derive(Clone, Copy, Debug)]
pub enum SafeGripperDecision {
    /// Start to collect.
    Collect(Job),
    /// Start to deposit.
    Deposit(Job),
    /// Go on to the next block to visit, or end the job.
    Visit(Job, Block),
    /// Report that the luggage is delivered.
    Tell(Job),
    /// Leave the luggage to other robots.
    Return(Job),
}

impl Recordable for SafeGripperSymptom {
    fn record(&self) -> Record {
        match *self {
            SafeGripperSymptom::AtLuggage(Job { luggage, from, .. }) => {
                record!(at_luggage: "is at {from}, where luggage {luggage} waits", from, luggage)
            }
            SafeGripperSymptom::AtDestination(Job { luggage, to, .. }) => {
                record!(at_destination_of_luggage: "is at {to}, where luggage {luggage} has to go", to, luggage)
            }
            SafeGripperSymptom::AtStop(Job { luggage, .. }, block) => {
                record!(at_block_to_visit: "is at {block}, which visit {visit} has", block, visit = luggage - FIRST_VISIT)
            }
            SafeGripperSymptom::Deposited(Job { luggage, .. }) => {
                record!(luggage_deposited: "has deposited luggage {luggage}", luggage)
            }
            SafeGripperSymptom::Failed(Job { luggage, from, .. }) => {
                record!(cannot_collect_luggage: "cannot collect luggage {luggage} at {from}", luggage, from)
            }
        }
    }
}

impl Recordable for SafeGripperDecision {
    fn record(&self) -> Record {
        match *self {
            SafeGripperDecision::Collect(Job { luggage, .. }) => {
                record!(collects_luggage: "collects luggage {luggage}", luggage)
            }
            SafeGripperDecision::Deposit(Job { luggage, .. }) => {
                record!(deposits_luggage: "deposits luggage {luggage}", luggage)
            }
            SafeGripperDecision::Visit(Job { luggage, .. }, block) => {
                record!(visits_block: "visits {block} for visit {visit}", block, visit = luggage - FIRST_VISIT)
            }
            SafeGripperDecision::Tell(Job { luggage, .. }) => {
                record!(announces_delivery: "announces that luggage {luggage} is delivered", luggage)
            }
            SafeGripperDecision::Return(Job { luggage, .. }) => {
                record!(leaves_luggage: "leaves luggage {luggage} to other robots", luggage)
            }
        }
    }
}

impl Loop for SafeGripper {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = SafeGripperSymptom;
    type Decision = SafeGripperDecision;

    fn initialize(&mut self, knowledge: &mut RobotKnowledge, _context: &mut Context<'_>) -> Result<(), Failure> {
        knowledge.polling.handling = true;
        Ok(())
    }

    fn monitor(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        if knowledge.hardware.is_handling() {
            knowledge.polled = knowledge.poll(context)?;
        }
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<SafeGripperSymptom>, Failure> {
        // What comes next follows from the action that is over, if it was the gripper's.
        context.because(context.cause());
        if let Some(JobEnd { job, stage }) = knowledge.untold {
            let delivered = stage == LuggageStage::Delivered;
            return Ok(Some(if delivered {
                SafeGripperSymptom::Deposited(job)
            } else {
                SafeGripperSymptom::Failed(job)
            }));
        }
        if knowledge.hardware.running().is_some() || knowledge.variables.critical || knowledge.stopped {
            return Ok(None);
        }
        if let Some(stop) = knowledge.stops.first().copied() {
            return Ok(knowledge.job_here().map(|job| SafeGripperSymptom::AtStop(job, stop)));
        }
        let has_luggage = knowledge.variables.has_luggage;
        let symptom = if has_luggage { SafeGripperSymptom::AtDestination } else { SafeGripperSymptom::AtLuggage };
        Ok(knowledge.job_here().map(symptom))
    }

    fn plan(
        &mut self,
        symptom: SafeGripperSymptom,
        _knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<SafeGripperDecision>, Failure> {
        Ok(Some(match symptom {
            SafeGripperSymptom::AtLuggage(job) => SafeGripperDecision::Collect(job),
            SafeGripperSymptom::AtDestination(job) => SafeGripperDecision::Deposit(job),
            SafeGripperSymptom::AtStop(job, block) => SafeGripperDecision::Visit(job, block),
            SafeGripperSymptom::Deposited(job) => SafeGripperDecision::Tell(job),
            SafeGripperSymptom::Failed(job) => SafeGripperDecision::Return(job),
        }))
    }

    fn execute(
        &mut self,
        decision: SafeGripperDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let action = match decision {
            SafeGripperDecision::Collect(job) => Some(Action::collect(job.luggage, job.from)),
            SafeGripperDecision::Deposit(job) => Some(Action::deposit(job.luggage, job.to)),
            SafeGripperDecision::Visit(..) => {
                knowledge.visit(context);
                None
            }
            SafeGripperDecision::Tell(_) | SafeGripperDecision::Return(_) => None,
        };
        if let Some(action) = action {
            knowledge.begin(context, action)?;
        }
        knowledge.report_outcome(self.luggage, context)
    }
}

impl RobotKnowledge {
    /// The job, if the robot is at its next destination, with enough energy to work there.
    pub(super) fn job_here(&mut self) -> Option<Job> {
        let destination = self.destination()?;
        if self.awaits_master > 0 && self.stops.len() == 1 {
            // It makes way for others meanwhile.
            return None;
        }
        let stands = self.next == self.block && self.reaches(destination, self.block);
        self.job.filter(|_| stands && self.may_handle() && !self.leaves_block())
    }

    /// True if a robot beside this one hardly reaches its charger, and has to pass this block, which this robot would
    /// keep while it handles its luggage.
    fn leaves_block(&self) -> bool {
        let (at, chargers) = (self.block, &self.lists.chargers);
        let comes_here = |other: &Position| {
            let place = chargers.binary_search_by_key(&other.robot, |(robot, _)| *robot);
            let is_own = other.priority.robot == other.robot;
            other.wanted == at || is_own && place.is_ok_and(|place| chargers[place].1 == at)
        };
        let waits =
            |other: &&Position| Urgency::Exhausted.is_at_most_that_of(other.priority) && other.block.distance(at) == 1;
        self.energy.handles_long() && self.traffic.near().iter().filter(waits).any(comes_here)
    }
}
