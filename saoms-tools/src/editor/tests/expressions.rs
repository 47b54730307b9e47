//! Names in expressions, and in files beside composites.

use super::marked::{defined, found, renamed};
use crate::editor::hover::hover;
use crate::editor::testing::{composite, scene};

/// A fleet of bots: its property `bots` is used in every way in which one can be.
const FLEET: &str = r#"<property name="bots">4</property><property name="simulated">true</property>
<include name="inner" s:if="bots &gt; 3"/>
<component name="R${index:02}" s:count="bots" s:from="1 + bots" s:overrides="r.csv" s:if="index &lt; bots and site == 'bots'">
  <implementation.rust class="saoms.Robot"/>
  <property name="delay">${(index - 1) * 500 / bots}</property>
  <property name="chargeX" value="${bots}"/>
  <property name="scenario"><value>a ${ bots } bots $${bots}</value><value><![CDATA[${bots}]]></value></property>
  <property name="text" file="text.txt"/>
  <property name="other" source="$bots/part"/>
  <reference name="world" target="W${index%bots}"/>
  <s:loop name="BatteryMS"><property name="p">${bots}</property></s:loop>
  <!-- ${bots} -->
</component>
<component name="W${index}" s:count="bots"/>
<component name="Plain" s:if="not bots == 1"><property name="p">${bots}</property><property name="q" file="text.txt"/></component>
<wire source="Plain/a" target="W1" s:if="bots!=0"/>"#;

const INNER: &str = r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" xmlns:own="urn:saoms:1" name="inner" targetNamespace="urn:f"><component name="I${index}" own:count="2*bots"/></composite>"#;
const TEXT: &str = "at ${bots}s ${index} bots $${bots}\n";

fn others() -> [(&'static str, &'static str); 3] {
    [("inner.composite", INNER), ("text.txt", TEXT), ("r.csv", "index,battery\n1,${bots}\n")]
}

#[test]
fn a_property_is_renamed_in_every_expression() {
    let marked = composite(&FLEET.replacen("s:count=\"bots", "s:count=\"bo|ts", 1));
    let all = renamed(&marked, &others(), "größe_1").unwrap();
    let new = |text: &str| {
        // What is no expression stays: texts, what is written with `$$`, comments, and templates of components that are
        // no replicas.
        let kept = ["'bots'", "} bots $${bots}", "<!-- ${bots}", "\"p\">${bots}</property><property name=\"q\""];
        let hidden =
            kept.iter().zip('\u{1}'..).fold(text.to_owned(), |text, (one, sign)| text.replace(one, &sign.to_string()));
        let changed = hidden.replace("bots", "größe_1");
        kept.iter().zip('\u{1}'..).fold(changed, |text, (one, sign)| text.replace(&sign.to_string(), one))
    };
    assert_eq!(all[0], composite(&new(FLEET)));
    assert_eq!(all[1], new(INNER));
    assert_eq!(all[2], new(TEXT));
    assert_eq!(all[3], others()[2].1, "values of tables are no templates");
}

