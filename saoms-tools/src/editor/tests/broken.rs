//! Whatever the text: every question has an answer.

use proptest::prelude::*;

use crate::editor::testing::{ask_everything, ask_everything_in, hold_laws};

const WHOLE: &str = r#"<?xml version="1.0"?>
<!-- ü -->
<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" xmlns:s="urn:saoms:1" xmlns:f="urn:f" name="fleet" targetNamespace="urn:f">
  <include name="f:inner"/>
  <property name="period" type="s:x">100<![CDATA[ ]]></property>
  <component name="R🤖${index:03}" s:count="2 * n" s:if='a &gt; b' s:overrides="t.csv">
    <implementation.rust class="saoms.Robot" library="x"/>
    <property name="period" source="$period/a/b"/>
    <property name="x" file="v.txt">${period * n</property>
    <property name="topicRename" value="COLLISIONTOPIC,ä::B,c"/>
    <property name="scenario"><value>at 1s</value><value/></property>
    <reference name="world" target=" R🤖001/TaskInterface/b  W "><binding.sca uri="W/x"/></reference>
    <s:loop name="BatteryMS" class="saoms.BatteryMS" after="RobotMS"><property name="p">1</property></s:loop>
  </component>
  <component name="W"><implementation.composite name="f:fleet"/><service name="s"/></component>
  <service name="s" promote="W/s"/>
  <wire source="R🤖001/world" target="W"/>
</composite>
"#;

/// Asks everything at a byte.
fn ask_all(text: &str, at: usize) {
    let table = "name,🤖\nR🤖001,\"";
    ask_everything(text, at, &[("inner.composite", WHOLE), ("t.csv", table), ("v.txt", "ä${period}${")]);
}

#[test]
fn everything_can_be_asked_at_the_end_of_every_beginning() {
    for (at, _) in WHOLE.char_indices() {
        ask_all(&WHOLE[..at], at);
    }
}

#[test]
fn everything_can_be_asked_at_every_place() {
    for (at, _) in WHOLE.char_indices() {
        ask_all(WHOLE, at);
    }
}

#[test]
fn everything_can_be_asked_in_files_beside_composites() {
    let table = "\u{feff}name , \"battery\",period,ü\r\n\"R🤖001\", 5 ,\"1\n0\"s,\n\n,,,,\"";
    let text = "at 1s luggage (1, 2) to r🤖;from 2..3 s 3 # ${period\nthen ${n} breakdown 1..";
    let description = "<contribution xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\"><deployable composite=\"f:fleet\"/><import namespace=\"\"/><";
    for (name, text) in [("t.csv", table), ("v.txt", text), ("sca-contribution.xml", description)] {
        for (at, _) in text.char_indices().chain([(text.len(), ' ')]) {
            ask_everything_in(name, text, at, &[("fleet.composite", WHOLE)]);
            ask_everything_in(name, &text[..at], at, &[("fleet.composite", WHOLE)]);
        }
    }
}

/// A text with some of its parts replaced by others.
fn disturbed() -> impl Strategy<Value = String> {
    let pieces = [
        "", "<", ">", "\"", "'", "/", "=", " ", "&", "${", "}", "::", ",", "<!--", "]]>", "ä", "🤖", "</component>",
        "<component ",
    ];
    let edit = (any::<prop::sample::Index>(), 0usize..12, prop::sample::select(pieces.to_vec()));
    prop::collection::vec(edit, 1..6).prop_map(|edits| {
        let mut text = WHOLE.to_owned();
        for (at, length, piece) in edits {
            let start = text.floor_char_boundary(at.index(text.len() + 1));
            let end = text.floor_char_boundary((start + length).min(text.len())).max(start);
            text.replace_range(start..end, piece);
        }
        text
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn everything_can_be_asked_in_disturbed_texts(text in disturbed(), at in any::<prop::sample::Index>()) {
        let at = text.floor_char_boundary(at.index(text.len() + 1));
        ask_all(&text, at);
        hold_laws(&text, at, &[("inner.composite", WHOLE)]);
    }
}
