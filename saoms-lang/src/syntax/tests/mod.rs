mod faults;

use std::sync::Arc;

use proptest::prelude::*;

use super::*;
use crate::source::{FileId, Sources, Span};

fn tree(text: &str) -> Document {
    let parsed = parse(FileId(0), &Arc::new(text.into()));
    assert!(parsed.faults.is_empty(), "{text}: {:?}", parsed.faults);
    parsed.document
}

/// The faults as `line:column [marked text] code message`, each with its suggestion.
fn fault(text: &str) -> String {
    let mut sources = Sources::new();
    let file = sources.add("t", text);
    let faults = parse(file, sources.get(file).text()).faults;
    assert!(!faults.is_empty(), "{text}");
    let shown = faults.iter().map(|one| {
        let place = sources.get(file).line_column(one.location.span.start);
        let marked = sources.snippet(one.location);
        let mut out = format!("{}:{} [{marked}] {} {}", place.line, place.column, one.code.id, one.message);
        for suggestion in &one.suggestions {
            out.push_str(&format!(" | {}", suggestion.description));
        }
        out
    });
    shown.collect::<Vec<_>>().join("\n")
}

#[test]
fn a_tree_knows_its_places() {
    let text = "\u{feff}<?xml version='1.0'?><!--c--><a:r xmlns:a = \"u\" a:x='1'\n y=\"2\"><b/> t <c>u</c ></a:r>\n";
    let document = tree(text);
    let slice = |span: Span| &text[span.start as usize..span.end as usize];
    let root = document.root();
    assert_eq!((root.name(), root.prefix(), root.local_name(), root.namespace()), ("a:r", Some("a"), "r", "u"));
    assert_eq!(slice(root.name_span()), "a:r");
    assert_eq!(slice(root.start_tag_span()), "<a:r xmlns:a = \"u\" a:x='1'\n y=\"2\">");
    assert_eq!(slice(root.content_span()), "<b/> t <c>u</c >");
    let attributes: Vec<_> = root.attributes().map(|one| (one.name(), one.namespace(), one.value())).collect();
    assert_eq!(attributes, [("a:x", "u", "1".into()), ("y", "", "2".into())]);
    let y = root.attribute("y").unwrap();
    assert_eq!((slice(y.span()), slice(y.name_span()), slice(y.value_span())), ("y=\"2\"", "y", "2"));
    assert_eq!(root.attribute_in("u", "x").unwrap().name(), "a:x");
    assert!(root.attribute("x").is_none());
    let declared: Vec<_> = root.namespace_declarations().map(|one| slice(one.span())).collect();
    assert_eq!(declared, ["xmlns:a = \"u\""]);
    let children: Vec<_> = root.children().map(|child| slice(child.span())).collect();
    assert_eq!(children, ["<b/>", "<c>u</c >"]);
    assert_eq!((root.text(), slice(root.text_span().unwrap())), (" t ".into(), "t"));
    let inner = document.innermost(text.find("u</c").unwrap() as u32).unwrap();
    assert_eq!((inner.name(), inner.parent().unwrap().id()), ("c", root.id()));
    assert_eq!(inner.namespace(), "");
    assert!(document.innermost(0).is_none());
}

#[test]
fn values_are_normalised_as_xml_says() {
    let document =
        tree("<a v='1\t2\r\n3\n4&#10;5&lt;&#x3C;&quot;é'>x\r\ny\rz&amp;<!--c--><![CDATA[<&amp;>]]><?p?>w</a>");
    assert_eq!(document.root().attribute("v").unwrap().value(), "1 2 3 4\n5<<\"é");
    assert_eq!(document.root().text(), "x\ny\nz&<&amp;>w");
}

#[test]
fn text_has_a_place_without_the_blanks_and_comments_around_it() {
    let shown = |text: &str| {
        let document = tree(text);
        document.root().text_span().map(|span| text[span.start as usize..span.end as usize].to_owned())
    };
    assert_eq!(shown("<a> \n x y \t</a>").as_deref(), Some("x y"));
    assert_eq!(shown("<a> <!-- x --> x <b>y</b> z <?p?> </a>").as_deref(), Some("x <b>y</b> z"));
    assert_eq!(shown("<a> <![CDATA[ x ]]> </a>").as_deref(), Some("x"));
    assert_eq!(shown("<a>&#65;</a>").as_deref(), Some("&#65;"));
    assert_eq!(shown("<a> <!-- x --> <![CDATA[ ]]> <b>y</b></a>"), None);
}

