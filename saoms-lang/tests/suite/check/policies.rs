//! Elements and names of policies, held to the schemas of SCA.

use expect_test::expect;

use crate::check::support::{nested, part, shown};

/// The diagnostics of a composite of SCA 1.1, whose classes are given.
fn found(inside: &str) -> String {
    given(&part("fleet", "", inside))
}

fn given(text: &str) -> String {
    let (_, diagnostics, sources) = nested(&[text], &[], true);
    diagnostics.iter().map(|one| shown(one, &sources)).collect()
}

const COMPONENT: &str = r#"<component name="C"><implementation.java class="a.C"/><service name="S"/></component>"#;

#[test]
fn elements_of_policies_say_what_they_are_about() {
    let text = format!(
        r#"<requires/><requires intents=""/><requires intents="t:a t:b"/><requires intent="t:a"/>
<policySetAttachment/><policySetAttachment name="t:p"/><policySetAttachment name=""/>
<requires intents="t:a">text</requires><requires intents="t:a"><wire source="C/r" target="C"/></requires>
{}"#,
        COMPONENT.replace("<service name=\"S\"/>", "<service name=\"S\"><extensions>text</extensions><extensions><f:x xmlns:f=\"urn:f\"/></extensions></service>")
    );
    expect![[r#"
        2:73-79 error S1007: `requires` has no attribute `intent`
          fix: replace `intent` with `intents` [2:73-79 "intents"]
        4:25-29 error S1012: unexpected text in `requires`: it contains elements only
          help: remove it, or write a comment between `<!--` and `-->`
        4:65-69 error S1005: `wire` is not allowed in `requires`
          help: `requires` cannot contain elements of SCA
        5:85-89 error S1012: unexpected text in `extensions`: it contains elements only
          help: remove it, or write a comment between `<!--` and `-->`
    "#]]
    .assert_eq(&found(&text));
}

#[test]
fn names_of_policies_and_types_are_names() {
    let text = format!(
        r#"<service name="S" promote="C/S" requires="t:a @@ t:b:c" policySets="1x"><binding.sca name="a b"/><binding.ws name=""/><binding.ws name="x:y"/></service>
<property name="P" type="a b">x</property>
{COMPONENT}<component name="D"><implementation.java class="a.D" requires="t: ${{a}}"/><property name="p" source="$P"/></component>"#
    );
    expect![""].assert_eq(&found(&text));
}

/// In SCA 1.0 an operation has a name, and a binding may have one with a prefix.
#[test]
fn operations_and_bindings_of_sca_1_0_have_their_names() {
    let text = r#"<composite xmlns="http://www.osoa.org/xmlns/sca/1.0" targetNamespace="urn:t" name="fleet">
<component name="C"><implementation.java class="a.C"/><service name="S"><operation/><operation name="b">text</operation><binding.ws name="x:y"/></service></component></composite>"#;
    expect![""].assert_eq(&given(text));
}
