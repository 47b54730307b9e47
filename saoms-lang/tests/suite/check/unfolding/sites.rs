//! Sites: topics, IDs and tables of composites that are used several times.

use std::fs;

use expect_test::expect;
use saoms_lang::assembly::Traffic;
use saoms_lang::project::Project;
use saoms_tools::diagnostics::human_of;

use crate::check::classes::registry;
use crate::check::support::{nested, outcome, part, told};

/// A composite with two robots, whose attributes and values are these.
fn hall(attributes: &str, values: &str) -> String {
    let robot = format!(
        r#"<component name="Robot${{index}}" saoms:count="2" {attributes}><implementation.java class="example.Robot001"/>
<property name="ID">Robot${{index}}</property><property name="period">1s</property>{values}</component>"#
    );
    part("hall", "xmlns:saoms=\"urn:saoms:1\"", &robot)
}

/// A composite with these inside.
fn around(name: &str, inside: &str) -> String {
    part(name, "xmlns:saoms=\"urn:saoms:1\"", inside)
}

/// A component that this composite implements, in a site.
fn site(name: &str, of: &str) -> String {
    format!(
        "<component name=\"{name}\" saoms:site=\"{name}\"><implementation.composite name=\"t:{of}\"/></component>\n"
    )
}

/// Diagnostics, and the topics of the fleet with their readers.
fn topics(texts: &[&str]) -> String {
    let (assembly, diagnostics, sources) = nested(texts, &[], false);
    let mut out = told(&diagnostics, &sources);
    let Some(assembly) = assembly else { return out };
    for topic in Traffic::of(&assembly).topics {
        let path = |end: &saoms_lang::assembly::TopicEnd| assembly.components[end.component()].path.as_str();
        let readers: Vec<&str> = topic.readers.iter().map(path).collect();
        out.push_str(&format!("{} [{}]: {}\n", topic.name, topic.site, readers.join(" ")));
    }
    out
}

