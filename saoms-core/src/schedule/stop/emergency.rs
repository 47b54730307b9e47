//! Emergency stops: hardware stops at once, whatever its component does, and stays stopped until the release.
//!
//! The functions that stop hardware are called from threads of their own, and its heartbeat ends. A component whose
//! class has a live property `stopped` gets the value `true`, so that it goes on without ordering anything of its
//! hardware; executions of others are left out.

use std::sync::Arc;

use saoms_api::host::declaration::PropertyKind;
use saoms_api::{Cause, Level};
use saoms_lang::assembly::ComponentSpec;

use crate::observe::Occurrence;
use crate::schedule::change::{self, LEAVING, Leaving};
use crate::schedule::engine::Engine;
use crate::schedule::engine::slot::{NEVER, Slot, SlotState};
use crate::schedule::members::UnknownComponent;

/// The property by which a component hears that it is stopped.
pub(crate) const STOPPED: &str = "stopped";

/// The kind of the alert about an emergency stop.
const EMERGENCY_STOP: &str = "emergency_stop";

/// True if components of this specification hear of an emergency stop by a live property `stopped`, and go on;
/// executions of others are left out.
pub fn hears_stops(spec: &ComponentSpec) -> bool {
    let declared = spec.class.declaration().property(STOPPED);
    declared.is_some_and(|one| one.live && one.kind == PropertyKind::Boolean)
}

impl Slot {
    /// Why a component that is stopped does not take a new value of a property: it would move before its release.
    pub(in crate::schedule) fn ends_emergency_stop(&self, property: &str, changed: &ComponentSpec) -> Option<String> {
        let is_set = |spec: &ComponentSpec| {
            let stopped = change::changed(spec, STOPPED, "true");
            stopped.is_ok_and(|stopped| stopped.values == spec.values)
        };
        let ends = property == STOPPED && self.is_stopped() && !is_set(changed);
        ends.then(|| "it is stopped by `saoms estop`, and goes on after `saoms release`".to_owned())
    }
}

impl Engine {
    /// The components that an emergency stop is for: those of these paths, or all that move something.
    pub(in crate::schedule) fn to_stop(&self, paths: &[String]) -> Result<Vec<u32>, UnknownComponent> {
        if !paths.is_empty() {
            return paths.iter().map(|path| self.periodic(path)).collect();
        }
        let moves = |index: &u32| {
            let slot = &self.slots[*index as usize];
            slot.is_member()
                && slot.policy.periodic
                && (slot.hears_stops || !self.heartbeats_of(*index).is_empty() || self.moves_elsewhere(*index))
        };
        Ok((0..self.slots.len() as u32).filter(moves).collect())
    }

    /// The components that are stopped, among those of these paths or among all.
    pub(in crate::schedule) fn to_release(&self, paths: &[String]) -> Result<Vec<u32>, UnknownComponent> {
        if !paths.is_empty() {
            return paths.iter().map(|path| self.periodic(path)).collect();
        }
        let is_stopped = |index: &u32| {
            let slot = &self.slots[*index as usize];
            slot.is_member() && slot.is_stopped()
        };
        Ok((0..self.slots.len() as u32).filter(is_stopped).collect())
    }

    /// Stops the hardware of components at once: its functions are called and its heartbeat ends. It may be called in
    /// any phase of the run.
    pub(in crate::schedule) fn stop_at_once(&mut self, components: &[u32]) {
        for index in components {
            let slot = &mut self.slots[*index as usize];
            slot.set_stopped(true);
            // What its code has begun may still reach the hardware.
            slot.stops_again = slot.body.is_none();
        }
        components.iter().for_each(|index| self.stop_hardware_of(*index));
    }

    /// Has the hardware of a component stopped: its own, and what only stopped components use.
    fn stop_hardware_of(&mut self, index: u32) {
        self.stops.request_of(index);
        self.stop_its_hardware(index);
    }