#[test]
fn prefixes_hold_where_they_are_declared() {
    let document = tree("<a xmlns='d' xmlns:p='1'><p:b xmlns:p='2' xmlns=''><c p:x=''/></p:b><p:d xml:lang='en'/></a>");
    let all: Vec<_> = document.elements().map(|one| (one.local_name(), one.namespace())).collect();
    assert_eq!(all, [("a", "d"), ("b", "2"), ("c", ""), ("d", "1")]);
    let c = document.elements().nth(2).unwrap();
    assert_eq!(c.attributes().next().unwrap().namespace(), "2");
    assert_eq!(c.resolve_prefix("p"), Some("2"));
    assert_eq!(c.resolve_prefix(""), None);
    assert_eq!(document.root().resolve_prefix(""), Some("d"));
    assert_eq!(document.root().resolve_prefix("q"), None);
    let d = document.elements().nth(3).unwrap();
    assert_eq!(d.attributes().next().unwrap().namespace(), XML_NAMESPACE);
    assert_eq!(d.resolve_prefix("xml"), Some(XML_NAMESPACE));
    let many: String = (0..40).map(|at| format!(" xmlns:p{at}='{at}'")).collect();
    let document = tree(&format!("<a xmlns='d'{many} p7='x'><b xmlns:p8='n'/></a>"));
    let b = document.elements().nth(1).unwrap();
    let namespaces = ["p7", "p8", "p39", "", "p40"].map(|prefix| b.resolve_prefix(prefix));
    let namespaces = namespaces.map(|one| one.unwrap_or("none"));
    assert_eq!(namespaces, ["7", "n", "39", "d", "none"]);
}

#[test]
fn what_looks_odd_and_is_fine() {
    for text in [
        "<a>]] > ]></a>",
        "<a b='>' c=\"'\" d='\"'/>",
        "<é:ö xmlns:é='u' é:ü='1'/>",
        "<a\n\tb = '1'\r\n/>",
        "<a></a \n>",
        "<!---->\n<a><!-- - --></a><?p?>",
        "<a><![CDATA[]]></a>",
        "<a><![CDATA[<!--]]]]></a>",
        "<a><?p <x> ??></a>",
        "<?xml version = \"1.0\" encoding='ISO-8859-1' standalone='yes' ?><a/>",
        "<?xml version='1.1'?><a/>",
        "<a xmlns:xml='http://www.w3.org/XML/1998/namespace'/>",
        "<a xmlns:p='u' b='' p:b=''/>",
        "<a xmlns='' xmlns:p='u'/>",
        "<a>&#x0000000000000000000000000000000000000000000000000000000000000000000041;</a>",
        "<?xml-stylesheet href='x'?><a/>",
        "<xmlish/>",
        "<a xmlnsx='1'/>",
    ] {
        tree(text);
    }
}

/// The elements of a text, indented by depth, with what can be relied on: attributes, `?` behind a doubtful one, text,
/// and `!` where an element is damaged.
fn shown(text: &str) -> String {
    let mut out = String::new();
    let document = parse(FileId(0), &Arc::new(text.into())).document;
    for element in document.elements() {
        out.push_str(&"  ".repeat(std::iter::successors(element.parent(), |one| one.parent()).count()));
        out.push_str(element.name());
        for one in element.written_attributes() {
            let doubt = if one.is_sure() { "" } else { "?" };
            let value = if one.has_value() { format!("='{}'", one.value()) } else { String::new() };
            out.push_str(&format!(" {}{value}{doubt}", one.name()));
        }
        let text = element.trimmed_text().map(|text| format!(" [{text}]")).unwrap_or_default();
        let end = if element.is_closed() { "" } else { " unclosed" };
        out.push_str(&format!("{text}{end}{}\n", if element.is_damaged() { " !" } else { "" }));
    }
    out
}

