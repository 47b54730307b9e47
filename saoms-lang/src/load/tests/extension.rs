//! Implementations, interfaces and bindings that others define.

use super::*;

/// Asserts the faults of a service of SCA 1.0 that has this binding.
#[track_caller]
fn binding(inside: &str, expected: &str) {
    faults_1_0(&format!("<component name='a'>\n{JAVA}<service name='s'>\n{inside}\n</service></component>"), expected);
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
    assert_eq!(service.contract().interface.as_ref().unwrap().kind, InterfaceKind::Java);
    assert_eq!(service.contract().interface.as_ref().unwrap().interface.as_ref().unwrap().as_str(), "x.S");
    assert_eq!((service.contract().bindings[0].kind.as_str(), service.contract().bindings[0].is_sca), ("sca", true));
    assert_eq!(
        faults,
        "5:22 [interface] error S1008 `interface` needs the attribute `interface`
6:22 [interface] error S1004 SCA 1.0 has no element `interface` | replace `interface` with `interface.java`
6:53 [binding] error S1004 SCA 1.0 has no element `binding` | replace `binding` with `binding.sca`\n"
    );
}

#[test]
fn what_others_define_is_judged_by_its_names_alone() {
    binding("<binding.jms uri='x'><destination/><any/></binding.jms>", "");
    binding("<binding.ejb session-type='state' ejb-version='EJB4'/>", "");
    faults_1_1("<component name='a'>\n<implementation.spring/></component>", "");
    faults_1_1("<component name='a'>\n<implementation.bpel process='none'/></component>", "");
}
