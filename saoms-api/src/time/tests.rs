use proptest::prelude::*;

use super::*;

#[test]
fn durations_are_read() {
    let cases: [(&str, u64); 12] = [
        ("500", 500_000_000),
        ("0", 0),
        ("100us", 100_000),
        ("100 µs", 100_000),
        (" 1.5 s ", 1_500_000_000),
        (".5ms", 500_000),
        ("5.min", 300_000_000_000),
        ("0.0000004ms", 0),
        ("0.0000005ms", 1),
        ("1.00000000000000000000000000000000000000001 h", 3_600_000_000_000),
        ("18446744073709551615ns", u64::MAX),
        ("007", 7_000_000),
    ];
    for (text, nanos) in cases {
        assert_eq!(parse_duration(text), Ok(Duration::from_nanos(nanos)), "{text}");
    }
}

#[test]
fn wrong_durations_are_refused() {
    let cases = [
        ("", WrongDuration::Other),
        ("soon", WrongDuration::Other),
        ("s", WrongDuration::Other),
        (".", WrongDuration::Other),
        ("1e3", WrongDuration::Other),
        ("1.2.3", WrongDuration::Other),
        ("+5", WrongDuration::Other),
        ("5 parsecs", WrongDuration::Other),
        ("5 S", WrongDuration::Other),
        ("inf", WrongDuration::Other),
        ("-", WrongDuration::Other),
        ("-x", WrongDuration::Other),
        ("-5", WrongDuration::Negative),
        ("-0.1 s", WrongDuration::Negative),
        ("18446744073709551616ns", WrongDuration::TooLong),
        ("99999999999999999999999999999999999999999999999999", WrongDuration::TooLong),
        ("1000000000000 h", WrongDuration::TooLong),
    ];
    for (text, error) in cases {
        assert_eq!(read_duration(text), Err(error), "{text}");
        assert!(parse_duration(text).is_err(), "{text}");
    }
    assert_eq!(
        parse_duration("5 parsecs").unwrap_err(),
        "`5 parsecs` is not a duration: expected a number of milliseconds, or a number with one of the units ns, us, ms, s, min, h"
    );
}

#[test]
fn what_is_meant_by_a_wrong_duration_is_found() {
    for (text, meant) in [
        ("1m30s", "90s"),
        ("1h30min", "5400s"),
        ("1 min 30 s", "90s"),
        ("1 minute and 30 seconds", "90s"),
        ("1s500ms", "1500ms"),
        ("00:01:00", "60s"),
        ("0:00:01.5", "1500ms"),
        ("PT0.2S", "0.2s"),
        ("PT1M30S", "90s"),
        ("5Hz", "200ms"),
        ("3 Hz", "333333us"),
        ("200MS", "200ms"),
        ("200milliseconds", "200ms"),
        ("2 minutes", "2min"),
        ("200ms;", "200ms"),
        ("~200ms", "200ms"),
        ("+1s", "1s"),
        ("0,2s", "0.2s"),
        ("1e3", "1000"),
        ("1e3 ms", "1000ms"),
    ] {
        assert_eq!(meant_duration(text).as_deref(), Some(meant), "{text}");
    }
    for text in ["", "soon", "200ms", "-1s", "1m", "12:30", "0 Hz", "1 parsec", "s", "::", "1/5s", "1s2", "e", "pt"] {
        assert_eq!(meant_duration(text), None, "{text}");
    }
}

#[test]
fn times_saturate() {
    assert_eq!(Time::from_nanos(5) - Time::from_nanos(7), Duration::ZERO);
    assert_eq!(Time::from_nanos(7) - Time::from_nanos(5), Duration::from_nanos(2));
    assert_eq!(Time::from_nanos(u64::MAX) + Duration::from_secs(1), Time::from_nanos(u64::MAX));
    assert_eq!(Time::from_nanos(12_500_900_000).to_string(), "12.500 s");
}

proptest! {
    #[test]
    fn what_is_written_is_read(nanos: u64) {
        let duration = Duration::from_nanos(nanos);
        prop_assert_eq!(parse_duration(&format_duration(duration)), Ok(duration));
    }

    #[test]
    fn any_text_is_read_or_refused(text in "[-0-9. a-zµ]{0,60}|\\PC{0,20}") {
        let _ = parse_duration(&text);
        let _ = meant_duration(&text);
    }
}
