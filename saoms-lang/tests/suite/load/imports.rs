//! Imports of one contribution from another.

use expect_test::expect;

use crate::load::named::{composite, links};

pub(crate) fn description(inside: &str) -> String {
    format!("<contribution xmlns='http://docs.oasis-open.org/ns/opencsa/sca/200912'>{inside}</contribution>")
}

/// A fleet that includes `b:hall`, in a contribution that says this, and the hall, in one that says that.
fn between(importing: &str, exporting: &str) -> String {
    let files = [
        ("fleet/META-INF/sca-contribution.xml", description(importing)),
        ("fleet/fleet.composite", composite("urn:a", "fleet", "<include name='b:hall'/>")),
        ("halls/sca-contribution.xml", description(exporting)),
        ("halls/deep/hall.composite", composite("urn:b", "hall", "<include name='b:door'/>")),
        ("halls/door.composite", composite("urn:b", "door", "")),
        ("far/off/sca-contribution.xml", description("<export namespace='urn:b'/>")),
        ("far/off/hall.composite", composite("urn:b", "hall", "")),
    ];
    links(&files, "fleet/fleet.composite")
}

#[test]
fn what_is_imported_is_found_where_it_is_exported() {
    // What a contribution names itself is looked for in it.
    expect![[r"
        fleet/fleet.composite: b:hall -> halls/deep/hall.composite
        halls/deep/hall.composite: b:door -> halls/door.composite
    "]]
    .assert_eq(&between("<import namespace='urn:b'/>", "<export namespace='urn:b'/>"));
    let location = "<import namespace='urn:b' location='../far/off'/>";
    assert_eq!(between(location, ""), "fleet/fleet.composite: b:hall -> fleet/../far/off/hall.composite\n");
    // An address elsewhere is no folder.
    let elsewhere = "<import namespace='urn:b' location='http://halls'/>";
    assert!(between(elsewhere, "<export namespace='urn:b'/>").contains("-> halls/deep/hall.composite"));
}

#[test]
fn what_is_not_imported_says_what_is_lacking() {
    expect![[r#"
        fleet/fleet.composite: b:hall is missing, near []; searched the files `*.composite` in `fleet` and below; the contribution in `halls` has it: write `<import namespace="urn:b"/>` in `fleet/META-INF/sca-contribution.xml`
    "#]]
    .assert_eq(&between("", "<export namespace='urn:b'/>"));
    expect![[r#"
        fleet/fleet.composite: b:hall is missing, near []; searched the files `*.composite` in `fleet` and below; the contribution in `halls` has it: write `<import namespace="urn:b"/>` in `fleet/META-INF/sca-contribution.xml`, and write `<export namespace="urn:b"/>` in `halls/sca-contribution.xml`
    "#]]
    .assert_eq(&between("", "<export namespace='urn:c'/>"));
    let files = [
        ("sca-contribution.xml", description("<import namespace='urn:a'/><import/><import namespace='urn:unused'/>")),
        ("fleet.composite", composite("urn:c", "fleet", "<include name='a:hall'/><include name='b:hall'/>")),
    ];
    expect![[r#"
        fleet.composite: a:hall is missing, near []; searched the files `*.composite` in `FOLDER` and below; `sca-contribution.xml` imports the namespace `urn:a`, which no known contribution exports: name a composite of it beside this one, or write its folder as `location` of the `import`
        fleet.composite: b:hall is missing, near []; searched the files `*.composite` in `FOLDER` and below
        sca-contribution.xml S1008
    "#]]
    .assert_eq(&links(&files, "fleet.composite"));
}

#[test]
fn descriptions_that_cannot_be_read_say_so() {
    for (text, code) in [("<contribution", "S0"), ("<composite/>", "S1001"), ("", "S0")] {
        let files = [
            ("sca-contribution.xml", text.to_owned()),
            ("fleet.composite", composite("urn:a", "fleet", "<include name='b:hall'/>")),
        ];
        let found = links(&files, "fleet.composite");
        assert!(found.contains(&format!("\nsca-contribution.xml {code}")), "{found}");
    }
}

#[test]
fn component_types_of_imported_packages_are_found() {
    let component = "<component name='c'><implementation.java class='halls.Door'/></component>";
    for (import, is_found) in [("<import.java package='halls'/>", true), ("", false)] {
        let files = [
            ("fleet/sca-contribution.xml", description(import)),
            ("fleet/fleet.composite", composite("urn:a", "fleet", component)),
            ("doors/sca-contribution.xml", description("<export.java package='halls'/>")),
            ("doors/halls/Door.componentType", "<wrong/>".to_owned()),
        ];
        let expected = if is_found { "doors/halls/Door.componentType S1001\n" } else { "" };
        assert_eq!(links(&files, "fleet/fleet.composite"), expected);
    }
}

#[test]
fn what_is_wrong_with_a_description_is_told_once() {
    let export = "<export namespace='urn:b'/>";
    // What can be read counts.
    expect![[r#"
        fleet/fleet.composite: b:hall -> halls/deep/hall.composite
        halls/deep/hall.composite: b:door -> halls/door.composite
        fleet/META-INF/sca-contribution.xml S0102
    "#]]
    .assert_eq(&between("<import namespace='urn:b'>", export));
    // What it imports is not known.
    expect![[r#"
        fleet/fleet.composite: b:hall is faulty
        fleet/META-INF/sca-contribution.xml S0105
    "#]]
    .assert_eq(&between("<import namespace/>", export));
    expect![[r#"
        fleet/fleet.composite: b:hall -> halls/deep/hall.composite
        halls/deep/hall.composite: b:door -> halls/door.composite
        fleet/META-INF/sca-contribution.xml S0001
    "#]]
    .assert_eq(&between("<import namespace='urn:b' location='../nowhere'/>", export));
}

#[test]
fn a_description_that_is_no_xml_is_judged_as_far_as_it_can_be_read() {
    let damaged = description("<deployable composite=fleet/>\n<deployabel composite='t:fleet'/>\n<import/>");
    expect![[r#"
        sca-contribution.xml:1:94 [fleet] error S0105 the value of `composite` is not in quotes
          put it in quotes
        sca-contribution.xml:1:94 [fleet] warning S2051 the contribution has no composite `fleet`
          write it with a prefix of the composite's target namespace
          it has no composites: is it made from several folders?
        sca-contribution.xml:2:2 [deployabel] error S1004 SCA 1.1 has no element `deployabel`
          replace `deployabel` with `deployable`
        sca-contribution.xml:3:2 [import] error S1008 `import` needs the attribute `namespace`
          add `namespace="..."` to it
    "#]]
    .assert_eq(&crate::load::definitions::alone("sca-contribution.xml", damaged));
}
