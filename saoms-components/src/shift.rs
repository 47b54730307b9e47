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
    /// True from the first execution on, as long as there are shifts left.
    is_on_duty: bool,
    /// End of the present shift.
    ends: Option<Time>,
    begun: u32,
}

impl Roster {
    /// True if a shift begins in an execution at this time, of this number of shifts.
    fn is_due(&mut self, now: Time, shifts: Option<u32>) -> bool {
        let is_left = shifts.is_none_or(|shifts| self.begun < shifts);
        // Neither shifts that begin late nor those that are added later make up for the time before.
        if !std::mem::replace(&mut self.is_on_duty, is_left) && is_left {
            self.next = self.next.max(now);
        }
        is_left && self.next <= now
    }

    /// Begins a shift.
    fn begin(&mut self, now: Time, work: Duration, pause: Duration) {
        self.begun = self.begun.saturating_add(1);
        self.ends = Some(now + work);
        self.next = self.next + work + pause;
    }
}

impl Component for Shift {
    type Properties = ShiftProperties;

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.roster.next = context.now() + self.properties.start;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let (roster, now) = (&mut self.roster, context.now());
        let ShiftProperties { work, pause, shifts, .. } = self.properties;
        let is_over = roster.ends.take_if(|end| *end <= now).is_some();
        let is_due = roster.is_due(now, shifts);
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
        self.roster.begin(now, work, pause);
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The seconds in which shifts of 2 s begin, with pauses of 3 s: those from the first one to the second one, of so
    /// many shifts.
    fn begins(roster: &mut Roster, seconds: std::ops::Range<u64>, shifts: Option<u32>) -> Vec<u64> {
        let mut begins = |second: &u64| {
            let now = Time::START + Duration::from_secs(*second);
            let is_due = roster.is_due(now, shifts);
            if is_due {
                roster.begin(now, Duration::from_secs(2), Duration::from_secs(3));
            }
            is_due
        };
        seconds.filter(|second| begins(second)).collect()
    }

    #[test]
    fn shifts_that_are_added_to_finished_ones_follow_each_other_from_then_on() {
        let mut roster = Roster::default();
        assert_eq!(begins(&mut roster, 0..100, Some(2)), [0, 5]);
        assert_eq!(begins(&mut roster, 100..120, Some(4)), [100, 105]);
        assert_eq!(begins(&mut roster, 120..200, Some(3)), [0; 0]);
        assert_eq!(begins(&mut roster, 200..212, None), [200, 205, 210]);
        // One that is added in time begins in time.
        assert_eq!(begins(&mut roster, 212..214, Some(7)), [0; 0]);
        assert_eq!(begins(&mut roster, 214..222, Some(9)), [215, 220]);
    }

    #[test]
    fn shifts_that_begin_late_keep_to_their_times() {
        let mut roster = Roster::default();
        assert_eq!(begins(&mut roster, 3..4, None), [3]);
        assert_eq!(begins(&mut roster, 10..20, None), [10, 13, 18]);
    }
}
