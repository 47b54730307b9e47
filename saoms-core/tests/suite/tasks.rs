use std::time::Duration;

use saoms_api::Time;

use crate::fleet::{check, of, outcome, run, simulated, start};

#[test]
fn a_task_is_scheduled_and_unscheduled_by_another() {
    check(
        "A actor period=10 task=B each=[running; 1: schedule; 1: running; 4: unschedule; 4: running; 6: schedule]
         B actor period=10 delay=5 startup=false first=[log first] each=[log b] last=[log last]",
        80,
        "[0.000 s] A: running false
         [0.010 s] A: running false
         [0.010 s] A: running true
         [0.010 s] B: first
         [0.015 s] B: b
         [0.020 s] A: running true
         [0.025 s] B: b
         [0.030 s] A: running true
         [0.035 s] B: b
         [0.040 s] A: running true
         [0.040 s] A: running false
         [0.040 s] B: last
         [0.050 s] A: running false
         [0.060 s] A: running false
         [0.060 s] B: first
         [0.065 s] B: b
         [0.070 s] A: running true
         [0.075 s] B: b
         [0.080 s] B: last
         Elapsed after 0.08 s",
    );
}

#[test]
fn a_task_is_scheduled_for_a_duration() {
    check(
        "A actor period=100 task=B each=[0: schedule-for 35]
         B actor period=10 startup=false each=[log b] last=[log last]",
        100,
        "[0.000 s] B: b
         [0.010 s] B: b
         [0.020 s] B: b
         [0.030 s] B: b
         [0.035 s] B: last
         Elapsed after 0.1 s",
    );
}

#[test]
fn how_long_a_running_task_is_scheduled_can_be_changed() {
    check(
        "A actor period=10 delay=1 task=B each=[0: schedule-for 1000; 2: schedule-for 4]
         B actor period=10 each=[log b] last=[log last]",
        100,
        "[0.000 s] B: b
         [0.010 s] B: b
         [0.020 s] B: b
         [0.025 s] B: last
         Elapsed after 0.1 s",
    );
}

#[test]
fn a_task_can_unschedule_itself_and_its_execution_ends_first() {
    check(
        "A actor period=10 task=A publishes=TALK each=[1: cancelled; 1: unschedule; 1: cancelled; 1: say bye; 1: running] last=[log last]
         B actor period=10 subscribes=TALK each=[hear]",
        30,
        "[0.000 s] B: hears []
         [0.010 s] A: cancelled false
         [0.010 s] A: cancelled true
         [0.010 s] A: running false
         [0.010 s] A: last
         [0.010 s] B: hears [bye]
         [0.020 s] B: hears []
         Elapsed after 0.03 s",
    );
}

#[test]
fn without_may_interrupt_an_execution_does_not_hear_of_it() {
    check(
        "A actor task=A interrupt=false each=[unschedule; cancelled]\nB actor",
        1,
        "[0.000 s] A: cancelled false
         Elapsed after 0.001 s",
    );
}

#[test]
fn a_task_that_unschedules_and_schedules_itself_begins_anew() {
    check(
        "A actor period=10 delay=3 task=A first=[log first] each=[number; 1: unschedule; 1: schedule] last=[log last]",
        30,
        "[0.000 s] A: first
         [0.003 s] A: A 0 every 10ms
         [0.013 s] A: A 1 every 10ms
         [0.013 s] A: last
         [0.013 s] A: first
         [0.016 s] A: A 0 every 10ms
         [0.026 s] A: A 1 every 10ms
         [0.026 s] A: last
         [0.026 s] A: first
         [0.029 s] A: A 0 every 10ms
         [0.030 s] A: last
         Elapsed after 0.03 s",
    );
}

#[test]
fn a_task_that_is_unscheduled_while_it_waits_for_its_restart_stays_away() {
    check(
        "A actor period=10 restart=25/3 each=[1: fail once] last=[log never]
         B actor period=10 task=A each=[2: running; 2: unschedule; 2: running]",
        100,
        "[0.010 s] A: failed and is restarted in 25ms: once
         [0.020 s] B: running true
         [0.020 s] B: running false
         Elapsed after 0.1 s",
    );
}

