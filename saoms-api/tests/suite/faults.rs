//! Faults as lines write them.

use saoms_api::event::fault::{FaultCall, FaultSubjects, SubjectComponent, SubjectTopic};
use saoms_api::extension::LineFault;

/// The line again, or its fault behind the words that are wrong.
fn read(line: &str) -> String {
    shown(line, FaultCall::read(line).map(|call| call.to_string()))
}

fn shown(line: &str, result: Result<String, LineFault>) -> String {
    result.unwrap_or_else(|fault| format!("`{}`: {fault}", &line[fault.bytes.clone()]))
}

#[test]
fn a_line_is_read_and_written_again() {
    for line in [
        "for 30s lose 20 % on POSTOPIC from Robot* to Robot2, Robot3",
        "violate 12.5 %",
        "delay 50ms to 300ms on North/POSTOPIC",
        "delay 50ms to Robot2",
        "jitter 20ms from Robot1",
        "duplicate 0.0001 %",
        "reorder 10 % by 200ms on ELMSTOPIC",
        "for 5s cut Robot1 from Robot2, Master on ELMSTOPIC",
        "part Robot1, Robot2 from Robot3",
        "for 2s stall Robot*",
        "fail World",
        "crash Zone restart 2s",
        "crash Zone",
        "drift Robot1 2 %",
        "drift Robot1 -0.5 %",
    ] {
        assert_eq!(read(line), line);
    }
    assert_eq!(read("  for 1 min lose 0.2 to  A , B"), "for 60s lose 20 % to A, B");
    assert_eq!(read("delay 50ms to 50ms"), "delay 50ms");
}

#[test]
fn a_wrong_line_is_refused_at_the_very_word() {
    for (line, expected) in [
        (
            "loose 20 %",
            "`loose`: found `loose`, expected a fault: `lose`, `violate`, `delay`, `jitter`, `duplicate`, `reorder`, `cut`, `part`, `stall`, `fail`, `crash`, `drift`; did you mean `lose`?",
        ),
        ("lose 120 %", "`120 %`: found `120 %`, expected a part from 0 % to 100 %, or from 0 to 1"),
        ("lose 20 on A", "`20`: found `20`, expected a part from 0 % to 100 %, or from 0 to 1; did you mean `20 %`?"),
        ("lose -1 %", "`-1 %`: found `-1 %`, expected a part of the messages such as `20 %`, from 0 % to 100 %"),
        ("lose NaN", "`NaN`: found `NaN`, expected a part of the messages such as `20 %`, from 0 % to 100 %"),
        ("lose", "``: found the end of the line, expected a part of the messages such as `20 %`"),
        ("delay 5", "`5`: "),
        ("delay 300ms to 50ms", "`50ms`: found `50ms`, expected the greater time second, as in `delay 50ms to 300ms`"),
        ("delay soon", "`soon`: found `soon`, expected a time such as `300ms` or `2s`"),
        ("for -2s lose 1 %", "`-2s`: found `-2s`, expected a time such as `300ms` or `2s`"),
        (
            "lose 1 % to A from B",
            "`from`: found `from`, expected the end of the line; the order is `on TOPIC from COMPONENTS to COMPONENTS`, each once",
        ),
        ("lose 1 % form A", "`form`: found `form`, expected the end of the line; did you mean `from`?"),
        (
            "lose 1 % from A,",
            "``: found the end of the line, expected a component such as `Robot2`, or several: `Robot*, World`",
        ),
        (
            "reorder 1 %",
            "``: found the end of the line, expected `by` and the time by which they come later at most, as in `by 200ms`",
        ),
        ("cut A", "``: found the end of the line, expected `from` and the components from which they are cut off"),
        (
            "stall A",
            "`stall`: found `stall` without how long it lasts; write `for` and a time before it, as in `for 2s stall ...`",
        ),
        (
            "for 2s crash A",
            "`for`: found `for` before `crash`, which happens once; remove it and its time; `crash` has the time to its `restart` behind it",
        ),
        (
            "drift A 90 %",
            "`90 %`: found `90 %`, expected by how much its clock is too fast, such as `2 %`, or too slow, such as `-2 %`, at most 50 %",
        ),
    ] {
        let found = read(line);
        assert!(if expected.ends_with(": ") { found != line } else { found == expected }, "{line}: {found}");
    }
}

