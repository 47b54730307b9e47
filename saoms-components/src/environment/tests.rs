use std::time::Duration;

use proptest::prelude::*;
use saoms_api::Chance;

use super::player::{Player, ScenarioEvent};
use super::scenario::{Continuation, Scenario, continuations};
use crate::grid::{Block, Map};
use crate::messages::{ExceptionalEvent, ExceptionalKind};

fn luggage(from: (i32, i32), to: (i32, i32)) -> ScenarioEvent {
    ScenarioEvent::Luggage { from: Block::new(from.0, from.1), to: Block::new(to.0, to.1) }
}

fn exceptional(kind: ExceptionalKind, pieces: u32) -> ScenarioEvent {
    ScenarioEvent::Exceptional(ExceptionalEvent { kind, pieces })
}

/// Events up to a time, polled every 100 ms.
fn played(text: &str, seed: u64, area: Option<&Map>, until: u64) -> Vec<(u64, ScenarioEvent)> {
    let scenario = Scenario::read(&[text]).unwrap_or_else(|findings| panic!("{findings:?}"));
    let mut player = Player::new(&scenario, &mut Chance::new(seed));
    let mut events = Vec::new();
    for now in (0..=until).step_by(100) {
        while let Some(event) = player.next(Duration::from_millis(now), area) {
            events.extend(event.map(|event| (now, event)));
        }
    }
    assert!(player.is_over() || text.contains("every"), "{text}");
    events
}

#[test]
fn a_scenario_happens_in_the_order_of_its_times() {
    let text = "
        # The first pieces; then others.
        at 6s luggage (3,1) to (3,10)
        then 1 s luggage ( 1 , 5 ) to ( 10 , 5 )   # after the line before
        then 500 luggage(10,8)to(1,8)
        at 3s landing 4; at 3s takeoff 2
        at 9s breakdown Robot002\r
        then 0 breakdown 3; at 9.5s end
    ";
    let expected = [
        (3000, exceptional(ExceptionalKind::Landing, 4)),
        (3000, exceptional(ExceptionalKind::Takeoff, 2)),
        (6000, luggage((3, 1), (3, 10))),
        (7000, luggage((1, 5), (10, 5))),
        (7500, luggage((10, 8), (1, 8))),
        (9000, ScenarioEvent::Breakdown(2)),
        (9000, ScenarioEvent::Breakdown(3)),
        (9500, ScenarioEvent::End),
    ];
    assert_eq!(played(text, 1, None, 10_000), expected);
    assert!(Scenario::read::<&str>(&[]).unwrap().lines().is_empty());
    assert!(Scenario::read(&["", " # nothing\n;"]).unwrap().lines().is_empty());
    let texts = ["at 1s landing 1", "then 1s landing 2"];
    assert!(Scenario::read(&texts).unwrap().lines()[1].follows, "also the one in another text");
}

#[test]
fn lines_repeat_so_often_or_so_long() {
    let times = |text: &str| played(text, 1, None, 20_000).into_iter().map(|(at, _)| at).collect::<Vec<_>>();
    assert_eq!(times("from 1s every 2s 3 times landing 1; then 500ms landing 2"), [1000, 3000, 5000, 5500]);
    assert_eq!(times("from 1s every 2s until 5s landing 1; then 500ms landing 2"), [1000, 3000, 5000, 5500]);
    assert_eq!(times("from 1s every 2s 2 times until 9s landing 1"), [1000, 3000]);
    assert_eq!(times("at 1s 3 times landing 1"), [1000, 1000, 1000]);
    assert_eq!(times("at 1s landing 1; then 1s every 1s 2 times landing 2"), [1000, 2000, 3000]);
    assert_eq!(times("at 9s landing 1; then 1s every 1s until 5s landing 2; then 1s landing 3"), [9000, 11_000]);
    assert_eq!(times("from 0 every 5s landing 1"), [0, 5000, 10_000, 15_000, 20_000]);
}

