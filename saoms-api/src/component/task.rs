use crate::{Context, Failure, interface};

/// The service that every periodic component offers: to be scheduled, unscheduled, and asked.
///
/// The host serves it for the component, whose class neither declares nor implements it. A component that has a
/// reference with this interface can be wired to any periodic component.
///
/// ```
/// use saoms_api::{Context, Failure, TaskInterfaceReference};
///
/// /// Stops the task when it runs.
/// fn pause(task: &TaskInterfaceReference, context: &mut Context<'_>) -> Result<(), Failure> {
///     if task.is_running(context)? {
///         task.unschedule(context)?;
///     }
///     Ok(())
/// }
/// ```
#[interface(name = "unibg.robotics.tca.TaskInterface")]
pub trait TaskInterface {
    /// Starts the periodic executions, the first after the task's delay. Nothing happens when they are running.
    fn schedule(&mut self, context: &mut Context<'_>) -> Result<(), Failure>;

    /// The same for a limited time, in milliseconds, counted from now; then the task is unscheduled.
    fn schedule_for(&mut self, context: &mut Context<'_>, milliseconds: u64) -> Result<(), Failure>;

    /// Ends the executions; the present one ends early only with `mayInterruptIfRunning`. Nothing happens when none are
    /// running.
    fn unschedule(&mut self, context: &mut Context<'_>) -> Result<(), Failure>;

    /// True if the task is scheduled.
    fn is_running(&mut self, context: &mut Context<'_>) -> Result<bool, Failure>;
}
