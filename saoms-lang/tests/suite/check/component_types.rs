//! Component types: files beside implementations that describe components.

use std::fs;

use expect_test::expect;
use saoms_lang::project::Project;

use crate::check::support::{compiled_in, fleet};
use crate::check::values::properties::robot;

const DESCRIPTION: &str = "<property name='speed' type='xsd:int'>5</property>
<property name='names' many='true'/>
<property name='must' type='xsd:string' mustSupply='true'/>
<service name='tick'/>
<reference name='clock'/>
<reference name='lamps' multiplicity='0..n'/>";

/// The diagnostics of a composite that has files beside it, where classes are taken as given or not.
pub(crate) fn found(inside: &str, types: &[(&str, &str)], assume_classes: bool) -> String {
    let folder = tempfile::tempdir().unwrap();
    for (name, inside) in types {
        let text = format!(
            "<componentType xmlns='http://docs.oasis-open.org/ns/opencsa/sca/200912' xmlns:xsd='http://www.w3.org/2001/XMLSchema'>\n{inside}</componentType>"
        );
        fs::write(folder.path().join(name), text).unwrap();
    }
    let path = folder.path().join("fleet.composite");
    let text = fleet(inside).replacen('>', " xmlns:t='urn:t' xmlns:xsd='http://www.w3.org/2001/XMLSchema'>", 1);
    fs::write(&path, text).unwrap();
    compiled_in(folder.path(), &Project::new().file(path).assume_classes(assume_classes)).1
}

/// A component of a script that is described as above.
fn script(inside: &str) -> String {
    let inside = format!("<component name='S'><t:implementation.script script='run.py'/>\n{inside}</component>");
    found(&inside, &[("run.componentType", DESCRIPTION)], true)
}

/// The same for an unknown class.
fn class(inside: &str) -> String {
    let inside = format!("<component name='S'><implementation.java class='a.Run'/>\n{inside}</component>");
    found(&inside, &[("Run.componentType", DESCRIPTION)], true)
}

const RIGHT: &str = "<property name='must' value='it'/><reference name='clock' target='S/tick'/>";

#[test]
fn a_right_use_has_no_faults() {
    let right = format!(
        "{RIGHT}<property name='names'><value>a</value><value>b</value></property><property name='speed' type='xsd:long'>7</property><service name='tick'/><reference name='lamps' target='S/tick S'/>"
    );
    assert_eq!(script(&right), "");
    assert_eq!(class(&right), "");
}

