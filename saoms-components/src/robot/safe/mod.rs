//! The rules of a robot that neither collides nor runs out of battery, whatever the periods of the others.
//!
//! - *Jobs*: it takes an interest in the luggage that suits it best and says so; it takes the job once no other robot that is interested is
//!   closer. See [`jobs`].
//! - *Energy*: it takes only jobs for which the battery lasts to the end and back to the charger, and turns back in time. See [`energy`].
//! - *Right of way*: it says which block it wants, and goes there once nobody else holds or wants it. Where robots meet, the one with the
//!   lower priority makes way. See [`traffic`].

mod drive;
mod energy;
mod jobs;
mod pace;
mod traffic;

use saoms_api::{Failure, Time};

use crate::grid::Block;
use crate::hardware::{Action, ActionKind};
use crate::messages::{IMMOVABLE, Priority};

use super::actions::Outcome;
use super::{Body, Job, Knowledge};
use energy::Energy;
use jobs::Jobs;
use traffic::Traffic;

/// The robot of the `safe` policy.
#[derive(Debug, Default)]
pub(crate) struct Safe {
    energy: Energy,
    jobs: Jobs,
    traffic: Traffic,
    leg: Leg,
}

/// The way to one goal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Leg {
    goal: Option<Block>,
    urgency: Urgency,
    since: Time,
}

/// What a way is for, the most urgent last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
enum Urgency {
    /// Nothing: the robot is where it wants to be.
    #[default]
    None,
    /// Going home without a job.
    Home,
    /// Bringing luggage.
    Job,
    /// Reaching the charger in time.
    Energy,
}

impl Leg {
    /// The more urgent way goes first; of two alike, the one that lasts longer. It stays the same on the whole way: robots that swap their
    /// priorities would push each other to and fro.
    fn priority(&self, robot: u32) -> Priority {
        const MOST: u64 = (1 << 56) - 1;
        // Quarters of microseconds: the time of a run fits for more than 500 years.
        let age = MOST - (self.since.as_nanos() >> 8).min(MOST);
        Priority { rank: (self.urgency as u64) << 56 | age, robot }
    }
}

impl Safe {
    pub(crate) fn execute(&mut self, body: &mut Body<'_, '_>) -> Result<(), Failure> {
        body.show_lists();
        self.energy.use_battery(body);
        let polled = body.poll()?;
        self.energy.pace().note_action(polled);
        self.energy.watch(body)?;
        body.topics.say_robot_if_news(body.context, body.knowledge)?;
        match polled {
            Some((Action { kind: ActionKind::Move, .. }, Outcome::Running | Outcome::NotBegun)) => {}
            Some((_, Outcome::Running | Outcome::NotBegun)) => return self.stay(body),
            _ => {
                let handles = self.handle_luggage(body)?;
                self.jobs.manage(body, &mut self.energy)?;
                if handles || self.energy.is_stranded() {
                    return self.stay(body);
                }
            }
        }
        self.set_leg(body);
        self.drive(body)?;
        body.show_battery();
        Ok(())
    }

    /// Collects or deposits where the robot stands; `true` while that goes on.
    fn handle_luggage(&mut self, body: &mut Body<'_, '_>) -> Result<bool, Failure> {
        let Some(job) = self.job_here(body.knowledge) else { return Ok(false) };
        let action = if body.knowledge.variables.has_luggage { Action::deposit } else { Action::collect };
        let outcome = body.begin(action(job.luggage, body.knowledge.block))?;
        Ok(matches!(outcome, Outcome::Running | Outcome::NotBegun))
    }

    /// The job, if the robot stands where it leads next, with enough left in its battery to work there.
    fn job_here(&self, knowledge: &mut Knowledge) -> Option<Job> {
        let stands = knowledge.next == knowledge.block && knowledge.destination() == Some(knowledge.block);
        knowledge.job.filter(|_| stands && self.energy.may_handle(knowledge))
    }

    /// Says that the robot does not leave its block whoever comes.
    fn stay(&mut self, body: &mut Body<'_, '_>) -> Result<(), Failure> {
        self.traffic.stay(body.knowledge.next);
        let position = crate::messages::Position { priority: IMMOVABLE, ..body.knowledge.position() };
        body.topics.say_position_if_news(body.context, position)?;
        body.show_battery();
        Ok(())
    }

    /// Where to go now, and how urgently.
    fn set_leg(&mut self, body: &mut Body<'_, '_>) {
        let knowledge = &mut *body.knowledge;
        let charge_block = knowledge.charge_block;
        let (goal, urgency) = if self.energy.must_charge() {
            (Some(charge_block), Urgency::Energy)
        } else if let Some(destination) = knowledge.destination() {
            (Some(destination), Urgency::Job)
        } else if knowledge.variables.transporter {
            (None, Urgency::None)
        } else {
            (Some(charge_block), Urgency::Home)
        };
        let arrived = goal.is_none_or(|goal| goal == knowledge.next);
        let urgency = if arrived { Urgency::None } else { urgency };
        if (goal, urgency) != (self.leg.goal, self.leg.urgency) {
            self.leg = Leg { goal, urgency, since: body.context.now() };
        }
        if let Some(goal) = goal {
            knowledge.routes.head_for(goal);
        }
        let variables = &mut knowledge.variables;
        variables.ready_to_go_under_charge = self.energy.must_charge();
        variables.reaching_charge = urgency == Urgency::Energy;
    }
}
