//! Values of this crate as the boundary writes them, and back.

mod finding;
mod property;
mod report;
mod topic;
mod value;

pub use finding::Findings;
pub(super) use finding::{put_findings, take_finding};
pub use property::PropertyViews;
pub(super) use property::read_properties;
pub(super) use report::{read_report, with_report_view};
pub(super) use topic::{read_topic, topic_view};
pub(super) use value::{read_record, read_value, value_view};
