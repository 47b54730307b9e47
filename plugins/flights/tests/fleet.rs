//! Flights in the airport fleet, with the plugin's code linked in.

use std::time::Duration;

use saoms_flights as _;
use saoms_testkit::Fleet;

#[test]
fn the_luggage_of_flights_and_of_the_environment_is_brought() {
    let fleet = Fleet::of_file("fleet.composite");
    assert_eq!(fleet.diagnostics(), "");
    let run = fleet.run(1, Duration::from_secs(300));
    assert_eq!(run.sections["luggage"]["delivered"], 4, "{}", run.log());
    assert_eq!(run.sections["flights"]["done"], 2, "{}", run.log());
    assert!(run.log_of("Master").contains(&"flight 12 has 2 pieces on board, 0 are lost".to_owned()), "{}", run.log());
}

#[test]
fn luggage_that_nobody_can_bring_is_lost_for_its_flight() {
    let text = std::fs::read_to_string("fleet.composite").unwrap();
    let run = Fleet::of_text(text.replace("(8,9)", "(30,9)")).run(1, Duration::from_secs(300));
    assert!(run.log_of("Master").contains(&"flight 34 has 0 pieces on board, 1 are lost".to_owned()), "{}", run.log());
    assert_eq!(run.sections["luggage"]["delivered"], 3, "{}", run.log());
}
