use std::fmt::Write as _;

use saoms_api::extension::Curve;

use super::{AdaptationReport, Adaptations, Samples, Throughput};
use crate::journal::{ComponentName, Journal, read};

/// A journal from lines such as `1.5 2 <- 1 Robot Path decision drives`: time, number, cause, component, loop (`-` for
/// none), phase and the record's id; `entry:yes` and `entry:no` instead of the last two are a change to that.
fn journal(lines: &str) -> Journal {
    let mut text = String::from(r#"{"journal":1,"seed":0,"clock":"virtual","components":[]}"#);
    for line in lines.lines().map(str::trim).filter(|line| !line.is_empty()) {
        let mut words: Vec<&str> = line.split(' ').collect();
        let cause = if words[2] == "<-" {
            words.remove(2);
            format!(r#","cause":{}"#, words.remove(2))
        } else {
            String::new()
        };
        let [time, id, component, loop_name] = words[..4] else { panic!("{line}") };
        let of_loop = if loop_name == "-" { String::new() } else { format!(r#""loop":"{loop_name}","#) };
        let what = match words[4].split_once(':') {
            Some((entry, value)) => {
                let after = value == "yes";
                let values = format!(r#""values":{{"before":{},"after":{after}}}"#, !after);
                format!(r#""phase":"effect","entry":"{entry}","text":"",{values}"#)
            }
            None if component == "(outside)" => {
                format!(r#""phase":"symptom","record":"message_from_outside","text":"{}""#, words[4..].join(" "))
            }
            None => format!(r#""phase":"{}","record":"{}","text":"""#, words[4], words[5]),
        };
        let _ =
            write!(text, "\n{{\"id\":{id},\"time_s\":{time},\"component\":\"{component}\",{of_loop}{what}{cause}}}");
    }
    read(&text).unwrap_or_else(|error| panic!("{error}")).journal
}

/// What came of the events of a journal, in a fleet whose components have a period of 100 ms.
fn measured(lines: &str) -> AdaptationReport {
    let journal = journal(lines);
    let mut adaptations = Adaptations::default();
    for entry in journal.entries() {
        let name = entry.component().to_owned();
        adaptations.join(&ComponentName { name, id: None, period_us: Some(100_000) });
    }
    journal.entries().iter().for_each(|entry| adaptations.take(entry));
    adaptations.report(&Samples::new(Vec::new()))
}

/// The table without its heading, with single spaces.
fn rows(lines: &str) -> Vec<String> {
    let table = measured(lines).to_string();
    table.lines().skip(1).map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect()
}

#[test]
fn an_event_from_outside_is_detected_decided_acted_on_and_settles() {
    let lines = "
        1.0 1 (outside) - breakdown Robot1
        1.2 2 <- 1 Master Faults symptom robot_is_broken
        1.3 3 <- 2 Master Faults decision sends_healer
        1.5 4 <- 3 Robot2 Path heals:yes
        1.9 5 <- 4 Robot2 Path effect arrives";
    assert_eq!(rows(lines), ["breakdown 1 0.200/0.200 0.300/0.300 0.500/0.500 0.900/0.900 0 1 0 -"]);
    let report = measured(lines);
    let event = &report.events[0];
    assert_eq!((event.id, event.time_s, event.settle_s), (1, 1.0, Some(0.9)));
    let json = serde_json::to_string(&report).unwrap();
    assert_eq!(serde_json::from_str::<AdaptationReport>(&json).unwrap(), report);
}

#[test]
fn a_fault_has_its_word_and_needs_no_answer() {
    assert_eq!(rows("1.0 1 (outside) - for 2s lose 20 % on TOPIC"), ["lose 1 - - - - 0 0 0 -"]);
}

#[test]
fn what_a_loop_begins_by_itself_counts_where_it_has_an_effect() {
    let lines = "
        1.0 1 Robot1 Battery symptom low_battery
        1.0 2 <- 1 Robot1 Battery decision goes_to_charge
        1.0 3 <- 2 Robot1 Battery charges:yes
        2.0 4 Robot2 Battery symptom low_battery";
    assert_eq!(rows(lines), ["low_battery (own) 1 - 0.000/0.000 0.000/0.000 0.000/0.000 0 1 0 -"]);
}

#[test]
fn a_measured_value_is_no_event_and_what_follows_from_it_is() {
    let lines = "
        1.0 1 Robot1 Sense effect battery_changes
        1.0 2 <- 1 Robot1 Battery symptom low_battery
        1.4 3 <- 2 Robot1 Battery charges:yes";
    assert_eq!(rows(lines), ["low_battery (own) 1 - - 0.400/0.400 0.400/0.400 0 1 0 -"]);
}

const WOKEN: &str = "
        1.0 1 (outside) - landing 1
        1.1 2 <- 1 Robot1 State symptom is_called
        1.1 3 <- 2 Robot1 State decision wakes
        1.1 4 <- 3 Robot1 State awake:yes";

#[test]
fn what_is_switched_back_unused_was_needless() {
    // By itself, after more than ten periods.
    let back = format!("{WOKEN}\n 4.0 5 <- 4 Robot1 State awake:no");
    assert_eq!(rows(&back), ["landing 1 0.100/0.100 0.100/0.100 0.100/0.100 3.000/3.000 0 0 1 -"]);
    let at_once = format!("{WOKEN}\n 2.0 5 <- 4 Robot1 State awake:no");
    assert!(rows(&at_once)[0].ends_with("1.000/1.000 0 0 0 -"), "within ten periods it is part of the adaptation");
    // By a loop's own decision.
    let own = format!(
        "{WOKEN}
        4.0 5 Robot1 State decision rests
        4.0 6 <- 5 Robot1 State awake:no"
    );
    assert_eq!(rows(&own)[0], "landing 1 0.100/0.100 0.100/0.100 0.100/0.100 0.100/0.100 0 0 1 -");
}

#[test]
fn what_brought_work_was_not_needless() {
    let work = "
        1.5 5 (outside) - luggage (3,1) to (3,10)
        1.6 6 <- 5 Robot1 Job offers:yes";
    let only_offered = format!("{WOKEN}{work}\n 1.8 7 <- 6 Robot1 Job offers:no\n 4.0 8 <- 4 Robot1 State awake:no");
    assert!(rows(&only_offered)[0].ends_with(" 1 -"), "an offer is no use: {:?}", rows(&only_offered));
    let works = format!(
        "{WOKEN}{work}
        1.8 7 <- 6 Robot1 Job carries:yes
        2.8 8 <- 7 Robot1 Job carries:no
        2.8 9 <- 7 Robot1 Job offers:no
        6.0 10 <- 4 Robot1 State awake:no"
    );
    assert_eq!(
        rows(&works),
        [
            "landing 1 0.100/0.100 0.100/0.100 0.100/0.100 5.000/5.000 0 0 0 -",
            "luggage 1 - - 0.100/0.100 1.300/1.300 0 0 0 -"
        ]
    );
}

#[test]
fn who_takes_over_ends_the_adaptation_to_another_event() {
    let lines = format!(
        "{WOKEN}
        1.5 5 (outside) - takeoff 1
        1.6 6 <- 5 Robot1 State awake:no"
    );
    assert_eq!(
        rows(&lines),
        ["landing 1 0.100/0.100 0.100/0.100 0.100/0.100 - 1 0 0 -", "takeoff 1 - - 0.100/0.100 0.100/0.100 0 1 0 -"]
    );
}

#[test]
fn what_a_component_does_after_it_is_done_belongs_to_no_adaptation() {
    let released = "
        1.0 1 (outside) - luggage 1
        1.1 2 <- 1 Robot1 Job busy:yes
        1.5 3 <- 2 Robot1 Job busy:no
        1.6 4 <- 3 Robot1 Job effect strolls";
    assert_eq!(rows(released), ["luggage 1 - - 0.100/0.100 0.500/0.500 0 0 0 -"]);
    // A loop looks at its own effect again, later.
    let again = "
        1.0 1 (outside) - luggage 1
        1.1 2 <- 1 Robot1 Job effect looks
        9.0 3 <- 2 Robot1 Job symptom still_there
        9.0 4 <- 3 Robot1 Job effect looks_again";
    assert_eq!(rows(again), ["luggage 1 - - 0.100/0.100 0.100/0.100 0 0 0 -"]);
}

#[test]
fn records_without_their_cause_are_counted() {
    let lines = "
        1.0 5 <- 4 Robot1 Job symptom hears
        1.0 6 <- 5 Robot1 Job effect acts";
    let report = measured(lines);
    assert_eq!((report.kinds.len(), report.detached), (0, 1));
}

#[test]
fn kinds_are_bounded() {
    let lines: String = (1..=100).fold(String::new(), |mut text, number| {
        let _ = writeln!(text, "{number}.0 {number} (outside) - word{number}");
        text
    });
    let report = measured(&lines);
    assert_eq!(report.kinds.len(), 65);
    let others = report.kinds.iter().find(|kind| kind.kind == "(others)").map(|kind| kind.count);
    assert_eq!(others, Some(36));
}

#[test]
fn the_throughput_before_and_after_an_event_is_compared() {
    let work = Curve { name: "done", panel: "done", is_work: true };
    let mut samples = Samples::new(vec![work]);
    // One in a second until 100 s, then nothing for 30 s, then one in two seconds.
    let done = |second: u64| match second {
        0..=100 => second as f64,
        101..=130 => 100.0,
        _ => 100.0 + ((second - 130) / 2) as f64,
    };
    for second in 0..=300_u64 {
        samples.advance(second * 1_000_000_000, || vec![done(second)]);
    }
    samples.finish(300_000_000_000, vec![done(300)]);
    let at = |seconds: &[u64]| Throughput::of(seconds.iter().map(|second| second * 1_000_000_000), &samples);
    let found = at(&[100]).unwrap();
    assert_eq!((found.before_per_min, found.after_per_min, found.dip_percent), (60.0, 15.0, Some(75.0)));
    assert_eq!(at(&[115]).unwrap().dip_percent.map(f64::round), Some(51.0));
    assert!(at(&[150]).unwrap().dip_percent.is_some_and(|dip| dip < 0.0), "it is more than before");
    assert_eq!(at(&[0, 300]), None, "there is no time on both sides");
    assert_eq!(at(&[10]).unwrap(), Throughput { before_per_min: 60.0, after_per_min: 60.0, dip_percent: Some(0.0) });
}
