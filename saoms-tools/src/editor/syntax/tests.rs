use super::*;

/// The elements of a text, one a line, indented by depth: name, attributes, and how it ends (`/` empty, `!` broken off,
/// `?` without end tag).
fn shown(text: &str) -> String {
    let document = parse(&text.to_owned().into());
    let mut out = String::new();
    for element in document.elements().filter(|one| !one.start_tag_span().is_empty()) {
        let around = std::iter::successors(element.parent(), |one| one.parent());
        out.push_str(&"  ".repeat(around.count()));
        out.push_str(element.name());
        for attribute in element.written_attributes() {
            out.push(' ');
            out.push_str(attribute.name());
            if let Some(value) = value_of(attribute) {
                let close = if attribute.is_closed() { "'" } else { "" };
                out.push_str(&format!("='{}{close}", &text[value]));
            }
        }
        out.push_str(match (element.has_whole_start_tag(), element.is_empty(), element.end_tag_span()) {
            (false, ..) => "!\n",
            (_, true, _) => "/\n",
            (.., None) => "?\n",
            _ => "\n",
        });
    }
    out
}

#[test]
fn well_formed_text_is_read_as_it_is() {
    let text = "<?xml version='1.0'?><!-- <x> --><a b='1' c=\"2>\"><b/><b><![CDATA[<c>]]></b ></a>";
    assert_eq!(shown(text), "a b='1' c='2>'\n  b/\n  b\n");
    // Where tags match, the vocabulary has no say.
    assert_eq!(
        shown("<component><property><component/></property></component>"),
        "component\n  property\n    component/\n"
    );
}

#[test]
fn what_is_not_closed_ends_where_the_next_begins() {
    let says = |text: &str, expected: &str| assert_eq!(shown(text), expected, "{text}");
    says("<a", "a!\n");
    says("<", "");
    says("<a b", "a b!\n");
    says("<a b=", "a b='!\n");
    says("<a b='x y", "a b='x y!\n");
    says("<a b='x/>", "a b='x/\n");
    says("<a b='x>y</a>", "a b='x\n");
    says("<a b='x'c='y'/>", "a b='x' c='y'/\n");
    says("<a b=x c/>", "a b='x c/\n");
    says("<a b='x c='y'/>", "a b='x c='y'/\n");
    says("<a b='x\n  c='y'/>", "a b='x c='y'/\n");
    says("<a b='x\n<b/>", "a b='x!\n  b/\n");
    says("<!-- <a", "");
    says("</a>", "");
    says("<a></b></a>", "a\n");
}

#[test]
fn elements_end_where_the_vocabulary_says() {
    let text = "<composite>
        <component name='a'><implementation.rust class='
        <component name='b'>
          <property name='p
          <property name='q'>1</property>
        <wire source='a'
      </composite>";
    let expected = "composite
  component name='a'?
    implementation.rust class='!
  component name='b'?
    property name='p!
    property name='q'
  wire source='a'!
";
    assert_eq!(shown(text), expected);
}

#[test]
fn any_text_can_be_read_at_any_place() {
    let text = "<a:b c='<&\"ä🤖>' d=\"<!-- --><![CDATA[]]></a:b x><?p ?></ü></>";
    let starts: Vec<usize> = text.char_indices().map(|(at, _)| at).collect();
    for &start in &starts {
        for &end in starts.iter().filter(|&&end| end >= start) {
            let part = &text[start..end];
            let document = parse(&part.to_owned().into());
            for (at, _) in part.char_indices().chain([(part.len(), ' ')]) {
                let _ = Cursor::at(&document, at);
            }
            assert!(document.elements().all(|one| one.whole().end <= part.len()));
        }
    }
}

/// The part at the cursor, `|`.
fn at(marked: &str) -> String {
    let at = marked.find('|').unwrap();
    let text = marked.replacen('|', "", 1);
    let document = parse(&text.clone().into());
    let name = |element: Option<Element<'_>>| element.map_or("-", |one| one.name()).to_owned();
    match Cursor::at(&document, at) {
        Cursor::ElementName { parent, name: range, .. } => {
            format!("element {:?} in {}", &text[range], name(parent))
        }
        Cursor::EndTag { element, name: range } => format!("end {:?} of {}", &text[range], name(element)),
        Cursor::AttributeName { element, name: range } => {
            format!("attribute {:?} of {}", &text[range], name(Some(element)))
        }
        Cursor::AttributeValue { attribute, value, .. } => {
            format!("value {:?} of {}", &text[value], attribute.name())
        }
        Cursor::Text { parent } => format!("text in {}", name(parent)),
        Cursor::Opaque => "nothing".to_owned(),
    }
}

#[test]
fn the_cursor_knows_where_it_is() {
    let says = |marked: &str, expected: &str| assert_eq!(at(marked), expected, "{marked}");
    says("|", "text in -");
    says("<|", "element \"\" in -");
    says("<a><|</a>", "element \"\" in a");
    says("<a><b|c/></a>", "element \"bc\" in a");
    says("<a>|<b/></a>", "text in a");
    says("<a><b/>|</a>", "text in a");
    says("<a><b>|</b></a>", "text in b");
    says("<a><b></b|></a>", "end \"b\" of b");
    says("<a><b></|", "end \"\" of b");
    says("<a |", "attribute \"\" of a");
    says("<a |/>", "attribute \"\" of a");
    says("<a b|='1'/>", "attribute \"b\" of a");
    says("<a b='1' | c='2'>", "attribute \"\" of a");
    says("<a b='1'| c='2'>", "nothing");
    says("<a b='|", "value \"\" of b");
    says("<a b='|'/>", "value \"\" of b");
    says("<a b='x|y' c=''/>", "value \"xy\" of b");
    says("<a b=|/>", "value \"\" of b");
    says("<a b='x|\n</a>", "value \"x\" of b");
    says("<a><!-- | --></a>", "nothing");
    says("<a/>|", "text in -");
}
