//! Whether to stop for another robot (listing 6.11).

use crate::robot::Body;

/// Stops for a period when another robot announced the same next block and has the lower number.
pub(super) fn manage(body: &mut Body<'_, '_>) {
    let knowledge = &mut *body.knowledge;
    let next = knowledge.next;
    let lowest = knowledge.lists.peers.heard().filter(|peer| peer.next == next).map(|peer| peer.robot).min();
    if let Some(lowest) = lowest {
        let name = &knowledge.name;
        body.context.console(format_args!("{name}: RISK OF COLLISION DETECTED AND AVOIDED!"));
        knowledge.variables.stop_a_period = lowest < knowledge.number;
        if knowledge.variables.stop_a_period {
            body.context.info(format_args!("waits: robot {lowest} goes to {next} first"));
        }
    }
}
