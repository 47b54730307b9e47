use crate::messages::RobotList;
use crate::robot::RobotKnowledge;

use super::CriticalSymptom;

/// A robot that was awaked and does not say so within so many executions is given up.
const PATIENCE: u32 = 8;

/// The search for a robot that stands in for another one.
#[derive(Debug)]
pub(super) struct Substitution {
    /// The robot that is missing.
    robot: u32,
    /// Whom this robot awaked, and for how many executions it waits for an answer.
    asked: Option<(u32, u32)>,
    /// Who did not answer.
    silent: Vec<u32>,
    /// Who stands in.
    by: Option<u32>,
}

impl Substitution {
    pub(super) fn of(robot: u32) -> Substitution {
        Substitution { robot, asked: None, silent: Vec::new(), by: None }
    }

    /// Takes in that a robot stands in for another one.
    pub(super) fn hear(&mut self, critical: u32, healer: u32) {
        if critical == self.robot && self.asked.is_some_and(|(asked, _)| asked == healer) {
            self.by = Some(healer);
        }
    }

    pub(super) fn ask(&mut self, sleeper: u32) {
        self.asked = Some((sleeper, 0));
    }

    /// What comes next; `None` while an answer is waited for. The search is over when nothing is waited for then.
    pub(super) fn look(&mut self, knowledge: &RobotKnowledge) -> Option<CriticalSymptom> {
        let robot = self.robot;
        if let Some(by) = self.by {
            return Some(CriticalSymptom::Substituted { robot, by });
        }
        if let Some((sleeper, waited)) = &mut self.asked {
            *waited += 1;
            if *waited <= PATIENCE.saturating_mul(knowledge.tempo()) {
                return None;
            }
            self.silent.push(*sleeper);
            self.asked = None;
        }
        let RobotList { robot: sleeper, battery, .. } = knowledge.best_sleeper(&self.silent)?;
        Some(CriticalSymptom::Missing { robot, sleeper: *sleeper, battery: *battery })
    }

    pub(super) fn is_waiting(&self) -> bool {
        self.asked.is_some()
    }
}

impl RobotKnowledge {
    /// The robot to awake: the one that sleeps with the most in its battery, of equal ones that with the lowest number.
    pub(super) fn best_sleeper(&self, without: &[u32]) -> Option<&RobotList> {
        let sleepers = self.lists.sleepers().filter(|sleeper| !without.contains(&sleeper.robot));
        sleepers.reduce(|best, other| if other.battery > best.battery { other } else { best })
    }
}
