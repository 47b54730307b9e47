//! What the components of the fleet tell each other, and on which topics.
//!
//! | topic | message | published by | read by |
//! | --- | --- | --- | --- |
//! | [`ENVIRONMENT`] | [`EnvironmentEvent`] | environment, or anyone | the master of the environment, world |
//! | [`EVENT_LUGGAGE`] | [`EventLuggage`] | the master of the environment, robots | robots, environment |
//! | [`EXCEPTIONAL_EVENT`] | [`ExceptionalEvent`] | the master of the environment | the master of the robots |
//! | [`ROBOT_LIST`] | [`RobotList`] | robots | robots, the master of the robots |
//! | [`POSITION`] | [`Position`] | robots | robots |

mod environment_event;
mod event_luggage;
mod exceptional_event;
mod position;
mod robot_list;

use saoms_api::Topic;

pub use environment_event::EnvironmentEvent;
pub use event_luggage::{EventLuggage, LuggageStage};
pub use exceptional_event::{ExceptionalEvent, ExceptionalKind};
pub use position::{IMMOVABLE, Position, Priority};
pub use robot_list::RobotList;

/// Events of any kind, as they come in from the environment.
pub const ENVIRONMENT: Topic<EnvironmentEvent> = Topic::event("ETOPIC");

/// Luggage that waits to be brought somewhere, and the robots' responses.
pub const EVENT_LUGGAGE: Topic<EventLuggage> = Topic::event("ELMSTOPIC");

/// Events that change how many robots are needed.
pub const EXCEPTIONAL_EVENT: Topic<ExceptionalEvent> = Topic::event("EETOPIC");

/// Which robots there are, the newest of each.
pub const ROBOT_LIST: Topic<RobotList> = Topic::state("RLMSTOPIC");

/// Where the robots are and where they go next, the newest of each.
pub const POSITION: Topic<Position> = Topic::state("POSTOPIC");
