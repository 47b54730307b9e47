//! Two ends of one topic.

use expect_test::expect;

use crate::check::support::faults;

fn task(name: &str, class: &str, rename: &str) -> String {
    format!(
        r#"<component name="{name}"><implementation.java class="example.{class}"/><property name="ID">{name}</property><property name="period">100</property>
<property name="topicRename">{rename}</property></component>
"#
    )
}

#[test]
fn ends_agree_in_kind_and_schema() {
    let robots = task("A", "Robot001", "") + &task("B", "Robot001", "");
    assert_eq!(faults(&robots), "");
    expect![[r#"
        6:18-19 error S4009: component `S` publishes topic `POSTOPIC` as an event topic, and component `A` as a state topic
          2:18-19 publishes it as a state topic
          help: a topic has one kind and one type of messages for all components; give one of them another topic with `topicRename`
    "#]]
        .assert_eq(&faults(&(robots.clone() + &task("S", "Shouter", "") + &task("S2", "Shouter", ""))));
    assert_eq!(faults(&(robots.clone() + &task("S", "Shouter", "POSTOPIC,shouts"))), "");
    expect![[r#"
        7:37-45 error S4009: component `T` publishes topic `POSTOPIC` as `Position`, and component `A` as `Position` with other fields
          2:18-19 publishes it as `Position` with other fields
          help: a topic has one kind and one type of messages for all components; give one of them another topic with `topicRename`
    "#]].assert_eq(&faults(&(robots.clone() + &task("T", "Tracker", "TRACKS,POSTOPIC"))));
    expect![[r#"
        3:49-50 error S4009: component `A` subscribes to topic `x` as an event topic, and itself as a state topic
          3:39-40 publishes it as a state topic
          help: a topic has one kind and one type of messages for all components; give one of them another topic with `topicRename`
    "#]]
    .assert_eq(&faults(&task("A", "Robot001", "POSTOPIC,x::ORDERS,x")));
}

#[test]
fn a_topic_that_is_published_and_subscribed_is_told_once() {
    let both = task("S", "Shouter", "") + &task("A", "Robot001", "");
    assert_eq!(faults(&both).matches(" error ").count(), 1, "{}", faults(&both));
}
