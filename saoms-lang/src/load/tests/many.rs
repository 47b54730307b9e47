//! Components with many services and references.

use super::{OSOA, loaded};

#[test]
fn the_first_of_each_name_is_found_among_many() {
    let references: String = (0..128).map(|number| format!("<reference name='r{}'/>", number % 71)).collect();
    let text = format!(
        "<composite xmlns='{OSOA}' name='c'><component name='A'>{references}<service name='r1'/></component></composite>"
    );
    let composite = loaded(&text).0.unwrap();
    let component = &composite.components[0];
    for number in 0..71 {
        let found = component.reference(&format!("r{number}")).unwrap();
        assert_eq!(found.origin, component.references[number].origin);
    }
    assert_eq!(component.reference("r"), None);
    assert_eq!(component.reference("s"), None);
    assert!(component.service("r1").is_some() && component.service("r2").is_none());
}
