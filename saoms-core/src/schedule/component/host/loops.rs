//! The loops of a component, and what they write into its journal.

use saoms_api::host::contain::contained;
use saoms_api::host::present::about;
use saoms_api::host::{DynLoop, Phase};
use saoms_api::{Failure, Record, Value};

use super::ComponentHost;
use crate::journal::Stamp;
use crate::schedule::component::body::subject;
use crate::schedule::component::part::Part;
use crate::schedule::shared::Shared;

/// Records carry the time at which the execution began: an execution is one instant, and the clock need not be read.
fn stamp<'a>(shared: &'a Shared, part: &Part) -> Stamp<'a> {
    Stamp { ids: &shared.records, component: part.index, time: part.now }
}

impl ComponentHost<'_> {
    /// A new instance of one of its loops.
    pub(super) fn construct_loop(&self, place: u32) -> Result<Box<dyn DynLoop>, Failure> {
        if !self.part.initializing {
            return Err(Failure::new("take the loops in `initialize`, and keep what `loops` returns"));
        }
        let one = self.spec().loops.get(place as usize).ok_or("there are fewer loops")?;
        let constructed = contained(|| about(&subject(&self.part.name), || one.class.construct(&one.values)));
        let constructed = constructed.and_then(|made| made);
        constructed.map_err(|failure| Failure::new(format!("loop `{}`: {failure}", one.name)))
    }

    /// Writes what a loop, or the component itself, saw, decided or did.
    pub(super) fn write_record(&mut self, phase: Phase, record: &Record) {
        let stamp = stamp(self.shared, self.part);
        let Part { recorder, spec, .. } = &mut *self.part;
        let place = recorder.present().map(usize::from);
        let class = place.and_then(|place| spec.loops.get(place)).map(|one| &one.class);
        let senses = class.map_or(&[][..], |class| &class.declaration().senses);
        recorder.write(stamp, phase, record, senses);
    }

    /// Writes that an entry of the knowledge changed.
    pub(super) fn write_change(&mut self, entry: &'static str, before: Value, after: Value) {
        let stamp = stamp(self.shared, self.part);
        self.part.recorder.changed(stamp, entry, before, after);
    }
}
