use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::schedule::engine::memory::SharedText;

/// What a change of a running fleet may do.
///
/// ```
/// use saoms_core::schedule::ChangeOptions;
///
/// assert!(!ChangeOptions::default().allow_loss);
/// ```
#[derive(Clone, Debug)]
pub struct ChangeOptions {
    /// True if components may be replaced that do not hand over their state.
    pub allow_loss: bool,
    /// The time of the run for which components that leave may finish what they have begun; then they end all the same,
    /// and hand over what they can.
    pub wait: Duration,
    /// Who wants the change, for the journal.
    pub by: Option<String>,
    /// The way to take the change back while somebody else waits for it.
    pub withdrawal: ChangeWithdrawal,
    /// What a text that [outlives the program](crate::schedule::Handle::share_text) is from the instant on at which the
    /// change takes effect: a later program has both or none.
    pub keeps: Option<(SharedText, String)>,
}

/// The way to take back a change of a running fleet until it is made.
///
/// ```
/// use saoms_core::schedule::ChangeWithdrawal;
///
/// let withdrawal = ChangeWithdrawal::default();
/// withdrawal.clone().withdraw();
/// assert!(withdrawal.is_withdrawn());
/// ```
#[derive(Clone, Debug, Default)]
pub struct ChangeWithdrawal(Arc<AtomicBool>);

impl ChangeOptions {
    /// The time for those that leave unless somebody says otherwise.
    pub const WAIT: Duration = Duration::from_secs(60);

    /// The usual options, for components that may lose their state.
    pub fn allowing_loss() -> ChangeOptions {
        ChangeOptions { allow_loss: true, ..ChangeOptions::default() }
    }
}

impl Default for ChangeOptions {
    fn default() -> ChangeOptions {
        let (wait, withdrawal) = (ChangeOptions::WAIT, ChangeWithdrawal::default());
        ChangeOptions { allow_loss: false, wait, by: None, withdrawal, keeps: None }
    }
}

impl ChangeWithdrawal {
    /// Takes the change back. One that has been made stays.
    pub fn withdraw(&self) {
        self.0.store(true, Ordering::SeqCst);
    }

    /// True if somebody took it back, or wanted to.
    pub fn is_withdrawn(&self) -> bool {
        self.0.load(Ordering::SeqCst)
    }
}
