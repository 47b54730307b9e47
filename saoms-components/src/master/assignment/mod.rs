//! Assignment of luggage to robots by the master of the environment.
//!
//! A loop matches the luggage that waits with the robots that are free, and sends each of them its job. A robot takes
//! it, refuses it for good, or hands it back. A visit is assigned to another robot only once the first one has
//! answered, luggage also when that takes too long: the world lets one robot collect it.

mod crew;
#[cfg(test)]
mod crew_tests;
mod knowledge;
#[cfg(test)]
mod lease_tests;
mod matching;
mod methods;
mod records;
mod ways;

use saoms_api::{Context, Failure, Loop, LoopClass, PropertyField, Time, info};

use crate::messages::{FIRST_VISIT, is_visit};

pub use crew::{Crew, Member};
pub use knowledge::MasterEnvironmentKnowledge;
use matching::{Candidate, Task};
pub use records::{AssignmentDecision, Unassigned};
use records::{Order, Orders};

/// Who decides which robot brings which luggage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PropertyField)]
pub enum AssignmentPolicy {
    /// The robots: they declare their interest, and the closest one takes the luggage. On a large map, where robots
    /// hear only what is near, the master assigns what no robot takes.
    #[default]
    Robots,
    /// The master, the oldest luggage first, to the closest robot.
    Oldest,
    /// The master, with the least total way to all luggage. Until a robot collects its luggage, it may get another one.
    Optimal,
}

/// Assigns luggage to robots, as the property `assignment` says.
///
/// - `robots`: only on a large map, where robots hear only what is near. The loop waits until the robots around had the
///   time to decide. Then the closest free robot within a circle gets the luggage. The circle grows: whenever the
///   luggage has waited twice as long, it is twice as large.
/// - `oldest`: the oldest luggage first, to the closest free robot.
/// - `optimal`: so that the total way of the robots to it is the least. Until a robot collects its luggage, it may get
///   other luggage, if that saves more than a few blocks. Long ways to destinations count a little, so that the last
///   jobs are short. Luggage that has waited for long goes first, the oldest before the others, and to robots that
///   carry nothing, so that none waits for ever. With more than 128 robots at once each robot takes the closest piece,
///   or each piece the closest robot, whichever are fewer.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.master.AssignmentMS",
    knowledge = MasterEnvironmentKnowledge,
    senses("waiting", "crew"),
    effects("assignments")
)]
pub struct MasterAssignment {
    orders: Orders,
    look_at: Time,
}

impl Loop for MasterAssignment {
    type Properties = ();
    type Knowledge = MasterEnvironmentKnowledge;
    type Symptom = Unassigned;
    type Decision = AssignmentDecision;

    fn analyze(
        &mut self,
        knowledge: &mut MasterEnvironmentKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<Unassigned>, Failure> {
        let now = context.now();
        if !std::mem::take(&mut knowledge.crew.changed) && now < self.look_at {
            return Ok(None);
        }
        self.look_at = now + knowledge.crew.slowest();
        self.orders = Orders(match knowledge.policy {
            AssignmentPolicy::Robots => methods::far(knowledge, now),
            AssignmentPolicy::Oldest => methods::oldest(knowledge, now),
            AssignmentPolicy::Optimal => methods::optimal(knowledge, now),
        });
        Ok((!self.orders.0.is_empty()).then(|| knowledge.unassigned(now)))
    }

    fn plan(
        &mut self,
        _symptom: Unassigned,
        _knowledge: &mut MasterEnvironmentKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<AssignmentDecision>, Failure> {
        Ok(Some(self.orders.decision()))
    }

    fn execute(
        &mut self,
        _decision: AssignmentDecision,
        knowledge: &mut MasterEnvironmentKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        order(std::mem::take(&mut self.orders), knowledge, context);
        Ok(())
    }
}

/// Takes what a loop decided over into the knowledge.
fn order(orders: Orders, knowledge: &mut MasterEnvironmentKnowledge, context: &mut Context<'_>) {
    for Order { robot, luggage, from, to, withdrawn } in orders.0 {
        let (what, number) = match is_visit(luggage) {
            true => ("visit", luggage - FIRST_VISIT),
            false => ("luggage", luggage),
        };
        match withdrawn {
            false => info!(context, "assigns {what} {number} to robot {robot}"),
            true => info!(context, "takes {what} {number} back from robot {robot}"),
        }
        context.effect(records::order(robot, luggage, withdrawn));
        knowledge.assign(robot, luggage, (from, to), withdrawn);
    }
}
