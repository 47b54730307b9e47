use std::fmt;
use std::time::Duration;

use crate::Failure;

/// A function that stops the hardware of a component, wherever the component is at that moment.
///
/// A class that declares `stops` in `#[class(...)]` registers one or several in `initialize`, with
/// [`Context::register_stop`](crate::Context::register_stop). The host calls it
///
/// - when the component fails, does not return, is unscheduled or removed,
/// - for a passive component, also when the last component that is wired to it does one of these,
/// - at every end of the program that leaves it time: the end of the run, a signal, the second signal.
///
/// It is called from a thread of the host's, at any time and any number of times, also while another function of the
/// component runs or hangs. So it captures what threads can share, such as the handle of a connection, and brings the
/// hardware to rest by itself. It may wait for the hardware: nobody but the end of the program waits for it.
///
/// A *heartbeat* covers what no function can: a program that was killed, a network that was cut. The host calls it
/// after each finished execution of the component, and of each component that is wired to it, with the time within
/// which the next one is due. The driver passes it on, and hardware that receives none for twice that time stops by
/// itself. A heartbeat must not wait.
///
/// ```
/// use std::sync::Arc;
/// use std::sync::atomic::{AtomicBool, Ordering};
///
/// use saoms_api::{Class, Component, Context, Failure, StopFunction};
///
/// /// A fan that never stops by itself.
/// #[derive(Class)]
/// #[class(name = "example.Fan", periodic, stops)]
/// struct Fan {
///     turns: Arc<AtomicBool>,
/// }
///
/// impl Component for Fan {
///     type Properties = ();
///
///     fn new((): ()) -> Result<Self, Failure> {
///         Ok(Fan { turns: Arc::default() })
///     }
///
///     fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
///         let turns = Arc::clone(&self.turns);
///         context.register_stop(StopFunction::new(move || {
///             turns.store(false, Ordering::SeqCst);
///             Ok(())
///         }))
///     }
///
///     fn execute(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
///         self.turns.store(true, Ordering::SeqCst);
///         Ok(())
///     }
/// }
/// ```
pub struct StopFunction {
    stop: Box<dyn Fn() -> Result<(), Failure> + Send + Sync>,
    heartbeat: Option<Box<dyn Fn(Duration) + Send + Sync>>,
}

impl StopFunction {
    /// A function that stops the hardware. An `Err` means that the hardware may still move: the run has failed then.
    pub fn new(stop: impl Fn() -> Result<(), Failure> + Send + Sync + 'static) -> StopFunction {
        StopFunction { stop: Box::new(stop), heartbeat: None }
    }

    /// The same with a heartbeat, which gets the time within which the next one is due.
    #[must_use]
    pub fn with_heartbeat(self, heartbeat: impl Fn(Duration) + Send + Sync + 'static) -> StopFunction {
        StopFunction { heartbeat: Some(Box::new(heartbeat)), ..self }
    }

    /// For hosts: stops the hardware.
    ///
    /// # Errors
    /// It may still move.
    pub fn stop(&self) -> Result<(), Failure> {
        (self.stop)()
    }

    /// For hosts: true if it has a heartbeat.
    pub fn has_heartbeat(&self) -> bool {
        self.heartbeat.is_some()
    }

    /// For hosts: signals the hardware that its component is alive; the next heartbeat is due within `period`.
    pub fn beat(&self, period: Duration) {
        if let Some(heartbeat) = &self.heartbeat {
            heartbeat(period);
        }
    }
}

impl fmt::Debug for StopFunction {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("StopFunction").field("has_heartbeat", &self.has_heartbeat()).finish_non_exhaustive()
    }
}
