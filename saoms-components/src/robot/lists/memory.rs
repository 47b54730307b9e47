//! The lists of a robot, for the robot that goes on from them.

use saoms_api::Field;

use super::Lists;
use super::helps::HelpsMemory;
use super::peers::PeersMemory;
use super::requests::RequestsMemory;
use crate::grid::Block;
use crate::messages::RobotList;

#[derive(Clone, Debug, Field)]
pub(in crate::robot) struct ListsMemory {
    active: Vec<RobotList>,
    requests: RequestsMemory,
    helps: HelpsMemory,
    peers: PeersMemory,
    chargers: Vec<ChargerOf>,
    charging_places: Vec<Block>,
    lost: Vec<u32>,
}

#[derive(Clone, Copy, Debug, Field)]
struct ChargerOf {
    robot: u32,
    block: Block,
}

impl Lists {
    pub(in crate::robot) fn memory(&self) -> ListsMemory {
        let chargers = self.chargers.iter().map(|&(robot, block)| ChargerOf { robot, block });
        ListsMemory {
            active: self.active.clone(),
            requests: self.requests.memory(),
            helps: self.helps.memory(),
            peers: self.peers.memory(),
            chargers: chargers.collect(),
            charging_places: self.charging_places.clone(),
            lost: self.lost.clone(),
        }
    }

    pub(in crate::robot) fn restore(&mut self, memory: ListsMemory) {
        self.active = memory.active;
        self.requests.restore(memory.requests);
        self.helps.restore(memory.helps);
        self.peers.restore(memory.peers);
        self.chargers = memory.chargers.iter().map(|charger| (charger.robot, charger.block)).collect();
        self.charging_places = memory.charging_places;
        self.lost = memory.lost;
    }
}
