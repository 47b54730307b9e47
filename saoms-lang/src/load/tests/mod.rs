mod extension;
mod large;
mod mended;
mod reading;
mod run_settings;
mod slips;
mod vocabulary;

use std::fmt::Write as _;

use super::*;
use crate::model::{ImplementationKind, InterfaceKind, Multiplicity, Part};
use crate::source::{Location, Text};

/// Loads a text, and gives the model and every diagnostic as `line:column [marked text] severity code message`, each
/// with its suggestions.
fn loaded(text: &str) -> (Option<Composite>, String) {
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let file = sources.add("t.composite", text);
    let composite = load_file(file, &sources, &mut diagnostics);
    (composite, shown(&sources, diagnostics))
}

fn shown(sources: &Sources, diagnostics: Diagnostics) -> String {
    let mut out = String::new();
    for one in diagnostics.into_sorted() {
        let place = sources.get(one.location.file).line_column(one.location.span.start);
        let marked = sources.snippet(one.location);
        let (severity, code) = (one.severity.name(), one.code.id);
        let _ = write!(out, "{}:{} [{marked}] {severity} {code} {}", place.line, place.column, one.message);
        for suggestion in &one.suggestions {
            let _ = write!(out, " | {}", suggestion.description);
        }
        out.push('\n');
    }
    out
}

/// The diagnostics of components and the like of a composite of SCA 1.0; they start in line 2.
#[track_caller]
fn faults_1_0(content: &str, expected: &str) {
    let text = format!("<composite xmlns='{}' name='c' targetNamespace='u'>\n{content}\n</composite>", OSOA);
    assert_eq!(loaded(&text).1.trim_end(), expected.trim(), "{content}");
}

/// The same for SCA 1.1.
#[track_caller]
fn faults_1_1(content: &str, expected: &str) {
    let text = format!("<composite xmlns='{}' name='c' targetNamespace='u'>\n{content}\n</composite>", OASIS);
    assert_eq!(loaded(&text).1.trim_end(), expected.trim(), "{content}");
}

/// The diagnostics of a whole file.
#[track_caller]
fn faults(text: &str, expected: &str) {
    assert_eq!(loaded(text).1.trim_end(), expected.trim(), "{text}");
}

const OSOA: &str = Version::Osoa10.namespace();
const OASIS: &str = Version::Oasis200912.namespace();
const JAVA: &str = "<implementation.java class='x.Y'/>";

const FLEET: &str = r#"<sca:composite xmlns:sca="http://docs.oasis-open.org/ns/opencsa/sca/200912" xmlns:f="urn:f"
    xmlns:saoms="urn:saoms:1" xmlns:t="urn:t" name="fleet" targetNamespace="urn:fleet" local="true" autowire="false"
    requires="t:a t:b" policySets="t:c" f:kept="yes">
  <sca:include name="t:base"/>
  <sca:property name="currency" type="xsd:string" many="false" mustSupply="true"> EUR </sca:property>
  <sca:service name="Move" promote="Robot/Move"><saoms:interface.rust interface="a.Move"/></sca:service>
  <sca:reference name="gps" promote="Robot/gps
      Other/gps" multiplicity="0..n"/>
  <sca:component name="Robot" autowire="1">
    <sca:service name="Move">
      <sca:interface.java interface="a.Move" callbackInterface="a.Back" remotable="true"/>
      <sca:binding.ws uri="http://h/&amp;x" name="ws"/><f:binding.http uri="/h"/>
      <sca:callback><sca:binding.sca/></sca:callback>
    </sca:service>
    <saoms:implementation.rust class="robot" library="librobot.so"/>
    <sca:property name="ID">Robot001</sca:property>
    <sca:property name="period" value=" 100us "/>
    <sca:property name="many" many="true"><sca:value>1</sca:value><sca:value> <f:x/></sca:value></sca:property>
    <sca:property name="order" source="$order/total" file="o.xml" element="f:o"><f:order/></sca:property>
    <sca:reference name="gps" target=" Gps  Gps2/Where/ws" multiplicity="1..n" wiredByImpl="false"
        nonOverridable="true" autowire="true"/>
    <f:extension/>
  </sca:component>
  <sca:component name="Gps"><sca:implementation.composite name="t:gps"/></sca:component>
  <sca:component name="Gps2"><f:implementation.script script="x.py"/></sca:component>
  <sca:component name="Gps3"><sca:implementation.spring location="x"/></sca:component>
  <sca:wire source="Robot/gps" target="Gps3/Where" replace="true"/>
