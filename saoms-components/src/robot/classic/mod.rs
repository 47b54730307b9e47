//! The rules of the manual, in the order of its listing 6.3, with the numbers of its transcripts.
//!
//! They are kept for those transcripts: a robot that stops is invisible to others, nobody sees swaps or idle robots, and the battery is low at a
//! fixed level, however far the charger is.

mod collision;
mod luggage;
mod path;

use saoms_api::Failure;

use super::Body;

/// The battery level at which a robot has to charge, in percent.
const LOW: u32 = 35;

/// The robot of the manual.
#[derive(Debug, Default)]
pub(crate) struct Classic {
    /// Whether it says its next block in this execution.
    announces: bool,
}

impl Classic {
    pub(crate) fn execute(&mut self, body: &mut Body<'_, '_>) -> Result<(), Failure> {
        body.knowledge.lists.requests.drop_contested();
        body.show_lists();
        use_battery(body);
        body.topics.say_robot(body.context, body.knowledge, true)?;
        watch_battery(body);
        let variables = &body.knowledge.variables;
        if !variables.busy && !variables.ready_to_go_under_charge && !variables.in_charge {
            luggage::manage(body)?;
        }
        if body.knowledge.variables.busy {
            collision::manage(body);
        }
        self.announces = false;
        self.follow_path(body)?;
        if self.announces {
            let position = body.knowledge.position();
            body.topics.say_position(body.context, position)?;
        }
        body.show_battery();
        Ok(())
    }
}

fn use_battery(body: &mut Body<'_, '_>) {
    let knowledge = &mut *body.knowledge;
    if knowledge.variables.in_charge {
        knowledge.battery.charge();
    } else if knowledge.block != knowledge.charge_block {
        knowledge.battery.drain();
    }
}

/// Whether the battery is low, or charged.
fn watch_battery(body: &mut Body<'_, '_>) {
    let knowledge = &mut *body.knowledge;
    let variables = &mut knowledge.variables;
    if variables.in_charge {
        if knowledge.battery.is_full() {
            let name = &knowledge.name;
            body.context.console(format_args!("{name} is now fully charged and ready (but still asleep)"));
            // It sleeps for the rest of this execution, and nobody has to wake it in the next.
            variables.in_charge = variables.busy;
            variables.busy = false;
        }
    } else if knowledge.battery.is_at_most(LOW)
        && knowledge.block != knowledge.charge_block
        && !variables.ready_to_go_under_charge
    {
        variables.ready_to_go_under_charge = true;
        let battery = &knowledge.battery;
        body.context.info(format_args!("has low battery ({battery} %): charges after its job"));
    }
}
