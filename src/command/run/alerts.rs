//! Delivery of alerts to the address and the command that the composite names: only where the command line allows it,
//! since a composite may be somebody else's. And the alert about files that cannot be written.

use std::env;
use std::sync::Arc;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use saoms_api::Level;
use saoms_api::host::one_line;
use saoms_control::{AlertList, AlertTarget, Token};
use saoms_core::observe::WriterEvents;
use saoms_core::schedule::Handle;
use saoms_lang::assembly::RunPolicy;

use super::RunArguments;
use super::control::fleet_name;
use crate::Exit;
use crate::output::{counted, eprint};

/// Time after the run for what waits.
const PATIENCE: Duration = Duration::from_secs(5);

/// The delivery of alerts.
pub(super) struct AlertDelivery {
    alerts: Arc<AlertList>,
    fleet: String,
    targets: Vec<AlertTarget>,
    /// What is left out without the option.
    left_out: Option<String>,
}

impl AlertDelivery {
    /// What the composites name and the command line allows. What is wrong with either is reported.
    pub(super) fn of(arguments: &RunArguments, policy: &RunPolicy, alerts: &Arc<AlertList>) -> Result<Self, Exit> {
        let fleet = fleet_name(arguments);
        let none = AlertDelivery { alerts: Arc::clone(alerts), fleet, targets: Vec::new(), left_out: None };
        if !arguments.alerts {
            return Ok(AlertDelivery { left_out: left_out(policy), ..none });
        }
        let mut targets = Vec::new();
        if let Some(url) = &policy.alert_url {
            let token = url.token_env.as_deref().map(token).transpose()?;
            targets.push(AlertTarget::Url { address: url.address.clone(), token });
        }
        if let Some(command) = &policy.alert_command {
            targets.push(AlertTarget::Command { line: command.line.clone(), folder: command.folder.clone() });
        }
        if targets.is_empty() {
            return Err(wrong(
                "`--alerts` has nothing to deliver to: no composite names an address or a command",
                "name one in the start tag of the composite: `saoms:alertUrl=\"http://...\"` or \
                 `saoms:alertCommand=\"...\"`",
            ));
        }
        Ok(AlertDelivery { targets, ..none })
    }

    /// Delivers from now on, or says what is left out.
    pub(super) fn start(&mut self, handle: &Handle) {
        if let Some(left_out) = self.left_out.take() {
            handle.note(Level::Warning, left_out);
        }
        let targets = std::mem::take(&mut self.targets);
        let started = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs();
        let log = handle.clone();
        self.alerts.deliver(&self.fleet, started, targets, &move |level, text| log.note(level, text));
    }

    /// Delivers what waits, and says what could not be delivered.
    pub(super) fn finish(self) {
        let lost = self.alerts.finish(PATIENCE);
        if lost > 0 {
            let changes = counted(usize::try_from(lost).unwrap_or(usize::MAX), "change");
            eprint(&format!("error: {changes} of alerts could not be delivered\n"));
        }
    }
}

/// What a run without the option says.
fn left_out(policy: &RunPolicy) -> Option<String> {
    let url = policy.alert_url.as_ref().map(|url| format!("sent to `{}`", url.address));
    let command = policy.alert_command.as_ref().map(|command| format!("given to the command `{}`", command.line));
    let targets: Vec<String> = url.into_iter().chain(command).collect();
    let targets = targets.join(" nor ");
    (!targets.is_empty()).then(|| one_line(&format!("alerts are not {targets}: `--alerts` allows it")).into_owned())
}

/// The token in an environment variable.
fn token(name: &str) -> Result<Token, Exit> {
    let Some(value) = env::var_os(name).filter(|value| !value.is_empty()) else {
        return Err(wrong(
            &format!(
                "the environment variable `{name}`, which the composite names for the token of alerts, is not set"
            ),
            "set it to the token that the address of `alertUrl` asks for",
        ));
    };
    // Its text is shown nowhere.
    value.to_str().and_then(Token::of).ok_or_else(|| {
        wrong(
            &format!("the environment variable `{name}` holds no token for alerts"),
            "a token has visible ASCII characters alone, at most 1024",
        )
    })
}

fn wrong(what: &str, help: &str) -> Exit {
    eprint(&format!("error: {what}\n  = help: {help}\n\n1 error: nothing was started\n"));
    Exit::WrongInput
}

/// The alert of the kind `file` about what a run leaves on the disk, from the first failure until it is written again.
pub(super) struct FileAlert {
    /// What the file is.
    subject: &'static str,
    alerts: Arc<AlertList>,
}

impl FileAlert {
    const KIND: &str = "file";

    pub(super) fn of(subject: &'static str, alerts: &Arc<AlertList>) -> FileAlert {
        FileAlert { subject, alerts: Arc::clone(alerts) }
    }
}

impl WriterEvents for FileAlert {
    fn fails(&self, reason: &str) {
        eprint(&format!("error: {reason}\n"));
        self.alerts.raise(FileAlert::KIND, self.subject, reason.to_owned());
    }

    fn works(&self) {
        self.alerts.over(FileAlert::KIND, self.subject);
    }
}
