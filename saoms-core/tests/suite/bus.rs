use saoms_core::observe::Occurrence;

use crate::fleet::{check, of, outcome, run, simulated, start};

#[test]
fn events_reach_every_reader_once_and_in_order() {
    check(
        "A actor period=10 publishes=TALK each=[2: say one; 2: say two; 7: say three]
         B actor period=40 subscribes=TALK each=[hear]
         C actor period=20 delay=5 subscribes=TALK each=[hear-last]",
        100,
        "[0.000 s] B: hears []
         [0.005 s] C: hears None
         [0.025 s] C: hears Some(\"two\")
         [0.040 s] B: hears [one, two]
         [0.045 s] C: hears None
         [0.065 s] C: hears None
         [0.080 s] B: hears [three]
         [0.085 s] C: hears Some(\"three\")
         Elapsed after 0.1 s",
    );
}

#[test]
fn a_message_knows_who_sent_it_and_when() {
    check(
        "A actor period=20 publishes=TALK each=[say a]
         B actor period=20 delay=10 publishes=TALK each=[say b]
         C actor period=40 delay=35 subscribes=TALK each=[hear-from]",
        40,
        "[0.035 s] C: hears [a by 0 at 0.000 s, b by 1 at 0.010 s, a by 0 at 0.020 s, b by 1 at 0.030 s]
         Elapsed after 0.04 s",
    );
}

#[test]
fn a_keyed_state_topic_keeps_the_newest_of_each_key() {
    check(
        "A actor period=10 publishes=TABLE each=[0: put 1 10; 1: put 2 20; 2: put 1 11; 3: put 1 12; 4: put 3 30]
         B actor period=10 delay=9 publishes=TABLE each=[3: put 2 21]
         C actor period=25 delay=5 subscribes=TABLE each=[read]",
        70,
        "[0.005 s] C: reads [1=10]
         [0.030 s] C: reads [2=20, 1=12]
         [0.055 s] C: reads [2=21, 3=30]
         Elapsed after 0.07 s",
    );
}

#[test]
fn an_unkeyed_state_topic_keeps_the_newest_of_each_publisher() {
    check(
        "A actor period=10 publishes=OWN subscribes=OWN each=[0: own 1; 1: own 2; 1: own 3]
         B actor period=10 publishes=OWN each=[0: own 7]
         C actor period=20 delay=15 subscribes=OWN each=[owns]",
        40,
        "[0.015 s] C: reads [7, 3]
         [0.035 s] C: reads []
         Elapsed after 0.04 s",
    );
}

#[test]
fn who_comes_later_gets_the_present_state_and_only_new_events() {
    check(
        "A actor period=10 publishes=[TABLE TALK] each=[0: put 1 10; 0: say early; 3: put 2 20; 3: say late]
         B actor period=10 task=C each=[2: schedule]
         C actor period=10 startup=false subscribes=[TABLE TALK] each=[read; hear]",
        50,
        "[0.020 s] C: reads [1=10]
         [0.020 s] C: hears []
         [0.030 s] C: reads [2=20]
         [0.030 s] C: hears [late]
         [0.040 s] C: reads []
         [0.040 s] C: hears []
         Elapsed after 0.05 s",
    );
}

#[test]
fn a_full_queue_loses_the_oldest_tells_it_once_and_fails_the_run() {
    let fleet = "A actor period=10 publishes=TALK each=[0: flood 6; 1: flood 5; 3: flood 9]
                 B actor period=10 queue=4 subscribes=TALK each=[hear]
                 C actor period=10 subscribes=TALK each=[]";
    let expected = "[0.000 s] B: lost 2 messages of topic `TALK`, whose queue was full: most were sent by `A`
         [0.000 s] B: hears [2, 3, 4, 5]
         [0.010 s] B: hears [1, 2, 3, 4]
         [0.020 s] B: hears []
         [0.030 s] B: lost 5 messages of topic `TALK`, whose queue was full: most were sent by `A`
         [0.030 s] B: hears [5, 6, 7, 8]
         [0.040 s] B: hears []";
    let end = "Failed after 0.05 s
         - component `B` lost messages of topic `TALK`, whose queue was full (most were sent by `A`): read faster, give it a longer `queue`, or accept loss";
    check(fleet, 50, &format!("{expected}\n{end}"));
    let tolerant = fleet.replace("queue=4", "queue=4 loss=accept");
    check(&tolerant, 50, &format!("{expected}\nElapsed after 0.05 s"));
    let (report, _) = run(&tolerant, simulated(50));
    assert_eq!(of(&report, "B").dropped, 8);
    assert_eq!(of(&report, "C").dropped, 0);
    assert_eq!(of(&report, "A").messages.sent, 20);
    assert_eq!(of(&report, "B").messages.received, 12);
    assert_eq!(of(&report, "C").messages.received, 20);
}

#[test]
fn what_a_reader_never_read_is_lost_too() {
    let (report, _) = run(
        "A actor period=10 publishes=TALK each=[flood 100]
         B actor period=10 queue=4 loss=accept subscribes=TALK each=[0: sleep 0]
         C actor period=1000 delay=500 queue=4 loss=accept subscribes=TALK",
        simulated(100),
    );
    assert_eq!(of(&report, "B").dropped, 960);
    assert_eq!(of(&report, "C").dropped, 996);
}

#[test]
fn renamed_topics_meet_under_their_new_names() {
    check(
        "A actor period=10 publishes=TALK rename=TALK/one each=[0: say a]
         B actor period=10 publishes=TALK rename=TALK/two each=[0: say b]
         C actor period=10 subscribes=TALK rename=TALK/one each=[hear]
         D actor period=10 subscribes=TALK each=[hear]",
        10,
        "[0.000 s] C: hears [a]
         [0.000 s] D: hears []
         Elapsed after 0.01 s",
    );
}

#[test]
fn different_messages_on_one_topic_do_not_start() {
    let (fleet, _) = start(
        "A actor publishes=TALK
         B actor subscribes=NUMBERS rename=NUMBERS/TALK",
        simulated(10),
    );
    assert_eq!(
        fleet.unwrap_err().to_string(),
        "component `B` of class `actor` could not start: topic `TALK` carries event messages `Words`, as component \
        `A` uses it, but here it would carry event messages `Own`: rename one of the two with `topicRename`, or use \
        the same message in both"
    );
    let (fleet, _) = start(
        "A actor publishes=OWN rename=OWN/both
         B actor subscribes=NUMBERS rename=NUMBERS/both",
        simulated(10),
    );
    assert!(fleet.unwrap_err().to_string().contains("carries state messages `Own`"));
}

#[test]
fn without_jms_there_are_no_topics() {
    for verb in ["publishes", "subscribes"] {
        let (fleet, _) = start(&format!("A actor jms=false {verb}=TALK"), simulated(10));
        assert_eq!(
            fleet.unwrap_err().to_string(),
            "component `A` of class `actor` could not start: topic `TALK`: component `A` has `useJMS` false and can neither \
             publish nor subscribe: set it to true"
        );
    }
}

#[test]
fn topics_are_taken_in_initialize_only_and_used_only_when_taken() {
    check(
        "A actor each=[publish-late]
         B actor each=[say nothing]",
        1,
        "[0.000 s] A: failed: topic `TALK`: a component can only publish in `initialize`; keep what it returns
         [0.000 s] B: failed: this publisher belongs to no topic: keep what `Context::publish` returned in `initialize`
         Failed after 0 s
         - component `A` failed: topic `TALK`: a component can only publish in `initialize`; keep what it returns
         - component `B` failed: this publisher belongs to no topic: keep what `Context::publish` returned in `initialize`",
    );
}

#[test]
fn what_one_execution_sends_is_bounded() {
    check(
        "A actor publishes=TALK each=[flood 1000001]
         B actor",
        1,
        "[0.000 s] A: failed: sends more in one execution than 1000000 messages or 256 MiB: 1000000 messages, 0 MiB so far; send the rest in the next executions (messages of this execution that are not sent: 1000000)
         Failed after 0.001 s
         - component `A` failed: sends more in one execution than 1000000 messages or 256 MiB: 1000000 messages, 0 MiB so far; send the rest in the next executions (messages of this execution that are not sent: 1000000)",
    );
}

#[test]
fn what_one_execution_writes_is_bounded() {
    let too_much = "component `A` failed: writes more in one execution than 100000 records of the journal or 100000 \
                    lines of the log: write changes, or the rest in the next executions";
    for (script, records, lines) in [
        ("record 100001", 100_000, 0),
        ("decide 100001", 100_000, 0),
        // Whether anybody wants the lines or not.
        ("write 100001", 0, 0),
        ("show 100001", 0, 100_000),
        ("record 100001; fail for another reason", 100_000, 0),
    ] {
        let (report, diary) = run(&format!("A actor each=[{script}]\nB actor"), simulated(10));
        assert!(outcome(&report).contains(too_much), "{script}: {}", outcome(&report));
        assert_eq!(of(&report, "B").executions, 1, "{script}");
        assert_eq!(report.journal.records, records, "{script}");
        assert_eq!(diary.count(|event| matches!(event.what, Occurrence::Console { .. })), lines, "{script}");
    }
    check("A actor each=[record 100000; write 100000]", 1, "Elapsed after 0.001 s");
}
