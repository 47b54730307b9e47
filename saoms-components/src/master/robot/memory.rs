//! State of a master of the robots, for the one that takes its place after a failure.

use saoms_api::{Field, Message, SavedLoops};

use super::knowledge::{MasterRobotKnowledge, Shift};
use crate::gone::Gone;
use crate::messages::RobotList;
use crate::validation::SpeakerMemory;

/// What the master knows; the numbers of pieces and periods are properties.
#[derive(Clone, Debug, Message)]
pub(super) struct MasterRobotMemory {
    robots: u32,
    asleep: u32,
    on_shift: u32,
    active: Vec<RobotList>,
    called: Vec<Called>,
    shifts: Vec<Shift>,
    speakers: SpeakerMemory,
    gone: Gone,
    loops: SavedLoops,
}

#[derive(Clone, Copy, Debug, Field)]
struct Called {
    robot: u32,
    awake: bool,
}

impl MasterRobotKnowledge {
    pub(super) fn memory(&self, loops: SavedLoops) -> MasterRobotMemory {
        MasterRobotMemory {
            robots: self.robots,
            asleep: self.asleep,
            on_shift: self.on_shift,
            active: self.active().cloned().collect(),
            called: self.called.iter().map(|(&robot, &awake)| Called { robot, awake }).collect(),
            shifts: self.shifts.clone(),
            speakers: self.validator.memory(),
            gone: self.gone.clone(),
            loops,
        }
    }

    /// Takes over the state of an earlier master, and gives back that of its loops.
    pub(super) fn restore(&mut self, memory: MasterRobotMemory) -> SavedLoops {
        (self.robots, self.asleep, self.on_shift) = (memory.robots, memory.asleep, memory.on_shift);
        self.active.0 = memory.active.into_iter().map(|robot| (robot.robot, robot)).collect();
        self.called = memory.called.iter().map(|called| (called.robot, called.awake)).collect();
        self.shifts = memory.shifts;
        self.validator.restore(memory.speakers);
        self.gone = memory.gone;
        memory.loops
    }
}
