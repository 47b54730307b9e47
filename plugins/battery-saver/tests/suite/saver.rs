//! The loop alone, with a simulated battery.

use saoms_api::{Extras, Knowledge, Value};
use saoms_battery_saver::BatterySaver;
use saoms_testkit::LoopBench;

/// The entries of a robot that the loop needs.
#[derive(Default, Knowledge)]
#[knowledge(name = "test.Robot")]
struct Robot {
    #[entry(unit = "%")]
    battery: f64,
    #[entry]
    in_charge: bool,
    #[entry(effector, unit = "%")]
    charge_at: f64,
    #[extras]
    extras: Extras,
}

fn bench() -> LoopBench<Robot> {
    let mut bench = LoopBench::of::<BatterySaver>(Robot::default(), &[("floor", "50")]).unwrap();
    bench.start().unwrap();
    bench
}

/// A trip with this battery level, then charging.
fn trip(bench: &mut LoopBench<Robot>, battery: f64) -> Vec<String> {
    for in_charge in [false, true] {
        let mut robot = bench.knowledge();
        (robot.in_charge, robot.battery) = (in_charge, battery);
        drop(robot);
        bench.execute().unwrap();
    }
    bench.journal().into_iter().map(str::to_owned).collect()
}

#[test]
fn a_deep_discharge_lets_it_charge_earlier_and_a_shallow_one_later() {
    let mut bench = bench();
    let deep = [
        "BatterySaver symptom: battery was down to 20 %, which is too low",
        "BatterySaver decision: charges at 60 % from now on",
        "BatterySaver chargeAt: 0 -> 60",
    ];
    assert_eq!(trip(&mut bench, 20.0), deep);
    assert_eq!(trip(&mut bench, 65.0), [""; 0], "neither too low nor far above");
    assert_eq!(trip(&mut bench, 90.0).last().unwrap(), "BatterySaver chargeAt: 60 -> 50");
    assert_eq!(bench.knowledge().charge_at, 50.0);
}

#[test]
fn it_remembers_the_lowest_charge_since_the_last_one() {
    let mut bench = bench();
    for battery in [80.0, 30.0, 70.0] {
        bench.knowledge().battery = battery;
        bench.execute().unwrap();
    }
    assert_eq!(bench.value("lowest"), Some(Value::Number(30.0)));
    trip(&mut bench, 75.0);
    assert_eq!(bench.knowledge().charge_at, 60.0);
    bench.expect_transcript("tests/lowest.txt");
}
