//! Where a server is, and how it is reached.

mod connector;
mod end_point;
mod passwords;
mod tls;
mod url;

use std::time::Duration;

use postgres::config::{Host, SslMode};
use postgres::{Client, Config, NoTls};
use saoms_api::host::one_line;

use crate::arguments::Arguments;
use crate::problem::{Outcome, Problem, reason};
use crate::warn;
use tls::Tls;

/// The folder of the socket of Debian's and most other packages of PostgreSQL.
const SOCKETS: &str = "/var/run/postgresql";

/// Time for a connection to come about, and for a network to take what was sent.
const CONNECT: Duration = Duration::from_secs(10);
const UNANSWERED: Duration = Duration::from_secs(30);

/// The place of a database, with all that a connection needs.
pub(crate) struct Address {
    config: Config,
    /// How the server is known; `None` if nothing is encrypted.
    tls: Option<Tls>,
    user: String,
    /// The database and its server, for people: without the password.
    pub(crate) shown: String,
}

impl Address {
    /// The address that the command line gives, with the password from where it is kept.
    pub(crate) fn of(arguments: &Arguments) -> Result<Address, String> {
        match (&arguments.to, &arguments.to_env) {
            (Some(url), _) if url::has_password(url) => {
                Err("`--to` has a password, which all users of the machine see in \
                 the list of processes: give it by the variable PGPASSWORD or by ~/.pgpass, or the whole url by \
                 `--to-env VARIABLE`"
                    .to_owned())
            }
            (Some(url), _) => Address::read(url).map_err(|problem| format!("`--to`: {problem}")),
            (None, Some(variable)) => {
                let url = std::env::var(variable)
                    .map_err(|_| format!("`--to-env`: there is no variable `{}` with a text", one_line(variable)))?;
                Address::read(&url).map_err(|problem| format!("the variable `{}`: {problem}", one_line(variable)))
            }
            (None, None) => Err("expected `--to URL` or `--to-env VARIABLE`".to_owned()),
        }
    }

    fn read(url: &str) -> Result<Address, String> {
        let (mut config, tls) = url::read(url)?;
        if config.get_hosts().is_empty() && config.get_hostaddrs().is_empty() {
            config.host(SOCKETS);
        }
        if config.get_user().is_none() {
            let user = whoami::username().map_err(|error| format!("the url names no user, and the system: {error}"))?;
            config.user(&user);
        }
        let user = config.get_user().unwrap_or_default().to_owned();
        if config.get_dbname().is_none() {
            config.dbname(&user);
        }
        config.application_name("saoms-postgres");
        config.connect_timeout(*config.get_connect_timeout().unwrap_or(&CONNECT));
        config.tcp_user_timeout(*config.get_tcp_user_timeout().unwrap_or(&UNANSWERED));
        if config.get_password().is_none()
            && let Some(password) = passwords::of(&config, &user)?
        {
            config.password(password);
        }
        if is_remote(&config) && !tls.is_verified() {
            warn(
                "the server can be another one than it says, as its certificate is not looked at: \
                 `sslmode=verify-full&sslrootcert=FILE` in the url has it verified",
            );
        }
        let has_network = config.get_hosts().iter().any(|host| matches!(host, Host::Tcp(_)));
        let has_network = has_network || !config.get_hostaddrs().is_empty();
        let tls = if has_network { tls.prepare(&mut config)? } else { without_tls(&mut config) };
        let shown = shown(&config);
        Ok(Address { config, tls, user, shown })
    }

    pub(crate) fn connect(&self) -> Outcome<Client> {
        let connected = match &self.tls {
            Some(tls) => self.config.connect(tls.connector()),
            None => self.config.connect(NoTls),
        };
        connected.map_err(|error| self.failed(&error))
    }

    fn failed(&self, error: &postgres::Error) -> Problem {
        let (shown, user, reason) = (&self.shown, one_line(&self.user), reason(error));
        match error.code().map(|code| code.code()) {
            Some("28P01" | "28000") => Problem::Wrong(format!(
                "{shown} refuses the user `{user}`: {reason}; another user stands in the url, as `postgres://user@...`, and \
                 a password in the variable PGPASSWORD or in ~/.pgpass"
            )),
            Some("3D000") => {
                Problem::Wrong(format!("there is no {shown}: {reason}; `createdb` of PostgreSQL makes one"))
            }
            _ if reason.contains("password missing") => Problem::Wrong(format!(
                "{shown} asks the user `{user}` for a password: give it by the variable PGPASSWORD or by ~/.pgpass"
            )),
            _ if reason.contains("failed to lookup address") => {
                Problem::Wrong(format!("{shown}: there is no such host: {reason}"))
            }
            _ => Problem::of(&format!("{shown} cannot be reached"), error),
        }
    }
}

/// No TLS, as at a socket of the machine.
fn without_tls(config: &mut Config) -> Option<Tls> {
    config.ssl_mode(SslMode::Disable);
    None
}

/// True if a server may be on another machine. Addresses are where connections go, whatever their hosts are called.
fn is_remote(config: &Config) -> bool {
    if config.get_hostaddrs().is_empty() {
        return config.get_hosts().iter().any(|host| matches!(host, Host::Tcp(name) if !is_local(name)));
    }
    !config.get_hostaddrs().iter().all(std::net::IpAddr::is_loopback)
}

fn is_local(name: &str) -> bool {
    name == "localhost" || name.parse::<std::net::IpAddr>().is_ok_and(|address| address.is_loopback())
}

/// The database and its servers.
fn shown(config: &Config) -> String {
    let ports = config.get_ports();
    let port = |place: usize| ports.get(place).or(ports.first()).copied().unwrap_or(5432);
    let host = |(place, host): (usize, &Host)| match host {
        Host::Tcp(name) => format!("{name}:{}", port(place)),
        Host::Unix(folder) => match port(place) {
            5432 => folder.display().to_string(),
            other => format!("{} (port {other})", folder.display()),
        },
    };
    let mut hosts: Vec<String> = config.get_hosts().iter().enumerate().map(host).collect();
    if hosts.is_empty() {
        hosts = config.get_hostaddrs().iter().map(ToString::to_string).collect();
    }
    let database = config.get_dbname().unwrap_or_default();
    one_line(&format!("database `{database}` at {}", hosts.join(", "))).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn servers_elsewhere_are_known_by_their_names_and_addresses() {
        for (url, expected) in [
            ("postgres://server/fleet", true),
            ("postgres://192.0.2.7/fleet", true),
            ("postgres://localhost,server/fleet", true),
            ("postgres:///fleet?hostaddr=192.0.2.7", true),
            ("postgres://localhost/fleet?hostaddr=192.0.2.7", true),
            ("postgres:///fleet?hostaddr=127.0.0.1", false),
            ("postgres://server/fleet?hostaddr=127.0.0.1", false),
            ("postgres://localhost/fleet", false),
            ("postgres://[::1]/fleet", false),
            ("postgres:///fleet?host=/run/postgresql", false),
        ] {
            assert_eq!(is_remote(&url::read(url).unwrap().0), expected, "{url}");
        }
    }
}
