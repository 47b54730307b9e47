use saoms_api::{Context, Failure, Loop, LoopClass, Publisher, Record, Recordable, Saved, record};

use crate::messages::{ROBOT_LIST, RobotList};
use crate::robot::RobotKnowledge;
use crate::robot::memory::lasting::lasting;

/// Announces that this robot is active.
///
/// It repeats the announcement only with new information: when its battery level changed, and when it starts or ends
/// charging.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.RobotListMS",
    knowledge = RobotKnowledge,
    senses("battery", "inCharge", "asleep", "critical", "chargeBlock")
)]
pub struct SafeRobotList {
    said: Option<RobotList>,
    #[publishes(ROBOT_LIST)]
    robots: Publisher<RobotList>,
}

/// Change of the battery level, in percent, after which a robot repeats its announcement.
const BATTERY_STEP: f64 = 5.0;

/// State of this robot that the others do not know yet.
#[derive(Clone, Copy, Debug)]
pub struct SafeRobotListSymptom {
    battery: f64,
    in_charge: bool,
    critical: bool,
}

/// Decision to announce the robot's state.
#[derive(Clone, Copy, Debug)]
pub struct SayRobot;

impl Recordable for SafeRobotListSymptom {
    fn record(&self) -> Record {
        let battery = self.battery;
        match self.in_charge {
            _ if self.critical => record!(out_of_order: "is out of order, and has asked for help"),
            true => {
                record!(charging_not_announced: "charges with {battery} %, which is not announced yet", battery)
            }
            false => record!(battery_not_announced: "battery is at {battery} %, which is not announced yet", battery),
        }
    }
}

impl Recordable for SayRobot {
    fn record(&self) -> Record {
        record!(announces_state: "announces its state")
    }
}

lasting! {
    SafeRobotList as RobotListMemory { said: Option<RobotList> }
}

impl Loop for SafeRobotList {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = SafeRobotListSymptom;
    type Decision = SayRobot;

    fn initialize(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        if let Some(zones) = &mut knowledge.zones {
            zones.robots = Some(context.publish(&ROBOT_LIST)?);
        }
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<SafeRobotListSymptom>, Failure> {
        let (battery, in_charge) = (knowledge.battery.percent(), knowledge.variables.in_charge);
        let says_again = std::mem::take(&mut knowledge.says_again);
        let news = says_again
            || self.said.as_ref().is_none_or(|said| {
                said.in_charge != in_charge
                    || (said.battery - battery).abs() >= BATTERY_STEP
                    || said.asleep != knowledge.variables.asleep
                    || said.charger != knowledge.charge_block
                    || knowledge.variables.critical
            });
        let critical = knowledge.variables.critical;
        Ok(news.then_some(SafeRobotListSymptom { battery, in_charge, critical }))
    }

    fn plan(
        &mut self,
        _symptom: SafeRobotListSymptom,
        _knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<SayRobot>, Failure> {
        Ok(Some(SayRobot))
    }

    fn execute(
        &mut self,
        _decision: SayRobot,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let robot = knowledge.robot(!knowledge.variables.critical);
        self.said = Some(robot.clone());
        context.send(&self.robots, robot)
    }

    fn shutdown(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        context.send(&self.robots, knowledge.robot(false))
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(self.saved())
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.go_on(saved)
    }
}
