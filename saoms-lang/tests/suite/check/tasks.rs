//! Task properties.

use expect_test::expect;

use crate::check::support::faults;

fn robot(inside: &str) -> String {
    faults(&format!(
        r#"<component name="R"><implementation.java class="example.Robot001"/><property name="ID">R</property><property name="period">100</property>
{inside}</component>"#
    ))
}

#[test]
fn topic_renames() {
    let rename = |text: &str| robot(&format!(r#"<property name="topicRename">{text}</property>"#));
    for right in ["POSTOPIC,pos", " POSTOPIC , pos :: ORDERS , o ", "POSTOPIC::pos", " "] {
        assert_eq!(rename(right), "", "{right}");
    }
    let all: String = [
        "POSTOPIC",
        "POSTOPIC,",
        "POSTOPIC,a,b",
        "POSTOPIC,a::ORDERS",
        "POSTOPIC,a::",
        "A::B::C",
        ",",
        "POSTOPIC,a::POSTOPIC,b",
        "POSTOPIC,ORDERS::ORDERS,c",
        "POSTOPIC,POSTOPIC",
        "POSTOPIC,a:ORDERS,b",
        "POSTOPC, pos001::POS002, pos002",
        "&#80;OSTOPIC,a::POSTOPIC,b",
    ]
    .map(|text| format!("{text}\n{}", rename(text)))
    .concat();
    expect![[r#"
        POSTOPIC
        3:30-38 error S4002: property `topicRename`: found one name in `POSTOPIC`, expected a pair `OLD,new`
          help: write `OLD,new` for each topic, and `::` between two of them
        POSTOPIC,
        3:30-39 error S4002: property `topicRename`: found one name in `POSTOPIC,`, expected a pair `OLD,new`
          help: write `OLD,new` for each topic, and `::` between two of them
        POSTOPIC,a,b
        3:30-42 error S4002: property `topicRename`: found 3 names, expected a pair `OLD,new`
          help: write `OLD,new` for each topic, and `::` between two of them
        POSTOPIC,a::ORDERS
        3:42-48 error S4002: property `topicRename`: found one name in `ORDERS`, expected a pair `OLD,new`
          help: write `OLD,new` for each topic, and `::` between two of them
        POSTOPIC,a::
        3:42-42 error S4002: property `topicRename`: found no names, expected a pair `OLD,new`
          help: write `OLD,new` for each topic, and `::` between two of them
        A::B::C
        3:30-37 error S4002: property `topicRename`: found 3 names, expected a pair `OLD,new`
          help: write `OLD,new` for each topic, and `::` between two of them
        ,
        3:30-31 error S4002: property `topicRename`: found no names, expected a pair `OLD,new`
          help: write `OLD,new` for each topic, and `::` between two of them
        POSTOPIC,a::POSTOPIC,b
        3:42-50 error S4002: property `topicRename`: topic `POSTOPIC` is renamed twice
          3:30-38 first renamed here
        POSTOPIC,ORDERS::ORDERS,c
        3:39-45 error S4002: property `topicRename`: a chain: `POSTOPIC` is renamed to `ORDERS`, and `ORDERS` to `c`
          3:47-53 renamed again here
        POSTOPIC,POSTOPIC
        3:39-47 error S4002: property `topicRename`: topic `POSTOPIC` is renamed to its own name
          help: write `OLD,new` for each topic, and `::` between two of them
        POSTOPIC,a:ORDERS,b
        3:30-49 error S4002: property `topicRename`: found 3 names, expected a pair `OLD,new`
          help: write `OLD,new` for each topic, and `::` between two of them
          fix: replace `POSTOPIC,a:ORDERS,b` with `POSTOPIC,a::ORDERS,b` [3:30-49 "POSTOPIC,a::ORDERS,b"]
        POSTOPC, pos001::POS002, pos002
        3:30-37 warning S4003: class `example.Robot001` uses no topic `POSTOPC`: nothing is renamed
          fix: replace `POSTOPC` with `POSTOPIC` [3:30-37 "POSTOPIC"]
        3:47-53 warning S4003: class `example.Robot001` uses no topic `POS002`: nothing is renamed
          help: topics that keep their names are `ORDERS` and `POSTOPIC`
        &#80;OSTOPIC,a::POSTOPIC,b
        3:46-54 error S4002: property `topicRename`: topic `POSTOPIC` is renamed twice
          3:30-42 first renamed here
    "#]]
    .assert_eq(&all);
}

#[test]
fn lists_of_peers() {
    let url = |text: &str| robot(&format!(r#"<property name="url">{text}</property>"#));
    for right in ["peers://a=localhost:1,b=localhost:2", "peers://a=[::1]:1,b=127.0.0.1:1,c.d=localhost:7"] {
        assert_eq!(url(right), "", "{right}");
    }
    let all: String = [
        "peers://",
        "peers://a=localhost:1",
        "peers://a=localhost:1,localhost:2",
        "peers://a=localhost:1,=localhost:2",
        "peers://a=localhost:1,b=localhost",
        "peers://a=localhost:1,b=localhost:2,",
        "peers://a=localhost:1,a=localhost:2",
        "peers://a=localhost:1,b=localhost:1",
        "peers://a=localhost:1,b=tls://localhost:2",
        "peers://a=localhost:1,b=10.0.0.1:2",
        "peers+tls://a=localhost:1,b=10.0.0.1:2",
    ]
    .map(|text| format!("{text}\n{}", url(text)))
    .concat();
    expect![[r#"
        peers://
        3:30-30 error S4005: `peers://` is not a list of peers: each peer has a name before `=`, and its address behind it
          help: write each as `NAME=host:port`, such as `peers://hall=localhost:7001,gate=localhost:7002`: the name of a node or of a composite's file, and where this program listens
        peers://a=localhost:1
        3:30-43 error S4005: `peers://a=localhost:1` is not a list of peers: one peer has nobody to speak with: name at least two, with `,` between them
          help: write each as `NAME=host:port`, such as `peers://hall=localhost:7001,gate=localhost:7002`: the name of a node or of a composite's file, and where this program listens
        peers://a=localhost:1,localhost:2
        3:44-55 error S4005: `peers://a=localhost:1,localhost:2` is not a list of peers: each peer has a name before `=`, and its address behind it
          help: write each as `NAME=host:port`, such as `peers://hall=localhost:7001,gate=localhost:7002`: the name of a node or of a composite's file, and where this program listens
        peers://a=localhost:1,=localhost:2
        3:44-56 error S4005: `peers://a=localhost:1,=localhost:2` is not a list of peers: each peer has a name before `=`, and its address behind it
          help: write each as `NAME=host:port`, such as `peers://hall=localhost:7001,gate=localhost:7002`: the name of a node or of a composite's file, and where this program listens
        peers://a=localhost:1,b=localhost
        3:46-55 error S4005: `peers://a=localhost:1,b=localhost` is not a list of peers: there is no port
          help: write each as `NAME=host:port`, such as `peers://hall=localhost:7001,gate=localhost:7002`: the name of a node or of a composite's file, and where this program listens
          fix: replace it with `localhost:61616` [3:46-55 "localhost:61616"]
        peers://a=localhost:1,b=localhost:2,
        3:58-58 error S4005: `peers://a=localhost:1,b=localhost:2,` is not a list of peers: each peer has a name before `=`, and its address behind it
          help: write each as `NAME=host:port`, such as `peers://hall=localhost:7001,gate=localhost:7002`: the name of a node or of a composite's file, and where this program listens
        peers://a=localhost:1,a=localhost:2
        3:44-45 error S4005: `peers://a=localhost:1,a=localhost:2` is not a list of peers: peer `a` is named twice
          help: write each as `NAME=host:port`, such as `peers://hall=localhost:7001,gate=localhost:7002`: the name of a node or of a composite's file, and where this program listens
        peers://a=localhost:1,b=localhost:1
        3:46-57 error S4005: `peers://a=localhost:1,b=localhost:1` is not a list of peers: two peers listen at `localhost:1`
          help: write each as `NAME=host:port`, such as `peers://hall=localhost:7001,gate=localhost:7002`: the name of a node or of a composite's file, and where this program listens
        peers://a=localhost:1,b=tls://localhost:2
        3:46-63 error S4005: `peers://a=localhost:1,b=tls://localhost:2` is not a list of peers: an address of a peer has no transport of its own
          help: write each as `NAME=host:port`, such as `peers://hall=localhost:7001,gate=localhost:7002`: the name of a node or of a composite's file, and where this program listens
        peers://a=localhost:1,b=10.0.0.1:2
        3:22-56 error S4021: other machines can reach these peers, which do not ask for certificates
          help: write `peers+tls://`, and give `tlsCa`, `tlsCertificate` and `tlsKey`: see docs/security.md
        peers+tls://a=localhost:1,b=10.0.0.1:2
        3:22-60 error S4021: other machines can reach these peers, which do not ask for certificates
          help: write `peers+tls://`, and give `tlsCa`, `tlsCertificate` and `tlsKey`: see docs/security.md
    "#]].assert_eq(&all);
    let account = r#"<property name="url">peers://a=localhost:1,b=localhost:2</property>
        <property name="user">u</property><property name="password">$P</property>"#;
    expect![[r#"
        4:31-32 error S4006: peers know no users: none of them is the broker that would ask for one
          help: leave `user` and its password out; peers recognise each other by certificates, with `peers+tls://`
    "#]]
    .assert_eq(&robot(account));
    let tls = r#"<property name="url">peers://a=localhost:1,b=localhost:2</property>
        <property name="tlsCa">ca.pem</property>"#;
    expect![[r#"
        4:32-38 error S4025: the files for TLS are not used: `peers://a=localhost:1,b=localhost:2` is without TLS
          help: name the network `peers+tls://a=localhost:1,b=localhost:2`, or leave them out
    "#]]
    .assert_eq(&robot(tls));
}

#[test]
fn brokers_of_others_beyond_the_machine_are_to_encrypt() {
    let url = |text: &str, more: &str| robot(&format!(r#"<property name="url">{text}</property>{more}"#));
    let password = r#"<property name="user">u</property><property name="password">$P</property>"#;
    let ca = r#"<property name="tlsCa">ca.pem</property>"#;
    let all = [
        url("mqtt://localhost:1883", password),
        url("mqtt://10.0.0.5:1883", ""),
        url("stomp://10.0.0.5:61613", password),
        url("mqtts://10.0.0.5:8883", &format!("{password}{ca}")),
        url("stomp://localhost:61613", ca),
    ];
    expect![[r#"
        3:22-42 warning S4029: messages to `mqtt://10.0.0.5:1883` go over the network without protection
          help: write `mqtts://10.0.0.5:1883` with `tlsCa`, and let the broker listen there with TLS: see docs/brokers.md
        3:22-44 error S4020: a password is for `stomp://10.0.0.5:61613`, which has no TLS: who is on the way can take the connection over
          3:115-117 the password
          help: write `stomp+ssl://10.0.0.5:61613` with `tlsCa`, and let the broker listen there with TLS: see docs/brokers.md
        3:79-85 error S4025: the files for TLS are not used: `stomp://localhost:61613` is without TLS
          help: name the network `stomp+ssl://localhost:61613`, or leave them out
    "#]].assert_eq(&all.concat());
}

#[test]
fn addresses_of_message_brokers() {
    let url = |text: &str| robot(&format!(r#"<property name="url">{text}</property>"#));
    for right in ["localhost:61616", "127.0.0.1:1", "[::1]:65535"] {
        assert_eq!(url(right), "", "{right}");
    }
    for elsewhere in ["10.0.0.1:1", "[fe80::1]:65535", "broker-1.example.org:80", "localhost.example.org:1"] {
        let found = url(elsewhere);
        assert!(found.starts_with("3:22") && found.contains("warning S4029"), "{elsewhere}: {found}");
        assert!(!found.contains("error"), "{elsewhere}: {found}");
    }
    let all: String = [
        "localhost", "localhost:", ":61616", "localhost:0", "localhost:65536", "localhost:6161x",
        "tcp://localhost:61616", "::1:61616", "local host:1", "[::g]:1", "localhost:+1",
    ]
    .map(|text| format!("{text}\n{}", url(text)))
    .concat();
    expect![[r#"
        localhost
        3:22-31 error S4005: `localhost` is not an address of a message broker: there is no port
          help: write the address as `host:port`, such as `localhost:61616`, with a port from 1 to 65535
          fix: replace it with `localhost:61616` [3:22-31 "localhost:61616"]
        localhost:
        3:31-32 error S4005: `localhost:` is not an address of a message broker: there is no port
          help: write the address as `host:port`, such as `localhost:61616`, with a port from 1 to 65535
        :61616
        3:22-28 error S4005: `:61616` is not an address of a message broker: there is no host
          help: write the address as `host:port`, such as `localhost:61616`, with a port from 1 to 65535
        localhost:0
        3:32-33 error S4005: `localhost:0` is not an address of a message broker: port 0 is outside 1 to 65535
          help: write the address as `host:port`, such as `localhost:61616`, with a port from 1 to 65535
        localhost:65536
        3:32-37 error S4005: `localhost:65536` is not an address of a message broker: port 65536 is outside 1 to 65535
          help: write the address as `host:port`, such as `localhost:61616`, with a port from 1 to 65535
        localhost:6161x
        3:32-37 error S4005: `localhost:6161x` is not an address of a message broker: `6161x` is not a port
          help: write the address as `host:port`, such as `localhost:61616`, with a port from 1 to 65535
        tcp://localhost:61616
        3:22-43 error S4005: `tcp://localhost:61616` is not an address of a message broker: found `tcp://` before host and port
          help: write the address as `host:port`, such as `localhost:61616`, with a port from 1 to 65535
          fix: replace it with `localhost:61616` [3:22-43 "localhost:61616"]
        ::1:61616
        3:22-25 error S4005: `::1:61616` is not an address of a message broker: `::1` is not a host: an IPv6 address is written in brackets
          help: write the address as `host:port`, such as `localhost:61616`, with a port from 1 to 65535
          fix: replace it with `[::1]` [3:22-25 "[::1]"]
        local host:1
        3:27-28 error S4005: `local host:1` is not an address of a message broker: ` ` cannot be in the name of a host
          help: write the address as `host:port`, such as `localhost:61616`, with a port from 1 to 65535
        [::g]:1
        3:22-27 error S4005: `[::g]:1` is not an address of a message broker: `[::g]` is not an IPv6 address
          help: write the address as `host:port`, such as `localhost:61616`, with a port from 1 to 65535
        localhost:+1
        3:32-34 error S4005: `localhost:+1` is not an address of a message broker: `+1` is not a port
          help: write the address as `host:port`, such as `localhost:61616`, with a port from 1 to 65535
    "#]].assert_eq(&all);
}

#[test]
fn faults_of_other_properties_hide_none_of_these() {
    expect![[r#"
        3:24-28 error S3007: property `delay`: `soon` is not a duration: expected a duration from 0ms to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
          help: `delay`: From the start to the first due execution; the default is `0ms`
        4:22-31 error S4005: `localhost` is not an address of a message broker: there is no port
          help: write the address as `host:port`, such as `localhost:61616`, with a port from 1 to 65535
          fix: replace it with `localhost:61616` [4:22-31 "localhost:61616"]
        4:66-71 error S4004: `useJMS` is false, but component `R` publishes `POSTOPIC` and subscribes to `POSTOPIC` and `ORDERS`
          help: set `useJMS` to true: without it a component cannot publish or subscribe
        5:30-42 error S4002: property `topicRename`: found 3 names, expected a pair `OLD,new`
          help: write `OLD,new` for each topic, and `::` between two of them
    "#]]
    .assert_eq(&robot(
        r#"<property name="delay">soon</property>
<property name="url">localhost</property><property name="useJMS">false</property>
<property name="topicRename">POSTOPIC,a,b</property>"#,
    ));
    // Nor does a topic have its old name then.
    let shouter = r#"<component name="S"><implementation.java class="example.Shouter"/><property name="ID">S</property><property name="period">1</property></component>"#;
    expect![[r#"
        3:76-80 error S3007: property `delay`: `soon` is not a duration: expected a duration from 0ms to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
          help: `delay`: From the start to the first due execution; the default is `0ms`
    "#]]
    .assert_eq(&robot(&format!(
        r#"<property name="topicRename">POSTOPIC,pos</property><property name="delay">soon</property></component>{}"#,
        shouter.trim_end_matches("</component>")
    )));
}

#[test]
fn settings_that_do_not_go_together() {
    expect![[r#"
        3:25-30 error S4004: `useJMS` is false, but component `R` publishes `POSTOPIC` and subscribes to `POSTOPIC` and `ORDERS`
          help: set `useJMS` to true: without it a component cannot publish or subscribe
    "#]].assert_eq(&robot(r#"<property name="useJMS">false</property>"#));
    expect![[r#"
        3:27-32 warning S4007: the deadline of 150ms is longer than the period of 100ms: the next execution is due before it
          2:124-127 the period
          help: shorten the deadline: it can be at most the period
    "#]]
    .assert_eq(&robot(r#"<property name="deadline">150ms</property>"#));
    expect![[r#"
        3:31-32 warning S4008: `restartLimit` has no effect: the component is never restarted
          help: set `restart` to `onFailure`
        4:33-35 warning S4008: `restartBackoff` has no effect: the component is never restarted
          help: set `restart` to `onFailure`
    "#]]
    .assert_eq(&robot(
        r#"<property name="restartLimit">3</property>
<property name="restartBackoff">1s</property>"#,
    ));
    expect![[r#"
        3:23-25 warning S4006: `user` has no effect: there is no `url` of a message broker
          help: leave it out, or give all three
    "#]]
    .assert_eq(&robot(r#"<property name="user">me</property>"#));
    expect![[r#"
        3:27-33 warning S4006: `password` is given without `user`
          help: give both, or neither
    "#]]
    .assert_eq(&robot(r#"<property name="password">secret</property><property name="url">localhost:1</property>"#));
    expect![[r#"
        3:23-25 warning S4006: `user` and `password` have no effect: there is no `url` of a message broker
          help: give the `url` of the broker, or leave them out
    "#]]
    .assert_eq(&robot(r#"<property name="user">me</property><property name="password">secret</property>"#));
    assert_eq!(robot(r#"<property name="restart">onFailure</property><property name="restartLimit">3</property>"#), "");
}

#[test]
fn topics_that_trigger_a_component() {
    let trigger = |text: &str| robot(&format!("<property name=\"trigger\">{text}</property>"));
    assert_eq!(trigger("POSTOPIC, ORDERS") + &trigger(""), "");
    expect![[r#"
        3:26-33 error S4015: class `example.Robot001` subscribes to no topic `POSTOPC`
          fix: replace `POSTOPC` with `POSTOPIC` [3:26-33 "POSTOPIC"]
    "#]]
    .assert_eq(&trigger("POSTOPC"));
    expect![[r#"
        4:1-7 error S4015: `ORDERS` is named twice
          help: name it once
    "#]]
    .assert_eq(&trigger("ORDERS\nORDERS"));
    expect![[r#"
        3:26-29 warning S4016: `minimum` has no effect: no topic triggers the component
          help: name topics in `trigger`, or remove it
    "#]]
    .assert_eq(&robot(r#"<property name="minimum">5ms</property>"#));
    expect![[r#"
        3:68-71 error S3008: property `minimum`: `1ns` is out of range: expected a duration from 1us to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
          help: `minimum`: The least time from one reaction to the next; the default is `1ms`
    "#]]
        .assert_eq(&robot(r#"<property name="trigger">ORDERS</property><property name="minimum">1ns</property>"#));
    let shouter = r#"<component name="S"><implementation.rust class="example.Shouter"/><property name="ID">S</property>
<property name="period">1s</property><property name="trigger">POSTOPIC</property></component>"#;
    expect![[r#"
        3:63-71 error S4015: class `example.Shouter` does not react to messages: no topic can trigger it
          help: remove `trigger`: it reads its messages in each period
          help: a class that reacts says `reacts` in its `#[class(...)]` and has a function `react`
    "#]]
    .assert_eq(&faults(shouter));
}
