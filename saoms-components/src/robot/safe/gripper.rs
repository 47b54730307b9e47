use saoms_api::{Context, Failure, Loop, LoopClass, Publisher, Record, Recordable, record};

use crate::hardware::Action;
use crate::messages::{EVENT_LUGGAGE, EventLuggage, LuggageStage};
use crate::robot::{Job, RobotKnowledge};

/// Works the gripper: collects luggage where it is and deposits it where it has to go.
#[derive(Debug, Default, LoopClass)]
#[looping(name = "saoms.GripperMS")]
pub struct GripperMS {
    luggage: Publisher<EventLuggage>,
}

/// What is to be done here.
#[derive(Clone, Copy, Debug)]
pub enum GripperSymptom {
    /// The robot stands where its luggage is.
    AtLuggage(Job),
    /// The robot stands where its luggage has to go.
    AtDestination(Job),
    /// What was deposited is not told yet.
    Deposited(Job),
}

/// What to do about it.
#[derive(Clone, Copy, Debug)]
pub enum GripperDecision {
    /// Start to collect.
    Collect(Job),
    /// Start to deposit.
    Deposit(Job),
    /// Tell that the luggage is delivered.
    Tell(Job),
}

impl Recordable for GripperSymptom {
    fn record(&self) -> Record {
        match *self {
            GripperSymptom::AtLuggage(Job { luggage, from, .. }) => {
                record!("is at {from}, where luggage {luggage} is", from, luggage)
            }
            GripperSymptom::AtDestination(Job { luggage, to, .. }) => {
                record!("is at {to}, where luggage {luggage} has to go", to, luggage)
            }
            GripperSymptom::Deposited(Job { luggage, .. }) => {
                record!("has deposited luggage {luggage}", luggage)
            }
        }
    }
}

impl Recordable for GripperDecision {
    fn record(&self) -> Record {
        match *self {
            GripperDecision::Collect(Job { luggage, .. }) => record!("collects luggage {luggage}", luggage),
            GripperDecision::Deposit(Job { luggage, .. }) => record!("deposits luggage {luggage}", luggage),
            GripperDecision::Tell(Job { luggage, .. }) => {
                record!("tells that luggage {luggage} is delivered", luggage)
            }
        }
    }
}

impl Loop for GripperMS {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = GripperSymptom;
    type Decision = GripperDecision;

    fn new((): ()) -> Result<Self, Failure> {
        Ok(GripperMS::default())
    }

    fn initialize(
        &mut self,
        _knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        self.luggage = context.publish(&EVENT_LUGGAGE)?;
        Ok(())
    }

    fn monitor(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        if knowledge.hooks.is_handling() {
            knowledge.polled = knowledge.poll(context)?;
        }
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<GripperSymptom>, Failure> {
        if let Some(job) = knowledge.delivered {
            return Ok(Some(GripperSymptom::Deposited(job)));
        }
        if knowledge.hooks.running().is_some() {
            return Ok(None);
        }
        let has_luggage = knowledge.variables.has_luggage;
        let symptom = if has_luggage { GripperSymptom::AtDestination } else { GripperSymptom::AtLuggage };
        Ok(knowledge.job_here().map(symptom))
    }

    fn plan(
        &mut self,
        symptom: GripperSymptom,
        _knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<GripperDecision>, Failure> {
        Ok(Some(match symptom {
            GripperSymptom::AtLuggage(job) => GripperDecision::Collect(job),
            GripperSymptom::AtDestination(job) => GripperDecision::Deposit(job),
            GripperSymptom::Deposited(job) => GripperDecision::Tell(job),
        }))
    }

    fn execute(
        &mut self,
        decision: GripperDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let block = knowledge.block;
        match decision {
            GripperDecision::Collect(job) => {
                knowledge.begin(context, Action::collect(job.luggage, block))?;
            }
            GripperDecision::Deposit(job) => {
                knowledge.begin(context, Action::deposit(job.luggage, block))?;
            }
            GripperDecision::Tell(_) => {}
        }
        let Some(job) = knowledge.delivered.take() else { return Ok(()) };
        context.send(&self.luggage, job.response(knowledge.number, block, LuggageStage::Delivered))
    }
}

impl RobotKnowledge {
    /// The job, if the robot stands where it leads next, with enough left in its battery to work there.
    pub(super) fn job_here(&mut self) -> Option<Job> {
        let stands = self.next == self.block && self.destination() == Some(self.block);
        self.job.filter(|_| stands && self.may_handle())
    }
}
