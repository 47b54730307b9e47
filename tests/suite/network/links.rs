//! A link to other programs that is lost: what a person is told, and what the composite chose for it.

use std::sync::Arc;

use super::programs::{Program, Programs, on_network};

/// Starts a robot on the network, with this effect of a lost link.
pub(super) fn robot(programs: &Programs, name: &str, effect: &str) -> Arc<Program> {
    let url = programs.url(programs.port);
    let number = name.trim_start_matches("Robot");
    let robot = on_network(&url, &[], &[(name, "saoms.Robot", &[("number", number)])]);
    programs.write(
        &format!("{name}.composite"),
        &format!(
            "<composite xmlns=\"http://www.osoa.org/xmlns/sca/1.0\" xmlns:s=\"urn:saoms:1\" targetNamespace=\"http://f\" \
             name=\"{name}\" {effect}>\n{robot}</composite>\n"
        ),
    );
    programs.run(name, &["run", &format!("{name}.composite"), "--stay"])
}

#[test]
fn a_lost_link_leads_to_what_the_composite_says() {
    let programs = Programs::new();
    let broker = programs.broker();
    let goes_on = robot(&programs, "Robot1", "");
    let holds = robot(&programs, "Robot2", "s:lostLink=\"hold\"");
    let ends = robot(&programs, "Robot3", "s:lostLink=\"end\"");
    for program in [&goes_on, &holds, &ends] {
        programs.until(program, "program `broker` is on the network");
    }
    broker.kill();
    let lost = format!("the link to the network `{}` is lost", programs.url(programs.port));
    for program in [&goes_on, &holds, &ends] {
        programs.until(program, &lost);
    }
    programs.until(&holds, "all that moves is stopped until `saoms release`");
    programs.until(&holds, "emergency stop");
    programs.ends(&ends, 130);
    assert!(!goes_on.printed().contains("all that moves is stopped"), "{}", programs.printed());
    let again = programs.broker();
    for program in [&goes_on, &holds] {
        programs.until(program, "the link to the network is there");
        programs.stop(program);
    }
    programs.end(&again);
}
