//! The acts of a robot from its messages: a line for each execution with more than a step on its way.

use std::fmt::Write;

use super::run::{Execution, Run};

impl Run {
    /// The facts of a robot's run, such as `12: collects at (3,1), 94.0`: the execution, what happened, where, and the
    /// battery.
    pub(crate) fn story(&self, robot: &str) -> String {
        let (mut text, mut before) = (String::new(), Vec::new());
        for execution in self.executions(robot) {
            let all: Vec<String> = execution.said.iter().filter_map(|line| fact(line)).collect();
            let news = |fact: &&String| !REPEATED.contains(&fact.as_str()) || !before.contains(*fact);
            let facts: Vec<&str> = all.iter().filter(news).map(String::as_str).collect();
            if !facts.is_empty() {
                let battery = execution.battery().map(|battery| format!(", {battery}")).unwrap_or_default();
                let _ = writeln!(text, "{}: {}{battery}", execution.number, facts.join(", "));
            }
            before = all;
        }
        text
    }
}

const GOES_HOME: &str = "goes under charge";
const CHARGED: &str = "is charged";

/// States that a robot reports in each execution: only the first report matters.
const REPEATED: [&str; 2] = [GOES_HOME, CHARGED];

/// The fact in a line of the console; `None` for those that say how things are and for steps.
///
/// # Panics
/// The line is none of the original's.
fn fact(line: &str) -> Option<String> {
    const STATE: [&str; 7] = [
        "updated active robot list: ",
        "updated other robot position list: ",
        "help request list: ",
        "luggage request list: ",
        "battery level: ",
        "needs to reach charge position as soon as possible!",
        "says: My position now is: ",
    ];
    if STATE.iter().any(|state| line.starts_with(state)) || line.starts_with("says: Ready to ") {
        return None;
    }
    let fact = match line {
        "says: Luggage collected." => "collects".to_owned(),
        "says: Luggage deposited." => "deposits".to_owned(),
        "says: I've arrived to destination." => "arrives".to_owned(),
        "has low battery and is going under charge..." => GOES_HOME.to_owned(),
        "says: I've arrived to charge position." => "is in charge".to_owned(),
        "is now fully charged and ready (but still asleep)" => CHARGED.to_owned(),
        "is a healer and now is awake" => "heals and is awake".to_owned(),
        "is a healer and awakes another robot" => "heals and awakes another".to_owned(),
        "RISK OF COLLISION DETECTED AND AVOIDED!" => "sees a risk of collision".to_owned(),
        _ => {
            if let Some(luggage) = line.strip_prefix("is bringing luggage from ") {
                format!("claims {luggage}")
            } else if let Some((_, critical)) = line.split_once(" is a new healer for Robot") {
                format!("would heal {critical}")
            } else {
                panic!("no line of the original: {line}")
            }
        }
    };
    Some(fact)
}

impl<'a> Execution<'a> {
    /// The battery as the console shows it, or as the log does where the console is silent.
    pub(crate) fn battery(&self) -> Option<&'a str> {
        let shown = self.said.iter().find_map(|line| line.strip_prefix("battery level: "));
        let logged = || self.log.iter().find_map(|line| line.split("(battery ").nth(1)?.strip_suffix(" %)"));
        shown.or_else(logged)
    }

    /// The position and the destination that the robot reports.
    pub(crate) fn step(&self) -> Option<(&'a str, &'a str)> {
        let line = self.said.iter().find_map(|line| line.strip_prefix("says: My position now is: "))?;
        line.split_once(" and my next position will be: ")
    }
}
