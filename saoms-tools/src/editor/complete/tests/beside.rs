//! Files beside composites: tables, scenarios, descriptions of contributions.

use super::*;
use crate::editor::hover::hover;
use crate::editor::testing::scene_in;

/// The proposals at the cursor of a file of this name beside a composite.
fn inside(name: &str, marked: &str, composites: &[(&str, &str)]) -> Vec<String> {
    let (scene, at) = scene_in(name, marked, composites);
    let mut all = complete(&scene, at);
    all.sort_by_key(Proposal::order);
    all.into_iter().map(|one| one.label).collect()
}

#[test]
fn columns_of_tables_are_properties_and_their_cells_values() {
    let fleet = composite(
        "<property name=\"bots\">3</property><component name=\"R${index:02}\" s:count=\"bots\" s:from=\"2\" s:overrides=\"r.csv\"><implementation.rust class=\"saoms.Robot\"/></component>",
    );
    let table = |marked: &str| inside("r.csv", marked, &[("fleet.composite", &fleet)]);
    assert_eq!(table("|"), ["index", "name"]);
    let columns = table("index,battery,|");
    assert!(columns.contains(&"policy".to_owned()) && !columns.contains(&"battery".to_owned()), "{columns:?}");
    assert!(table("index,bat|tery\n").contains(&"battery".to_owned()), "the one at the cursor can be written again");
    // What the lines are about: replicas without a line.
    assert_eq!(table("index,battery\n|"), ["2", "3", "4"]);
    assert_eq!(table("index,battery\n3,50\n|"), ["2", "4"]);
    assert_eq!(table("\u{feff}name,battery\r\n\"R02\",50\r\n|,3"), ["R03", "R04"]);
    assert_eq!(table("index,asleep,policy\n2,|"), ["false", "true"]);
    assert_eq!(table("index,asleep,policy\n2,true,\"|\""), ["safe", "classic"]);
    assert_eq!(table("index,nonsense\n2,|"), [""; 0]);
    assert_eq!(table("index,battery\n2,3,|"), [""; 0]);
    // Nobody takes values from it.
    assert_eq!(inside("other.csv", "|", &[("fleet.composite", &fleet)]), [""; 0]);
}

#[test]
fn columns_of_composites_are_their_properties() {
    let hall = "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"hall\" targetNamespace=\"urn:f\"><property name=\"lit\" type=\"xsd:boolean\"/></composite>";
    let fleet = composite(
        "<component name=\"H${index}\" s:count=\"2\" s:overrides=\"h.csv\"><implementation.composite name=\"hall\"/></component>",
    );
    let all = [("fleet.composite", fleet.as_str()), ("hall.composite", hall)];
    assert_eq!(inside("h.csv", "name,|", &all), ["lit"]);
    assert_eq!(
        inside("h.csv", "name,lit\nH1,|", &all),
        ["false", "true"].map(String::from).iter().rev().cloned().collect::<Vec<_>>()
    );
}

const ENVIRONMENT: &str = "<component name=\"Robot${index:02}\" s:count=\"2\"><implementation.rust class=\"saoms.Robot\"/></component><component name=\"E\"><implementation.rust class=\"launch.Environment\"/><property name=\"scenario\"";

#[test]
fn scenarios_complete_word_by_word() {
    let outer = composite(&format!("{ENVIRONMENT} file=\"s.txt\"/></component>"));
    let both = |marked: &str| {
        let written = inside("s.txt", marked, &[("fleet.composite", &outer)]);
        let own = proposed(&composite(&format!("{ENVIRONMENT}>{marked}</property></component>")));
        assert_eq!(written, own, "{marked}");
        own
    };
    assert_eq!(both("|"), ["at", "from", "then"]);
    assert_eq!(both("at 1s end\n|"), ["at", "from", "then"]);
    assert_eq!(both("at 1s end; |"), ["at", "from", "then"]);
    assert_eq!(both("at 3|"), ["3ms", "3s", "3us", "3min", "3h", "3ns"]);
    assert_eq!(both("at 0.5|")[0], "0.5ms");
    assert_eq!(both("at 2s..8|")[1], "8s");
    assert_eq!(both("from 1s |"), ["every"]);
    assert_eq!(both("at 1s |")[..6], ["luggage", "visit", "landing", "takeoff", "breakdown", "gone"]);
    assert!(both("at 1s |").contains(&"end".to_owned()));
    assert!(both("at 1s 10|").contains(&"10 times".to_owned()));
    assert_eq!(both("at 1s luggage |"), ["(0,0)", "random"]);
    assert_eq!(both("at 1s luggage (1, |"), ["(0,0)", "random"]);
    assert_eq!(both("at 1s luggage random |"), ["to"]);
    assert_eq!(both("at 1s breakdown |"), ["Robot01"]);
    assert_eq!(both("at 1s gone |"), ["Robot01"]);
    let faults = both("at 1s |");
    assert!(["for", "lose", "crash", "drift", "slow", "drain"].iter().all(|word| faults.iter().any(|one| one == word)));
    assert_eq!(both("at 1s for 2|")[1], "2s");
    assert_eq!(both("at 1s for 2s lose |"), ["10 %"]);
    assert_eq!(both("at 1s for 2s lose 20 % |"), ["on", "from", "to"]);
    assert_eq!(both("at 1s reorder 20 % |"), ["by"]);
    assert_eq!(both("at 1s lose 20 % from |"), ["E", "Robot01"]);
    assert_eq!(both("at 1s crash E |"), ["restart"]);
    assert_eq!(both("at 1s cut E from |"), ["E", "Robot01"]);
    assert_eq!(both("at 1s end # |"), [""; 0]);
    // The word at the cursor is replaced, and nothing else.
    let taken = |label: &str, marked: &str| {
        let (scene, at) = scene_in("s.txt", marked, &[("fleet.composite", &outer)]);
        let found = complete(&scene, at).into_iter().find(|one| one.label == label).unwrap();
        scene.file().text[found.range].to_owned()
    };
    assert_eq!(taken("luggage", "at 1s lu|gg (1,2) to random; at 2s end"), "lugg");
    assert_eq!(taken("(0,0)", "at 1s luggage (1, |2) to random"), "(1, 2)");
    assert_eq!(taken("8s", "at 2s..8| end"), "8");
}

