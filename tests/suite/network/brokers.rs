//! Fleets at brokers of others: mosquitto over MQTT, and ActiveMQ over STOMP, each with a configuration of its own.

use std::io::Write as _;
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::thread::spawn;

use super::certificates::Authority;
use super::errors::{ends_with, impatient};
use super::passwords::numbers;
use super::programs::{Program, Programs, Transport, component};
use super::{beside_each_other, reader, receives_all, senders};

const MOSQUITTO: &str = "/usr/sbin/mosquitto";
const ACTIVEMQ: &str = "/usr/share/activemq/bin/activemq.jar";

/// Number of events of each sender.
const MANY: &str = "20000";

/// The programs of a fleet, and the broker at their port.
struct AtBroker {
    programs: Programs,
    command: fn(&Programs) -> Command,
}

impl AtBroker {
    /// Writes the configuration of a broker, with more than it needs; `None` if it is not installed.
    #[expect(clippy::print_stdout, reason = "a test that is skipped says so")]
    fn new(transport: Transport, more: &str) -> Option<AtBroker> {
        let programs = Programs::over(transport);
        let (program, package, command): (_, _, fn(&Programs) -> Command) = match transport {
            Transport::Mqtt => (MOSQUITTO, "mosquitto", mosquitto),
            _ => (ACTIVEMQ, "activemq", active_mq),
        };
        if !Path::new(program).exists() {
            let missing = format!("{program} is missing (apt-get install {package})");
            assert!(std::env::var("SAOMS_PEERS").as_deref() != Ok("required"), "{missing}");
            println!("skipped: {missing}");
            return None;
        }
        let port = programs.port;
        match transport {
            Transport::Mqtt => {
                let more = if more.is_empty() { "allow_anonymous true\n" } else { more };
                // As root it would go on as a user who cannot read the files of the test.
                programs.write("mosquitto.conf", &format!("user root\nlistener {port} 127.0.0.1\n{more}"));
            }
            _ => programs.write("activemq.xml", &ACTIVEMQ_XML.replace("PORT", &port.to_string()).replace("MORE", more)),
        }
        Some(AtBroker { programs, command })
    }

    /// Starts the broker, and waits until it listens.
    #[track_caller]
    fn start(&self) -> Arc<Program> {
        let broker = self.programs.other("broker", (self.command)(&self.programs));
        let port = self.programs.port;
        self.programs.wait("the broker does not listen", || TcpStream::connect(("127.0.0.1", port)).is_ok());
        broker
    }

    /// Holds the programs to having said nothing that is wrong.
    #[track_caller]
    fn is_sound(&self) {
        let printed = self.programs.printed();
        for sign in ["wrong:", "panicked", "are lost"] {
            assert!(!printed.contains(sign), "`{sign}`\n{printed}");
        }
    }
}

fn mosquitto(_: &Programs) -> Command {
    let mut command = Command::new(MOSQUITTO);
    command.args(["-c", "mosquitto.conf"]);
    command
}

fn active_mq(programs: &Programs) -> Command {
    let mut command = Command::new("java");
    let folder = programs.folder().display();
    for open in ["java.lang", "java.util", "java.net", "java.util.concurrent", "java.util.concurrent.atomic"] {
        command.args(["--add-opens", &format!("java.base/{open}=ALL-UNNAMED")]);
    }
    command.args(["-Xmx256M", "-XX:TieredStopAtLevel=1", "-Dactivemq.home=/usr/share/activemq"]);
    command.args(["base", "conf", "data"].map(|of| format!("-Dactivemq.{of}={folder}")));
    command.args(["-jar", ACTIVEMQ, "start", &format!("xbean:file:{folder}/activemq.xml")]);
    command
}

const ACTIVEMQ_XML: &str = r#"<beans xmlns="http://www.springframework.org/schema/beans"
    xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xsi:schemaLocation="http://www.springframework.org/schema/beans
      http://www.springframework.org/schema/beans/spring-beans-2.0.xsd http://activemq.apache.org/schema/core
      http://activemq.apache.org/schema/core/activemq-core.xsd">
  <broker xmlns="http://activemq.apache.org/schema/core" brokerName="fleet" useJmx="false" persistent="false">
    MORE
    <transportConnectors><transportConnector uri="stomp://127.0.0.1:PORT"/></transportConnectors>
  </broker>
