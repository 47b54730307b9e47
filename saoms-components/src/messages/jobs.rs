//! Messages of a master that assigns luggage to robots.

use std::time::Duration;

use saoms_api::{Message, Topic};

use super::job_name;
use crate::grid::{Block, Map};
use crate::validation::{MessageValidator, Problem, Sender, Validate};

/// Luggage that a master assigns to single robots.
///
/// Published by the master of the environment; read by robots.
pub const ASSIGNMENT: Topic<Assignment> = Topic::event("JOBTOPIC").optional();

/// A job for one robot. The robot answers on ELMSTOPIC: it takes the luggage, refuses it for good, or releases it for
/// the others. To a robot that took a visit by itself, it says that the master agrees, and has no answer.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(place = "charger")]
pub struct Assignment {
    /// Number of the robot.
    pub robot: u32,
    /// Number of the luggage.
    pub luggage: u32,
    /// True if the luggage is for another robot now: the robot releases it, unless it has collected it.
    pub withdrawn: bool,
    /// Block where the luggage is collected.
    pub from: Block,
    /// Block where the luggage is deposited.
    pub to: Block,
    /// Block of the robot's charger. On a large map a robot hears the assignments for its charger alone.
    pub charger: Block,
    /// Of the answer to a lease (LEASETOPIC) its number: the robot may collect the luggage, or has to release it if it
    /// is withdrawn. 0 in all else.
    pub lease: u64,
}

impl Validate for Assignment {
    const WHAT: &'static str = "an assignment";

    fn about(&self) -> String {
        format!("{} from {} to {}", job_name(self.luggage), self.from, self.to)
    }

    fn validate(
        &self,
        _sender: Sender<'_>,
        validator: &mut MessageValidator,
        area: Option<&Map>,
    ) -> Result<(), Problem> {
        // What a lease is about its robot knows.
        for block in [self.from, self.to].into_iter().filter(|_| self.lease == 0) {
            Problem::of_block(block, area)?;
            if area.is_some_and(|area| !area.is_free(block)) {
                return Err(Problem::Blocked { block });
            }
        }
        validator.check_known(self.robot)
    }
}

/// Shortest lease, and the number of periods of its robot that it lasts at least. Networks are away for seconds when a
/// program of them starts again.
const LEAST_LEASE: Duration = Duration::from_secs(10);
const PERIODS_OF_LEASE: u32 = 20;

/// Luggage that robots have on a lease, the newest message of each robot.
///
/// Published by robots; read by the master of the environment.
pub const LEASE: Topic<Lease> = Topic::state("LEASETOPIC").optional();

/// Luggage that a robot brings which a component of another program requested or assigned.
///
/// The robot repeats it several times in each lease. It collects the luggage only once the master has answered, on
/// JOBTOPIC, that it may. Until then the luggage passes on to another robot if the master hears nothing for the time of
/// the lease.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(
    key = "robot",
    speaker("robot", instead = "to free luggage that the robot has taken, send `breakdown` or `gone`")
)]
pub struct Lease {
    /// Number of the robot.
    pub robot: u32,
    /// Number of the luggage.
    pub luggage: u32,
    /// Number of the lease, never 0: the robot has another one whenever it takes luggage.
    pub number: u64,
    /// True once the robot asks whether it may collect the luggage.
    pub collects: bool,
}

impl Lease {
    /// How long a lease of a robot with this period lasts, given in microseconds.
    pub fn duration(period: u64) -> Duration {
        LEAST_LEASE.max(Duration::from_micros(period).saturating_mul(PERIODS_OF_LEASE))
    }
}

impl Validate for Lease {
    const WHAT: &'static str = "the lease";
    const SPOKEN_ON: Option<Topic<Lease>> = Some(LEASE);

    fn about(&self) -> String {
        format!("luggage {}", self.luggage)
    }

    fn validate(
        &self,
        sender: Sender<'_>,
        validator: &mut MessageValidator,
        _area: Option<&Map>,
    ) -> Result<(), Problem> {
        validator.check_known_speaker(self.robot, sender)
    }
}
