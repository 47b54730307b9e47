//! In place of the loops of `saoms.MasterRobot`.

use saoms_api::{
    Context, Effector, Entry, Failure, Knowledge, Loop, LoopClass, Properties, Publisher, Record, Subscription, record,
};
use saoms_components::messages::{EXCEPTIONAL_EVENT, ExceptionalEvent, ROBOT_STATE, RobotList, RobotState};

use crate::step::{Decision, Step};

/// What a composite can set.
#[derive(Debug, Properties)]
pub struct AllHandsProperties {
    /// Number of executions after the last event for which all robots stay awake.
    #[property(default = 50, range = 1.., unit = "executions")]
    lasting: u32,
}

/// In place of `AwakeAsleepMS`: wakes all robots at once, however many pieces are expected, and sends all to charge
/// when nothing happened for long.
#[derive(Debug, LoopClass)]
#[looping(name = "own.AllHands", senses("robots", "asleep", "counter", "piecesPerRobot"))]
pub struct AllHands {
    #[properties]
    properties: AllHandsProperties,
    left: u32,
    #[subscribes(EXCEPTIONAL_EVENT)]
    events: Subscription<ExceptionalEvent>,
    #[publishes(ROBOT_STATE)]
    states: Publisher<RobotState>,
    #[senses]
    active: Entry<Vec<RobotList>>,
    #[effects]
    on_shift: Effector<u32>,
}

impl Loop for AllHands {
    type Properties = AllHandsProperties;
    type Knowledge = dyn Knowledge;
    type Symptom = Step<bool>;
    type Decision = Decision<bool>;

    fn analyze(&mut self, _: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<Option<Step<bool>>, Failure> {
        let heard = context.receive(&self.events).with_headers().last();
        if let Some((header, event)) = heard {
            self.left = self.properties.lasting;
            context.because(header.cause);
            let why = record!(pieces_expected: "expects {pieces} {pieces:piece|pieces}", pieces = event.pieces);
            return Ok(Some(Step::new(why, record!(wakes_all: "wakes all robots"), true)));
        }
        let ends = self.left == 1;
        self.left = self.left.saturating_sub(1);
        let why = record!(nothing_happened: "nothing happened for a while");
        Ok(ends.then(|| Step::new(why, record!(sends_all: "sends all robots to charge"), false)))
    }

    fn plan(
        &mut self,
        step: Step<bool>,
        _: &mut dyn Knowledge,
        _: &mut Context<'_>,
    ) -> Result<Option<Decision<bool>>, Failure> {
        Ok(Some(step.decide()))
    }

    fn execute(
        &mut self,
        decision: Decision<bool>,
        master: &mut dyn Knowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let awake = decision.act;
        let mut called = 0;
        for robot in self.active.get(master)?.iter().filter(|robot| robot.asleep == awake) {
            called += 1;
            context.effect(record!(calls_robot: "calls robot {robot}", robot = robot.robot));
            context.send(&self.states, RobotState { robot: robot.robot, awake, emulate: 0 })?;
        }
        self.on_shift.set(master, if awake { called } else { 0 })
    }
}

/// In place of `RobotListMS`: tells the mean battery level of the robots.
#[derive(Debug, Default, LoopClass)]
#[looping(name = "own.MeanBattery", senses("robots", "asleep"))]
pub struct MeanBattery {
    said: Option<f64>,
    #[senses]
    active: Entry<Vec<RobotList>>,
}

impl Loop for MeanBattery {
    type Properties = ();
    type Knowledge = dyn Knowledge;
    type Symptom = Record;
    type Decision = Record;

    fn analyze(&mut self, master: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        let active = self.active.get(master)?;
        let count = u32::try_from(active.len()).unwrap_or(u32::MAX);
        let mean = active.iter().map(|robot| robot.battery).sum::<f64>() / f64::from(count.max(1));
        if count == 0 || self.said == Some(mean) {
            return Ok(None);
        }
        self.said = Some(mean);
        context.report("robots.mean_battery", mean);
        Ok(Some(record!(mean_battery: "{count} {count:robot has|robots have} {mean} % on average", count, mean)))
    }

    fn plan(&mut self, _: Record, _: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        Ok(None)
    }

    fn execute(&mut self, _: Record, _: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        Ok(())
    }
}
