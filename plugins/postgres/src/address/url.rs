//! The url of a database, as libpq has it.

use std::time::Duration;

use postgres::Config;
use postgres::config::SslMode;
use saoms_api::host::one_line;

use super::tls::{Tls, Trust};
use crate::problem::reason;

/// Time without traffic after which a network is asked whether the server is still there, time between two such
/// questions, and the number of them without an answer after which it is not.
const IDLE: Duration = Duration::from_secs(30);
const BETWEEN: Duration = Duration::from_secs(10);
const RETRIES: u32 = 3;

const PREFIXES: [&str; 2] = ["postgres://", "postgresql://"];

/// True if a url has a password.
pub(super) fn has_password(url: &str) -> bool {
    let rest = PREFIXES.iter().find_map(|prefix| url.strip_prefix(prefix)).unwrap_or(url);
    let before_options = rest.split('?').next().unwrap_or_default();
    let has_user = before_options.rsplit_once('@').is_some_and(|(user, _)| user.contains(':'));
    has_user || options(rest).any(|(name, _)| name == "password")
}

/// What a url says of a connection.
pub(super) fn read(url: &str) -> Result<(Config, Wish), String> {
    const EXPECTED: &str = "expected a url, such as `postgres:///fleet?host=/run/postgresql` or \
                            `postgres://ada@server/fleet?sslmode=verify-full`";
    if !PREFIXES.iter().any(|prefix| url.starts_with(prefix)) {
        return Err(EXPECTED.to_owned());
    }
    let (place, _) = url.split_once('?').unwrap_or((url, ""));
    let mut wish = Wish { mode: Mode::Prefer, root: None };
    let mut others = Vec::new();
    for (name, value) in options(url) {
        match name {
            "sslmode" => wish.mode = Mode::of(value)?,
            "sslrootcert" => wish.root = Some(decoded(value)),
            "sslcert" | "sslkey" => {
                return Err(format!("certificates of clients (`{name}`) are not used: expected a password"));
            }
            _ => others.push(format!("{name}={value}")),
        }
    }
    let others = if others.is_empty() { String::new() } else { format!("?{}", others.join("&")) };
    let config = format!("{place}{others}").parse::<Config>();
    let mut config = config.map_err(|error| format!("{}; {EXPECTED}", reason(&error)))?;
    keep_alive(&mut config, options(url).any(|(name, _)| name == "keepalives_idle"));
    Ok((config, wish))
}

/// Has a connection that is idle asked whether the server is still there, as the url says or else after these times.
fn keep_alive(config: &mut Config, says_idle: bool) {
    if !says_idle {
        config.keepalives_idle(IDLE);
    }
    config.keepalives_interval(config.get_keepalives_interval().unwrap_or(BETWEEN));
    config.keepalives_retries(config.get_keepalives_retries().unwrap_or(RETRIES));
}

/// The options of a url.
fn options(url: &str) -> impl Iterator<Item = (&str, &str)> {
    let options = url.split_once('?').map(|(_, options)| options).unwrap_or_default();
    options.split('&').filter(|option| !option.is_empty()).map(|one| one.split_once('=').unwrap_or((one, "")))
}

/// A value without its escapes.
fn decoded(value: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = value.as_bytes();
    while let Some((first, others)) = rest.split_first() {
        let escaped = others.get(..2).filter(|_| *first == b'%').and_then(|digits| str::from_utf8(digits).ok());
        match escaped.and_then(|digits| u8::from_str_radix(digits, 16).ok()) {
            Some(byte) => {
                bytes.push(byte);
                rest = &others[2..];
            }
            None => {
                bytes.push(*first);
                rest = others;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// How a url wants a connection to be protected.
pub(super) struct Wish {
    mode: Mode,
    /// The file with the certificates of those who vouch for the server.
    root: Option<String>,
}

/// The modes of libpq, but `allow`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    Disable,
    Prefer,
    Require,
    VerifyCa,
    VerifyFull,
}

impl Mode {
    fn of(text: &str) -> Result<Mode, String> {
        Ok(match text {
            "disable" => Mode::Disable,
            "prefer" => Mode::Prefer,
            "require" => Mode::Require,
            "verify-ca" => Mode::VerifyCa,
            "verify-full" => Mode::VerifyFull,
            _ => {
                return Err(format!(
                    "`sslmode` is `{}`: expected `disable`, `prefer`, `require`, `verify-ca` or `verify-full`",
                    one_line(text)
                ));
            }
        })
    }
}

impl Wish {
    /// True if the name of the server is verified.
    pub(super) fn is_verified(&self) -> bool {
        self.mode == Mode::VerifyFull
    }

    /// What protects the connection; `None` if nothing does.
    pub(super) fn prepare(&self, config: &mut Config) -> Result<Option<Tls>, String> {
        let root = self.root.clone().or_else(default_root);
        let needed = || {
            root.as_deref().ok_or_else(|| {
                "the server cannot be verified: name the file with the certificates of those who vouch for it, as \
                 `sslrootcert=FILE` in the url; those of the public authorities are in /etc/ssl/certs/ca-certificates.crt"
                    .to_owned()
            })
        };
        config.ssl_mode(match self.mode {
            Mode::Disable => SslMode::Disable,
            Mode::Prefer => SslMode::Prefer,
            Mode::Require | Mode::VerifyCa | Mode::VerifyFull => SslMode::Require,
        });
        match self.mode {
            Mode::Disable => Ok(None),
            Mode::Prefer => Tls::new(Trust::Anybody).map(Some),
            // As libpq does: who has certificates wants them to count.
            Mode::Require => Tls::new(root.as_deref().map_or(Trust::Anybody, Trust::Authority)).map(Some),
            Mode::VerifyCa => Tls::new(Trust::Authority(needed()?)).map(Some),
            Mode::VerifyFull => Tls::new(Trust::Name(needed()?)).map(Some),
        }
    }
}

/// The file of certificates that libpq takes where none is named.
fn default_root() -> Option<String> {
    let path = std::path::Path::new(&std::env::var_os("HOME")?).join(".postgresql/root.crt");
    path.is_file().then(|| path.display().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passwords_are_found_in_urls() {
        for (url, expected) in [
            ("postgres:///fleet?host=/run/postgresql", false),
            ("postgres://ada@server/fleet", false),
            ("postgres://server:5433/fleet?application_name=a:b@c", false),
            ("postgres://ada:secret@server/fleet", true),
            ("postgresql://ada:se@cret@server/fleet", true),
            ("postgres://server/fleet?user=ada&password=secret", true),
        ] {
            assert_eq!(has_password(url), expected, "{url}");
        }
    }

    #[test]
    fn silent_servers_are_noticed_unless_the_url_says_otherwise() {
        let times = |url: &str| {
            let (config, _) = read(url).unwrap();
            let interval = config.get_keepalives_interval().unwrap().as_secs();
            (config.get_keepalives_idle().as_secs(), interval, config.get_keepalives_retries().unwrap())
        };
        assert_eq!(times("postgres://server/fleet"), (30, 10, 3));
        assert_eq!(times("postgres://server/fleet?keepalives_idle=7200"), (7200, 10, 3));
        assert_eq!(times("postgres://server/fleet?keepalives_interval=5&keepalives_retries=9"), (30, 5, 9));
        assert!(!read("postgres://server/fleet?keepalives=0").unwrap().0.get_keepalives());
    }

    #[test]
    fn values_have_their_characters_back() {
        assert_eq!(decoded("%2Fetc%2fa%20b.pem%"), "/etc/a b.pem%");
    }
}
