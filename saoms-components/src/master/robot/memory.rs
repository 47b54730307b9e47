//! State of a master of the robots, for the one that takes its place after a failure.

use saoms_api::{Field, Message, SavedLoops};

use super::knowledge::{MasterRobotKnowledge, Shift};
use super::work::{Work, WorkMemory};
use crate::gone::Gone;
use crate::messages::RobotList;
use crate::validation::SpeakerMemory;

/// What the master knows; the numbers of pieces and periods are properties.
#[derive(Clone, Debug, Message)]
pub(super) struct MasterRobotMemory {
    on_shift: u32,
    active: Vec<RobotList>,
    called: Vec<Called>,
    shifts: Vec<Shift>,
    speakers: SpeakerMemory,
    gone: Gone,
    due: u32,
    work: WorkMemory,
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
            on_shift: self.on_shift,
            active: self.active().cloned().collect(),
            called: self.called.iter().map(|(&robot, &awake)| Called { robot, awake }).collect(),
            shifts: self.shifts.clone(),
            speakers: self.validator.memory(),
            gone: self.gone.clone(),
            due: self.due,
            work: self.work.memory(),
            loops,
        }
    }

    /// Takes over the state of an earlier master, and gives back that of its loops.
    pub(super) fn restore(&mut self, memory: MasterRobotMemory) -> SavedLoops {
        memory.active.iter().for_each(|robot| self.hear(robot));
        self.on_shift = memory.on_shift;
        (self.due, self.work) = (memory.due, Work::of(memory.work));
        self.called = memory.called.iter().map(|called| (called.robot, called.awake)).collect();
        self.shifts = memory.shifts;
        self.validator.restore(memory.speakers);
        self.gone = memory.gone;
        memory.loops
    }
}
