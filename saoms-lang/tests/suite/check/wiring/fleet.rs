//! The wiring of a fleet as a whole.

use expect_test::expect;
use saoms_lang::project::Project;

use crate::check::support::{compiled, part, told};

fn found(inside: &str) -> String {
    let text = part("fleet", "xmlns:saoms=\"urn:saoms:1\"", inside);
    let project = Project::new().in_memory().text("fleet.composite", text).wiring(true);
    let (_, diagnostics, sources) = compiled(&project);
    told(&diagnostics, &sources)
}

/// Components in a line each.
fn fleet(components: &[(&str, &str, &str)]) -> String {
    let one = |(name, class, properties): &(&str, &str, &str)| {
        let period = if properties.contains("period") { "" } else { "<property name=\"period\">100</property>" };
        let count = if name.contains('$') { "saoms:count=\"400\"" } else { "" };
        format!(
            "<component name=\"{name}\" {count}><implementation.java class=\"example.{class}\"/><property name=\"ID\">{name}</property>{period}{properties}</component>\n"
        )
    };
    components.iter().map(one).collect()
}

fn period(text: &str) -> String {
    format!("<property name=\"period\">{text}</property>")
}

fn rename(text: &str) -> String {
    format!("<property name=\"topicRename\">{text}</property>")
}

