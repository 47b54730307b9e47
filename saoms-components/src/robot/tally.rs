//! The row of a robot in the report.

use std::time::Duration;

use saoms_api::{Context, ReportValue};

use super::{RobotKnowledge, Trouble, Variables};
use crate::grid::Block;
use crate::messages::job_name;

/// What a robot did so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tally {
    /// Pieces of luggage that it delivered.
    pub(super) delivered: u64,
    /// Blocks that it drove.
    pub(super) blocks: u64,
    /// Time for which another robot kept it from entering the block that it wanted.
    pub(super) waited: Duration,
}

impl RobotKnowledge {
    /// Notes whether the robot waits in this execution.
    pub(super) fn note_waiting(&mut self) {
        if self.variables.stop_a_period {
            self.tally.waited += self.elapsed;
        }
    }

    /// Writes the row of the robot to the report. A robot that is scheduled again goes on counting.
    pub(super) fn report_row(&self, context: &mut Context<'_>) {
        // Dots lead into objects.
        let key = context.name().replace('.', "_");
        let row = |field: &str| format!("robots.by_path.{key}.{field}");
        let Tally { delivered, blocks, waited } = self.tally;
        context.report(&row("number"), i64::from(self.number));
        context.count(&row("delivered"), i64::try_from(delivered).unwrap_or(i64::MAX));
        context.count(&row("blocks"), i64::try_from(blocks).unwrap_or(i64::MAX));
        context.count(&row("waited_ms"), i64::try_from(waited.as_millis()).unwrap_or(i64::MAX));
        context.report(&row("battery"), self.battery.percent());
        context.report(&row("state"), self.state());
    }

    /// What an operator wants to know of it.
    pub(super) fn status(&self) -> Vec<(String, ReportValue)> {
        let block = |block: Block| ReportValue::List(vec![block.x.into(), block.y.into()]);
        let job = self.job.as_ref().map_or(ReportValue::Null, |job| {
            format!("{} from {} to {}", job_name(job.luggage), job.from, job.to).into()
        });
        let waits = self.conflict.as_ref();
        ReportValue::named([
            ("robot", ReportValue::from(self.number)),
            ("state", self.state().into()),
            ("block", block(self.block)),
            ("battery", self.battery.percent().into()),
            ("job", job),
            ("waits_for_robot", waits.map_or(ReportValue::Null, |conflict| conflict.waits_for.into())),
            ("waits_since_s", waits.map_or(ReportValue::Null, |conflict| conflict.since.as_secs_f64().into())),
            ("waits_at", waits.map_or(ReportValue::Null, |conflict| block(conflict.block))),
            ("goes_first", waits.map_or(ReportValue::Null, |conflict| conflict.first.into())),
            ("because", waits.map_or(ReportValue::Null, |conflict| conflict.why().into())),
            ("delivered", i64::try_from(self.tally.delivered).unwrap_or(i64::MAX).into()),
        ])
    }

    /// Its state in a word or two.
    fn state(&self) -> &'static str {
        let Variables { has_luggage, reaching_charge, in_charge, asleep, busy, .. } = self.variables;
        match self.trouble {
            _ if self.gone => "gone",
            Some(Trouble::Battery) => "stranded",
            Some(Trouble::Breakdown | Trouble::Hardware) => "broken",
            None if self.shut_down => "broken",
            None if self.waits_to_enter() => "waits to enter",
            None if self.stopped => "stopped",
            None if has_luggage => "carries luggage",
            None if self.job.is_some() && busy => "goes to luggage",
            None if reaching_charge => "goes to charge",
            None if asleep => "asleep",
            None if in_charge => "charges",
            None => "free",
        }
    }
}
