//! What `?` makes a failure of.

use std::fmt;

use saoms_api::{CallError, Failure, Finding, Place};

/// An error of somebody's own.
#[derive(Debug)]
struct Jammed(std::num::ParseIntError);

impl fmt::Display for Jammed {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("the wheel is jammed")
    }
}

impl std::error::Error for Jammed {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.0)
    }
}

fn message(attempt: impl FnOnce() -> Result<(), Failure>) -> String {
    attempt().unwrap_err().message().to_owned()
}

#[test]
fn any_error_and_any_text_is_a_reason() {
    assert_eq!(message(|| Ok(Err("no numbers left")?)), "no numbers left");
    assert_eq!(message(|| Ok(Err(format!("{} left", 0))?)), "0 left");
    assert_eq!(message(|| Ok(Some(()).filter(|()| false).ok_or("none")?)), "none");
    assert_eq!(message(|| Ok("5x".parse::<u32>().map(drop)?)), "invalid digit found in string");
    assert!(message(|| Ok(std::fs::read("/nowhere/at/all").map(drop)?)).contains("No such file"));
    let jammed = || Jammed("x".parse::<u32>().unwrap_err());
    assert_eq!(message(|| Ok(Err(jammed())?)), "the wheel is jammed: invalid digit found in string");
    let boxed: Box<dyn std::error::Error + Send + Sync> = Box::new(jammed());
    assert_eq!(message(|| Ok(Err(boxed)?)), "the wheel is jammed: invalid digit found in string");
    assert_eq!(message(|| Ok(Err(fmt::Error)?)), fmt::Error.to_string());
}

#[test]
fn what_a_failure_is_about_goes_through() {
    let busy = || CallError::Busy { provider: "Wheels1".to_owned() };
    assert_eq!(Failure::from(busy()).busy_provider(), Some("Wheels1"));
    let inner = CallError::Failed { provider: "Drive".to_owned(), failure: busy().into() };
    assert_eq!(Failure::from(inner).busy_provider(), Some("Wheels1"));
    let gone = CallError::NotRunning { provider: "Wheels1".to_owned() };
    assert_eq!((Failure::from(gone.clone()).busy_provider(), Failure::from(gone).message().is_empty()), (None, false));
    let finding = |name| Finding::new(Place::property(name), "wrong");
    assert_eq!(Failure::from(finding("low")).findings(), [finding("low")]);
    let both = Failure::of_findings(vec![finding("low"), finding("high")]);
    assert_eq!((both.message(), both.findings().len()), ("property `low`: wrong (and 1 more)", 2));
}
