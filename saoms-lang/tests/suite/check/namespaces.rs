//! Elements and names whose namespaces are not those that count.

use expect_test::expect;

use crate::check::component_types::found;
use crate::check::support::faults;

#[test]
fn an_element_of_sca_in_another_namespace_is_told() {
    let inside = "<x:component xmlns:x='urn:x' name='A'><implementation.java class='x.A'/></x:component>
<component name='B'><implementation.java class='x.B'/><x:property xmlns:x='urn:x' name='p'>1</x:property><x:note xmlns:x='urn:x'/></component>
<x:documentation xmlns:x='urn:x'/>
<xi:include xmlns:xi='http://www.w3.org/2001/XInclude' href='more.composite'/>";
    expect![[r#"
        2:2-13 warning S1015: `x:component` is ignored: its namespace `urn:x` is not that of SCA
          help: write `<component>` if you mean the element of SCA
        3:56-66 warning S1015: `x:property` is ignored: its namespace `urn:x` is not that of SCA
          help: write `<property>` if you mean the element of SCA
        5:2-12 warning S1015: `xi:include` is ignored: its namespace `http://www.w3.org/2001/XInclude` is not that of SCA
          help: `<include name="..."/>` without a prefix includes a composite by its name
    "#]]
    .assert_eq(&found(inside, &[], true));
    let implementation = "<component name='A'><x:implementation.java xmlns:x='urn:x' class='example.Gps'/></component>
<component name='B'><x:implementation.bpel xmlns:x='urn:x' process='x:b'/></component>";
    expect![[r#"
        2:22-43 error S3002: this program cannot run `implementation.java` of another namespace
          help: to use the element of SCA, write it with the prefix of the elements around it, or without a prefix if they have none
        3:22-43 error S3002: this program cannot run `implementation.bpel`
          help: name the class of the component: `implementation.java class="..."`, `implementation.rust class="..."` or `implementation.python module="..." class="..."`
    "#]].assert_eq(&faults(implementation));
}

#[test]
fn a_prefix_in_a_list_of_names_has_a_namespace() {
    let inside = "<component name='A' requires='t:known q:unknown plain' policySets='{urn:x}p http://x/y'><implementation.java class='x.A'/></component>
<property name='p' element='q:e'/>";
    expect![[r#"
        2:39-48 warning S1011: the prefix `q` of `q:unknown` is not declared
          help: declare it in the root element: `xmlns:q="..."`, or correct it
        3:17-18 warning S2026: no component uses the property `p` of the composite
          help: remove it, or use its value in a component with `source="$p"`
        3:29-32 warning S1011: the prefix `q` of `q:e` is not declared
          help: declare it in the root element: `xmlns:q="..."`, or correct it
    "#]]
    .assert_eq(&found(inside, &[], true));
}