#[test]
fn chance_draws_within_the_ends_and_by_the_seed_alone() {
    let area = Map::read("....\n.@..\n....").unwrap();
    let text = "from 1s..2s every 100ms..300ms 200 times luggage random to (0,0)..(3,1)
        at 30s..60s breakdown 1..3
        at 5s landing 2..8";
    let events = played(text, 7, Some(&area), 90_000);
    assert_eq!(events, played(text, 7, Some(&area), 90_000));
    assert_ne!(events, played(text, 8, Some(&area), 90_000));
    let mut last = 0;
    let mut pieces = 0;
    for (at, event) in &events {
        match event {
            ScenarioEvent::Luggage { from, to } => {
                pieces += 1;
                assert!(area.is_free(*from) && area.is_free(*to) && from != to && to.y <= 1, "{event:?}");
                assert!((1000..=2100).contains(&(at - last)) || (0..=400).contains(&(at - last)), "{at}");
                last = *at;
            }
            ScenarioEvent::Visit { .. } | ScenarioEvent::End | ScenarioEvent::Gone(_) | ScenarioEvent::Raised(_) => {
                unreachable!("no line says so")
            }
            ScenarioEvent::Breakdown(robot) => {
                assert!((1..=3).contains(robot) && (30_000..=60_100).contains(at))
            }
            ScenarioEvent::Exceptional(event) => assert!((2..=8).contains(&event.pieces)),
        }
    }
    assert_eq!((pieces, events.len()), (200, 202));
    // Another line does not change the ones before it.
    let more = played(&format!("{text}\nat 1s landing 1..9"), 7, Some(&area), 90_000);
    assert!(events.iter().all(|event| more.contains(event)));
}

#[test]
fn luggage_for_which_there_is_no_block_does_not_happen() {
    let area = Map::read(".@\n@@").unwrap();
    assert_eq!(played("at 1s luggage (1,1)..(0,1) to (0,0)", 1, Some(&area), 2000), []);
    assert_eq!(played("at 1s luggage random to random", 1, Some(&area), 2000), [], "there is but one");
    assert_eq!(played("at 1s luggage (50,50)..(60,60) to (0,0)", 1, Some(&area), 2000), []);
    let some = played("at 1s 9 times luggage (0,0)..(60000,60000) to (7,7)", 1, Some(&area), 2000);
    assert_eq!(some, vec![(1000, luggage((0, 0), (7, 7))); 9]);
    assert!(Scenario::read(&["at 1s luggage (1,1) to random"]).unwrap().needs_area());
    assert!(!Scenario::read(&["at 1s luggage (1,1) to (2,2)..(3,3)"]).unwrap().needs_area());
}

#[test]
fn a_line_of_very_many_words_is_one_mistake() {
    // If each word took time with the length of the rest, this would not end.
    let line = "at 1s landing 4 ".repeat(100_000);
    assert_eq!(Scenario::read(&[line]).unwrap_err().len(), 1);
}

