//! Events of other classes in scenarios.

use std::sync::Arc;
use std::time::Duration;

use expect_test::expect;
use saoms_api::event::{Event, EventField, Events, FieldType};
use saoms_api::extension::{
    EventReader, EventSource, JudgedTexts, PropertyLanguage, PropertyText, PropertyTexts, TimedMessage,
};
use saoms_api::host::declaration::PropertyKind;
use saoms_api::{Chance, Time};

use super::outside::Reader;
use super::player::{Player, ScenarioEvent};
use super::scenario::Scenario;

fn events() -> Events {
    let field = |name: &str, of| EventField { name: name.to_owned(), of, message: String::new() };
    let number = |most: &str| FieldType::Scalar {
        kind: PropertyKind::Integer,
        bounds: Some(("0".to_owned(), most.to_owned())),
        allowed: Vec::new(),
        most: None,
    };
    let fuel = FieldType::Scalar {
        kind: PropertyKind::Enumeration,
        bounds: None,
        allowed: vec!["OIL".to_owned(), "WOOD".to_owned()],
        most: None,
    };
    let at = FieldType::Group(vec![field("x", number("99")), field("y", number("99"))]);
    let optional = |of| FieldType::Optional(Box::new(of));
    Events::of([Event {
        name: "fire".to_owned(),
        doc: "A fire breaks out.".to_owned(),
        fields: vec![
            field("at", at),
            field("size", number("255")),
            field("fuel", optional(fuel)),
            field("heat", optional(FieldType::scalar(PropertyKind::Float))),
            field("note", optional(FieldType::scalar(PropertyKind::String))),
        ],
        classes: vec!["example.Hall".to_owned()],
    }])
}

fn language() -> &'static PropertyLanguage {
    PropertyLanguage::named("scenario").unwrap()
}

/// What the language finds, each at its words.
fn judged(text: &str, plays: &[&str]) -> String {
    let plays: Vec<String> = plays.iter().map(|word| (*word).to_owned()).collect();
    let texts = PropertyTexts { property: "scenario", texts: &[text], plays: &plays, events: &events() };
    let JudgedTexts { findings, raised, faults } = (language().check)(&texts);
    let raised = raised.into_iter().map(|one| format!("raises `{}`\n", &text[one.call.bytes()]));
    let faults =
        faults.into_iter().map(|one| format!("disturbs by `{}` at `{}`\n", one.call, &text[one.call.bytes.clone()]));
    let found = findings.into_iter().map(|one| {
        let (_, part) = one.place().value_part().unwrap();
        let meant = one.replacement().map_or(String::new(), |meant| format!(", meant `{meant}`"));
        format!("`{}`: {}{meant}\n", &text[part], one.message())
    });
    raised.chain(faults).chain(found).collect()
}

