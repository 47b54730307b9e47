//! Messages and topics of the fleet.
//!
//! | topic | message | published by | read by |
//! | --- | --- | --- | --- |
//! | [`ENVIRONMENT`] | [`EnvironmentEvent`] | environment, or anyone | the master of the environment, world |
//! | [`EVENT_LUGGAGE`] | [`EventLuggage`] | the master of the environment, robots | robots, the master of the environment, environment, world |
//! | [`EXCEPTIONAL_EVENT`] | [`ExceptionalEvent`] | the master of the environment | the master of the robots |
//! | [`FAULT`] | [`Fault`] | the master of the environment | robots |
//! | [`ROBOT_STATE`] | [`RobotState`] | the master of the robots, robots | robots |
//! | [`CRITICAL_SITUATION`] | [`CriticalSituation`] | robots | robots |
//! | [`ROBOT_LIST`] | [`RobotList`] | robots | robots, the master of the robots |
//! | [`POSITION`] | [`Position`] | robots | robots |
//! | [`AREA`] | [`Area`] | world | the master of the environment, environment, observers of the fleet |
//! | [`COLLISION`] | [`Collision`] | world, or robots without one | observers of the fleet |

mod collision;
mod critical_situation;
mod environment_event;
mod event_luggage;
mod exceptional_event;
mod fault;
mod position;
mod robot_list;
mod robot_state;

use saoms_api::Topic;

use crate::hardware::Area;

pub use collision::Collision;
pub use critical_situation::{CriticalKind, CriticalSituation, CriticalStage};
pub use environment_event::EnvironmentEvent;
pub use event_luggage::{EventLuggage, LuggageStage};
pub use exceptional_event::{ExceptionalEvent, ExceptionalKind};
pub use fault::{Fault, FaultKind};
pub use position::{IMMOVABLE, Position, Priority};
pub use robot_list::RobotList;
pub use robot_state::RobotState;

/// Events of any kind from the environment.
pub const ENVIRONMENT: Topic<EnvironmentEvent> = Topic::event("ETOPIC");

/// Requests to bring luggage, and the robots' responses.
pub const EVENT_LUGGAGE: Topic<EventLuggage> = Topic::event("ELMSTOPIC");

/// Events that change the number of robots that are needed.
pub const EXCEPTIONAL_EVENT: Topic<ExceptionalEvent> = Topic::event("EETOPIC").optional();

/// State of each robot, the newest message of each.
pub const ROBOT_LIST: Topic<RobotList> = Topic::state("RLMSTOPIC");

/// Position and next blocks of each robot, the newest message of each.
pub const POSITION: Topic<Position> = Topic::state("POSTOPIC");

/// The map that the robots share, published when the world starts.
pub const AREA: Topic<Area> = Topic::state("AREATOPIC");

/// Collisions of robots.
pub const COLLISION: Topic<Collision> = Topic::event("COLLISIONTOPIC").optional();

/// Faults of robots.
pub const FAULT: Topic<Fault> = Topic::event("FAULTTOPIC");

/// Commands to robots to wake or to sleep.
pub const ROBOT_STATE: Topic<RobotState> = Topic::event("RMSTOPIC");

/// Requests for help, and the responses of healers.
pub const CRITICAL_SITUATION: Topic<CriticalSituation> = Topic::event("CSMSTOPIC");
