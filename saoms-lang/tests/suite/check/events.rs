//! Events that classes take, in texts of a language.

use saoms_api::event::EventCall;
use saoms_api::extension::{JudgedTexts, LineFault, PropertyLanguage, PropertyTexts, RaisedEvent, submit};
use saoms_api::host::Registration;
use saoms_api::{Class, Component, Failure, Finding, Message, Own, Place, Subscription, Topic};
use saoms_lang::project::Project;
use saoms_lang::registry::Registry;

use crate::check::support::{compiled, faults, fleet, outcome, part};

pub(crate) fn add(registry: &mut Registry) {
    let all = [Registration::of::<Hall>(), Registration::of::<Tower>(), Registration::of::<Player>()];
    for one in all.into_iter().chain([Registration::of::<Halt>()]) {
        registry.add(one).unwrap();
    }
}

submit! {
    PropertyLanguage { name: "example", words: &["halt"], check: judge, complete: |_| Vec::new(), explain: |_| None }
}

/// A line is an event.
fn judge(texts: &PropertyTexts<'_>) -> JudgedTexts {
    let mut judged = JudgedTexts::default();
    for (text, line) in texts.texts.iter().enumerate().filter(|(_, line)| !texts.plays.iter().any(|own| own == *line)) {
        let call = EventCall::read(line).and_then(|call| {
            texts.events.find(&call)?.check(&call)?;
            Ok(call)
        });
        match call {
            Ok(call) => judged.raised.push(RaisedEvent { text, call }),
            Err(LineFault { bytes, message, instead, .. }) => {
                let finding = Finding::new(Place::property(texts.property).part(text, bytes), message);
                judged.findings.push(match instead {
                    Some(instead) => finding.instead(instead),
                    None => finding,
                });
            }
        }
    }
    judged
}

#[derive(Clone, Debug, Message)]
struct Fire {
    size: u8,
    cause: Option<String>,
}

#[derive(Clone, Debug, Message)]
struct Smoke {
    height: f64,
}

const FIRE: Topic<Fire> = Topic::event("FIRE");
const SMOKE: Topic<Smoke> = Topic::event("SMOKE");

#[derive(Class)]
#[class(name = "example.Hall", periodic)]
struct Hall {
    /// It begins to burn.
    #[takes("fire", FIRE)]
    taken: Subscription<Fire>,
}

#[derive(Class)]
#[class(name = "example.Tower", periodic)]
struct Tower {
    /// It begins to burn.
    #[takes("fire", SMOKE)]
    taken: Subscription<Smoke>,
}

#[derive(Class)]
#[class(name = "example.Halt", periodic)]
struct Halt {
    /// It begins to burn.
    #[takes("halt", FIRE)]
    taken: Subscription<Fire>,
}

macro_rules! idle {
    ($($name:ident)*) => {$(
        impl Component for $name {
            type Properties = ();

            fn new((): ()) -> Result<Self, Failure> {
                Ok($name { taken: Subscription::default() })
            }
        }
    )*};
}

idle! { Hall Tower Halt }

/// Plays events.
#[derive(Class)]
#[class(name = "example.Player", periodic)]
struct Player {
    /// An event in each period.
    #[property(language = "example", plays("pause"))]
    lines: Vec<String>,
}

impl Component for Player {
    type Properties = Own<Self>;

    fn execute(&mut self, _: &mut saoms_api::Context<'_>) -> Result<(), Failure> {
        Err(Failure::new(format!("{} lines are only checked here", self.lines.len())))
    }
}

fn component(name: &str, class: &str, rest: &str) -> String {
    format!(
        "<component name=\"{name}\"><implementation.java class=\"example.{class}\"/><property name=\"ID\">{name}</property>\
         <property name=\"period\">1s</property>{rest}</component>\n"
    )
}

fn player(lines: &[&str]) -> String {
    let lines: Vec<String> = lines.iter().map(|line| format!("\n<value>{line}</value>")).collect();
    component("Player", "Player", &format!("<property name=\"lines\">{}</property>", lines.concat()))
}

