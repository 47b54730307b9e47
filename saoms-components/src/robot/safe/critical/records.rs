use saoms_api::{Record, Recordable, record};

use crate::grid::Block;
use crate::messages::{CriticalKind, CriticalSituation};
use crate::robot::Trouble;

/// Critical situations that a robot can react to.
#[derive(Clone, Debug)]
pub enum SafeCriticalSymptom {
    /// This robot cannot continue.
    Broken {
        /// Reason why it cannot continue.
        trouble: Trouble,
        /// Kind of its critical situation.
        kind: CriticalKind,
        /// Position of the robot.
        block: Block,
    },
    /// Another robot needs help.
    NeedsHelp {
        /// The request of that robot.
        situation: CriticalSituation,
        /// Distance to the block where the help begins.
        distance: u32,
    },
    /// Another robot has needed help for very long. This robot was free, but other robots were in its way.
    InVain(CriticalSituation),
    /// This robot offered help, and no other robot did.
    Alone(CriticalSituation),
    /// Another robot offered help and is closer, or the battery is low.
    Beaten {
        /// The request for help.
        situation: CriticalSituation,
        /// Number of the other robot; `None` if this one has to charge.
        by: Option<u32>,
    },
    /// Another robot helps.
    Gone,
    /// This robot was woken as a substitute for a robot whose job is already taken over.
    Woken {
        /// Number of the other robot.
        emulates: u32,
    },
    /// This robot starts to charge, and others sleep.
    Charges {
        /// Battery level in percent.
        battery: f64,
    },
    /// A robot is missing, and another one sleeps.
    Missing {
        /// Number of the missing robot.
        robot: u32,
        /// Number of the sleeping robot.
        sleeper: u32,
        /// Battery level of the sleeping robot, in percent.
        battery: f64,
    },
    /// A missing robot has a substitute.
    Substituted {
        /// Number of the missing robot.
        robot: u32,
        /// Number of its substitute.
        by: u32,
    },
}

/// Reaction to a critical situation.
#[derive(Clone, Debug)]
pub enum SafeCriticalDecision {
    /// Ask for help, and shut down.
    CallForHelp {
        /// Reason why the robot cannot continue.
        trouble: Trouble,
        /// Kind of its critical situation.
        kind: CriticalKind,
    },
    /// Offer help.
    Offer(CriticalSituation),
    /// Consider the request again when the battery lasts long enough.
    Postpone {
        /// The request.
        situation: CriticalSituation,
        /// Number of executions that the battery has to last.
        needs: u32,
    },
    /// Consider the request again when the ways have changed.
    AwaitWay(CriticalSituation),
    /// Leave the request to other robots: it is out of reach.
    Refuse(CriticalSituation),
    /// Help.
    Heal(CriticalSituation),
    /// Take the offer back.
    Release(CriticalSituation),
    /// Become free again.
    Forget,
    /// Report that this robot substitutes another one.
    StandIn {
        /// Number of the other robot.
        critical: u32,
    },
    /// Ask for a substitute.
    AskForSubstitute,
    /// Wake a substitute for another robot.
    Awake {
        /// Number of the sleeping robot.
        sleeper: u32,
        /// Number of the missing robot.
        robot: u32,
    },
    /// End the search; this robot itself sleeps if it was the missing one.
    Rest {
        /// Number of the missing robot.
        robot: u32,
    },
}

