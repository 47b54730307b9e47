//! What is defined by others than the core of SCA: required attributes and what their values can be.

use super::*;

/// What is wrong with a service that has this binding, in SCA 1.0.
#[track_caller]
fn binding(inside: &str, expected: &str) {
    faults_1_0(
        &format!("<component name='a'>\n{JAVA}<service name='s'>\n{inside}\n</service></component>"),
        expected,
    );
}

/// What is wrong with a component that has this implementation, in SCA 1.0.
#[track_caller]
fn implementation(inside: &str, expected: &str) {
    faults_1_0(&format!("<component name='a'>\n{inside}\n</component>"), expected);
}

const TUSCANY: &str = "xmlns='http://tuscany.apache.org/xmlns/sca/1.0'";

#[test]
fn bindings_of_ejb_are_of_a_known_kind() {
    binding("<binding.ejb session-type='stateful' ejb-version='EJB3'/>", "");
    binding(
        "<binding.ejb session-type='state' ejb-version='EJB4'/>",
        "4:28 [state] error S1011 `session-type` is `state`, and has to be `stateful` or `stateless`
4:48 [EJB4] error S1011 `ejb-version` is `EJB4`, and has to be `EJB2` or `EJB3` | replace it with `EJB2`",
    );
}

#[test]
fn attributes_that_implementations_need_can_be_misspelt() {
    let told = |implementation: &str, expected: &str| {
        faults_1_1(&format!("<component name='a'>\n{implementation}</component>"), expected);
    };
    told("<implementation.spring location='x'/>", "");
    told(
        "<implementation.spring locaton='x'/>",
        "3:24 [locaton] error S1007 `implementation.spring` has no attribute `locaton` | replace `locaton` with `location`",
    );
    told(
        "<implementation.spring/>",
        "3:2 [implementation.spring] error S1008 `implementation.spring` needs the attribute `location`",
    );
}

#[test]
fn formats_are_of_those_who_make_bindings() {
    binding("<binding.sca><wireFormat.default/><operationSelector.own/></binding.sca>", "");
    binding(
        "<binding.sca><format.default/></binding.sca>",
        "4:15 [format.default] error S1004 SCA 1.0 has no element `format.default`",
    );
}

#[test]
fn parts_of_jms_are_named_and_their_values_known() {
    binding(
        "<binding.jms><destination name='a' create='ifnotexist'/><resourceAdapter name='b'/></binding.jms>",
        "",
    );
    binding(
        "<binding.jms><destination name='a' create='perhaps'/>
<response><connectionFactory name=''/></response>
<resourceAdapter/><operationProperties/></binding.jms>",
        "4:44 [perhaps] error S1011 `create` is `perhaps`, and has to be `always` or `never` or `ifNotExist`
5:30 [name=''] error S1011 the attribute `name` is empty
6:2 [resourceAdapter] error S1008 `resourceAdapter` needs the attribute `name`
6:20 [operationProperties] error S1008 `operationProperties` needs the attribute `name`",
    );
}

#[test]
fn parts_of_jms_of_no_namespace_or_another_version_are_told() {
    binding(
        "<binding.jms><destination xmlns='' name='q'/>\n<o:headers xmlns:o='http://docs.oasis-open.org/ns/opencsa/sca/200912'/><x:own xmlns:x='urn:x'/></binding.jms>",
        "4:15 [destination] error S1004 `destination` is in no namespace
5:2 [o:headers] error S1003 `o:headers` is of SCA 1.1, and the composite is of SCA 1.0",
    );
}

#[test]
fn implementations_of_other_kinds_need_what_their_schemas_say() {
    implementation(
        "<implementation.cpp library='l'/>",
        "3:2 [implementation.cpp] error S1008 `implementation.cpp` needs the attribute `header`",
    );
    implementation(
        &format!("<implementation.node {TUSCANY} uri='n'/>"),
        "3:2 [implementation.node] error S1008 `implementation.node` needs the attribute `composite`",
    );
    implementation(&format!("<implementation.script {TUSCANY} script='a.js'/>"), "");
    implementation(
        &format!("<implementation.script {TUSCANY} language='js'>function f() {{}}</implementation.script>"),
        "",
    );
    implementation(
        &format!("<implementation.script {TUSCANY} language='js'/>"),
        "3:2 [implementation.script] error S1008 `implementation.script` needs the attribute `script`",
    );
}

#[test]
fn properties_of_osgi_are_those_of_a_service_or_a_reference() {
    implementation(
        &format!(
            "<implementation.osgi {TUSCANY} bundleSymbolicName='b'>
<properties service='s'/><properties referenceCallback='r'/>
<properties name='p'/></implementation.osgi>"
        ),
        "5:2 [properties] error S1008 `properties` says of no service or reference what it is about",
    );
}

