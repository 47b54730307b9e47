//! Conditions: what is there only where they hold.

use expect_test::expect;

use crate::check::support::{outcome, part};
use crate::check::unfolding::fleets::{fleet, of};

const SAOMS: &str = "xmlns:saoms=\"urn:saoms:1\"";

#[test]
fn conditions_take_away_what_is_checked_all_the_same() {
    let inside = r#"<property name="simulated">true</property><property name="site">north</property>
<component name="Gps" saoms:if="simulated"><implementation.java class="example.Gps"/></component>
<component name="Gps" saoms:if="not simulated"><implementation.java class="real.Gps"/></component>
<component name="Spare" saoms:if="site == 'south'"><implementation.java class="example.Gps"/></component>
<component name="R${index}" saoms:count="5" saoms:if="index != 3"><implementation.java class="example.Robot"/><property name="ID">R${index}</property><property name="period">1</property><property name="number">${index}</property></component>
<component name="N"><implementation.java class="example.Navigator"/></component>
<wire source="N/wheels" target="R1" saoms:if="simulated"/><wire source="N/wheels" target="R2" saoms:if="not simulated"/>"#;
    expect![[r#"
        Gps (example.Gps) other->
        R1 (example.Robot) ID=Text("R1") number=Integer(1) gps->
        R2 (example.Robot) ID=Text("R2") number=Integer(2) gps->
        R4 (example.Robot) ID=Text("R4") number=Integer(4) gps->
        R5 (example.Robot) ID=Text("R5") number=Integer(5) gps->
        N (example.Navigator) wheels->R1/move task->
    "#]]
    .assert_eq(&of(inside, &[]));
    expect![[r#"
        Gps (example.Gps) other->
        Spare (example.Gps) other->
        R1 (example.Robot) ID=Text("R1") number=Integer(1) gps->
        R2 (example.Robot) ID=Text("R2") number=Integer(2) gps->
        R4 (example.Robot) ID=Text("R4") number=Integer(4) gps->
        R5 (example.Robot) ID=Text("R5") number=Integer(5) gps->
        N (example.Navigator) wheels->R1/move task->
    "#]]
    .assert_eq(&of(inside, &["site=south"]));
    expect![[r#"
        3:18-19 error S3006: component `A` needs the property `period`
          help: add `<property name="period">...</property>`: a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
        3:148-151 error S3008: property `number`: `100` is out of range: expected a whole number from 1 to 99
          help: `number`: The number of the robot
        3:178-182 error S3004: class `example.Robot` has no property `sped`
          fix: replace `sped` with `speed` [3:178-182 "speed"]
        4:31-35 error S2045: found the text `north`, expected a condition
          2:23-28 the value of `site`
          help: compare it with something, as in `robots > 10`
        5:31-40 error S2045: the text `north` cannot be compared with the number 3
          2:23-28 the value of `site`
          help: write texts between two `'`; numbers, `true` and `false` have no quotes
        6:35-36 error S2045: there is no `=`
          fix: replace `=` with `==` [6:35-36 "=="]
        7:31-36 error S2045: the composite has no property `index`
          help: give the component a `saoms:count`: `index` is the number of a replica
        8:21-32 error S1011: the attribute `saoms:if` is empty
          help: write its value between the quotes
    "#]].assert_eq(&of(
        r#"<property name="site">north</property>
<component name="A" saoms:if="site == 'south'"><implementation.java class="example.Robot"/><property name="ID">A</property><property name="number">100</property><property name="sped">1</property></component>
<component name="B" saoms:if="site"><implementation.java class="example.Gps"/></component>
<component name="C" saoms:if="site == 3"><implementation.java class="example.Gps"/></component>
<component name="D" saoms:if="sit = 'north'"><implementation.java class="example.Gps"/></component>
<component name="E" saoms:if="index == 3"><implementation.java class="example.Gps"/></component>
<component name="F" saoms:if=""><implementation.java class="example.Gps"/></component>"#,
        &[],
    ));
    expect![[r#"
        4:95-96 error S2011: the component `A` is excluded by its condition
          3:31-46 this condition is false
          help: add the same condition to the element that names it
        6:15-26 error S2010: `B/other/x/y` has the wrong form
          help: write `component` or `component/name`
    "#]]
    .assert_eq(&of(
        r#"<property name="site">north</property>
<component name="A" saoms:if="site == 'south'"><implementation.java class="example.Gps"/></component>
<component name="B"><implementation.java class="example.Gps"/><reference name="other" target="A"/></component>
<wire source="B/other" target="A" saoms:if="site == 'south'"/>
<wire source="B/other/x/y" target="A" saoms:if="site == 'south'"/>"#,
        &[],
    ));
}

#[test]
fn a_text_without_quotes_is_told_as_one() {
    expect![[r#"
        --set:1:7-10 error S2042: the property `night` has the type `xsd:boolean`: found `off`, expected `true` or `false`
          2:68-79 the type
          fix: replace `off` with `false` [--set:1:7-10 "false"]
        2:126-131 error S2042: the property `night` has the type `xsd:boolean`: found `flase`, expected `true` or `false`
          2:68-79 the type
          fix: replace `flase` with `false` [2:126-131 "false"]
        3:39-44 error S2045: the composite has no property `south`
          help: write a text between two `'`, as `'south'`; its properties are `night` and `site`
        4:39-44 error S2045: the composite has no property `sight`
          fix: replace `sight` with `night` [4:39-44 "night"]
    "#]].assert_eq(&of(
        r#"<property name="site">north</property><property name="night" type="xsd:boolean" xmlns:xsd="http://www.w3.org/2001/XMLSchema">flase</property>
<component name="A" saoms:if="site == south"><implementation.java class="example.Gps"/></component>
<component name="B" saoms:if="site != sight"><implementation.java class="example.Gps"/></component>
<component name="C" saoms:if="night"><implementation.java class="example.Gps"/></component>"#,
        &["night=off"],
    ));
}

#[test]
fn includes_and_composites_can_be_absent() {
    let more = part(
        "more",
        "",
        r#"<property name="used">1</property><component name="M"><implementation.java class="example.Gps"/></component>
<component name="N"><implementation.java class="example.Robot"/><property name="ID">N</property><property name="period" source="$used"/><property name="number">7</property></component>
<wire source="M/other" target="Nobody"/>"#,
    );
    let inside = r#"<property name="more">false</property><include name="t:more" saoms:if="more"/>
<component name="In" saoms:if="more"><implementation.composite name="t:more"/></component>
<component name="Out" saoms:if="not more"><implementation.java class="example.Gps"/></component>"#;
    expect![[r#"
        Out (example.Gps) other->
    "#]]
    .assert_eq(&outcome(&[&fleet(inside), &more], &[]));
    expect![[r#"
        more:3:85-86 error S3013: components `N` and `In/N` have the same `ID` `N`
          3:18-20 used here
          help: give every robot its own `ID`
          help: both take this value from here: give each use of the composite a value of its own, or make it a site with `saoms:site`
    "#]]
    .assert_eq(&outcome(
        &[&fleet(inside), &more.replace("<wire source=\"M/other\" target=\"Nobody\"/>", "")],
        &["more=true"],
    ));
}

/// A composite whose inclusion has a false condition declares nothing in place of what is there.
#[test]
fn expressions_take_the_properties_of_what_is_included() {
    let with = |name: &str, count: usize, robots: &str| {
        part(name, SAOMS, &format!("<property name=\"n\">{count}</property>{robots}"))
    };
    let gps = |name: &str| {
        format!(
            "<component name=\"{name}${{index}}\" saoms:count=\"n\"><implementation.java class=\"example.Gps\"/></component>"
        )
    };
    let (south, north) = (with("south", 1, &gps("S")), with("north", 2, &gps("N")));
    let more = part("more", "", "<component name=\"M\"><implementation.java class=\"example.Gps\"/></component>");
    let found = |site: &str, includes: &str| {
        let robot = "<component name=\"R\"><implementation.java class=\"example.Robot\"/><property name=\"ID\">R</property><property name=\"period\">1</property><property name=\"number\" source=\"$n\"/></component>";
        let inside = format!("<property name=\"site\">{site}</property>{includes}{}{robot}", gps("G"));
        outcome(&[&part("fleet", SAOMS, &inside), &south, &north, &more], &[])
    };
    let one_of = |first: &str, second: &str| {
        format!(
            "<include name=\"t:{first}\" saoms:if=\"site == '{first}'\"/><include name=\"t:{second}\" saoms:if=\"site == '{second}'\"/>"
        )
    };
    for includes in [one_of("south", "north"), one_of("north", "south")] {
        expect![[r#"
            N1 (example.Gps) other->
            N2 (example.Gps) other->
            G1 (example.Gps) other->
            G2 (example.Gps) other->
            R (example.Robot) ID=Text("R") number=Integer(2) gps->
        "#]]
        .assert_eq(&found("north", &includes));
        expect![[r#"
            S1 (example.Gps) other->
            G1 (example.Gps) other->
            R (example.Robot) ID=Text("R") number=Integer(1) gps->
        "#]]
        .assert_eq(&found("south", &includes));
    }
    // A condition can ask for what another one includes.
    let asking = r#"<include name="t:more" saoms:if="n == 2"/>"#.to_owned() + &one_of("south", "north");
    expect![[r#"
        M (example.Gps) other->
        N1 (example.Gps) other->
        N2 (example.Gps) other->
        G1 (example.Gps) other->
        G2 (example.Gps) other->
        R (example.Robot) ID=Text("R") number=Integer(2) gps->
    "#]]
    .assert_eq(&found("north", &asking));
    expect![[r#"
        S1 (example.Gps) other->
        G1 (example.Gps) other->
        R (example.Robot) ID=Text("R") number=Integer(1) gps->
    "#]]
    .assert_eq(&found("south", &asking));
}

/// Of includes that exclude each other one is there, so that both can declare what the other one does.
#[test]
fn includes_that_exclude_each_other_can_declare_the_same() {
    let one = |name: &str, period: &str| {
        part(
            name,
            "",
            &format!(
                r#"<property name="every">{period}</property><component name="N"><implementation.java class="example.Robot"/><property name="ID">N</property><property name="period" source="$every"/><property name="number">7</property></component>"#
            ),
        )
    };
    let inside = |other: &str| {
        format!(
            r#"<property name="real">false</property><include name="t:model" saoms:if="not real"/><include name="t:{other}" saoms:if="real"/>"#
        )
    };
    let all = [fleet(&inside("robot")), one("model", "10"), one("robot", "20")];
    let all: Vec<&str> = all.iter().map(String::as_str).collect();
    let twice = [&fleet(&inside("model")), all[1]];
    for (files, settings) in [(&all[..], &[][..]), (&all, &["real=true"]), (&twice, &[])] {
        expect![[r#"
            N (example.Robot) ID=Text("N") number=Integer(7) gps->
        "#]]
        .assert_eq(&outcome(files, settings));
    }
}

#[test]
fn what_is_promoted_and_absent_is_told_with_what_can_be_done() {
    let fleet = part(
        "fleet",
        r#"xmlns:saoms="urn:saoms:1""#,
        r#"<property name="site">north</property><service name="at" promote="A"/>
<component name="A" saoms:if="site == 'south'"><implementation.java class="example.Gps"/></component>"#,
    );
    expect![[r#"
        2:67-68 error S2011: the component `A` is excluded by its condition
          3:31-46 this condition is false
          help: put the component and the promotion into another composite, and include that with the same condition: a promotion cannot have a condition
    "#]]
    .assert_eq(&outcome(&[&fleet], &[]));
}

/// An element with a false condition declares nothing for those that are there.
#[test]
fn expressions_take_nothing_of_what_is_kept_away() {
    const SAOMS: &str = "xmlns:saoms=\"urn:saoms:1\"";
    let robots = |count: &str| {
        format!(
            r#"<component name="G${{index}}" saoms:count="{count}"><implementation.java class="example.Gps"/></component>"#
        )
    };
    let kept_away =
        part("more", SAOMS, &format!(r#"<property name="n">2</property>{}"#, robots("n").replace('G', "M")));
    let including = |inside: &str, condition: &str| {
        let outer =
            format!(r#"<property name="big">false</property><include name="t:more" saoms:if="{condition}"/>{inside}"#);
        outcome(&[&part("fleet", SAOMS, &outer), &kept_away], &[])
    };
    expect![[r#"
        2:118-119 error S2045: the composite has no property `n`
          help: its properties are `big`
    "#]]
    .assert_eq(&including(&robots("n"), "big"));
    expect![[r#"
        G1 (example.Gps) other->
        G2 (example.Gps) other->
    "#]]
    .assert_eq(&including(&robots("2"), "big"));
    expect![[r#"
        2:71-72 error S2045: the composite has no property `n`
          help: its properties are `big`
    "#]]
    .assert_eq(&including(&robots("2"), "n == 4"));
}
