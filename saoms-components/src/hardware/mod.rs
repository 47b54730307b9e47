//! Service that a robot's hardware offers: moving, collecting and depositing.
//!
//! A robot whose reference `world` is wired drives the hardware at its other end: the simulated hardware of a
//! [`World`](crate::world::World), or a component that drives real hardware. The calls never wait: `begin` starts an
//! action, `poll` returns its progress, `cancel` stops it. `retire` ends the work of a robot that is broken.

mod action;
mod area;
mod proxy;

use saoms_api::extension::{ServiceEffects, submit};
use saoms_api::host::{Interface, Operation, cdr};
use saoms_api::{Context, Failure, interface};

use crate::grid::Block;

pub use action::{Action, ActionKind, Progress};
pub use area::Area;

/// Service of a robot's hardware.
#[interface(name = "saoms.Hardware")]
pub trait Hardware {
    /// Registers a robot with its number, its name and the block where it assumes to be; returns its real position.
    fn enter(&mut self, context: &mut Context<'_>, robot: u32, name: String, block: Block) -> Result<Block, Failure>;

    /// The map that the robots share.
    fn area(&mut self, context: &mut Context<'_>) -> Result<Area, Failure>;

    /// Starts an action; a robot runs one at a time.
    fn begin(&mut self, context: &mut Context<'_>, robot: u32, action: Action) -> Result<Progress, Failure>;

    /// Progress of the robot's action.
    fn poll(&mut self, context: &mut Context<'_>, robot: u32) -> Result<Progress, Failure>;

    /// Stops the robot's action where it is; does nothing if no action is running.
    fn cancel(&mut self, context: &mut Context<'_>, robot: u32) -> Result<(), Failure>;

    /// Takes the robot out of service: its action ends, it stays where it is, and adjacent robots may collect and
    /// deposit on its block in its place. Returns its position.
    fn retire(&mut self, context: &mut Context<'_>, robot: u32) -> Result<Block, Failure>;

    /// Level of the robot's battery in percent; `None`, as by itself, if the hardware does not measure it: then the
    /// robot counts.
    fn battery(&mut self, context: &mut Context<'_>, robot: u32) -> Result<Option<f64>, Failure> {
        let _ = (context, robot);
        Ok(None)
    }

    /// True if the robot stands on the floor; so by itself, as that of real robots that nobody carries away. In a site
    /// with zones a robot of which this says no enters the floor only once its block is granted to it.
    fn is_on_floor(&mut self, context: &mut Context<'_>, robot: u32) -> Result<bool, Failure> {
        let _ = (context, robot);
        Ok(true)
    }

    /// What became of an action of which the robot knows that an earlier program began it, or was about to; before
    /// `enter`, after a restart of the program. `None`, as by itself, if the hardware does not know: then a person is
    /// asked. `Failed` if it did not begin.
    fn recall(&mut self, context: &mut Context<'_>, robot: u32, action: Action) -> Result<Option<Progress>, Failure> {
        let _ = (context, robot, action);
        Ok(None)
    }
}

/// The operations by their places in the interface.
const ENTER: Operation = 0;
const BEGIN: Operation = 2;
const POLL: Operation = 3;
const CANCEL: Operation = 4;
const RETIRE: Operation = 5;

submit! {
    ServiceEffects {
        interface: <dyn Hardware as Interface>::NAME,
        begin: BEGIN,
        poll: POLL,
        end: &[ENTER, CANCEL, RETIRE],
        waiting: || cdr::encode(&Progress::Running),
        failed: || cdr::encode(&Progress::Failed),
    }
}
