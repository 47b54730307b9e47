//! One mistake, one message: what follows from it is not told again.

use expect_test::expect;

use crate::check::mistakes::slips::{GPS, of, robot};
use crate::check::support::{faults_of, fleet, fleet_1_0, outcome, part};
use crate::check::values::files::checked;

/// Two robots that take their number from a property of the composite, which is given as `given`.
fn takers(given: &str) -> String {
    let taker =
        |name: &str| robot(name, "<property name=\"password\" source=\"$n\"/><property name=\"number\">1</property>");
    format!("{given}\n{}\n{}", taker("A"), taker("B").replace(">1</property></component>", ">2</property></component>"))
}

#[test]
fn an_entity_that_is_declared_is_told_with_its_declaration() {
    let whole = fleet(&takers("<property name=\"n\">&p;</property>"));
    expect![[r#"
        1:1-10 error S0110: a document type declaration is not allowed here
          3:20-23 an entity that it declares
          help: remove it; a composite needs no DTD, and entities beyond the five predefined ones are refused
          help: write the text itself in place of `&p;`
    "#]]
    .assert_eq(&outcome(&[&format!("<!DOCTYPE composite [<!ENTITY p \"7\">]>\n{whole}")], &[]));
    expect![[r#"
        1:1-10 error S0110: a document type declaration is not allowed here
          help: remove it; a composite needs no DTD, and entities beyond the five predefined ones are refused
        3:20-23 error S0109: unknown entity `&p;`
          help: use only `&lt;`, `&gt;`, `&amp;`, `&apos;` and `&quot;`; other entities cannot be declared
    "#]]
    .assert_eq(&outcome(&[&format!("<!DOCTYPE composite [<!ENTITY q \"7\">]>\n{whole}")], &[]));
}

#[test]
fn a_property_without_a_value_is_told_at_its_first_use() {
    expect![[r#"
        A (example.Robot) ID=Text("A") number=Integer(1) gps->
        B (example.Robot) ID=Text("B") number=Integer(2) gps->
    "#]]
    .assert_eq(&of(&takers("<property name=\"n\"/>")));
    expect![[r#"
        2:22-31 error S0109: unknown entity `&nowhere;`
          help: use only `&lt;`, `&gt;`, `&amp;`, `&apos;` and `&quot;`; other entities cannot be declared
    "#]]
    .assert_eq(&of(&takers("<property name=\"n\">a &nowhere; b</property>")));
}

#[test]
fn two_values_of_a_property_that_takes_one_are_told_where_they_are() {
    let two = "<value>1</value><value>2</value>";
    expect![[r#"
        2:37-42 error S3011: the property `n` allows one value, found 2
          2:21-26 the first
          help: keep one of them, or write `many="true"` where the property is declared
    "#]]
    .assert_eq(&of(&takers(&format!("<property name=\"n\">{two}</property>"))));
    expect![[r#"
        2:55-56 error S3011: the property `password` allows one value, found 2
          2:39-40 the first
          4:35-37 used here as `password`
          help: `password`: The account's password, or `$NAME` for the environment variable `NAME`
    "#]]
    .assert_eq(&of(&takers(&format!("<property name=\"n\" many=\"true\">{two}</property>"))));
}

#[test]
fn a_condition_that_xml_does_not_allow_leaves_no_replica_out() {
    let robots = |condition: &str| {
        format!(
            "<component name=\"R${{index}}\" xmlns:saoms=\"urn:saoms:1\" saoms:count=\"3\" saoms:overrides=\"robots.csv\" saoms:if=\"{condition}\"><implementation.java class=\"example.Robot\"/><property name=\"ID\">R${{index}}</property><property name=\"period\">1</property><property name=\"number\">${{index}}</property></component>"
        )
    };
    let with = |condition: &str| checked(&robots(condition), &[("robots.csv", b"index,number\n3,7\n")], 1000).1;
    expect![[r#"
        2:116-117 error S0105: `<` in the value of `saoms:if`
          2:109-110 the value starts here
          fix: replace `<` with `&lt;` [2:116-117 "&lt;"]
    "#]]
    .assert_eq(&with("index < 3"));
    expect![[r#"
        robots.csv:2:1-2 warning S2047: the condition leaves out the replica `3`
          2:110-122 false for it
          help: change the condition, or remove the row
    "#]]
    .assert_eq(&with("index &lt; 3"));
}

#[test]
fn what_an_element_cannot_have_is_told_alone() {
    let inner = part("inner", "", GPS);
    let with = |includes: &str| outcome(&[&part("fleet", "xmlns:saoms=\"urn:saoms:1\"", includes), &inner], &[]);
    expect![[r#"
        2:25-35 error S1007: `include` has no attribute `saoms:site`
          help: only a component can have it: write `<component name="..." saoms:site="A"><implementation.composite name="t:inner"/></component>` in place of the `include`
        3:25-35 error S1007: `include` has no attribute `saoms:site`
          help: only a component can have it: write `<component name="..." saoms:site="B"><implementation.composite name="t:inner"/></component>` in place of the `include`
    "#]]
    .assert_eq(&with("<include name=\"t:inner\" saoms:site=\"A\"/>\n<include name=\"t:inner\" saoms:site=\"B\"/>"));
    expect![[r#"
        2:25-36 error S1007: `include` has no attribute `saoms:count`
          help: only a component can have it: write `<component name="..." saoms:count="2"><implementation.composite name="t:inner"/></component>` in place of the `include`
    "#]]
    .assert_eq(&with("<include name=\"t:inner\" saoms:count=\"2\"/>"));
    let inside = "<component name=\"Inside\"><implementation.java class=\"example.Gps\"/></component>";
    expect![[r#"
        2:24-33 error S1005: `component` is not allowed in `component`
          help: move it out of `component`: it belongs in the composite
    "#]]
    .assert_eq(&of(&format!(
        "<component name=\"Out\">{inside}<implementation.java class=\"example.Gps\"/></component>\n{}",
        robot("R", "<property name=\"number\">1</property><reference name=\"gps\" target=\"Inside\"/>")
    )));
    expect![[r#"
        2:20-27 error S1007: `property` has no attribute `promote`
          help: `property` has the attributes `name`, `value`, `type`, `element`, `many`, `mustSupply`
    "#]]
    .assert_eq(&of(&format!("<property name=\"n\" promote=\"G/n\">1</property>\n{GPS}")));
    expect![[r#"
        2:2-8 error S1004: SCA 1.1 has no element `import`
          help: write it in the `sca-contribution.xml` of the folder
    "#]]
    .assert_eq(&of("<import namespace=\"urn:t\"/>"));
    expect![[r#"
        2:2-11 error S1008: a `reference` with a `target`, outside of the component that has it
          help: move it into that component, or write `<wire source="COMPONENT/gps" target="G"/>`; a reference of the composite has a `promote`
    "#]].assert_eq(&of("<reference name=\"gps\" target=\"G\"/>"));
    expect![[r#"
        2:21-26 error S1007: `component` has no attribute `class`
          help: write `<implementation.rust class="example.Gps"/>` in the component
    "#]]
    .assert_eq(&of("<component name=\"C\" class=\"example.Gps\"/>"));
    expect![[r#"
        4:59-66 error S1007: `reference` has no attribute `service`
          fix: replace `service` with `target` [4:59-66 "target"]
    "#]]
    .assert_eq(&of(&format!(
        "{GPS}\n{}",
        robot("R", "<property name=\"number\">1</property><reference name=\"gps\" service=\"G\"/>")
    )));
}

#[test]
fn a_position_in_a_path_says_how_many_there_are() {
    let with = |place: &str| {
        of(&format!(
            "<property name=\"bays\"><bay>3</bay><bay>2</bay></property>\n{}",
            robot("R", &format!("<property name=\"number\" source=\"$bays/bay[{place}]\"/>"))
        ))
    };
    expect![[r#"
        4:39-45 error S2023: there are 2 parts `bay`, counted from `[1]`: the last one is `bay[2]`
        4:39-45 error S2023: there are 2 parts `bay`, counted from `[1]`: the last one is `bay[2]`
          fix: replace `[0]` with `[1]` [4:42-45 "[1]"]
    "#]]
    .assert_eq(&(with("3") + &with("0")));
}

#[test]
fn conditions_of_other_languages_are_told_in_this_one() {
    let with = |condition: &str| {
        let component = format!(
            "<component name=\"G\" xmlns:saoms=\"urn:saoms:1\" saoms:if=\"{condition}\"><implementation.java class=\"example.Gps\"/></component>"
        );
        of(&format!("<property name=\"robots\">3</property><property name=\"pause\">200ms</property>\n{component}"))
    };
    expect![[r#"
        3:64-66 error S2045: expected an operator before this
          fix: replace `gt` with `>` [3:64-66 "&gt;"]
        3:64-66 error S2045: expected an operator before this
          fix: replace `lt` with `<` [3:64-66 "&lt;"]
        3:64-66 error S2045: expected an operator before this
          fix: replace `eq` with `==` [3:64-66 "=="]
        3:69-71 error S2045: expected an operator before this
          help: write a text in quotes: `'200ms'`
    "#]]
    .assert_eq(&["robots gt 3", "robots lt 3", "robots eq 3", "pause == 200ms"].map(with).concat());
    let named = |width: &str| {
        of(&robot(&format!("R${{index:{width}}}"), "<property name=\"number\">${index}</property>")
            .replacen("<component", "<component saoms:count=\"1\"", 1))
    };
    expect![[r#"
        2:43-47 error S2045: expected the number of digits after `:`, with a `0` before it (in `R${index:%02d}`, index 1)
          help: as in `${index:03}`, which turns 7 into 007
          fix: replace `%02d` with `02` [2:43-47 "02"]
        2:123-127 error S2045: expected the number of digits after `:`, with a `0` before it (in `R${index:%02d}`, index 1)
          help: as in `${index:03}`, which turns 7 into 007
          fix: replace `%02d` with `02` [2:123-127 "02"]
        2:43-44 error S2045: expected the number of digits after `:`, with a `0` before it (in `R${index:2}`, index 1)
          help: as in `${index:03}`, which turns 7 into 007
          fix: replace `2` with `02` [2:43-44 "02"]
        2:120-121 error S2045: expected the number of digits after `:`, with a `0` before it (in `R${index:2}`, index 1)
          help: as in `${index:03}`, which turns 7 into 007
          fix: replace `2` with `02` [2:120-121 "02"]
    "#]].assert_eq(&["%02d", "2"].map(named).concat());
}

#[test]
fn a_function_is_told_by_its_name() {
    let with = |value: &str| {
        of(&robot("R${index}", &format!("<property name=\"number\">${{{value}}}</property>"))
            .replacen("<component", "<component saoms:count=\"1\"", 1))
    };
    expect![[r#"
        3:27-30 error S2045: there is no function `max` (in `R1`, index 1)
          help: expressions have operators and parentheses, and no functions
        3:31-34 error S2045: there is no function `abs` (in `R1`, index 1)
          help: expressions have operators and parentheses, and no functions
        3:35-38 error S2045: `not` must be before a comparison (in `R1`, index 1)
          help: write `(not ...)`
    "#]]
    .assert_eq(&["max(index, 2)", "2 * abs (index)", "index + not(index)"].map(with).concat());
}

/// What is wrong in a composite is one mistake, however often the composite is used.
#[test]
fn a_task_id_of_two_components_is_told_once_for_all_sites() {
    let clock = |name: &str| {
        format!(
            "<component name=\"{name}\"><implementation.java class=\"example.Clock\"/>\n<property name=\"ID\">C</property><property name=\"period\">1</property></component>"
        )
    };
    let site = |name: &str| {
        format!(
            "<component name=\"{name}\" saoms:site=\"{name}\"><implementation.composite name=\"t:inner\"/></component>"
        )
    };
    let outer = part("outer", "xmlns:saoms=\"urn:saoms:1\"", &(site("N") + &site("S")));
    let inner = part("inner", "", &(clock("A") + &clock("B")));
    expect![[r#"
        inner:4:21-22 warning S4001: components `N/A` and `N/B` share the ID `C`
          inner:3:21-22 the first
          help: give each its own ID: messages and reports name tasks by their ID
        N/A (example.Clock)
        N/B (example.Clock)
        S/A (example.Clock)
        S/B (example.Clock)
    "#]]
    .assert_eq(&outcome(&[&outer, &inner], &[]));
}

#[test]
fn an_expression_that_nobody_reads_and_makes_ids_equal_is_told_once() {
    let used = |number: u8| {
        format!(
            "<component name=\"U{number}\"><implementation.composite name=\"t:inner\"/><property name=\"n\">{number}</property></component>"
        )
    };
    let outer = part("outer", "", &[1, 2, 3].map(used).concat());
    let inside = "<implementation.java class=\"example.Robot\"/><property name=\"ID\">R${n}</property><property name=\"period\">1</property><property name=\"number\" source=\"$n\"/>";
    let inner = part(
        "inner",
        "",
        &format!("<property name=\"n\" mustSupply=\"true\"/>\n<component name=\"R\">{inside}</component>"),
    );
    expect![[r#"
        inner:3:85-90 error S3013: components `U1/R` and `U2/R` have the same `ID` `R${n}`
          2:18-20 used here
          2:124-126 used here
          help: `${...}` is evaluated only in components with a `saoms:count`: put the value together in the component around it, and take it with `source`
          help: give every robot its own `ID`
          help: both take this value from here: give each use of the composite a value of its own, or make it a site with `saoms:site`
    "#]].assert_eq(&outcome(&[&outer, &inner], &[]));
    let replicas = used(1).replace("\"U1\"", "\"U${index}\" saoms:count=\"3\"").replace(">1<", ">${index}<");
    let outer = part("outer", "xmlns:saoms=\"urn:saoms:1\"", &replicas);
    expect![[r#"
        inner:3:85-90 error S3013: components `U1/R` and `U2/R` have the same `ID` `R${n}` (and in 1 more)
          2:18-27 used here
          help: `${...}` is evaluated only in components with a `saoms:count`: put the value together in the component around it, and take it with `source`
          help: give every robot its own `ID`
          help: both take this value from here: give each use of the composite a value of its own, or make it a site with `saoms:site`
    "#]].assert_eq(&outcome(&[&outer, &inner], &[]));
}

#[test]
fn a_property_that_is_written_as_an_attribute_of_its_name_is_told_once() {
    let own =
        "<property period=\"100\"/><property  speed='1' many=\"true\">2</property><property nam=\"x\"/><property/>";
    let text = format!("<component name=\"R\"><implementation.java class=\"example.Robot\"/>\n{own}</component>");
    expect![[r#"
        3:11-17 error S1007: `property` has no attribute `period`
          fix: replace it with `name="period" value="100"` [3:11-23 "name=\"period\" value=\"100\""]
        3:36-41 error S1007: `property` has no attribute `speed`
          fix: replace it with `name="speed" value="1"` [3:36-45 "name=\"speed\" value=\"1\""]
        3:80-83 error S1007: `property` has no attribute `nam`
          fix: replace `nam` with `name` [3:80-83 "name"]
        3:85-86 error S3004: class `example.Robot` has no property `x`
          help: its properties are `ID`, `number`, `speed`, `colour`, `awake`, `charger`, `stops`, `grace`, `period`, `delay`, `runOnStartup`, `mayInterruptIfRunning`, `useJMS`, `url`, `user`, `password`, `passwordFile`, `tlsCa`, `tlsCertificate`, `tlsKey`, `topicRename`, `overrun`, `restart`, `restartBackoff`, `restartLimit`, `deadline`, `trigger`, `minimum`, `queue` and `loss`
        3:90-98 error S1008: `property` needs the attribute `name`
          help: add `name="..."` to it
    "#]]
    .assert_eq(&of(&text));
    expect![[r#"
        3:11-17 error S1007: `property` has no attribute `period`
          help: write `<property name="period">100</property>`
        3:36-41 error S1007: `property` has no attribute `speed`
          help: write `<property name="speed">1</property>`
        3:80-83 error S1007: `property` has no attribute `nam`
          fix: replace `nam` with `name` [3:80-83 "name"]
        3:85-86 error S3004: class `example.Robot` has no property `x`
          help: its properties are `ID`, `number`, `speed`, `colour`, `awake`, `charger`, `stops`, `grace`, `period`, `delay`, `runOnStartup`, `mayInterruptIfRunning`, `useJMS`, `url`, `user`, `password`, `passwordFile`, `tlsCa`, `tlsCertificate`, `tlsKey`, `topicRename`, `overrun`, `restart`, `restartBackoff`, `restartLimit`, `deadline`, `trigger`, `minimum`, `queue` and `loss`
        3:90-98 error S1008: `property` needs the attribute `name`
          help: add `name="..."` to it
    "#]]
    .assert_eq(&faults_of(&[&fleet_1_0(&text)], &[]));
}
