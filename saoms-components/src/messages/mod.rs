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

pub use collision::{COLLISION, Collision};
pub use critical_situation::{CRITICAL_SITUATION, CriticalKind, CriticalSituation, CriticalStage};
pub use environment_event::{ENVIRONMENT, EnvironmentEvent};
pub use event_luggage::{EVENT_LUGGAGE, EventLuggage, LuggageStage};
pub use exceptional_event::{EXCEPTIONAL_EVENT, ExceptionalEvent, ExceptionalKind};
pub use fault::{FAULT, Fault, FaultKind};
pub use position::{IMMOVABLE, POSITION, Position, Priority};
pub use robot_list::{ROBOT_LIST, RobotList};
pub use robot_state::{ROBOT_STATE, RobotState};

/// The map that the robots share, published when the world starts.
pub const AREA: Topic<Area> = Topic::state("AREATOPIC");
