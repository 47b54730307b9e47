//! A measurement in a process of its own, so that its memory and processor time are its own.

use std::env;
use std::process::{Command, Stdio};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::Outcome;

/// Runs this program again with `--inside CASE`, and reads the result that it [prints](tell). The case is passed as
/// JSON.
pub(crate) fn run<T: DeserializeOwned>(case: &impl Serialize) -> Outcome<T> {
    let case = serde_json::to_string(case)?;
    let mut command = Command::new(env::current_exe()?);
    command.args(["--bench", "--inside", &case]).stderr(Stdio::inherit());
    let output = command.output()?;
    if !output.status.success() {
        return Err(format!("{case}: ended with {}", output.status).into());
    }
    Ok(serde_json::from_slice(&output.stdout)?)
}

/// Prints the result of a measurement for the process that started it.
pub(crate) fn tell(result: &impl Serialize) -> Outcome<()> {
    Ok(serde_json::to_writer(std::io::stdout(), result)?)
}
