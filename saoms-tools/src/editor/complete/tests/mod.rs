mod beside;
mod ends;
mod fleets;
mod sources;

use super::*;
use crate::editor::testing::{composite, scene};

/// The labels of the proposals at the cursor, `|`, the likeliest first.
fn proposed(marked: &str) -> Vec<String> {
    proposed_among(marked, &[])
}

fn proposed_among(marked: &str, others: &[(&str, &str)]) -> Vec<String> {
    let (scene, at) = scene(marked, others);
    let mut all = complete(&scene, at);
    all.sort_by_key(Proposal::order);
    all.into_iter().map(|one| one.label).collect()
}

/// The text after the proposal of this label was taken at the cursor, in an editor that knows snippets or none.
fn taken(marked: &str, label: &str, knows_snippets: bool) -> String {
    let (scene, at) = scene(marked, &[]);
    let text = &scene.file().text;
    let found = complete(&scene, at).into_iter().find(|one| one.label == label).unwrap();
    let (new, _) = found.insert.text(knows_snippets);
    format!("{}{new}{}", &text[..found.range.start], &text[found.range.end..])
}

const ROBOT: &str = "<component name=\"R\"><implementation.rust class=\"saoms.Robot\"/>";
const WORLD: &str = "<component name=\"World\"><implementation.rust class=\"saoms.World\"/></component>";

#[test]
fn elements_are_those_that_can_stand_there() {
    assert_eq!(proposed("|"), ["composite"]);
    assert_eq!(proposed("<|"), ["composite"]);
    let top = ["component", "include", "property", "reference", "service", "wire"];
    assert_eq!(proposed(&composite("<|"))[..6], top);
    assert_eq!(proposed(&composite("|"))[..6], top);
    let inside = proposed(&composite("<component name=\"R\"><|"));
    assert_eq!(inside[..3], ["implementation.rust", "implementation.composite", "implementation.java"]);
    assert!(inside.contains(&"s:loop".to_owned()), "{inside:?}");
    // There is one implementation, and the class says what has to be given.
    let inside = proposed(&composite(&format!("{ROBOT}<|</component>")));
    assert_eq!(inside[..4], ["property ID", "property period", "property", "reference"]);
    assert!(!inside.iter().any(|label| label.starts_with("implementation.")));
    let inside = proposed(&composite(&format!("{ROBOT}<property name=\"ID\" value=\"R\"/><|</component>")));
    assert_eq!(inside[..2], ["property period", "property"]);
    assert_eq!(proposed(&composite("<component name=\"R\"><property name=\"p\"><|"))[0], "value");
    assert_eq!(proposed(&composite("<!-- <| -->")), [""; 0]);
}

#[test]
fn elements_keep_the_prefix_of_the_file() {
    let text = "<sca:composite xmlns:sca=\"http://www.osoa.org/xmlns/sca/1.0\" name=\"f\"><sca:|</sca:composite>";
    assert_eq!(proposed(text)[..2], ["sca:component", "sca:include"]);
}

#[test]
fn what_is_taken_fits_into_the_text() {
    let top = |inside: &str| format!("<composite name=\"f\">{inside}</composite>");
    let plain = |marked: &str, label: &str| taken(&top(marked), label, false);
    assert_eq!(plain("<wi|", "wire"), top("<wire source=\"\" target=\"\"/>"));
    assert_eq!(taken(&top("<wi|"), "wire", true), top("<wire source=\"$1\" target=\"$2\"/>"));
    assert_eq!(plain("<w|ire source=\"a\"/>", "include"), top("<include source=\"a\"/>"));
    assert_eq!(plain("<wire so|/>", "target"), top("<wire target=\"\"/>"));
    assert_eq!(plain("<wire so|=\"a\"/>", "target"), top("<wire target=\"a\"/>"));
    assert_eq!(plain("<component name=\"R\"></|", "component"), top("<component name=\"R\"></component>"));
    assert_eq!(plain("<component name=\"R\"></|>", "component"), top("<component name=\"R\"></component>"));
    let class = "<component name=\"R\"><implementation.rust class=\"";
    assert_eq!(plain(&format!("{class}sao|"), "saoms.Robot"), top(&format!("{class}saoms.Robot")));
    assert_eq!(plain(&format!("{class}sao|ms\"/>"), "saoms.Robot"), top(&format!("{class}saoms.Robot\"/>")));
    let period = format!("{ROBOT}<property name=\"period\">1|00</property>");
    let expected = format!("{ROBOT}<property name=\"period\">1ms</property>");
    assert_eq!(plain(&period, "1ms"), top(&expected));
}

#[test]
fn attributes_are_those_that_are_missing() {
    assert_eq!(
        proposed(&composite("<component |")),
        [
            "name", "autowire", "policySets", "requires", "s:count", "s:from", "s:if", "s:node", "s:overrides",
            "s:path", "s:site"
        ]
    );
    let left = proposed(&composite("<component name=\"R\" |/>"));
    assert!(!left.contains(&"name".to_owned()), "{left:?}");
    assert_eq!(proposed(&composite("<wire source=\"a\" tar|"))[0], "target");
    assert_eq!(proposed(&composite("<wire source=\"a\"|/>")), [""; 0]);
}

