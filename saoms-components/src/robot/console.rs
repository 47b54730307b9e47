//! Lines of the original's console.

use saoms_api::Context;

use crate::console::JavaList;
use crate::grid::Block;

use super::RobotKnowledge;

impl RobotKnowledge {
    /// Prints the robot's lists, in the format of the console in the manual's figures.
    pub(super) fn show_lists(&self, context: &mut Context<'_>) {
        let RobotKnowledge { name, lists, .. } = self;
        context.console(format_args!("{name} updated active robot list: {}", JavaList(lists.active.iter())));
        if lists.peers.heard().next().is_some() {
            let heard = JavaList(lists.peers.heard());
            context.console(format_args!("{name} updated other robot position list: {heard}"));
        }
        let helps = JavaList(lists.helps.open().iter());
        context.console(format_args!("{name} help request list: {helps}"));
        let open = JavaList(lists.requests.open().iter());
        context.console(format_args!("{name} luggage request list: {open}"));
    }

    /// Prints the battery, in the format of the console in the manual's figures.
    pub(super) fn show_battery(&self, context: &mut Context<'_>) {
        let RobotKnowledge { name, battery, .. } = self;
        if battery.is_at_most(10) && !self.is_at_charger() {
            context.console(format_args!("{name} needs to reach charge position as soon as possible!"));
        } else {
            context.console(format_args!("{name} battery level: {battery}"));
        }
    }

    /// Prints the robot's next block, in the format of the console in the manual's figures.
    pub(super) fn show_move(&self, context: &mut Context<'_>, next: Block) {
        let RobotKnowledge { name, block, .. } = self;
        context.console(format_args!("{name} says: My position now is: {block} and my next position will be: {next}"));
    }
}