#[test]
fn each_site_has_its_own_topics_and_its_own_ids() {
    let fleet = around("fleet", &(site("North", "hall") + &site("South", "hall")));
    expect![[r#"
        North/ORDERS [North]: North/Robot1 North/Robot2
        North/POSTOPIC [North]: North/Robot1 North/Robot2
        South/ORDERS [South]: South/Robot1 South/Robot2
        South/POSTOPIC [South]: South/Robot1 South/Robot2
    "#]]
    .assert_eq(&topics(&[&fleet, &hall("", "")]));
    // Without sites both halls are one.
    let fleet = fleet.replace("saoms:site=\"South\"", "").replace("saoms:site=\"North\"", "");
    let found = topics(&[&fleet, &hall("", "")]);
    assert!(found.contains("in one site, and both have a component `Robot1`"), "{found}");
    assert_eq!(found.matches("error ").count(), 1, "{found}");
}

#[test]
fn ids_have_to_differ_within_a_site() {
    let inside = r#"<component name="A" saoms:site="North"><implementation.java class="example.Robot001"/><property name="ID">R1</property><property name="period">1s</property></component>
<component name="B" saoms:site="North"><implementation.java class="example.Robot001"/><property name="ID">R1</property><property name="period">1s</property></component>
<component name="C" saoms:site="South"><implementation.java class="example.Robot001"/><property name="ID">R1</property><property name="period">1s</property></component>"#;
    expect![[r#"
        3:107-109 error S3013: components `A` and `B` have the same `ID` `R1`
          2:107-109 the first
          help: give every robot its own `ID`
    "#]]
    .assert_eq(&outcome(&[&around("fleet", inside)], &[]));
}

#[test]
fn sites_in_sites_and_new_names_of_topics() {
    let plant = around("plant", &(site("North", "hall") + &site("South", "hall")));
    let fleet = around("fleet", &site("Plant", "plant"));
    let renamed = hall("", "<property name=\"topicRename\">POSTOPIC,pos::ORDERS,/orders</property>");
    expect![[r#"
        Plant/North/pos [Plant/North]: Plant/North/Robot1 Plant/North/Robot2
        Plant/South/pos [Plant/South]: Plant/South/Robot1 Plant/South/Robot2
        orders []: Plant/North/Robot1 Plant/North/Robot2 Plant/South/Robot1 Plant/South/Robot2
    "#]]
    .assert_eq(&topics(&[&fleet, &plant, &renamed]));
}

#[test]
fn a_site_may_come_from_an_index_or_a_property() {
    let count = "<component name=\"Hall${index}\" saoms:count=\"2\" saoms:site=\"Hall${index}\"><implementation.composite name=\"t:hall\"/></component>";
    let found = topics(&[&around("fleet", count), &hall("", "")]);
    assert!(found.contains("Hall1/POSTOPIC [Hall1]") && found.contains("Hall2/POSTOPIC [Hall2]"), "{found}");
    let named = r#"<property name="where">East</property>
<component name="Hall" saoms:site="${where}"><implementation.composite name="t:hall"/></component>"#;
    let found = topics(&[&around("fleet", named), &hall("", "")]);
    assert!(found.contains("East/POSTOPIC [East]"), "{found}");
}

#[test]
fn a_name_of_a_site_has_no_blanks_and_no_empty_parts() {
    for (written, wrong) in
        [("North hall", "North hall"), ("/North", "/North"), ("a//b", "a//b"), ("a:b", "a:b"), ("$site", "$site")]
    {
        let fleet =
            around("fleet", &site("N", "hall").replace("saoms:site=\"N\"", &format!("saoms:site=\"{written}\"")));
        let found = topics(&[&fleet, &hall("", "")]);
        assert!(found.contains(&format!("error S1011: `{wrong}` is not a site name")), "{found}");
    }
    let fleet = around("fleet", &site("N", "hall").replace("saoms:site=\"N\"", "saoms:site=\"${nowhere}\""));
    expect![[r#"
        2:35-42 error S2045: the composite has no property `nowhere`
          help: declare it: `<property name="...">...</property>` in the composite
    "#]]
    .assert_eq(&topics(&[&fleet, &hall("", "")]));
}

#[test]
fn a_name_of_a_topic_has_no_empty_parts() {
    let fleet = around("fleet", &site("N", "hall"));
    for name in ["/", "//", "//all", "/all//positions", "all/", "a//b"] {
        let renamed = hall("", &format!("<property name=\"topicRename\">POSTOPIC,{name}</property>"));
        let found = topics(&[&fleet, &renamed]);
        assert!(found.contains(&format!("S4002: property `topicRename`: `{name}` is not a topic name")), "{found}");
    }
}

#[test]
fn types_of_topics_are_compared_within_a_site() {
    let other = around(
        "other",
        "<component name=\"S\"><implementation.java class=\"example.Shouter\"/><property name=\"ID\">S</property><property name=\"period\">1s</property></component>",
    );
    let fleet = around("fleet", &(site("North", "hall") + &site("South", "other")));
    assert!(!topics(&[&fleet, &hall("", ""), &other]).contains("error"));
    let together = fleet.replace("saoms:site=\"South\"", "saoms:site=\"North\"");
    assert!(topics(&[&together, &hall("", ""), &other]).contains("topic `North/POSTOPIC`"));
}

#[test]
fn each_use_of_a_composite_has_its_own_table() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let hall = hall("saoms:overrides=\"${table}\"", "").replacen(
        "<component",
        "<property name=\"table\" mustSupply=\"true\"/>\n<component",
        1,
    );
    let sites = site("North", "hall") + &site("South", "hall");
    let with = |name: &str, table: &str, sites: String| {
        let component =
            format!("<component name=\"{name}\" saoms:site=\"{name}\"><implementation.composite name=\"t:hall\"/>");
        sites.replace(&component, &format!("{component}<property name=\"table\">{table}</property>"))
    };
    let sites = with("South", "south.csv", with("North", "north.csv", sites));
    write("hall.composite", &hall);
    write("fleet.composite", &around("fleet", &sites));
    write("north.csv", "index,speed\n1,2\n");
    write("south.csv", "index,speed\n2,1.5\n");
    let compiled = || Project::new().file(folder.path().join("fleet.composite")).compile(&registry());
    let speeds = |found: saoms_lang::project::Compilation| {
        let text = human_of(&found);
        let assembly = found.output.unwrap_or_else(|| panic!("{text}"));
        let speed = |one: &saoms_lang::assembly::ComponentSpec| {
            let value = one.values.iter().find(|(name, _)| name == "speed");
            format!("{} {:?}", one.path, value.map(|(_, value)| value.clone()))
        };
        assembly.components.iter().map(speed).collect::<Vec<_>>().join("\n")
    };
    expect![[r#"
        North/Robot1 Some(Float(2.0))
        North/Robot2 None
        South/Robot1 None
        South/Robot2 Some(Float(1.5))"#]]
    .assert_eq(&speeds(compiled()));
    ["south.csv", "north.csv"].iter().for_each(|name| fs::remove_file(folder.path().join(name)).unwrap());
    let found = compiled();
    let message: Vec<String> = found.reported().map(|one| format!("{} {}", one.code.id, one.message)).collect();
    assert_eq!(message, ["S0001 there is no such file", "S0001 there is no such file"]);
}

#[test]
fn a_table_is_beside_the_file_that_names_it() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    fs::create_dir(folder.path().join("halls")).unwrap();
    let property = "<property name=\"table\" mustSupply=\"true\"/>\n<component";
    let hall =
        |overrides: &str| hall(&format!("saoms:overrides=\"{overrides}\""), "").replacen("<component", property, 1);
    let inner = |name: &str, of: &str, property: &str| {
        format!("<component name=\"{name}\"><implementation.composite name=\"t:{of}\"/>{property}</component>")
    };
    let value = "<property name=\"table\">one.csv</property>";
    let middle = "<property name=\"table\">none.csv</property>".to_owned()
        + &inner("Hall", "hall", "<property name=\"table\" source=\"$table\"/>");
    write("fleet.composite", &around("fleet", &inner("Middle", "middle", value)));
    write("halls/middle.composite", &around("middle", &middle));
    let found = |overrides: &str| {
        write("halls/hall.composite", &hall(overrides));
        let found = Project::new().file(folder.path().join("fleet.composite")).compile(&registry());
        let place = |at: saoms_lang::source::Location| {
            let path = found.sources.get(at.file).path().rsplit('/').next().unwrap_or_default().to_owned();
            format!("{path} {}", found.sources.snippet(at))
        };
        let told = |one: &saoms_lang::diagnostic::Diagnostic| {
            let labels: Vec<String> = one.labels.iter().map(|label| place(label.location)).collect();
            format!("{} at {} [{}]", one.message, place(one.location), labels.join(", "))
        };
        found.reported().map(told).collect::<Vec<_>>()
    };
    // Where the value is written, with the attribute beside it.
    assert_eq!(found("${table}"), ["there is no such file at fleet.composite one.csv [hall.composite ${table}]"]);
    assert_eq!(found("./${table}"), ["`./one.csv`: there is no such file at hall.composite ./${table} []"]);
    write("halls/one.csv", "index,speed\n1,2\n");
    assert_eq!(found("./${table}"), [""; 0], "the path is written in the inner composite");
    assert_eq!(found("${table}").len(), 1);
    write("one.csv", "index,speed\n1,2\n");
    assert_eq!(found("${table}"), [""; 0]);
}

#[test]
fn a_property_in_place_of_a_table_is_told_its_expression() {
    let folder = tempfile::tempdir().unwrap();
    for (written, is_told) in [("$table", true), ("table", true), ("$tables", false), ("table.csv", false)] {
        let hall = hall(&format!("saoms:overrides=\"{written}\""), "");
        let hall = hall.replacen("<component", "<property name=\"table\">a.csv</property>\n<component", 1);
        fs::write(folder.path().join("hall.composite"), hall).unwrap();
        let found = Project::new().file(folder.path().join("hall.composite")).compile(&registry());
        let told = human_of(&found);
        assert!(told.starts_with("error[S0001") && told.matches("error[").count() == 1, "{told}");
        assert_eq!(told.contains(&format!("replace `{written}` with `${{table}}`")), is_told, "{told}");
    }
}
