use saoms_api::{Record, Recordable, record};

use crate::grid::Block;
use crate::messages::{CriticalKind, CriticalSituation};
use crate::robot::Trouble;

/// What is critical.
#[derive(Clone, Debug)]
pub enum CriticalSymptom {
    /// This robot cannot go on.
    Broken {
        /// What is broken.
        trouble: Trouble,
        /// What it was doing.
        kind: CriticalKind,
        /// Where it is.
        block: Block,
    },
    /// Another robot needs help.
    NeedsHelp {
        /// What that robot said.
        situation: CriticalSituation,
        /// How far it is to where the help begins.
        distance: u32,
    },
    /// Another robot has needed help for very long, while this robot did nothing else, and others were in its way.
    InVain(CriticalSituation),
    /// This robot would help, and nobody else would.
    Alone(CriticalSituation),
    /// Another robot would help and is closer, or the battery got low.
    Beaten {
        /// What the robot in need said.
        situation: CriticalSituation,
        /// The other robot; `None` where this one has to charge.
        by: Option<u32>,
    },
    /// Another robot helps.
    Gone,
    /// This robot was awaked in place of another one, whose job is taken over already.
    Awaked {
        /// The other robot.
        emulates: u32,
    },
    /// This robot starts to charge, and others sleep.
    Charges {
        /// Its battery in percent.
        battery: f64,
    },
    /// A robot is missing, and another one sleeps.
    Missing {
        /// The robot that is missing.
        robot: u32,
        /// The one that sleeps.
        sleeper: u32,
        /// Its battery in percent.
        battery: f64,
    },
    /// A robot that was missing has a substitute.
    Substituted {
        /// The robot that was missing.
        robot: u32,
        /// The one that stands in.
        by: u32,
    },
}

/// What to do about it.
#[derive(Clone, Debug)]
pub enum CriticalDecision {
    /// Ask for help, and shut down.
    CallForHelp {
        /// What is broken.
        trouble: Trouble,
        /// What the robot was doing.
        kind: CriticalKind,
    },
    /// Be ready to help, and ask who else is.
    Offer(CriticalSituation),
    /// Think about it again when the battery lasts for so many executions.
    Postpone {
        /// The robot in need.
        critical: u32,
        /// The executions.
        needs: u32,
    },
    /// Leave it to others: it is out of reach.
    Refuse(CriticalSituation),
    /// Help.
    Heal(CriticalSituation),
    /// Leave it to others.
    Release(CriticalSituation),
    /// Be free again.
    Forget,
    /// Say that this robot stands in for another one.
    StandIn {
        /// The other robot.
        critical: u32,
    },
    /// Ask for a substitute.
    AskForSubstitute,
    /// Awake a robot in place of another one.
    Awake {
        /// The robot that sleeps.
        sleeper: u32,
        /// The robot that is missing.
        robot: u32,
    },
    /// Let it be; this robot itself sleeps when it was the one that was missing.
    Rest {
        /// The robot that was missing.
        robot: u32,
    },
}

impl Recordable for CriticalSymptom {
    fn record(&self) -> Record {
        match *self {
            CriticalSymptom::Broken { trouble, kind, block } => {
                record!("{trouble} at {block} {doing}", trouble = trouble.words(), block, doing = doing(kind))
            }
            CriticalSymptom::NeedsHelp { ref situation, distance } => {
                let CriticalSituation { critical, block, kind, .. } = *situation;
                record!(
                    "robot {critical} broke down at {block} {doing}, {distance} blocks away",
                    critical,
                    block,
                    doing = doing(kind),
                    distance
                )
            }
            CriticalSymptom::InVain(CriticalSituation { critical, .. }) => record!(
                "could not begin to help robot {critical} for very long: others are in its way",
                critical
            ),
            CriticalSymptom::Alone(CriticalSituation { critical, .. }) => {
                record!("no other robot would help robot {critical}", critical)
            }
            CriticalSymptom::Beaten { situation: CriticalSituation { critical, .. }, by: Some(robot) } => {
                record!("robot {robot} is closer to robot {critical}", robot, critical)
            }
            CriticalSymptom::Beaten { situation: CriticalSituation { critical, .. }, by: None } => {
                record!("has to charge, and said that it would help robot {critical}", critical)
            }
            CriticalSymptom::Gone => record!("another robot helps"),
            CriticalSymptom::Awaked { emulates } => {
                record!("was awaked in place of robot {emulates}", emulates)
            }
            CriticalSymptom::Charges { battery } => {
                record!("has to charge (battery {battery} %), and others sleep", battery)
            }
            CriticalSymptom::Missing { robot, sleeper, battery } => record!(
                "robot {robot} is missing, and robot {sleeper} sleeps with {battery} %",
                robot,
                sleeper,
                battery
            ),
            CriticalSymptom::Substituted { robot, by } => {
                record!("robot {by} stands in for robot {robot}", by, robot)
            }
        }
    }
}

impl Recordable for CriticalDecision {
    fn record(&self) -> Record {
        match *self {
            CriticalDecision::CallForHelp { .. } => record!("calls for help and shuts down"),
            CriticalDecision::Offer(CriticalSituation { critical, .. }) => {
                record!("would help robot {critical}, and asks who else would", critical)
            }
            CriticalDecision::Postpone { needs, .. } => {
                record!("charges first: that takes {needs} executions", needs)
            }
            CriticalDecision::Refuse(CriticalSituation { critical, .. }) => {
                record!("leaves robot {critical} to others: it can never do that", critical)
            }
            CriticalDecision::Heal(CriticalSituation { critical, kind, luggage, to, .. }) => match kind {
                CriticalKind::CarriesLuggage => {
                    record!(
                        "collects luggage {luggage} from robot {critical} and brings it to {to}",
                        luggage,
                        critical,
                        to
                    )
                }
                CriticalKind::OnTheWay => {
                    record!(
                        "brings luggage {luggage} to {to} in place of robot {critical}",
                        luggage,
                        to,
                        critical
                    )
                }
                CriticalKind::Idle => record!("finds a substitute for robot {critical}", critical),
            },
            CriticalDecision::Release(CriticalSituation { critical, .. }) => {
                record!("leaves robot {critical} to others", critical)
            }
            CriticalDecision::Forget => record!("is free again"),
            CriticalDecision::StandIn { critical } => record!("stands in for robot {critical}", critical),
            CriticalDecision::AskForSubstitute => record!("asks for a substitute"),
            CriticalDecision::Awake { sleeper, robot } => {
                record!("awakes robot {sleeper} in place of robot {robot}", sleeper, robot)
            }
            CriticalDecision::Rest { robot } => record!("robot {robot} has its substitute", robot),
        }
    }
}

impl Trouble {
    pub(super) const fn words(self) -> &'static str {
        match self {
            Trouble::Breakdown => "broke down",
            Trouble::Hardware => "has hardware that fails again and again",
            Trouble::Battery => "has an empty battery",
        }
    }
}

pub(super) const fn doing(kind: CriticalKind) -> &'static str {
    match kind {
        CriticalKind::CarriesLuggage => "with luggage",
        CriticalKind::OnTheWay => "on its way to luggage",
        CriticalKind::Idle => "without a job",
    }
}