#[test]
fn a_script_has_what_its_file_says_and_nothing_else() {
    let wrong = format!(
        "{RIGHT}\n<property name='sped'>1</property>\n<service name='tock'/>\n<reference name='lamp' target='S/tik'/></component>
<component name='T'><implementation.java class='a.T'/><reference name='r' target='S/tik S/tock S/other'/></component>
<wire source='S/clok' target='S/tik'/>
<service name='p' promote='S/tik'/>
<reference name='q' promote='S/lamsp'/>
<component name='U'><implementation.java class='a.U'/>"
    );
    expect![[r#"
        4:17-21 error S3004: component `S` has no property `sped`
          run.componentType:1:2-15 its component type
          fix: replace `sped` with `speed` [4:17-21 "speed"]
        5:16-20 error S2005: component `S` has no service `tock`
          run.componentType:1:2-15 its component type
          fix: replace `tock` with `tick` [5:16-20 "tick"]
        6:18-22 error S2006: component `S` has no reference `lamp`
          run.componentType:1:2-15 its component type
          fix: replace `lamp` with `lamps` [6:18-22 "lamps"]
        6:34-37 error S2012: component `S` has no service `tik`
          run.componentType:1:2-15 its component type
          fix: replace `tik` with `tick` [6:34-37 "tick"]
        7:85-88 error S2012: component `S` has no service `tik`
          run.componentType:1:2-15 its component type
          fix: replace `tik` with `tick` [7:85-88 "tick"]
        7:98-103 error S2012: component `S` has no service `other`
          run.componentType:1:2-15 its component type
          help: its services are `tick`
        8:17-21 error S2016: component `S` has no reference `clok`
          run.componentType:1:2-15 its component type
          fix: replace `clok` with `clock` [8:17-21 "clock"]
        8:33-36 error S2012: component `S` has no service `tik`
          run.componentType:1:2-15 its component type
          fix: replace `tik` with `tick` [8:33-36 "tick"]
        9:30-33 error S2021: component `S` has no service `tik`
          run.componentType:1:2-15 its component type
          fix: replace `tik` with `tick` [9:30-33 "tick"]
        10:32-37 error S2021: component `S` has no reference `lamsp`
          run.componentType:1:2-15 its component type
          fix: replace `lamsp` with `lamps` [10:32-37 "lamps"]
    "#]]
    .assert_eq(&script(&wrong));
}

#[test]
fn what_a_file_cannot_say_is_told() {
    let described = "<servise name='tick'/><property name='speed' defualt='5'/>\n<component name='x'/>text<service xmlns='' name='a'/>
<o:service xmlns:o='http://www.osoa.org/xmlns/sca/1.0' name='b'/><x:more xmlns:x='urn:x'/><implementation.java class='a.B'/>";
    let inside = "<component name='S'><t:implementation.script script='run.py'/></component>";
    expect![[r#"
        run.componentType:2:2-9 error S1004: SCA 1.1 has no element `servise`
          fix: replace `servise` with `service` [run.componentType:2:2-9 "service"]
        run.componentType:2:46-53 error S1007: `property` has no attribute `defualt`
          help: `property` has the attributes `name`, `value`, `type`, `element`, `many`, `mustSupply`
        run.componentType:3:2-11 error S1005: `component` is not allowed in `componentType`
          help: `componentType` can contain `implementation.*`, `service`, `reference`, `property`, `requires`, `policySetAttachment`, `documentation`, `extensions`
        run.componentType:3:22-26 error S1012: unexpected text in `componentType`: it contains elements only
          help: remove it, or write a comment between `<!--` and `-->`
        run.componentType:3:27-34 error S1004: `service` is in no namespace
          help: write it in the namespace of the composite if it is of SCA, else in its own
        run.componentType:4:2-11 error S1003: `o:service` is of SCA 1.0, but the componentType is of SCA 1.1
          run.componentType:1:2-15 the componentType
          help: use one namespace of SCA for a composite and everything in it
    "#]].assert_eq(&found(inside, &[("run.componentType", described)], true));
}

/// Its file adds to its own declaration, which is not visible here.
#[test]
fn a_class_may_have_more_than_its_file_says() {
    let wrong = format!("{RIGHT}\n<property name='sped'>1</property>\n<service name='another'/>");
    expect![[r#"
        4:17-21 warning S3004: component `S` has no property `sped`
          run.componentType:1:2-15 its component type
          help: if the class has it, add the property to the component type
          fix: replace `sped` with `speed` [4:17-21 "speed"]
        5:16-23 warning S2005: component `S` has no service `another`
          run.componentType:1:2-15 its component type
          help: its services are `tick`
          help: if the class has it, add the service to the component type
    "#]]
    .assert_eq(&class(&wrong).replace("Run.", "run."));
    let one = |inside| {
        let component = format!("<component name='S'><implementation.java class='a.Run'/>{inside}</component>");
        found(&component, &[("Run.componentType", "<service name='tick'/>")], true)
    };
    assert_eq!(one("<property name='sped'>1</property><reference name='r' target='S/tick'/>"), "");
}

#[test]
fn files_are_held_to_names_alone() {
    let wrong = format!(
        "{RIGHT}\n<property name='speed'>fast</property></component>
<property name='many' type='xsd:string'>7</property>
<component name='T'><t:implementation.script script='run.py'/>{RIGHT}<property name='speed' source='$many'/></component>
<component name='U'><t:implementation.script script='run.py'/>{RIGHT}<property name='speed'><value>1</value><value>2</value></property></component>
<component name='V'><t:implementation.script script='run.py'/>{RIGHT}<property name='speed' many='true' value='1'/></component>
<component name='W'><t:implementation.script script='run.py'/>{RIGHT}<property name='speed' type='xsd:string' value='1'/></component>
<component name='X'><t:implementation.script script='run.py'/>{RIGHT}<property name='speed'><a xmlns=''>1</a></property></component>
<component name='Y'><t:implementation.script script='run.py'/>"
    );
    expect![""].assert_eq(&script(&wrong));
}

#[test]
fn a_file_beside_a_class_names_what_the_class_has() {
    let types = [(
        "Robot001.componentType",
        "<property name='number' type='xsd:int' mustSupply='true'/>\n<property name='speed' type='xsd:int'/>\n<property name='spede'/>\n<property name='grace'>soon</property>",
    )];
    expect![[r#"
        Robot001.componentType:4:17-22 error S3004: class `example.Robot001` has no property `spede`
          fix: replace `spede` with `speed` [Robot001.componentType:4:17-22 "speed"]
        Robot001.componentType:5:24-28 error S3007: property `grace`: `soon` is not a duration: expected a duration (in ms, or with a unit: ns, us, ms, s, min, h)
          2:18-19 used here as `grace`
          help: the default is `10ms`
    "#]].assert_eq(&found(&robot("<property name='speed'>1.5</property>"), &types, false));
}

#[test]
fn a_slip_in_a_name_that_a_component_of_an_unknown_class_declares_is_told() {
    let inside = |service: &str, reference: &str, target: &str, source: &str| {
        format!(
            r#"<service name="s" promote="A/{service}"/>
<reference name="r" promote="A/{reference}"/>
<component name="A"><implementation.java class="x.Unknown"/><service name="ItemCollection"/>
  <reference name="stockQuotes" multiplicity="0..1"/><reference name="next" multiplicity="0..1"/></component>
<component name="B"><implementation.java class="x.Unknown"/><reference name="out" target="A/{target}"/></component>
<wire source="A/{source}" target="B"/>"#
        )
    };
    let near = inside("ItemColection", "stokQuotes", "ItemsCollection", "nxt");
    let more = "help: if its class has both, declare this one in the component as well";
    expect![[r#"
        2:30-43 warning S2021: component `A` declares no service `ItemColection`
          4:76-90 its own declaration
          fix: replace `ItemColection` with `ItemCollection` [2:30-43 "ItemCollection"]
        3:32-42 warning S2021: component `A` declares no reference `stokQuotes`
          5:20-31 its own declaration
          fix: replace `stokQuotes` with `stockQuotes` [3:32-42 "stockQuotes"]
        6:93-108 warning S2012: component `A` declares no service `ItemsCollection`
          4:76-90 its own declaration
          fix: replace `ItemsCollection` with `ItemCollection` [6:93-108 "ItemCollection"]
        7:17-20 warning S2016: component `A` declares no reference `nxt`
          5:71-75 its own declaration
          fix: replace `nxt` with `next` [7:17-20 "next"]
    "#]]
    .assert_eq(&found(&near, &[], true).replace(&format!("  {more}\n"), ""));
    let apart = inside("ItemCollection2", "other", "LocalItemCollection", "stockQuotes");
    expect![""].assert_eq(&found(&apart, &[], true));
}

#[test]
fn a_value_in_a_component_type_is_one_and_written_once() {
    let inside = "<property name='a' type='xsd:int'><value>1</value><value>2</value></property><property name='b' type='xsd:int' value='1'><value>2</value></property>
<property name='c' type='xsd:int' value='1'>2</property><property name='d' type='xsd:int' many='true'><value>1</value><value>2</value></property>
<property name='e' type='xsd:int' value='1'/><property name='f' type='xsd:int'>2</property>
<requires/><requires intents=''/><policySetAttachment/><documentation/><extensions><service name='x'/></extensions>";
    let component = "<component name='S'><implementation.java class='a.Run'/></component>";
    expect![[r#"
        Run.componentType:5:85-92 error S1005: `service` is not allowed in `extensions`
          help: `extensions` cannot contain elements of SCA
    "#]]
    .assert_eq(&found(component, &[("Run.componentType", inside)], true));
}

#[test]
fn a_file_that_is_no_xml_is_judged_as_far_as_it_can_be_read() {
    let damaged = "<property name='speed' type=xsd:int/>\n<servce name='tick'/>\n<reference/>\n";
    let inside = "<component name='S'><implementation.java class='a.Run'/><service name='other'/></component>";
    expect![[r#"
        Run.componentType:2:29-36 error S0105: the value of `type` is not in quotes
          fix: put it in quotes [Run.componentType:2:29-36 "\"xsd:int\""]
        Run.componentType:3:2-8 error S1004: SCA 1.1 has no element `servce`
          fix: replace `servce` with `service` [Run.componentType:3:2-8 "service"]
        Run.componentType:4:2-11 error S1008: `reference` needs the attribute `name`
          help: add `name="..."` to it
    "#]]
    .assert_eq(&found(inside, &[("Run.componentType", damaged)], true));
}
