//! In place of `GripperMS`.

use saoms_api::{Context, Effector, Entry, Failure, Knowledge, Loop, LoopClass, Properties, Publisher, record};
use saoms_components::grid::Block;
use saoms_components::messages::{EVENT_LUGGAGE, EventLuggage, LuggageStage};
use saoms_components::robot::{Job, JobEnd};

use crate::step::{Decision, Step};

/// What a composite can set.
#[derive(Debug, Properties)]
pub struct SlowGripperProperties {
    /// Number of executions for which the robot looks at luggage before it takes it.
    #[property(default = 5, unit = "executions")]
    looks: u32,
}

/// Looks at luggage for a while before the gripper collects it.
#[derive(Debug, LoopClass)]
#[looping(name = "own.SlowGripper")]
pub struct SlowGripper {
    #[properties]
    properties: SlowGripperProperties,
    looked: u32,
    #[publishes(EVENT_LUGGAGE)]
    luggage: Publisher<EventLuggage>,
    #[senses]
    number: Entry<u32>,
    #[senses]
    block: Entry<Block>,
    #[senses]
    next: Entry<Block>,
    #[senses]
    busy: Entry<bool>,
    #[senses]
    has_luggage: Entry<bool>,
    #[senses]
    job: Entry<Option<Job>>,
    #[senses]
    moving: Entry<bool>,
    #[senses]
    handling: Entry<bool>,
    #[senses]
    lasts: Entry<u32>,
    #[senses]
    way_home: Entry<u32>,
    #[effects]
    grip: Effector<bool>,
    #[effects]
    untold: Effector<Option<JobEnd>>,
}

/// What it can do.
#[derive(Debug)]
pub enum Act {
    /// Tell the others how a job ended.
    Tell(JobEnd),
    /// Collect the luggage, or deposit it.
    Grip,
}

impl Loop for SlowGripper {
    type Properties = SlowGripperProperties;
    type Knowledge = dyn Knowledge;
    type Symptom = Step<Act>;
    type Decision = Decision<Act>;

    fn analyze(&mut self, robot: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Step<Act>>, Failure> {
        if let Some(end) = self.untold.get(robot)? {
            let why = record!(job_over: "the job with luggage {luggage} is over", luggage = end.job.luggage);
            return Ok(Some(Step::new(why, record!(tells_end_of_job: "tells the others"), Act::Tell(end))));
        }
        let block = self.block.get(robot)?;
        let is_still = self.next.get(robot)? == block && !self.moving.get(robot)? && !self.handling.get(robot)?;
        let lasts = self.lasts.get(robot)? > self.way_home.get(robot)?.saturating_add(2);
        let has_luggage = self.has_luggage.get(robot)?;
        let job = self.job.get(robot)?.filter(|job| if has_luggage { job.to == block } else { job.from == block });
        let Some(job) = job.filter(|_| is_still && lasts) else {
            self.looked = 0;
            return Ok(None);
        };
        if !self.busy.get(robot)? {
            return Ok(None);
        }
        self.looked += 1;
        if !has_luggage && self.looked <= self.properties.looks {
            return Ok(None);
        }
        self.looked = 0;
        let (luggage, executions) = (job.luggage, self.properties.looks);
        let what = record!(uses_gripper: "uses its gripper");
        Ok(Some(Step::new(
            match has_luggage {
                true => {
                    record!(at_end_of_job: "is at {block}, the end of the job with luggage {luggage}", block, luggage)
                }
                false => record!(
                    has_looked: "has looked at luggage {luggage} for {executions} {executions:execution|executions}",
                    luggage,
                    executions
                ),
            },
            what,
            Act::Grip,
        )))
    }

    fn plan(
        &mut self,
        step: Step<Act>,
        _: &mut dyn Knowledge,
        _: &mut Context<'_>,
    ) -> Result<Option<Decision<Act>>, Failure> {
        Ok(Some(step.decide()))
    }

    fn execute(
        &mut self,
        decision: Decision<Act>,
        robot: &mut dyn Knowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        match decision.act {
            Act::Grip => self.grip.set(robot, true),
            Act::Tell(end) => {
                let (number, block) = (self.number.get(robot)?, self.block.get(robot)?);
                self.untold.set(robot, None)?;
                tell(end, (number, block), self.luggage, context)
            }
        }
    }
}

/// Tells the others how a job ended. What could not be collected waits again for them.
pub(crate) fn tell(
    end: JobEnd,
    (number, block): (u32, Block),
    luggage: Publisher<EventLuggage>,
    context: &mut Context<'_>,
) -> Result<(), Failure> {
    let JobEnd { job, stage } = end;
    context.send(&luggage, job.response(number, block, stage))?;
    if stage == LuggageStage::Refused {
        context.send(&luggage, EventLuggage::request(job.luggage, job.from, job.to))?;
    }
    Ok(())
}