    /// Stops the hardware of a component once more, whose code was running when it was stopped.
    #[cold]
    pub(in crate::schedule) fn stop_again(&mut self, index: u32) {
        if std::mem::take(&mut self.slots[index as usize].stops_again) {
            self.stop_hardware_of(index);
        }
    }

    /// Tells components that they are stopped or released, which the journal has as this record.
    pub(in crate::schedule) fn tell_stopped(&mut self, components: &[u32], is_stopped: bool, cause: Cause, now: u64) {
        for index in components {
            let slot = &mut self.slots[*index as usize];
            slot.set_stopped(is_stopped);
            slot.stops_again &= is_stopped;
            self.note_differs(*index, now);
            let slot = &mut self.slots[*index as usize];
            if slot.hears_stops {
                self.queue_told(*index, STOPPED, is_stopped, cause);
            } else if !is_stopped && slot.state == SlotState::Active && slot.body.is_some() {
                self.react_to_news(*index, now);
            }
        }
    }

    /// Gives a component that does not run the value with which it will start.
    pub(in crate::schedule) fn set_at_rest(&mut self, index: u32, property: &str, value: &str) {
        let slot = &mut self.slots[index as usize];
        if let Ok(changed) = change::changed(&slot.spec, property, value) {
            slot.spec = Arc::new(changed);
            if let Some(body) = &mut slot.body {
                body.part.spec = Arc::clone(&slot.spec);
            }
        }
        if property == LEAVING {
            slot.leaving = match (value == "true", slot.state) {
                // It says more once it has started.
                (true, SlotState::Starting) => Leaving::Finishing,
                (true, _) => Leaving::Finished,
                (false, _) => Leaving::Not,
            };
        }
    }

    /// The specification of a component that takes the place of another one: where that is stopped, it is, too.
    pub(in crate::schedule) fn still_stopped(&self, number: u32, spec: Arc<ComponentSpec>) -> Arc<ComponentSpec> {
        if !self.slots[number as usize].is_stopped() || !hears_stops(&spec) {
            return spec;
        }
        change::changed(&spec, STOPPED, "true").map_or(spec, Arc::new)
    }

    /// Leaves out the execution of a component that is stopped and does not hear of it: its phase stays.
    #[cold]
    pub(in crate::schedule) fn leave_out(&mut self, index: u32, now: u64) {
        let slot = &mut self.slots[index as usize];
        slot.react_due = NEVER;
        if slot.due <= now {
            let periods = (now - slot.due) / slot.policy.period + 1;
            slot.due = slot.due.saturating_add(periods.saturating_mul(slot.policy.period));
        }
        let when = slot.next_time();
        self.enqueue(index, when);
    }

    /// Logs an emergency stop or a release. A stop is an alert until nothing is stopped any more.
    pub(in crate::schedule) fn log_stopped(
        &mut self,
        components: &[u32],
        is_stopped: bool,
        by: Option<&str>,
        now: u64,
    ) {
        let what = if is_stopped { "emergency stop" } else { "release" };
        let names: Vec<&str> = components.iter().map(|index| &*self.slots[*index as usize].name).collect();
        let by = by.map(|name| format!(" by {name}")).unwrap_or_default();
        let whom = match names[..] {
            [] if is_stopped => "no component controls hardware".to_owned(),
            [] => "no component was stopped".to_owned(),
            _ => names.join(", "),
        };
        let text = format!("{what}{by}: {whom}");
        let (kind, subject) = (EMERGENCY_STOP.into(), "".into());
        if is_stopped && !components.is_empty() {
            return self.note(now, Occurrence::Alert { kind, subject, text: Some(text) });
        }
        self.note(now, Occurrence::Note { level: Level::Warning, text });
        if !components.is_empty() && !self.slots.iter().any(|slot| slot.is_member() && slot.is_stopped()) {
            self.note(now, Occurrence::Alert { kind, subject, text: None });
        }
    }
}