#[test]
fn names_have_to_mean_something() {
    let ends = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
    let topic = |name: &str, writers: &[&str], readers: &[&str]| SubjectTopic {
        name: name.to_owned(),
        writers: ends(writers),
        readers: ends(readers),
    };
    let component = |path: &str, node: &str| SubjectComponent {
        path: path.to_owned(),
        node: node.to_owned(),
        is_periodic: path != "Broker",
    };
    let components = [("hall/Robot1", "gate-a"), ("hall/Robot2", "gate-b"), ("World", "control"), ("Broker", "router")];
    let subjects = FaultSubjects {
        components: components.map(|(path, node)| component(path, node)).to_vec(),
        topics: vec![
            topic("POSTOPIC", &["hall/Robot1", "hall/Robot2"], &["hall/Robot1", "hall/Robot2"]),
            topic("AREATOPIC", &["World"], &[]),
        ],
        is_complete: true,
    };
    let judge = |line: &str| {
        let judged = subjects.check(&FaultCall::read(line).unwrap());
        shown(line, judged.map(|()| "right".to_owned()))
    };
    for (line, expected) in [
        ("lose 1 %", "right"),
        ("lose 1 % on POS* from Robot1 to hall/*", "right"),
        ("part Robot1 from Robot2", "right"),
        ("crash World", "right"),
        ("crash @control restart 2s", "right"),
        ("part @gate-a from @gate-b", "right"),
        ("lose 1 % from @*", "right"),
        ("crash @gate-aa", "`@gate-aa`: the fleet has no node `gate-aa`; did you mean `@gate-a`?"),
        ("crash @floor", "`@floor`: the fleet has no node `floor`; it has `@control`, `@gate-a`, `@gate-b`, `@router`"),
        (
            "for 1s stall @router",
            "`@router`: all components of `@router` are passive: they have no executions; name the component that calls it",
        ),
        (
            "cut @gate-a from @gate-a",
            "`@gate-a`: no message takes this way, so the fault has no effect; `from` names components that publish a topic, `to` others that read it",
        ),
        (
            "lose 1 % on POSTOPIC from @control",
            "`@control`: node `control` publishes nothing on `POSTOPIC`; its publishers are `hall/Robot1`, `hall/Robot2`",
        ),
        ("crash Wrold", "`Wrold`: the fleet has no component `Wrold`; did you mean `World`?"),
        (
            "for 1s stall Broker",
            "`Broker`: component `Broker` is passive: it has no executions; name the component that calls it",
        ),
        ("lose 1 % on POSTOPICS", "`POSTOPICS`: the fleet has no topic `POSTOPICS`; did you mean `POSTOPIC`?"),
        (
            "cut Robot1 from World",
            "`World`: no message takes this way, so the fault has no effect; `from` names components that publish a topic, `to` others that read it",
        ),
        (
            "lose 1 % on POSTOPIC from World",
            "`World`: component `World` publishes nothing on `POSTOPIC`; its publishers are `hall/Robot1`, `hall/Robot2`",
        ),
        (
            "lose 1 % on POSTOPIC to World",
            "`World`: component `World` reads nothing on `POSTOPIC`; its readers are `hall/Robot1`, `hall/Robot2`",
        ),
        (
            "lose 1 % from Robot1 to Robot1",
            "`Robot1`: no message takes this way, so the fault has no effect; `from` names components that publish a topic, `to` others that read it",
        ),
    ] {
        assert_eq!(judge(line), expected, "{line}");
    }
    let mut one_program = subjects.clone();
    one_program.components.iter_mut().for_each(|one| one.node.clear());
    let line = "crash @floor";
    let judged = one_program.check(&FaultCall::read(line).unwrap());
    let expected = "`@floor`: the fleet has no node `floor`; no component has a `saoms:node`, and no other composite is on a network";
    assert_eq!(shown(line, judged.map(|()| "right".to_owned())), expected);
    let unknown = FaultSubjects::default();
    assert_eq!(unknown.check(&FaultCall::read("crash Anything").unwrap()), Ok(()));
}