#[test]
fn both_ends_of_a_topic_are_asked_for() {
    expect![""].assert_eq(&found(&fleet(&[("D", "Dispatcher", ""), ("P", "Picker", "")])));
    expect![[r#"
        2:18-19 note S4010: component `D` publishes topic `ORDERS`, which no component reads
          help: it is an event topic of `Order`
        3:18-20 note S4010: component `T1` and another one publish topic `TRACKS`, which no component reads
          help: it is a state topic of `Position`
    "#]]
    .assert_eq(&found(&fleet(&[("D", "Dispatcher", ""), ("T1", "Tracker", ""), ("T2", "Tracker", "")])));
    expect![[r#"
        2:18-19 warning S4011: component `P` and 2 others read topic `ORDERS`, which no component publishes
          help: it is an event topic of `Order`
    "#]]
    .assert_eq(&found(&fleet(&[("P", "Picker", ""), ("Q", "Picker", ""), ("R", "Picker", "")])));
}

#[test]
fn names_that_are_nearly_the_same_are_told_together() {
    expect![[r#"
        2:177-182 warning S4012: component `D` publishes topic `oders`, which no component reads: there is `orders`
          3:174-180 reads `orders`
          fix: replace `oders` with `orders` [2:177-182 "orders"]
    "#]]
    .assert_eq(&found(&fleet(&[
        ("D", "Dispatcher", &rename("ORDERS,oders")),
        ("P", "Picker", &rename("ORDERS, orders")),
        ("E", "Dispatcher", &rename("ORDERS,orders")),
    ])));
    expect![[r#"
        2:18-19 warning S4012: component `D` publishes topic `ORDERS`, which no component reads: there is `orders`
          3:173-179 reads `orders`
          help: connect the two topics with `topicRename`
    "#]]
    .assert_eq(&found(&fleet(&[("D", "Dispatcher", ""), ("P", "Picker", &rename("ORDERS,orders"))])));
    expect![[r#"
        4:174-179 note S4010: component `T` publishes topic `ORDER`, which no component reads
          help: it is a state topic of `Position`
    "#]]
    .assert_eq(&found(&fleet(&[
        ("D", "Dispatcher", ""),
        ("P", "Picker", ""),
        ("T", "Tracker", &rename("TRACKS,ORDER")),
    ])));
}

/// A class at both ends of a topic has both ends wherever a slip takes it.
#[test]
fn who_talks_to_itself_on_nearly_the_topic_of_others_is_told() {
    let number = |number: &str| format!("<property name=\"number\">{number}</property>");
    let found = |new: &str| {
        let first = format!("{}{}", number("1"), rename(&format!("POSTOPIC,{new}")));
        let (second, third) = (number("2"), number("3"));
        let all = [("A", "Robot", &*first), ("B", "Robot", &*second), ("C", "Robot", &*third), ("D", "Dispatcher", "")];
        found(&fleet(&all))
    };
    expect![[r#"
        2:210-219 warning S4012: component `A` receives only its own messages on topic `postopics`: others use `POSTOPIC`
          3:18-19 uses `POSTOPIC`
          help: correct `topicRename`: remove a pair, or change its new name
    "#]]
    .assert_eq(&found("postopics"));
    expect![""].assert_eq(&found("elsewhere"));
}

/// Users of a slip of the name that others have without renaming, however many they are on either side.
#[test]
fn parts_of_a_fleet_that_a_slip_keeps_apart_are_told() {
    let found = |new: &[&str]| {
        let robot = |(number, new): (usize, &&str)| {
            let new = if new.is_empty() { String::new() } else { rename(&format!("POSTOPIC,{new}")) };
            (format!("R{number}"), format!("<property name=\"number\">{}</property>{new}", number + 1))
        };
        let robots: Vec<_> = new.iter().enumerate().map(robot).collect();
        let mut all: Vec<_> =
            robots.iter().map(|(name, properties)| (name.as_str(), "Robot", properties.as_str())).collect();
        all.push(("D", "Dispatcher", ""));
        found(&fleet(&all))
    };
    expect![[r#"
        2:212-219 warning S4012: component `R0` receives only its own messages on topic `POSTOPC`: others use `POSTOPIC`
          3:18-20 uses `POSTOPIC`
          help: correct `topicRename`: remove a pair, or change its new name
    "#]]
    .assert_eq(&found(&["POSTOPC", ""]));
    expect![""].assert_eq(&found(&["HALL_1", "HALL_1", "HALL_2"]));
    expect![""].assert_eq(&found(&["HALL_1", "HALL_2", "HALL_2"]));
    expect![[r#"
        2:212-219 warning S4012: component `R0` and another one receive only their own messages on topic `POSTOPC`: others use `POSTOPIC`
          4:18-20 uses `POSTOPIC`
          help: correct `topicRename`: remove a pair, or change its new name
    "#]].assert_eq(&found(&["POSTOPC", "POSTOPC", "", ""]));
    expect![[r#"
        2:212-220 warning S4012: component `R0` and another one receive only their own messages on topic `postopic`: others use `POSTOPIC`
          4:18-20 uses `POSTOPIC`
          help: correct `topicRename`: remove a pair, or change its new name
    "#]].assert_eq(&found(&["postopic", "postopic", "", ""]));
    // Halls of one file, kept apart.
    expect![""].assert_eq(&found(&["POSTOPIC2", "POSTOPIC2", "", ""]));
    expect![""].assert_eq(&found(&["POSTOPIC_B", "POSTOPIC_B", "", ""]));
    expect![""].assert_eq(&found(&["HALLA", "HALLA", "HALLB", "HALLB"]));
}

#[test]
fn queues_have_room_for_what_can_come_between_two_executions() {
    let slow = |queue: &str| format!("{}<property name=\"queue\">{queue}</property>", period("1001"));
    let both = |properties: &str| found(&fleet(&[("D", "Dispatcher", ""), ("P", "Picker", properties)]));
    expect![""].assert_eq(&both(&slow("11")));
    expect![[r#"
        3:161-163 note S4013: up to 11 messages of topic `ORDERS` can arrive between two executions of component `P`, and the queue holds 10
          help: component `D` publishes it: this is the case if each sends one message per execution; usually there are fewer
          help: if a run reports lost messages, give the readers a `queue` of 11, or a shorter `period`
    "#]].assert_eq(&both(&slow("10")));
    expect![""].assert_eq(&both(&format!("{}<property name=\"loss\">accept</property>", slow("10"))));
    // Of those with the same period, each queue by itself.
    let pickers = [("P", slow("1")), ("Q", period("1001")), ("R", slow("1")), ("S", slow("2"))];
    let mut all = vec![("D", "Dispatcher", "")];
    all.extend(pickers.iter().map(|(name, properties)| (*name, "Picker", properties.as_str())));
    expect![[r#"
        3:161-162 note S4013: up to 11 messages of topic `ORDERS` can arrive between two executions of component `P` and another one, and the queue holds 1
          help: component `D` publishes it: this is the case if each sends one message per execution; usually there are fewer
          help: if a run reports lost messages, give the readers a `queue` of 11, or a shorter `period`
        6:161-162 note S4013: up to 11 messages of topic `ORDERS` can arrive between two executions of component `S`, and the queue holds 2
          help: component `D` publishes it: this is the case if each sends one message per execution; usually there are fewer
          help: if a run reports lost messages, give the readers a `queue` of 11, or a shorter `period`
    "#]].assert_eq(&found(&fleet(&all)));
    expect![[r#"
        3:193-197 note S4013: up to 1200 messages of topic `ORDERS` can arrive between two executions of component `P1` and 399 others, and the queue holds 1024
          help: component `D1` and 399 others publish it: this is the case if each sends one message per execution; usually there are fewer
          help: if a run reports lost messages, give the readers a `queue` of 1200, or a shorter `period`
    "#]].assert_eq(&found(&fleet(&[
        ("D${index}", "Dispatcher", ""),
        ("P${index}", "Picker", &format!("{}<property name=\"queue\">1024</property>", period("300"))),
    ])));
    // Queues whose length nobody gave grow with the components that use the topic.
    expect![""].assert_eq(&found(&fleet(&[("D${index}", "Dispatcher", ""), ("P${index}", "Picker", &period("300"))])));
}

#[test]
fn readers_in_a_hurry_are_told_once_for_each_period() {
    expect![[r#"
        3:18-19 note S4014: component `P` and another one read topic `ORDERS` every 50ms, but no component publishes it more often than every 100ms
          help: some of its executions receive nothing new
        5:18-19 note S4014: component `R` reads topic `ORDERS` every 20ms, but no component publishes it more often than every 100ms
          help: some of its executions receive nothing new
    "#]].assert_eq(&found(&fleet(&[
        ("D", "Dispatcher", ""),
        ("P", "Picker", &period("50")),
        ("Q", "Picker", &period("50")),
        ("R", "Picker", &period("20")),
    ])));
}
