use std::any::Any;

use saoms_api::host::{Operation, ServiceCall};
use saoms_api::{CallError, Failure};

use super::{Act, ActKind};

/// A call between its two ends, which takes the way of bytes, so that both arguments and reply are seen.
pub(crate) struct TapedCall<'a> {
    inner: &'a mut dyn ServiceCall,
    pub(crate) arguments: Vec<u8>,
    pub(crate) reply: Option<Vec<u8>>,
}

impl<'a> TapedCall<'a> {
    pub(crate) fn new(inner: &'a mut dyn ServiceCall) -> TapedCall<'a> {
        let arguments = inner.arguments();
        TapedCall { inner, arguments, reply: None }
    }
}

impl ServiceCall for TapedCall<'_> {
    fn operation(&self) -> Operation {
        self.inner.operation()
    }

    fn typed(&mut self) -> Option<(&mut dyn Any, &mut dyn Any)> {
        None
    }

    fn arguments(&mut self) -> Vec<u8> {
        self.arguments.clone()
    }

    fn reply(&mut self, bytes: &[u8]) -> Result<(), CallError> {
        self.reply = Some(bytes.to_vec());
        self.inner.reply(bytes)
    }
}

/// The answer to a call as an act of this kind.
pub(crate) fn answered(what: ActKind, reply: &Result<Vec<u8>, CallError>) -> Act {
    let (number, name, bytes) = match reply {
        Ok(reply) => (0, "", reply.clone()),
        Err(CallError::NotWired { reference }) => (1, reference.as_str(), Vec::new()),
        Err(CallError::Busy { provider }) => (2, provider.as_str(), Vec::new()),
        Err(CallError::NotRunning { provider }) => (3, provider.as_str(), Vec::new()),
        Err(CallError::Mismatch { message }) => (4, message.as_str(), Vec::new()),
        Err(CallError::Failed { provider, failure }) => (5, provider.as_str(), failure.message().as_bytes().to_vec()),
    };
    Act::new(what, number, name).with(bytes)
}

/// The answer that such an act says.
///
/// # Errors
/// It is one.
pub(crate) fn answer_of(act: &Act) -> Result<&[u8], CallError> {
    let name = || act.name.clone();
    Err(match act.number {
        0 => return Ok(&act.bytes),
        1 => CallError::NotWired { reference: name() },
        2 => CallError::Busy { provider: name() },
        3 => CallError::NotRunning { provider: name() },
        4 => CallError::Mismatch { message: name() },
        _ => CallError::Failed { provider: name(), failure: Failure::new(act.text()) },
    })
}
