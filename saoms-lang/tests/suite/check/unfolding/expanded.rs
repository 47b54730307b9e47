//! Composites that are written anew from what they come to.

use expect_test::expect;
use proptest::prelude::*;
use saoms_lang::assembly::Assembly;
use saoms_lang::project::Project;
use saoms_tools::diagnostics::human_of;
use saoms_tools::expand::expanded;

use crate::check::classes::registry;
use crate::check::support::part;

/// The assembly of the first text, which can name the others, and the composite that it comes to.
fn expand(texts: &[&str]) -> (Assembly, String) {
    let project = Project::new().in_memory().text("t", texts[0]);
    let project = texts[1..].iter().fold(project, |project, text| project.other_text("t", *text));
    let compilation = project.compile(&registry());
    let Some(text) = expanded(&compilation) else {
        panic!("{}\n{}", human_of(&compilation), texts.join("\n"));
    };
    // What is said elsewhere stands at other places.
    (Assembly { places: Default::default(), ..compilation.output.unwrap() }, text)
}

/// Expands, and holds the result to what it has to be: the same fleet, and the same when it is expanded again.
fn settled(texts: &[&str]) -> String {
    let (before, text) = expand(texts);
    let (after, again) = expand(&[&text]);
    assert_eq!(format!("{before:#?}"), format!("{after:#?}"), "{text}");
    assert_eq!(text, again);
    text
}

