use saoms_abi::{DepartedView, HostHandle, MessageView};

use crate::host::SharedMessage;
use crate::{Cause, Context, Departed, Failure, Header};

use super::host::time;
use super::remote_host::{RemoteHost, check_size};

/// The state behind the contexts of a component or a loop of this side: its inboxes, and a buffer.
#[derive(Default)]
pub(super) struct ContextState {
    /// By the index of the subscription; only its own are ever filled.
    inboxes: Vec<Vec<SharedMessage>>,
    subscribed: Vec<u32>,
    /// By the index of the subscription: messages that left its region.
    departed: Vec<Vec<Departed>>,
    /// True if there is a message in them.
    is_filled: bool,
    buffer: Vec<u8>,
}

impl ContextState {
    /// Runs code with the context behind a handle. Messages are taken in when the code `takes_in`, and stay until the
    /// next time.
    ///
    /// # Safety
    /// The handle is that of an active call.
    #[inline]
    pub(super) unsafe fn with<E: From<Failure>>(
        &mut self,
        handle: &HostHandle,
        takes_in: bool,
        code: impl FnOnce(&mut Context<'_>) -> Result<(), E>,
    ) -> Result<(), E> {
        if !takes_in {
            // SAFETY: as the caller promises.
            unsafe { check_size(handle) }?;
        } else if handle.inbox_count != 0 || self.is_filled {
            // SAFETY: as the caller promises.
            unsafe { self.take_in(handle) }?;
        }
        // SAFETY: as the caller promises.
        let mut host = unsafe { RemoteHost::new(handle, &mut self.buffer, &mut self.subscribed, &self.departed) };
        code(&mut Context::new(&mut host, &self.inboxes))
    }

    /// Copies what arrived for the own subscriptions.
    ///
    /// # Safety
    /// As [`with`](ContextState::with).
    unsafe fn take_in(&mut self, handle: &HostHandle) -> Result<(), Failure> {
        self.is_filled = handle.inbox_count != 0;
        for subscription in &self.subscribed {
            let place = *subscription as usize;
            if self.inboxes.len() <= place {
                self.inboxes.resize_with(place + 1, Vec::new);
                self.departed.resize_with(place + 1, Vec::new);
            }
            let departed = &mut self.departed[place];
            departed.clear();
            let inbox = &mut self.inboxes[place];
            inbox.clear();
            if place >= handle.inbox_count {
                continue;
            }
            // SAFETY: the host lends `inbox_count` inboxes with their messages for the time of the call.
            unsafe {
                let lent = *handle.inboxes.add(place);
                for message in 0..lent.count {
                    inbox.push(copy(&*lent.messages.add(message))?);
                }
                let mut view = DepartedView { key: 0, sender: 0 };
                while ((*handle.functions).departed)(handle.state, *subscription, departed.len(), &raw mut view) != 0 {
                    departed.push(Departed { sender: view.sender, key: view.key });
                }
            }
        }
        Ok(())
    }
}

/// # Safety
/// The view's bytes are readable.
unsafe fn copy(view: &MessageView) -> Result<SharedMessage, Failure> {
    let header = Header { sender: view.sender, sent: time(view.sent), cause: Cause(view.cause) };
    // SAFETY: as the caller promises.
    let bytes = unsafe { view.bytes.get() }?;
    Ok(SharedMessage::from_bytes(header, (view.has_key != 0).then_some(view.key), bytes.to_vec()))
}

#[cfg(test)]
mod tests {
    use saoms_abi::HostFunctions;

    use super::super::host::HOST_FUNCTIONS;
    use super::*;

    #[test]
    fn a_program_that_is_older_than_the_library_is_refused() {
        let older = HostFunctions { size: size_of::<HostFunctions>() - size_of::<usize>(), ..HOST_FUNCTIONS };
        let host = |functions| HostHandle {
            state: std::ptr::null_mut(),
            functions,
            inboxes: std::ptr::null(),
            inbox_count: 0,
        };
        let initialized = |functions| {
            // SAFETY: the handle is there; nothing is called through it.
            unsafe { ContextState::default().with(&host(functions), false, |_| Ok::<(), Failure>(())) }
        };
        assert_eq!(initialized(&raw const HOST_FUNCTIONS), Ok(()));
        let failure = initialized(&raw const older).unwrap_err();
        assert!(failure.message().starts_with("the program is older than the library"), "{failure}");
    }
}
