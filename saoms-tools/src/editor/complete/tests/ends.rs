//! Ends of wires.

use super::*;

const GPS: &str = "<component name=\"GPS\"><implementation.java class=\"resources.robotEnvironment.GPS\"/></component>";

#[test]
fn ends_are_components_and_their_parts() {
    let ends = |inside: &str| proposed(&composite(&format!("{WORLD}{inside}")));
    // What offers the interface, or may; what calls itself is a mistake.
    assert_eq!(
        ends(&format!("<component name=\"A\"/>{GPS}{ROBOT}<reference name=\"world\" target=\"|\"/>")),
        ["A", "World"]
    );
    assert_eq!(ends(&format!("{ROBOT}<reference name=\"world\" target=\"|\"/></component>")), ["World"]);
    let bound = format!("{ROBOT}<reference name=\"world\"><binding.sca uri=\"|\"/></reference></component>");
    assert_eq!(ends(&bound), ["World"]);
    let worlds = "<component name=\"W${index}\" s:count=\"2\"><implementation.rust class=\"saoms.World\"/></component>";
    for name in ["W*", "W2", "W${index}"] {
        let of = ends(&format!("{worlds}{ROBOT}<reference name=\"world\" target=\"{name}/|\"/></component>"));
        assert_eq!(of, ["hardware"], "{name}");
    }
    // Any service will do while its caller is unknown.
    assert_eq!(ends("<wire target=\"World/|\"/>"), ["hardware", "TaskInterface"]);
    let services = ends(&format!("{ROBOT}<reference name=\"world\" target=\"World/|\"/></component>"));
    assert_eq!(services, ["hardware"], "the others have another interface");
    assert_eq!(ends(&format!("{ROBOT}<reference name=\"world\" target=\"World/|")), ["hardware"], "unclosed");
    assert_eq!(ends(&format!("{ROBOT}</component><wire source=\"R/|\" target=\"\"/>")), ["world"]);
    assert_eq!(ends(&format!("{ROBOT}</component><wire source=\"R/world\" target=\"|\"/>"))[0], "World");
    assert_eq!(ends(&format!("{ROBOT}</component><reference name=\"r\" promote=\"R/|\"/>")), ["world"]);
    assert_eq!(
        ends(&format!("{ROBOT}</component><service name=\"s\" promote=\"R/|\"/>")),
        ["operator", "TaskInterface"]
    );
    // The word of a list at the cursor is replaced, not the others.
    let list = format!("{WORLD}{ROBOT}<reference name=\"world\" target=\"World W|orl R\"/></component>");
    let expected = list.replace("W|orl", "World");
    assert_eq!(taken(&composite(&list), "World", false), composite(&expected));
}

#[test]
fn what_lacks_what_is_asked_for_is_no_end() {
    let ends = |inside: &str| proposed(&composite(&format!("{WORLD}{GPS}{ROBOT}</component>{inside}")));
    // Neither a world nor a GPS calls anybody.
    assert_eq!(ends("<wire source=\"|\"/>"), ["R/world"]);
    assert_eq!(ends("<wire source=\"World/|\"/>"), [""; 0]);
    assert_eq!(ends("<reference name=\"r\" promote=\"|\"/>"), ["R/world"]);
    assert_eq!(ends("<wire source=\"R/world\" target=\"|\"/>"), ["World"]);
    let all = ends("<service name=\"s\" promote=\"|\"/>");
    assert!(all.contains(&"World".to_owned()) && all.contains(&"R".to_owned()), "{all:?}");
    // What nothing is known of may be meant.
    assert_eq!(
        ends(
            "<component name=\"X\"><implementation.java class=\"x.Y\"/></component><wire source=\"R/world\" target=\"|\"/>"
        ),
        ["World", "X"]
    );
}

