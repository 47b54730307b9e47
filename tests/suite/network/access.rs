//! Access of users to topics.

use std::sync::Arc;

use super::certificates::write_private;
use super::nodes::at_node;
use super::passwords::{BROKER, broker, numbers};
use super::programs::{Program, Programs, Transport, component};
use crate::boundary::build;

#[test]
fn users_reach_the_topics_that_they_may_and_are_told_of_others() {
    let programs = Programs::over(Transport::Zenoh);
    let url = programs.url(programs.port);
    write_private(&programs.folder().join("users"), "sends:one\nreads:two\nguest:three\n");
    let broker =
        broker(&programs, &[("users", "users"), ("access", "sends: writes NUMBERS, PRESENT; reads NUMBERS, PRESENT")]);
    programs.until(&broker, "listens at");
    let outside = numbers(&programs, "reader-guest", &url, &[("user", "guest"), ("password", "three")]);
    let said = format!(
        "component `reader-guest` may not read topic `NUMBERS` of the network `{url}` as user `guest`: nothing of it \
         passes the broker"
    );
    programs.until(&outside, &said);
    let reader = numbers(&programs, "reader", &url, &[("user", "sends"), ("password", "one")]);
    programs.until(&reader, "program `broker` is on the network");
    let given = [("user", "guest"), ("password", "three"), ("readers", "0")];
    let intruder = numbers(&programs, "sender-guest", &url, &given);
    programs.until(&intruder, "component `sender-guest` may not publish on topic `NUMBERS`");
    let sender = numbers(&programs, "sender", &url, &[("user", "sends"), ("password", "one")]);
    programs.until(&reader, "has received 1 to 200 of sender");
    for program in [&outside, &intruder, &reader, &sender] {
        programs.stop(program);
    }
    assert!(!outside.printed().contains("has received"), "{}", outside.printed());
    assert!(!reader.printed().contains("of sender-guest"), "{}", reader.printed());
    programs.end_without(&broker, &["panicked"]);
}

/// Writes a fleet of which one node sends numbers and calls, and the other one reads and is called.
fn write_nodes(programs: &Programs) {
    let port = programs.port.to_string();
    let access = "client: runs client</value><value>server: runs server</value><value>viewer: reads NUMBERS";
    let access = format!("<property name=\"access\"><value>{access}</value></property></component>");
    let broker = component("Broker", BROKER, &[("IP", "127.0.0.1"), ("port", &port), ("users", "users")]);
    let task = |name: &str, class: &str, more: &[(&str, &str)], end: &str| {
        let own = component(name, class, &[&[("ID", name), ("period", "50")], more].concat());
        let given = ["url", "user", "password"].map(|name| format!("<property name=\"{name}\" source=\"${name}\"/>"));
        own.replacen("</component>", &format!("{}{end}</component>", given.concat()), 1)
    };
    let wire = "<reference name=\"counter\" target=\"Tally\"/>";
    let components = broker.replacen("</component>", &access, 1)
        + &at_node("client", task("Caller", "calls.Caller", &[("calls", "50")], wire))
        + &at_node("client", task("Sender", "numbers.Sender", &[("count", "200"), ("each", "20")], ""))
        + &at_node("server", component("Tally", "calls.Tally", &[]))
        + &at_node("server", task("Reader", "numbers.Reader", &[("count", "200")], ""));
    let url = programs.url(programs.port);
    let properties = [("url", url.as_str()), ("user", ""), ("password", "")]
        .map(|(name, value)| format!("<property name=\"{name}\" type=\"xsd:string\">{value}</property>\n"));
    let properties = properties.concat();
    programs.write(
        "fleet.composite",
        &format!(
            "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:s=\"urn:saoms:1\" \
             xmlns:xsd=\"http://www.w3.org/2001/XMLSchema\" targetNamespace=\"urn:fleet\" name=\"fleet\" \
             s:defaultNode=\"broker\">\n{properties}{components}</composite>\n"
        ),
    );
}

/// Starts a node as a user.
fn start_as(programs: &Programs, node: &str, user: &str, password: &str) -> Arc<Program> {
    let library = build::library("calls");
    let (user, password) = (format!("user={user}"), format!("password={password}"));
    let fleet = ["run", "fleet.composite", "--node", node, "--plugin", library.to_str().unwrap()];
    programs.run(node, &[&fleet[..], &["--set", &user, "--set", &password]].concat())
}

#[test]
fn a_user_may_do_what_the_components_of_its_node_do() {
    let programs = Programs::over(Transport::Zenoh);
    write_private(&programs.folder().join("users"), "client:one\nserver:two\nviewer:three\n");
    write_nodes(&programs);
    let broker = start_as(&programs, "broker", "client", "one");
    programs.until(&broker, "listens at");
    // Another machine than the one whose node it runs.
    let (server, wrong) =
        (start_as(&programs, "server", "server", "two"), start_as(&programs, "client", "viewer", "three"));
    let refused = "may not call components of other programs over the network";
    for said in ["component `Sender` may not read topic `PRESENT`", refused] {
        programs.until(&wrong, said);
    }
    programs.stop(&wrong);
    programs.stop(&server);
    assert!(!server.printed().contains("has received"), "{}", programs.printed());
    let server = start_as(&programs, "server", "server", "two");
    let client = start_as(&programs, "client", "client", "one");
    programs.until(&client, "made 50 calls, 50 were answered");
    programs.until(&server, "has received 1 to 200 of Sender");
    for program in [&client, &server] {
        programs.stop(program);
        assert!(!program.printed().contains("may not"), "{}", programs.printed());
    }
    programs.end_without(&broker, &["panicked"]);
}
