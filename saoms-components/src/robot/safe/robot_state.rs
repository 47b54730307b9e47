use saoms_api::{Cause, Context, Failure, Header, Loop, LoopClass, Record, Recordable, Subscription, record};

use crate::messages::{ROBOT_STATE, RobotList, RobotState};
use crate::robot::{Help, Request, RobotKnowledge};

/// For so many executions a sleeping robot leaves luggage to whoever could be awaked for it.
const TURN: u32 = 5;

/// Awakes the robot and lets it sleep, as others ask.
///
/// A robot that is sent to sleep finishes its job, goes to its charger and takes no jobs until it is awaked. It goes on to listen and to make
/// way. It awakes by itself where a robot needs help, or luggage waits, and no other robot is awake that can do it.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.RobotMS",
    knowledge = RobotKnowledge,
    senses("busy", "transporter", "critical", "block", "chargeBlock"),
    effects("asleep"),
    subscribes(ROBOT_STATE)
)]
pub struct RobotMS {
    states: Subscription<RobotState>,
    /// What arrived and is not judged yet: before that, the robot has to hear who is there.
    arrived: Vec<(Header, RobotState)>,
    called: Option<(RobotState, Cause)>,
    /// Why it sleeps once it is at its charger.
    sent: Cause,
}

/// Why to be awake, or asleep.
#[derive(Clone, Copy, Debug)]
pub enum RobotSymptom {
    /// Somebody awakes the robot, perhaps in place of another one.
    Awaked {
        /// The robot to stand in for; 0 where it is for none.
        emulate: u32,
    },
    /// Somebody sends the robot to its charger.
    SentToSleep,
    /// A robot needs help, and nobody is awake who can give it.
    NobodyAwake {
        /// The robot.
        critical: u32,
    },
    /// Luggage waits, and nobody is awake who can bring it.
    NobodyForLuggage {
        /// The luggage.
        luggage: u32,
    },
    /// The robot was sent to sleep, and is at its charger.
    AtRest,
}

/// What to do about it.
#[derive(Clone, Copy, Debug)]
pub enum RobotDecision {
    /// Be awake, perhaps in place of another robot.
    Awake {
        /// The robot to stand in for; 0 where it is for none.
        emulate: u32,
    },
    /// Stay awake.
    StayAwake,
    /// Finish the job, then sleep.
    Finish,
    /// Sleep.
    Sleep,
}

impl Recordable for RobotSymptom {
    fn record(&self) -> Record {
        match *self {
            RobotSymptom::Awaked { emulate: 0 } => record!("is awaked"),
            RobotSymptom::Awaked { emulate } => record!("is awaked in place of robot {emulate}", emulate),
            RobotSymptom::SentToSleep => record!("is sent to sleep"),
            RobotSymptom::NobodyAwake { critical } => {
                record!("robot {critical} needs help, and no robot that is awake can give it", critical)
            }
            RobotSymptom::NobodyForLuggage { luggage } => {
                record!("luggage {luggage} waits, and no robot that is awake can bring it", luggage)
            }
            RobotSymptom::AtRest => record!("is at its charger and was sent to sleep"),
        }
    }
}