</sca:composite>"#;

fn at(text: &str, location: Location) -> &str {
    &text[location.span.start as usize..location.span.end as usize]
}

fn both(text: &Text) -> (&str, &str) {
    (text, at(FLEET, text.location))
}

#[test]
fn the_whole_vocabulary_is_in_the_model_with_its_places() {
    let (composite, faults) = loaded(FLEET);
    assert_eq!(faults, "");
    let composite = composite.unwrap();
    assert_eq!(both(&composite.name), ("fleet", "fleet"));
    assert_eq!((at(FLEET, composite.tag()), composite.version), ("sca:composite", Version::Oasis200912));
    assert_eq!(both(composite.target_namespace.as_ref().unwrap()), ("urn:fleet", "urn:fleet"));
    assert_eq!((*composite.local.unwrap(), *composite.autowire.unwrap()), (true, false));
    let words = |list: &[Text]| list.iter().map(|one| both(one).1.to_owned()).collect::<Vec<_>>();
    let root = composite.origin.element(&composite.document);
    assert_eq!(root.attribute_in("urn:f", "kept").unwrap().value(), "yes");
    assert_eq!(both(&composite.includes[0].name).1, "t:base");

    let currency = &composite.properties[0];
    assert_eq!(both(currency.text.as_ref().unwrap()), ("EUR", "EUR"));
    assert_eq!((both(currency.r#type().unwrap()).1, *currency.many().unwrap()), ("xsd:string", false));
    assert!(*currency.must_supply().unwrap());
    assert_eq!(both(composite.services[0].promote.as_ref().unwrap()).1, "Robot/Move");
    assert_eq!(composite.services[0].contract().interface.as_ref().unwrap().kind, InterfaceKind::Rust);
    assert_eq!(words(&composite.references[0].promote), ["Robot/gps", "Other/gps"]);
    assert_eq!(*composite.references[0].multiplicity.unwrap(), Multiplicity::Any);

    let robot = composite.component("Robot").unwrap();
    assert_eq!((at(FLEET, robot.tag()), *robot.autowire.unwrap()), ("sca:component", true));
    assert_eq!(both(robot.class().unwrap()).1, "robot");
    let ImplementationKind::Rust { library, .. } = &robot.implementation.as_ref().unwrap().kind else {
        panic!("implementation.rust")
    };
    assert_eq!(library.as_ref().unwrap().as_str(), "librobot.so");
    let service = robot.service("Move").unwrap();
    let interface = service.contract().interface.as_ref().unwrap();
    assert_eq!(interface.kind, InterfaceKind::Java);
    assert_eq!(both(interface.interface.as_ref().unwrap()).1, "a.Move");
    let uris: Vec<_> = service
        .contract()
        .bindings
        .iter()
        .map(|one| (one.kind.as_str(), one.is_sca, both(one.uri.as_ref().unwrap())))
        .collect();
    assert_eq!(uris, [("ws", true, ("http://h/&x", "http://h/&amp;x")), ("http", false, ("/h", "/h"))]);
    assert_eq!(service.contract().callback.as_ref().unwrap().bindings[0].kind, "sca");

    assert_eq!(both(robot.property("ID").unwrap().simple_value().unwrap()).1, "Robot001");
    assert_eq!(both(robot.property("period").unwrap().simple_value().unwrap()), ("100us", "100us"));
    let many = robot.property("many").unwrap();
    assert_eq!(many.values().iter().map(|one| one.text.as_str()).collect::<Vec<_>>(), ["1", ""]);
    assert_eq!(composite.document.element(many.values()[1].content[0]).name(), "f:x");
    let order = robot.property("order").unwrap();
    assert_eq!((both(order.source().unwrap()).1, both(order.file().unwrap()).1), ("$order/total", "o.xml"));
    assert_eq!(composite.document.element(order.content()[0]).name(), "f:order");
    assert!(order.has_value() && order.simple_value().is_none());
    let gps = robot.reference("gps").unwrap();
    assert_eq!(words(&gps.targets), ["Gps", "Gps2/Where/ws"]);
    assert_eq!((*gps.autowire.unwrap(), *gps.wired_by_impl.unwrap()), (true, false));
    assert!(*gps.non_overridable.unwrap() && gps.multiplicity.unwrap().is_required());
    let element = robot.origin.element(&composite.document);
    assert_eq!(element.children().last().unwrap().name(), "f:extension");

    let kinds: Vec<_> =
        composite.components[1..].iter().map(|one| &one.implementation.as_ref().unwrap().kind).collect();
    assert!(matches!(kinds[0], ImplementationKind::Composite { name: Some(name) } if *name == "t:gps"));
    assert!(matches!(kinds[1], ImplementationKind::Other { kind, is_sca: false } if kind == "script"));
    assert!(matches!(kinds[2], ImplementationKind::Other { kind, is_sca: true } if kind == "spring"));
    let wire = &composite.wires[0];
    assert_eq!(both(wire.source.as_ref().unwrap()).1, "Robot/gps");
    assert_eq!(both(wire.target.as_ref().unwrap()).1, "Gps3/Where");
    assert!(*wire.replace.unwrap());
}

#[test]
fn a_root_that_is_no_composite_is_told_what_it_has_to_be() {
    faults(
        &format!("<Composite xmlns='{OSOA}' name='c' targetNamespace='u'/>"),
        "1:2 [Composite] error S1001 the root element is `Composite`, expected `composite` \
         | replace `Composite` with `composite`",
    );
    faults("<project/>", "1:2 [project] error S1001 the root element is `project`, expected `composite`");
    faults(
        &format!("<componentType xmlns='{OASIS}'/>"),
        "1:2 [componentType] error S1001 the root element is `componentType`, expected `composite`",
    );
    assert!(loaded("<project/>").0.is_none());
    let composite = format!("<composite xmlns='{OASIS}' name='c' targetNamespace='u'/>");
    faults(
        &format!("<composites>{composite}</composites>"),
        "1:2 [composites] error S1001 the root element is `composites`, expected `composite` \
         | remove its start tag and end tag: the composite in it is the root",
    );
    faults(
        &format!("<composites>{composite}{composite}</composites>"),
        "1:2 [composites] error S1001 the root element is `composites`, expected `composite`",
    );
}

#[test]
fn a_wrong_namespace_is_found_where_it_is_written_and_the_rest_is_read() {
    faults(
        "<composite name='c' targetNamespace='u'><component/></composite>",
        "
1:2 [composite] error S1002 `composite` is in no namespace, so it is not a composite of SCA | insert `xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\"`
1:42 [component] error S1008 `component` needs the attribute `name`
1:42 [component] warning S1010 a component has no implementation",
    );
    faults(
        "<s:composite xmlns:x='u' xmlns:s='http://www.osoa.org/xmlns/sca/1.1' name='c' targetNamespace='u'/>",
        "1:35 [http://www.osoa.org/xmlns/sca/1.1] error S1002 `http://www.osoa.org/xmlns/sca/1.1` is not a namespace of SCA \
         | replace it with `http://www.osoa.org/xmlns/sca/1.0`",
    );
    faults(
        "<composite xmlns='urn:mine' name='c' targetNamespace='u'/>",
        "1:19 [urn:mine] error S1002 `urn:mine` is not a namespace of SCA",
    );
    let mut diagnostics = Diagnostics::new();
    let mut sources = Sources::new();
    let file = sources.add("t", "<composite xmlns='urn:mine' name='c' targetNamespace='u'/>");
    load_file(file, &sources, &mut diagnostics);
    let help = diagnostics.into_sorted().remove(0).help.join(" ");
    assert!(Version::ALL.iter().all(|version| help.contains(version.namespace())), "{help}");
}

#[test]
fn unknown_names_come_with_the_nearest() {
    faults_1_0(
        &format!("<component nmae='a'>{JAVA}<property nam='ID'>1</property></component>"),
        "
2:12 [nmae] error S1007 `component` has no attribute `nmae` | replace `nmae` with `name`
2:65 [nam] error S1007 `property` has no attribute `nam` | replace `nam` with `name`",
    );
    faults_1_0(
        &format!("<component name='a'>{JAVA}<reference name='r' targt='b'/><propery name='x'>1</propery></component>"),
        "
2:75 [targt] error S1007 `reference` has no attribute `targt` | replace `targt` with `target`
2:87 [propery] error S1004 SCA 1.0 has no element `propery` | replace `propery` with `property`",
    );
    faults_1_0(
        "<component name='a'><implementation.jav class='x'/></component>",
        "2:22 [implementation.jav] error S1004 SCA 1.0 has no element `implementation.jav` \
         | replace `implementation.jav` with `implementation.java`",
    );
    faults_1_0(
        &format!("<component name='a'>{JAVA}<service name='s'><interface.jva interface='i'/></service></component>"),
        "2:74 [interface.jva] error S1004 SCA 1.0 has no element `interface.jva` \
         | replace `interface.jva` with `interface.java`",
    );
    // The schema of 1.0 lets any attribute pass, that of 1.1 does not.
    faults_1_0(
        &format!("<component name='a' colour='red'>{JAVA}</component>"),
        "2:21 [colour] warning S1007 `component` has no attribute `colour`",
    );
    faults_1_1(
        &format!("<component name='a' colour='red'>{JAVA}</component>"),
        "2:21 [colour] error S1007 `component` has no attribute `colour` | write it as a property: `<property name=\"colour\">red</property>`",
    );
    // What is given already is not proposed a second time.
    let given = |written: &str, proposed: &str| {
        faults_1_1(
            &format!("<component name='a' period='1s'>{JAVA}<property name='period'{written}</component>"),
            &format!("2:21 [period] error S1007 `component` has no attribute `period`{proposed}"),
        );
    };
    given(" value='1s'/>", " | remove it: the component has this property");
    given(">1s</property>", " | remove it: the component has this property");
    given(">2s</property>", "");
    faults_1_1(
        &format!("<component name='a' constrainingType='t'>{JAVA}</component>"),
        "2:21 [constrainingType] error S1007 `component` has no attribute `constrainingType`",
    );
    faults_1_1(
        &format!("<component name='a' xmlns:s='{OASIS}' s:autowire='true'>{JAVA}</component>"),
        "2:80 [s:autowire] error S1007 `s:autowire` has a prefix; attributes of SCA have none | remove the prefix",
    );
}

/// To follow a suggestion must not give an element one attribute twice.
#[test]
fn what_is_given_already_is_not_suggested() {
    faults_1_1(
        &format!("<component name='a' nqme='b'>{JAVA}</component>"),
        "2:21 [nqme] error S1007 `component` has no attribute `nqme`",
    );
    let own = "xmlns:s='urn:saoms:1'";
    faults_1_1(
        &format!("<component name='a${{index}}' {own} s:count='2' s:coun='3'>{JAVA}</component>"),
        "2:63 [s:coun] error S1007 `component` has no attribute `s:coun`",
    );
    faults_1_1(
        &format!("<component name='a' {own} s:name='b'>{JAVA}</component>"),
        "2:43 [s:name] error S1007 `component` has no attribute `s:name`",
    );
}

#[test]
fn a_suggestion_renames_the_end_tag_too() {
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let text = format!(
        "<s:composite xmlns:s='{OSOA}' name='c' targetNamespace='u'><component name='a'></component>\
        <s:componnt name='b'> </s:componnt ></s:composite>"
    );
    let file = sources.add("t", &*text);
    load_file(file, &sources, &mut diagnostics);
    let mut mended = text.clone();
    let mut edits: Vec<_> = diagnostics
        .into_sorted()
        .into_iter()
        .flat_map(|one| one.suggestions)
        .flat_map(|suggestion| suggestion.edits)
        .collect();
    edits.sort_by_key(|edit| std::cmp::Reverse(edit.location));
    for edit in edits {
        let span = edit.location.span;
        mended.replace_range(span.start as usize..span.end as usize, &edit.replacement);
    }
    let (composite, faults) = loaded(&mended);
    assert_eq!(faults.matches(" error ").count(), 0, "{mended}\n{faults}");
    assert_eq!(composite.unwrap().components.len(), 2);
}

#[test]
fn what_cannot_be_is_found_at_its_place() {
    faults_1_0(
        &format!("<component name='a'>{JAVA}<implementation.java class='z'/></component>"),
        "2:56 [implementation.java] error S1006 `component` has a second implementation",
    );
    faults_1_0(
        &format!("<component>{JAVA}</component><component name=''>{JAVA}</component>"),
        "
2:2 [component] error S1008 `component` needs the attribute `name`
2:69 [name=''] error S1011 the attribute `name` is empty",
    );
    faults_1_0(
        "<wire target='b'/><wire source='a' target=' '/>",
        "
2:2 [wire] error S1008 `wire` needs the attribute `source`
2:36 [target=' '] error S1011 the attribute `target` is empty",
    );
    faults_1_0(
        &format!("<component name='a'>oops{JAVA}<property>1</property></component>more"),
        "
2:21 [oops] error S1012 unexpected text in `component`: it contains elements only
2:60 [property] error S1008 `property` needs the attribute `name`
2:93 [more] error S1012 unexpected text in `composite`: it contains elements only",
    );
    faults_1_0(
        "<component name='a'><implementation.java>x.Y</implementation.java></component>",
        "
2:42 [x.Y] error S1012 unexpected text in `implementation.java`: it contains elements only",
    );
    faults_1_0(
        &format!("<component name='a'>{JAVA}<component name='b'/></component><value/><interface.java/>"),
        "
2:56 [component] error S1005 `component` is not allowed in `component`
2:89 [value] error S1005 `value` is not allowed in `composite`
2:97 [interface.java] error S1005 `interface.java` is not allowed in `composite`",
    );
    faults_1_0(
        &format!("<component name='a'>{JAVA}<property name='p'>1<component name='b'/></property></component>"),
        "2:76 [component] error S1005 `component` is not allowed in `property`",
    );
    faults_1_1(
        &format!("<component name='a'>{JAVA}<property name='p'>1<value>2</value></property></component>"),
        "2:74 [1] error S3012 the property `p` is given a value in two ways",
    );
    faults_1_0(
        &format!("<component name='a b'>{JAVA}</component><component name='a/b'>{JAVA}</component>"),
        "
2:18 [a b] error S1011 `a b` cannot be a name: it contains ` `
2:86 [a/b] error S1011 `a/b` cannot be a name: it contains `/`",
    );
    faults_1_0(
        &format!("<component name='a' autowire='yes'>{JAVA}<reference name='r' multiplicity='0..*'/></component>"),
        "
2:31 [yes] error S1011 `autowire` is `yes`, expected `true` or `false` | replace it with `true`
2:104 [0..*] error S1011 `multiplicity` is `0..*`, expected `0..1`, `1..1`, `0..n` or `1..n` | remove `multiplicity`: the class says how many targets there can be",
    );
    faults_1_0(
        "<service name='s'/><reference name='r' promote=''/>",
        "
2:2 [service] error S1008 `service` needs the attribute `promote`
2:40 [promote=''] warning S1011 the attribute `promote` of `reference` is empty",
    );
}

#[test]
fn the_versions_differ_where_they_do() {
    faults_1_0("<component name='a'/>", "2:2 [component] warning S1010 the component `a` has no implementation");
    faults_1_1("<component name='a'/>", "2:2 [component] error S1010 the component `a` has no implementation");
    let bare = |namespace: &str| format!("<composite xmlns='{namespace}' name='c'/>");
    faults(&bare(OSOA), "1:2 [composite] warning S1009 `composite` has no `targetNamespace`");
    faults(&bare(OASIS), "1:2 [composite] error S1009 `composite` has no `targetNamespace`");
    faults_1_0(
        &format!("<component xmlns='{OASIS}' name='a'>{JAVA}</component>"),
        "
2:2 [component] error S1003 `component` is of SCA 1.1, but the composite is of SCA 1.0
2:79 [implementation.java] error S1003 `implementation.java` is of SCA 1.1, but the composite is of SCA 1.0",
    );
    let draft = Version::Oasis200903.namespace();
    let (composite, faults) = loaded(&format!(
        "<composite xmlns='{draft}' name='c' targetNamespace='u'><component name='a'>{JAVA}</component></composite>"
    ));
    assert_eq!((composite.unwrap().version, &*faults), (Version::Oasis200903, ""));
}

#[test]
fn what_others_add_is_kept_and_what_is_nobodys_is_not() {
    faults_1_0(
        &format!(
            "<component name='a' xmlns:f='urn:f' f:x='1'><f:y z='1'>text<f:w/></f:y>{JAVA}</component><x:q xmlns:x='urn:q'/>"
        ),
        "",
    );
    faults_1_0(
        &format!("<component name='a' xmlns=''>{JAVA}</component>"),
        "2:2 [component] error S1004 `component` is in no namespace",
    );
    faults_1_0(
        &format!("<component name='a' xmlns:saoms='urn:saoms:1' saoms:colour='red'>{JAVA}<saoms:robot/></component>"),
        "
2:47 [saoms:colour] error S1007 `component` has no attribute `saoms:colour`
2:101 [saoms:robot] error S1004 SAOMS has no element `robot`",
    );
    faults_1_0(
        "<component name='a'><implementation.rust class='robot' libary='l'/></component>",
        "2:56 [libary] error S1007 `implementation.rust` has no attribute `libary` | replace `libary` with `library`",
    );
    // As FraSCAti's users write it.
    faults_1_0(&format!("<component name='a'><service name='s'/><reference name='r'/>{JAVA}</component>"), "");
    // A value of the user's own, in the default namespace.
    faults_1_0(
        &format!("<component name='a'>{JAVA}<property name='p'><order><total/></order></property></component>"),
        "",
    );
}

#[test]
fn an_ill_formed_place_hides_nothing_before_or_behind_it() {
    let text = format!(
        "<composite xmlns='{OSOA}' nmae='c' targetNamespace='u'>\n<component/>\n<component name='a'>\n\
         <property name='x'>a & b</property>\n<propery/></component></composite>"
    );
    let (composite, faults) = loaded(&text);
    assert_eq!(composite.unwrap().components.len(), 2);
    assert_eq!(
        faults,
        "1:54 [nmae] error S1007 `composite` has no attribute `nmae` | replace `nmae` with `name`\n\
         2:2 [component] error S1008 `component` needs the attribute `name`\n\
         2:2 [component] warning S1010 a component has no implementation\n\
         3:2 [component] warning S1010 the component `a` has no implementation\n\
         4:22 [&] error S0109 `&` must start a reference such as `&amp;` | replace `&` with `&amp;`\n\
         5:2 [propery] error S1004 SCA 1.0 has no element `propery` | replace `propery` with `property`\n\
         5:2 [propery] error S1008 `propery` needs the attribute `name`\n"
    );
}

#[test]
fn figure_6_25_of_the_manual_has_nothing_wrong() {
    let text = r#"<?xml version="1.0" encoding="UTF-8"?>
<composite xmlns="http://www.osoa.org/xmlns/sca/1.0"
    targetNamespace="http://launch" name="launchbroker">

    <component name="MessageBrokerComponent">
        <implementation.java
            class="unibg.robotics.tca.MessageBrokerImpl" />
        <property name="IP">localhost</property>
        <property name="port">61616</property>
        <service name="MessageBroker">
            <interface.java
                interface="unibg.robotics.tca.MessageBroker" />
            </service>
        </component>
    </composite>"#;
    let (composite, faults) = loaded(text);
    assert_eq!(faults, "");
    let broker = &composite.unwrap().components[0];
    let values: Vec<_> = broker.properties.iter().map(|one| one.simple_value().unwrap().as_str()).collect();
    assert_eq!(
        (broker.class().unwrap().as_str(), values),
        ("unibg.robotics.tca.MessageBrokerImpl", vec!["localhost", "61616"])
    );
}
