//! Shifts: components that others schedule for a time.

use std::time::Duration;

use saoms_api::{Class, Component, Context, Failure, Properties, TaskInterfaceReference, Time, info};

/// Properties of shifts.
#[derive(Clone, Debug, Properties)]
pub struct ShiftProperties {
    /// Time of the first shift, from the start of this component.
    #[property(default = "0s", range = "0s"..="24h")]
    pub(crate) start: Duration,
    /// Length of a shift.
    #[property(range = "1ms"..="24h")]
    pub(crate) work: Duration,
    /// Time from the end of a shift to the start of the next one.
    #[property(default = "0s", range = "0s"..="24h")]
    pub(crate) pause: Duration,
    /// Number of shifts; by default they do not end.
    #[property(range = 1..)]
    pub(crate) shifts: Option<u32>,
}

/// Schedules other components in shifts: it starts them, and they stop after the time that it gives them.
///
/// Their `runOnStartup` is `false`, so that they wait for their first shift. Its reference `tasks` leads to any
/// periodic component. A new shift starts in the first execution that is due at its time or later. The first
/// one starts, and is counted from, no earlier than the first execution, which a `delay` can put off.
#[derive(Debug, Class)]
#[class(name = "saoms.Shift", periodic)]
pub struct Shift {
    #[properties]
    properties: ShiftProperties,
    #[reference]
    tasks: Vec<TaskInterfaceReference>,
    /// Time of the next shift; `None` after the last one.
    next: Option<Time>,
    /// True from the first execution on.
    is_on_duty: bool,
    /// End of the present shift.
    ends: Option<Time>,
    begun: u32,
}

impl Component for Shift {
    type Properties = ShiftProperties;

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.next = Some(context.now() + self.properties.start);
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if !std::mem::replace(&mut self.is_on_duty, true) {
            self.next = self.next.max(Some(context.now()));
        }
        let is_due = |time: &Time| *time <= context.now();
        let (due, is_over) = (self.next.filter(is_due), self.ends.take_if(|end| is_due(end)).is_some());
        // Another shift without a pause goes on with the same components.
        if is_over && due.is_none() {
            info!(context, "shift {} is over for {}", self.begun, self.names());
        }
        let Some(due) = due else { return Ok(()) };
        let ShiftProperties { work, pause, shifts, .. } = self.properties;
        let milliseconds = u64::try_from(work.as_millis()).unwrap_or(u64::MAX);
        for task in &self.tasks {
            task.schedule_for(context, milliseconds)?;
        }
        self.begun = self.begun.saturating_add(1);
        self.ends = Some(context.now() + work);
        self.next = Some(due + work + pause).filter(|_| shifts.is_none_or(|shifts| self.begun < shifts));
        info!(context, "starts shift {} of {} s for {}", self.begun, work.as_secs_f64(), self.names());
        Ok(())
    }
}

impl Shift {
    fn names(&self) -> String {
        match self.tasks.len() {
            1 => "1 component".to_owned(),
            count => format!("{count} components"),
        }
    }
}
