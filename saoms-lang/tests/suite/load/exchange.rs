//! Exports and imports of contributions.

use expect_test::expect;

use crate::load::definitions::{OASIS, OSOA, alone, of_folder};

fn description(namespace: &str, inside: &str) -> String {
    format!("<contribution xmlns='{namespace}' xmlns:t='urn:t' xmlns:x='urn:x'>\n{inside}</contribution>")
}

fn composite(namespace: &str) -> String {
    format!("<composite xmlns='{OASIS}' targetNamespace='{namespace}' name='fleet'/>")
}

#[test]
fn all_that_the_schemas_allow_is_right() {
    let inside = "<documentation/><deployable composite='t:fleet'><documentation/></deployable>
<import namespace='urn:q'/><import namespace='urn:q' location='http://else/where'/><import namespace=''/><import.java package='a.b'/><import.java package='a.b' location='http://x'/>
<import.cpp name='t:y' location='urn:w'/><import.resource uri='x'/><x:import.lua/>
<export namespace='urn:airport'/><export namespace='urn:q'/><export namespace='urn:types'/><export namespace='urn:desk'/><export.java package='a'/><export.c name='t:x' path='inc'/><export.resource uri='y'/>
<extensions><x:z/></extensions>";
    let files = [
        ("META-INF/sca-contribution.xml", description(OASIS, &inside.replace("t:fleet", "x:fleet"))),
        ("fleet.composite", composite("urn:airport")),
        ("more.composite", composite("urn:x")),
        ("w/t.xsd", "<schema targetNamespace='urn:types' xmlns='http://www.w3.org/2001/XMLSchema'/>".to_owned()),
        ("w/d.wsdl", "<definitions targetNamespace='urn:desk'/>".to_owned()),
    ];
    expect![""].assert_eq(&of_folder(&files));
}

