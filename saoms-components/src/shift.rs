//! Shifts: components that others schedule for a time.

use std::time::Duration;

use saoms_api::{Class, Component, Context, Failure, Message, Properties, Saved, TaskInterfaceReference, Time, info};

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
#[class(name = "saoms.Shift", periodic, saves)]
pub struct Shift {
    #[properties]
    properties: ShiftProperties,
    #[reference]
    tasks: Vec<TaskInterfaceReference>,
    roster: Roster,
}

/// The shifts so far, and the next one: what outlives an instance.
#[derive(Clone, Debug, Default, Message)]
struct Roster {
    /// Time of the next shift, if there is another one.
    next: Time,
    /// True from the first execution on.
    is_on_duty: bool,
    /// End of the present shift.
    ends: Option<Time>,
    begun: u32,
}

impl Component for Shift {
    type Properties = ShiftProperties;

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.roster.next = context.now() + self.properties.start;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let (roster, now) = (&mut self.roster, context.now());
        if !std::mem::replace(&mut roster.is_on_duty, true) {
            roster.next = roster.next.max(now);
        }
        let ShiftProperties { work, pause, shifts, .. } = self.properties;
        let is_over = roster.ends.take_if(|end| *end <= now).is_some();
        let is_due = roster.next <= now && shifts.is_none_or(|shifts| roster.begun < shifts);
        // Another shift without a pause goes on with the same components.
        if is_over && !is_due {
            info!(context, "shift {} is over for {}", self.roster.begun, self.names());
        }
        if !is_due {
            return Ok(());
        }
        let milliseconds = u64::try_from(work.as_millis()).unwrap_or(u64::MAX);
        for task in &self.tasks {
            task.schedule_for(context, milliseconds)?;
        }
        let roster = &mut self.roster;
        roster.begun = roster.begun.saturating_add(1);
        roster.ends = Some(now + work);
        roster.next = roster.next + work + pause;
        info!(context, "starts shift {} of {} s for {}", self.roster.begun, work.as_secs_f64(), self.names());
        Ok(())
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(Saved::of(&self.roster))
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        if let Some(roster) = saved.read()? {
            self.roster = roster;
        }
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
