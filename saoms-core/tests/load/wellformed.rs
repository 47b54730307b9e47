//! Markup put together at random, whole and broken, beside roxmltree.

use proptest::prelude::*;
use proptest::sample::select;

use crate::oracle::judge;

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
}