</beans>
"#;

#[test]
fn a_broker_of_others_that_is_killed_and_a_reader_that_stops_cost_no_event() {
    let trial = |transport| {
        let Some(at) = AtBroker::new(transport, "") else { return };
        let programs = &at.programs;
        let first = at.start();
        let reader = reader(programs, "reader", programs.port, &[("count", MANY)]);
        let senders = senders(programs, programs.port, &[("count", MANY), ("each", "500")]);
        programs.until(&senders, "Sender2        begins");
        programs.until(&senders, "program `reader` is on the network");
        first.kill();
        programs.until(&senders, "the link to the network was lost");
        let second = at.start();
        programs.until(&senders, "the link to the network is there");
        reader.signal(libc::SIGSTOP);
        programs.until(&senders, "program `reader` gives no sign of life");
        reader.signal(libc::SIGCONT);
        receives_all(programs, &reader, MANY);
        programs.ends(&senders, 0);
        at.is_sound();
        second.kill();
    };
    beside_each_other(&[&|| trial(Transport::Mqtt), &|| trial(Transport::Stomp)]);
}

/// Users `fleet` and `viewer` with the password `sesame`; the first one may do what a fleet does.
const USERS: &str = r#"<plugins>
  <simpleAuthenticationPlugin anonymousAccessAllowed="false"><users>
    <authenticationUser username="fleet" password="sesame" groups="fleet"/>
    <authenticationUser username="viewer" password="sesame" groups="viewers"/>
  </users></simpleAuthenticationPlugin>
  <authorizationPlugin><map><authorizationMap><authorizationEntries>
    <authorizationEntry topic="saoms.>" read="fleet" write="fleet" admin="fleet"/>
    <authorizationEntry topic="ActiveMQ.Advisory.>" read="fleet,viewers" write="fleet,viewers" admin="fleet,viewers"/>
  </authorizationEntries></authorizationMap></map></authorizationPlugin>
</plugins>"#;

#[test]
fn a_broker_of_others_refuses_who_has_no_account_and_no_right() {
    let trial = |transport| {
        let more = if transport == Transport::Mqtt { "password_file users\nacl_file access\n" } else { USERS };
        let Some(at) = AtBroker::new(transport, more) else { return };
        let programs = &at.programs;
        if transport == Transport::Mqtt {
            programs.write("users", "fleet:sesame\nviewer:sesame\n");
            let hashed = Command::new("mosquitto_passwd").arg("-U").arg(programs.folder().join("users")).status();
            assert!(hashed.unwrap().success());
            programs.write("access", "user fleet\ntopic readwrite saoms/#\n");
        }
        let broker = at.start();
        let url = programs.url(programs.port);
        let account = [("user", "fleet"), ("password", "$SAOMS_PASSWORD")];
        let reader = numbers(programs, "reader", &url, &account);
        let refused = [
            ("sender1", &[("user", "fleet"), ("password", "sesam")][..], "the broker refuses user `fleet`"),
            ("sender2", &[("user", "other"), ("password", "sesame")], "the broker refuses user `other`"),
            ("sender3", &[], "the broker asks for a user"),
            ("sender4", &[("user", "viewer"), ("password", "sesame")], "the broker does not let user `viewer`"),
        ];
        for (name, given, said) in refused {
            let program = numbers(programs, name, &url, given);
            ends_with(programs, &program, &[said, &url, &format!("component `{name}`")]);
        }
        let sender = numbers(programs, "sender", &url, &account);
        programs.until(&reader, "has received 1 to 200 of sender");
        programs.ends(&reader, 0);
        programs.ends(&sender, 0);
        at.is_sound();
        broker.kill();
    };
    beside_each_other(&[&|| trial(Transport::Mqtt), &|| trial(Transport::Stomp)]);
}

