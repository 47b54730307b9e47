//! Messages from which nothing comes any more.

use super::state::{Message, State};
use crate::zone::ledger::Heard;

impl State {
    /// Drops messages that nobody reads any more, of zones that are none any more, and about terms that nobody waits
    /// for. All others stay, also those that were heard: it is explored that they do no harm when they come again.
    pub(super) fn drop_answered(&mut self) {
        let mut network = std::mem::take(&mut self.network);
        network.retain(|message| !self.is_over(message));
        self.network = network;
    }

    fn is_over(&self, message: &Message) -> bool {
        // Where borders do not change, what is of an earlier term stays, too.
        let is_former = |zone: u32, term: u64| {
            let now = self.place(zone).map(|place| self.zones[place].ledger.territory().term);
            self.drawings > 0 && now.is_none_or(|now| now > term)
        };
        let waits =
            |zone: u32, robot: u32| self.place(zone).is_some_and(|place| self.zones[place].unheard.contains(&robot));
        let is_unread = |robot: u32| self.robots[robot as usize - 1].is_gone && self.faults.back == 0;
        let territories = |robot: u32| self.robots[robot as usize - 1].passage.territories();
        let known = |robot: u32, zone: u32| territories(robot).known().iter().find(move |known| known.zone == zone);
        let has_lasted = self.faults.zones == 0;
        match message {
            Message::Request(request) => {
                if is_former(request.zone, request.term) {
                    return true;
                }
                // What changes nothing now does not later on, since the robot says nothing new.
                let ledger = &self.zones[self.place(request.zone).unwrap()].ledger;
                let is_ended = ledger.has_ended(request.robot, request.incarnation);
                is_ended && ledger.clone().hear(request) == Heard::Nothing
            }
            Message::Grant(grant) => {
                let is_newer = || known(grant.robot, grant.zone).is_none_or(|known| known.term > grant.term);
                is_unread(grant.robot) || self.drawings > 0 && is_newer()
            }
            Message::Gone(zone, ..) => self.place(*zone).is_none(),
            Message::Territory(robot, territory) => {
                let (zone, term) = (territory.zone, territory.term);
                let is_known = known(*robot, zone).is_some_and(|known| known.term >= term);
                let is_former = is_former(zone, term) && !territories(*robot).clone().hear(territory);
                is_unread(*robot) || is_former || is_known && has_lasted && !waits(zone, *robot)
            }
            Message::Clear(robot, incarnation, clear, _) => {
                if is_former(clear.zone, clear.term) {
                    return true;
                }
                let ledger = &self.zones[self.place(clear.zone).unwrap()].ledger;
                let member = ledger.member(*robot);
                let is_known = member.is_none_or(|member| member.request.incarnation >= *incarnation);
                let is_known = is_known || clear.term < ledger.territory().term;
                is_known && has_lasted && !waits(clear.zone, *robot)
            }
        }
    }
}
