//! Intents that composites require.

use expect_test::expect;

use crate::load::definitions::{OASIS, OSOA, definitions, of_fleet};

/// What is said of a composite with this inside, beside definitions of the same version with this inside.
fn told(namespace: &str, inside: &str, defined: &str) -> String {
    let fleet = format!(
        "<composite xmlns='{namespace}' xmlns:sca='{namespace}' xmlns:t='urn:t' xmlns:o='urn:o' targetNamespace='urn:t' name='fleet'>\n{inside}</composite>"
    );
    let mut files = vec![("fleet.composite", fleet)];
    if !defined.is_empty() {
        files.push(("definitions.xml", definitions(namespace, defined)));
    }
    of_fleet(&files)
}

#[test]
fn intents_that_exclude_each_other_are_not_required_together() {
    let inside = "<component name='A' requires='sca:propagatesTransaction'><implementation.java class='x.A'/>
<service name='s' requires='sca:suspendsTransaction sca:propagatesTransaction'/><service name='t' requires='t:a.high sca:ordered t:b'/>
<service name='u' requires='sca:suspendsTransaction'/><service name='v' requires='t:a o:b'/>
<service name='w' requires='t:b'><requires intents='t:c t:a'/></service></component>";
    let defined = "<intent name='a' excludes='t:b'/><intent name='b'/><intent name='c'/>";
    expect![[r#"
        fleet.composite:3:53 [sca:propagatesTransaction] error S2060 `sca:propagatesTransaction` excludes `sca:suspendsTransaction`
          remove one of them
        fleet.composite:3:130 [t:b] error S2060 `t:b` excludes `t:a.high`
          remove one of them
        fleet.composite:5:29 [t:b] error S2060 `t:b` excludes `t:a`
          remove one of them
    "#]].assert_eq(&told(OASIS, inside, defined));
    let old = "<component name='A'><implementation.java class='x.A'/><service name='s' requires='immediateOneWay transactedOneWay'/></component>";
    expect![[r#"
        fleet.composite:2:99 [transactedOneWay] warning S2060 `transactedOneWay` excludes `immediateOneWay`
          remove one of them
    "#]]
    .assert_eq(&told(OSOA, old, ""));
}

#[test]
fn what_is_promoted_may_require_nothing_that_its_promotion_excludes() {
    let inside = "<reference name='r' promote='A/r B/r' multiplicity='0..n' requires='t:b'/><service name='s' promote='A/s' requires='t:b'/>
<reference name='q' promote='A/q' multiplicity='0..1' requires='t:b'/><reference name='p' promote='Z/q A' multiplicity='0..1' requires='t:b'/>
<component name='A'><implementation.java class='x.A'/><service name='s' requires='t:a'/><reference name='r' requires='t:a'/><reference name='q' requires='t:b'/></component>
<component name='B' requires='t:a'><implementation.java class='x.A'/><reference name='r'/></component>";
    let defined = "<intent name='a' excludes='t:b'/><intent name='b'/>";
    expect![[r#"
        fleet.composite:2:69 [t:b] error S2060 `t:b` excludes `t:a`, which `A/r` requires
          remove one of them
        fleet.composite:2:117 [t:b] error S2060 `t:b` excludes `t:a`, which `A/s` requires
          remove one of them
    "#]]
    .assert_eq(&told(OASIS, inside, defined));
}

#[test]
fn intents_of_sca_have_their_names() {
    let inside = "<component name='A' requires='sca:confidentality sca:integrity.message sca:orderd.x confidentiality sca:mine t:integritty'><implementation.java class='x.A'/></component>";
    expect![[r#"
        fleet.composite:2:31 [sca:confidentality] warning S2056 SCA has no intent `confidentality`
          replace `confidentality` with `confidentiality`
        fleet.composite:2:72 [sca:orderd.x] warning S2056 SCA has no intent `orderd`
          replace `orderd` with `ordered`
    "#]]
    .assert_eq(&told(OASIS, inside, ""));
    let fleet = format!(
        "<composite xmlns='{OASIS}' xmlns:sca='{OASIS}' targetNamespace='urn:t' name='fleet'><component name='A' requires='sca:orderd'><implementation.java class='x.A'/></component></composite>"
    );
    let own = definitions(OASIS, "<intent name='orderd'/>")
        .replace("targetNamespace='urn:t'", &format!("targetNamespace='{OASIS}'"));
    expect![""].assert_eq(&of_fleet(&[("fleet.composite", fleet), ("definitions.xml", own)]));
}

#[test]
fn interfaces_have_intents_in_1_1_alone() {
    let inside = "<component name='A'><implementation.java class='x.A'/><service name='s' requires='t:a' policySets='t:p'><interface.java interface='x.I' requires='t:a' policySets='t:p'/></service></component>";
    expect![""].assert_eq(&told(OASIS, inside, ""));
    expect![[r#"
        fleet.composite:2:137 [requires] warning S1014 `requires` of `interface.java` is an attribute of SCA 1.1, and this file is of SCA 1.0
          it counts here, and other programs do not know it: let the file be one of SCA 1.1
        fleet.composite:2:152 [policySets] warning S1014 `policySets` of `interface.java` is an attribute of SCA 1.1, and this file is of SCA 1.0
          it counts here, and other programs do not know it: let the file be one of SCA 1.1
    "#]].assert_eq(&told(OSOA, inside, ""));
}
