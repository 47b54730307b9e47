//! Real-time scheduling, in a process of its own because it locks the memory of the process.

use std::time::Duration;

use saoms_core::report::RunStatus;
use saoms_core::schedule::{RunningFleet, Settings, StartError};
use saoms_lang::assembly::Assembly;

#[test]
fn realtime_works_or_says_what_to_grant() {
    let settings = Settings { realtime: true, limit: Some(Duration::from_millis(20)), ..Settings::default() };
    match RunningFleet::start(Assembly::default(), settings, Vec::new()) {
        Ok(fleet) => assert_eq!(fleet.run_to_end().outcome.status, RunStatus::Elapsed),
        Err(error @ StartError::Realtime(_)) => {
            let text = error.to_string();
            assert!(text.contains("is not permitted") && text.contains("CAP_") && text.contains("ulimit"), "{text}");
        }
        Err(other) => panic!("{other}"),
    }
}
