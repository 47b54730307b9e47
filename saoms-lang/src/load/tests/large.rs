//! Files that are large, or deep, or wrong a million times.

use super::*;

#[test]
fn a_million_faults_are_counted_and_a_few_shown() {
    let text = format!("<composite xmlns='{OSOA}' name='c' targetNamespace='u'>{}</composite>", "<x/>".repeat(50_000));
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let file = sources.add("t", text);
    load_file(file, &sources, &mut diagnostics);
    assert_eq!(diagnostics.errors(), 50_000);
    assert_eq!(diagnostics.into_sorted().len(), 1001);
}

#[test]
fn an_element_of_endless_attributes_takes_no_time() {
    let attributes: String = (0..50_000).map(|number| format!(" a{number}=''")).collect();
    let text = format!("<composite xmlns='{OSOA}'{attributes} name='c' targetNamespace='u'/>");
    let (composite, faults) = loaded(&text);
    assert!(composite.is_some() && faults.contains("49000 more of S1007 (unknown-attribute), not shown"));
}

#[test]
fn depth_is_no_matter_wherever_it_is() {
    let deep = |name: &str| format!("{}{}", format!("<{name}>").repeat(100_000), format!("</{name}>").repeat(100_000));
    let (composite, faults) = loaded(&format!(
        "<composite xmlns='{OSOA}' name='c' targetNamespace='u'><component name='a'>{JAVA}<property name='p'>{}</property>\
         </component>{}</composite>",
        deep("value-of-mine"),
        deep("component name='b'").replace("</component name='b'>", "</component>"),
    ));
    let composite = composite.unwrap();
    assert_eq!(composite.components.len(), 2);
    assert_eq!(composite.components[0].properties[0].content().len(), 1);
    assert!(faults.starts_with("1:") && faults.contains("`component` is not allowed in `component`"), "{faults}");
}

#[test]
fn a_list_has_an_end() {
    let long = "a ".repeat(1_000_001);
    let text = format!(
        "<composite xmlns='http://docs.oasis-open.org/ns/opencsa/sca/200912' name='c' targetNamespace='u'><component name='a'><implementation.java class='b'/><reference name='r' target='{long}'/></component></composite>"
    );
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let file = sources.add("c.composite", text);
    let composite = load_file(file, &sources, &mut diagnostics).unwrap();
    assert_eq!(composite.components[0].references[0].targets.len(), 1_000_000);
    let messages: Vec<_> = diagnostics.iter().map(|one| one.message.as_str()).collect();
    assert_eq!(messages, ["`target` has more than 1000000 words"]);
}
