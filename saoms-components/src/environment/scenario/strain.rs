//! The values of faults that robots and worlds take as events: `slow`, `drain` and `outage`.

use saoms_api::event::{Argument, Event, EventCall};
use saoms_api::extension::LineFault;
use saoms_api::host::parse_duration;

use crate::messages::MOST_FACTOR;

/// The classes whose events these are; others may have events with these names.
const CLASSES: [&str; 2] = ["saoms.World", "saoms.Robot"];

/// Judges what the types of the fields leave open.
pub(super) fn check(event: &Event, call: &EventCall) -> Result<(), LineFault> {
    if !event.classes.iter().any(|class| CLASSES.contains(&class.as_str())) {
        return Ok(());
    }
    let given = |name: &str| call.arguments.iter().find(|one| one.name.text == name);
    if event.name == "drain" {
        match (given("percent"), given("factor"), given("lasting")) {
            (None, None, _) => {
                let message =
                    "event `drain` says neither what the battery loses at once, nor how much faster it drains";
                let fault = LineFault::new(call.name.bytes.clone(), message);
                return Err(fault.help("add `percent=30`, or `factor=3` and perhaps `lasting=20s`"));
            }
            (Some(_), None, Some(lasting)) => {
                let message = "found `lasting`, but `percent` is lost at once";
                let fault = LineFault::new(lasting.name.bytes.clone(), message);
                return Err(fault.help("remove it, or add `factor=3` for a battery that drains faster so long"));
            }
            _ => {}
        }
    }
    in_range(given("percent"), (0.0, 100.0), "from 0 to 100, in percent of a full battery")?;
    in_range(given("factor"), (1.0, MOST_FACTOR), &format!("from 1 to {MOST_FACTOR}"))?;
    match given("lasting") {
        Some(lasting)
            if lasting.ends().iter().any(|end| parse_duration(&end.text).is_ok_and(|time| time.is_zero())) =>
        {
            let message = format!("field `lasting`: found `{}`, expected a time above 0", lasting.value.text);
            Err(LineFault::new(lasting.value.bytes.clone(), message).help("leave it out for a fault that never ends"))
        }
        _ => Ok(()),
    }
}

fn in_range(field: Option<&Argument>, (least, most): (f64, f64), expected: &str) -> Result<(), LineFault> {
    let Some(field) = field else { return Ok(()) };
    let is_wrong = |text: &str| text.parse::<f64>().is_ok_and(|value| !(least..=most).contains(&value));
    match field.ends().into_iter().find(|end| is_wrong(&end.text)) {
        None => Ok(()),
        Some(end) => {
            let message = format!("field `{}`: found `{}`, expected a number {expected}", field.name.text, end.text);
            Err(LineFault::new(end.bytes, message))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(line: &str) -> String {
        let call = EventCall::read(line).unwrap();
        let event = Event {
            name: call.name.text.clone(),
            doc: String::new(),
            fields: Vec::new(),
            classes: vec!["saoms.World".to_owned()],
        };
        check(&event, &call).map_or_else(
            |LineFault { bytes, message, .. }| format!("`{}`: {message}", &line[bytes]),
            |()| String::new(),
        )
    }

    #[test]
    fn values_that_mean_nothing_are_refused_at_their_place() {
        for right in [
            "slow robot=2 factor=3 lasting=20s",
            "slow robot=2 factor=1.0..3.0",
            "drain robot=2 percent=30",
            "drain robot=2 percent=30 factor=2 lasting=5s..9s",
            "outage charger=(0,4)",
        ] {
            assert_eq!(judged(right), "", "{right}");
        }
        assert_eq!(
            judged("slow robot=2 factor=0.5"),
            "`0.5`: field `factor`: found `0.5`, expected a number from 1 to 1000"
        );
        assert_eq!(
            judged("slow robot=2 factor=0.5..3.0"),
            "`0.5`: field `factor`: found `0.5`, expected a number from 1 to 1000"
        );
        assert_eq!(
            judged("drain robot=2 percent=130"),
            "`130`: field `percent`: found `130`, expected a number from 0 to 100, in percent of a full battery"
        );
        assert_eq!(
            judged("drain robot=2 factor=1e308"),
            "`1e308`: field `factor`: found `1e308`, expected a number from 1 to 1000"
        );
        assert!(judged("drain robot=2").starts_with("`drain`: event `drain` says neither"));
        assert_eq!(
            judged("drain robot=2 percent=3 lasting=9s"),
            "`lasting`: found `lasting`, but `percent` is lost at once"
        );
        assert_eq!(
            judged("outage charger=(0,4) lasting=0s"),
            "`0s`: field `lasting`: found `0s`, expected a time above 0"
        );
    }
}
