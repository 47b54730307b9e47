//! Markup put together at random, whole and broken, beside roxmltree.

use proptest::prelude::*;
use proptest::sample::{select, subsequence};

use crate::load::oracle::judge;

/// Pieces of markup, whole and broken.
fn piece() -> impl Strategy<Value = &'static str> {
    select(vec![
        "<a>",
        "</a>",
        "<a",
        "<b/>",
        "<b>",
        "</b>",
        "</",
        ">",
        "/>",
        "<p:a>",
        "</p:a>",
        " x='1'",
        " x=\"2\"",
        " p:x='1'",
        " q:x='3'",
        " xmlns:p='u'",
        " xmlns:q='u'",
        " xmlns='d'",
        " xmlns:p=''",
        " xmlns:q=''",
        " xmlns=''",
        " y = '&lt;'",
        " z='<'",
        "&amp;",
        "&#65;",
        "&#x41;",
        "&#0;",
        "&#xFFFE;",
        "&no;",
        "&",
        ";",
        "#",
        "]]>",
        "]]",
        "<![CDATA[",
        "<!--",
        "-->",
        "--",
        "-",
        "<?",
        "?>",
        "p",
        "<?p ?>",
        "<?xml version='1.0'?>",
        " ",
        "\t",
        "\r\n",
        "\r",
        "text",
        "'",
        "\"",
        "=",
        ":",
        "é",
        "\u{e9}x",
        "1",
        "\u{1}",
        "\u{fffe}",
        "\u{fffd}",
        "<!DOCTYPE a>",
        "<!",
        "\u{feff}",
        "&#x110000;",
        "<?xml?>",
        " xml:lang='en'",
        " xmlns:xml='u'",
        "<é/>",
        "<·a/>",
        " xmlns:p='http://www.w3.org/2000/xmlns/'",
    ])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn pieces_of_markup_are_judged_alike(pieces in proptest::collection::vec(piece(), 0..12)) {
        judge(&pieces.concat());
    }

    #[test]
    fn pieces_inside_an_element_are_judged_alike(pieces in proptest::collection::vec(piece(), 0..6)) {
        judge(&format!("<a xmlns:p='v'>{}</a>", pieces.concat()));
        judge(&format!("<a xmlns:p='v'{}/>", pieces.concat()));
        judge(&format!("<a x='{}'/>", pieces.concat()));
    }

    #[test]
    fn trees_of_tags_that_are_written_alike_are_judged_alike(steps in proptest::collection::vec(step(), 0..25)) {
        judge(&tree(&steps));
    }
}

/// The next part of a tree.
#[derive(Clone, Debug)]
enum Step {
    /// A start tag without its end: it is empty when it is said so.
    Tag(String, bool),
    End,
    Text(&'static str),
}

const NAMES: [&str; 6] = ["a", "b", "ab", "p:a", "p:b", "q:a"];
/// Attributes, some of which bind a prefix for the tag and its content.
const ATTRIBUTES: [&str; 11] = [
    " x='1'", " xy='22'", " p:x='1'", "\n  q:x=\"\"", " y='&lt;'", " z='a b'", " xmlns='d'", " xmlns='e'",
    " xmlns:p='u'", " xmlns:p='w'", " xmlns:q='u'",
];

fn step() -> impl Strategy<Value = Step> {
    let attributes = prop_oneof![
        3 => subsequence(ATTRIBUTES[..6].to_vec(), 0..3),
        1 => subsequence(ATTRIBUTES.to_vec(), 0..4),
    ];
    let tag = (select(NAMES.to_vec()), attributes, any::<bool>(), select(vec!["", "", " ", "\n"]));
    prop_oneof![
        4 => tag.prop_map(|(name, attributes, is_empty, space)| {
            let end = if is_empty { "/>" } else { ">" };
            Step::Tag(format!("<{name}{}{space}{end}", attributes.concat()), is_empty)
        }),
        2 => Just(Step::End),
        1 => select(vec!["\n        ", "t", "&amp;", "<!-- c -->"]).prop_map(Step::Text),
    ]
}

/// A tree of these steps, with all end tags in place; the prefixes are bound from the start.
fn tree(steps: &[Step]) -> String {
    let mut text = "<r xmlns:p='u' xmlns:q='v'>".to_owned();
    let mut open = vec!["r".to_owned()];
    for step in steps {
        match step {
            Step::Tag(tag, is_empty) => {
                text += tag;
                let name = tag[1..].split([' ', '\n', '/', '>']).next().unwrap_or_default();
                open.extend((!is_empty).then(|| name.to_owned()));
            }
            Step::End if open.len() > 1 => text += &format!("</{}>", open.pop().unwrap_or_default()),
            Step::End => {}
            Step::Text(piece) => text += piece,
        }
    }
    open.iter().rev().for_each(|name| text += &format!("</{name}>"));
    text
}
