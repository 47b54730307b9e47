use saoms_api::{Context, Failure, Header, Loop, LoopClass, Record, Recordable, Subscription, record};

use crate::messages::{ROBOT_STATE, RobotState};
use crate::robot::RobotKnowledge;

/// Obeys whoever awakes the robot or sends it under charge (listing 6.4).
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.classic.RobotMS",
    knowledge = RobotKnowledge,
    senses("healer"),
    effects("inCharge", "asleep", "busy", "readyToGoUnderCharge"),
    subscribes(ROBOT_STATE)
)]
pub struct RobotMS {
    states: Subscription<RobotState>,
    /// What arrived for this execution: before it is judged, the robot has to hear who is there.
    arrived: Vec<(Header, RobotState)>,
}

/// What the robot has to do.
#[derive(Clone, Copy, Debug)]
pub enum RobotSymptom {
    /// Be awake, and stand in for a robot; for 0 there is none.
    Awake(u32),
    /// Go under charge.
    Asleep,
}

/// What it does.
#[derive(Clone, Copy, Debug)]
pub enum RobotDecision {
    /// Is awake.
    Wake(u32),
    /// Goes under charge after its present job.
    Charge,
}

impl Recordable for RobotSymptom {
    fn record(&self) -> Record {
        match *self {
            RobotSymptom::Awake(0) => record!("is called to be awake"),
            RobotSymptom::Awake(robot) => record!("is called to stand in for robot {robot}", robot),
            RobotSymptom::Asleep => record!("is called to go under charge"),
        }
    }
}

impl Recordable for RobotDecision {
    fn record(&self) -> Record {
        match self {
            RobotDecision::Wake(_) => record!("is awake"),
            RobotDecision::Charge => record!("goes under charge after its job"),
        }
    }
}

impl Loop for RobotMS {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = RobotSymptom;
    type Decision = RobotDecision;

    fn new((): ()) -> Result<Self, Failure> {
        Ok(RobotMS::default())
    }

    fn initialize(
        &mut self,
        _knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        self.states = context.subscribe(&ROBOT_STATE)?;
        Ok(())
    }

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
    ) -> Result<Option<RobotSymptom>, Failure> {
        let mut newest = None;
        for (header, state) in self.arrived.drain(..) {
            if knowledge.lets_in(&state, header, context) && state.robot == knowledge.number {
                newest = Some((state, header.cause));
            }
        }
        let Some((state, cause)) = newest else { return Ok(None) };
        context.because(cause);
        let variables = &knowledge.variables;
        Ok(match state.awake {
            true => variables.in_charge.then_some(RobotSymptom::Awake(state.emulate)),
            false => {
                (!variables.in_charge && !variables.ready_to_go_under_charge).then_some(RobotSymptom::Asleep)
            }
        })
    }

    fn plan(
        &mut self,
        symptom: RobotSymptom,
        _knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<RobotDecision>, Failure> {
        Ok(Some(match symptom {
            RobotSymptom::Awake(emulate) => RobotDecision::Wake(emulate),
            RobotSymptom::Asleep => RobotDecision::Charge,
        }))
    }

    fn execute(
        &mut self,
        decision: RobotDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let variables = &mut knowledge.variables;
        match decision {
            RobotDecision::Wake(emulate) => {
                // A healer is awake by this, and stays a healer.
                (variables.in_charge, variables.asleep, variables.busy) = (false, false, variables.healer);
                knowledge.stands_in_for = (emulate != 0).then_some(emulate);
                context.info(format_args!("is awaked (battery {} %)", knowledge.battery));
            }
            RobotDecision::Charge => {
                variables.ready_to_go_under_charge = true;
                // Who sent it away knows that one robot is less there.
                knowledge.relieved = true;
                context.info(format_args!("is sent under charge"));
            }
        }
        Ok(())
    }
}