#[test]
fn a_scenario_completes_wherever_its_text_is_written() {
    let environment = |given: &str| {
        format!(
            "<component name=\"Robot1\"><implementation.rust class=\"saoms.Robot\"/></component><component name=\"E\">\
             <implementation.rust class=\"saoms.Environment\"/><property name=\"scenario\" {given}/></component>"
        )
    };
    let words = ["luggage", "visit", "landing", "takeoff", "breakdown", "gone"];
    let begins = |found: Vec<String>| assert_eq!(found[..6], words);
    let robots = |found: Vec<String>| assert_eq!(found, ["Robot1"]);
    // In the property that the environment takes it from, in each way of writing a value.
    let own = |property: &str| proposed(&composite(&format!("{property}{}", environment("source=\"$x\""))));
    begins(own("<property name=\"x\">at 1s |</property>"));
    begins(own("<property name=\"x\"><value>at 1s |</value></property>"));
    begins(own("<property name=\"x\" value=\"at 1s |\"/>"));
    robots(own("<property name=\"x\">at 1s breakdown |</property>"));
    // A part of a value is no scenario.
    let part =
        proposed(&composite(&format!("<property name=\"x\">at 1s |</property>{}", environment("source=\"$x/y\""))));
    assert!(!part.contains(&words[0].to_owned()), "{part:?}");
    // In the file that the property names.
    let outer = composite(&format!("<property name=\"x\" file=\"s.txt\"/>{}", environment("source=\"$x\"")));
    begins(inside("s.txt", "at 1s |", &[("fleet.composite", &outer)]));
    // In what a component gives the composite that has the environment, through a composite between.
    let inner = |name: &str, content: &str| composite(content).replace("\"fleet\"", &format!("\"{name}\""));
    let deepest = inner("deepest", &format!("<property name=\"x\"/>{}", environment("source=\"$x\"")));
    let middle = inner(
        "middle",
        "<property name=\"y\"/><component name=\"D\"><implementation.composite name=\"deepest\"/><property name=\"x\" source=\"$y\"/></component>",
    );
    let given = |how: &str| {
        composite(&format!(
            "<component name=\"M\"><implementation.composite name=\"middle\"/><property name=\"y\"{how}</component>"
        ))
    };
    let others = [("deepest.composite", deepest.as_str()), ("middle.composite", middle.as_str())];
    begins(proposed_among(&given(">at 1s |</property>"), &others));
    robots(proposed_among(&given(" value=\"at 1s breakdown |\"/>"), &others));
    let outer = given(" file=\"s.txt\"/>");
    let mut all = others.to_vec();
    all.push(("fleet.composite", &outer));
    begins(inside("s.txt", "at 1s |", &all));
    // In a file that includes the composite with the environment, and in a cell of a table.
    let including = composite("<include name=\"deepest\"/><property name=\"x\">at 1s |</property>");
    let included = deepest.replace("<property name=\"x\"/>", "");
    begins(proposed_among(&including, &[("deepest.composite", &included)]));
    let table =
        composite(&environment("").replace("name=\"E\"", "name=\"E${index}\" s:count=\"2\" s:overrides=\"t.csv\""));
    begins(inside("t.csv", "index,scenario\n1,\"at 1s |\"", &[("fleet.composite", &table)]));
}

#[test]
fn descriptions_of_contributions_complete() {
    let other = "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"other\" targetNamespace=\"urn:example:harbour\"/>";
    let fleet = composite("");
    let all = [("fleet.composite", fleet.as_str()), ("other.composite", other)];
    let description = |marked: &str| {
        let marked = format!(
            "<contribution xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:f=\"urn:f\">{marked}</contribution>"
        );
        inside("sca-contribution.xml", &marked, &all)
    };
    assert_eq!(inside("sca-contribution.xml", "<|", &all), ["contribution"]);
    let elements = description("<|");
    assert_eq!(elements[0], "deployable");
    assert!(["import", "export.java"].iter().all(|one| elements.contains(&(*one).to_owned())), "{elements:?}");
    assert_eq!(description("<deployable |/>"), ["composite"]);
    assert_eq!(description("<deployable composite=\"|\"/>"), ["f:fleet", "harbour:other"]);
    assert_eq!(description("<deployable composite=\"f:fleet\"/><deployable composite=\"|\"/>"), ["harbour:other"]);
    assert_eq!(description("<export namespace=\"|\"/>"), ["urn:example:harbour", "urn:f"]);
    let marked = "<contribution xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\"><deplo|yable composite=\"x\"/></contribution>";
    let (scene, at) = scene_in("sca-contribution.xml", marked, &all);
    assert!(hover(&scene, at).unwrap().0.contains("runs by itself"));
}
