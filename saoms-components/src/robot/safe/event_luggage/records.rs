use saoms_api::{Record, Recordable, record};

use crate::grid::Block;
use crate::messages::FIRST_VISIT;
use crate::robot::Job;

/// Luggage that a robot can decide about.
#[derive(Clone, Copy, Debug)]
pub enum SafeLuggageSymptom {
    /// Luggage waits, and suits this robot best.
    Waiting {
        /// Index of the request on the list.
        place: usize,
        /// The job.
        job: Job,
        /// Distance to the luggage.
        distance: u32,
    },
    /// This robot is interested, and no other robot is.
    Alone(Job),
    /// Another robot is interested and closer, or the battery is low.
    Beaten {
        /// The job that this robot was interested in.
        job: Job,
        /// Number of the other robot; `None` if this one has to charge.
        by: Option<u32>,
    },
    /// Another robot took the luggage that this one was interested in.
    Gone,
    /// A master assigned luggage to this robot.
    Assigned {
        /// The job.
        job: Job,
        /// True if this robot can take a job now.
        is_free: bool,
    },
    /// A master assigned the luggage of this robot to another one. It is not collected yet.
    Withdrawn(Job),
    /// No way leads to the robot's goal any more.
    CutOff {
        /// The job.
        job: Job,
        /// Goal of the robot.
        to: Block,
        /// True if the robot carries the luggage.
        carries: bool,
    },
    /// The luggage has waited for very long. This robot was free, but other robots were in its way.
    InVain(Job),
    /// This robot has been on the job for many times as long as the job takes, because other robots are in its way.
    Stuck {
        /// The job.
        job: Job,
        /// Number of executions since its start.
        executions: u32,
        /// True if the robot carries the luggage.
        carries: bool,
    },
    /// After several returns to the charger this robot knows that no full battery lasts.
    TooFar {
        /// The job.
        job: Job,
        /// Goal of the robot.
        to: Block,
        /// True if the robot carries the luggage.
        carries: bool,
    },
}

/// Reaction to the state of luggage.
#[derive(Clone, Copy, Debug)]
pub enum SafeLuggageDecision {
    /// Take an interest, and announce it.
    TakeInterest {
        /// Index of the request on the list.
        place: usize,
        /// The job.
        job: Job,
    },
    /// Consider the request again when the battery lasts long enough.
    Postpone {
        /// Index of the request on the list.
        place: usize,
        /// Number of executions that the battery has to last.
        needs: u32,
    },
    /// Consider the request again when the ways have changed.
    AwaitWay {
        /// Index of the request on the list.
        place: usize,
    },
    /// Leave the luggage to other robots for good.
    Refuse {
        /// The job.
        job: Job,
        /// Reason why this robot cannot bring it.
        why: Hindrance,
    },
    /// Visit the blocks of a request for this robot alone.
    Visit {
        /// Index of the request on the list.
        place: usize,
        /// The job.
        job: Job,
    },
    /// Bring the luggage.
    Take(Job),
    /// Take the interest back.
    Release(Job),
    /// Look for other luggage.
    Forget,
    /// Leave luggage that is not collected yet to other robots.
    Return(Job),
    /// Leave luggage to the master that assigned it, and end the job if it is the robot's.
    HandBack(Job),
    /// Give up luggage that the robot carries.
    GiveUp {
        /// The job.
        job: Job,
        /// Reason why the robot cannot bring it.
        why: Hindrance,
    },
}

/// Reasons why a robot cannot bring its luggage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hindrance {
    /// No way leads to the destination.
    NoWay,
    /// No full battery lasts for the way.
    Battery,
    /// Other robots are permanently in the way.
    Others,
}

impl Hindrance {
    pub(super) const fn words(self) -> &'static str {
        match self {
            Hindrance::NoWay => "no path leads there",
            Hindrance::Battery => "a full battery does not last for the way",
            Hindrance::Others => "other robots stay in its way",
        }
    }
}

