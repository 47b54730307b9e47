//! Calls of services of the web: made on the thread of the caller, which waits, by whoever the run was given for them.

use std::time::Duration;

use saoms_api::host::{ServiceCall, format_duration};
use saoms_api::{CallError, Failure};
use saoms_lang::assembly::{CALL_DEADLINE, WebTarget};

use super::part::Part;
use crate::schedule::shared::Shared;
use crate::web::{WebCall, WebError};

/// Calls a service of the web. What its server answers is held to the interface of the reference.
#[cold]
pub(super) fn call_web(
    shared: &Shared,
    caller: &Part,
    (target, deadline): (&WebTarget, Option<Duration>),
    call: &mut dyn ServiceCall,
) -> Result<(), CallError> {
    let server = target.address.to_string();
    // It is no component, so the message names it.
    let failed = |why: String| CallError::Failed {
        provider: String::new(),
        failure: Failure::new(format!("the web server `{server}` {why}")),
    };
    let number = call.operation();
    let Some(operation) = target.operations.get(number as usize) else {
        return Err(CallError::Mismatch {
            message: format!("the interface has no operation with the number {number}"),
        });
    };
    let Some(client) = shared.web.get() else {
        return Err(failed(match shared.clock.is_virtual() {
            true => "is not called in virtual time: a run there depends on its composite and its seed alone".to_owned(),
            false => "cannot be called: this program has no client for the web".to_owned(),
        }));
    };
    let arguments = operation.decode_arguments(&call.arguments());
    let arguments = arguments.map_err(|error| CallError::Mismatch { message: error.to_string() })?;
    let deadline = deadline.unwrap_or(CALL_DEADLINE);
    let reply = client.call(&WebCall {
        target,
        operation,
        arguments: &arguments,
        deadline,
        is_cancelled: &|| caller.is_cancelled(),
    });
    let reply = reply.map_err(|error| match error {
        WebError::Busy => CallError::Busy { provider: server.clone() },
        WebError::Late => failed(format!("does not answer `{}` within {}", operation.name, format_duration(deadline))),
        WebError::Failed(why) => failed(why),
    })?;
    let bytes = operation.encode_reply(&reply).map_err(|faults| {
        failed(format!("answers `{}` with a reply that does not fit: {faults}", operation.signature))
    })?;
    call.reply(&bytes)
}
