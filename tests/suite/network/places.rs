//! Messages with a place go to the programs whose readers are around it.

use super::programs::{Programs, Transport};
use super::proxy::{Line, Proxy};

/// A walker goes from one that stands to another one, far away, who says a lot: each of them hears it while it is near,
/// and nobody hears who is far away.
#[track_caller]
fn walkers_hear_who_is_near(transport: Transport) {
    let programs = Programs::over(transport);
    let broker = programs.broker();
    programs.until(&broker, "listens at");
    let proxy = Proxy::to(programs.port, Line::default());
    let walker = |name, port, from: &str, to: &str, size: &str| {
        programs.tasks(name, port, &[(name, "numbers.Walker", &[("from", from), ("to", to), ("size", size)])])
    };
    let near = walker("near", proxy.port, "10", "10", "0");
    let far = walker("far", programs.port, "100", "100", "65536");
    let walks = walker("walks", programs.port, "0", "100", "0");
    for program in [&near, &far, &walks] {
        programs.until(program, "has joined the network at");
    }
    let starter = programs.tasks("starter", programs.port, &[("starter", "numbers.Starter", &[])]);
    programs.until(&near, "meets walks at");
    programs.until(&walks, "meets near at 10");
    programs.until(&near, "hears walks no more");
    let before = proxy.received();
    programs.until(&far, "meets walks at");
    programs.until(&walks, "meets far at 100");
    // Meanwhile that one has said some five megabytes.
    let bytes = proxy.received() - before;
    assert!(bytes < 1_000_000, "{bytes}\n{}", programs.printed());
    for program in [&near, &far] {
        let printed = program.printed();
        assert_eq!(printed.matches("meets").count(), 1, "{printed}");
    }
    for program in [&near, &far, &walks, &starter] {
        programs.stop(program);
    }
    programs.end(&broker);
}

#[test]
fn a_program_hears_what_is_around_its_readers() {
    walkers_hear_who_is_near(Transport::Relay);
}

#[test]
fn a_program_hears_what_is_around_its_readers_over_zenoh_too() {
    walkers_hear_who_is_near(Transport::Zenoh);
}
