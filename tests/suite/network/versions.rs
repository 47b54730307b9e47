//! Programs that were built from different versions.

use super::programs::{Programs, on_network};
use crate::boundary::build;
use crate::plugins::library;
use crate::support::command;

#[test]
fn messages_of_another_form_are_told_once_with_both_ends() {
    let programs = Programs::new();
    let broker = programs.broker();
    let url = programs.url(programs.port);
    let reader = [("Reader", "numbers.Reader", &[("count", "50")][..])];
    let reader = programs.tasks("reader", programs.port, &reader);
    // The same class, from a library with another form of the message.
    let sender = [("Sender1", "numbers.Sender", &[("count", "50"), ("each", "5")][..])];
    let file = programs.write_composite("sender", &on_network(&url, &[], &sender));
    let mut run = command(&["run", &file, "--control", "none"]);
    for library in [library("saoms_relay"), build::library("numbers_other")] {
        run.arg("--plugin").arg(library);
    }
    let sender = programs.other("sender", run);
    programs.until(&sender, "has sent 1 to 50");
    let said = format!(
        "component `Sender1` of program `sender` sends other messages on topic `NUMBERS` of the network `{url}` than \
         component `Reader` of this program, `reader`, reads there: they are ignored; build both programs from one version"
    );
    programs.until(&reader, &said);
    for program in [&sender, &reader] {
        programs.stop(program);
    }
    assert_eq!(programs.printed().matches("sends other messages").count(), 1, "{}", programs.printed());
    assert!(!reader.printed().contains("has received"), "{}", reader.printed());
    programs.end(&broker);
}
