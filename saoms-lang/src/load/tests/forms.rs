//! What is written as something before it is read as if it were not.

use std::collections::HashSet;

use proptest::prelude::*;

use super::*;

/// Written between the tags of components, each of the same length: the same in each, a comment that differs, or an instruction that does, so
/// that no two are of one form.
const FILLERS: [fn(usize) -> String; 3] =
    [|_| " ".repeat(11), |place| format!("<!--{place:04}-->"), |place| format!("<?f {place:05}?>")];

/// One piece of a composite; `@` are values, and `~` is the filler.
const PIECES: [&str; 14] = [
    "<component name=\"@\">~<implementation.java class=\"@\"/></component>\n",
    "<component name=\"@\">~<implementation.java class=\"@\"/>\n<property name='@'>@</property></component>",
    "<component name=\"@\">~<implementation.rust class=\"@\"/><property name=\"@\" value=\"@\"/><reference name=\"r\" target='@'/></component> ",
    "<component name=\"@\">~<implementation.rust class=\"robot.Robot\"/><service name=\"@\"/><reference name=\"@\"/></component >",
    "<component name=\"@\">~<implementation.rust class=\"@\" library=\"@\"/><property name=\"@\"> @ </property></component>",
    "<component name=\"@\">~<implementation.composite name=\"@\"/><service name=\"@\"><interface.java interface=\"@\"/></service></component>",
    "<component name=\"@\">~<property name=\"@\"><value>@</value><value>@</value></property></component>",
    "<component name=\"@\">~<implementation.java class=\"@\"/><property xmlns:a=\"urn:@\" name=\"@\"><a:b>@</a:b></property></component>",
    "<component name=\"@\" autowire=\"@\">~@<implementation.java class=\"@\" requires='@'/></component>",
    "<component name=\"@\" s:count=\"@\">~<implementation.script script=\"@\"/><property name=\"@\" value=\"@\">@</property></component>",
    "<component name=\"@\">~<!-- @ --><implementation.rust class=\"@\"/><!--@ --><property name=\"@\">@</property><!-- @ <b/> --><property name=\"@\"><!-- @ -->@</property></component>\n",
    "<component name=\"@\">~<implementation.rust class=\"@\"/><property name=\"@\">@<!-- @ --></property><property name=\"@\">@ </property>@</component><!-- @ -->\n",
    "<wire source=\"@\" target=\"@\"/>\n",
    "<property name=\"@\">~<e>@</e></property><component name=\"@\">~</component>",
];

const VALUES: [&str; 20] = [
    "a", "b", "Robot001", "10ms", "x/y", "a b", " a", "", " ", "a&amp;b", "&lt;", "${index}", "$", "1a", "-",
    "s:a", "\u{e9}", "a]b", "a\nb", "true",
];

/// A composite of pieces, with or without what makes each of them one of its own.
fn written((is_1_1, pieces): &(bool, Vec<(usize, Vec<usize>)>), filler: fn(usize) -> String) -> String {
    let namespace = if *is_1_1 { OASIS } else { OSOA };
    let mut text = format!(
        "<composite xmlns='{namespace}' xmlns:s='{}' name='c' targetNamespace='u'>",
        crate::model::SAOMS_NAMESPACE
    );
    let mut count = 0;
    for (piece, values) in pieces {
        let mut values = values.iter().cycle();
        for letter in PIECES[*piece].chars() {
            match letter {
                '@' => text.push_str(values.next().map_or("", |value| VALUES[*value])),
                '~' => {
                    text.push_str(&filler(count));
                    count += 1;
                }
                letter => text.push(letter),
            }
        }
    }
    text + "</composite>"
}

/// All that is read of a text.
fn read(text: &str) -> (String, String) {
    let (composite, faults) = loaded(text);
    let Some(composite) = composite else { return (String::new(), faults) };
    let tree = composite.document.elements().map(|element| {
        let attributes: Vec<_> = element.attributes().map(|one| (one.span(), one.value())).collect();
        let around = (
            element.parent().map(|one| one.id()),
            element.namespace(),
            element.span(),
            element.content_span(),
        );
        let children: Vec<_> = element.children().map(|one| one.id()).collect();
        format!("{} {around:?} {children:?} {attributes:?} {:?}\n", element.name(), element.has_text())
    });
    let Composite { components, properties, wires, outside, severities, .. } = &composite;
    (
        tree.collect::<String>()
            + &format!("{components:#?} {properties:?} {wires:?} {outside:?} {severities:?}"),
        faults,
    )
}

proptest! {
    #[test]
    fn a_component_like_one_before_is_read_as_any_other(
        composite in (any::<bool>(), prop::collection::vec((0..PIECES.len(), prop::collection::vec(0..VALUES.len(), 1..6)), 1..40)),
    ) {
        let [like, commented, unlike] = FILLERS.map(|filler| written(&composite, filler));
        let expected = read(&unlike);
        prop_assert!(read(&like) == expected, "{like}");
        prop_assert!(read(&commented) == expected, "{commented}");
    }
}

#[test]
fn forms_are_found_again() {
    let pieces: Vec<_> = (0..60).map(|place| (place % 5, vec![0, 1, 2])).collect();
    let forms = |filler| {
        let (composite, faults) = loaded(&written(&(true, pieces.clone()), filler));
        let composite = composite.unwrap_or_else(|| panic!("{faults}"));
        let forms: Vec<u32> = composite.document.alike().iter().map(|one| one.form).collect();
        (forms.len(), forms.iter().collect::<HashSet<_>>().len())
    };
    assert_eq!(FILLERS.map(forms), [(60, 5), (60, 5), (60, 60)]);
}

/// A name with an expression is one of replicas, also where the component before has the same.
#[test]
fn a_replica_is_never_made_as_what_is_none() {
    let pieces: Vec<(usize, Vec<usize>)> = [0, 0, 11, 11, 0].map(|value| (0, vec![value])).into();
    assert_eq!(VALUES[11], "${index}");
    let fleet = (true, pieces);
    let [like, commented, unlike] = FILLERS.map(|filler| read(&written(&fleet, filler)));
    assert_eq!((&like, &commented), (&unlike, &unlike));
}