#[test]
fn every_wrong_line_says_where_and_why() {
    let kinds = "`luggage`, `visit`, `landing`, `takeoff`, `breakdown`, `gone`, `end`, `lose`, `violate`, `delay`, \
        `jitter`, `duplicate`, `reorder`, `cut`, `part`, `stall`, `fail`, `crash` or `drift`";
    let block = "a block such as `(3,1)`, two corners such as `(1,0)..(10,10)`, or `random`";
    let robot = "a robot such as `Robot002` or `2`, or numbers such as `1..10` to draw one of";
    let time = "a time such as `6s` or `500ms`";
    let pieces = "a number of pieces of luggage, such as `4`";
    let start = "`at`, `from` or `then` at the start of a line";
    let end = "the end of the line, or `;` before the next event";
    let times = "the number of times: a whole number from 1 to 1000000";
    for (line, at, message, instead) in [
        ("luggage", "luggage", format!("found `luggage`, expected {start}"), None),
        ("on 6s landing 4", "on", format!("found `on`, expected {start}"), Some("at")),
        ("at 6s 10 luggage (3,1) to (3,10)", "10", "found `10` before `luggage`, expected a number of times, such as `10 times`".into(), Some("10 times")),
        ("at 6s 10 landing 4", "10", format!("found `10`, expected {kinds}"), None),
        ("at 6s luggage radnom to (3,10)", "radnom", format!("found `radnom`, expected {block}"), Some("random")),
        ("ta 6s landing 4", "ta", format!("found `ta`, expected {start}"), Some("at")),
        ("at 6s lugage (3,1) to (3,10)", "lugage", format!("found `lugage`, expected {kinds}"), Some("luggage")),
        ("at 6s (3,1) to (3,10)", "(3,1)", format!("found `(3,1)`, expected {kinds}"), None),
        ("at luggage (3,1) to (3,10)", "luggage", format!("found `luggage`, expected {time}"), None),
        ("at", "", format!("found the end of the line, expected {time}"), None),
        ("at 6parsec landing 4", "6parsec", "`6parsec` is not a duration: expected a number of milliseconds, or a number with one of the units ns, us, ms, s, min, h".into(), None),
        ("at 6m landing 4", "6m", "`6m` is not a duration: expected `6min`, for minutes, or `6ms`, for milliseconds".into(), Some("6min")),
        ("at -6 s landing 4", "-6 s", "found `-6 s`, which is before the start of the scenario: expected a time from 0s on".into(), Some("6 s")),
        ("at 6s luggage (3,1)", "", "found the end of the line, expected `to` and the block to bring it to".into(), None),
        ("at 6s luggage (3,1) too (3,10)", "too", "found `too`, expected `to` and the block to bring it to".into(), Some("to")),
        ("at 6s luggage (3,1) to 3,10", "3,10", format!("found `3,10`, expected {block}"), Some("(3,10)")),
        ("at 6s luggage (3;1) to (3,10)", "(3;1)", format!("found `(3;1)`, expected {block}"), Some("(3,1)")),
        ("at 6s luggage (-3,1) to (3,10)", "(-3,1)", "found `(-3,1)`, but every area starts at (0,0)".into(), None),
        ("at 6s landing four", "four", format!("found `four`, expected {pieces}"), Some("4")),
        ("at 6s landing", "", format!("found the end of the line, expected {pieces}"), None),
        ("at 6s landing 4 5", "5", format!("found `5`, expected {end}"), None),
        ("at 6s breakdown Gripper", "Gripper", format!("found `Gripper`, expected {robot}"), None),
        ("at 6s breakdown robot 2", "robot 2", format!("found `robot 2`, expected {robot}"), Some("2")),
        ("at 6s breakdown 0", "0", format!("found `0`, expected {robot}"), None),
        ("at 8s..2s landing 4", "8s..2s", "found `8s..2s`, expected the smaller value first".into(), Some("2s..8s")),
        ("at 8s every 2s landing 4", "at", "found `every` after `at`; an event that is repeated starts with `from`".into(), Some("from")),
        ("from 8s landing 4", "from", "expected `every` after `from` and its time; an event that happens once starts with `at`".into(), Some("at")),
        ("from 8s until 20s landing 4", "until", "found `until` without `every`, which says how often this happens".into(), None),
        ("from 8s until 20s every 2s landing 4", "until", "found `until` before `every`; `every` comes directly after the first time".into(), None),
        ("from 8s to 20s every 2s landing 4", "to", "found `to` before `every`; `every` comes directly after the first time".into(), None),
        ("from 8s 10 times every 2s landing 4", "10", "found `10` before `every`; `every` comes directly after the first time".into(), None),
        ("from 8s every 0s landing 4", "0s", "found `0s` after `every`, expected at least 1ms".into(), None),
        ("from 8s every 1s 0 times landing 4", "0", format!("found `0`, expected {times}"), None),
        ("at 8s until 9s landing 4", "until", "found `until` without `every`: this happens once".into(), None),
        ("from 8s every 1s until 7s landing 4", "7s", "found `until 7s`, which is before the first event".into(), None),
        ("from 8s every 1s landing 1\nthen 1s landing 2", "then", "the line before never ends, so no event can follow it".into(), None),
    ] {
        let text = format!("at 1s landing 1; at 2s landing 1 # 2\n{line}\nat 7s landing 9");
        let findings = Scenario::read(&["at 0 landing 2".to_owned(), text.clone()]).unwrap_err();
        let finding = &findings[0];
        let (value, part) = finding.place().value_part().unwrap();
        assert_eq!((finding.message(), value), (message.as_str(), 1), "{line}");
        assert_eq!((&text[part], finding.replacement()), (at, instead), "{line}");
    }
}

