//! Parts of real composites that come again are read as they are the first time.

use std::ops::Range;

use saoms_lang::diagnostic::{Diagnostic, Diagnostics};
use saoms_lang::load::load_file;
use saoms_lang::model::Composite;
use saoms_lang::source::Sources;
use saoms_lang::xml::{Document, Element};

use crate::files::{Sample, all};

/// How often each part stands there.
const TIMES: usize = 3;

/// The composite with all of its parts several times over. Behind each start tag in it is a filler of one length: the same in all parts, a
/// comment of its own in each, or an instruction of its own, so that no part is written as one before it.
fn repeated(document: &Document, filler: impl Fn(usize) -> String) -> String {
    let (text, root) = (document.text(), document.root());
    let content = root.content_span();
    let slice = |range: Range<u32>| &text[range.start as usize..range.end as usize];
    let mut out = slice(0..content.start).to_owned();
    let mut count = 0;
    for part in (0..TIMES).flat_map(|_| root.children()) {
        let (span, tag) = (part.span(), part.start_tag_span());
        out.push_str(slice(span.start..tag.end));
        if tag.end < span.end {
            out.push_str(&filler(count));
            count += 1;
        }
        out.push_str(slice(tag.end..span.end));
        out.push('\n');
    }
    out + slice(content.end..text.len() as u32)
}

fn loaded(text: &str) -> (Composite, Vec<Diagnostic>) {
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let file = sources.add("t.composite", text);
    let composite = load_file(file, &sources, &mut diagnostics).unwrap();
    (composite, diagnostics.into_sorted())
}

#[test]
fn parts_that_come_again_are_read_as_the_first_time() {
    let mut again = 0;
    for Sample { name, text } in all() {
        let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
        let file = sources.add(name.as_str(), text);
        let Some(composite) = load_file(file, &sources, &mut diagnostics) else { continue };
        let like = repeated(&composite.document, |_| " ".repeat(12));
        let beside_comments = repeated(&composite.document, |count| format!("<!--{count:05}-->"));
        let (other, expected) = loaded(&repeated(&composite.document, |count| format!("<?f {count:06}?>")));
        for (one, told) in [loaded(&like), loaded(&beside_comments)] {
            assert_eq!(told, expected, "{name}");
            assert!(
                one.components == other.components,
                "{name}: {:#?} {:#?}",
                one.components,
                other.components
            );
            assert!(one.properties == other.properties && one.services == other.services, "{name}");
            assert!(one.references == other.references && one.wires == other.wires, "{name}");
            assert_eq!(shown(&one), shown(&other), "{name}");
            again += one.components.len() - composite.components.len();
        }
    }
    assert!(again > 20, "{again} components came again");
}

/// The tree, element by element.
fn shown(composite: &Composite) -> Vec<String> {
    let shown = |element: Element<'_>| {
        let attributes: Vec<_> = element.attributes().map(|one| (one.span(), one.namespace())).collect();
        let places = (element.span(), element.content_span(), element.parent().map(Element::id));
        format!("{} {places:?} {attributes:?} {}", element.name(), element.has_text())
    };
    composite.document.elements().map(shown).collect()
}
