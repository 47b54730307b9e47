use saoms_api::{
    Cause, Context, Failure, Field, Header, Loop, LoopClass, Record, Recordable, Saved, Subscription, info, record,
};

use crate::messages::{ROBOT_STATE, RobotState};
use crate::robot::RobotKnowledge;
use crate::robot::memory::lasting::lasting;

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
    /// From when it is to leave the fleet until it has gone back to work, whether it charged, or was to charge, before.
    was_away: Option<bool>,
    /// The newest command since then.
    called: Option<Called>,
}

/// A command to this robot, and its cause.
#[derive(Clone, Debug, Field)]
struct Called {
    state: RobotState,
    cause: Cause,
}

lasting! { ClassicRobotState as RobotStateMemory { was_away: Option<bool>, called: Option<Called> } }

/// Commands to a robot.
#[derive(Clone, Copy, Debug)]
pub enum ClassicRobotSymptom {
    /// Wake up as a substitute for this robot; for 0 as none.
    Awake(u32),
    /// Go to charge.
    Asleep,
    /// Leave the fleet.
    Leaves,
    /// Stay in the fleet after all.
    Stays,
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
            ClassicRobotSymptom::Leaves => record!(leaves_fleet: "is to leave the fleet"),
            ClassicRobotSymptom::Stays => record!(stays_in_fleet: "does not leave the fleet"),
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
                newest = Some(Called { state, cause: header.cause });
            }
        }
        let variables = &knowledge.variables;
        let is_on_leave = variables.in_charge || variables.ready_to_go_under_charge;
        if knowledge.leaving {
            self.called = newest.or(self.called.take());
            self.was_away.get_or_insert(is_on_leave);
            return Ok((!is_on_leave).then_some(ClassicRobotSymptom::Leaves));
        }
        let newest = newest.or(self.called.take());
        if let Some(was_away) = self.was_away {
            let wakes = newest.as_ref().map_or(!was_away, |called| called.state.awake);
            if wakes && is_on_leave && !variables.in_charge {
                // It wakes where it charges.
                self.called = newest;
                return Ok(None);
            }
            self.was_away = None;
            if wakes && is_on_leave && newest.is_none() {
                return Ok(Some(ClassicRobotSymptom::Stays));
            }
        }
        let Some(Called { state, cause }) = newest else { return Ok(None) };
        context.because(cause);
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
            ClassicRobotSymptom::Stays => ClassicRobotDecision::Wake(0),
            ClassicRobotSymptom::Asleep | ClassicRobotSymptom::Leaves => ClassicRobotDecision::Charge,
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

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(self.saved())
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.go_on(saved)
    }
}
