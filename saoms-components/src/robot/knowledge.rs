use crate::grid::Block;

use super::{Battery, Job, Lists, Routes};

/// What a robot knows: about itself, its job, the others, and the area.
#[derive(Debug)]
pub struct Knowledge {
    /// Its name.
    pub name: String,
    /// Its number.
    pub number: u32,
    /// The time from one of its executions to the next, in microseconds.
    pub period: u64,
    /// Where it is.
    pub block: Block,
    /// Where it moves next; the same as `block` while it does not.
    pub next: Block,
    /// Where its charger is.
    pub charge_block: Block,
    /// Its battery.
    pub battery: Battery,
    /// What it brings, or would.
    pub job: Option<Job>,
    /// Its state.
    pub variables: Variables,
    /// What it heard from others.
    pub lists: Lists,
    /// The area and the ways through it.
    pub routes: Routes,
}

impl Knowledge {
    /// What a robot knows that starts at its charger.
    pub fn new(name: String, number: u32, charge_block: Block, battery: Battery) -> Knowledge {
        Knowledge {
            name,
            number,
            period: 0,
            block: charge_block,
            next: charge_block,
            charge_block,
            battery,
            job: None,
            variables: Variables::default(),
            lists: Lists::new(number),
            routes: Routes::default(),
        }
    }

    /// Whether it stands at its charger.
    pub fn is_at_charger(&self) -> bool {
        self.block == self.charge_block && self.next == self.charge_block
    }

    /// Where its job leads next: first to where to collect, then to where to deposit.
    pub fn destination(&self) -> Option<Block> {
        let job = self.job.as_ref().filter(|_| self.variables.busy)?;
        Some(if self.variables.has_luggage { job.to } else { job.from })
    }
}

/// The state of a robot, in the terms of the manual's table 6.27.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Variables {
    /// It has a job, or may not take one.
    pub busy: bool,
    /// It took an interest in luggage.
    pub transporter: bool,
    /// It carries luggage.
    pub has_luggage: bool,
    /// It stops for this period.
    pub stop_a_period: bool,
    /// It goes to its charger after its present job.
    pub ready_to_go_under_charge: bool,
    /// It is on the way to its charger.
    pub reaching_charge: bool,
    /// It is at its charger, in charge.
    pub in_charge: bool,
}
