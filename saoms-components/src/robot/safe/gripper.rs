use saoms_api::{Context, Failure, Loop, LoopClass, Publisher, Record, Recordable, record};

use crate::hardware::Action;
use crate::messages::{EVENT_LUGGAGE, EventLuggage, LuggageStage};
use crate::robot::{Job, RobotKnowledge};

/// Works the gripper: collects luggage where it is and deposits it where it has to go.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.GripperMS",
    knowledge = RobotKnowledge,
    senses("block", "busy", "hasLuggage"),
    effects("job", "busy", "transporter", "hasLuggage", "healer"),
    publishes(EVENT_LUGGAGE)
)]
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
    /// What could not be collected is not told yet.
    Failed(Job),
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
    /// Leave it to others.
    Return(Job),
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
            GripperSymptom::Failed(Job { luggage, from, .. }) => {
                record!("cannot collect luggage {luggage} at {from}", luggage, from)
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
            GripperDecision::Return(Job { luggage, .. }) => {
                record!("leaves luggage {luggage} to others", luggage)
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
        if let Some((job, stage)) = knowledge.untold {
            let delivered = stage == LuggageStage::Delivered;
            return Ok(Some(if delivered {
                GripperSymptom::Deposited(job)
            } else {
                GripperSymptom::Failed(job)
            }));
        }
        if knowledge.hooks.running().is_some() || knowledge.variables.critical {
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
            GripperSymptom::Failed(job) => GripperDecision::Return(job),
        }))
    }

    fn execute(
        &mut self,
        decision: GripperDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let action = match decision {
            GripperDecision::Collect(job) => Some(Action::collect(job.luggage, job.from)),
            GripperDecision::Deposit(job) => Some(Action::deposit(job.luggage, job.to)),
            GripperDecision::Tell(_) | GripperDecision::Return(_) => None,
        };
        if let Some(action) = action {
            knowledge.begin(context, action)?;
        }
        knowledge.tell(self.luggage, context)
    }
}

impl RobotKnowledge {
    /// The job, if the robot stands where it leads next, with enough left in its battery to work there.
    pub(super) fn job_here(&mut self) -> Option<Job> {
        let destination = self.destination()?;
        let stands = self.next == self.block && self.reaches(destination, self.block);
        self.job.filter(|_| stands && self.may_handle())
    }
}
