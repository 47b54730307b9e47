//! Calls of other programs, which a component serves between two executions, as a call of an operator.

use std::any::Any;
use std::sync::Arc;

use saoms_api::host::{Invocation, Operation, ServiceCall};
use saoms_api::{CallError, Cause, Failure};

use crate::network::FromRun;
use crate::network::exchange::wire::Request;
use crate::schedule::component::body::Body;
use crate::schedule::engine::Engine;
use crate::schedule::shared::Shared;

/// A call of another program, and its answer once it was served.
#[derive(Debug)]
pub(crate) struct RemoteCall {
    /// The network that it came over.
    network: u8,
    request: Request,
    /// The number of the component that makes it.
    caller: u32,
    /// The time until which it may begin.
    until: u64,
    reply: Vec<u8>,
    answer: Option<Result<(), CallError>>,
}

impl RemoteCall {
    pub(in crate::schedule) fn new(network: u8, request: Request, caller: u32, now: u64) -> RemoteCall {
        let until = now.saturating_add(request.left);
        RemoteCall { network, request, caller, until, reply: Vec::new(), answer: None }
    }

    /// True if its caller does not want it any more.
    pub(super) fn is_late(&self, now: u64) -> bool {
        now > self.until
    }
}

impl ServiceCall for RemoteCall {
    fn operation(&self) -> Operation {
        self.request.operation
    }

    fn typed(&mut self) -> Option<(&mut dyn Any, &mut dyn Any)> {
        None
    }

    fn arguments(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.request.arguments)
    }

    fn reply(&mut self, bytes: &[u8]) -> Result<(), CallError> {
        self.reply = bytes.to_vec();
        Ok(())
    }
}

impl Body {
    /// Serves a call of another program.
    ///
    /// # Errors
    /// The component panicked.
    pub(super) fn serve_remote(
        &mut self,
        shared: &Arc<Shared>,
        call: &mut RemoteCall,
        cause: Cause,
    ) -> Result<(), Failure> {
        let service = call.request.service.clone();
        let served = self.serve(shared, &mut Invocation { service: &service, call }, cause)?;
        call.answer = Some(served);
        Ok(())
    }
}

impl Engine {
    /// The record that a call of another program follows from.
    pub(super) fn cause_of(&self, call: &RemoteCall) -> Cause {
        self.networks.elsewhere.cause(call.caller, call.request.cause)
    }

    /// Answers a call of another program after the code of its component has returned, or has failed.
    pub(super) fn finish_remote_call(&mut self, index: u32, mut call: RemoteCall, failure: Option<&Failure>) {
        let provider = self.slots[index as usize].name.to_string();
        let answer = match (call.answer.take(), failure) {
            (Some(Ok(())), _) => Ok(std::mem::take(&mut call.reply)),
            (Some(Err(error)), _) => Err(error),
            (None, Some(failure)) => Err(CallError::Failed { provider: String::new(), failure: failure.clone() }),
            (None, None) => Err(CallError::NotRunning { provider }),
        };
        self.reply_to(&call, answer);
    }

    /// Says that a call of another program has not begun, and does not any more.
    pub(in crate::schedule) fn leave_unserved(&mut self, call: &RemoteCall) {
        let Request { program, line, number, .. } = call.request;
        self.networks.waiting.push((call.network, FromRun::Unserved { program, line, number }));
    }

    /// Answers a call of another program.
    pub(in crate::schedule) fn reply_to(&mut self, call: &RemoteCall, answer: Result<Vec<u8>, CallError>) {
        let Request { program, line, number, .. } = call.request;
        self.networks.waiting.push((call.network, FromRun::Reply { program, line, number, answer }));
    }
}