#[test]
fn a_slip_is_told_with_what_is_meant() {
    for (line, meant) in [
        ("at 1s luggage (3,1) -> (3,10)", "at 1s luggage (3,1) to (3,10)"),
        ("at 1s luggage (3,1) (3,10)", "at 1s luggage (3,1) to (3,10)"),
        ("at 1s luggage from (3,1) to (3,10)", "at 1s luggage  (3,1) to (3,10)"),
        ("at 1s luggage [3,1] to (3,10)", "at 1s luggage (3,1) to (3,10)"),
        ("at 1s luggage [3,1] to [3,10]", "at 1s luggage (3,1) to [3,10]"),
        ("at 1s luggage (3;1) to (3,10); at 2s end", "at 1s luggage (3,1) to (3,10); at 2s end"),
        ("at 1s luggage (3,1 to (3,10)", "at 1s luggage (3,1) to (3,10)"),
        ("at 1s luggage (3,1) to (3,10", "at 1s luggage (3,1) to (3,10)"),
        ("at 1s, luggage (3,1) to (3,10)", "at 1s luggage (3,1) to (3,10)"),
        ("at 1s: luggage (3,1) to (3,10)", "at 1s luggage (3,1) to (3,10)"),
        ("at 1s landing 4 at 2s landing 5", "at 1s landing 4 ; at 2s landing 5"),
        ("at 1s landing 4, at 2s landing 5", "at 1s landing 4; at 2s landing 5"),
        ("at 1s landing 4 // the first", "at 1s landing 4 # the first"),
        ("-- nothing", "# nothing"),
        ("every 5s landing 4", "from 5s every 5s landing 4"),
        ("from 1s every 5s 3x landing 4", "from 1s every 5s 3 times landing 4"),
        ("from 1s every 5s 3 time landing 4", "from 1s every 5s 3 times landing 4"),
        ("at 1s break Robot7", "at 1s breakdown Robot7"),
        ("at 1,5s landing 4", "at 1.5s landing 4"),
        ("from 1s every 2s-8s 3 times landing 4", "from 1s every 2s..8s 3 times landing 4"),
        ("from 1s every 2s.8s 3 times landing 4", "from 1s every 2s..8s 3 times landing 4"),
        ("at 1s luggage (1,1)...(5,5) to (3,10)", "at 1s luggage (1,1)..(5,5) to (3,10)"),
        ("at 1s luggage (1,1) ... (5,5) to (3,10)", "at 1s luggage (1,1) .. (5,5) to (3,10)"),
        ("at 1s luggage (1,1) to (3,10)...(5,5)", "at 1s luggage (1,1) to (3,10)..(5,5)"),
        ("from 1s every 2s...4s 3 times landing 4", "from 1s every 2s..4s 3 times landing 4"),
        ("from 1s every 2 s...4 s 3 times landing 4", "from 1s every 2 s..4 s 3 times landing 4"),
        ("at 0.2s...4s landing 4", "at 0.2s..4s landing 4"),
        ("at 1s landing 2...4", "at 1s landing 2..4"),
        ("at 1s takeoff 2....4", "at 1s takeoff 2..4"),
        ("at 1s breakdown 1...2", "at 1s breakdown 1..2"),
        ("1s landing 4", "at 1s landing 4"),
        ("@1s landing 4", "at 1s landing 4"),
        ("at every 5s landing 4", "from 5s every 5s landing 4"),
        ("at 1m30s landing 4", "at 90s landing 4"),
        ("at 00:01:00 landing 4", "at 60s landing 4"),
        ("at 1 minute landing 4", "at 1min landing 4"),
        ("at +1s landing 4", "at 1s landing 4"),
        ("from 1s every 5s three times landing 4", "from 1s every 5s 3 times landing 4"),
        ("at 1s twice landing 4", "at 1s 2 times landing 4"),
        ("at 1s luggage any to (3,10)", "at 1s luggage random to (3,10)"),
        ("at 1s luggage (3,1) to *", "at 1s luggage (3,1) to random"),
        ("at 1s luggage (3.1) to (3,10)", "at 1s luggage (3,1) to (3,10)"),
        ("at 1s luggage (3,1), (3,10)", "at 1s luggage (3,1) to (3,10)"),
        ("at 1s package (3,1) to (3,10)", "at 1s luggage (3,1) to (3,10)"),
        ("at 1s Robot7 breakdown", "at 1s breakdown Robot7"),
    ] {
        let findings = Scenario::read(&[line]).unwrap_err();
        let (_, part) = findings[0].place().value_part().unwrap();
        let mut changed = line.to_owned();
        changed.replace_range(part, findings[0].replacement().unwrap_or("?"));
        assert_eq!((changed.as_str(), findings.len()), (meant, 1), "{findings:?}");
    }
    // What would lead to the same fault is not proposed.
    for line in ["at 1s luggage 5 (3,1) to (3,10)", "at 00:10 landing 4", "at 1s repair Robot7", "at 1s landing -2"] {
        assert_eq!(Scenario::read(&[line]).unwrap_err()[0].replacement(), None, "{line}");
    }
    for (line, help) in [
        ("at 1s landing 4 3 times", "write it before the event: `at 1s 3 times landing 4`"),
        ("at 1s landing 4 every 5s", "write it before the event: `from 1s every 5s landing 4`"),
        ("at 1s landing 4 3 times every 5s", "write it before the event: `from 1s every 5s 3 times landing 4`"),
        (
            "at 1s luggage (3,1) to (3,2) every 5s 3 times",
            "write it before the event: `from 1s every 5s 3 times luggage (3,1) to (3,2)`",
        ),
        ("at 1s landing 4 every", "as in `at 3s landing 4`"),
        ("at 1s luggage 5 (3,1) to (3,10)", "write `5 times` before `luggage` for 5 pieces"),
        ("at 1s luggage (3,1)", "as in `at 6s luggage (3,1) to (3,10)`"),
        ("at 1s breakdown all", "as in `at 9s breakdown Robot002`"),
        ("at 1s repair Robot7", "a robot that broke down is not repaired"),
    ] {
        let findings = Scenario::read(&[line]).unwrap_err();
        assert_eq!((findings[0].helps(), findings[0].replacement()), (&[help.to_owned()][..], None), "{line}");
    }
    let findings = Scenario::read(&["end 20s"]).unwrap_err();
    assert_eq!(findings[0].helps(), ["write the time first, as in `at 6s end ...`"]);
}

