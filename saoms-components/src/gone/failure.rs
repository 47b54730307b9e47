//! What the fleet is told when the component of a robot fails: it is treated as a fault of the robot.

use saoms_api::extension::{FailureNotice, Outage, submit};
use saoms_api::host::cdr;

use crate::messages::{ENVIRONMENT, EnvironmentEvent, Fault, ROBOT_LIST};

submit! { FailureNotice { about: ROBOT_LIST.declaration(), topic: ENVIRONMENT.declaration(), message } }

fn message(outage: Outage) -> (Vec<u8>, String) {
    let Outage { number, since, restarts } = outage;
    let fault = Fault::failure(number, since, restarts);
    let text = fault.to_string();
    (cdr::encode(&EnvironmentEvent::from(fault)), text)
}
