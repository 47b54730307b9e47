//! What operators and the dashboard see of a zone.

use saoms_api::ReportValue;

use super::ledger::{Ledger, Member};
use crate::grid::Block;

/// Maximum number of waiting robots that a status lists.
const LISTED: usize = 1000;

/// The status of a zone with this record, which grants or not.
pub(super) fn status(ledger: Option<&Ledger>, open: bool) -> Vec<(String, ReportValue)> {
    let count = |number: usize| ReportValue::from(i64::try_from(number).unwrap_or(i64::MAX));
    let members = || ledger.into_iter().flat_map(Ledger::members);
    let held = || members().map(|(_, member)| member.steps.len());
    let waits = members().filter_map(|(robot, member)| waits(*robot, member));
    ReportValue::named([
        ("robots", count(held().filter(|held| *held > 0).count())),
        ("held", count(held().sum())),
        ("waiting", count(members().filter(|(_, member)| member.waited > 0).count())),
        ("open", open.into()),
        ("waits", ReportValue::List(waits.take(LISTED).collect())),
    ])
}

/// A robot that waits, the robot that goes first, and why.
fn waits(robot: u32, member: &Member) -> Option<ReportValue> {
    let (Block { x, y }, first) = member.in_the_way?;
    let waits = member.wants_to_go() || member.waits_to_enter();
    let value = || {
        ReportValue::Map(ReportValue::named([
            ("robot", robot.into()),
            ("at", ReportValue::List(vec![x.into(), y.into()])),
            ("goes_first", first.into()),
            ("because", format!("it {}", member.rule.words()).into()),
        ]))
    };
    waits.then(value)
}
