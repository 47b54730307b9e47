use saoms_api::Field;

use crate::messages::RobotList;
use crate::robot::RobotKnowledge;

use super::SafeCriticalSymptom;

/// Number of executions within which a woken robot has to answer.
const PATIENCE: u32 = 8;

/// Search for a substitute of a robot.
#[derive(Debug, Clone, Field)]
pub(super) struct Substitution {
    /// Number of the missing robot.
    robot: u32,
    /// The robot that was woken.
    asked: Option<Asked>,
    /// Numbers of robots that did not answer.
    silent: Vec<u32>,
    /// Number of the substitute.
    by: Option<u32>,
}

/// A robot that was woken, and number of executions that it has had for its answer.
#[derive(Clone, Copy, Debug, Field)]
struct Asked {
    sleeper: u32,
    waited: u32,
}

impl Substitution {
    pub(super) fn of(robot: u32) -> Substitution {
        Substitution { robot, asked: None, silent: Vec::new(), by: None }
    }

    /// Handles the report that a robot substitutes another one.
    pub(super) fn hear(&mut self, critical: u32, healer: u32) {
        if critical == self.robot && self.asked.is_some_and(|asked| asked.sleeper == healer) {
            self.by = Some(healer);
        }
    }

    pub(super) fn ask(&mut self, sleeper: u32) {
        self.asked = Some(Asked { sleeper, waited: 0 });
    }

    /// The next step of the search; `None` while it waits for an answer or is over.
    pub(super) fn look(&mut self, knowledge: &RobotKnowledge) -> Option<SafeCriticalSymptom> {
        let robot = self.robot;
        if let Some(by) = self.by {
            return Some(SafeCriticalSymptom::Substituted { robot, by });
        }
        if let Some(Asked { sleeper, waited }) = &mut self.asked {
            *waited += 1;
            if *waited <= PATIENCE.saturating_mul(knowledge.tempo()) {
                return None;
            }
            self.silent.push(*sleeper);
            self.asked = None;
        }
        // One with less charge would be relieved by this robot in turn, and so on.
        let is_better = |one: &&RobotList| robot != knowledge.number || one.battery > knowledge.battery.percent();
        let RobotList { robot: sleeper, battery, .. } = knowledge.best_sleeper(&self.silent).filter(is_better)?;
        Some(SafeCriticalSymptom::Missing { robot, sleeper: *sleeper, battery: *battery })
    }

    pub(super) fn is_waiting(&self) -> bool {
        self.asked.is_some()
    }
}

impl RobotKnowledge {
    /// The robot to wake: the sleeping robot with the highest battery level, of equal ones the one with the lowest
    /// number.
    pub(super) fn best_sleeper(&self, without: &[u32]) -> Option<&RobotList> {
        let sleepers = self.lists.sleepers().filter(|sleeper| !without.contains(&sleeper.robot));
        sleepers.reduce(|best, other| if other.battery > best.battery { other } else { best })
    }
}
