use saoms_api::{Record, Recordable, record};

use crate::grid::Block;
use crate::robot::Job;

/// What there is to decide about luggage.
#[derive(Clone, Copy, Debug)]
pub enum EventLuggageSymptom {
    /// Luggage waits, and suits this robot best.
    Waiting {
        /// Its place on the list.
        place: usize,
        /// What there is to bring.
        job: Job,
        /// How far away it is.
        distance: u32,
    },
    /// This robot is interested, and nobody else is.
    Alone(Job),
    /// Another robot is interested and closer, or the battery got low.
    Beaten {
        /// What this robot was interested in.
        job: Job,
        /// The other robot; `None` where this one has to charge.
        by: Option<u32>,
    },
    /// Another robot took what this one was interested in.
    Gone,
    /// No way leads any more to where this robot has to go.
    CutOff {
        /// What it brings.
        job: Job,
        /// Where it has to go.
        to: Block,
        /// Whether it carries it.
        carries: bool,
    },
    /// It waits for very long, while this robot did nothing else, and others were in its way.
    InVain(Job),
    /// This robot has been on it for many times as long as it takes, because others are in its way.
    Stuck {
        /// What it brings.
        job: Job,
        /// Since how many executions.
        executions: u32,
        /// Whether it carries it.
        carries: bool,
    },
    /// Charged and turned back again and again, it knows by now that no full battery lasts.
    TooFar {
        /// What it brings.
        job: Job,
        /// Where it has to go.
        to: Block,
        /// Whether it carries it.
        carries: bool,
    },
}

/// What to do about it.
#[derive(Clone, Copy, Debug)]
pub enum EventLuggageDecision {
    /// Take an interest, and say so.
    TakeInterest {
        /// The request's place on the list.
        place: usize,
        /// What there is to bring.
        job: Job,
    },
    /// Think about it again when the battery lasts for so many executions.
    Postpone {
        /// The request's place on the list.
        place: usize,
        /// The executions.
        needs: u32,
    },
    /// Leave it to others for good.
    Refuse {
        /// What there is to bring.
        job: Job,
        /// Why it cannot.
        why: Hindrance,
    },
    /// Bring it.
    Take(Job),
    /// Take the interest back.
    Release(Job),
    /// Look for other luggage.
    Forget,
    /// Leave what it did not collect yet to others.
    Return(Job),
    /// Give up what it carries.
    GiveUp {
        /// What it brings.
        job: Job,
        /// Why it cannot.
        why: Hindrance,
    },
}

/// What keeps a robot from bringing what it carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hindrance {
    /// No way leads there.
    NoWay,
    /// No full battery lasts for the way.
    Battery,
    /// Others are in the way for ever.
    Others,
}

impl Hindrance {
    pub(super) const fn words(self) -> &'static str {
        match self {
            Hindrance::NoWay => "no way leads",
            Hindrance::Battery => "no full battery lasts for the way",
            Hindrance::Others => "others are in its way for ever",
        }
    }
}

impl Recordable for EventLuggageSymptom {
    fn record(&self) -> Record {
        match *self {
            EventLuggageSymptom::Waiting { job: Job { luggage, from, .. }, distance, .. } => {
                record!("luggage {luggage} waits at {from}, {distance} blocks away", luggage, from, distance)
            }
            EventLuggageSymptom::Alone(Job { luggage, .. }) => {
                record!("no other robot is interested in luggage {luggage}", luggage)
            }
            EventLuggageSymptom::Beaten { job: Job { luggage, .. }, by: Some(robot) } => {
                record!("robot {robot} is closer to luggage {luggage}", robot, luggage)
            }
            EventLuggageSymptom::Beaten { job: Job { luggage, .. }, by: None } => {
                record!("has to charge, and said that it would bring luggage {luggage}", luggage)
            }
            EventLuggageSymptom::Gone => record!("another robot takes the luggage"),
            EventLuggageSymptom::CutOff { job: Job { luggage, .. }, to, .. } => {
                record!(
                    "no way leads to {to} any more, where it has to go for luggage {luggage}",
                    to,
                    luggage
                )
            }
            EventLuggageSymptom::InVain(Job { luggage, .. }) => {
                record!(
                    "could not begin with luggage {luggage} for very long: others are in its way",
                    luggage
                )
            }
            EventLuggageSymptom::Stuck { job: Job { luggage, .. }, executions, .. } => record!(
                "gets nowhere with luggage {luggage}: others have been in its way for {executions} executions",
                luggage,
                executions
            ),
            EventLuggageSymptom::TooFar { job: Job { luggage, .. }, to, .. } => {
                record!(
                    "turned back from the way to {to} again and again: no full battery lasts to bring luggage {luggage}",
                    to,
                    luggage
                )
            }
        }
    }
}

impl Recordable for EventLuggageDecision {
    fn record(&self) -> Record {
        match *self {
            EventLuggageDecision::TakeInterest { job: Job { luggage, .. }, .. } => {
                record!("would bring luggage {luggage}, and asks who else would", luggage)
            }
            EventLuggageDecision::Postpone { needs, .. } => {
                record!("charges first: that takes {needs} executions", needs)
            }
            EventLuggageDecision::Refuse { job: Job { luggage, .. }, .. } => {
                record!("leaves luggage {luggage} to others: it can never bring that", luggage)
            }
            EventLuggageDecision::Take(Job { luggage, from, to }) => {
                record!("brings luggage {luggage} from {from} to {to}", luggage, from, to)
            }
            EventLuggageDecision::Release(Job { luggage, .. }) => {
                record!("leaves luggage {luggage} to others", luggage)
            }
            EventLuggageDecision::Forget => record!("looks for other luggage"),
            EventLuggageDecision::Return(Job { luggage, .. }) => {
                record!("leaves luggage {luggage} to others", luggage)
            }
            EventLuggageDecision::GiveUp { job: Job { luggage, .. }, .. } => {
                record!("gives luggage {luggage} up", luggage)
            }
        }
    }
}
