//! The manual's table 6.27, made consistent: the variables of a robot in each situation, as the journal tells them.

use saoms_api::Time;
use saoms_core::journal::{Change, Journal};

use super::run::Run;

/// Situation; robot; execution; the variables at its end, in the order of [`VARIABLES`], where a hyphen can be either.
const TABLE: &str = "
    awake, in charge position          | Robot001 |  3 | no  no  no  no  no  no  no  no
    takes an interest in luggage       | Robot001 |  8 | no  yes no  no  -   no  no  no
    on the way to collect              | Robot001 | 12 | yes yes no  no  -   no  no  no
    on the way to deposit              | Robot001 | 20 | yes yes yes no  -   no  no  no
    no risk of collision yet           | Robot002 | 16 | yes yes yes no  -   -   no  -
    risk of collision, no precedence   | Robot002 | 17 | yes yes yes yes -   -   no  -
    low battery                        | Robot001 | 44 | -   -   -   -   yes no  no  no
    reaching the charge position       | Robot001 | 56 | no  no  no  no  yes yes no  no
    charging                           | Robot001 | 66 | yes no  no  no  no  no  yes no
    charged and asleep                 | Robot001 | 75 | no  no  no  no  no  no  yes no
    helps another robot (healer elect) | Robot002 | 67 | yes no  no  no  no  no  -   yes
    the same, still in charge          | Robot002 | 65 | yes no  no  no  no  no  -   yes
";

const VARIABLES: [&str; 8] = [
    "busy", "transporter", "hasLuggage", "stopAPeriod", "readyToGoUnderCharge", "reachingCharge", "inCharge", "healer",
];

/// The value of a variable once the execution that began then is over.
///
/// # Panics
/// The journal contradicts itself: a change starts at another value than the last one ended at.
fn variable(journal: &Journal, robot: &str, name: &str, at: Time) -> bool {
    let (mut value, changes) = (false, journal.of(robot).changes(name));
    for entry in changes.iter() {
        let Change { before, after: to, .. } = entry.change().unwrap();
        assert_eq!(before, value, "{robot} {name} before {}", entry.time());
        if entry.time() > at {
            return value;
        }
        value = to == true;
    }
    value
}

#[test]
fn each_situation_has_the_variables_of_table_6_27() {
    let run = Run::of("scenario2.composite", 90);
    let journal = &run.report.journal;
    assert_eq!(journal.overwritten, 0);
    for row in TABLE.trim().lines() {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let [_, robot, execution, expected] = cells[..] else { panic!("no row: {row}") };
        let at = run.execution(robot, execution.parse().unwrap()).time;
        let shown = expected.split_whitespace().zip(VARIABLES).map(|(expected, name)| {
            let value = if variable(journal, robot, name, at) { "yes" } else { "no" };
            if expected == "-" { "-" } else { value }
        });
        let expected: Vec<&str> = expected.split_whitespace().collect();
        assert_eq!(shown.collect::<Vec<_>>(), expected, "{row}");
    }
}
