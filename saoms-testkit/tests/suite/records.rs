//! Ids of records on a bench.

use saoms_api::{Class, Component, Context, Failure, record};
use saoms_testkit::Bench;

/// Writes two records.
#[derive(Class)]
#[class(name = "test.Speaker", periodic)]
struct Speaker;

impl Component for Speaker {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Speaker)
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let battery = 34;
        context.symptom(record!(battery: "battery is at {battery} %", battery));
        if context.execution() == 0 {
            context.effect(record!(battery: "shows {battery} %", battery));
        } else {
            context.symptom(record!(battery: "battery is low: {battery} %", battery));
        }
        Ok(())
    }
}

#[test]
fn an_id_with_two_texts_is_a_failure() {
    let mut bench = Bench::of::<Speaker>(&[]).unwrap();
    bench.start().unwrap();
    bench.execute().unwrap();
    assert_eq!(bench.journal(), ["symptom: battery is at 34 %", "effect: shows 34 %"], "another phase is another id");
    let failure = bench.execute().unwrap_err().to_string();
    let expected = "the record `battery` has two texts, `battery is at {battery} %` and `battery is low: {battery} %`: \
                    give one of them another id";
    assert!(failure.contains(expected), "{failure}");
}