#[test]
fn a_language_judges_texts_with_the_events_of_all_classes() {
    let lines = ["pause", "fire size=1", "fier size=1", "fire sise=1", "fire size=256", "fire", "fire size=3..1"];
    let told = faults(&(player(&lines) + &component("Hall", "Hall", "")));
    expect_test::expect![[r#"
        5:8-12 error S3014: component `Player`: property `lines`: no class takes the event `fier`
          fix: replace `fier` with `fire` [5:8-12 "fire"]
        6:13-17 error S3014: component `Player`: property `lines`: event `fire` has no field `sise`
          fix: replace `sise` with `size` [6:13-17 "size"]
        7:18-21 error S3014: component `Player`: property `lines`: field `size`: `256` is out of range: expected a whole number from 0 to 255
          help: `saoms components example.Player` describes its properties
        8:8-12 error S3014: component `Player`: property `lines`: event `fire` needs its fields: `size` is missing
          help: `saoms components example.Player` describes its properties
        9:18-22 error S3014: component `Player`: property `lines`: field `size`: found `3..1`, expected the smaller value first
          fix: replace `3..1` with `1..3` [9:18-22 "1..3"]
    "#]].assert_eq(&told);
}

#[test]
fn an_event_is_for_components_of_the_site_that_take_it() {
    let lines = ["fire size=1 to Hall1", "fire size=1 to Hal2", "fire size=1 to Player", "fire size=1 to here/Hall2"];
    let halls = component("Hall1", "Hall", "") + &component("Hall2", "Hall", "");
    expect_test::expect![[r#"
        4:23-27 error S3014: component `Player`: property `lines`: no component `Hal2` takes the event `fire`
          fix: replace `Hal2` with `Hall2` [4:23-27 "Hall2"]
        5:23-29 error S3014: component `Player`: property `lines`: no component `Player` takes the event `fire`
          help: remove `to`, or name a component that takes it, such as `Hall1`
        6:23-33 error S3014: component `Player`: property `lines`: no component `here/Hall2` takes the event `fire`
          help: remove `to`, or name a component that takes it, such as `Hall1`
    "#]]
    .assert_eq(&faults(&(player(&lines) + &halls)));
    expect_test::expect![[r#"
        3:8-12 warning S4018: component `Player`: property `lines`: no component of the fleet takes the event `fire`, so the event has no effect
          help: add a component of a class that takes it, such as `example.Hall`
    "#]].assert_eq(&faults(&player(&["fire size=1"])));
    let around = fleet(
        &(player(&["fire size=1"])
            + "<component name=\"Plant\" xmlns:t=\"urn:t\" xmlns:saoms=\"urn:saoms:1\" saoms:site=\"Plant\"><implementation.composite name=\"t:plant\"/></component>"),
    );
    expect_test::expect![[r#"
        3:8-12 warning S4018: component `Player`: property `lines`: no component outside of sites takes the event `fire`, so the event has no effect
          help: components in the site `Plant` take it: move the event there
        Player (example.Player) lines=Many([Text("fire size=1")])
        Plant/Hall1 (example.Hall)
        Plant/Hall2 (example.Hall)
    "#]].assert_eq(&outcome(&[&around, &part("plant", "", &halls)], &[]));
}

#[test]
fn a_topic_by_which_an_event_comes_needs_no_publisher() {
    let told = |class: &str| {
        let text = fleet(&component("A", class, ""));
        compiled(&Project::new().in_memory().wiring(true).text("fleet.composite", text)).1.len()
    };
    assert_eq!((told("Hall"), told("Picker")), (0, 1));
}

#[test]
fn an_event_has_the_same_fields_for_all_and_is_no_word_of_a_language() {
    let all = component("A", "Hall", "") + &component("B", "Tower", "") + &component("C", "Tower", "");
    expect_test::expect![[r#"
        3:18-19 error S4017: component `B` takes the event `fire` with the fields `height=1.5`, and class `example.Hall` with the fields `size=1`, `cause="text"`
          2:18-19 a component of that class
          help: an event has the same fields for all classes; give it another name under `takes` in one of them
        5:18-19 error S4017: component `D` takes the event `halt`, which is a reserved word of the `example` language
          help: give it another name under `takes` in the declaration of class `example.Halt`
    "#]].assert_eq(&faults(&(all + &component("D", "Halt", ""))));
}
