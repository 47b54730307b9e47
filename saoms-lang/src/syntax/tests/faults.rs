//! Faults of well-formedness, and their places.

use super::{fault, tree};

#[test]
fn what_is_not_well_formed_is_found_at_its_place() {
    const CASES: &[&str] = &[
        "<a",
        "<a b='",
        "<a>x",
        "<a><b></a>",
        "<a><b>x</a>",
        "<a><b/></b></a>",
        "<a><long/></long></a>",
        "<a><long/>x</long></a>",
        "<a></A>",
        "<a/></a>",
        "<a/><b/>",
        "<a/> x",
        "x y <a/>",
        "&lt;<a/>",
        "<a/><![CDATA[x]]>",
        "<!-- c -->",
        "<a b='1' b='2'/>",
        "<a xmlns:p='u' xmlns:q='u' p:b='' q:b=''/>",
        "<a b='<'/>",
        "<a b='1 < 2/></a>",
        "<a b='1><c/></a>",
        "<a b='1\"/><c/></a>",
        "<a b='1 c='2'/>",
        "<a b '1'/>",
        "<a b: '1'/>",
        "<a b='1', c='2'/>",
        "<a\u{a0}b='1'/>",
        "<a b\u{200b}='1'/>",
        "<a b/>",
        "<a b=c/>",
        "<a b='1'c='2'/>",
        "<a /b>",
        "<a b='1'\\>",
        "<a></a><b></b>",
        "<a></a><b></b></a>",
        "<a =''/>",
        "<a <b/></a>",
        "<a>< b/></a>",
        "<1/>",
        "<a:b:c/>",
        "<:a/>",
        "<a -b=''/>",
        "<a></ a>",
        "<a></a b=''>",
        "<a></a",
        "<a>&nbsp;</a>",
        "<a>&AMP;</a>",
        "<a>a & b</a>",
        "<a b='x && y'/>",
        "<a b='x&y'/>",
        "<a>&#0;</a>",
        "<a>&#xD800;</a>",
        "<a>&#X41;</a>",
        "<a>&#1114112;</a>",
        "<a>]]></a>",
        "<a><!-- x -- y --></a>",
        "<a><!-- x ---></a>",
        "<a><!-- x </a>",
        "<a><![CDATA[ x </a>",
        "<a><?p x </a>",
        "<a><!x></a>",
        "<!DOCTYPE a><a/>",
        "<!DOCTYPE a [<!ENTITY x '<a/>",
        "<!doctype a><a/>",
        "<a><?xml version='1.0'?></a>",
        "x <?xml version='1.0'?><a/>",
        "<?xml version=\u{201d}1.0\u{201d}?><a/>",
        "<?xml?><a/>",
        "<?xml encoding='UTF-8'?><a/>",
        "<?xml version='2.0'?><a/>",
        "<?xml version='1.0' encoding='-'?><a/>",
        "<?xml version='1.0'encoding='x'?><a/>",
        "<?xml version='1.0' standalone='no' encoding='x'?><a/>",
        "<?xml version='1.0' standalone='maybe'?><a/>",
        "<?xml version='1.0' x?><a/>",
        "<?XML x?><a/>",
        "<?1?><a/>",
        "<p:a/>",
        "<a p:b=''/>",
        "<a xsi:type=''/>",
        "<a xmlns:scx='u'><sca:b/></a>",
        "<a><b xmlns:p='u'/><p:c/></a>",
        "<a xmlns:p=''/>",
        "<a xmlns:xmlns='u'/>",
        "<a xmlns:xml='u'/>",
        "<a xmlns='http://www.w3.org/2000/xmlns/'/>",
        "<xmlns:a/>",
        "<",
    ];
    let shown = CASES.iter().map(|text| format!("{text}\n    {}\n", fault(text).replace('\n', "\n    ")));
    expect_test::expect![[r#"
        <a
            1:2 [a] S0103 the start tag of `a` has no `>`
        <a b='
            1:6 ['] S0103 the value of `b` has no closing quote
        <a>x
            1:2 [a] S0103 `<a>` has no end tag | add `</a>` at the end
        <a><b></a>
            1:7 [</a>] S0102 `</a>` found where `</b>` is expected | end `b` with `/>`
        <a><b>x</a>
            1:8 [</a>] S0102 `</a>` found where `</b>` is expected | close `b` first
        <a><b/></b></a>
            1:8 [</b>] S0102 `</b>` found where `</a>` is expected | remove it
        <a><long/></long></a>
            1:11 [</long>] S0102 `</long>` found where `</a>` is expected | remove it
        <a><long/>x</long></a>
            1:12 [</long>] S0102 `</long>` found where `</a>` is expected | remove its `/`
        <a></A>
            1:4 [</A>] S0102 `</A>` found where `</a>` is expected | replace it with `</a>`
        <a/></a>
            1:5 [</a>] S0102 `</a>` closes nothing: no element is open
        <a/><b/>
            1:6 [b] S0104 a second root element: a file has exactly one
        <a/> x
            1:6 [x] S0104 text outside of the root element
        x y <a/>
            1:1 [x y] S0104 text outside of the root element
        &lt;<a/>
            1:1 [&lt;] S0104 text outside of the root element
        <a/><![CDATA[x]]>
            1:5 [<![CDATA[x]]>] S0104 text outside of the root element
        <!-- c -->
            1:11 [] S0101 the file contains no element
        <a b='1' b='2'/>
            1:10 [b] S0106 the attribute `b` is given twice | remove the second `b`
        <a xmlns:p='u' xmlns:q='u' p:b='' q:b=''/>
            1:35 [q:b] S0106 the attribute `q:b` is given twice: both prefixes are of `u` | remove the second `q:b`
        <a b='<'/>
            1:7 [<] S0105 `<` in the value of `b` | replace `<` with `&lt;`
        <a b='1 < 2/></a>
            1:9 [<] S0105 `<` in the value of `b`
            1:14 [</a>] S0102 `</a>` closes nothing: no element is open
        <a b='1><c/></a>
            1:6 ['1] S0105 the value of `b` has no closing quote | close it with `'`
        <a b='1"/><c/></a>
            1:6 ['1"] S0105 the value of `b` has no closing quote | replace `"` with `'`
            1:12 [c] S0104 a second root element: a file has exactly one
        <a b='1 c='2'/>
            1:6 ['1] S0105 this value has no closing quote before `c` | close it with `'`
        <a b '1'/>
            1:4 [b] S0105 the attribute `b` has no value | insert `=`
        <a b: '1'/>
            1:5 [:] S0105 found `:` between `b` and its value, expected `=` | replace `:` with `=`
        <a b='1', c='2'/>
            1:9 [,] S0101 `,` is misplaced in the start tag of `a` | remove `,`
        <a b='1'/>
            1:3 [ ] S0107 U+00A0, which looks like a blank, in the name of an element | replace it with a blank
        <a b\u{200b}='1'/>
            1:5 [\u{200b}] S0107 U+200B, which looks like nothing, in the name of an attribute | remove it
        <a b/>
            1:4 [b] S0105 the attribute `b` has no value
        <a b=c/>
            1:6 [c] S0105 the value of `b` is not in quotes | put it in quotes
        <a b='1'c='2'/>
            1:9 [c] S0105 white space is missing between two attributes | insert a blank
        <a /b>
            1:4 [/] S0101 `/` is misplaced in the start tag of `a`
        <a b='1'\>
            1:9 [\] S0101 a tag without content ends with `/>`, not with `\>` | replace `\` with `/`
        <a></a><b></b>
            1:9 [b] S0104 a second root element: a file has exactly one
        <a></a><b></b></a>
            1:4 [</a>] S0104 `</a>` is too early: more elements of `a` and another `</a>` follow | remove it
        <a =''/>
            1:4 [=] S0101 `=` is misplaced in the start tag of `a`
        <a <b/></a>
            1:4 [<] S0103 the start tag of `a` has no `>` before the next `<`
        <a>< b/></a>
            1:4 [<] S0107 white space cannot follow `<`: the name of an element is expected | remove the white space
        <1/>
            1:2 [1] S0107 `1` is not a valid name for an element
        <a:b:c/>
            1:2 [a:b:c] S0107 `a:b:c` is not a valid name for an element
        <:a/>
            1:2 [:a] S0107 `:a` is not a valid name for an element
        <a -b=''/>
            1:4 [-b] S0107 `-b` is not a valid name for an attribute
        <a></ a>
            1:4 [</] S0107 an end tag is `</`, the name of the element, and `>` | remove the white space
        <a></a b=''>
            1:8 [b] S0101 `b` is misplaced in an end tag
        <a></a
            1:4 [</a] S0103 this end tag has no `>`
        <a>&nbsp;</a>
            1:4 [&nbsp;] S0109 unknown entity `&nbsp;`
        <a>&AMP;</a>
            1:4 [&AMP;] S0109 unknown entity `&AMP;` | replace `&AMP;` with `&amp;`
        <a>a & b</a>
            1:6 [&] S0109 `&` must start a reference such as `&amp;` | replace `&` with `&amp;`
        <a b='x && y'/>
            1:9 [&&] S0109 `&` must start a reference such as `&amp;` | replace `&&` with the `and` of conditions
        <a b='x&y'/>
            1:8 [&] S0109 `&` must start a reference such as `&amp;` | replace `&` with `&amp;`
        <a>&#0;</a>
            1:4 [&#0;] S0109 `&#0;` is not a character that XML allows
        <a>&#xD800;</a>
            1:4 [&#xD800;] S0109 `&#xD800;` is not a character that XML allows
        <a>&#X41;</a>
            1:4 [&#X41;] S0109 `&#X41;` is not a character that XML allows
        <a>&#1114112;</a>
            1:4 [&#1114112;] S0109 `&#1114112;` is not a character that XML allows
        <a>]]></a>
            1:4 []]>] S0101 `]]>` in text, which XML allows only to end a CDATA section | replace it with `]]&gt;`
        <a><!-- x -- y --></a>
            1:11 [--] S0101 `--` inside a comment | write single dashes
        <a><!-- x ---></a>
            1:11 [--] S0101 `--` inside a comment | write single dashes
        <a><!-- x </a>
            1:4 [<!--] S0103 this comment has no end
        <a><![CDATA[ x </a>
            1:4 [<![CDATA[] S0103 this CDATA section has no end
        <a><?p x </a>
            1:4 [<?] S0103 this processing instruction has no end
        <a><!x></a>
            1:4 [<!] S0101 `<!` starts a comment (`<!--`) or a CDATA section (`<![CDATA[`), and nothing else here
        <!DOCTYPE a><a/>
            1:1 [<!DOCTYPE] S0110 a document type declaration is not allowed here
        <!DOCTYPE a [<!ENTITY x '<a/>
            1:1 [<!DOCTYPE] S0110 a document type declaration is not allowed here
        <!doctype a><a/>
            1:1 [<!doctype] S0110 a document type declaration is not allowed here
        <a><?xml version='1.0'?></a>
            1:4 [<?xml version='1.0'?>] S0111 the XML declaration is not at the very start of the file
        x <?xml version='1.0'?><a/>
            1:1 [x] S0104 text outside of the root element
        <?xml version=”1.0”?><a/>
            1:7 [version=”1.0”] S0111 expected `version`, `encoding` or `standalone` here | replace it with `version="1.0"`
        <?xml?><a/>
            1:3 [xml] S0111 the XML declaration must start with `version`
        <?xml encoding='UTF-8'?><a/>
            1:3 [xml] S0111 the XML declaration must start with `version`
        <?xml version='2.0'?><a/>
            1:16 [2.0] S0111 `2.0` is not a value of version in an XML declaration
        <?xml version='1.0' encoding='-'?><a/>
            1:31 [-] S0111 `-` is not a value of encoding in an XML declaration
        <?xml version='1.0'encoding='x'?><a/>
            1:20 [encoding] S0111 `encoding` is misplaced in the XML declaration
        <?xml version='1.0' standalone='no' encoding='x'?><a/>
            1:37 [encoding] S0111 `encoding` is misplaced in the XML declaration
        <?xml version='1.0' standalone='maybe'?><a/>
            1:33 [maybe] S0111 `maybe` is not a value of standalone in an XML declaration
        <?xml version='1.0' x?><a/>
            1:21 [x] S0111 expected `version`, `encoding` or `standalone` here
        <?XML x?><a/>
            1:3 [XML] S0111 `XML` is reserved: an instruction cannot have this name
        <?1?><a/>
            1:1 [<?1] S0107 a processing instruction is `<?`, a name, white space, anything, and `?>`
        <p:a/>
            1:2 [p] S0112 the prefix `p` is not declared
        <a p:b=''/>
            1:4 [p] S0112 the prefix `p` is not declared
        <a xsi:type=''/>
            1:4 [xsi] S0112 the prefix `xsi` is not declared | declare it in the root element: `xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"`
        <a xmlns:scx='u'><sca:b/></a>
            1:19 [sca] S0112 the prefix `sca` is not declared | replace `sca` with `scx`
        <a><b xmlns:p='u'/><p:c/></a>
            1:21 [p] S0112 the prefix `p` is not declared
        <a xmlns:p=''/>
            1:4 [xmlns:p=''] S0112 the namespace of a prefix cannot be empty
        <a xmlns:xmlns='u'/>
            1:4 [xmlns:xmlns='u'] S0112 the prefix `xmlns` cannot be declared
        <a xmlns:xml='u'/>
            1:4 [xmlns:xml='u'] S0112 the prefix `xml` cannot be declared for another namespace than its own
        <a xmlns='http://www.w3.org/2000/xmlns/'/>
            1:4 [xmlns='http://www.w3.org/2000/xmlns/'] S0112 no prefix can have the namespace of `xmlns`
        <xmlns:a/>
            1:2 [xmlns] S0112 the prefix `xmlns` is not declared
        <
            1:1 [<] S0107 the file ends after `<` | replace `<` with `&lt;`
    "#]].assert_eq(&shown.collect::<String>().replace('\u{200b}', "\\u{200b}"));
}

#[test]
fn a_fault_before_a_forbidden_character_comes_first() {
    assert_eq!(fault("<a>\u{1}</a>"), "1:4 [\u{1}] S0108 the character U+0001 is not allowed in XML | remove it");
    assert_eq!(
        fault("<a b='\u{ffff}'/>"),
        "1:7 [\u{ffff}] S0108 the character U+FFFF is not allowed in XML | remove it"
    );
    assert!(fault("<a/>\u{0}").starts_with("1:5"));
    assert!(fault("<a></b>\u{0}").contains("S0102"));
    let far = format!("<a>{}\u{2}", "x\n".repeat(500));
    assert!(fault(&far).contains("501:1 [\u{2}]"));
    tree("<a>\u{7f}\u{fffd}\u{e000}\u{10ffff}\u{ef}</a>");
}

#[test]
fn where_reading_stops_is_said() {
    for text in ["<a><!-- x </a>", "<a><![CDATA[ x </a>", "<a><?p x </a>"] {
        let faults = super::parse(super::FileId(0), &super::Arc::new(text.into())).faults;
        assert_eq!(
            faults[0].help,
            ["close it: until then, the rest of the file belongs to it and is not checked"],
            "{text}"
        );
    }
}

/// A start tag that is being typed, before the end tag of its own element, beside the root.
#[test]
fn the_end_tag_of_an_element_that_is_being_typed_is_one_fault_and_no_panic() {
    for text in ["<x/><a</a><a", "<x/><a</a>", "<x/><a></a><a", "<x><a</a><a", "<x/><a </a> <a"] {
        let faults = super::parse(super::FileId(0), &super::Arc::new(text.into())).faults;
        assert!(!faults.is_empty(), "{text}");
    }
}
