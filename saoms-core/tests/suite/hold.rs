//! Pause, steps and speed.

use std::thread;
use std::time::{Duration, Instant};

use saoms_api::Time;
use saoms_core::schedule::{HoldError, Order, RunningFleet, Settings, Speed};

use crate::fleet::{outcome, real, run, simulated, start};

const FLEET: &str = "A actor period=10 each=[number]\nB actor period=10 each=[say b] publishes=TALK\nC actor period=15 subscribes=TALK each=[hear]";

fn milliseconds(time: u64) -> Time {
    Time::from_nanos(time * 1_000_000)
}

/// Runs a fleet on another thread; gives its remote control and its end.
fn running(settings: Settings) -> (saoms_core::schedule::Handle, thread::JoinHandle<(String, Option<String>)>) {
    let fleet: RunningFleet = start(FLEET, settings).0.unwrap();
    let handle = fleet.handle();
    handle.pause().unwrap();
    let run = thread::spawn(move || {
        let report = fleet.run_to_end();
        (outcome(&report), report.trace_hash)
    });
    (handle, run)
}

fn wait_for(handle: &saoms_core::schedule::Handle, time: Time) {
    let start = Instant::now();
    while handle.progress().time != time {
        assert!(start.elapsed() < Duration::from_secs(20), "it is at {}", handle.progress().time);
        thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn virtual_time_pauses_and_advances_by_steps_with_the_same_trace() {
    let (undisturbed, _) = run(FLEET, simulated(100));
    let (handle, run) = running(simulated(100));
    // Before the first executions; time stands.
    let status = handle.status();
    assert!(status.paused && status.time_s == 0.0 && handle.progress().periods == 0);
    // Through the first instant, and then to the next one.
    assert_eq!(handle.step(None), Ok(Time::from_nanos(1)));
    wait_for(&handle, Time::from_nanos(1));
    assert_eq!(handle.progress().periods, 3);
    assert_eq!(handle.step(None), Ok(milliseconds(10) + Duration::from_nanos(1)));
    wait_for(&handle, milliseconds(10) + Duration::from_nanos(1));
    assert_eq!(handle.progress().periods, 5);
    let to = milliseconds(40) + Duration::from_nanos(1);
    assert_eq!(handle.step(Some(Duration::from_millis(30))), Ok(to));
    wait_for(&handle, to);
    assert_eq!(handle.status().components[0].report.executions, 5);
    handle.resume().unwrap();
    let (told, trace) = run.join().unwrap();
    assert_eq!((told.as_str(), trace), ("Elapsed after 0.1 s", undisturbed.trace_hash));
    assert_eq!(handle.pause(), Err(HoldError::Ending));
    assert_eq!(handle.step(None), Err(HoldError::Ending));
}

#[test]
fn orders_take_effect_while_virtual_time_stands() {
    let (handle, run) = running(simulated(100));
    let answer = handle.order(Order::Stop { component: "B".to_owned() }, None).unwrap().wait(Duration::from_secs(10));
    assert_eq!(answer, Ok(serde_json::Value::Null));
    handle.resume().unwrap();
    let (told, _) = run.join().unwrap();
    assert_eq!(told, "Elapsed after 0.1 s");
}

#[test]
fn a_paused_run_ends_when_it_is_stopped() {
    for settings in [simulated(100), real(60_000)] {
        let (handle, run) = running(settings);
        handle.stop();
        assert!(run.join().unwrap().0.starts_with("Interrupted"));
    }
}

#[test]
fn virtual_time_passes_at_its_speed() {
    let (undisturbed, _) = run(FLEET, simulated(1000));
    let (handle, run) = running(simulated(1000));
    handle.set_speed(Speed::Factor(10.0)).unwrap();
    assert_eq!(handle.status().speed, Some(10.0));
    let start = Instant::now();
    handle.resume().unwrap();
    let (_, trace) = run.join().unwrap();
    assert!(start.elapsed() >= Duration::from_millis(95), "a tenth of the time of the run, not less");
    assert_eq!(trace, undisturbed.trace_hash);
    assert_eq!(
        "0".parse::<Speed>().unwrap_err(),
        "found `0`, expected a factor such as `10` or `0.5`, at most 1000000, or `max`"
    );
    assert_eq!("max".parse(), Ok(Speed::Unlimited));
    assert_eq!("2.5x".parse(), Ok(Speed::Factor(2.5)));
}

#[test]
fn real_time_stands_still_and_nothing_is_missed() {
    let fleet = start("A actor period=10 each=[number]", real(600_000)).0.unwrap();
    let handle = fleet.handle();
    while handle.progress().periods < 3 {
        thread::sleep(Duration::from_millis(1));
    }
    let at = handle.pause().unwrap();
    // An execution may have begun before.
    thread::sleep(Duration::from_millis(20));
    let before = handle.progress();
    assert_eq!(before.time, at);
    thread::sleep(Duration::from_millis(600));
    let status = handle.status();
    assert!(status.paused, "it answers while it pauses");
    assert_eq!((handle.progress().time, handle.progress().periods), (at, before.periods));
    assert_eq!(handle.step(None), Err(HoldError::RealTime));
    assert_eq!(handle.set_speed(Speed::Unlimited), Err(HoldError::RealTime));
    let missed = status.components[0].report.missed;
    handle.resume().unwrap();
    while handle.progress().periods < before.periods + 2 {
        thread::sleep(Duration::from_millis(1));
    }
    let went_on = handle.status();
    // Sixty executions would be missed if the pause were a part of its time; a busy machine misses fewer.
    assert!(went_on.components[0].report.missed < missed + 40);
    handle.stop();
    fleet.run_to_end();
}
