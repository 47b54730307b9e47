//! Networks over TLS, with an authority of the fleet's own.

use super::certificates::{Authority, write_private};
use super::passwords::{broker, numbers};
use super::programs::{Given, Programs, Transport};

const BROKER: Given<'_> = &[("transport", "tls"), ("tlsCertificate", "broker.pem"), ("tlsKey", "broker.key")];

fn programs() -> (Programs, Authority, String) {
    let programs = Programs::over(Transport::Zenoh);
    let authority = Authority::new(&programs.folder().join("ca.pem"));
    authority.vouch(programs.folder(), "broker", &["127.0.0.1", "localhost"]);
    let url = format!("tls://127.0.0.1:{}", programs.port);
    (programs, authority, url)
}

#[test]
fn programs_that_know_the_authority_are_one_fleet_and_others_end() {
    let (programs, _authority, url) = programs();
    Authority::new(&programs.folder().join("other.pem"));
    let broker = broker(&programs, BROKER);
    programs.until(&broker, &format!("listens at `{url}`"));
    let reader = numbers(&programs, "reader", &url, &[("tlsCa", "ca.pem")]);
    let unknown = numbers(&programs, "sender1", &url, &[("tlsCa", "other.pem")]);
    programs.ends(&unknown, 1);
    let said = "nobody in `tlsCa` vouches for the certificate of the broker (component `sender1` needs it)";
    assert!(unknown.printed().contains(said), "{}", unknown.printed());
    let plain = numbers(&programs, "sender2", &programs.url(programs.port), &[]);
    programs.until(&plain, "a broker with TLS for a `url` without");
    programs.stop(&plain);
    let sender = numbers(&programs, "sender", &url, &[("tlsCa", "ca.pem")]);
    programs.until(&reader, "has received 1 to 200 of sender");
    programs.ends(&reader, 0);
    programs.ends(&sender, 0);
    programs.end(&broker);
}

#[test]
fn a_broker_asks_for_certificates_that_its_authority_vouches_for() {
    let (programs, authority, url) = programs();
    authority.vouch(programs.folder(), "robots", &["robots"]);
    let other = Authority::new(&programs.folder().join("other.pem"));
    other.vouch(programs.folder(), "stranger", &["robots"]);
    let broker = broker(&programs, &[BROKER, &[("tlsCa", "ca.pem")]].concat());
    programs.until(&broker, "listens at");
    let own = [("tlsCa", "ca.pem"), ("tlsCertificate", "robots.pem"), ("tlsKey", "robots.key")];
    let reader = numbers(&programs, "reader", &url, &own);
    programs.until(&reader, "has joined the network at");
    let refused = [
        ("sender1", &[("tlsCa", "ca.pem")][..], "the broker asks for a certificate"),
        (
            "sender2",
            &[("tlsCa", "ca.pem"), ("tlsCertificate", "stranger.pem"), ("tlsKey", "stranger.key")],
            "the broker does not accept the certificate in `tlsCertificate`",
        ),
    ];
    for (name, given, said) in refused {
        let program = numbers(&programs, name, &url, given);
        programs.ends(&program, 1);
        assert!(program.printed().contains(said), "{}", program.printed());
    }
    let sender = numbers(&programs, "sender", &url, &own);
    programs.until(&reader, "has received 1 to 200 of sender");
    programs.ends(&reader, 0);
    programs.ends(&sender, 0);
    programs.end(&broker);
}

#[test]
fn a_certificate_for_another_name_and_a_broker_without_tls_are_told() {
    let (programs, authority, url) = programs();
    authority.vouch(programs.folder(), "gate", &["gate-a"]);
    let wrong_name = broker(&programs, &[("transport", "tls"), ("tlsCertificate", "gate.pem"), ("tlsKey", "gate.key")]);
    programs.until(&wrong_name, "listens at");
    let sender = numbers(&programs, "sender1", &url, &[("tlsCa", "ca.pem")]);
    programs.ends(&sender, 1);
    assert!(sender.printed().contains("is not for `127.0.0.1`"), "{}", sender.printed());
    programs.end(&wrong_name);
    let plain = broker(&programs, &[]);
    programs.until(&plain, "listens at");
    let sender = numbers(&programs, "sender2", &url, &[("tlsCa", "ca.pem")]);
    programs.until(&sender, "waits for the message broker at");
    programs.stop(&sender);
    programs.end(&plain);
}

#[test]
fn files_for_tls_are_checked_before_the_start() {
    let (programs, authority, url) = programs();
    let folder = programs.folder();
    authority.vouch(folder, "robots", &["robots"]);
    authority.vouch_until(folder, "old", &["robots"], 2020);
    std::fs::write(folder.join("empty.pem"), "nothing").unwrap();
    write_private(&folder.join("none.key"), "nothing");
    std::fs::copy(folder.join("robots.key"), folder.join("open.key")).unwrap();
    let mode = std::os::unix::fs::PermissionsExt::from_mode(0o644);
    std::fs::set_permissions(folder.join("open.key"), mode).unwrap();
    let wrong = [
        ("sender1", &[("tlsCa", "nowhere.pem")][..], "`nowhere.pem` cannot be read: No such file"),
        ("sender2", &[("tlsCa", "empty.pem")], "there is no certificate in `empty.pem`"),
        ("sender3", &[("tlsCertificate", "old.pem"), ("tlsKey", "old.key")], "has expired, on"),
        (
            "sender4",
            &[("tlsCertificate", "robots.pem"), ("tlsKey", "broker.key")],
            "the key in `broker.key` is not that of the certificate in `robots.pem`",
        ),
        (
            "sender5",
            &[("tlsCertificate", "robots.pem"), ("tlsKey", "open.key")],
            "other users can read or change `open.key`",
        ),
        ("sender6", &[("tlsCertificate", "robots.pem"), ("tlsKey", "none.key")], "there is no private key in"),
    ];
    for (name, given, said) in wrong {
        let program = numbers(&programs, name, &url, given);
        programs.ends(&program, 2);
        let printed = program.printed();
        let place = format!("--> {name}.composite:2:");
        assert!([said, "error[S4028]", &place].iter().all(|text| printed.contains(text)), "{printed}");
    }
}