#[test]
fn names_in_expressions_lead_to_their_property_and_are_explained() {
    let at = |from: &str, to: &str| composite(&FLEET.replacen(from, to, 1));
    for (from, to) in [
        ("s:count=\"bots", "s:count=\"bots|"),
        ("/ bots}", "/ |bots}"),
        ("s:if=\"bots &gt;", "s:if=\"bot|s &gt;"),
        ("{ bots }", "{ bo|ts }"),
    ] {
        assert_eq!(defined(&at(from, to), &others()), ["fleet.composite:2:17 bots"], "{to}");
    }
    let places = found(&at("s:count=\"bots", "s:count=\"bots|"), &others(), false);
    assert_eq!(places.len(), 16, "{places:?}");
    let said = |marked: &str| {
        let (scene, at) = scene(marked, &others());
        hover(&scene, at).map(|(text, _)| text).unwrap_or_default()
    };
    assert!(said(&at("s:count=\"bots", "s:count=\"bo|ts")).contains("a property of the composite `fleet`: `4`"));
    assert!(said(&at("${(index", "${(ind|ex")).contains("the number of each replica of `R${index:02}`"));
    // In a component that is none of many, `index` is a name as any other.
    let plain = composite(r#"<property name="index"/><component name="P" s:if="ind|ex > 3"/>"#);
    assert_eq!(defined(&plain, &[]), ["fleet.composite:2:17 index"]);
}

#[test]
fn what_would_break_an_expression_is_refused() {
    let marked = composite(&FLEET.replacen("name=\"bots", "name=\"bots|", 1));
    for name in ["my-bots", "1bots", "index", "and"] {
        let why = renamed(&marked, &others(), name).unwrap_err();
        assert!(why.contains("is used in expressions"), "{why}");
    }
    let index = composite(&FLEET.replacen("${(index", "${(in|dex", 1));
    assert!(renamed(&index, &others(), "i").unwrap_err().contains("the number of a replica"));
    // Where no expression uses it, any name does.
    let plain = composite(r#"<property name="a|"/><component name="C"><property name="b" source="$a"/></component>"#);
    assert!(renamed(&plain, &[], "my-a").is_ok());
    let chosen = composite(
        r#"<property name="start1|"/><property name="start2"/><component name="R${index}" s:count="2"><property name="b" source="$start${index / 1}/x"/></component>"#,
    );
    assert!(renamed(&chosen, &[], "begin").unwrap_err().contains("names this replica together with others"));
    let worlds = composite(
        r#"<component name="W1|"/><component name="W2"/><component name="R${index}" s:count="2"><reference name="w" target="W${index}"/></component>"#,
    );
    assert!(
        renamed(&worlds, &[], "World1").unwrap_err().contains("`W${index}` names this replica together with others")
    );
}

#[test]
fn replicas_that_others_name_by_expressions_follow() {
    let text = |name: &str, other: &str| {
        composite(&format!(
            r#"<component name="{name}${{index:02}}" s:count="4"/><component name="B${{index}}" s:count="4"><reference name="r" target="{name}${{index%4+1:02}} {other}${{index}}"/></component>"#
        ))
    };
    let marked = text("A", "C").replacen("name=\"A", "name=\"|A", 1);
    assert_eq!(renamed(&marked, &[], "Cart${index:02}").unwrap(), [text("Cart", "C")]);
}

#[test]
fn tables_follow_what_is_renamed() {
    let text =
        |name: &str| composite(&format!(r#"<component name="{name}${{index:02}}" s:count="2" s:overrides="r.csv"/>"#));
    let table = "\u{feff}name,battery\r\nR01,60\n\"R02\",70\nR3x,\n";
    let all = renamed(&text("|R"), &[("r.csv", table)], "Cart${index:02}").unwrap();
    assert_eq!(all, [text("Cart"), table.replace("R0", "Cart0")]);
    let by_index = "index,R01\n1,60\n";
    assert_eq!(renamed(&text("|R"), &[("r.csv", by_index)], "C${index:02}").unwrap()[1], by_index);
    // The columns of a component with a composite inside are properties of that.
    let hall = |name: &str| {
        format!(
            r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="hall" targetNamespace="urn:f"><property name="{name}"/></composite>"#
        )
    };
    let uses = |name: &str| {
        composite(&format!(
            r#"<component name="H${{index}}" s:count="2" s:overrides="r.csv"><implementation.composite name="hall"/><property name="{name}">1</property></component>"#
        ))
    };
    let marked = uses("size|");
    let all = renamed(&marked, &[("hall.composite", &hall("size")), ("r.csv", "index,size\n1,3\n")], "width").unwrap();
    assert_eq!(all, [uses("width"), hall("width"), "index,width\n1,3\n".to_owned()]);
}

#[test]
fn a_component_is_renamed_across_a_fleet_in_several_files() {
    let hall = |name: &str| {
        format!(
            r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" xmlns:s="urn:saoms:1" name="hall" targetNamespace="urn:f"><service name="lamp" promote="{name}1/s"/><reference name="r" promote="{name}*/r {name}2/q"/><component name="{name}${{index}}" s:count="2"/></composite>"#
        )
    };
    let outer = composite(
        r#"<component name="H"><implementation.composite name="hall"/></component><component name="Bot1"/><wire source="H/r" target="Bot1"/><service name="t" promote="H/lamp"/>"#,
    );
    let marked = hall("Bot").replacen("promote=\"Bot*", "promote=\"Bot|*", 1);
    let all = renamed(&marked, &[("outer.composite", &outer)], "Cart${index}").unwrap();
    assert_eq!(all, [hall("Cart"), outer.clone()], "what is inside has names of its own");
    let marked = outer.replacen("source=\"H/r", "source=\"H/r|", 1);
    let all = renamed(&marked, &[("hall.composite", &hall("Bot"))], "rail").unwrap();
    assert_eq!(all, [outer.replace("H/r", "H/rail"), hall("Bot").replace("name=\"r\"", "name=\"rail\"")]);
}

#[test]
fn loops_that_a_composite_adds_are_renamed_and_those_of_the_class_are_not() {
    let text = |name: &str| {
        composite(&format!(
            r#"<component name="R"><implementation.rust class="saoms.Robot"/><s:loop name="{name}" class="x.Y" after="BatteryMS"/><s:loop name="BatteryMS" before="{name}"/><s:loop name="z" class="x.Z" after="{name}"/></component>"#
        ))
    };
    let marked = text("mine").replacen("before=\"mine", "before=\"mi|ne", 1);
    assert_eq!(renamed(&marked, &[], "ours").unwrap(), [text("ours")]);
    assert_eq!(renamed(&marked, &[], "z").unwrap_err(), "the name `z` is already used");
    assert_eq!(renamed(&marked, &[], "BatteryMS").unwrap_err(), "the name `BatteryMS` is already used");
    let own = text("mine").replacen("name=\"BatteryMS", "name=\"BatteryMS|", 1);
    assert!(renamed(&own, &[], "x").unwrap_err().contains("is named in the code of the component's class"));
}