#[test]
fn all_that_is_resolved_is_written_out() {
    let fleet = part(
        "fleet",
        "autowire=\"true\"",
        r#"<property name="pace">250us</property>
<component name="hall"><implementation.composite name="t:hall"/><property name="id">A &lt; "B"</property><property name="pace" source="$pace"/></component>
<component name="hall.Robot"><implementation.java class="example.Gps"/><reference name="other" autowire="false"/></component>
<component name="C"><implementation.java class="example.Conductor"/><reference name="wheels" target="T/left hall T/right"/></component>
<component name="T"><implementation.java class="example.Twins"/></component>"#,
    );
    let hall = part(
        "hall",
        "",
        r#"<property name="id"/><property name="pace"/><service name="drive" promote="Robot/move"/>
<component name="Robot"><implementation.java class="example.Robot001"/><property name="ID" source="$id"/><property name="period" source="$pace"/>
<property name="charger"><y xmlns="">4</y><x xmlns="">3</x></property><property name="stops"><value>1</value><value>2</value></property>
<property name="topicRename">POSTOPIC,pos::ORDERS, orders</property><property name="restart">onFailure</property><property name="restartLimit">7</property>
<property name="overrun">catchUp</property><property name="deadline">200us</property><property name="delay">1500us</property><property name="loss">accept</property></component>"#,
    );
    expect![[r#"
        <composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" xmlns:s="urn:saoms:1" name="fleet" targetNamespace="urn:t">
          <component name="hall.Robot_" s:path="hall/Robot">
            <implementation.rust class="example.Robot001"/>
            <property name="ID">A &lt; "B"</property>
            <property name="charger">
              <x xmlns="">3</x>
              <y xmlns="">4</y>
            </property>
            <property name="stops">
              <value>1</value>
              <value>2</value>
            </property>
            <property name="period">250us</property>
            <property name="delay">1500us</property>
            <property name="topicRename">POSTOPIC,pos::ORDERS,orders</property>
            <property name="overrun">catchUp</property>
            <property name="restart">onFailure</property>
            <property name="restartBackoff">100ms</property>
            <property name="restartLimit">7</property>
            <property name="deadline">200us</property>
            <property name="loss">accept</property>
          </component>
          <component name="hall.Robot">
            <implementation.rust class="example.Gps"/>
          </component>
          <component name="C">
            <implementation.rust class="example.Conductor"/>
            <reference name="wheels" target="T/left hall.Robot_/move T/right"/>
            <reference name="gps" target="hall.Robot/position"/>
          </component>
          <component name="T">
            <implementation.rust class="example.Twins"/>
          </component>
        </composite>
    "#]].assert_eq(&settled(&[&fleet, &hall]));
}

#[test]
fn values_are_written_as_they_were_and_known_by_what_they_are() {
    let fleet = |values: &str| {
        let robot =
            format!("<component name=\"R\"><implementation.java class=\"example.Robot001\"/>{values}</component>");
        part("fleet", "", &robot)
    };
    let fancy = fleet(
        r#"<property name="ID" value=" 007 "/><property name="period" value="1000"/><property name="speed" value="0.50"/>
<property name="colour" value=" red "/><property name="awake" value="1"/><property name="grace">1.5s</property>
<property name="charger"><x xmlns="">+3</x><y xmlns="">4</y></property><property name="stops"><value>01</value><value>2</value></property>"#,
    );
    let plain = fleet(
        r#"<property name="ID" value=" 007 "/><property name="period" value="1s"/><property name="speed" value="0.5"/>
<property name="colour" value="red"/><property name="awake" value="true"/><property name="grace">1500ms</property>
<property name="charger"><x xmlns="">3</x><y xmlns="">4</y></property><property name="stops"><value>1</value><value>2</value></property>"#,
    );
    let [(fancy, written), (plain, usual)] = [fancy, plain].map(|text| expand(&[&text]));
    assert_eq!(fancy.components[0].values, plain.components[0].values);
    assert_eq!(fancy.components[0].task, plain.components[0].task);
    expect![[r#"
        <composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="fleet" targetNamespace="urn:t">
          <component name="R">
            <implementation.rust class="example.Robot001"/>
            <property name="ID">007</property>
            <property name="speed">0.50</property>
            <property name="colour">red</property>
            <property name="awake">1</property>
            <property name="charger">
              <x xmlns="">+3</x>
              <y xmlns="">4</y>
            </property>
            <property name="stops">
              <value>01</value>
              <value>2</value>
            </property>
            <property name="grace">1.5s</property>
            <property name="period">1s</property>
          </component>
        </composite>
    "#]]
    .assert_eq(&settled(&[&written]));
    assert_eq!(settled(&[&usual]), usual);
}

#[test]
fn references_without_a_target_make_it_one_of_sca_1_0() {
    let text = part("fleet", "", r#"<component name="N"><implementation.java class="example.Navigator"/></component>"#)
        .replace("http://docs.oasis-open.org/ns/opencsa/sca/200912", "http://www.osoa.org/xmlns/sca/1.0");
    let fleet = part("outer", "", r#"<include name="t:fleet"/>"#);
    assert!(settled(&[&fleet, &text]).contains("xmlns=\"http://www.osoa.org/xmlns/sca/1.0\""));
}

/// A diagnostic lowered with a reason is not reported again; those of other components are.
#[test]
fn lowered_warnings_stay_lowered() {
    let clock = |name: &str, more: &str| {
        format!(
            "<component name=\"{name}\"><implementation.java class=\"example.Clock\"/><property name=\"ID\">{name}</property><property name=\"period\">1</property>{more}</component>"
        )
    };
    let late = |said: &str| format!("<property name=\"deadline\">2</property>{said}");
    let severity = |code: &str| format!("<s:severity code=\"{code}\" level=\"allow\" reason=\"known\"/>");
    let fleet = |inside: String| settled(&[&part("fleet", "xmlns:s=\"urn:saoms:1\"", &inside)]);
    let said = severity("S4007");
    assert!(fleet(clock("A", &late(&said))).contains(&said));
    assert!(!fleet(clock("A", &late(&said)) + &clock("B", &late(""))).contains("severity"));
    let wiring = severity("S4010");
    assert!(fleet(clock("A", "") + &wiring).contains(&wiring), "it is for another check");
}

/// Severities that a composite lowers stay lowered, or its expansion would not run.
#[test]
fn lowered_errors_stay_lowered() {
    let robot = |name: &str, more: &str| {
        format!(
            "<component name=\"{name}\"><implementation.java class=\"example.Robot001\"/><property name=\"ID\">R</property><property name=\"period\">1</property><property name=\"number\">1</property>{more}</component>\n"
        )
    };
    let lowered = "<s:severity code=\"S3013\" level=\"note\" reason=\"twins, &lt;they say\"/>";
    let text = settled(&[&part("fleet", "xmlns:s=\"urn:saoms:1\"", &(robot("A", "") + &robot("B", lowered)))]);
    let expected = "<s:severity code=\"S3013\" level=\"note\" reason=\"twins, &lt;they say\"/>";
    assert_eq!(text.matches(expected).count(), 1, "{text}");
}

#[test]
fn loops_are_said_as_far_as_they_differ_from_those_of_the_class() {
    let cart = |loops: &str| {
        let text = format!(
            "<component name=\"Cart\"><implementation.rust class=\"example.Cart\"/><property name=\"ID\">Cart</property><property name=\"period\">100</property>{loops}</component>"
        );
        settled(&[&part("fleet", "xmlns:s=\"urn:saoms:1\"", &text)])
    };
    assert!(!cart("").contains("loop"));
    let all = cart(
        r#"<s:loop name="Saver" class="example.BatterySaver" before="BatteryMS"><property name="threshold" value="50"/></s:loop>
<s:loop name="CollisionMS" class="example.Courteous" after="PathMS"/><s:loop name="BatteryMS" after="CollisionMS"/>"#,
    );
    expect![[r#"
            <s:loop name="CollisionMS" class="example.Courteous" after="PathMS"/>
            <s:loop name="Saver" class="example.BatterySaver" after="CollisionMS">
              <property name="threshold">50</property>
            </s:loop>
            <s:loop name="BatteryMS" after="Saver"/>
          </component>
        </composite>
    "#]]
    .assert_eq(&all[all.find("    <s:loop").unwrap()..]);
    let fewer = cart(
        r#"<s:loop name="BatteryMS" remove="true"/><s:loop name="CollisionMS"><property name="patience">7</property></s:loop>"#,
    );
    expect![[r#"
            <s:loop name="BatteryMS" remove="true"/>
            <s:loop name="CollisionMS">
              <property name="patience">7</property>
            </s:loop>
          </component>
        </composite>
    "#]]
    .assert_eq(&fewer[fewer.find("    <s:loop").unwrap()..]);
}

/// One of several composites: its robot, the composite behind it that implements a component, and where its band leads.
/// A robot's ID is its own, so each composite is there once.
#[derive(Clone, Debug)]
struct Level {
    robot: (u8, String),
    inner: Option<u8>,
    targets: Vec<(bool, u8)>,
}

fn level() -> impl Strategy<Value = Level> {
    let robot = (1..9u8, "[ -~]{1,6}");
    (robot, any::<Option<u8>>(), prop::collection::vec(any::<(bool, u8)>(), 0..3))
        .prop_map(|(robot, inner, targets)| Level { robot, inner, targets })
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

/// The text of the composite of this place. It can hold those behind it, each of which offers `drive` and has `band`.
fn text(place: usize, levels: &[Level]) -> String {
    let level = &levels[place];
    let mut inside = String::from(
        "<property name=\"id\">x</property><service name=\"drive\" promote=\"r0/move\"/><reference name=\"band\" promote=\"band/wheels\" multiplicity=\"0..n\"/>\n",
    );
    let (speed, id) = &level.robot;
    let id = if id.trim().is_empty() { "x" } else { id };
    inside += &format!(
        "<component name=\"r0\"><implementation.java class=\"example.Robot\"/><property name=\"ID\" value=\"{} {place}\"/><property name=\"number\">{speed}</property><property name=\"period\">{speed}ms</property></component>\n",
        escaped(id)
    );
    let mut offers = vec!["r0/move".to_owned()];
    let behind = levels.len() - place - 1;
    if let Some(inner) = level.inner.filter(|_| behind > 0) {
        let inner = place + 1 + usize::from(inner) % behind;
        inside += &format!(
            "<component name=\"c\"><implementation.composite name=\"t:l{inner}\"/><reference name=\"band\" target=\"r0\"/></component>\n"
        );
        offers.push("c/drive".to_owned());
    }
    let targets: Vec<&str> =
        level.targets.iter().map(|(_, target)| offers[usize::from(*target) % offers.len()].as_str()).collect();
    let attribute = if targets.is_empty() { String::new() } else { format!(" target=\"{}\"", targets.join(" ")) };
    let fixed = level.targets.iter().any(|(fixed, _)| *fixed);
    inside += &format!(
        "<component name=\"band\"><implementation.java class=\"example.Conductor\"/><reference name=\"wheels\" nonOverridable=\"{fixed}\"{attribute}/><reference name=\"gps\" target=\"G\"/></component><component name=\"G\"><implementation.java class=\"example.Gps\"/></component>"
    );
    part(&format!("l{place}"), "", &inside)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_is_expanded_stays_the_same(levels in prop::collection::vec(level(), 1..4)) {
        let texts: Vec<String> = (0..levels.len()).map(|place| text(place, &levels)).collect();
        let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
        settled(&texts);
    }
}

/// A severity that a composite sets is kept by its expansion where the fault is still there.
#[test]
fn severities_of_the_examples_outlive_their_expansion() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/suite/check/examples");
    let compile = |text: &str| Project::new().in_memory().text("fleet.composite", text).compile(&registry());
    let (mut codes_left, mut lost) = (Vec::new(), Vec::new());
    for code in saoms_lang::diagnostic::codes::ALL {
        let Ok(text) = std::fs::read_to_string(folder.join(format!("{}.composite", code.id))) else {
            continue;
        };
        let Some(start) = text.find("<composite") else { continue };
        let Some(end) = text[start..].find('>') else { continue };
        let (head, rest) = text.split_at(start + end + 1);
        let severity =
            format!(r#"<s:severity xmlns:s="urn:saoms:1" code="{}" level="allow" reason="known"/>"#, code.id);
        let Some(text) = expanded(&compile(&format!("{head}{severity}{rest}"))) else { continue };
        codes_left.push(code.id);
        if compile(&text).diagnostics.iter().any(|one| one.code == *code && !one.is_allowed()) {
            lost.push(code.id);
        }
    }
    assert!(lost.is_empty(), "they are of the nature `OutlivesExpansion`: {lost:?}");
    assert!(codes_left.contains(&"S4007"), "{codes_left:?}");
}