#[test]
fn lines_have_events_of_classes_with_their_fields() {
    let text = "at 1s fire at=( 3, 4 ) size=2 note=\"a; b # c\" to Hall1; then 2s 3 times fire size=1..3 at=(0,0)..(9,9) # here
        from 9s every 1s until 12s fire at=(1,1) size=1 heat=0.5..1.5; at 2s breakdown 1";
    expect![[r#"
        raises `fire at=( 3, 4 ) size=2 note="a; b # c" to Hall1`
        raises `fire size=1..3 at=(0,0)..(9,9)`
        raises `fire at=(1,1) size=1 heat=0.5..1.5`
    "#]]
    .assert_eq(&judged(text, &["breakdown"]));
    let play = |seed| {
        let mut player = Player::new(&Scenario::read(&[text]).unwrap(), &mut Chance::new(seed));
        let mut told = Vec::new();
        while let Some(event) = player.next(Duration::from_secs(20), None) {
            told.extend(event);
        }
        told
    };
    let told = play(1);
    assert_eq!(told, play(1));
    assert_ne!(told, play(2));
    let first = ScenarioEvent::Raised("fire at=( 3, 4 ) size=2 note=\"a; b # c\" to Hall1".to_owned());
    assert_eq!(told[0], first);
    assert_eq!(told.len(), 1 + 1 + 3 + 4);
    for event in &told {
        let ScenarioEvent::Raised(line) = event else { continue };
        assert!(!line.contains("..") && judged(&format!("at 1s {line}"), &[]).starts_with("raises"), "{line}");
    }
}

#[test]
fn mistakes_are_told_at_their_words_with_what_is_meant() {
    let told: String = [
        "at 1s fier at=(1,1) size=1",
        "fire at=(1,1) size=1",
        "at 1s fire at=(1,1) size=1 fule=OIL",
        "at 1s fire at=(1,1) size=1 fuel=OLI",
        "at 1s fire at=(1,1) size=999",
        "at 1s fire at=(1,1,1) size=1",
        "at 1s fire at=(9,9)..(0,0) size=1",
        "at 1s fire at=(1,1) size=3..1",
        "at 1s fire at=(1,1) size=1 heat=2.5...4.5",
        "at 1s fire at=(1,1)...(2,2) size=1",
        "at 1s fire at=(1,1) size=1 fuel=OIL..WOOD",
        "at 1s fire at=(1,1) size=1 heat=1..3",
        "at 1s fire at=(1,1) size = 1",
        "at 1s fire at=(1,1) size=",
        "at 1s fire at=(1,1) size=1 size=2",
        "at 1s fire at=(1,1)",
        "at 1s fire at=(1,1) size=1 to",
        "at 1s fire at=(1,1) size=1 to A B",
        "at 1s luggage (1,1) to (2,2)",
    ]
    .iter()
    .map(|line| judged(line, &["breakdown", "end"]))
    .collect();
    expect![[r#"
        `fier`: found `fier`, expected `breakdown`, `end`, `fire`, `lose`, `violate`, `delay`, `jitter`, `duplicate`, `reorder`, `cut`, `part`, `stall`, `fail`, `crash` or `drift`, meant `fire`
        `fire`: found `fire`, expected `at`, `from` or `then` at the start of a line
        `fule`: event `fire` has no field `fule`, meant `fuel`
        `OLI`: field `fuel`: `OLI` is not allowed: expected `OIL` or `WOOD`, meant `OIL`
        `999`: field `size`: `999` is out of range: expected a whole number from 0 to 255
        `(1,1,1)`: field `at`: found `(1,1,1)`, expected `(x,y)`, such as `(1,1)`
        raises `fire at=(9,9)..(0,0) size=1`
        `3..1`: field `size`: found `3..1`, expected the smaller value first, meant `1..3`
        `2.5...4.5`: field `heat`: found `2.5...4.5`, expected `..` between the two ends of a range, meant `2.5..4.5`
        `(1,1)...(2,2)`: field `at`: found `(1,1)...(2,2)`, expected `..` between the two ends of a range, meant `(1,1)..(2,2)`
        `OIL..WOOD`: field `fuel`: found the range `OIL..WOOD`, expected one value: `OIL` or `WOOD`
        `1..3`: field `heat`: found a range of whole numbers, expected real numbers, meant `1.0..3.0`
        `size`: found `size`, expected a field such as `size=2`, or `to` and a component
        `size=`: found no value of the field `size`
        `size`: found the field `size` twice
        `fire`: event `fire` needs its fields: `size` is missing
        ``: found the end of the line, expected the component after `to`
        `B`: found `B`, expected the end of the line after the component
        `luggage`: found `luggage`, an event that this class does not support
    "#]]
    .assert_eq(&told);
}

#[test]
fn lines_from_outside_have_them_too() {
    let source = EventSource { name: "(outside)", line: "a line of `--events`", seed: 1, numbers: Arc::default() };
    let (mut reader, events) = (Reader::new(source), events());
    let told = reader
        .read("at 2s 2 times fire at=(1,1) size=1..9; fire at=(1,1) size=1 to Hall1", Time::START, &events)
        .unwrap();
    let told: Vec<String> = told.into_iter().map(|TimedMessage { at, text, .. }| format!("{at:?} {text}")).collect();
    expect![[r#"
        Some(Time(2000000000)) fire at=(1,1) size=9
        Some(Time(2000000000)) fire at=(1,1) size=1
        None fire at=(1,1) size=1 to Hall1"#]]
    .assert_eq(&told.join("\n"));
    let fault = reader.read("fier at=(1,1) size=1", Time::START, &events).unwrap_err();
    assert_eq!((fault.bytes, fault.instead.as_deref()), (0..4, Some("fire")));
}

/// What an editor offers at the cursor, and the meaning of the word there.
fn offered(text: &str) -> (String, Option<String>) {
    let at = text.find('|').unwrap();
    let text = text.replace('|', "");
    let components = |class: &str| vec![format!("a {class}")];
    let events = events();
    let of = PropertyText { text: &text, at, plays: &["end".to_owned()], events: &events, components: &components };
    let offered: Vec<String> = (language().complete)(&of).into_iter().map(|one| one.label).collect();
    let meant = (language().explain)(&of).map(|one| format!("{}: {}", &text[one.bytes], one.text));
    (offered.join(" "), meant)
}

#[test]
fn editors_offer_and_explain_them() {
    assert_eq!(
        offered("at 1s |").0,
        "fire end 3 times for lose violate delay jitter duplicate reorder cut part fail crash drift"
    );
    assert_eq!(offered("at 1s fire |").0, "at=(1,1) size=1 fuel=OIL heat=1.5 note=\"text\" to");
    assert_eq!(offered("at 1s fire at=( 1, 1 ) |").0, "size=1 fuel=OIL heat=1.5 note=\"text\" to");
    assert_eq!(offered("at 1s fire fuel=O|").0, "OIL WOOD");
    assert_eq!(offered("at 1s fire size=1 to |").0, "a example.Hall");
    assert_eq!(offered("at 1s fire size=1 to A |").0, "");
    expect![[r#"
        fire: `fire at=(1,1) size=1`: A fire breaks out.
        - `at`: `(x,y)`, such as `(1,1)`
        - `size`: a whole number from 0 to 255
        - `fuel`: `OIL` or `WOOD`, optional
        - `heat`: a number, optional
        - `note`: a text, in quotes if it has blanks, optional

        Taken by `example.Hall`."#]]
    .assert_eq(&offered("at 1s fi|re size=1").1.unwrap());
    assert_eq!(offered("at 1s e|nd").1.unwrap(), "end: `end`: nothing happens; the run does not end before this time");
    assert_eq!(offered("at 1s end # fi|re").1, None);
}

#[test]
fn lines_have_faults_that_the_fleet_plays() {
    let text = "at 10s for 30s lose 20 % on POSTOPIC from Robot* to Robot2 # here
        from 1s every 9s 3 times crash Zone restart 2s; then 2s cut A from B;at 5s..20s drift C -1 %";
    expect![[r#"
        disturbs by `for 30s lose 20 % on POSTOPIC from Robot* to Robot2` at `lose`
        disturbs by `crash Zone restart 2s` at `crash`
        disturbs by `cut A from B` at `cut`
        disturbs by `drift C -1 %` at `drift`
    "#]]
    .assert_eq(&judged(text, &[]));
    let text = "at 1s lose 120 %; at 2s for 3s crash A; at 2s los 3 %";
    expect![[r#"
        `120 %`: found `120 %`, expected a part from 0 % to 100 %, or from 0 to 1
        `for`: found `for` before `crash`, which happens once
        `los`: found `los`, expected `luggage`, `fire`, `lose`, `violate`, `delay`, `jitter`, `duplicate`, `reorder`, `cut`, `part`, `stall`, `fail`, `crash` or `drift`, meant `lose`
    "#]]
    .assert_eq(&judged(text, &["luggage"]));
}
