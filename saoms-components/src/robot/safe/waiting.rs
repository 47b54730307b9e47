//! Reports of a robot that gets nowhere because others are in its way: once when it has waited for a while, and once
//! when that ends.

use saoms_api::{Context, Field, Time, info};

use crate::grid::Block;
use crate::robot::RobotKnowledge;

use super::leg::Urgency;

/// Number of executions without progress after which a robot reports that it waits, beside those of two moves.
const TELLING_WAIT: u32 = 8;

/// The wait of a robot on its way to a goal.
///
/// It ends when the robot is closer to its goal than ever before, so that stepping aside and back is no end.
#[derive(Debug, Default, Clone, Field)]
pub(super) struct Waiting {
    way: Option<Progress>,
}

#[derive(Debug, Clone, Field)]
struct Progress {
    goal: Block,
    /// The shortest distance to the goal so far, and its time.
    closest: u32,
    since: Time,
    is_told: bool,
}

impl Waiting {
    /// Looks at an execution in which the robot decided about its way.
    pub(super) fn note(&mut self, knowledge: &RobotKnowledge, context: &mut Context<'_>) {
        let (at, now) = (knowledge.next, context.now());
        let goal = knowledge.leg.goal.filter(|goal| knowledge.leg.urgency != Urgency::None && *goal != at);
        let Some(goal) = goal else { return self.end(context) };
        let distance = knowledge.routes.to_goal(at, goal);
        match &mut self.way {
            Some(way) if way.goal == goal && distance >= way.closest => {
                let executions = TELLING_WAIT.saturating_add(2 * knowledge.energy.executions_of_move());
                // Of hardware that is busy the robot tells apart.
                let is_due = !way.is_told && !knowledge.hardware.keeps_waiting();
                if is_due && now.since(way.since) >= context.period().saturating_mul(executions) {
                    way.is_told = true;
                    let since = way.since;
                    let in_the_way = match &knowledge.zones {
                        Some(zones) => zones.in_the_way().map(|wait| wait.robot),
                        None => knowledge.traffic.blocker(at, goal, &knowledge.routes),
                    };
                    match in_the_way {
                        Some(robot) => {
                            info!(context, "has been waiting at {at} for robot {robot} since {since}")
                        }
                        None => info!(context, "has been waiting at {at} for other robots since {since}"),
                    }
                }
            }
            _ => {
                self.end(context);
                self.way = Some(Progress { goal, closest: distance, since: now, is_told: false });
            }
        }
    }

    /// The robot gets on, or has another goal or none.
    pub(super) fn end(&mut self, context: &mut Context<'_>) {
        if let Some(Progress { since, is_told: true, .. }) = self.way.take() {
            let waited = Time::from_nanos(context.now().as_nanos() - since.as_nanos());
            info!(context, "continues after waiting {waited}");
        }
    }
}
