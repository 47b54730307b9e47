//! Which robot brings which luggage (listings 6.5 and 6.9).

use std::cmp::Reverse;

use saoms_api::Failure;

use crate::messages::LuggageStage;
use crate::robot::{Body, Request};

/// Takes an interest in the oldest request; in the next execution, when the others' responses are known, the closest robot goes.
pub(super) fn manage(body: &mut Body<'_, '_>) -> Result<(), Failure> {
    if body.knowledge.variables.transporter { check_conflicts_and_go(body) } else { take_interest(body) }
}

fn take_interest(body: &mut Body<'_, '_>) -> Result<(), Failure> {
    let Some(request) = body.knowledge.lists.requests.claim(0) else { return Ok(()) };
    let job = request.job;
    body.knowledge.variables.transporter = true;
    let name = &body.knowledge.name;
    body.context.console(format_args!("{name} is bringing luggage from {} to {}", job.from, job.to));
    body.respond(&job, LuggageStage::Interest)
}

fn check_conflicts_and_go(body: &mut Body<'_, '_>) -> Result<(), Failure> {
    let request = body.knowledge.lists.requests.settle();
    let Some(request) = request.filter(|request| is_closest(body, request)) else {
        body.knowledge.variables.transporter = false;
        return Ok(());
    };
    let job = request.job;
    body.knowledge.variables.busy = true;
    body.knowledge.job = Some(job);
    body.context.info(format_args!("takes luggage {} from {} to {}", job.luggage, job.from, job.to));
    body.respond(&job, LuggageStage::Taken)
}

/// By straight-line distance; at the same distance the lower number is the closest.
fn is_closest(body: &Body<'_, '_>, request: &Request) -> bool {
    let from = request.job.from;
    let mine = (body.knowledge.block.straight_squared(from), body.knowledge.number);
    let best =
        request.rivals.iter().max_by_key(|rival| Reverse((rival.block.straight_squared(from), rival.robot)));
    best.is_none_or(|rival| mine < (rival.block.straight_squared(from), rival.robot))
}