#[test]
fn then_needs_a_line_before_it() {
    for texts in [&["# early\nthen 6s landing 4"][..], &["", "then 6s landing 4"]] {
        let findings = Scenario::read(texts).unwrap_err();
        assert_eq!(
            (findings[0].message(), findings[0].replacement()),
            ("found `then` in the first line: there is no event before it to count from", Some("at"))
        );
    }
    assert!(Scenario::read(&["at 1s landing 4", "then 6s landing 4"]).is_ok());
}

#[test]
fn all_wrong_lines_are_found_at_once() {
    let (scenario, findings) =
        Scenario::read_partly(&["at 1s lading 1; at 2s landing 1", "then landing\nat 3s breakdown 1"]);
    assert_eq!((scenario.lines().len(), findings.len()), (2, 2));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn any_text_is_read_or_refused_at_a_place_in_it(words in prop::collection::vec(word(), 0..12)) {
        let text = words.concat();
        if let Err(findings) = Scenario::read(&[&text]) {
            for finding in findings {
                let (_, part) = finding.place().value_part().unwrap();
                prop_assert!(text.get(part.clone()).is_some(), "{text:?} {part:?}");
            }
        }
    }

    #[test]
    fn any_scenario_can_be_played(words in prop::collection::vec(word(), 0..30), seed: u64) {
        let (scenario, _) = Scenario::read_partly(&[words.concat()]);
        let mut player = Player::new(&scenario, &mut Chance::new(seed));
        let area = Map::new(11, 11);
        for _ in 0..100 {
            if player.next(Duration::from_secs(60), Some(&area)).is_none() {
                break;
            }
        }
    }
}

