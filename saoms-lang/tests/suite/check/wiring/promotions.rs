//! Declarations of promotions compared with the promoted parts.

use expect_test::expect;

use crate::check::component_types::found;
use crate::check::support::{faults, fleet_1_0, nested, outcome, part, shown};

const TYPE: &[(&str, &str)] = &[(
    "A.componentType",
    "<service name='s'/><service name='u'/>\n<reference name='one'/><reference name='many' multiplicity='1..n'/>",
)];

/// The diagnostics of composites whose classes are taken as given.
fn given(inside: &str) -> String {
    found(inside, TYPE, true)
}

#[test]
fn multiplicities_are_not_widened_whatever_the_classes_are() {
    let wrong = "<component name='A'><implementation.java class='x.A'/></component>
<component name='B'><implementation.java class='x.B'/>
<reference name='r' multiplicity='1..1'/><reference name='q' target='B'/><reference name='p' multiplicity='1..n' target='B'/></component>
<reference name='a' multiplicity='0..1' promote='A/one'/>
<reference name='b' multiplicity='0..n' promote='A/many'/>
<reference name='c' multiplicity='0..1' promote='B/r'/>
<reference name='d' multiplicity='0..n' promote='B/q'/>
<reference name='e' multiplicity='0..n' promote='B/p'/>
<reference name='f' multiplicity='1..1' promote='A/many'/>";
    expect![[r#"
        7:35-39 error S2036: the multiplicity `0..1` of `c` is wider than `1..1` of the promoted reference `r` of component `B`
          help: it can be `1..1`
    "#]]
    .assert_eq(&given(wrong));
}

#[test]
fn what_is_wrong_with_several_that_are_promoted_together_is_told_once() {
    let component = |name: &str, given: &str| {
        format!(
            "<component name='{name}'><implementation.java class='x.B'/><reference name='r' {given}/></component>\n"
        )
    };
    let promoted = |given: &[&str], outer: &str| {
        let components: String =
            given.iter().zip(["A", "B", "C", "D"]).map(|(given, name)| component(name, given)).collect();
        let names: Vec<String> =
            ["A/r", "B/r", "C/r", "D/r"].iter().take(given.len()).map(|one| (*one).to_owned()).collect();
        self::given(&format!("{components}<reference name='w' multiplicity='{outer}' promote='{}'/>", names.join(" ")))
    };
    let (one, many) = ("multiplicity='1..1'", "multiplicity='1..n'");
    expect![[r#"
        4:35-39 error S2036: `w` promotes 2 references whose multiplicity is narrower than `0..n`: `A/r` takes `1..1` and `B/r` takes `1..n`
          help: it can be `1..1`
    "#]].assert_eq(&promoted(&[one, many], "0..n"));
    expect![[r#"
        6:35-39 error S2036: `w` promotes 4 references whose multiplicity is narrower than `0..n`: `A/r` takes `1..1`, `B/r` takes `1..n`, `C/r` takes `1..1` and 1 more
          help: it can be `1..1`
    "#]].assert_eq(&promoted(&[one, many, one, one], "0..n"));
    let fixed = "multiplicity='1..1' nonOverridable='true' target='A'";
    expect![[r#"
        4:18-19 error S2037: the references `A/r` and `B/r` must not be overridden
          2:111-115 `nonOverridable` is set here
          3:111-115 `nonOverridable` is set here
          help: do not promote them, or remove `nonOverridable`
    "#]]
    .assert_eq(&promoted(&[fixed, fixed], "1..1"));
}

#[test]
fn what_a_promotion_must_keep_is_told_beside_a_class_that_is_not_there() {
    let component =
        "<component name='B'><implementation.java class='x.B'/><reference name='q' nonOverridable='true'/></component>";
    let found = found(&format!("{component}<reference name='d' multiplicity='0..n' promote='B/q'/>"), TYPE, false);
    for code in ["S3001", "S2036", "S2037"] {
        assert!(found.contains(code), "{code}: {found}");
    }
}

#[test]
fn interfaces_of_composites_are_those_of_the_classes() {
    let wrong = "<component name='N'><implementation.java class='example.Navigator'/></component>
<component name='R'><implementation.java class='example.Robot001'/><property name='ID'>R</property><property name='period'>1</property></component>
<component name='G'><implementation.java class='example.Gps'/></component>
<service name='s' promote='R/move'><interface.java interface='example.Position'/></service>
<service name='t' promote='G/position'><interface.java interface='example.Positions'/></service>
<reference name='w' promote='N/wheels' target='R/move'><interface.java interface='example.Position'/></reference>
<reference name='v' promote='R/gps N/task'/>";
    expect![[r#"
        5:63-79 error S2007: the interface of `s` is `example.Wheels`, not `example.Position`
          fix: replace `example.Position` with `example.Wheels` [5:63-79 "example.Wheels"]
        7:83-99 error S2007: the interface of `w` is `example.Wheels`, not `example.Position`
          fix: replace `example.Position` with `example.Wheels` [7:83-99 "example.Wheels"]
        8:18-19 warning S2022: reference `v` of the composite is not wired to a service: calls through it fail
          help: wire the component's reference inside the composite: a composite that runs by itself has nothing around it
        8:36-42 error S2007: reference `v` of the composite promotes references with the interfaces `example.Positions` and `unibg.robotics.tca.TaskInterface`
          8:30-35 the first
          help: promote each with its own reference: no service has both interfaces
    "#]].assert_eq(&faults(wrong));
}

#[test]
fn interfaces_that_differ_inside_are_told_inside_alone() {
    let fleet = part(
        "fleet",
        "",
        "<component name='H'><implementation.composite name='t:hall'/><reference name='v' target='G'/></component>
<component name='G'><implementation.java class='example.Gps'/></component>",
    );
    let hall = part(
        "hall",
        "",
        "<component name='R'><implementation.java class='example.Robot001'/><property name='ID'>R</property><property name='period'>1</property></component>
<component name='N'><implementation.java class='example.Navigator'/><reference name='wheels' target='R/move'/></component>
<reference name='v' promote='R/gps N/task'/>",
    );
    let (_, diagnostics, sources) = nested(&[&fleet, &hall], &[], false);
    let all: String = diagnostics.iter().map(|one| shown(one, &sources)).collect();
    expect![[r#"
        hall:4:36-42 error S2007: reference `v` of the composite promotes references with the interfaces `example.Positions` and `unibg.robotics.tca.TaskInterface`
          hall:4:30-35 the first
          help: promote each with its own reference: no service has both interfaces
    "#]].assert_eq(&all);
}

#[test]
fn a_promoted_reference_is_wired_where_it_has_an_address_or_nobody_knows_what_takes_it() {
    let told = |component: &str, inside: &str| {
        let around = format!(
            "<reference name='R' promote='I/r'/>\n<component name='I'><implementation.composite name='t:in'/>{inside}</component>"
        );
        let inner = part("in", "", &format!("<reference name='r' promote='C/gps'/>\n{component}"));
        let (_, diagnostics, sources) = nested(&[&part("fleet", "", &around), &inner], &[], true);
        diagnostics.iter().map(|one| shown(one, &sources)).collect::<String>()
    };
    let class = |class: &str| {
        format!(
            "<component name='C'><implementation.java class='{class}'/><property name='ID'>R</property><property name='period'>1</property><reference name='gps'/></component>"
        )
    };
    expect![[r#"
        2:18-19 warning S2022: reference `R` of the composite is not wired to a service: calls through it fail
          help: wire the component's reference inside the composite: a composite that runs by itself has nothing around it
    "#]]
    .assert_eq(&told(&class("example.Robot001"), ""));
    let address = "<reference name='r'><binding.ws uri='http://x'/></reference>";
    expect![[""]].assert_eq(&told(&class("example.Robot001"), address));
    expect![[""]].assert_eq(&told(&class("unknown.Robot"), ""));
}

#[test]
fn what_is_promoted_has_to_be_there_in_a_file_of_any_version() {
    let of = |class: &str| {
        let text = fleet_1_0(&format!(
            "<component name='A'><implementation.java class='{class}'/></component>\n\
             <service name='s' promote='A/nix'/><service name='t' promote='B'/>"
        ));
        outcome(&[&text], &[])
    };
    expect![[r#"
        3:30-33 error S2021: component `A` has no service `nix`
          help: its services are `position`
        3:63-64 error S2011: there is no component `B`
          help: the components are `A`
    "#]]
    .assert_eq(&of("example.Gps"));
}
