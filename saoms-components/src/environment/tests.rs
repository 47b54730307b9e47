use std::time::Duration;

use super::scenario::{Event, Scenario};
use crate::grid::Block;
use crate::messages::{ExceptionalEvent, ExceptionalKind};

fn luggage(from: (i32, i32), to: (i32, i32)) -> Event {
    Event::Luggage { from: Block::new(from.0, from.1), to: Block::new(to.0, to.1) }
}

#[test]
fn a_scenario_is_read_in_the_order_of_its_times() {
    let text = "
        # The first pieces.
        at 6s luggage (3,1) to (3,10)
        then 1 s luggage ( 1 , 5 ) to ( 10 , 5 )   # after the line before
        then 500 luggage(10,8)to(1,8)
        at 3s landing 4; at 3s takeoff 2
    ";
    let exceptional = |kind, pieces| Event::Exceptional(ExceptionalEvent { kind, pieces });
    let millis = Duration::from_millis;
    let expected = [
        (millis(3000), exceptional(ExceptionalKind::Landing, 4)),
        (millis(3000), exceptional(ExceptionalKind::Takeoff, 2)),
        (millis(6000), luggage((3, 1), (3, 10))),
        (millis(7000), luggage((1, 5), (10, 5))),
        (millis(7500), luggage((10, 8), (1, 8))),
    ];
    assert_eq!(Scenario::read([text]).unwrap().events(), expected);
    assert!(Scenario::read([]).unwrap().events().is_empty());
    assert!(Scenario::read(["", " # nothing\n;"]).unwrap().events().is_empty());
}

#[test]
fn a_wrong_scenario_says_where_and_why() {
    let expected = "expected a line such as `at 6s luggage (3,1) to (3,10)` or `then 500ms landing 4`";
    for (line, error) in [
        ("luggage", format!("found `luggage`, {expected}")),
        ("after 6s landing 4", format!("found `after` at its start, {expected}")),
        ("at 6s lugage (3,1) to (3,10)", "found no event in `at 6s lugage (3,1) to (3,10)`, expected one of luggage, landing, takeoff".into()),
        ("at luggage (3,1) to (3,10)", "found no time after `at`, expected one such as `6s` or `500ms`".into()),
        ("at -6s landing 4", "`-6s` is negative: expected a number of milliseconds, or a number with one of the units ns, us, ms, s, min, h".into()),
        ("at 6s luggage (3,1)", "found `(3,1)` after `luggage`, expected two blocks such as `(3,1) to (3,10)`".into()),
        ("at 6s luggage (3,1) to 3,10", "found `3,10`, expected a block such as (3,10)".into()),
        ("at 6s landing four", "found `four`, expected the number of expected pieces of luggage, such as 4".into()),
        ("at 6s landing", "found ``, expected the number of expected pieces of luggage, such as 4".into()),
    ] {
        let found = Scenario::read(["at 1s landing 1; at 2s landing 1", line]).unwrap_err();
        assert_eq!((found.line, found.message), (3, error), "{line}");
    }
}
