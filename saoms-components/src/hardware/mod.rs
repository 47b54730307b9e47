//! What a robot asks of its hardware: to move, to collect, to deposit.
//!
//! A robot whose reference `world` is wired drives what is behind it: the simulated hardware of a [`World`](crate::world::World), or a component
//! that drives a real one. The calls never wait: `begin` starts an action, `poll` asks how it goes, `cancel` stops it. `retire` ends the work of a robot that is broken.

mod action;
mod area;

use saoms_api::{Context, Failure, interface};

use crate::grid::Block;

pub use action::{Action, ActionKind, Progress};
pub use area::Area;

/// The hooks to a robot's hardware.
#[interface(name = "saoms.Hardware")]
pub trait Hardware {
    /// Says that the robot of this number and name starts, as it believes at this block; the answer is where it really is.
    fn enter(
        &mut self,
        context: &mut Context<'_>,
        robot: u32,
        name: String,
        block: Block,
    ) -> Result<Block, Failure>;

    /// The area that the robots share.
    fn area(&mut self, context: &mut Context<'_>) -> Result<Area, Failure>;

    /// Starts an action; a robot does one at a time.
    fn begin(&mut self, context: &mut Context<'_>, robot: u32, action: Action) -> Result<Progress, Failure>;

    /// How the robot's action goes.
    fn poll(&mut self, context: &mut Context<'_>, robot: u32) -> Result<Progress, Failure>;

    /// Stops the robot's action where it is; nothing happens when there is none.
    fn cancel(&mut self, context: &mut Context<'_>, robot: u32) -> Result<(), Failure>;

    /// Says that the robot is out of order: its action ends, it stays where it is, and robots beside it collect and deposit on its block in
    /// its place. The answer is where it is.
    fn retire(&mut self, context: &mut Context<'_>, robot: u32) -> Result<Block, Failure>;
}
