//! What tests of composites and components use: check a fleet, or run it in virtual time and look at what came of it.
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
//! let report = fleet.set("period", "50").run(7, Duration::from_secs(10));
//! assert_eq!(report.components[0].executions, 200);
//! ```
//!
//! The components that ship are linked in; a crate with its own links them by naming it: `use my_robot as _;`.

mod fleet;

pub use fleet::Fleet;
use saoms_components as _;
