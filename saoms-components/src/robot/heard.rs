//! What robots hear from others, where anybody may publish: what cannot be is reported with its sender and not taken in.

use saoms_api::{Context, Header, Subscription};

use super::{RobotKnowledge, Routes};
use crate::grid::Block;
use crate::messages::{CriticalSituation, CriticalStage, Position};
use crate::refusal::ignore;

impl RobotKnowledge {
    /// Takes in where the others are.
    pub(super) fn hear_positions(&mut self, positions: Subscription<Position>, context: &mut Context<'_>) {
        let RobotKnowledge { lists, routes, .. } = self;
        let heard = context.receive(&positions).with_headers();
        let sound = heard.filter(|(header, position)| {
            let Position { robot, block, next, wanted, .. } = **position;
            is_let_in(problem(routes, robot, &[block, next, wanted]), *header, context)
        });
        lists.peers.hear(sound.map(|(_, position)| position));
    }

    /// Whether a critical situation is one that can be.
    pub(super) fn lets_in(
        &self,
        situation: &CriticalSituation,
        header: Header,
        context: &mut Context<'_>,
    ) -> bool {
        let problem = match (situation.stage, situation.job()) {
            (CriticalStage::Request, Some(job)) => {
                problem(&self.routes, situation.critical, &[situation.block, job.from, job.to])
            }
            (CriticalStage::Request, None) => problem(&self.routes, situation.critical, &[situation.block]),
            _ => problem(&self.routes, situation.healer, &[situation.healer_block]),
        };
        is_let_in(problem, header, context)
    }
}

/// What cannot be about a robot and blocks.
#[derive(Clone, Copy, Debug)]
enum Problem {
    NoRobot,
    Outside(Block),
}

fn problem(routes: &Routes, robot: u32, blocks: &[Block]) -> Option<Problem> {
    if robot == 0 {
        return Some(Problem::NoRobot);
    }
    blocks.iter().copied().find(|block| !routes.contains(*block)).map(Problem::Outside)
}

fn is_let_in(problem: Option<Problem>, header: Header, context: &mut Context<'_>) -> bool {
    let Some(problem) = problem else { return true };
    context.count("messages.ignored", 1);
    let reason = match problem {
        Problem::NoRobot => "robot 0 does not exist: their numbers start at 1".to_owned(),
        Problem::Outside(block) => format!("{block} is outside the area"),
    };
    ignore(context, header, reason);
    false
}