#[test]
fn what_the_schemas_forbid_is_told_where_it_stands() {
    let inside = "<deployable composit='t:a'>now<component/></deployable><import/><import.c name='t:x'/><export.cpp path='x'/><export.java pakage='a'/>
<extensions/><extensions><deployable/></extensions><export namespace='urn:a' location='b'/><composite/><imports namespace='a'/>";
    expect![[r#"
        sca-contribution.xml:2:13 [composit] error S1007 `deployable` has no attribute `composit`
          replace `composit` with `composite`
        sca-contribution.xml:2:23 [t:a] warning S2051 the contribution has no composite `t:a`
          it has no composites: is it made from several folders?
        sca-contribution.xml:2:28 [now] error S1012 unexpected text in `deployable`: it contains elements only
          remove it, or write a comment between `<!--` and `-->`
        sca-contribution.xml:2:32 [component] error S1005 `component` is not allowed in `deployable`
          `deployable` can contain `documentation`, `extensions`
        sca-contribution.xml:2:57 [import] error S1008 `import` needs the attribute `namespace`
          add `namespace="..."` to it
        sca-contribution.xml:2:66 [import.c] error S1008 `import.c` needs the attribute `location`
          add `location="..."` to it
        sca-contribution.xml:2:88 [export.cpp] error S1008 `export.cpp` needs the attribute `name`
          add `name="..."` to it
        sca-contribution.xml:2:122 [pakage] error S1007 `export.java` has no attribute `pakage`
          replace `pakage` with `package`
        sca-contribution.xml:3:15 [extensions] error S1006 `contribution` has a second `extensions`
          keep one of the two
        sca-contribution.xml:3:27 [deployable] error S1004 SCA 1.1 has no element `deployable`
          `extensions` cannot contain elements of SCA
        sca-contribution.xml:3:78 [location] error S1007 `export` has no attribute `location`
          `export` has the attributes `namespace`
        sca-contribution.xml:3:93 [composite] error S1005 `composite` is not allowed in `contribution`
          `contribution` can contain `deployable`, `import`, `import.java`, `import.resource`, `import.c`, `import.cpp`, `export`, `export.java`, `export.resource`, `export.c`, `export.cpp`, `documentation`, `extensions`
        sca-contribution.xml:3:105 [imports] error S1004 SCA 1.1 has no element `imports`
          replace `imports` with `import`
    "#]].assert_eq(&alone("sca-contribution.xml", description(OASIS, inside)));
    expect![[r#"
        sca-contribution.xml:2:2 [documentation] warning S1004 `documentation` is an element of SCA 1.1, but this file is of SCA 1.0
          other programs refuse it
          write a comment instead
        sca-contribution.xml:2:18 [extensions] warning S1004 `extensions` is an element of SCA 1.1, but this file is of SCA 1.0
          other programs refuse it
        sca-contribution.xml:2:79 [t:a] warning S2051 the contribution has no composite `t:a`
          it has no composites: is it made from several folders?
    "#]].assert_eq(&alone(
        "sca-contribution.xml",
        description(
            OSOA,
            "<documentation/><extensions/><export.java package='a'/><deployable composite='t:a'/>",
        ),
    ));
}

#[test]
fn what_is_said_twice_is_told() {
    let inside = "<import namespace='urn:a'/><import namespace='urn:a' location='http://x'/><import namespace='urn:a'/><export.java package='a'/><export.java package='a'/><export namespace='urn:t'/><export namespace='urn:t'/>";
    let files = [("sca-contribution.xml", description(OASIS, inside)), ("fleet.composite", composite("urn:t"))];
    expect![[r#"
        sca-contribution.xml:2:94 [urn:a] warning S1011 `urn:a` is imported twice
          keep one of them
        sca-contribution.xml:2:150 [a] warning S1011 `a` is exported twice
          keep one of them
        sca-contribution.xml:2:200 [urn:t] warning S1011 `urn:t` is exported twice
          keep one of them
    "#]]
    .assert_eq(&of_folder(&files));
}

#[test]
fn what_is_exported_is_there() {
    let inside = "<export namespace='urn:airprt'/><export namespace='urn:other'/><export namespace='urn:airport'/>";
    let mut files =
        vec![("sca-contribution.xml", description(OASIS, inside)), ("fleet.composite", composite("urn:airport"))];
    expect![[r#"
        sca-contribution.xml:2:20 [urn:airprt] warning S2059 the contribution has no composite or definition in the namespace `urn:airprt`
          replace `urn:airprt` with `urn:airport`
        sca-contribution.xml:2:52 [urn:other] warning S2059 the contribution has no composite or definition in the namespace `urn:other`
          it has `urn:airport`
    "#]]
    .assert_eq(&of_folder(&files));
    // A file of another kind may have the other one.
    files.push(("made.bpel", "<process/>".to_owned()));
    expect![[r#"
        sca-contribution.xml:2:20 [urn:airprt] warning S2059 the contribution has no composite or definition in the namespace `urn:airprt`
          replace `urn:airprt` with `urn:airport`
    "#]]
    .assert_eq(&of_folder(&files));
    // Composites may be put beside it later.
    files.remove(1);
    assert!(!of_folder(&files).contains("S2059"));
}

#[test]
fn what_is_imported_is_exported_by_those_around() {
    let import = |namespace: &str| description(OASIS, &format!("<import namespace='{namespace}'/>"));
    let told = |namespace: &str, export: &str| {
        of_folder(&[
            ("a/sca-contribution.xml", import(namespace)),
            ("a/fleet.composite", composite("urn:airport")),
            ("b/sca-contribution.xml", description(OASIS, export)),
            ("b/fleet.composite", composite("urn:robots")),
        ])
    };
    let export = "<export namespace='urn:robots'/>";
    expect![""].assert_eq(&told("urn:robots", export));
    expect![""].assert_eq(&told("urn:elsewhere", export));
    expect![""].assert_eq(&told("urn:airport", export));
    expect![[r#"
        a/sca-contribution.xml:2:20 [urn:robot] warning S2059 no contribution around this one exports the namespace `urn:robot`
          replace `urn:robot` with `urn:robots`
    "#]].assert_eq(&told("urn:robot", export));
    expect![[r#"
        a/sca-contribution.xml:2:20 [urn:robots] warning S2059 the contribution in `b` has the namespace `urn:robots`, but does not export it
          write `<export namespace="urn:robots"/>` in its description
    "#]].assert_eq(&told("urn:robots", ""));
}
