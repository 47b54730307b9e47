//! The message broker of the manual's figure 6.25.

use saoms_api::extension::{Access, Router, RouterClass, TlsPaths, Topics, submit};
use saoms_api::{Class, Component, Context, Failure, Finding, Place, Properties, Secret, interface};

/// Service by which other components learn where the broker is.
#[interface(name = "unibg.robotics.tca.MessageBroker")]
pub trait MessageBrokerInterface {
    /// The address as the property `url` of a task names it.
    fn address(&mut self, context: &mut Context<'_>) -> Result<String, Failure>;
}

/// Properties of a message broker.
#[derive(Debug, Properties)]
pub struct MessageBrokerProperties {
    /// The name or address of the machine. `0.0.0.0` is all addresses that it has.
    #[property(name = "IP", default = "localhost", required_text)]
    host: String,
    /// The port.
    #[property(default = 61616, range = 1..=65535)]
    port: u16,
    /// The transport, as the `url` of the tasks names it before `://`, such as `tls`; without one, that for
    /// `host:port`.
    transport: Option<String>,
    /// The user that the broker accepts. Without this and `users`, it accepts everybody who reaches it.
    user: Option<String>,
    /// The password of this user, or `$NAME` for the environment variable `NAME`.
    password: Option<Secret>,
    /// The path of a file with this password, which no other user can read: from the folder of the composite.
    password_file: Option<String>,
    /// The path of a file with further users, which no other user can read: lines `user:password`.
    users: Option<String>,
    /// What a user may do, as `viewer: reads POSTOPIC; writes RMSTOPIC; controls`; `*` is all topics, `runs hall`
    /// allows what the components of the node `hall` do, and `controls` lets the user ask all programs, and give them
    /// orders, with `--url`. Without any, all users may do everything; with some, those that are not named may do
    /// nothing.
    access: Vec<String>,
    /// The path of a file (PEM) with the certificates of those who vouch for programs: then only programs with such a
    /// certificate are accepted.
    tls_ca: Option<String>,
    /// The path of the certificate of the broker (PEM).
    tls_certificate: Option<String>,
    /// The path of the private key of this certificate (PEM), which no other user can read.
    tls_key: Option<String>,
    /// Whether other machines may reach the broker although it asks for no password or does not encrypt: in a network
    /// that you trust.
    #[property(default = false)]
    unprotected: bool,
}

/// Carries the topics of all tasks whose `url` names this broker, in this program and in others: the program listens at
/// its address.
#[derive(Debug, Class)]
#[class(
    name = "saoms.MessageBroker",
    passive,
    service("MessageBroker": MessageBrokerInterface),
    also("unibg.robotics.tca.MessageBrokerImpl")
)]
pub struct MessageBroker {
    address: String,
}

impl MessageBrokerProperties {
    fn router(self) -> Result<Router, Failure> {
        let transport = given(self.transport).map(|transport| format!("{transport}://")).unwrap_or_default();
        let access = self.access.iter().enumerate().map(|(place, text)| {
            access_of(text).map_err(|message| {
                let finding = Finding::new(Place::property("access").part(place, 0..text.len()), message);
                Failure::from(finding.help("write it as `viewer: reads POSTOPIC; writes RMSTOPIC`"))
            })
        });
        Ok(Router {
            url: format!("{transport}{}:{}", self.host.trim(), self.port),
            user: given(self.user),
            password: self.password,
            password_file: given(self.password_file),
            users: given(self.users),
            access: access.collect::<Result<_, Failure>>()?,
            tls: TlsPaths {
                ca: given(self.tls_ca),
                certificate: given(self.tls_certificate),
                key: given(self.tls_key),
            },
            is_unprotected: self.unprotected,
        })
    }
}

/// A text that is given: one without a character is not.
fn given(text: Option<String>) -> Option<String> {
    text.map(|text| text.trim().to_owned()).filter(|text| !text.is_empty())
}

/// What a user may do.
fn access_of(text: &str) -> Result<Access, String> {
    let (user, rights) = text.split_once(':').ok_or("there is no `:` behind the name of a user")?;
    let mut access = Access { user: user.trim().to_owned(), ..Access::default() };
    if access.user.is_empty() {
        return Err("there is no name of a user before `:`".to_owned());
    }
    for right in rights.split(';').map(str::trim).filter(|right| !right.is_empty()) {
        let (verb, names) = right.split_once(char::is_whitespace).unwrap_or((right, ""));
        let names: Vec<String> =
            names.split(',').map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).collect();
        let topics = || match names.as_slice() {
            [] => Err(format!("there is no topic behind `{verb}`")),
            [all] if all == "*" => Ok(Topics::All),
            _ => Ok(Topics::Some(names.clone())),
        };
        match verb {
            "controls" if names.is_empty() => access.controls = true,
            "reads" => access.reads.extend(topics()?),
            "writes" => access.writes.extend(topics()?),
            "runs" if names.is_empty() => return Err("there is no node behind `runs`".to_owned()),
            "runs" => access.runs.extend(names),
            _ => {
                return Err(format!(
                    "found `{verb}`, expected `reads` or `writes` and topics, `runs` and nodes, or `controls` alone"
                ));
            }
        }
    }
    Ok(access)
}

impl Component for MessageBroker {
    type Properties = MessageBrokerProperties;

    fn new(properties: MessageBrokerProperties) -> Result<Self, Failure> {
        Ok(MessageBroker { address: properties.router()?.url })
    }
}

submit! {
    RouterClass {
        class: "saoms.MessageBroker",
        router: |values| MessageBrokerProperties::from_values(values)?.router(),
    }
}

impl MessageBrokerInterface for MessageBroker {
    fn address(&mut self, _context: &mut Context<'_>) -> Result<String, Failure> {
        Ok(self.address.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn access_is_read_whole_or_not() {
        let access = access_of("viewer: reads POSTOPIC, Event luggage MS; writes *").unwrap();
        assert!(access.reads.contain("Event luggage MS") && !access.reads.contain("ESTOP"));
        assert_eq!((access.user.as_str(), access.writes), ("viewer", Topics::All));
        let viewer = access_of("viewer:").unwrap();
        assert!(viewer.reads == Topics::default() && !viewer.controls);
        assert!(access_of("ada: reads *; controls").unwrap().controls);
        let access = access_of("ada: runs hall, gate-a; reads A; reads B").unwrap();
        assert_eq!(
            (access.runs, access.reads.names()),
            (vec!["hall".into(), "gate-a".into()], &["A".into(), "B".into()][..])
        );
        for (wrong, message) in [
            ("viewer reads A", "no `:`"),
            (": reads A", "no name of a user"),
            ("viewer: sees A", "found `sees`"),
            ("viewer: controls A", "found `controls`"),
            ("viewer: reads", "no topic behind `reads`"),
            ("viewer: runs", "no node behind `runs`"),
        ] {
            assert!(access_of(wrong).unwrap_err().contains(message), "{wrong}");
        }
    }
}