#[test]
fn values_of_attributes_are_those_of_their_kind() {
    assert_eq!(proposed(&composite("<component autowire=\"|\"/>")), ["true", "false"]);
    let reference = "<component name=\"R\"><reference name=\"r\" multiplicity='|'";
    assert_eq!(proposed(&composite(reference)), ["0..1", "1..1", "0..n", "1..n"]);
    let classes = proposed(&composite("<component name=\"a\"><implementation.rust class=\"|"));
    assert!(classes.contains(&"saoms.World".to_owned()), "{classes:?}");
    let names = |rest: &str| proposed(&composite(&format!("{ROBOT}{rest}")));
    let properties = names("<property name=\"|");
    assert_eq!(properties[..2], ["ID", "period"]);
    assert!(properties.contains(&"topicRename".to_owned()));
    assert!(!names("<property name=\"ID\">R</property><property name=\"|\"/>").contains(&"ID".to_owned()));
    // The one at the cursor can be written again.
    assert_eq!(names("<property name=\"per|iod\"/>")[1], "period");
    assert_eq!(names("<reference name=\"|\""), ["world"]);
    assert_eq!(names("<service name=\"|\""), ["operator", "TaskInterface"]);
    assert_eq!(names("<reference name=\"world\"><interface.java interface=\"|")[0], "saoms.Hardware");
    let levels = proposed(&composite("<s:severity code=\"S4001\" level=\"|\"/>"));
    assert!(levels.contains(&"warning".to_owned()), "{levels:?}");
    let codes = proposed(&composite("<s:severity code=\"|"));
    assert!(["S4001", "S5001"].iter().all(|code| codes.contains(&(*code).to_owned())), "{codes:?}");
    assert_eq!(proposed("<composite xmlns=\"|\"/>")[0], "http://docs.oasis-open.org/ns/opencsa/sca/200912");
}

#[test]
fn values_of_properties_are_as_the_class_declares_them() {
    let values = |name: &str, typed: &str| {
        let as_text = proposed(&composite(&format!("{ROBOT}<property name=\"{name}\">{typed}|</property>")));
        let as_value = proposed(&composite(&format!("{ROBOT}<property name=\"{name}\" value=\"{typed}|\"/>")));
        let as_element =
            proposed(&composite(&format!("{ROBOT}<property name=\"{name}\"><value>{typed}|</value></property>")));
        assert_eq!(as_text, as_value, "{name}");
        assert_eq!(as_text, as_element, "{name}");
        as_text
    };
    assert_eq!(values("asleep", ""), ["false", "true"]);
    assert_eq!(values("policy", "cl"), ["safe", "classic"]);
    assert_eq!(values("overrun", ""), ["skip", "catchUp", "stop"]);
    assert_eq!(values("period", ""), ["100us", "24h"]);
    // Only what the range allows.
    assert_eq!(values("period", "5"), ["5ms", "5s", "5min", "5h", "100us", "24h"]);
    assert_eq!(values("battery", ""), ["100.0", "0.0"]);
    assert_eq!(values("ID", ""), ["R"]);
    assert_eq!(values("nonsense", ""), [""; 0]);
}

#[test]
fn sources_are_properties_of_the_composite() {
    let properties = "<property name=\"period\">100</property><property name=\"robots\" value=\"3\"/>";
    let source = format!("{properties}{ROBOT}<property name=\"period\" source=\"|\"/></component>");
    assert_eq!(proposed(&composite(&source)), ["$period", "$robots"]);
    let count = format!("{properties}<component name=\"R\" s:count=\"2 * ro|\"/>");
    assert_eq!(proposed(&composite(&count)), ["period", "robots"]);
}

#[test]
fn topics_are_those_of_the_class_and_of_the_fleet() {
    let other = "<component name=\"O\"><implementation.rust class=\"saoms.Robot\"/><property name=\"topicRename\">COLLISIONTOPIC,quietü</property></component>";
    let topics =
        |value: &str| proposed(&composite(&format!("{other}{ROBOT}<property name=\"topicRename\">{value}</property>")));
    let own = topics("|");
    assert!(own.contains(&"COLLISIONTOPIC".to_owned()) && !own.contains(&"quietü".to_owned()), "{own:?}");
    assert_eq!(topics("COLLISIONTOPIC,x::|"), own);
    assert!(topics("COLLISIONTOPIC, |").contains(&"quietü".to_owned()));
    let list = format!("{ROBOT}<property name=\"topicRename\">A,b::COLL|,c</property>");
    assert_eq!(taken(&composite(&list), "COLLISIONTOPIC", false), composite(&list.replace("COLL|", "COLLISIONTOPIC")));
}

