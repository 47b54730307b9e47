//! Composites that include others, and components that composites implement.

use expect_test::expect;
use saoms_lang::diagnostic::Severity;
use saoms_lang::model::Version;

use crate::check::support::{nested, outcome, part, shown};

const ROBOT: &str = r#"<property name="period">1s</property><property name="id" mustSupply="true"/>
<service name="drive" promote="Robot/move"/>
<reference name="where" promote="Robot/gps" multiplicity="0..1"/>
<component name="Robot"><implementation.java class="example.Robot001"/>
<property name="ID" source="$id"/><property name="period" source="$period"/></component>"#;

#[test]
fn what_is_included_stands_where_it_is_included() {
    let fleet = part(
        "fleet",
        "",
        r#"<component name="A"><implementation.java class="example.Gps"/></component>
<include name="t:more"/>
<component name="C"><implementation.java class="example.Gps"/><reference name="other" target="B"/></component>"#,
    );
    let more = part(
        "more",
        "",
        r#"<property name="unused">1</property><component name="B"><implementation.java class="example.Gps"/><reference name="other" target="A"/></component>
<wire source="C/other" target="A/position" replace="true"/><property name="unused">2</property>"#,
    );
    expect![[r#"
        more:2:17-23 warning S2026: no component uses the property `unused` of the composite
          help: remove it, or use its value in a component with `source="$unused"`
        more:3:76-82 error S2003: the composite has two properties `unused`
          more:2:17-23 the first
          help: give each its own name
    "#]]
    .assert_eq(&outcome(&[&fleet, &more], &[]));
    let more = more
        .replace("<property name=\"unused\">2</property>", "")
        .replace("unused\">1", "unused\">")
        .replace("<property name=\"unused\"></property>", "");
    expect![[r#"
        A (example.Gps) other->
        B (example.Gps) other->A/position
        C (example.Gps) other->A/position
    "#]]
    .assert_eq(&outcome(&[&fleet, &more], &[]));
}

#[test]
fn autowire_of_an_included_composite_is_its_own_or_else_that_around_it() {
    let inside = r#"<component name="N"><implementation.java class="example.Navigator"/></component>"#;
    let robots = r#"<component name="T"><implementation.java class="example.Twins"/></component>"#;
    for (around, own, is_wired) in [("true", "", true), ("true", "false", false), ("", "true", true)] {
        let attribute = |value: &str| match value {
            "" => String::new(),
            value => format!("autowire=\"{value}\""),
        };
        let fleet = part("fleet", &attribute(around), &format!("<include name=\"t:more\"/>{robots}"));
        let found = outcome(&[&fleet, &part("more", &attribute(own), inside)], &[]);
        assert_eq!(found.contains("S2019"), is_wired, "{around} {own}: {found}");
        assert_eq!(found.contains("S2018"), !is_wired, "{around} {own}: {found}");
    }
}

#[test]
fn includes_that_cannot_be_say_so() {
    let fleet = part(
        "fleet",
        "",
        "<include name=\"t:more\"/>\n<include name=\"t:mor\"/>\n<include name=\"t:more\"/>\n<include name=\"u:x\"/>\n<include name=\"t:fleet\"/>\n<component name=\"A\"><implementation.java class=\"example.Gps\"/></component>",
    );
    let more = part(
        "more",
        "local=\"true\"",
        "<component name=\"A\"><implementation.java class=\"example.Gps\"/></component><include name=\"fleet\"/>",
    );
    expect![[r#"
        2:16-22 error S2034: the composite `more` is `local`, and the one that includes it is not
          more:1:128-132 `local` is set here
          help: give both composites the same `local`
        3:16-21 error S2030: there is no composite `mor` in the namespace `urn:t`
          help: name the file of that composite in the command as well
          fix: replace `t:mor` with `t:more` [3:16-21 "t:more"]
        4:16-22 error S2033: the composite `more` is included twice
          help: remove one of the includes: all of its components are there already
        5:16-19 error S2030: there is no composite `x`
          help: the prefix `u` is not declared
          help: name the file of that composite in the command as well
        6:16-23 error S2032: composites contain each other in a cycle: `fleet` -> `fleet`
          help: remove one of these: a composite cannot contain itself
        7:18-19 error S2002: there are two components `A`
          more:2:18-19 the first
          help: files given together form one fleet: for two fleets, run the command once for each file
          fix: remove the second: both are the same, word for word [7:1-75 ""]
        more:2:90-95 warning S2030: `fleet` without a prefix is in the default namespace, which is that of SCA: the composite in `urn:t` is used
          1:115-120 this composite is used
          fix: replace `fleet` with `t:fleet` [more:2:90-95 "t:fleet"]
        more:2:90-95 error S2032: composites contain each other in a cycle: `fleet` -> `more` -> `fleet`
          2:16-22 it is contained here
          help: remove one of these: a composite cannot contain itself
    "#]]
    .assert_eq(&outcome(&[&fleet, &more], &[]));
}

#[test]
fn a_composite_implements_components_each_with_its_own_values() {
    let fleet = part(
        "fleet",
        "",
        r#"<property name="pace">2s</property>
<component name="one"><implementation.composite name="t:robot"/><property name="id">R1</property></component>
<component name="two"><implementation.composite name="t:robot"/><property name="id" value="R2"/><property name="period" source="$pace"/><reference name="where" target="gps"/></component>
<component name="gps"><implementation.java class="example.Gps"/></component>
<component name="N"><implementation.java class="example.Navigator"/><reference name="wheels" target="one/drive"/></component>
<component name="M"><implementation.java class="example.Navigator"/></component><wire source="M/wheels" target="two"/>"#,
    );
    let robot = part("robot", "", ROBOT);
    expect![[r#"
        one/Robot (example.Robot001) ID=Text("R1") number=Integer(1) gps->
        two/Robot (example.Robot001) ID=Text("R2") number=Integer(1) gps->gps/position
        gps (example.Gps) other->
        N (example.Navigator) wheels->one/Robot/move task->
        M (example.Navigator) wheels->two/Robot/move task->
    "#]]
    .assert_eq(&outcome(&[&fleet, &robot], &[]));
    let (assembly, ..) = nested(&[&fleet, &robot], &["pace=5s"], false);
    let periods: Vec<u64> =
        assembly.unwrap().components.iter().filter_map(|one| Some(one.task.as_ref()?.period.as_secs())).collect();
    assert_eq!(periods, [1, 5]);
}

#[test]
fn faults_of_an_inner_composite_are_told_once_and_those_of_its_users_where_they_are() {
    let user = r#"<component name="NAME"><implementation.composite name="t:robot"/><property name="nr">7</property>
<service name="driv"/><reference name="when" target="x"/><reference name="where" target="two/drive" multiplicity="1..n"/></component>"#;
    let fleet = part("fleet", "", &format!("{}\n{}", user.replace("NAME", "one"), user.replace("NAME", "two")));
    let robot = part("robot", "", &ROBOT.replace("$period", "$perod").replace("Robot/move", "Robot/mov"));
    expect![[r#"
        2:18-21 error S2025: component `one` must give a value to the property `id` of its composite
          robot:2:54-56 declared here, without a value
          help: add `<property name="id">...</property>`
        2:81-83 error S3004: composite `robot` has no property `nr`
          help: its properties are `period` and `id`
        3:16-20 error S2005: composite `robot` has no service `driv`
          fix: replace `driv` with `drive` [3:16-20 "drive"]
        3:40-44 error S2006: composite `robot` has no reference `when`
          help: its references are `where`
        3:115-119 error S2008: the multiplicity `1..n` of `where` is wider than `0..1` in composite `robot`
          help: it can be `0..1` or `1..1`
        4:18-21 error S2025: component `two` must give a value to the property `id` of its composite
          robot:2:54-56 declared here, without a value
          help: add `<property name="id">...</property>`
        4:81-83 error S3004: composite `robot` has no property `nr`
          help: its properties are `period` and `id`
        5:16-20 error S2005: composite `robot` has no service `driv`
          fix: replace `driv` with `drive` [5:16-20 "drive"]
        5:40-44 error S2006: composite `robot` has no reference `when`
          help: its references are `where`
        5:115-119 error S2008: the multiplicity `1..n` of `where` is wider than `0..1` in composite `robot`
          help: it can be `0..1` or `1..1`
        robot:3:38-41 error S2021: component `Robot` has no service `mov`
          fix: replace `mov` with `move` [robot:3:38-41 "move"]
        robot:6:68-73 error S2024: the composite has no property `perod`
          fix: replace `perod` with `period` [robot:6:68-73 "period"]
    "#]]
    .assert_eq(&outcome(&[&fleet, &robot], &[]));
}

/// Promotion through two composites; several components behind one reference; several targets of one reference.
#[test]
fn a_value_that_is_not_of_the_type_of_an_inner_property_is_told_there_alone() {
    let fleet = part(
        "fleet",
        "",
        r#"<component name="A"><implementation.composite name="t:inner"/><property name="rank">first</property></component>"#,
    );
    let inner = part(
        "inner",
        r#"xmlns:xs="http://www.w3.org/2001/XMLSchema""#,
        r#"<property name="rank" type="xs:int"/>
<component name="R"><implementation.java class="example.Robot"/><property name="ID">R</property><property name="period">1s</property><property name="number" source="$rank"/></component>"#,
    );
    expect![[r#"
        2:85-90 error S2042: the property `rank` has the type `xs:int`: found `first`, expected a whole number of 32 bits
          inner:2:29-35 the type
          help: change the value, or the type
    "#]].assert_eq(&outcome(&[&fleet, &inner], &[]));
}

#[test]
fn references_are_wired_from_outside_through_every_level() {
    let fleet = part(
        "fleet",
        "",
        r#"<component name="hall"><implementation.composite name="t:hall"/><reference name="where" target="gps"/></component>
<component name="gps"><implementation.java class="example.Gps"/></component>
<component name="band"><implementation.composite name="t:band"/><reference name="all" target="hall/a hall/b" multiplicity="1..n"/><reference name="gps" target="gps"/></component>"#,
    );
    let hall = part(
        "hall",
        "",
        r#"<service name="a" promote="a/drive"/><service name="b" promote="b/drive"/>
<reference name="where" promote="a/where b" multiplicity="1..1"/>
<component name="a"><implementation.composite name="t:robot"/><property name="id">A</property></component>
<component name="b"><implementation.composite name="t:robot"/><property name="id">B</property></component>"#,
    );
    let band = part(
        "band",
        "",
        r#"<reference name="all" promote="C/wheels" multiplicity="0..n"/><reference name="gps" promote="C/gps" multiplicity="1..n"/>
<component name="C"><implementation.java class="example.Conductor"/></component>"#,
    );
    let robot = part("robot", "", ROBOT);
    let others = [hall.as_str(), &band, &robot];
    let with = |fleet: &str| outcome(&[fleet, others[0], others[1], others[2]], &[]);
    expect![[r#"
        hall/a/Robot (example.Robot001) ID=Text("A") number=Integer(1) gps->gps/position
        hall/b/Robot (example.Robot001) ID=Text("B") number=Integer(1) gps->gps/position
        gps (example.Gps) other->
        band/C (example.Conductor) wheels->hall/a/Robot/move+hall/b/Robot/move gps->gps/position
    "#]]
    .assert_eq(&with(&fleet));
    // Without a target, the outermost component is to blame, and not the innermost.
    let bare = fleet
        .replace("<reference name=\"where\" target=\"gps\"/>", "")
        .replace(" target=\"hall/a hall/b\"", " target=\"hall\"")
        .replace("<reference name=\"gps\" target=\"gps\"/>", "");
    expect![[r#"
        2:18-22 error S2018: reference `where` of component `hall` is not wired to a service
          help: give it a target with the interface `example.Positions`: `<reference name="where" target="..."/>`
        4:18-22 error S2018: reference `gps` of component `band` is not wired to a service
          help: give it a target with the interface `example.Positions`: `<reference name="gps" target="..."/>`
        4:95-99 error S2014: component `hall` has several services with the interface `example.Wheels`
          help: name one of `a` and `b`: `hall/...`
    "#]]
    .assert_eq(&with(&bare));
}

#[test]
fn targets_from_outside_take_the_place_of_those_inside_unless_they_must_not() {
    let fleet = part(
        "fleet",
        "",
        r#"<component name="x"><implementation.composite name="t:inner"/><reference name="all" target="T/left"/></component>
<component name="T"><implementation.java class="example.Twins"/></component>"#,
    );
    let inner = |reference: &str| {
        part(
            "inner",
            "",
            &format!(
                r#"<reference name="all" promote="C/wheels" multiplicity="0..n"/>
<component name="C"><implementation.java class="example.Conductor"/>{reference}<reference name="gps" target="G"/></component>
<component name="T"><implementation.java class="example.Twins"/></component><component name="G"><implementation.java class="example.Gps"/></component>"#
            ),
        )
    };
    let wheels = |reference: &str| {
        let found = outcome(&[&fleet, &inner(reference)], &[]);
        let start = found.find("wheels->").unwrap_or_else(|| panic!("{found}"));
        found[start..].split(' ').next().unwrap().to_owned()
    };
    assert_eq!(wheels(""), "wheels->T/left");
    assert_eq!(wheels(r#"<reference name="wheels" target="T/right"/>"#), "wheels->T/left");
    let fixed = r#"<reference name="wheels" target="T/right" nonOverridable="true" multiplicity="0..n"/>"#;
    assert_eq!(wheels(fixed), "wheels->x/T/right+T/left");
    assert_eq!(wheels(r#"<reference name="wheels" autowire="true"/>"#), "wheels->T/left");
}

#[test]
fn a_target_of_a_composites_reference_is_a_service_around_the_composite() {
    let inner = |target: &str| {
        let inside = r#"<component name="A"><implementation.java class="example.Gps"/></component><component name="H"><implementation.java class="example.Gps"/></component>"#;
        let reference = format!(r#"<reference name="other" promote="A" multiplicity="0..1" target="{target}"/>"#);
        part("inner", "", &format!("{reference}\n{inside}"))
    };
    let fleet = |reference: &str| {
        let used = format!(r#"<component name="x"><implementation.composite name="t:inner"/>{reference}</component>"#);
        let others = "<component name=\"G\"><implementation.java class=\"example.Gps\"/></component><component name=\"I\"><implementation.java class=\"example.Gps\"/></component>";
        part("fleet", "", &format!("{used}\n{others}"))
    };
    expect![[r#"
        x/A (example.Gps) other->G/position
        x/H (example.Gps) other->
        G (example.Gps) other->
        I (example.Gps) other->
    "#]]
    .assert_eq(&outcome(&[&fleet(""), &inner("G")], &[]));
    let found = outcome(&[&fleet(r#"<reference name="other" target="I"/>"#), &inner("G")], &[]);
    assert!(found.contains("x/A (example.Gps) other->I/position"), "{found}");
    expect![[r#"
        inner:2:65-66 error S2011: there is no component `H`
          help: the components are `G` and `I`
          help: use `<wire>` to wire components inside the composite: the target of a composite's reference is outside of it
    "#]]
    .assert_eq(&outcome(&[&fleet(""), &inner("H")], &[]));
    // By itself, what is around it is the domain.
    expect![[r#"
        A (example.Gps) other->H/position
        H (example.Gps) other->
    "#]]
    .assert_eq(&outcome(&[&inner("H")], &[]));
    expect![[r#"
        2:65-71 error S2011: there is no component `Nobody`
          help: the components are `A` and `H`
    "#]]
    .assert_eq(&outcome(&[&inner("Nobody")], &[]));
}

#[test]
fn autowire_finds_all_that_a_reference_takes() {
    let fleet = part(
        "fleet",
        "autowire=\"true\"",
        r#"<component name="C"><implementation.java class="example.Conductor"/></component>
<component name="T"><implementation.java class="example.Twins"/></component>
<component name="G"><implementation.java class="example.Gps"/></component>"#,
    );
    expect![[r#"
        C (example.Conductor) wheels->T/left+T/right gps->G/position
        T (example.Twins)
        G (example.Gps) other->
    "#]]
    .assert_eq(&outcome(&[&fleet], &[]));
}

#[test]
fn composites_that_multiply_end() {
    let mut texts =
        vec![part("c0", "", "<component name=\"a\"><implementation.java class=\"example.Gps\"/></component>")];
    for level in 1..30 {
        let inner = level - 1;
        let one = |name: &str| {
            format!("<component name=\"{name}\"><implementation.composite name=\"t:c{inner}\"/></component>")
        };
        texts.insert(0, part(&format!("c{level}"), "", &(one("a") + &one("b"))));
    }
    let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
    let (assembly, diagnostics, sources) = nested(&texts, &[], false);
    assert!(assembly.is_none());
    let codes: Vec<&str> = diagnostics.iter().map(|one| one.code.id).collect();
    assert_eq!(codes, ["S2035"], "{}", shown(&diagnostics[0], &sources));
}

#[test]
fn what_is_taken_as_given_has_no_fault_of_its_own() {
    let fleet = part(
        "fleet",
        "",
        r#"<component name="A"><implementation.java class="some.Class"/><property name="p" source="$x"/><reference name="r" target="B/any C"/></component>
<component name="B"><implementation.composite name="t:else"/></component>
<component name="C"><implementation.spring location="x"/></component>
<component name="N"><implementation.java class="example.Navigator"/><reference name="wheels" target="A"/></component>
<wire source="B/out" target="D"/>"#,
    );
    let (assembly, diagnostics, sources) = nested(&[&fleet], &[], true);
    assert!(assembly.is_none());
    let found: String = diagnostics.iter().map(|one| shown(one, &sources)).collect();
    expect![[r#"
        2:90-91 error S2024: the composite has no property `x`
          help: declare it: `<property name="...">...</property>` in the composite
        3:53-59 warning S2031: there is no composite `else` in the namespace `urn:t`
          help: name the file of that composite in the command as well
        6:30-31 warning S2011: there is no component `D` in these composites
          help: the components are `A`, `C` and `N`
          help: it is not checked: another composite of the domain may have it
    "#]]
    .assert_eq(&found);
}

#[test]
fn types_of_a_property_and_of_what_gives_its_value_fit() {
    let xsd = "xmlns:x=\"http://www.w3.org/2001/XMLSchema\"";
    let inner = part("hall", xsd, r#"<property name="size" type="x:int"/>"#);
    let fleet = |of: &str, source: &str| {
        let inside = format!(
            "<property name=\"all\" type=\"{source}\">4</property>\n<component name=\"H\"><implementation.composite name=\"t:hall\"/><property name=\"size\" type=\"{of}\" source=\"$all\"/></component>"
        );
        faults_only(&outcome(&[&part("fleet", xsd, &inside), &inner], &[]))
    };
    assert_eq!(fleet("x:short", "x:integer"), "");
    expect![[r#"
        3:90-99 error S3007: the property `size` has the type `x:boolean` here, but `x:int` where it is declared
          hall:2:29-34 where it is declared
          help: remove `type`: the type of the declaration is used
        3:109-113 error S3007: the property `size` has the type `x:boolean` here, but `x:string` where its value comes from
          3:90-99 its type
          2:28-36 where its value comes from
          help: give both the same type
    "#]].assert_eq(&fleet("x:boolean", "x:string"));
}

/// Without the warnings about properties that nothing uses.
fn faults_only(found: &str) -> String {
    found
        .split_inclusive('\n')
        .filter(|line| !line.contains("no component uses") && !line.contains("use its value in a component"))
        .collect()
}

/// Nobody here takes what a composite promotes that runs by itself; one that implements a component is another matter.
#[test]
fn what_a_composite_of_1_0_promotes_by_itself_is_a_warning() {
    let inside = r#"<service name="s" promote="A/s"/><service name="s" promote="B"/><reference name="r" promote="A/r"/>
<component name="A"><implementation.java class="other.A"/><service name="s"/></component>"#;
    let inner = part("inner", "", inside);
    let outer = part("outer", "", r#"<component name="A"><implementation.composite name="t:inner"/></component>"#);
    let of_1_0 = |text: &str| text.replace(Version::Oasis200912.namespace(), Version::Osoa10.namespace());
    let found = |texts: &[&str]| {
        let texts: Vec<String> = texts.iter().map(|text| of_1_0(text)).collect();
        let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
        let (_, diagnostics, _) = nested(&texts, &[], true);
        let found = diagnostics.iter().filter(|one| one.code.id != "S2022");
        found.map(|one| format!("{} {}\n", one.severity.name(), one.message)).collect::<String>()
    };
    let faults = |severity: &str| {
        format!("{severity} the composite has two services `s`\n{severity} there is no component `B`\n")
    };
    assert_eq!(found(&[&inner]), faults("warning"));
    assert_eq!(found(&[&outer, &inner]), faults("error"));
    let (_, diagnostics, _) = nested(&[&inner], &[], true);
    assert_eq!(diagnostics.iter().filter(|one| one.severity == Severity::Error).count(), 2);
}

#[test]
fn what_a_missing_include_would_bring_is_not_told_again() {
    let fleet = part(
        "fleet",
        "",
        r#"<include name="t:hall"/><service name="s" promote="R/x"/><wire source="R/gps" target="S"/>
<component name="N"><implementation.java class="example.Navigator"/><reference name="wheels" target="R/move"/></component>"#,
    );
    for assumes in [false, true] {
        let (_, found, sources) = nested(&[&fleet], &[], assumes);
        let found: Vec<String> = found.iter().map(|one| shown(one, &sources)).collect();
        assert!(found.len() == 1 && found[0].contains("S2030"), "{found:?}");
    }
}

#[test]
fn a_name_that_means_another_namespace_than_it_leads_to_says_so() {
    let fleet = part(
        "fleet",
        "xmlns:u=\"urn:u\"",
        "<include name=\"hall\"/>\n<include name=\"yard\"/>\n<component name=\"A\"><implementation.composite name=\"hall\"/></component>\n<component name=\"B\"><implementation.composite name=\"x:hall\"/></component>\n<include name=\"u:dock\"/>",
    );
    let gps =
        |name: &str| format!("<component name=\"{name}\"><implementation.java class=\"example.Gps\"/></component>");
    let hall = part("hall", "", &gps("H"));
    let yard = part("yard", "", &gps("Y")).replace("targetNamespace=\"urn:t\"", "");
    let dock = part("dock", "", &gps("D")).replace("\"urn:t\"", "\"urn:u\"");
    expect![[r#"
        2:16-20 warning S2030: `hall` without a prefix is in the default namespace, which is that of SCA: the composite in `urn:t` is used
          hall:1:115-119 this composite is used
          fix: replace `hall` with `t:hall` [2:16-20 "t:hall"]
        3:16-20 warning S2030: `yard` without a prefix is in the default namespace, which is that of SCA: the composite in no namespace is used
          yard:1:92-96 this composite is used
          help: give it a `targetNamespace`, and name it with a prefix of that namespace
        4:53-57 warning S2031: `hall` without a prefix is in the default namespace, which is that of SCA: the composite in `urn:t` is used
          hall:1:115-119 this composite is used
          fix: replace `hall` with `t:hall` [4:53-57 "t:hall"]
        5:53-59 warning S2031: the prefix `x` is not declared: the composite in `urn:t` is used
          hall:1:115-119 this composite is used
          fix: replace `x:hall` with `t:hall` [5:53-59 "t:hall"]
        yard:1:2-11 error S1009: `composite` has no `targetNamespace`
          help: add `targetNamespace="urn:..."`: other composites refer to this one by it
    "#]].assert_eq(&outcome(&[&fleet, &hall, &yard, &dock], &[]));
    // Where no prefix is bound, one is declared; a default namespace of the author's own is what is meant.
    let no_prefix =
        fleet.replace("xmlns:t=\"urn:t\"", "").lines().take(2).collect::<Vec<_>>().join("\n") + "</composite>";
    expect![[r#"
        2:16-20 warning S2030: `hall` without a prefix is in the default namespace, which is that of SCA: the composite in `urn:t` is used
          hall:1:115-119 this composite is used
          fix: insert `xmlns:tns="urn:t"` into `composite`, and replace `hall` with `tns:hall` [1:11-11 " xmlns:tns=\"urn:t\""] [2:16-20 "tns:hall"]
        H (example.Gps) other->
    "#]].assert_eq(&outcome(&[&no_prefix, &hall], &[]));
    let own = "<s:composite xmlns:s=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns=\"urn:t\" targetNamespace=\"urn:f\" name=\"fleet\"><s:include name=\"hall\"/></s:composite>";
    expect![[r#"
        H (example.Gps) other->
    "#]]
    .assert_eq(&outcome(&[own, &hall], &[]));
}