#[test]
fn replicas_are_named_as_the_place_allows() {
    let worlds = "<component name=\"W${index:02}\" s:from=\"7\" s:count=\"2\"><implementation.rust class=\"saoms.World\"/></component>";
    let robots = ROBOT.replace("\"R\"", "\"R${index}\" s:count=\"2\"");
    let ends = |inside: &str| proposed(&composite(&format!("{worlds}{inside}")));
    // A robot has one world. A replica can name that of its own index, others only one by its name.
    assert_eq!(ends(&format!("{ROBOT}<reference name=\"world\" target=\"|\"/></component>")), ["W07"]);
    assert_eq!(ends(&format!("{robots}<reference name=\"world\" target=\"|\"/>")), ["W${index:02}"]);
    let robots = format!("{robots}</component>");
    assert_eq!(ends(&format!("{robots}<wire source=\"R*/world\" target=\"|\"/>")), ["W07"]);
    // Wires and promotions have no index; several can be promoted by a reference and begin wires.
    assert_eq!(ends(&format!("{robots}<wire source=\"|\" target=\"W07\"/>")), ["R*/world"]);
    assert_eq!(ends(&format!("{robots}<reference name=\"r\" promote=\"|\"/>")), ["R*/world"]);
    assert_eq!(ends(&format!("{robots}<service name=\"s\" promote=\"|\"/>")), ["R1", "W07"]);
    // Who calls is not known yet.
    let own = format!("{robots}<component name=\"X${{index}}\" s:count=\"2\"><reference name=\"x\" target=\"|\"/>");
    let all = ends(&own);
    assert!(["R*", "R${index}", "W*", "W${index:02}"].iter().all(|one| all.contains(&(*one).to_owned())), "{all:?}");
    // Where the first depends on what is set, none is known.
    let open = worlds.replace("\"7\"", "\"first\"");
    assert_eq!(
        proposed(&composite(&format!("{open}{ROBOT}<reference name=\"world\" target=\"|\"/></component>"))),
        [""; 0]
    );
}

/// A composite around another one, whose reference `power` is promoted from a robot in it.
const OUTER: &str = r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="outer" targetNamespace="urn:f">
<component name="Site"><implementation.rust class="saoms.World"/></component>
<component name="Inner"><implementation.composite name="fleet"/></component>
<component name="Gps"><implementation.java class="resources.robotEnvironment.GPS"/></component></composite>"#;

#[test]
fn references_of_a_composite_target_what_is_around_it() {
    let others = [("outer.composite", OUTER)];
    let reference = |target: &str| {
        composite(&format!(
            "{WORLD}{ROBOT}</component><reference name=\"power\" promote=\"R/world\" target=\"{target}\"/>"
        ))
    };
    assert_eq!(proposed_among(&reference("|"), &others), ["Site"]);
    assert_eq!(proposed_among(&reference("Site/|"), &others), ["hardware"]);
    // Nobody uses it: nothing is around it.
    assert_eq!(proposed(&reference("|")), [""; 0]);
}

#[test]
fn parts_of_composites_have_the_interfaces_of_what_they_promote() {
    let inner = |inside: &str| {
        composite(&format!("{WORLD}{ROBOT}</component>{inside}")).replace("name=\"fleet\"", "name=\"inner\"")
    };
    let among = |inside: &str, text: &str| {
        let uses = "<component name=\"I\"><implementation.composite name=\"inner\"/>";
        proposed_among(&composite(&format!("{uses}{text}")), &[("inner.composite", &inner(inside))])
    };
    let services = "<service name=\"ground\" promote=\"World/Hardware\"/><service name=\"task\" promote=\"World/TaskInterface\"/><service name=\"floor\" promote=\"World\"/>";
    let calls = format!("</component>{}", ROBOT.replace("\"R\"", "\"Q\""));
    let target =
        |typed: &str| among(services, &format!("{calls}<reference name=\"world\" target=\"{typed}\"/></component>"));
    assert_eq!(target("I/|"), ["floor", "ground"]);
    // One of several has to be named.
    assert_eq!(target("|"), ["I/floor", "I/ground"]);
    let world = "<reference name=\"power\" promote=\"R/world\"/>";
    let wired = format!("<reference name=\"power\" target=\"|\"/></component>{WORLD}{GPS}");
    assert_eq!(among(world, &wired), ["World"]);
}
