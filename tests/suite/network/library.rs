//! Networks whose transport is not there.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;

use super::programs::{Program, Programs, Transport, component, on_network};
use crate::boundary::build;
use crate::plugins::library;
use crate::support::{PROGRAM, text};

/// The command where no library is beside it, with a composite of these components.
fn alone(programs: &Programs, name: &str, components: &str) -> Arc<Program> {
    alone_with(programs, name, components, &[])
}

/// The same, with these libraries beside that of the components.
fn alone_with(programs: &Programs, name: &str, components: &str, libraries: &[&Path]) -> Arc<Program> {
    let folder = programs.folder().join("bin");
    fs::create_dir_all(&folder).unwrap();
    let copied = folder.join("saoms");
    if !copied.exists() {
        fs::copy(PROGRAM, &copied).unwrap();
    }
    let file = programs.write_composite(name, components);
    let mut run = Command::new(copied);
    run.args(["run", &file, "--control", "none", "--plugin"]).arg(build::library("numbers"));
    for library in libraries {
        run.arg("--plugin").arg(library);
    }
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
    // Where the command looks, which is not where it is built.
    let how = format!(
        "`cargo build --release -p saoms-zenoh` makes the one for `host:port` and `tls://`, `libsaoms_zenoh.so`, in \
         `target/release`; copy it to `{}`, or name it with `--plugin`",
        programs.folder().canonicalize().unwrap().join("lib/saoms").display()
    );
    for text in ["error[S4031]", "there is no transport for urls such as `host:port`", &how, "--> tasks.composite:2:"] {
        assert!(printed.contains(text), "{text}\n{printed}");
    }
    assert!(version(&programs).ends_with(" of the boundary, none was found\n"), "{}", version(&programs));
}

/// What the command says there of its build.
fn version(programs: &Programs) -> String {
    text(&Command::new(programs.folder().join("bin/saoms")).arg("--version").output().unwrap())
}

/// As packages have it: the command in `bin`, and the library in `lib/saoms`.
#[test]
fn a_library_is_found_where_packages_have_it() {
    let programs = Programs::over(Transport::Zenoh);
    let folder = programs.folder().join("lib/saoms");
    fs::create_dir_all(&folder).unwrap();
    fs::copy(library("saoms_zenoh"), folder.join("libsaoms_zenoh.so")).unwrap();
    let (url, port) = (programs.url(programs.port), programs.port.to_string());
    let address = [("IP", "127.0.0.1"), ("port", &*port)];
    let broker = alone(&programs, "broker", &component("Broker", "saoms.MessageBroker", &address));
    programs.until(&broker, &format!("the program listens at `{url}`"));
    let reader = [("Reader", "numbers.Reader", &[("count", "10")][..])];
    let reader = alone(&programs, "reader", &on_network(&url, &[], &reader));
    let sender = [("Sender1", "numbers.Sender", &[("count", "10"), ("each", "1")][..])];
    let sender = alone(&programs, "sender", &on_network(&url, &[], &sender));
    programs.until(&reader, "has received 1 to 10 of Sender1");
    for program in [&reader, &sender] {
        programs.ends(program, 0);
    }
    programs.end(&broker);
    assert!(version(&programs).contains(" of the boundary, `host:port`, "), "{}", version(&programs));
}

#[test]
fn a_library_of_another_version_of_the_boundary_is_told() {
    let programs = Programs::new();
    let bytes = fs::read(library("saoms_relay")).unwrap();
    let (own, other) = (b"{\"saoms\":\"transport\",\"abi\":1,", b"{\"saoms\":\"transport\",\"abi\":9,");
    let places: Vec<usize> =
        bytes.windows(own.len()).enumerate().filter(|(_, part)| part == own).map(|it| it.0).collect();
    assert!(!places.is_empty());
    let mut changed = bytes;
    places.iter().for_each(|place| changed[*place..][..other.len()].copy_from_slice(other));
    let path = programs.folder().join("libother.so");
    fs::write(&path, changed).unwrap();
    let sender = [("Sender1", "numbers.Sender", &[("count", "10"), ("each", "1")][..])];
    let url = programs.url(programs.port);
    let program = alone_with(&programs, "tasks", &on_network(&url, &[], &sender), &[&path]);
    programs.ends(&program, 2);
    let printed = program.printed();
    let said = format!(
        "transport `{}` was built for version 9 of the boundary, this program has version 1: build it again",
        path.display()
    );
    for text in ["error[S4031]", &said, "--> tasks.composite:2:"] {
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
