//! Random fleets.

use std::time::Duration;

use proptest::prelude::*;
use saoms_core::fault::TimedFault;
use saoms_core::schedule::Settings;

use crate::fault::faults;
use crate::fleet::{run, simulated};

fn command() -> impl Strategy<Value = String> {
    let verbs = prop_oneof![
        Just("say word"),
        Just("say-random"),
        Just("flood 9"),
        Just("put 1 2"),
        Just("own 3"),
        Just("random"),
        Just("ask something"),
        Just("must-ask something"),
        Just("schedule"),
        Just("schedule-for 7"),
        Just("unschedule"),
        Just("running"),
        Just("open"),
        Just("count parcels.delivered 1"),
        Just("hear"),
        Just("spin 2"),
    ];
    (0..12_u32, any::<bool>(), verbs).prop_map(|(from, on, verb)| {
        let from_then_on = if on && verb != "spin 2" { "+" } else { "" };
        format!("{from}{from_then_on}: {verb}")
    })
}

fn script() -> impl Strategy<Value = String> {
    prop::collection::vec(command(), 0..6).prop_map(|commands| commands.join("; "))
}

prop_compose! {
    fn component()(
        passive in prop::bool::weighted(0.2),
        period in 1..20_u32,
        delay in 0..10_u32,
        startup in prop::bool::weighted(0.8),
        restart in prop_oneof![Just(""), Just("restart=3/4"), Just("restart=1/99")],
        overrun in prop_oneof![Just("skip"), Just("catchUp"), Just("stop")],
        peer in 0..6_usize,
        task in 0..6_usize,
        each in script(),
        called in script(),
        last in script(),
    ) -> (bool, String, usize, usize) {
        let topics = "publishes=[TALK TABLE OWN] subscribes=[TALK TABLE OWN]";
        let line = if passive {
            format!("callee publishes=TALK called=[{called}] last=[{last}]")
        } else {
            format!(
                "actor period={period} delay={delay} startup={startup} {restart} overrun={overrun} queue=8 {topics} each=[{each}] \
                 called=[{called}] last=[{last}]"
            )
        };
        (passive, line, peer, task)
    }
}

/// Components that call each other as they like, and schedule each other.
fn fleet() -> impl Strategy<Value = String> {
    prop::collection::vec(component(), 1..6).prop_map(|components| {
        let lines = components.iter().enumerate().map(|(place, (_, line, peer, task))| {
            let (peer, task) = (peer % components.len(), task % components.len());
            // Only a periodic component has a task service.
            let task = if components[task].0 { String::new() } else { format!(" task=C{task}") };
            format!("C{place} {line} peer=C{peer}{task}\n")
        });
        lines.collect()
    })
}

fn fault() -> impl Strategy<Value = String> {
    let topic = prop_oneof![Just(""), Just(" on TALK"), Just(" on TABLE"), Just(" on OWN to C*")];
    let ends = (0..6_u32, 0..6_u32);
    let kind = (topic, ends, 1..40_u64, 0..=100_u32).prop_flat_map(|(topic, (one, other), time, rate)| {
        prop_oneof![
            Just(format!("for {time}ms lose {rate} %{topic}")),
            Just(format!("for {time}ms violate {rate} %{topic}")),
            Just(format!("for 30ms delay 2ms to {}ms{topic}", time + 2)),
            Just(format!("for 60ms jitter {time}ms{topic}")),
            Just(format!("duplicate {rate} %{topic}")),
            Just(format!("reorder {rate} % by {time}ms{topic}")),
            Just(format!("for {time}ms cut C{one} from C{other}")),
            Just(format!("for {time}ms part C{one} from C{other}, C0")),
            Just(format!("for 2ms stall C{one}")),
            Just(format!("fail C{one}")),
            Just(format!("crash C{one}")),
            Just(format!("crash C{one} restart {time}ms")),
            Just(format!("drift C{one} {}.5 %", rate / 3)),
        ]
    });
    (0..150_u64, kind).prop_map(|(at, kind)| format!("{at} {kind}"))
}

fn some_faults() -> impl Strategy<Value = Vec<TimedFault>> {
    prop::collection::vec(fault(), 0..5).prop_map(|lines| faults(&lines.iter().map(String::as_str).collect::<Vec<_>>()))
}

/// The outcome of a run, without the places of panics in the source.
fn run_once(fleet: &str, faults: &[TimedFault]) -> (String, String) {
    let (report, diary) = run(fleet, Settings { faults: faults.to_vec(), ..simulated(150) });
    (serde_json::to_string_pretty(&report).unwrap(), diary.all_lines())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn any_fleet_runs_to_an_end_and_twice_the_same(fleet in fleet(), faults in some_faults()) {
        prop_assert_eq!(run_once(&fleet, &faults), run_once(&fleet, &faults));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, ..ProptestConfig::default() })]

    #[test]
    fn any_fleet_runs_to_an_end_in_real_time(fleet in fleet(), faults in some_faults()) {
        let limit = Some(Duration::from_millis(60));
        let settings = Settings { limit, grace: Duration::from_secs(20), faults, ..Settings::default() };
        let (report, _) = run(&fleet, settings);
        let left_behind = |reason: &&String| reason.contains("did not end");
        prop_assert_eq!(report.outcome.reasons.iter().find(left_behind), None);
        prop_assert_eq!(report.periods, report.components.iter().map(|component| component.executions).sum::<u64>());
    }
}

/// The thread of the fleet reports its end only after others can observe it.
#[test]
fn the_last_event_is_told_however_often_a_fleet_ends() {
    for run in 0..300 {
        let (_, told) = run_once("C0 actor period=15", &[]);
        assert!(told.contains("has shut down"), "run {run}: {told}");
    }
}
