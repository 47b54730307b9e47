//! Formatting changes nothing that another XML parser tells, and nothing that is formatted.

use std::sync::Arc;

use proptest::prelude::*;
use proptest::sample::select;
use roxmltree::{Document, Node, NodeType};
use saoms_lang::source::FileId;
use saoms_lang::syntax::parse;
use saoms_tools::format::format;

use crate::files::{self, Sample};

/// The whole infoset as text, without white space beside elements. `None` for what is not well-formed.
fn infoset(text: &str) -> Option<String> {
    // roxmltree leaves the line ends of comments and instructions as they are; XML 1.0, 2.11 does not tell them apart.
    let text = with_line_feeds(text);
    let document = Document::parse(&text).ok()?;
    let mut out = String::new();
    for node in document.descendants() {
        out.push_str(&"-".repeat(node.ancestors().count()));
        match node.node_type() {
            NodeType::Element => out.push_str(&element(node)),
            NodeType::Text if is_between(node) => {}
            NodeType::Text => out.push_str(&format!("text {:?}", node.text())),
            NodeType::Comment => out.push_str(&format!("comment {:?}", node.text())),
            NodeType::PI => out.push_str(&format!("instruction {:?}", node.pi())),
            NodeType::Root => {}
        }
        out.push('\n');
    }
    let lines = out.lines().filter(|line| !line.trim_start_matches('-').is_empty());
    Some(lines.collect::<Vec<_>>().join("\n"))
}

fn with_line_feeds(text: &str) -> String {
    text.replace("\r\n", "\n").replace('\r', "\n")
}

fn element(node: Node<'_, '_>) -> String {
    let mut out = format!("{:?}", node.tag_name());
    for one in node.attributes() {
        out.push_str(&format!(" {:?}:{}={:?}", one.namespace(), one.name(), one.value()));
    }
    for one in node.namespaces() {
        out.push_str(&format!(" {one:?}"));
    }
    out
}

/// True if it is white space that separates the parts of an element, or all that an element of SCA holds.
fn is_between(node: Node<'_, '_>) -> bool {
    let is_blank =
        |node: Node<'_, '_>| node.text().is_some_and(|text| text.trim_matches([' ', '\t', '\r', '\n']).is_empty());
    let Some(parent) = node.parent().filter(|_| is_blank(node)) else { return false };
    let is_sca = parent.tag_name().namespace().is_some_and(|uri| uri.contains("/sca/"));
    let has_text = WITH_TEXT.contains(&parent.tag_name().name());
    let text = &node.document().input_text()[node.range()];
    let is_literal = !text.contains(['&', '[']);
    let has_parts = parent.has_children() && parent.children().any(|one| one.is_element());
    let is_mixed = parent.children().any(|one| one.is_text() && !is_blank(one));
    is_literal && !is_mixed && (has_parts || (is_sca && !has_text))
}

const WITH_TEXT: [&str; 3] = ["property", "value", "documentation"];

/// The pieces that must be there byte for byte, in order.
fn sections(text: &str) -> Vec<String> {
    let text = with_line_feeds(text);
    let starts = text.match_indices("<![CDATA[").map(|(at, _)| &text[at..]);
    starts.filter_map(|rest| Some(rest[..rest.find("]]>")?].to_owned())).collect()
}

fn holds(text: &str, width: usize) {
    let document = parse(FileId(0), &Arc::new(text.into())).well_formed().unwrap();
    let once = format(&document, width);
    assert_eq!(infoset(&once), infoset(text), "{text:?} became {once:?}");
    assert_eq!(sections(&once), sections(text), "{text:?} became {once:?}");
    let again = parse(FileId(0), &Arc::new(once.clone())).well_formed().unwrap();
    assert_eq!(format(&again, width), once, "{text:?}");
}

#[test]
fn real_files_keep_their_meaning() {
    for (index, Sample { text, .. }) in files::all().into_iter().enumerate() {
        holds(&text, [120, 40][index % 2]);
    }
}

/// Content of an element: pieces in any order, and elements with content of their own.
fn content() -> impl Strategy<Value = String> {
    let piece = select(vec![
        " ",
        "\n",
        "\n \n\t\n",
        "\r\n",
        "\r",
        "text",
        "é ",
        "&lt;",
        "&#32;",
        "<!-- a -->",
        "<!--\n b\r\n-->",
        "<?p ?>",
        "<?p a\n b?>",
        "<![CDATA[ ]]>",
        "<![CDATA[<x>\n]]>",
        "<value/>",
        "<p:b x='\"'/>",
        "<reference\nname = 'r' target='a\n b' ></reference >",
    ]);
    let piece = piece.prop_map(str::to_owned);
    piece.prop_recursive(4, 24, 5, |inner| {
        let names = select(vec!["component", "property", "value", "p:a", "documentation"]);
        let attributes = select(vec![
            "", " name = 'a'", " p:x=\"'\"\n y='2' xmlns=''", " xml:space='preserve'", " xmlns:q='u' q:z='&#10;'",
        ]);
        (names, attributes, proptest::collection::vec(inner, 0..6))
            .prop_map(|(name, attributes, inner)| format!("<{name}{attributes}>{}</{name}>", inner.concat()))
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn documents_keep_their_meaning(parts in proptest::collection::vec(content(), 0..4), before in select(vec!["", "<!-- a --> ", "\n\n<?p?>"]), width in 0..60_usize) {
        let inside = parts.concat();
        holds(&format!("{before}<composite xmlns:p='v' xmlns='http://www.osoa.org/xmlns/sca/1.0'>{inside}</composite>\n<!-- end -->"), width);
    }
}
