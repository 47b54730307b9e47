//! Components that messages trigger.

use saoms_core::schedule::Settings;

use crate::fault::faults;
use crate::fleet::{check, of, outcome, real, run, simulated};

#[test]
fn a_message_is_handled_at_once_and_comes_to_no_execution() {
    check(
        "A actor period=100 publishes=TALK each=[0: say a; 1: say b]
         B actor period=40 trigger=TALK subscribes=TALK reacts=[hear; log reacts] each=[hear]",
        130,
        "[0.000 s] B: hears [a]
         [0.000 s] B: reacts
         [0.000 s] B: hears []
         [0.040 s] B: hears []
         [0.080 s] B: hears []
         [0.100 s] B: hears [b]
         [0.100 s] B: reacts
         [0.120 s] B: hears []
         Elapsed after 0.13 s",
    );
}

#[test]
fn reactions_are_no_executions_and_leave_their_phase() {
    let fleet = "A actor period=10 publishes=TALK each=[say a]
         B actor period=25 delay=5 trigger=TALK subscribes=TALK reacts=[] each=[log executes]";
    check(
        fleet,
        60,
        "[0.005 s] B: executes
         [0.030 s] B: executes
         [0.055 s] B: executes
         Elapsed after 0.06 s",
    );
    let (report, _) = run(fleet, simulated(60));
    assert_eq!((of(&report, "B").executions, of(&report, "B").reactions), (3, 6));
    assert_eq!((of(&report, "B").missed, of(&report, "B").messages.received), (0, 6));
}

#[test]
fn between_two_reactions_is_the_minimum() {
    check(
        "A actor period=1 publishes=TALK each=[say a]
         B actor period=100 trigger=TALK minimum=4 subscribes=TALK reacts=[hear]",
        12,
        "[0.000 s] B: hears [a]
         [0.004 s] B: hears [a, a, a, a]
         [0.008 s] B: hears [a, a, a, a]
         Elapsed after 0.012 s",
    );
    // A message of its own triggers a component, too, and time goes on.
    check(
        "A actor period=100 trigger=TALK minimum=2 publishes=TALK subscribes=TALK each=[say a] reacts=[hear; say b]",
        5,
        "[0.000 s] A: hears [a]
         [0.002 s] A: hears [b]
         [0.004 s] A: hears [b]
         Elapsed after 0.005 s",
    );
}

#[test]
fn reactions_of_one_instant_are_in_document_order_and_before_executions() {
    check(
        "B actor period=100 delay=10 trigger=TALK subscribes=TALK reacts=[log B reacts] each=[log B executes]
         A actor period=10 publishes=TALK each=[1: say a; 1: log says]
         C actor period=10 trigger=TALK subscribes=TALK reacts=[log C reacts] each=[1: log C executes]",
        20,
        "[0.010 s] B: B executes
         [0.010 s] A: says
         [0.010 s] B: B reacts
         [0.010 s] C: C reacts
         [0.010 s] C: C executes
         Elapsed after 0.02 s",
    );
}

#[test]
fn topics_that_are_no_triggers_wait_for_the_execution() {
    check(
        "A actor period=10 publishes=[TALK TABLE] each=[0: put 7 1; 1: say a]
         B actor period=40 delay=20 trigger=TALK subscribes=[TALK TABLE] reacts=[hear; read] each=[hear; read]",
        30,
        "[0.010 s] B: hears [a]
         [0.010 s] B: reads []
         [0.020 s] B: hears []
         [0.020 s] B: reads [7=1]
         Elapsed after 0.03 s",
    );
}

#[test]
fn what_came_before_a_component_starts_or_while_it_was_gone_triggers_it() {
    check(
        "A actor period=100 publishes=TABLE each=[put 7 1]
         B actor period=100 startup=false trigger=TABLE subscribes=TABLE reacts=[read]
         C actor period=100 delay=15 task=B each=[schedule]",
        20,
        "[0.015 s] B: reads [7=1]
         Elapsed after 0.02 s",
    );
    check(
        "A actor period=10 publishes=TALK each=[say a]
         B actor period=100 restart=25/2 trigger=TALK subscribes=TALK reacts=[hear; fail again]",
        30,
        "[0.000 s] B: hears [a]
         [0.000 s] B: failed and is restarted in 25ms: again
         [0.025 s] B: restarted (1)
         [0.025 s] B: hears [a, a]
         [0.025 s] B: failed and is restarted in 50ms: again
         Elapsed after 0.03 s",
    );
}

#[test]
fn a_reaction_that_finds_its_provider_busy_comes_again_with_its_messages() {
    let settings = Settings { faults: faults(&["10 for 3ms stall P"]), ..simulated(20) };
    let fleet = "P actor period=10
         A actor period=10 publishes=TALK each=[1: say a]
         B actor period=100 delay=50 trigger=TALK minimum=1 subscribes=TALK peer=P reacts=[must-ask one; hear]";
    let (report, diary) = run(fleet, settings);
    let told =
        "[0.010 s] B: component `P`, which it calls, is busy: tries again in each period\n[0.013 s] B: hears [a]\n";
    assert_eq!((diary.lines().as_str(), of(&report, "B").busy), (told, 3));
}

#[test]
fn in_real_time_a_message_wakes_a_reaction_long_before_the_next_execution() {
    let fleet = "A actor period=5 publishes=TALK each=[3: say a]
         B actor period=60s trigger=TALK publishes=OWN subscribes=TALK reacts=[hear; done]";
    let (report, diary) = run(fleet, real(30_000));
    assert_eq!(outcome(&report).split(' ').next(), Some("Done"), "{}", diary.lines());
    assert!(diary.lines().contains("B: hears [a]"), "{}", diary.lines());
    assert_eq!(of(&report, "B").reactions, 1);
}

#[test]
fn a_slow_reaction_holds_up_nobody() {
    let fleet = "A actor period=5 publishes=TALK each=[say a]
         B actor period=1s trigger=TALK subscribes=TALK reacts=[sleep 50]
         C actor period=2";
    let (report, _) = run(fleet, real(1000));
    // C is due 500 times; behind B, it would run once in 50 ms.
    assert!(of(&report, "C").executions > 250 && of(&report, "B").slow >= 1, "{:?}", of(&report, "B"));
}
