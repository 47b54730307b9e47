use saoms_api::{Context, Failure};

use crate::console::JavaList;
use crate::messages::LuggageStage;

use super::{Hooks, Job, Knowledge, Topics};

/// What the rules of a robot work on during an execution: what it knows, its hardware, its topics.
pub(crate) struct Body<'a, 'c> {
    pub(crate) knowledge: &'a mut Knowledge,
    pub(crate) hooks: &'a mut Hooks,
    pub(crate) topics: &'a mut Topics,
    pub(crate) context: &'a mut Context<'c>,
}

impl Body<'_, '_> {
    /// Responds to the request for a piece of luggage.
    pub(crate) fn respond(&mut self, job: &Job, stage: LuggageStage) -> Result<(), Failure> {
        self.topics.respond(self.context, self.knowledge, job, stage)
    }

    /// Shows what the robot heard, as the console of the manual's figures does.
    pub(crate) fn show_lists(&mut self) {
        let Knowledge { name, lists, .. } = &*self.knowledge;
        self.context
            .console(format_args!("{name} updated active robot list: {}", JavaList(lists.active.iter())));
        if lists.peers.heard().next().is_some() {
            let heard = JavaList(lists.peers.heard());
            self.context.console(format_args!("{name} updated other robot position list: {heard}"));
        }
        let open = JavaList(lists.requests.open().iter());
        self.context.console(format_args!("{name} luggage request list: {open}"));
    }

    /// Shows the battery, as the console of the manual's figures does.
    pub(crate) fn show_battery(&mut self) {
        let Knowledge { name, battery, .. } = &*self.knowledge;
        if battery.is_at_most(10) && !self.knowledge.is_at_charger() {
            self.context.console(format_args!("{name} needs to reach charge position as soon as possible!"));
        } else {
            self.context.console(format_args!("{name} battery level: {battery}"));
        }
    }

    /// Shows where the robot goes, as the console of the manual's figures does.
    pub(crate) fn show_move(&mut self, next: crate::grid::Block) {
        let Knowledge { name, block, .. } = &*self.knowledge;
        self.context.console(format_args!(
            "{name} says: My position now is: {block} and my next position will be: {next}"
        ));
    }
}
