//! The path to a destination, step by step (listing 6.6).

use saoms_api::Failure;

use crate::grid::Block;
use crate::hardware::{Action, ActionKind};
use crate::robot::Body;
use crate::robot::actions::Outcome;

use super::Classic;

impl Classic {
    /// One execution of the path: what was announced in the last one is driven now, and the next block is announced.
    pub(super) fn follow_path(&mut self, body: &mut Body<'_, '_>) -> Result<(), Failure> {
        if std::mem::take(&mut body.knowledge.variables.stop_a_period) {
            self.announces = true;
            return Ok(());
        }
        let polled = body.poll()?;
        match polled {
            Some((_, Outcome::Running | Outcome::NotBegun)) => {
                self.announces = body.knowledge.next != body.knowledge.block;
                return Ok(());
            }
            Some((Action { kind: ActionKind::Collect | ActionKind::Deposit, .. }, _)) => return Ok(()),
            Some(_) | None => {}
        }
        let moved = polled.is_some();
        if let Some(destination) = body.knowledge.destination() {
            self.bring(body, destination, moved)
        } else if body.knowledge.variables.ready_to_go_under_charge {
            self.go_charging(body, moved)
        } else {
            Ok(())
        }
    }

    fn bring(&mut self, body: &mut Body<'_, '_>, destination: Block, moved: bool) -> Result<(), Failure> {
        let knowledge = &*body.knowledge;
        let stands = knowledge.next == knowledge.block && !moved;
        if let Some(job) = knowledge.job.filter(|_| stands && knowledge.block == destination) {
            let has_luggage = knowledge.variables.has_luggage;
            let action = if has_luggage { Action::deposit } else { Action::collect };
            return body.begin(action(job.luggage, destination)).map(|_| ());
        }
        self.announces = true;
        if self.reach(body, destination, Block::step_x_first, moved)? {
            let name = &body.knowledge.name;
            body.context.console(format_args!("{name} says: I've arrived to destination."));
        }
        Ok(())
    }

    fn go_charging(&mut self, body: &mut Body<'_, '_>, moved: bool) -> Result<(), Failure> {
        let (name, charge_block) = (&body.knowledge.name, body.knowledge.charge_block);
        body.context.console(format_args!("{name} has low battery and is going under charge..."));
        body.knowledge.variables.reaching_charge = true;
        self.announces = true;
        if self.reach(body, charge_block, Block::step_y_first, moved)? {
            self.announces = false;
            let name = &body.knowledge.name;
            body.context.console(format_args!("{name} says: I've arrived to charge position."));
            body.context.info(format_args!("charges (battery {} %)", body.knowledge.battery));
            let variables = &mut body.knowledge.variables;
            variables.reaching_charge = false;
            variables.ready_to_go_under_charge = false;
            (variables.in_charge, variables.busy) = (true, true);
        }
        Ok(())
    }

    /// Drives to the announced block and announces the next one; `true` once the robot is there.
    fn reach(
        &mut self,
        body: &mut Body<'_, '_>,
        to: Block,
        step: fn(Block, Block) -> Block,
        moved: bool,
    ) -> Result<bool, Failure> {
        let next = body.knowledge.next;
        if next != body.knowledge.block && !moved && body.begin(Action::move_to(next))? != Outcome::Done {
            return Ok(false);
        }
        let block = body.knowledge.block;
        if block == to {
            return Ok(true);
        }
        let next = step(block, to);
        body.show_move(next);
        body.knowledge.next = next;
        Ok(false)
    }
}
