//! Names that no property of a periodic class may have: its task has properties of these names. `ID` is not among them:
//! a class may read the name of its task.

use super::contains;

macro_rules! reserved {
    ($($name:literal),* $(,)?) => {
        /// The names of the properties of tasks, and of those that tasks are to have.
        pub const RESERVED: &[&str] = &[$($name),*];

        const MESSAGES: &[&str] = &[$(concat!(
            "`", $name, "` is reserved for the task of a periodic component, and cannot be a property of the class: rename the \
             field, or give the property another name with `#[property(name = \"...\")]`"
        )),*];
    };
}

reserved! {
    "period", "delay", "runOnStartup", "mayInterruptIfRunning", "useJMS", "url", "user", "password",
    "topicRename", "overrun", "restart", "restartBackoff", "restartLimit", "deadline", "queue", "loss", "trigger",
    "minimum", "node", "passwordFile", "tlsCa", "tlsCertificate", "tlsKey",
}

/// Refuses the properties of a periodic class if one has such a name. Runs at compile time.
///
/// # Panics
/// One has.
#[expect(clippy::panic, reason = "it ends the compilation, with the message as the error")]
pub const fn refuse_reserved(names: &[&str]) {
    let mut at = 0;
    while at < RESERVED.len() {
        if contains(names, RESERVED[at]) {
            panic!("{}", MESSAGES[at]);
        }
        at += 1;
    }
}
