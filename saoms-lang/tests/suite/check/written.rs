//! Rules that need no class: bindings, targets and values as they are written.

use expect_test::expect;

use crate::check::component_types::found;
use crate::check::support::{faults, outcome, part};

/// The diagnostics of a component of an unknown class.
fn given(inside: &str) -> String {
    let inside = format!("<component name='A'><implementation.java class='x.A'/>\n{inside}</component>");
    found(&inside, &[], true)
}

#[test]
fn a_target_and_an_address_exclude_each_other() {
    let wrong = "<reference name='a' target='A'><binding.ws uri='http://a'/></reference>
<reference name='b' target='A'><binding.ws/></reference><reference name='c'><binding.ws uri='http://a'/></reference>
<reference name='d'><binding.ws uri='http://a' wsdlElement='http://x#wsdl.port(S/P)'/></reference>
<reference name='e'><binding.ws uri='http://a' wsdlElement='http://x#wsdl.binding(B)'/></reference>
<reference name='f' multiplicity='0..1'><binding.ws uri='http://a'/><binding.jms name='j' uri='jms:a'/></reference>
<reference name='g' multiplicity='0..n'><binding.ws uri='http://a'/><binding.jms name='j' uri='jms:a'/></reference>";
    expect![[r#"
        3:49-57 error S2054: reference `a` has a target, and a binding to `http://a`
          3:29-30 the target
          help: keep one of them
    "#]]
    .assert_eq(&given(wrong));
}

#[test]
fn bindings_without_a_name_are_called_as_what_they_bind() {
    let wrong = "<service name='a'><binding.ws/><binding.jms/></service>
<service name='b'><binding.ws/><binding.sca name='b'/></service>
<service name='c'><binding.ws/><binding.sca name='d'/></service>
<service name='e'><binding.ws name='f'/><callback><binding.ws name='f'/><binding.jms name='f'/></callback></service>";
    expect![[r#"
        3:33-44 warning S2040: service `a` has two bindings `a`: this is the default name of `binding.jms`
          3:20-30 the first
          help: give each its own name
        4:51-52 warning S2040: service `b` has two bindings `b`: this is the default name of `binding.ws`
          4:20-30 the first
          help: give each its own name
        6:92-93 error S2040: the callback of `e` has two bindings `f`
          6:69-70 the first
          help: give each its own name
    "#]]
    .assert_eq(&given(wrong));
}

#[test]
fn targets_name_bindings_that_are_written() {
    let wrong = "<service name='s'><binding.ws name='q'/></service><service name='t'/>
<reference name='a' target='A/s/zz A/s/q A/t/zz'/>";
    expect![[r#"
        4:33-35 error S2013: service `s` of component `A` has no binding `zz`
          help: its bindings are `q`
    "#]]
    .assert_eq(&given(wrong));
}

#[test]
fn a_property_for_one_value_has_one() {
    let wrong = "<property name='a' many='false'><value>1</value><value>2</value></property>
<property name='b'><value>1</value><value>2</value></property>
<property name='c' many='false' source='$two'/></component>
<property name='two' many='true'><value>1</value><value>2</value></property>
<property name='one'><value>1</value><value>2</value></property>
<component name='B'><implementation.java class='x.B'/><property name='c' source='$one'/>";
    expect![[r#"
        7:39-44 error S3011: the property `one` allows one value, found 2
          7:23-28 the first
          help: keep one of them, or write `many="true"` where the property is declared
    "#]]
    .assert_eq(&given(wrong));
    let inner = "<component name='R'><implementation.java class='example.Robot001'/><property name='ID'>R</property><property name='period' many='true'>1</property></component>";
    expect![[r#"
        2:130-134 error S3011: the property `period` allows one value, but is declared here to allow several
          help: remove `many`
    "#]]
    .assert_eq(&faults(inner));
}

#[test]
fn values_are_written_as_their_types_ask_for() {
    let right = [
        ("date", "2026-11-22"),
        ("date", "-0044-02-29Z"),
        ("time", "23:59:59.5+01:00"),
        ("time", "24:00:00"),
        ("dateTime", "2026-11-22T12:30:00"),
        ("duration", "-P1Y2M3DT4H5M6.7S"),
        ("duration", "PT1H"),
        // Their units in whatever order.
        ("duration", "P1H"),
        ("duration", "P1.5D"),
        ("gYear", "2026"),
        ("gYearMonth", "2026-11"),
        ("gMonth", "--11"),
        ("gMonthDay", "--02-29"),
        ("gDay", "---31"),
        ("QName", "t:x"),
        ("NCName", "a.b-c"),
        ("ID", "_1"),
        ("NMTOKEN", "1:2"),
        ("language", "de-AT-1996"),
        ("hexBinary", "0aFF"),
        ("hexBinary", ""),
        ("base64Binary", "YQ=="),
        ("anyURI", "http://x/%20 y"),
        ("string", ""),
        ("t:date", "soon"),
        // Values of other types are accepted unjudged.
        ("date", "2026-13-01"),
        ("date", "2026-02-30"),
        ("date", "26-01-01"),
        ("time", "25:00:00"),
        ("time", "12:30"),
        ("dateTime", "2026-11-22"),
        ("dateTime", "2026-11-22Z T1:00:00"),
        ("gYear", "x"),
        ("gYearMonth", "2026-13"),
        ("gMonth", "11"),
        ("gMonthDay", "--02-30"),
        ("gDay", "---32"),
        ("NCName", "a b"),
        ("ID", "1"),
        ("NMTOKEN", "a b"),
        ("language", "!!"),
        ("hexBinary", "xyz"),
        ("base64Binary", "*"),
    ];
    let wrong = [
        ("duration", "5"),
        ("duration", "P"),
        ("duration", "PT"),
        ("QName", "a:b:c"),
        ("anyURI", "%%% ^"),
        ("int", ""),
    ];
    let all = |values: &[(&str, &str)]| {
        let (mut declared, mut used) = (String::new(), String::new());
        for (place, (of, value)) in values.iter().enumerate() {
            let of = if of.contains(':') { (*of).to_owned() } else { format!("xsd:{of}") };
            declared += &format!("<property name='p{place}' type='{of}' value='{value}'/>\n");
            used += &format!("<property name='p{place}' source='$p{place}'/>");
        }
        given(&format!("</component>{declared}<component name='B'><implementation.java class='x.B'/>{used}"))
    };
    assert_eq!(all(&right), "");
    let told = all(&wrong);
    for (place, one) in wrong.iter().enumerate() {
        assert!(told.contains(&format!("error S2042: the property `p{place}` has the type")), "{one:?}\n{told}");
    }
    expect![[r#"
        3:60-61 error S2042: the property `p0` has the type `xsd:duration`: found `5`, expected a duration such as `PT1H30M`
          3:39-51 the type
          help: change the value, or the type
        4:48-49 error S2042: the property `p1` has the type `xsd:duration`: found `P`, expected a duration such as `PT1H30M`
          4:27-39 the type
          help: change the value, or the type
    "#]].assert_eq(&all(&wrong[..2]));
    expect![[r#"
        3:14-22 error S2042: the property `p0` has the type `xsd:int`: found nothing, expected a whole number of 32 bits
          3:39-46 the type
          help: change the value, or the type
    "#]]
    .assert_eq(&all(&[("int", "")]));
}

#[test]
fn variables_have_names_that_somebody_can_set() {
    let told = given(
        "</component><property name='n' xmlns:saoms='urn:saoms:1' saoms:env='9 bad' many='false'>2</property><component name='B'><implementation.java class='x.B'/><property name='p' source='$n'/>",
    );
    expect![[r#"
        3:69-74 error S1011: `9 bad` is not a name of an environment variable: use letters, digits and `_`, and no digit first
    "#]].assert_eq(&told);
}

#[test]
fn what_its_implementation_wires_nothing_else_wires() {
    let inside = "<component name='A'><implementation.java class='x.A'/>
<reference name='a' wiredByImpl='true' target='B'/><reference name='b' wiredByImpl='true' multiplicity='0..1'><binding.ws uri='http://b'/></reference>
<reference name='c' wiredByImpl='true' autowire='true'/><reference name='d' wiredByImpl='true'/>
<reference name='e' wiredByImpl='true' autowire='false'><binding.ws/></reference><reference name='f' wiredByImpl='false' target='B'/></component>
<component name='B'><implementation.java class='x.B'/></component>
<wire source='A/d' target='B'/><wire source='A/f' target='B/s' replace='true'/>";
    expect![[r#"
        3:48-49 error S2038: reference `a` is wired by its implementation, but has a target
          3:34-38 `wiredByImpl` is set here
          help: remove the target, or `wiredByImpl`
        3:128-136 error S2038: reference `b` is wired by its implementation, but has a binding that leads to one
          3:85-89 `wiredByImpl` is set here
          help: remove the `uri` of the binding, or `wiredByImpl`
        4:50-54 error S2038: reference `c` is wired by its implementation, but has `autowire`
          4:34-38 `wiredByImpl` is set here
          help: remove `autowire`, or `wiredByImpl`
        7:15-18 error S2038: reference `d` is wired by its implementation, but starts a wire
          4:90-94 `wiredByImpl` is set here
          help: remove the wire, or `wiredByImpl`
    "#]]
    .assert_eq(&found(inside, &[], true));
    assert!(!found(&inside.replace("='true' target", "='0' target"), &[], true).contains("`a`"));
}

#[test]
fn what_the_implementation_inside_wires_nothing_outside_wires() {
    let inner = "<component name='B'><implementation.java class='x.B'/>
<reference name='a'/><reference name='b' wiredByImpl='true'/><reference name='c'/></component>
<reference name='a' promote='B/a' wiredByImpl='true' multiplicity='0..1'/><reference name='b' promote='B/b' multiplicity='0..1'/>
<reference name='c' promote='B/c' multiplicity='0..1'/>";
    let outer = "<component name='A'><implementation.composite name='t:inner'/>
<reference name='a' target='C'/><reference name='c' target='C'/></component>
<component name='C'><implementation.java class='x.C'/></component><wire source='A/b' target='C'/>";
    let told = outcome(&[&part("outer", "", outer), &part("inner", "", inner)], &[]);
    let told: Vec<&str> = told.lines().filter(|line| line.contains("S2038")).collect();
    expect![[r#"
        3:29-30 warning S2038: reference `a` is wired by its implementation, but has a target
        4:81-84 warning S2038: reference `b` is wired by its implementation, but starts a wire"#]]
    .assert_eq(&told.join("\n"));
    let described = [("A.componentType", "<reference name='a' wiredByImpl='true'/>")];
    let inside = "<component name='A'><implementation.java class='x.A'/><reference name='a' target='C'/></component>
<component name='C'><implementation.java class='x.C'/></component>
<reference name='r' promote='A/a' wiredByImpl='true' target='C' multiplicity='0..1'/>";
    expect![[r#"
        2:83-84 warning S2038: reference `a` is wired by its implementation, but has a target
          A.componentType:2:34-38 `wiredByImpl` is set here
          help: remove the target, or `wiredByImpl`
        4:62-63 warning S2038: reference `r` is wired by its implementation, but has a target
          4:48-52 `wiredByImpl` is set here
          help: remove the target, or `wiredByImpl`
    "#]]
    .assert_eq(&found(inside, &described, true));
}