/// Words of scenarios, and words that are none.
fn word() -> impl Strategy<Value = String> {
    let known = [
        "at ",
        "from ",
        "then ",
        "every ",
        "times ",
        "until ",
        "luggage ",
        "to ",
        "random ",
        "landing ",
        "takeoff ",
        "breakdown ",
        "(3,1)",
        "(10,10)",
        "(",
        ")",
        "..",
        ".",
        ";",
        "\n",
        "\r\n",
        " ",
        "#",
        "1s ",
        "500 ",
        "2 ",
        "-1s ",
        "Robot002 ",
        "\u{fc}",
        "\u{1f600} ",
        "99999999999999999999 ",
        "1h ",
        "from 1s every 1ms 9 times luggage random to (0,0)..(5,5)\n",
        "then 1s landing 1..3;",
    ];
    prop::sample::select(known.to_vec()).prop_map(str::to_owned)
}

#[test]
fn the_examples_of_the_documentation_are_scenarios() {
    let page = include_str!("../../../docs/scenarios.md");
    let examples: Vec<&str> = page.split("```scenario\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert!(examples.len() >= 4);
    for example in examples {
        let (scenario, findings) = Scenario::read_partly(&[example]);
        assert!(findings.is_empty() && !scenario.lines().is_empty(), "{example}: {findings:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    /// Following the offered continuations until there are none yields a line that can be read.
    #[test]
    fn what_can_follow_leads_to_lines_that_can_be_read(
        choices in prop::collection::vec(any::<prop::sample::Index>(), 16),
        ranges in prop::collection::vec(any::<bool>(), 16),
    ) {
        let mut line = String::new();
        for (choice, ranges) in choices.iter().zip(ranges) {
            let all = continuations(&line);
            if all.is_empty() {
                break;
            }
            let one = all[choice.index(all.len())];
            let until = line.ends_with("until ");
            let value = match one {
                Continuation::Word(word) => word,
                Continuation::Time if until => "60s",
                Continuation::Time => if ranges { "2s..8 s" } else { "500" },
                Continuation::Times => "3 times",
                Continuation::Pieces => if ranges { "2..8" } else { "4" },
                Continuation::Place if line.ends_with("to ") => "random",
                Continuation::Place => if ranges { "(1,0)..(10,10)" } else { "(3, 1)" },
                Continuation::Robot => if ranges { "1..3" } else { "Robot002" },
                Continuation::Duration => if ranges { "2 s" } else { "2000" },
                Continuation::Rate => if ranges { "20 %" } else { "0.2" },
                Continuation::Component => if ranges { "Robot2, hall/*" } else { "Robot2" },
                Continuation::Topic => "POSTOPIC",
            };
            line.push_str(value);
            line.push(' ');
        }
        // A visit has as many blocks as one likes.
        line.push_str(match continuations(&line).first() {
            Some(Continuation::Place) => "(3, 1)",
            Some(Continuation::Robot) => "Robot002",
            Some(Continuation::Component) => "Robot2",
            _ => "",
        });
        // `then` needs a line before it.
        let read = Scenario::read(&["at 0 end", &line]).map(|scenario| scenario.lines().len());
        prop_assert_eq!(read.map_err(|findings| format!("{line}: {findings:?}")), Ok(2));
    }
}

#[test]
fn what_can_follow_is_what_the_grammar_says() {
    let words = |line: &str| -> Vec<Continuation> { continuations(line) };
    assert_eq!(words(""), ["at", "from", "then"].map(Continuation::Word));
    for (line, expected) in [
        ("at ", Continuation::Time),
        ("at 2s..", Continuation::Time),
        ("from 1s every ", Continuation::Time),
        ("from 1 s ", Continuation::Word("every")),
        ("at 1s 3 ", Continuation::Word("times")),
        ("at 1s luggage ", Continuation::Place),
        ("at 1s luggage (1, 2) ", Continuation::Word("to")),
        ("at 1s luggage (1,2)..(3,4) to random..", Continuation::Place),
        ("at 1s breakdown ", Continuation::Robot),
        ("then 1s every 2s 3 times takeoff 2..", Continuation::Pieces),
        ("at 1s for ", Continuation::Duration),
        ("at 1s lose ", Continuation::Rate),
        ("at 1s reorder 20 % ", Continuation::Word("by")),
        ("at 1s reorder 20 % by ", Continuation::Duration),
        ("at 1s jitter 20 ms on ", Continuation::Topic),
        ("at 1s lose 20% on POSTOPIC from A, B to ", Continuation::Component),
        ("at 1s cut A, ", Continuation::Component),
        ("at 1s cut A, B ", Continuation::Word("from")),
        ("at 1s part A from B ", Continuation::Word("on")),
        ("at 1s crash A ", Continuation::Word("restart")),
        ("at 1s drift A ", Continuation::Rate),
    ] {
        assert_eq!(words(line), [expected], "{line}");
    }
    assert!(words("from 1s every 2s ").contains(&Continuation::Word("until")));
    assert!(!words("at 1s ").contains(&Continuation::Word("until")) && words("at 1s ").contains(&Continuation::Times));
    assert!(!words("at 1s 3 times ").contains(&Continuation::Times));
    assert_eq!(words("at 1s for 2s lose 20 % "), ["on", "from", "to"].map(Continuation::Word));
    assert_eq!(words("at 1s delay 50ms to "), [Continuation::Duration, Continuation::Component]);
    let lasting = words("at 1s for 2 s ");
    assert!(lasting.contains(&Continuation::Word("stall")) && !lasting.contains(&Continuation::Word("crash")));
    let begins = words("at 1s ");
    assert!(begins.contains(&Continuation::Word("for")) && !begins.contains(&Continuation::Word("stall")));
    for line in [
        "at 1s end ", "at 1s for 2s stall A ", "at 1s crash A restart 2s ", "at 1s lose 20 % to A ", "nonsense ",
        "at 1s landing 4 ", "at 1s nonsense ",
    ] {
        assert_eq!(words(line), [], "{line}");
    }
}

#[test]
fn a_site_in_a_scenario_is_told_to_belong_to_events_from_outside() {
    for (line, site) in [
        ("North: at 3s luggage (1,1) to (2,2)", "North:"),
        ("at 3s Paris/Hall1: luggage (1,1) to (2,2)", "Paris/Hall1:"),
        ("North : end", "North :"),
    ] {
        let findings = Scenario::read(&["# a: b", line]).unwrap_err();
        let expected =
            format!("found the site `{site}`, which is allowed only before events from outside (`--events`)");
        assert_eq!(findings.iter().map(saoms_api::Finding::message).collect::<Vec<_>>(), [expected]);
    }
    for line in ["at: 3s end", "at 10:30 end", "at 3s luggage: (1,1) to (2,2)"] {
        assert!(!Scenario::read(&[line]).unwrap_err()[0].message().contains("site"), "{line}");
    }
}
