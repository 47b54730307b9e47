use crate::fleet::{check, of, run, simulated};

#[test]
fn executions_follow_delay_and_period() {
    check(
        "A actor period=30 delay=5 each=[time]",
        100,
        "[0.005 s] A: now 0.005 s due 0.005 s
         [0.035 s] A: now 0.035 s due 0.035 s
         [0.065 s] A: now 0.065 s due 0.065 s
         [0.095 s] A: now 0.095 s due 0.095 s
         Elapsed after 0.1 s",
    );
}

#[test]
fn at_one_instant_the_order_is_that_of_the_document_and_each_sees_what_earlier_ones_sent() {
    check(
        "A actor publishes=TALK subscribes=TALK each=[hear; say a]
         B actor publishes=TALK subscribes=TALK each=[hear; say b]
         C actor publishes=TALK subscribes=TALK each=[hear; say c]",
        200,
        "[0.000 s] A: hears []
         [0.000 s] B: hears [a]
         [0.000 s] C: hears [a, b]
         [0.100 s] A: hears [a, b, c]
         [0.100 s] B: hears [b, c, a]
         [0.100 s] C: hears [c, a, b]
         Elapsed after 0.2 s",
    );
}

#[test]
fn components_of_different_periods_meet_in_document_order() {
    check(
        "A actor period=60 each=[log a]
         B actor period=20 each=[log b]
         C actor period=30 each=[log c]",
        61,
        "[0.000 s] A: a
         [0.000 s] B: b
         [0.000 s] C: c
         [0.020 s] B: b
         [0.030 s] C: c
         [0.040 s] B: b
         [0.060 s] A: a
         [0.060 s] B: b
         [0.060 s] C: c
         Elapsed after 0.061 s",
    );
}

#[test]
fn an_execution_knows_its_number_name_and_period() {
    check(
        "hall/A actor period=1.5s each=[number]",
        1501,
        "[0.000 s] hall/A: hall/A 0 every 1.5s
         [1.500 s] hall/A: hall/A 1 every 1.5s
         Elapsed after 1.501 s",
    );
}

#[test]
fn time_does_not_drift_over_a_day() {
    let (report, _) = run("A actor period=1250\nB actor period=86399.9s delay=100us", simulated(86_400_000));
    assert_eq!(of(&report, "A").executions, 69_120);
    assert_eq!(of(&report, "B").executions, 2);
    assert_eq!(report.periods, 69_122);
    assert_eq!(report.time_s, 86_400.0);
}