impl Recordable for SafeLuggageSymptom {
    fn record(&self) -> Record {
        match *self {
            SafeLuggageSymptom::Waiting { job: Job { luggage, from, .. }, distance, .. } => {
                record!(
                    luggage_waits: "luggage {luggage} waits at {from}, {distance} {distance:block|blocks} away",
                    luggage,
                    from,
                    distance
                )
            }
            SafeLuggageSymptom::Alone(Job { luggage, .. }) => {
                record!(no_other_offer_for_luggage: "no other robot offers to carry luggage {luggage}", luggage)
            }
            SafeLuggageSymptom::Beaten { job: Job { luggage, .. }, by: Some(robot) } => {
                record!(robot_closer_to_luggage: "robot {robot} is closer to luggage {luggage}", robot, luggage)
            }
            SafeLuggageSymptom::Beaten { job: Job { luggage, .. }, by: None } => {
                record!(
                    has_to_charge_despite_luggage: "has to charge, but has offered to carry luggage {luggage}",
                    luggage
                )
            }
            SafeLuggageSymptom::Assigned { job: Job { luggage, from, .. }, is_free: true } => {
                record!(luggage_assigned: "is to carry luggage {luggage} from {from}", luggage, from)
            }
            SafeLuggageSymptom::Assigned { job: Job { luggage, .. }, is_free: false } => {
                record!(luggage_assigned_in_vain: "is to carry luggage {luggage}, but takes no job now", luggage)
            }
            SafeLuggageSymptom::Withdrawn(Job { luggage, .. }) => {
                record!(luggage_withdrawn: "luggage {luggage} is for another robot now", luggage)
            }
            SafeLuggageSymptom::Gone => record!(luggage_taken: "another robot takes the luggage"),
            SafeLuggageSymptom::CutOff { job: Job { luggage, .. }, to, .. } => {
                record!(
                    luggage_cut_off: "no path leads to {to} any more, where it has to go for luggage {luggage}",
                    to,
                    luggage
                )
            }
            SafeLuggageSymptom::InVain(Job { luggage, .. }) => {
                record!(
                    luggage_blocked: "could not get to luggage {luggage} for a long time: other robots are in its way",
                    luggage
                )
            }
            SafeLuggageSymptom::Stuck { job: Job { luggage, .. }, executions, .. } => record!(
                stuck_with_luggage:
                    "is stuck with luggage {luggage}: other robots have been in its way for {executions} \
                     {executions:execution|executions}",
                luggage,
                executions
            ),
            SafeLuggageSymptom::TooFar { job: Job { luggage, .. }, to, .. } => {
                record!(
                    luggage_too_far:
                        "turned back on its way to {to} again and again: a full battery does not last for luggage \
                         {luggage}",
                    to,
                    luggage
                )
            }
        }
    }
}

impl Recordable for SafeLuggageDecision {
    fn record(&self) -> Record {
        match *self {
            SafeLuggageDecision::TakeInterest { job: Job { luggage, .. }, .. } => {
                record!(offers_to_carry_luggage: "offers to carry luggage {luggage}", luggage)
            }
            SafeLuggageDecision::Postpone { needs, .. } => {
                record!(
                    charges_first: "charges first: the battery has to last {needs} {needs:execution|executions}",
                    needs
                )
            }
            SafeLuggageDecision::AwaitWay { .. } => {
                record!(awaits_way: "waits until a robot in the only way there has started again")
            }
            SafeLuggageDecision::Refuse { job: Job { luggage, .. }, .. } => {
                record!(refuses_luggage: "leaves luggage {luggage} to other robots: it can never carry it", luggage)
            }
            SafeLuggageDecision::Take(Job { luggage, from, to }) => {
                record!(takes_luggage: "takes luggage {luggage} from {from} to {to}", luggage, from, to)
            }
            SafeLuggageDecision::Visit { job: Job { luggage, from, .. }, .. } => {
                record!(goes_to_visit: "goes to {from} for visit {visit}", visit = luggage - FIRST_VISIT, from)
            }
            SafeLuggageDecision::Release(Job { luggage, .. }) => {
                record!(withdraws_offer_for_luggage: "withdraws its offer to carry luggage {luggage}", luggage)
            }
            SafeLuggageDecision::HandBack(Job { luggage, .. }) => {
                record!(hands_luggage_back: "leaves luggage {luggage} to the master", luggage)
            }
            SafeLuggageDecision::Forget => record!(looks_for_other_luggage: "looks for other luggage"),
            SafeLuggageDecision::Return(Job { luggage, .. }) => {
                record!(leaves_luggage: "leaves luggage {luggage} to other robots", luggage)
            }
            SafeLuggageDecision::GiveUp { job: Job { luggage, .. }, .. } => {
                record!(gives_up_luggage: "gives up luggage {luggage}", luggage)
            }
        }
    }
}