#[test]
fn an_xsi_type_says_which_interface_it_is() {
    let text = "<composite xmlns='http://www.osoa.org/xmlns/sca/1.0' name='c' targetNamespace='u'
    xmlns:xsi='http://www.w3.org/2001/XMLSchema-instance' xmlns:t='http://www.osoa.org/xmlns/sca/1.0'><component name='a'>
<implementation xsi:type='t:JavaImplementation' class='x.Y'/>
<service name='s'><interface xsi:type='interface.java' interface='x.S'/><binding xsi:type='t:SCABinding'/></service>
<reference name='r'><interface xsi:type='WSDLPortType'/></reference>
<reference name='q'><interface xsi:type='t:Other'/><binding xsi:type='JavaInterface'/></reference>
</component></composite>";
    let (composite, faults) = loaded(text);
    let composite = composite.unwrap();
    let component = &composite.components[0];
    assert_eq!(component.class().unwrap().as_str(), "x.Y");
    let service = &component.services[0];
    assert_eq!(service.interface().unwrap().kind, InterfaceKind::Java);
    assert_eq!(service.interface().unwrap().interface.as_ref().unwrap().as_str(), "x.S");
    assert_eq!((service.bindings()[0].kind.as_str(), service.bindings()[0].is_sca), ("sca", true));
    assert_eq!(
        faults,
        "5:22 [interface] error S1008 `interface` needs the attribute `interface`
6:22 [interface] error S1004 SCA 1.0 has no element `interface` | replace `interface` with `interface.java`
6:53 [binding] error S1004 SCA 1.0 has no element `binding` | replace `binding` with `binding.sca`\n"
    );
}

#[test]
fn a_queue_of_jms_is_named_in_one_way() {
    let told = |inside: &str, expected: &str| {
        faults_1_1(
            &format!("<component name='a'>{JAVA}<service name='s'>\n{inside}</service></component>"),
            expected,
        );
    };
    // What is so by itself is no fault in SCA 1.1, whose schema says that it is.
    told("<binding.jms><destination jndiName='a' type='queue'/></binding.jms>", "");
    told("<binding.jms uri='jms:jndi:a'><response><destination jndiName='b'/></response></binding.jms>", "");
    told(
        "<binding.jms uri='jms:jndi:a'><destination jndiName='b'/></binding.jms>",
        "3:32 [destination] warning S2054 binding.jms has a `uri`, and a `destination` that says where messages go",
    );
}

#[test]
fn interfaces_and_callbacks_name_interfaces_of_wsdl() {
    let told = |interface: &str, expected: &str| {
        let inside = format!(
            "<component name='a'>\n{JAVA}<service name='s'>\n<interface.wsdl {interface}/>\n</service></component>"
        );
        faults_1_1(&inside, expected);
    };
    for right in ["u#wsdl.interface(I)", "u#wsdl.portType(I)", "u#wsdl.porttype(I)", "u#xpointer(//I)"] {
        told(&format!("interface='{right}' callbackInterface='{right}'"), "");
    }
    told(
        "interface='u#wsdl.service(S)'",
        "4:28 [u#wsdl.service(S)] error S1011 `#wsdl.service(S)` is no interface in a WSDL document",
    );
    told(
        "interface='u#wsdl.porttype'",
        "4:28 [u#wsdl.porttype] error S1011 `#wsdl.porttype` is no interface in a WSDL document",
    );
    told(
        "interface='u#wsdl.porttype()'",
        "4:28 [u#wsdl.porttype()] error S1011 `#wsdl.porttype()` is no interface in a WSDL document",
    );
    told(
        "interface='u#wsdl.interface(I)' callbackInterface='u'",
        "4:68 [u] error S1011 `u` names nothing in a WSDL document",
    );
    told(
        "interface='u#wsdl.interface(I)' callbackInterface='u#wsdl.binding(B)'",
        "4:68 [u#wsdl.binding(B)] error S1011 `#wsdl.binding(B)` is no interface in a WSDL document",
    );
    told(
        "interface='u#wsdl.interface(I)' callbackInterface=''",
        "4:49 [callbackInterface=''] error S1011 the attribute `callbackInterface` is empty",
    );
    binding("<binding.ws wsdlElement='u#wsdl.endpoint(S/E)'/>", "");
    binding(
        "<binding.ws wsdlElement='u#wsdl.prot(S/P)'/>",
        "4:26 [u#wsdl.prot(S/P)] error S1011 `#wsdl.prot(S/P)` is no binding, port or service in a WSDL document",
    );
}
