use saoms_api::{Context, Failure, Header, Loop, LoopClass, Record, Recordable, Subscription, info, record};

use crate::messages::{ROBOT_STATE, RobotState};
use crate::robot::RobotKnowledge;

/// Wakes the robot, or sends it to charge, on request (listing 6.4).
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.classic.RobotMS",
    knowledge = RobotKnowledge,
    senses("healer"),
    effects("inCharge", "asleep", "busy", "readyToGoUnderCharge", "standsInFor", "relieved")
)]
pub struct ClassicRobotState {
    #[subscribes(ROBOT_STATE)]
    states: Subscription<RobotState>,
    /// Commands that arrived for this execution. They are judged once the robot has heard which robots are active.
    arrived: Vec<(Header, RobotState)>,
}

/// Commands to a robot.
#[derive(Clone, Copy, Debug)]
pub enum ClassicRobotSymptom {
    /// Wake up as a substitute for this robot; for 0 as none.
    Awake(u32),
    /// Go to charge.
    Asleep,
}

/// Reaction to a command.
#[derive(Clone, Copy, Debug)]
pub enum ClassicRobotDecision {
    /// Wake up.
    Wake(u32),
    /// Charge after the current job.
    Charge,
}

impl Recordable for ClassicRobotSymptom {
    fn record(&self) -> Record {
        match *self {
            ClassicRobotSymptom::Awake(0) => record!(woken: "is woken"),
            ClassicRobotSymptom::Awake(robot) => {
                record!(woken_as_substitute: "is woken to stand in for robot {robot}", robot)
            }
            ClassicRobotSymptom::Asleep => record!(sent_to_charge: "is sent to charge"),
        }
    }
}

impl Recordable for ClassicRobotDecision {
    fn record(&self) -> Record {
        match self {
            ClassicRobotDecision::Wake(_) => record!(wakes: "wakes up"),
            ClassicRobotDecision::Charge => record!(charges_after_job: "goes to charge after its job"),
        }
    }
}

impl Loop for ClassicRobotState {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = ClassicRobotSymptom;
    type Decision = ClassicRobotDecision;

    fn monitor(&mut self, _knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        let arrived = context.receive(&self.states).with_headers();
        self.arrived.clear();
        self.arrived.extend(arrived.map(|(header, state)| (header, state.clone())));
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<ClassicRobotSymptom>, Failure> {
        let mut newest = None;
        for (header, state) in self.arrived.drain(..) {
            if knowledge.accepts(&state, header, context) && state.robot == knowledge.number {
                newest = Some((state, header.cause));
            }
        }
        let Some((state, cause)) = newest else { return Ok(None) };
        context.because(cause);
        let variables = &knowledge.variables;
        Ok(match state.awake {
            true => variables.in_charge.then_some(ClassicRobotSymptom::Awake(state.emulate)),
            false => {
                (!variables.in_charge && !variables.ready_to_go_under_charge).then_some(ClassicRobotSymptom::Asleep)
            }
        })
    }

    fn plan(
        &mut self,
        symptom: ClassicRobotSymptom,
        _knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<ClassicRobotDecision>, Failure> {
        Ok(Some(match symptom {
            ClassicRobotSymptom::Awake(emulate) => ClassicRobotDecision::Wake(emulate),
            ClassicRobotSymptom::Asleep => ClassicRobotDecision::Charge,
        }))
    }

    fn execute(
        &mut self,
        decision: ClassicRobotDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let variables = &mut knowledge.variables;
        match decision {
            ClassicRobotDecision::Wake(emulate) => {
                // This wakes a healer too, which stays a healer.
                (variables.in_charge, variables.asleep, variables.busy) = (false, false, variables.healer);
                knowledge.stands_in_for = (emulate != 0).then_some(emulate);
                info!(context, "wakes up (battery {} %)", knowledge.battery);
            }
            ClassicRobotDecision::Charge => {
                variables.ready_to_go_under_charge = true;
                // The component that sent it to charge knows that one robot less is there.
                knowledge.relieved = true;
                info!(context, "is sent to charge");
            }
        }
        Ok(())
    }
}
