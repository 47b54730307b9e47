//! Messages that are lost, late or come twice, and components that fail.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

use saoms_testkit::{Fleet, Run};

fn hall() -> Fleet {
    Fleet::of_file("../composites/hall.composite")
}

fn run(fleet: &Fleet) -> Run {
    fleet.run(7, Duration::from_secs(60))
}

const fn seconds(seconds: u64) -> Duration {
    Duration::from_secs(seconds)
}

#[test]
fn a_request_that_is_lost_is_carried_by_nobody() {
    let lost = run(&hall().lose("ELMSTOPIC", seconds(0)..seconds(2)));
    assert_eq!(lost.count("luggage.delivered"), 0);
    lost.expect("Robot7").never_to("takes luggage");
    let later = run(&hall().lose("ELMSTOPIC", seconds(20)..seconds(30)));
    assert_eq!(later.count("luggage.delivered"), 1, "nothing was sent then");
}

#[test]
fn a_late_request_is_carried_later_and_one_that_comes_twice_once() {
    let takes = |run: &Run| run.expect("Robot7").to("takes luggage 1").time();
    let (usual, late) = (run(&hall()), run(&hall().delay("ELMSTOPIC", seconds(0)..seconds(2), seconds(5))));
    assert!(takes(&late).saturating_sub(takes(&usual)) >= Duration::from_millis(4900));
    assert_eq!(late.count("luggage.delivered"), 1);
    let twice = run(&hall().duplicate("ELMSTOPIC", seconds(0)..seconds(60)));
    assert_eq!(twice.count("luggage.delivered"), 1);
    assert_eq!(twice.expect("Robot7").count("takes luggage 1"), run(&hall()).expect("Robot7").count("takes luggage 1"));
}

#[test]
fn an_execution_fails_when_the_test_says_so() {
    let failed = run(&hall().fail("Robot7", seconds(2)));
    let robot = failed.components.iter().find(|one| one.name == "Robot7").unwrap();
    assert_eq!(robot.failures, 1);
    assert!(failed.log().contains("Robot7: "), "{}", failed.log());
}

#[test]
fn a_fault_of_nothing_is_a_slip_of_the_test() {
    let told = |fleet: Fleet| {
        let cause = catch_unwind(AssertUnwindSafe(|| drop(run(&fleet)))).unwrap_err();
        cause.downcast_ref::<String>().unwrap().clone()
    };
    let topic = told(hall().lose("ELMTOPIC", seconds(0)..seconds(2)));
    assert_eq!(
        topic,
        "the fault `for 2s violate 100 % on ELMTOPIC`: the fleet has no topic `ELMTOPIC`; did you mean `ELMSTOPIC`?"
    );
    let component = told(hall().slow("Wrold", seconds(1), seconds(1)));
    assert_eq!(component, "the fault `for 1s stall Wrold`: the fleet has no component `Wrold`; did you mean `World`?");
}