#[test]
fn a_failed_task_can_be_scheduled_again() {
    check(
        "A actor period=10 each=[0: fail once]
         B actor period=10 task=A each=[2: schedule]",
        40,
        "[0.000 s] A: failed: once
         [0.020 s] A: failed: once
         Failed after 0.04 s
         - component `A` failed: once
         - component `A` failed: once",
    );
}

#[test]
fn requests_in_initialize_take_effect_when_the_fleet_has_started() {
    check(
        "A actor period=10 task=B first=[running; schedule-for 15; running]
         B actor period=10 startup=false first=[time] each=[log b] last=[log last]
         C actor task=C first=[unschedule] each=[log never] last=[log c]",
        30,
        "[0.000 s] A: running false
         [0.000 s] A: running true
         [0.000 s] B: now 0.000 s due 0.000 s
         [0.000 s] B: b
         [0.000 s] C: c
         [0.010 s] B: b
         [0.015 s] B: last
         Elapsed after 0.03 s",
    );
}

#[test]
fn a_task_that_leaves_hears_nothing_meanwhile() {
    check(
        "A actor period=10 publishes=TALK each=[say word]
         B actor period=10 subscribes=TALK each=[hear]
         C actor period=10 task=B each=[0: unschedule; 3: schedule]",
        50,
        "[0.000 s] B: hears [word]
         [0.030 s] B: hears []
         [0.040 s] B: hears [word]
         Elapsed after 0.05 s",
    );
}

#[test]
fn the_program_schedules_and_unschedules_at_exact_times() {
    let (fleet, diary) = start(
        "A actor period=10 each=[log a] last=[log last]
         B actor period=10 startup=false each=[log b]
         C callee",
        simulated(100),
    );
    let fleet = fleet.unwrap();
    let handle = fleet.handle();
    fleet.run_until(Time::from_nanos(10_000_000));
    assert_eq!(handle.progress().time, Time::from_nanos(10_000_000));
    assert_eq!(handle.progress().periods, 1);
    assert_eq!((handle.is_running("A"), handle.is_running("B")), (Ok(true), Ok(false)));
    handle.unschedule("A").unwrap();
    handle.schedule_for("B", Duration::from_millis(20)).unwrap();
    assert_eq!((handle.is_running("A"), handle.is_running("B")), (Ok(false), Ok(true)));
    fleet.run_until(Time::from_nanos(50_000_000));
    assert_eq!((handle.is_running("A"), handle.is_running("B")), (Ok(false), Ok(false)));
    assert_eq!(handle.schedule("X").unwrap_err().to_string(), "the fleet has no component `X`");
    assert_eq!(
        handle.unschedule("C").unwrap_err().to_string(),
        "component `C` is passive: it has no executions that could be scheduled"
    );
    handle.schedule("A").unwrap();
    fleet.run_until(Time::from_nanos(55_000_000));
    let report = fleet.run_to_end();
    assert_eq!(outcome(&report), "Elapsed after 0.1 s");
    assert_eq!(
        diary.lines(),
        "[0.000 s] A: a\n[0.010 s] A: last\n[0.010 s] B: b\n[0.020 s] B: b\n[0.050 s] A: a\n[0.060 s] A: a\n[0.070 s] A: a\n\
         [0.080 s] A: a\n[0.090 s] A: a\n[0.100 s] A: last\n"
    );
}

#[test]
fn scheduling_again_and_again_leaves_nothing_behind() {
    let (report, _) = run(
        "A actor period=1 task=B each=[unschedule; schedule]
         B actor period=3600s startup=false",
        simulated(2000),
    );
    assert_eq!(of(&report, "A").executions, 2000);
    assert_eq!(of(&report, "B").executions, 2000);
}

#[test]
fn a_task_that_begins_anew_in_each_execution_lets_time_go_on() {
    check(
        "A actor period=10 task=A each=[time; unschedule; schedule]",
        30,
        "[0.000 s] A: now 0.000 s due 0.000 s
         [0.010 s] A: now 0.010 s due 0.010 s
         [0.020 s] A: now 0.020 s due 0.020 s
         Elapsed after 0.03 s",
    );
}
