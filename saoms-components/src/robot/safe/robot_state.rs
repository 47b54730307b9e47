use saoms_api::{
    Cause, Context, Failure, Field, Header, Loop, LoopClass, Record, Recordable, Saved, Subscription, Time, info,
    record,
};

use crate::messages::{ROBOT_STATE, RobotList, RobotState};
use crate::robot::memory::lasting::lasting;
use crate::robot::{Help, Request, RobotKnowledge};

/// Number of executions for which a sleeping robot leaves luggage to each robot that is asked before it.
const TURN: u32 = 5;

/// Wakes the robot and sends it to sleep, on request.
///
/// A robot that is sent to sleep finishes its job, goes to its charger and takes no jobs until it is woken. It still
/// listens and makes way. It wakes by itself if a robot needs help, or luggage waits, and no robot that is awake can do
/// it.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.RobotMS",
    knowledge = RobotKnowledge,
    senses(
        "busy", "transporter", "critical", "block", "chargeBlock", "offersHelp", "relieved", "robots", "requests",
        "helpRequests"
    ),
    effects("asleep", "relieved", "standsInFor")
)]
pub struct SafeRobotState {
    #[subscribes(ROBOT_STATE)]
    states: Subscription<RobotState>,
    /// Commands that arrived and are not judged yet. They are judged once the robot has heard which robots are active.
    arrived: Vec<Arrived>,
    called: Option<Called>,
    /// Cause of sleeping once it is at its charger.
    sent: Cause,
    /// While it is to leave the fleet, whether it slept, or was to sleep, before.
    slept: Option<bool>,
}

/// A command and its header.
#[derive(Clone, Debug, Field)]
struct Arrived {
    sender: u32,
    sent: Time,
    cause: Cause,
    state: RobotState,
}

/// A command to this robot, and its cause.
#[derive(Clone, Debug, Field)]
struct Called {
    state: RobotState,
    cause: Cause,
}

/// Reasons to be awake, or asleep.
#[derive(Clone, Copy, Debug)]
pub enum SafeRobotSymptom {
    /// A command to wake, perhaps as a substitute.
    Woken {
        /// Number of the robot to substitute; 0 for none.
        emulate: u32,
    },
    /// A command to go to the charger and sleep.
    SentToSleep,
    /// A robot needs help, and no robot that is awake can give it.
    NobodyAwake {
        /// Number of that robot.
        critical: u32,
    },
    /// Luggage waits, and no robot that is awake can bring it.
    NobodyForLuggage {
        /// Number of the luggage.
        luggage: u32,
    },
    /// A master assigned luggage to this robot.
    Assigned {
        /// Number of the luggage.
        luggage: u32,
    },
    /// The robot was sent to sleep, and is at its charger.
    AtRest,
    /// The robot is to leave the fleet.
    Leaves,
    /// The robot was to leave the fleet, and stays.
    Stays,
}

/// Reaction to the reason.
#[derive(Clone, Copy, Debug)]
pub enum SafeRobotDecision {
    /// Wake up, perhaps as a substitute.
    Awake {
        /// Number of the robot to substitute; 0 for none.
        emulate: u32,
    },
    /// Stay awake.
    StayAwake,
    /// Finish the job, then sleep.
    Finish,
    /// Sleep.
    Sleep,
}

impl Recordable for SafeRobotSymptom {
    fn record(&self) -> Record {
        match *self {
            SafeRobotSymptom::Woken { emulate: 0 } => record!(woken: "is woken"),
            SafeRobotSymptom::Woken { emulate } => {
                record!(woken_as_substitute: "is woken to stand in for robot {robot}", robot = emulate)
            }
            SafeRobotSymptom::SentToSleep => record!(sent_to_sleep: "is sent to sleep"),
            SafeRobotSymptom::NobodyAwake { critical } => {
                record!(
                    no_awake_robot_can_help: "robot {robot} needs help, and no robot that is awake can help",
                    robot = critical
                )
            }
            SafeRobotSymptom::NobodyForLuggage { luggage } => {
                record!(
                    no_awake_robot_can_carry: "luggage {luggage} waits, and no robot that is awake can carry it",
                    luggage
                )
            }
            SafeRobotSymptom::Assigned { luggage } => {
                record!(assigned_while_asleep: "is to carry luggage {luggage}, and sleeps", luggage)
            }
            SafeRobotSymptom::Leaves => record!(leaves_fleet: "is to leave the fleet"),
            SafeRobotSymptom::Stays => record!(stays_in_fleet: "does not leave the fleet"),
            SafeRobotSymptom::AtRest => record!(at_charger_to_sleep: "is at its charger, and was sent to sleep"),
        }
    }
}

impl Recordable for SafeRobotDecision {
    fn record(&self) -> Record {
        match *self {
            SafeRobotDecision::Awake { emulate: 0 } => record!(wakes: "wakes up"),
            SafeRobotDecision::Awake { emulate } => {
                record!(wakes_as_substitute: "wakes up to stand in for robot {robot}", robot = emulate)
            }
            SafeRobotDecision::StayAwake => record!(already_awake: "is already awake"),
            SafeRobotDecision::Finish => record!(sleeps_after_job: "finishes its job, then sleeps"),
            SafeRobotDecision::Sleep => record!(sleeps: "sleeps"),
        }
    }
}

lasting! {
    SafeRobotState as RobotStateMemory {
        arrived: Vec<Arrived>,
        called: Option<Called>,
        sent: Cause,
        slept: Option<bool>,
    }
}

impl Loop for SafeRobotState {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = SafeRobotSymptom;
    type Decision = SafeRobotDecision;