impl Recordable for SafeCriticalSymptom {
    fn record(&self) -> Record {
        match *self {
            SafeCriticalSymptom::Broken { trouble, kind, block } => {
                let trouble = trouble.name();
                match kind {
                    CriticalKind::CarriesLuggage => {
                        record!(
                            stops_while_carrying: "stops at {block} while carrying luggage: {trouble}",
                            block,
                            trouble
                        )
                    }
                    CriticalKind::OnTheWay => record!(
                        stops_while_fetching: "stops at {block} while fetching luggage: {trouble}",
                        block,
                        trouble
                    ),
                    CriticalKind::Idle => {
                        record!(stops_while_idle: "stops at {block} while idle: {trouble}", block, trouble)
                    }
                }
            }
            SafeCriticalSymptom::NeedsHelp { ref situation, distance } => {
                let CriticalSituation { critical, block, kind, .. } = *situation;
                match kind {
                    CriticalKind::CarriesLuggage => record!(
                        robot_broke_down_while_carrying:
                            "robot {robot} broke down at {block} while carrying luggage, {distance} \
                             {distance:block|blocks} away",
                        robot = critical,
                        block,
                        distance
                    ),
                    CriticalKind::OnTheWay => record!(
                        robot_broke_down_while_fetching:
                            "robot {robot} broke down at {block} while fetching luggage, {distance} \
                             {distance:block|blocks} away",
                        robot = critical,
                        block,
                        distance
                    ),
                    CriticalKind::Idle => record!(
                        robot_broke_down_while_idle:
                            "robot {robot} broke down at {block} while idle, {distance} {distance:block|blocks} away",
                        robot = critical,
                        block,
                        distance
                    ),
                }
            }
            SafeCriticalSymptom::InVain(CriticalSituation { critical, .. }) => {
                record!(
                    help_blocked: "could not get to robot {robot} for a long time: other robots are in its way",
                    robot = critical
                )
            }
            SafeCriticalSymptom::Alone(CriticalSituation { critical, .. }) => {
                record!(no_other_offer_to_help: "no other robot offers to help robot {robot}", robot = critical)
            }
            SafeCriticalSymptom::Beaten { situation: CriticalSituation { critical, .. }, by: Some(robot) } => {
                record!(robot_closer_to_robot: "robot {robot} is closer to robot {critical}", robot, critical)
            }
            SafeCriticalSymptom::Beaten { situation: CriticalSituation { critical, .. }, by: None } => {
                record!(
                    has_to_charge_despite_offer_to_help: "has to charge, but has offered to help robot {robot}",
                    robot = critical
                )
            }
            SafeCriticalSymptom::Gone => record!(other_robot_helps: "another robot helps"),
            SafeCriticalSymptom::Woken { emulates } => {
                record!(was_woken_as_substitute: "was woken to stand in for robot {robot}", robot = emulates)
            }
            SafeCriticalSymptom::Charges { battery } => {
                record!(
                    has_to_charge_while_others_sleep: "has to charge (battery {battery} %), and other robots sleep",
                    battery
                )
            }
            SafeCriticalSymptom::Missing { robot, sleeper, battery } => record!(
                robot_missing: "robot {robot} is missing, and robot {sleeper} sleeps with {battery} %",
                robot,
                sleeper,
                battery
            ),
            SafeCriticalSymptom::Substituted { robot, by } => {
                record!(robot_substituted: "robot {by} stands in for robot {robot}", by, robot)
            }
        }
    }
}

impl Recordable for SafeCriticalDecision {
    fn record(&self) -> Record {
        match *self {
            SafeCriticalDecision::CallForHelp { .. } => record!(asks_for_help: "asks for help and shuts down"),
            SafeCriticalDecision::Offer(CriticalSituation { critical, .. }) => {
                record!(offers_help: "offers to help robot {robot}", robot = critical)
            }
            SafeCriticalDecision::Postpone { needs, .. } => {
                record!(
                    charges_first: "charges first: the battery has to last {needs} {needs:execution|executions}",
                    needs
                )
            }
            SafeCriticalDecision::AwaitWay(_) => {
                record!(awaits_way: "waits until a robot in the only way there has started again")
            }
            SafeCriticalDecision::Refuse(CriticalSituation { critical, .. }) => {
                record!(refuses_help: "leaves robot {robot} to other robots: it can never help it", robot = critical)
            }
            SafeCriticalDecision::Heal(CriticalSituation { critical, kind, luggage, to, .. }) => match kind {
                CriticalKind::CarriesLuggage => {
                    record!(
                        takes_over_luggage_on_board:
                            "collects luggage {luggage} from robot {robot} and carries it to {to}",
                        luggage,
                        robot = critical,
                        to
                    )
                }
                CriticalKind::OnTheWay => {
                    record!(
                        takes_over_luggage: "carries luggage {luggage} to {to} in place of robot {robot}",
                        luggage,
                        to,
                        robot = critical
                    )
                }
                CriticalKind::Idle => {
                    record!(finds_substitute: "looks for a substitute for robot {robot}", robot = critical)
                }
            },
            SafeCriticalDecision::Release(CriticalSituation { critical, .. }) => {
                record!(withdraws_offer_to_help: "withdraws its offer to help robot {robot}", robot = critical)
            }
            SafeCriticalDecision::Forget => record!(is_free: "is free again"),
            SafeCriticalDecision::StandIn { critical } => {
                record!(stands_in: "stands in for robot {robot}", robot = critical)
            }
            SafeCriticalDecision::AskForSubstitute => record!(asks_for_substitute: "asks for a substitute"),
            SafeCriticalDecision::Awake { sleeper, robot } => {
                record!(wakes_substitute: "wakes robot {sleeper} to stand in for robot {robot}", sleeper, robot)
            }
            SafeCriticalDecision::Rest { robot } => {
                record!(substitute_found: "robot {robot} has a substitute", robot)
            }
        }
    }
}

impl Trouble {
    /// Its name in records.
    const fn name(self) -> &'static str {
        match self {
            Trouble::Breakdown => "breakdown",
            Trouble::Hardware => "hardware",
            Trouble::Battery => "battery",
        }
    }

    pub(in crate::robot) const fn words(self) -> &'static str {
        match self {
            Trouble::Breakdown => "breaks down",
            Trouble::Hardware => "hardware keeps failing",
            Trouble::Battery => "battery is empty",
        }
    }
}

pub(super) const fn doing(kind: CriticalKind) -> &'static str {
    match kind {
        CriticalKind::CarriesLuggage => "while carrying luggage",
        CriticalKind::OnTheWay => "while fetching luggage",
        CriticalKind::Idle => "while idle",
    }
}
