//! Tests of composites and components: check a fleet, or run it in virtual time and look at the result.
//!
//! A [`Bench`] runs one component and a [`LoopBench`] one loop. [`Installed`] runs a fleet with the command `saoms`
//! that is installed, which is all that a plugin needs: with `default-features = false` its tests build none of SAOMS
//! but the contract. With the feature `fleets`, which is there by default, a [`Fleet`] runs in the process of the test.
//!
//! ```
//! use std::time::Duration;
//! use saoms_testkit::Fleet;
//!
//! let fleet = Fleet::of_text(r#"
//!     <composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="fleet" targetNamespace="urn:fleet">
//!       <property name="period">100</property>
//!       <component name="Robot001">
//!         <implementation.java class="robot.Robot001"/>
//!         <property name="ID">Robot001</property>
//!         <property name="period" source="$period"/>
//!       </component>
//!     </composite>"#);
//! assert_eq!(fleet.diagnostics(), "");
//! let run = fleet.set("period", "50").run(7, Duration::from_secs(10));
//! assert_eq!(run.components[0].executions, 200);
//! ```
//!
//! A composite says in comments what is wrong with it, and [`expect_diagnostics`] holds it to them; [`Run::expect`]
//! asks what a component did in a run. `docs/testing.md` of the project is the guide.
//!
//! A test holds a fleet to how it adapts itself by the [journal](saoms_core::journal) of a run: what each loop saw,
//! decided and did, when, and what came from what.
//!
//! ```
//! use std::time::Duration;
//! use saoms_testkit::Fleet;
//!
//! let run = Fleet::of_file("../composites/hall.composite").run(7, Duration::from_secs(60));
//! let robot = run.journal().of("Robot7");
//! let collects = robot.decisions().with("collects luggage 1").last().unwrap();
//! let (reasons, _) = run.journal().reasons(collects);
//! assert_eq!(reasons[0].text(), "is at (3,1), where luggage 1 waits");
//! assert_eq!(run.journal().of("Robot7").changes("hasLuggage").len(), 2);
//! assert_eq!(run.log_of("Robot7")[0], "takes luggage 1 from (3,1) to (3,10)");
//! ```
//!
//! The components that ship are linked in; a crate with its own links them by naming it: `use my_robot as _;`.

#[cfg(feature = "fleets")]
mod adaptation;
mod bench;
mod comply;
#[cfg(feature = "fleets")]
mod expected;
#[cfg(feature = "fleets")]
mod faults;
#[cfg(feature = "fleets")]
mod fleet;
mod golden;
mod installed;
#[cfg(feature = "fleets")]
mod invariants;
mod loop_bench;
#[cfg(feature = "fleets")]
mod moment;
#[cfg(feature = "fleets")]
mod problem;
#[cfg(feature = "fleets")]
mod run;
mod stage;
#[cfg(feature = "fleets")]
mod start;

pub use bench::Bench;
pub use comply::{comply, comply_as, comply_loop, comply_loop_as};
#[cfg(feature = "fleets")]
pub use expected::expect_diagnostics;
#[cfg(feature = "fleets")]
pub use fleet::Fleet;
pub use installed::{Installed, InstalledRun};
pub use loop_bench::LoopBench;
#[cfg(feature = "fleets")]
pub use moment::{Expect, Moment, PointInTime};
#[cfg(feature = "fleets")]
pub use problem::{Problem, ProblemFault, ProblemFleet, Task};
#[cfg(feature = "fleets")]
pub use run::Run;
#[cfg(feature = "fleets")]
use saoms_components as _;
#[cfg(feature = "fleets")]
pub use start::NotStarted;

/// The examples of `docs/loops.md`, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../../docs/loops.md")]
struct Loops;

/// The examples of `docs/testing.md`, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../../docs/testing.md")]
struct Testing;

/// The examples of `docs/plugins.md`, compiled.
#[cfg(doctest)]
#[doc = include_str!("../../docs/plugins.md")]
struct Plugins;

/// The example of `docs/scheduling.md`, compiled.
#[cfg(doctest)]
#[doc = include_str!("../../docs/scheduling.md")]
struct Scheduling;

/// The example of `docs/from-ros2.md`, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../../docs/from-ros2.md")]
struct FromRos2;

/// The example of `docs/from-dora.md`, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../../docs/from-dora.md")]
struct FromDora;

/// The example of `docs/from-behaviortree.md`, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../../docs/from-behaviortree.md")]
struct FromBehaviorTree;
