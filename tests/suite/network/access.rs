//! Access of users to topics.

use super::certificates::write_private;
use super::passwords::{broker, numbers};
use super::programs::{Programs, Transport};

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
