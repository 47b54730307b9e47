//! One slip of the pen is reported once, and none is skipped.

use super::{JAVA, OASIS, OSOA, faults, faults_1_0, faults_1_1};

#[test]
fn a_namespace_that_is_nearly_one_of_ours_is_told() {
    let with = |declaration: &str, component: &str, expected: &str| {
        let text = format!(
            "<composite xmlns='{OASIS}' {declaration} name='c' targetNamespace='u'>\n<component name='a' {component}>{JAVA}</component></composite>"
        );
        let column = format!("1:{}", "<composite xmlns='".len() + OASIS.len() + "' xmlns:x='".len() + 1);
        faults(&text, &expected.replace("1:1", &column));
    };
    let ours = |written: &str| {
        format!(
            "1:1 [{written}] warning S1013 unknown namespace `{written}`: did you mean `urn:saoms:1`? \
             | replace it with `urn:saoms:1`"
        )
    };
    for written in
        ["urn:saom:1", "urn:soams:1", "urn:saoms:2", "urn:SAOMS:1", "urn:saoms", "urn:saoms:1/", "urn:saomss:1"]
    {
        with(&format!("xmlns:x='{written}'"), "x:if='false'", &ours(written));
        with(&format!("xmlns:x='{written}'"), "", "");
    }
    // Mixed sites would be another fleet.
    with("xmlns:x='urn:saoms'", "x:site='N'", &ours("urn:saoms").replace("warning", "error"));
    with("xmlns:x='urn:some:1'", "x:if='false'", "");
    let draft = "http://docs.oasis-open.org/ns/opencsa/sca/200712";
    with(&format!("xmlns:x='{draft}'"), "x:note=''", "");
    let slip = "http://docs.oasis-open.org/ns/openscsa/sca/200912";
    with(
        &format!("xmlns:x='{slip}'"),
        "x:note=''",
        &format!(
            "1:1 [{slip}] warning S1013 unknown namespace `{slip}`: did you mean `{OASIS}`? | replace it with `{OASIS}`"
        ),
    );
}

#[test]
fn an_element_of_another_version_is_told_once() {
    faults_1_1(
        &format!("<component name='a' xmlns:o='{OSOA}'><o:implementation.foo/>{JAVA}</component>"),
        "2:66 [o:implementation.foo] error S1003 `o:implementation.foo` is of SCA 1.0, but the composite is of SCA 1.1",
    );
}

#[test]
fn the_end_tag_of_a_misspelt_element_is_right() {
    faults_1_1(
        &format!("<componnt name='a'>{JAVA}</component>"),
        "2:2 [componnt] error S1004 SCA 1.1 has no element `componnt` | replace `componnt` with `component`",
    );
    faults_1_1(
        &format!("<component name='a'>{JAVA}</componnt>"),
        "2:55 [</componnt>] error S0102 `</componnt>` found where `</component>` is expected | replace it with `</component>`",
    );
}

#[test]
fn an_element_that_is_closed_too_late_or_too_early_is_told_once() {
    let component =
        |inside: &str| format!("<component name='a'>{inside}</component>\n<component name='b'>{JAVA}</component>");
    faults_1_1(
        &component("<implementation.java class='x.Y'><property name='p'>1</property><property name='q'>2</property>"),
        "2:22 [implementation.java] error S0103 `<implementation.java class='x.Y'>` has no end tag | end `implementation.java` with `/>`",
    );
    faults_1_1(
        &component(&format!("{JAVA}<property name='p'>1<property><property name='q'>2</property>")),
        "2:75 [<property>] error S0102 `<property>` found where `</property>` is expected | replace it with `</property>`",
    );
    faults_1_1(
        &component(&format!("{JAVA}<property name='p'>1<property name='q'>2</property>")),
        "2:56 [property] error S0103 `<property name='p'>` has no end tag | close `property`",
    );
    faults_1_1(
        &format!(
            "<component name='a'>{JAVA}\n<component name='b'>{JAVA}</component><component name='c'>{JAVA}</component>"
        ),
        "2:2 [component] error S0103 `<component name='a'>` has no end tag | close `component`",
    );
    faults_1_1(
        &format!("<component name='a'/>{JAVA}<property name='p'>1</property>\n</component>"),
        "3:1 [</component>] error S0102 `</component>` found where `</composite>` is expected | remove its `/`",
    );
    faults_1_1(
        &component(&format!("{JAVA}<property name='p'/>1</property><property name='q'>2</property>")),
        "2:76 [</property>] error S0102 `</property>` found where `</component>` is expected | remove its `/`",
    );
    // A fault of another kind leaves elements open as well.
    faults_1_1(
        &format!("<component name='a'>{JAVA}<component name='b'/>&nbsp;</component>"),
        "2:56 [component] error S1005 `component` is not allowed in `component`\n\
         2:76 [&nbsp;] error S0109 unknown entity `&nbsp;`",
    );
}

#[test]
fn a_misspelt_element_is_read_on() {
    let content = format!(
        "<componant name='a'>{JAVA}<porperty name='p'><valeu>1</valeu></porperty><Reference name='r' target='b'/></componant>"
    );
    let text = format!("<composite xmlns='{OASIS}' name='c' targetNamespace='u'>{content}</composite>");
    let (composite, faults) = super::loaded(&text);
    assert_eq!(faults.lines().count(), 4, "{faults}");
    let component = &composite.unwrap().components[0];
    assert_eq!(component.class().unwrap(), &"x.Y");
    assert_eq!(component.property("p").unwrap().values().len(), 1);
    assert_eq!(component.reference("r").unwrap().targets[0].as_str(), "b");
}

#[test]
fn a_remark_as_other_languages_write_it_becomes_a_comment() {
    faults_1_1(
        "# the hall",
        "2:1 [# the hall] error S1012 unexpected text in `composite`: it contains elements only | write it as a comment",
    );
    faults_1_1("the hall", "2:1 [the hall] error S1012 unexpected text in `composite`: it contains elements only");
}

#[test]
fn what_one_version_of_sca_alone_has_is_told_once() {
    let inside = format!(
        "<documentation>a</documentation><component name='a'>{JAVA}\n<documentation/><service name='s'><operation name='o'/></service><service name='t'><operation name='o'/></service></component>"
    );
    faults_1_0(
        &inside,
        "2:2 [documentation] warning S1004 `documentation` is an element of SCA 1.1, but this file is of SCA 1.0",
    );
    faults_1_1(
        &inside,
        "3:36 [operation] warning S1004 `operation` is an element of SCA 1.0, but this file is of SCA 1.1",
    );
}

#[test]
fn names_are_those_of_xml() {
    let component = |name: &str| format!("<component name='{name}'>{JAVA}</component>");
    for right in ["a1", "_", "\u{e4}-.", "${artifactId}", "\u{442}"] {
        faults_1_1(&component(right), "");
    }
    let told = |name: &str, why: &str| {
        let expected = format!("2:18 [{name}] warning S1011 `{name}` {why}: it is not an XML name");
        faults_1_1(&component(name), &expected);
        faults_1_0(&component(name), &expected);
    };
    told("1a", "does not start with a letter or `_`");
    told("-a", "does not start with a letter or `_`");
    told("t:a", "has a colon in it");
}