impl Recordable for RobotDecision {
    fn record(&self) -> Record {
        match *self {
            RobotDecision::Awake { emulate: 0 } => record!("awakes"),
            RobotDecision::Awake { emulate } => record!("awakes and stands in for robot {emulate}", emulate),
            RobotDecision::StayAwake => record!("is awake already"),
            RobotDecision::Finish => record!("finishes its job, then sleeps"),
            RobotDecision::Sleep => record!("sleeps"),
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
        self.arrived.extend(arrived.map(|(header, state)| (header, state.clone())));
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<RobotSymptom>, Failure> {
        for (header, state) in self.arrived.drain(..) {
            if knowledge.lets_in(&state, header, context) && state.robot == knowledge.number {
                self.called = Some((state, header.cause));
            }
        }
        if knowledge.variables.critical {
            return Ok(None);
        }
        if let Some((state, cause)) = self.called.take() {
            context.because(cause);
            let symptom = RobotSymptom::Awaked { emulate: state.emulate };
            return Ok(Some(if state.awake { symptom } else { RobotSymptom::SentToSleep }));
        }
        if knowledge.variables.asleep {
            if let Some((critical, cause)) = knowledge.has_to_help() {
                context.because(cause);
                return Ok(Some(RobotSymptom::NobodyAwake { critical }));
            }
            return Ok(knowledge.has_to_bring(context).map(|(luggage, cause)| {
                context.because(cause);
                RobotSymptom::NobodyForLuggage { luggage }
            }));
        }
        let rests = knowledge.relieved && knowledge.is_free() && knowledge.is_at_charger();
        context.because(self.sent);
        Ok(rests.then_some(RobotSymptom::AtRest))
    }

    fn plan(
        &mut self,
        symptom: RobotSymptom,
        knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<RobotDecision>, Failure> {
        let asleep = knowledge.variables.asleep;
        Ok(match symptom {
            RobotSymptom::Awaked { emulate } if asleep || knowledge.relieved => {
                Some(RobotDecision::Awake { emulate })
            }
            RobotSymptom::Awaked { .. } => Some(RobotDecision::StayAwake),
            RobotSymptom::NobodyAwake { critical } => Some(RobotDecision::Awake { emulate: critical }),
            RobotSymptom::NobodyForLuggage { .. } => Some(RobotDecision::Awake { emulate: 0 }),
            RobotSymptom::SentToSleep => (!asleep).then_some(RobotDecision::Finish),
            RobotSymptom::AtRest => Some(RobotDecision::Sleep),
        })
    }

    fn execute(
        &mut self,
        decision: RobotDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        match decision {
            RobotDecision::Awake { emulate } => {
                (knowledge.variables.asleep, knowledge.relieved) = (false, false);
                self.sent = Cause::default();
                knowledge.stands_in_for = Some(emulate).filter(|emulate| *emulate > 0);
                context.info(format_args!("awakes"));
            }
            RobotDecision::StayAwake => {}
            RobotDecision::Finish => {
                (knowledge.relieved, self.sent) = (true, context.cause());
            }
            RobotDecision::Sleep => {
                (knowledge.variables.asleep, knowledge.relieved) = (true, false);
                context.info(format_args!("sleeps"));
            }
        }
        Ok(())
    }
}

impl RobotKnowledge {
    /// Whether the robot has no job and would take none.
    pub(super) fn is_free(&self) -> bool {
        !self.variables.busy && !self.variables.transporter && !self.offers_help
    }

    /// The robot that needs help, if this one is the first to awake where nobody who is awake can help it.
    fn has_to_help(&self) -> Option<(u32, Cause)> {
        let mut requests = self.lists.helps.open().iter().filter(|request| self.is_to_be_helped(request));
        let mine = |request: &&Help| {
            let luggage = request.situation.job().map(|job| job.luggage);
            let first = self.sleepers_for(luggage).all(|other| self.number < other.robot);
            first && !self.is_awake_for(luggage)
        };
        let request = requests.find(mine)?;
        Some((request.situation.critical, request.cause))
    }

    /// The luggage that nobody who is awake can bring and that is in reach, if it is this robot's turn: sleepers of lower numbers are asked first.
    fn has_to_bring(&self, context: &Context<'_>) -> Option<(u32, Cause)> {
        let waits = |request: &&Request| {
            let luggage = Some(request.job.luggage);
            if !request.judged || self.is_awake_for(luggage) {
                return false;
            }
            let ahead = self.sleepers_for(luggage).filter(|other| other.robot < self.number).count();
            let turn = u32::try_from(ahead + 1).unwrap_or(u32::MAX).saturating_mul(TURN);
            context.now().since(request.since) >= context.period().saturating_mul(turn)
        };
        let request = self.lists.requests.open().iter().find(waits)?;
        Some((request.job.luggage, request.cause))
    }

    /// Whether another robot is awake that did not refuse the luggage.
    fn is_awake_for(&self, luggage: Option<u32>) -> bool {
        self.lists.active.iter().any(|robot| !robot.asleep && !self.refused(luggage, robot.robot))
    }

    /// The other robots that sleep and did not refuse the luggage.
    fn sleepers_for(&self, luggage: Option<u32>) -> impl Iterator<Item = &RobotList> {
        self.lists.sleepers().filter(move |robot| !self.refused(luggage, robot.robot))
    }

    fn refused(&self, luggage: Option<u32>, robot: u32) -> bool {
        luggage.is_some_and(|luggage| self.lists.requests.is_refused_by(luggage, robot))
    }
}
