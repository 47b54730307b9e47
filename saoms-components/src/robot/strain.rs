//! Faults that scenarios put into a robot: its battery loses charge, or a charger gives nothing. The robot plays them,
//! as it counts its battery; its loops see no more than the level.

use saoms_api::{Cause, Context, Field, Subscription, Time, record, warn};

use super::{Battery, RobotKnowledge};
use crate::grid::Block;
use crate::messages::{Drain, Outage, end_of};

/// The faults that have begun and are not over.
#[derive(Clone, Debug, Default, PartialEq, Field)]
pub(crate) struct Strain {
    drains: Vec<FastDrain>,
    outages: Vec<ChargerOutage>,
}

/// A battery that drains faster.
#[derive(Clone, Copy, Debug, PartialEq, Field)]
struct FastDrain {
    factor: f64,
    until: Option<Time>,
}

/// A charger that gives nothing.
#[derive(Clone, Copy, Debug, PartialEq, Field)]
struct ChargerOutage {
    charger: Block,
    until: Option<Time>,
}

impl Strain {
    /// Forgets what is over.
    fn settle(&mut self, now: Time) {
        let lasts = |until: Option<Time>| until.is_none_or(|until| now < until);
        self.drains.retain(|drain| lasts(drain.until));
        self.outages.retain(|outage| lasts(outage.until));
    }

    /// Notes that a charger gives nothing.
    fn end_charger(&mut self, charger: Block, until: Option<Time>) {
        match self.outages.iter_mut().find(|known| known.charger == charger) {
            Some(known) => known.until = known.until.zip(until).map(|(one, other)| one.max(other)),
            None => self.outages.push(ChargerOutage { charger, until }),
        }
    }

    /// Notes that the battery drains faster.
    fn drain_faster(&mut self, factor: f64, until: Option<Time>) {
        match self.drains.iter_mut().find(|known| known.until == until) {
            Some(known) => known.factor *= factor,
            None => self.drains.push(FastDrain { factor, until }),
        }
    }

    /// True if the charger on this block gives something.
    pub(super) fn gives(&self, charger: Block) -> bool {
        self.outages.iter().all(|outage| outage.charger != charger)
    }

    /// How many times as much everything takes that discharges the battery.
    fn factor(&self) -> f64 {
        self.drains.iter().map(|drain| drain.factor).product()
    }
}

impl RobotKnowledge {
    /// Takes in the faults of this execution.
    pub(super) fn hear_strain(
        &mut self,
        drains: Subscription<Drain>,
        outages: Subscription<Outage>,
        context: &mut Context<'_>,
    ) {
        for (header, drain) in context.receive(&drains).with_headers() {
            if drain.robot == self.number && self.accepts(drain, header, context) {
                context.because(header.cause);
                self.lose(drain, header.sent, context);
                context.because(Cause::default());
            }
        }
        for (header, outage) in context.receive(&outages).with_headers() {
            if self.accepts(outage, header, context) {
                self.strain.end_charger(outage.charger, end_of(header.sent, outage.lasting.as_ref()));
            }
        }
        if self.strain != Strain::default() {
            self.strain.settle(context.now());
        }
    }

    fn lose(&mut self, drain: &Drain, began: Time, context: &mut Context<'_>) {
        if self.hardware.measures_battery() {
            context.count("faults.ignored", 1);
            return warn!(context, "its hardware measures the battery, which cannot be drained here");
        }
        if let Some(factor) = drain.factor {
            self.strain.drain_faster(factor, end_of(began, drain.lasting.as_ref()));
            context.effect(record!(battery_drains_faster: "battery drains {factor} times as fast", factor));
            warn!(context, "battery drains {factor} times as fast");
        }
        if let Some(percent) = drain.percent {
            self.battery.set_percent(self.battery.percent() - percent);
            self.charge = self.battery.percent();
            let battery = self.charge;
            context.effect(record!(battery_loses: "battery loses {percent} %, {battery} % are left", percent, battery));
            warn!(context, "battery loses {percent} %: {battery} % are left");
        }
    }

    /// Discharges the battery, by more where a fault drains it.
    pub(super) fn discharge(&mut self, use_battery: impl FnOnce(&mut Battery)) {
        let before = self.battery.percent();
        use_battery(&mut self.battery);
        if !self.strain.drains.is_empty() {
            let lost = before - self.battery.percent();
            self.battery.set_percent(before - lost * self.strain.factor());
        }
    }
}
