//! Code of libraries that the program waits for in vain: told on standard error after a second, each once.

use std::collections::HashSet;
use std::time::Duration;
use std::{io, thread};

use saoms_api::host::present::{Function, Owner, everywhere};
use saoms_core::schedule::start_thread;

use crate::output::eprint;

/// How long such code runs before it is told.
const PATIENCE: Duration = Duration::from_secs(1);

/// The time between two looks.
const LOOK: Duration = Duration::from_millis(250);

/// What still runs after so long is named where the program ends in spite of it.
const MOMENT: Duration = Duration::from_millis(50);

/// Begins to watch, on a thread of its own.
pub(super) fn watch() -> io::Result<()> {
    start_thread("saoms-hang", look_for_ever).map(drop)
}

fn look_for_ever() {
    let mut since: Vec<(u64, Duration)> = Vec::new();
    let mut told = HashSet::new();
    loop {
        thread::sleep(LOOK);
        let calls = everywhere();
        since.resize(calls.len(), (u64::MAX, Duration::ZERO));
        let mut begins = false;
        for (thread, (call, since)) in calls.into_iter().zip(&mut since).enumerate() {
            let (number, present) = call;
            *since = if since.0 == number { (number, since.1 + LOOK) } else { (number, Duration::ZERO) };
            let Some((owner, function)) = present.filter(|(_, function)| function.holds_up()) else { continue };
            begins |= since.1 < PATIENCE && function.is_looked_after();
            if since.1 >= PATIENCE && told.insert((thread, number)) {
                eprint(&format!("warning: {}\n", waits(owner, function)));
            }
        }
        // What code does that begins is looked at when it returns, which names its component, too.
        if !begins {
            super::look_again();
        }
    }
}

fn waits(owner: &Owner, function: Function) -> String {
    format!("the program waits for {} of {}, which has not returned", function.name(), owner.text)
}

/// What the program waits for now, if it is code of a library; for the message of a program that ends in spite of it.
/// An execution that goes on in the meantime is named, too: a run that ends waits for it.
pub(crate) fn waited_for() -> Option<String> {
    let told = |(owner, function)| Some(waits(owner, function));
    let before = everywhere();
    let calls = before.iter().filter_map(|(_, call)| *call);
    if let Some((owner, function)) = calls.clone().find(|(_, function)| function.holds_up()) {
        return told((owner, function));
    }
    calls.clone().next()?;
    thread::sleep(MOMENT);
    let after = everywhere();
    let lasts = before.iter().zip(&after).find(|((number, _), (now, call))| number == now && call.is_some());
    lasts.and_then(|(_, (_, call))| *call).and_then(told)
}
