//! What a robot does by itself in each execution, whichever loops it has: its battery drains and charges, it knows how
//! far the battery lasts, and follows what its loops decided.

use saoms_api::{Context, Failure};

use super::{Battery, Policy, RobotKnowledge};

impl RobotKnowledge {
    /// Begins an execution.
    pub(super) fn begin_execution(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let now = context.now();
        self.polled = None;
        self.lingers = self.lingers.saturating_sub(1);
        self.awaits_master = self.awaits_master.saturating_sub(1);
        self.elapsed = self.executed_at.map_or(std::time::Duration::ZERO, |last| now.since(last));
        self.executed_at = Some(now);
        self.take_measured();
        self.level_before = self.charge;
        if let Some(percent) = self.hardware.battery(context, self.number)? {
            self.battery.set_percent(percent);
            self.level_before = self.battery.percent();
        }
        self.use_battery();
        Ok(())
    }

    /// Takes over the battery level that a loop measured.
    fn take_measured(&mut self) {
        if self.charge != self.battery.percent() {
            if self.charge.is_finite() {
                self.battery.set_percent(self.charge);
            }
            self.charge = self.battery.percent();
        }
    }

    /// Drains or charges the battery by the time since the last execution, unless the hardware measures it.
    fn use_battery(&mut self) {
        let (charges, drains) = match self.policy {
            Policy::Safe => {
                let entered = self.hardware.has_entered();
                let is_at_charger = self.is_at_charger();
                (entered && is_at_charger && !self.battery.is_full(), entered && !is_at_charger)
            }
            // As in the manual: a robot that is awake at its charger does neither.
            Policy::Classic => {
                let in_charge = self.variables.in_charge;
                (in_charge && !self.battery.is_full(), !in_charge && self.block != self.charge_block)
            }
        };
        self.charging = charges;
        if self.hardware.measures_battery() {
            // The level is known.
        } else if charges {
            if self.strain.gives(self.block) {
                self.battery.charge(self.elapsed);
            }
        } else if drains && !(self.stopped && self.battery.drains_by_execution()) {
            // An execution stands for driving, which a stopped robot does not; time goes on.
            let elapsed = self.elapsed;
            self.discharge(|battery| battery.drain(elapsed));
        }
        self.charge = self.battery.percent();
    }

    /// Discharges the battery by a move to the next block.
    pub(super) fn use_battery_to_drive(&mut self) {
        if !self.hardware.measures_battery() {
            self.discharge(Battery::drive);
        }
        self.charge = self.battery.percent();
    }

    /// Measures what the loops decide by, after all of them have monitored.
    pub(super) fn measure(&mut self) {
        self.take_measured();
        match self.policy {
            Policy::Safe => {
                self.measure_energy();
                self.traffic.look(&self.lists.peers, self.next);
            }
            Policy::Classic => {
                self.lasts = self.executions_left();
                self.way_home = self.next.distance(self.charge_block);
            }
        }
    }

    /// Ends an execution: what the loops wrote into entries takes effect.
    pub(super) fn end_execution(&mut self, was_critical: bool, context: &mut Context<'_>) -> Result<(), Failure> {
        if self.policy == Policy::Safe {
            self.follow_decisions();
            self.traffic.follow(&mut self.wanted, self.next);
        }
        if self.routes.charge_block().is_some_and(|known| known != self.charge_block) {
            self.use_charger(self.charge_block);
        }
        self.lists.is_doubted = false;
        // A broken robot stops its hardware for good, and says a last time what it has to say in the next execution.
        self.shut_down |= was_critical;
        if !self.variables.critical {
            return Ok(());
        }
        self.stop_for_good(context)?;
        if self.policy == Policy::Safe && self.hardware.is_retired() {
            self.next = self.block;
        }
        Ok(())
    }

    /// Takes the hardware of a broken robot out of service, unless a loop did. Hardware that is busy is asked again.
    pub(super) fn stop_for_good(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if !self.hardware.is_retired() {
            self.retire(context)?;
        }
        Ok(())
    }
}
