//! Networks whose transport is not there.

use std::fs;
use std::process::Command;
use std::sync::Arc;

use super::programs::{Program, Programs, Transport, component, on_network};
use crate::boundary::build;
use crate::support::PROGRAM;

/// The command where no library is beside it, with a composite of these components.
fn alone(programs: &Programs, name: &str, components: &str) -> Arc<Program> {
    let folder = programs.folder().join("bin");
    fs::create_dir_all(&folder).unwrap();
    let copied = folder.join("saoms");
    if !copied.exists() {
        fs::copy(PROGRAM, &copied).unwrap();
    }
    let composite = format!(
        "<composite xmlns=\"http://www.osoa.org/xmlns/sca/1.0\" targetNamespace=\"http://launch\" \
         name=\"{name}\">\n{components}</composite>\n"
    );
    programs.write(&format!("{name}.composite"), &composite);
    let mut run = Command::new(copied);
    run.args(["run", &format!("{name}.composite"), "--control", "none", "--plugin"]).arg(build::library("numbers"));
    programs.other(name, run)
}

#[test]
fn a_url_of_an_unknown_scheme_is_told_at_its_place() {
    let programs = Programs::new();
    let url = format!("rely://127.0.0.1:{}", programs.port);
    let sender = [("Sender1", "numbers.Sender", &[("count", "10"), ("each", "1")][..])];
    let program = programs.start("tasks", &on_network(&url, &[], &sender));
    programs.ends(&program, 2);
    let printed = program.printed();
    let said = format!(
        "error[S4031]: component `Sender1` is on the network `{url}`, but there is no transport for urls with \
         `rely://`; those that were found serve"
    );
    for text in [&*said, "--> tasks.composite:2:", "`relay://`", "1 error: nothing was started"] {
        assert!(printed.contains(text), "{text}\n{printed}");
    }
}

#[test]
fn a_missing_library_is_told_with_how_to_get_it() {
    let programs = Programs::over(Transport::Zenoh);
    let sender = [("Sender1", "numbers.Sender", &[("count", "10"), ("each", "1")][..])];
    let url = programs.url(programs.port);
    let program = alone(&programs, "tasks", &on_network(&url, &[], &sender));
    programs.ends(&program, 2);
    let printed = program.printed();
    let how = "`cargo build --release -p saoms-zenoh` makes the one for `host:port` and `tls://`, `libsaoms_zenoh.so`";
    for text in ["error[S4031]", "there is no transport for urls such as `host:port`", how, "--> tasks.composite:2:"] {
        assert!(printed.contains(text), "{text}\n{printed}");
    }
}

#[test]
fn without_the_library_a_fleet_with_its_broker_runs_inside_its_program() {
    let programs = Programs::over(Transport::Zenoh);
    let url = programs.url(programs.port);
    let tasks: [(_, _, &[_]); 2] = [
        ("Sender1", "numbers.Sender", &[("count", "10"), ("each", "1")]),
        ("Reader", "numbers.Reader", &[("count", "10")]),
    ];
    let address = [("IP", "127.0.0.1"), ("port", &programs.port.to_string())];
    let broker = component("Broker", "unibg.robotics.tca.MessageBrokerImpl", &address);
    let program = alone(&programs, "fleet", &(broker + &on_network(&url, &[], &tasks)));
    programs.ends(&program, 0);
    let printed = program.printed();
    assert!(printed.contains("has received 1 to 10 of Sender1"), "{printed}");
    let said = format!("the topics of `{url}` are served inside this program, and no other program can join them");
    assert_eq!(printed.matches(&said).count(), 1, "{printed}");
}