#[test]
fn a_broker_of_mqtt_with_tls_is_known_by_its_certificate() {
    let files =
        "cafile ca.pem\ncertfile broker.pem\nkeyfile broker.key\nrequire_certificate true\nallow_anonymous true\n";
    let Some(at) = AtBroker::new(Transport::Mqtt, files) else { return };
    let (programs, folder) = (&at.programs, at.programs.folder());
    let authority = Authority::new(&folder.join("ca.pem"));
    authority.vouch(folder, "broker", &["127.0.0.1"]);
    authority.vouch(folder, "robots", &["robots"]);
    Authority::new(&folder.join("other.pem"));
    let broker = at.start();
    let url = format!("mqtts://127.0.0.1:{}", programs.port);
    let own = [("tlsCa", "ca.pem"), ("tlsCertificate", "robots.pem"), ("tlsKey", "robots.key")];
    let reader = numbers(programs, "reader", &url, &own);
    let refused = [
        ("sender1", &[("tlsCa", "other.pem")][..], "nobody in `tlsCa` vouches for the certificate of the broker"),
        ("sender2", &[("tlsCa", "ca.pem")], "the broker asks for a certificate"),
    ];
    for (name, given, said) in refused {
        ends_with(programs, &numbers(programs, name, &url, given), &[said, &url]);
    }
    let unknown = numbers(programs, "sender3", &url, &[]);
    programs.ends(&unknown, 2);
    assert!(unknown.printed().contains("nobody says who vouches"), "{}", unknown.printed());
    let sender = numbers(programs, "sender", &url, &own);
    programs.until(&reader, "has received 1 to 200 of sender");
    programs.ends(&reader, 0);
    programs.ends(&sender, 0);
    at.is_sound();
    broker.kill();
}

/// A listener that says this first, or answers it; nothing where it is empty.
fn who_says(greeting: &'static [u8]) -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    spawn(move || {
        let mut streams = Vec::new();
        for stream in listener.incoming() {
            let mut stream = stream.unwrap();
            let _ = stream.write_all(greeting);
            streams.push(stream);
        }
    });
    port
}

#[test]
fn who_listens_and_is_no_broker_of_this_kind_is_told() {
    let openwire = b"\0\0\x01\x4c\x01ActiveMQ\0\0\0\x0c";
    let trials: [(Transport, u16, &str); 8] = [
        (Transport::Mqtt, super::programs::free_port(), "nobody listens there"),
        (Transport::Stomp, super::programs::free_port(), "nobody listens there"),
        (Transport::Mqtt, who_says(openwire), "an ActiveMQ broker listens there, over OpenWire"),
        (Transport::Stomp, who_says(openwire), "an ActiveMQ broker listens there, over OpenWire"),
        (Transport::Stomp, who_says(b"SSH-2.0-OpenSSH_9.2\r\n"), "who listens there does not speak STOMP"),
        (Transport::Mqtt, who_says(b"\x20\x02\0\x01"), "the broker does not speak MQTT 5"),
        (Transport::Mqtt, who_says(b""), "it does not answer as an MQTT broker does"),
        (Transport::Mqtt, who_says(b"\x15\x03\x03\0\x02\x02\x0a"), "who listens there speaks TLS: write `mqtts://"),
    ];
    for (transport, port, said) in trials {
        let programs = Programs::over(transport);
        let url = programs.url(port);
        ends_with(&programs, &impatient(&programs, "tasks", &url, "0s"), &[said, &url, "component `Sender1`"]);
    }
}

#[test]
fn a_composite_cannot_be_a_broker_of_others() {
    for (transport, name) in [(Transport::Mqtt, "mqtt"), (Transport::Stomp, "stomp")] {
        let programs = Programs::over(transport);
        let address = [("IP", "127.0.0.1"), ("transport", name), ("port", "1883")];
        let broker = programs.start("broker", &component("Broker", "unibg.robotics.tca.MessageBrokerImpl", &address));
        programs.ends(&broker, 2);
        let printed = broker.printed();
        let all = ["error[S4028]", "property `transport`", "is a program of its own", "--> broker.composite:2:"];
        assert!(all.iter().all(|text| printed.contains(text)), "{printed}");
    }
}