#[test]
fn a_tree_goes_on_behind_faults() {
    expect_test::expect![[r#"
        a
          b x='1' [t]
          c [u]
            d !
    "#]]
    .assert_eq(&shown("<a><b x='1'>t</b><c>u<d>&nope;</d></c></a>"));
}

/// The tokens tile any text, and what the tree says of it is inside of it.
#[track_caller]
fn is_lossless(text: &str) {
    let Parse { document, faults } = parse(FileId(0), &Arc::new(text.into()));
    let tokens: String = document.tokens().map(|(_, span)| &text[span.start as usize..span.end as usize]).collect();
    assert_eq!(tokens, text);
    for (_, span) in document.tokens() {
        assert!(!span.is_empty() || text.is_empty() || document.root().name().is_empty(), "{text:?}");
    }
    for element in document.elements() {
        let (span, tag, content) = (element.span(), element.start_tag_span(), element.content_span());
        assert!(span.contains(tag) && span.contains(content), "{text:?}");
        let mut end = tag.start;
        for one in element.written_attributes() {
            assert!(tag.contains(one.span()) && one.span().start >= end, "{text:?} {}", one.name());
            assert!(one.span().contains(one.value_span()), "{text:?}");
            end = one.span().end;
            let _ = (one.value(), one.trimmed(), one.namespace(), one.words().count());
        }
        for child in element.children() {
            assert_eq!(child.parent().map(Element::id), Some(element.id()), "{text:?}");
            assert!(child.id() > element.id(), "{text:?}");
        }
        let _ =
            (element.text(), element.trimmed_text(), element.text_span(), element.end_name_span(), element.namespace());
    }
    for fault in &faults {
        assert!(fault.location.span.end as usize <= text.len(), "{text:?}");
        let _ = &text[fault.location.span.start as usize..fault.location.span.end as usize];
        for edit in fault.suggestions.iter().flat_map(|one| &one.edits) {
            let _ = &text[edit.location.span.start as usize..edit.location.span.end as usize];
        }
    }
    let sound = roxmltree::Document::parse(text).is_ok();
    assert!(sound || !faults.is_empty(), "{text:?} is not well-formed");
}

#[test]
fn any_part_of_a_text_keeps_every_byte() {
    let text = "\u{feff}<?xml version='1.0'?><c xmlns:p='u' a='1 < 2' b=\"x\ty' z>t &amp; &x; <![CDATA[<]]> <!--c--> <d e='&'/f> <p:c></d> ]]> </c ></ü \u{1}";
    let starts: Vec<usize> = text.char_indices().map(|(at, _)| at).chain([text.len()]).collect();
    for &start in &starts {
        for &end in starts.iter().filter(|&&end| end >= start) {
            is_lossless(&text[start..end]);
        }
    }
}

const PIECES: [&str; 40] = [
    "<composite>", "</composite>", "<component name='a'>", "<component", "</component>", "<property name='p'>",
    "</property>", "<property>", "</properti>", "<wire source='", "<", ">", "/>", "</", "'", "\"", "=", " ", "\n", "a",
    "b='1'", "b=2", "&", "&amp;", "&x;", "<!--", "-->", "<![CDATA[", "]]>", "<?p", "?>", "<!DOCTYPE", "[", "p:",
    "xmlns:p='u'", "\u{2028}", "\u{1}", "<!x>", "ä", "\u{201c}",
];

proptest! {
    #[test]
    fn every_byte_is_kept(pieces in prop::collection::vec(0..PIECES.len(), 0..30)) {
        let text: String = pieces.into_iter().map(|piece| PIECES[piece]).collect();
        is_lossless(&text);
    }
}

/// Depth, width and length cost time in proportion; a test that hangs or overflows the stack fails.
#[test]
fn neither_depth_nor_width_matters() {
    let depth = 1_000_000;
    let deep = format!("{}{}", "<a>".repeat(depth), "</a>".repeat(depth));
    let document = tree(&deep);
    assert_eq!(document.root().descendants().count(), depth);
    assert_eq!(document.innermost(3 * depth as u32).unwrap().id().0 as usize, depth - 1);
    assert!(fault(&"<a>".repeat(depth / 10)).contains("S0103"));
    let scopes: String = (0..100_000).map(|n| format!("<p0:a xmlns:p{n}='u{n}'>")).collect();
    assert!(fault(&scopes).contains("S0103"));
    let attributes: String = (0..100_000).map(|n| format!(" a{n}=''")).collect();
    assert_eq!(tree(&format!("<a{attributes}/>")).root().attributes().count(), 100_000);
    assert!(fault(&format!("<a{attributes} a7=''/>")).contains("S0106"));
    let flat = format!("<a>{}</a>", "<b/>t&amp;".repeat(100_000));
    let document = tree(&flat);
    assert_eq!(document.root().children().count(), 100_000);
    assert_eq!(document.root().text().len(), 200_000);
}

#[test]
fn a_value_that_goes_on_behind_the_end_of_its_tag_ends_with_the_text() {
    assert!(fault("<:\" s=\">\"f").starts_with("1:2 [:] S0107"));
}