    fn monitor(&mut self, _knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        let arrived = context.receive(&self.states).with_headers();
        self.arrived.extend(arrived.map(|(Header { sender, sent, cause }, state)| Arrived {
            sender,
            sent,
            cause,
            state: state.clone(),
        }));
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<SafeRobotSymptom>, Failure> {
        for Arrived { sender, sent, cause, state } in self.arrived.drain(..) {
            let header = Header { sender, sent, cause };
            if knowledge.accepts(&state, header, context) && state.robot == knowledge.number {
                self.called = Some(Called { state, cause });
            }
        }
        if knowledge.variables.critical {
            return Ok(None);
        }
        let is_on_leave = knowledge.variables.asleep || knowledge.relieved;
        if knowledge.leaving {
            // The newest command waits: it holds if the robot stays.
            self.slept.get_or_insert(is_on_leave);
            if !is_on_leave {
                return Ok(Some(SafeRobotSymptom::Leaves));
            }
            return Ok(self.rests(knowledge, context));
        }
        if self.slept.take() == Some(false) && is_on_leave && self.called.is_none() {
            return Ok(Some(SafeRobotSymptom::Stays));
        }
        if let Some(Called { state, cause }) = self.called.take() {
            context.because(cause);
            let symptom = SafeRobotSymptom::Woken { emulate: state.emulate };
            return Ok(Some(if state.awake { symptom } else { SafeRobotSymptom::SentToSleep }));
        }
        if knowledge.variables.asleep {
            if let Some((critical, cause)) = knowledge.has_to_help() {
                context.because(cause);
                return Ok(Some(SafeRobotSymptom::NobodyAwake { critical }));
            }
            if let Some(assigned) = knowledge.lists.requests.assigned().filter(|assigned| !assigned.withdrawn) {
                context.because(assigned.cause);
                return Ok(Some(SafeRobotSymptom::Assigned { luggage: assigned.job.luggage }));
            }
            return Ok(knowledge.has_to_bring(context).map(|(luggage, cause)| {
                context.because(cause);
                SafeRobotSymptom::NobodyForLuggage { luggage }
            }));
        }
        Ok(self.rests(knowledge, context))
    }

    fn plan(
        &mut self,
        symptom: SafeRobotSymptom,
        knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<SafeRobotDecision>, Failure> {
        let asleep = knowledge.variables.asleep;
        Ok(match symptom {
            SafeRobotSymptom::Woken { emulate } if asleep || knowledge.relieved => {
                Some(SafeRobotDecision::Awake { emulate })
            }
            SafeRobotSymptom::Woken { .. } => Some(SafeRobotDecision::StayAwake),
            SafeRobotSymptom::NobodyAwake { critical } => Some(SafeRobotDecision::Awake { emulate: critical }),
            SafeRobotSymptom::NobodyForLuggage { .. } | SafeRobotSymptom::Assigned { .. } => {
                Some(SafeRobotDecision::Awake { emulate: 0 })
            }
            SafeRobotSymptom::Stays => Some(SafeRobotDecision::Awake { emulate: 0 }),
            SafeRobotSymptom::Leaves => Some(SafeRobotDecision::Finish),
            SafeRobotSymptom::SentToSleep => (!asleep).then_some(SafeRobotDecision::Finish),
            SafeRobotSymptom::AtRest => Some(SafeRobotDecision::Sleep),
        })
    }

    fn execute(
        &mut self,
        decision: SafeRobotDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        match decision {
            SafeRobotDecision::Awake { emulate } => {
                (knowledge.variables.asleep, knowledge.relieved) = (false, false);
                self.sent = Cause::default();
                knowledge.stands_in_for = Some(emulate).filter(|emulate| *emulate > 0);
                info!(context, "wakes up");
                let (name, heals) = (&knowledge.name, emulate > 0);
                context.console(format_args!("{name} {}now is awake", if heals { "is a healer and " } else { "" }));
            }
            SafeRobotDecision::StayAwake => {}
            SafeRobotDecision::Finish => {
                (knowledge.relieved, self.sent) = (true, context.cause());
            }
            SafeRobotDecision::Sleep => {
                (knowledge.variables.asleep, knowledge.relieved) = (true, false);
                info!(context, "sleeps");
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

impl SafeRobotState {
    /// The end of the way to sleep.
    fn rests(&self, knowledge: &RobotKnowledge, context: &mut Context<'_>) -> Option<SafeRobotSymptom> {
        let rests = knowledge.relieved && knowledge.is_free() && knowledge.is_at_charger();
        context.because(self.sent);
        rests.then_some(SafeRobotSymptom::AtRest)
    }
}

impl RobotKnowledge {
    /// True if the robot has no job and would take none.
    pub(super) fn is_free(&self) -> bool {
        !self.variables.busy && !self.variables.transporter && !self.offers_help
    }

    /// The robot that needs help, if no robot that is awake can help it and this robot is the first to wake.
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

    /// Luggage in reach that no robot that is awake can bring, if it is this robot's turn: sleeping robots with lower
    /// numbers are asked first.
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

    /// True if another robot is awake that did not refuse the luggage.
    fn is_awake_for(&self, luggage: Option<u32>) -> bool {
        self.lists.active.iter().any(|robot| !robot.asleep && !self.refused(luggage, robot.robot))
    }

    /// Other robots that sleep and did not refuse the luggage.
    fn sleepers_for(&self, luggage: Option<u32>) -> impl Iterator<Item = &RobotList> {
        self.lists.sleepers().filter(move |robot| !self.refused(luggage, robot.robot))
    }

    fn refused(&self, luggage: Option<u32>, robot: u32) -> bool {
        luggage.is_some_and(|luggage| self.lists.requests.is_refused_by(luggage, robot))
    }
}
