//! The lists of a robot, for the robot that goes on from them.

use saoms_api::Field;

use super::Lists;
use super::helps::HelpsMemory;
use super::requests::RequestsMemory;
use crate::gone::Gone;
use crate::grid::Block;

/// What comes as events. The states and positions of the other robots come again from their topics, so that a robot
/// saves as fast in a large fleet as alone.
#[derive(Clone, Debug, Field)]
pub(in crate::robot) struct ListsMemory {
    requests: RequestsMemory,
    helps: HelpsMemory,
    charging_places: Vec<Block>,
    gone: Gone,
}

impl Lists {
    pub(in crate::robot) fn memory(&self) -> ListsMemory {
        ListsMemory {
            requests: self.requests.memory(),
            helps: self.helps.memory(),
            charging_places: self.charging_places.clone(),
            gone: self.gone.clone(),
        }
    }

    pub(in crate::robot) fn restore(&mut self, memory: ListsMemory) {
        self.requests.restore(memory.requests);
        self.helps.restore(memory.helps);
        self.charging_places = memory.charging_places;
        self.gone = memory.gone;
    }
}
