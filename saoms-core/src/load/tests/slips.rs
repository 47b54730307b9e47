//! One slip of the pen is told once, and none is passed over.

use super::{JAVA, OASIS, OSOA, faults, faults_1_1};

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
            "1:1 [{written}] warning S1013 what is in the namespace `{written}` is passed over: it is nearly `urn:saoms:1` \
             | replace it with `urn:saoms:1`"
        )
    };
    for written in [
        "urn:saom:1",
        "urn:soams:1",
        "urn:saoms:2",
        "urn:SAOMS:1",
        "urn:saoms",
        "urn:saoms:1/",
        "urn:saomss:1",
    ] {
        with(&format!("xmlns:x='{written}'"), "x:if='false'", &ours(written));
        with(&format!("xmlns:x='{written}'"), "", "");
    }
    with("xmlns:x='urn:some:1'", "x:if='false'", "");
    let draft = "http://docs.oasis-open.org/ns/opencsa/sca/200712";
    with(&format!("xmlns:x='{draft}'"), "x:note=''", "");
    let slip = "http://docs.oasis-open.org/ns/openscsa/sca/200912";
    with(
        &format!("xmlns:x='{slip}'"),
        "x:note=''",
        &format!(
            "1:1 [{slip}] warning S1013 what is in the namespace `{slip}` is passed over: it is nearly `{OASIS}` | replace it with `{OASIS}`"
        ),
    );
}

#[test]
fn an_element_of_another_version_is_told_once() {
    faults_1_1(
        &format!("<component name='a' xmlns:o='{OSOA}'><o:implementation.foo/>{JAVA}</component>"),
        "2:66 [o:implementation.foo] error S1003 `o:implementation.foo` is of SCA 1.0, and the composite is of SCA 1.1",
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
