//! Composites that are given what they need from outside.

use expect_test::expect;

use crate::fleets::fleet;
use crate::support::{outcome, part};

/// What a component gives the composite that it implements counts for expressions as it does for sources, however it is given.
#[test]
fn expressions_inside_of_composites_take_what_sources_lead_to() {
    let hall = part(
        "hall",
        "xmlns:saoms=\"urn:saoms:1\"",
        r#"<property name="count">7</property><property name="open">false</property>
<component name="G${index}" saoms:count="count" saoms:if="open"><implementation.java class="example.Gps"/></component>"#,
    );
    let outer = |given: &str| {
        fleet(&format!(
            r#"<property name="halls"><hall id="a" xmlns=""><count>1</count><open>true</open></hall><hall id="b" xmlns=""><count>2</count><open>true</open></hall></property>
<component name="Hall"><implementation.composite name="t:hall"/>{given}</component>"#
        ))
    };
    let both = |count: &str, open: &str| {
        let given =
            format!(r#"<property name="count" source="{count}"/><property name="open" source="{open}"/>"#);
        outcome(&[&outer(&given), &hall], &[])
    };
    expect![[r#"
        Hall/G1 (example.Gps) other->
        Hall/G2 (example.Gps) other->
    "#]]
    .assert_eq(&both("$halls/hall[@id='b']/count", "$halls/hall[1]/open"));
    expect![[r#"
        Hall/G1 (example.Gps) other->
    "#]]
    .assert_eq(&both("count($halls/hall) - 1", "$halls/hall[count = 2]/open"));
    expect![[r#"
        3:103-116 error S2023: no part here has `c` as its `id`: its values are `a` and `b`
        3:156-160 error S2024: the composite has no property `hals`
          fix: replace `hals` with `halls` [3:156-160 "halls"]
    "#]]
    .assert_eq(&both("$halls/hall[@id='c']/count", "$hals"));
    expect![[r#"
        hall:3:42-47 error S2045: the property `count` has no simple value
          help: an expression takes one text: give it one, or a part of the value, as with `source="$name/part"`
        hall:3:59-63 error S2045: the property `open` has no simple value (in `G1`, index 1)
          help: an expression takes one text: give it one, or a part of the value, as with `source="$name/part"`
    "#]]
    .assert_eq(&both("$halls", "$halls/hall/open"));
    expect![[r#"
        2:17-22 warning S2026: the property `halls` of the composite is used by no component
          help: a component takes its value with `source="$halls"`
        hall:3:42-47 error S2045: the property `count` has no simple value
          help: an expression takes one text: give it one, or a part of the value, as with `source="$name/part"`
    "#]]
    .assert_eq(&outcome(
        &[
            &outer(
                r#"<property name="count"><a xmlns="">1</a></property><property name="open">true</property>"#,
            ),
            &hall,
        ],
        &[],
    ));
    // Through a composite in between, and with the numbers of replicas.
    let wing = part(
        "wing",
        "xmlns:saoms=\"urn:saoms:1\"",
        r#"<property name="halls"/>
<component name="Hall${index}" saoms:count="2"><implementation.composite name="t:hall"/><property name="count" source="$halls/hall[${index}]/count"/><property name="open">true</property></component>"#,
    );
    let through = outer("").replace("t:hall\"/>", "t:wing\"/><property name=\"halls\" source=\"$halls\"/>");
    expect![[r#"
        Hall/Hall1/G1 (example.Gps) other->
        Hall/Hall2/G1 (example.Gps) other->
        Hall/Hall2/G2 (example.Gps) other->
    "#]]
    .assert_eq(&outcome(&[&through, &wing, &hall], &[]));
}