#[test]
fn loops_are_those_of_the_class_and_those_that_fit_it() {
    let loops = |rest: &str| proposed(&composite(&format!("{ROBOT}{rest}</component>")));
    let own = loops("<s:loop name=\"|\"/>");
    assert!(own.contains(&"BatteryMS".to_owned()), "{own:?}");
    let names: std::collections::BTreeSet<&String> = own.iter().collect();
    assert_eq!(names.len(), own.len(), "each once: {own:?}");
    // Those of the list that the component has, and those that nothing is said about yet.
    let classic = loops("<property name=\"policy\">classic</property><s:loop name=\"|\"/>");
    assert!(classic != own && !classic.is_empty(), "{classic:?}");
    let set = "<property name=\"p\" value=\"classic\"/>";
    let sourced = format!("{set}{ROBOT}<property name=\"policy\" source=\"$p\"/><s:loop name=\"|\"/></component>");
    assert_eq!(proposed(&composite(&sourced)), classic);
    assert!(!loops("<s:loop name=\"BatteryMS\"/><s:loop name=\"|\"/>").contains(&"BatteryMS".to_owned()));
    let after = loops("<s:loop name=\"new\" class=\"x.Y\"/><s:loop name=\"BatteryMS\" after=\"|\"/>");
    assert!(after.contains(&"new".to_owned()) && !after.contains(&"BatteryMS".to_owned()), "{after:?}");
    assert!(loops("<s:loop name=\"x\" class=\"|\"/>")[0].starts_with("saoms."));
    assert!(loops("<s:loop name=\"BatteryMS\"><property name=\"|\"/></s:loop>").len() < 10);
}

#[test]
fn composites_of_other_files_are_known() {
    let inner = "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"inner\" targetNamespace=\"urn:f\">\
        <property name=\"size\"/><service name=\"lamp\" promote=\"L\"/><reference name=\"power\" promote=\"L/p\"/>\
        <component name=\"L\"/></composite>";
    let others =
        [("inner.composite", inner), ("else.composite", "<composite name=\"else\" targetNamespace=\"urn:e\"/>")];
    let among = |inside: &str| proposed_among(&composite(inside), &others);
    // Without a prefix a name is of the default namespace, so that prefixes are declared.
    assert_eq!(among("<include name=\"|\"/>"), ["tns:inner", "e:else"]);
    assert_eq!(among("<include xmlns=\"urn:e\" name=\"|\"/>"), ["else", "tns:inner"]);
    let (scene, at) = scene(&composite("<include name=\"|\"/>"), &others);
    let found = complete(&scene, at).into_iter().find(|one| one.label == "e:else").unwrap();
    assert_eq!(found.also.unwrap().text, " xmlns:e=\"urn:e\"");
    assert_eq!(among("<include xmlns:e=\"urn:e\" name=\"|\"/>"), ["e:else", "tns:inner"]);
    let uses = "<component name=\"I\"><implementation.composite name=\"inner\"/>";
    assert_eq!(among(&format!("{uses}<property name=\"|\"/>")), ["size"]);
    assert_eq!(among(&format!("{uses}<reference name=\"|\"/>")), ["power"]);
    assert_eq!(among(&format!("{uses}</component><wire source=\"x\" target=\"I/|\"/>")), ["lamp"]);
    // What an include brings can be wired.
    assert_eq!(among("<include name=\"inner\"/><wire source=\"|\"/>"), ["L"]);
}

#[test]
fn what_is_typed_is_looked_for_in_the_labels() {
    let one = Proposal::new("property Period-Ä", ProposalKind::Value, &(0..0));
    for typed in ["", "<", "<pper", "PERIOD", "period-ä", "-"] {
        assert!(one.clone().matching(typed).is_some(), "{typed}");
    }
    for typed in ["x", "<doirep", "period--"] {
        assert!(one.clone().matching(typed).is_none(), "{typed}");
    }
    // What begins so comes before what holds it, and that before what has its letters.
    let labels = ["chargeX", "moreRest", "restart", "saoms.Restless"];
    let one = |label: &str| Proposal::new(label, ProposalKind::Value, &(0..0)).matching("re");
    let mut all: Vec<Proposal> = labels.into_iter().filter_map(one).collect();
    all.sort_by_key(Proposal::order);
    let sorted: Vec<&str> = all.iter().map(|one| one.label.as_str()).collect();
    assert_eq!(sorted, ["restart", "saoms.Restless", "moreRest", "chargeX"]);
}

#[test]
fn behind_an_ampersand_stands_a_character() {
    let all = ["&amp;", "&apos;", "&gt;", "&lt;", "&quot;"];
    let scenario = format!("{ROBOT}<property name=\"ID\">R&|</property></component>");
    assert_eq!(proposed(&composite(&scenario)), all);
    assert_eq!(proposed(&composite("<wire s:if=\"1 &l| 2\"/>")), all);
    assert_eq!(taken("<a b=\"1 &l|t; 2\"/>", "&lt;", true), "<a b=\"1 &lt; 2\"/>");
    assert!(proposed(&composite("<!-- R & D &| -->")).is_empty());
}

#[test]
fn classes_of_small_packages_come_first() {
    let class = proposed(&composite("<component name=\"R\"><implementation.rust class=\"|\"/></component>"));
    let first = class.iter().position(|one| one.starts_with("saoms.")).unwrap();
    let other = class.iter().position(|one| one.starts_with("resources.")).unwrap();
    assert!(first < other, "{class:?}");
}
