//! Addresses that a composite names for requests of HTTP.

use std::fmt;
use std::net::Ipv6Addr;

/// The scheme of these addresses, and what it ends with.
const SCHEME: &str = "http://";

/// An address of HTTP: `http://host:port/path`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HttpAddress {
    /// A name or an IP address; one of IPv6 without its brackets.
    pub host: String,
    /// The port: 80 where the address has none.
    pub port: u16,
    /// The host as the header `Host` has it: with its port, if that is given.
    pub authority: String,
    /// Path and query; at least `/`.
    pub target: String,
}

/// Why a text is no address of HTTP, and what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AddressFault {
    /// What is wrong: it follows the text.
    pub message: String,
    /// What to do.
    pub help: String,
    /// The address that may be meant.
    pub meant: Option<String>,
}

/// What to do where an address cannot have what its author wants, by what the address is for.
#[derive(Clone, Copy, Debug)]
pub struct AddressHelp {
    /// An address of HTTPS.
    pub encrypted: &'static str,
    /// An account in it.
    pub account: &'static str,
    /// Another scheme.
    pub scheme: &'static str,
}

impl AddressHelp {
    /// For addresses of alerts.
    pub const ALERTS: AddressHelp = AddressHelp {
        encrypted: "let a command send it, as `saoms:alertCommand=\"curl --fail --silent --show-error --max-time 5 \
                    --json @- https://...\"`, or name a proxy on this machine that encrypts",
        account: "write no secret into a composite: let `alertTokenEnv` name an environment variable with a token",
        scheme: "write it as `http://host:port/path`, or let a command send it: `saoms:alertCommand`",
    };
    /// For addresses of services.
    pub const SERVICES: AddressHelp = AddressHelp {
        encrypted: "name a proxy on this machine that encrypts, such as `stunnel`, `nginx` or an `ssh -L` tunnel",
        account: "write no secret into a composite: let `saoms:tokenEnv` of the reference name an environment variable \
                  with a token",
        scheme: "write it as `http://host:port/path`",
    };
}

impl AddressFault {
    fn new(message: impl Into<String>, help: impl Into<String>) -> AddressFault {
        AddressFault { message: message.into(), help: help.into(), meant: None }
    }

    fn meant(self, meant: String) -> AddressFault {
        // What is suggested has to be right.
        let is_right = HttpAddress::parse(&meant, &AddressHelp::ALERTS).is_ok();
        AddressFault { meant: is_right.then_some(meant), ..self }
    }
}

impl HttpAddress {
    /// Reads an address.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn parse(text: &str, help: &AddressHelp) -> Result<HttpAddress, AddressFault> {
        let rest = rest_behind_scheme(text, help)?;
        if let Some(wrong) = rest.chars().find(|letter| !letter.is_ascii_graphic() || r#""<>\^`{|}"#.contains(*letter))
        {
            let shown = wrong.escape_debug();
            let bytes = "write it as the bytes of UTF-8, each as `%` and two hexadecimal digits";
            return Err(AddressFault::new(format!("has the character `{shown}`, which no address has"), bytes));
        }
        if let Some((before, _)) = rest.split_once('#') {
            let one = AddressFault::new("has a part after `#`, which is never sent", "leave that part out");
            return Err(one.meant(format!("{SCHEME}{before}")));
        }
        let end = rest.find(['/', '?']).unwrap_or(rest.len());
        let (authority, target) = rest.split_at(end);
        if authority.contains('@') {
            return Err(AddressFault::new("has an account before `@`", help.account));
        }
        let (host, port) = host_and_port(authority)?;
        let target = if target.starts_with('/') { target.to_owned() } else { format!("/{target}") };
        Ok(HttpAddress { host, port, authority: authority.to_owned(), target })
    }
}

impl HttpAddress {
    /// The whole address.
    pub fn written(&self) -> String {
        format!("{SCHEME}{}{}", self.authority, self.target)
    }
}

impl fmt::Display for HttpAddress {
    /// The address without its query, which may hold what is nobody's business.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = self.target.split('?').next().unwrap_or_default();
        write!(formatter, "{SCHEME}{}{path}", self.authority)
    }
}

fn rest_behind_scheme<'t>(text: &'t str, help: &AddressHelp) -> Result<&'t str, AddressFault> {
    let (start, rest) = text.split_at_checked(SCHEME.len()).unwrap_or_default();
    if start.eq_ignore_ascii_case(SCHEME) {
        return Ok(rest);
    }
    let scheme = text.split_once("://").map(|(scheme, _)| scheme);
    Err(match scheme {
        Some(scheme) if scheme.eq_ignore_ascii_case("https") => {
            AddressFault::new("is an address of HTTPS: SAOMS does not encrypt", help.encrypted)
        }
        Some(scheme) => AddressFault::new(format!("has the scheme `{scheme}`, expected `http`"), help.scheme),
        None => AddressFault::new("has no scheme", "write it as `http://host:port/path`")
            .meant(format!("{SCHEME}{}", text.trim_start_matches('/'))),
    })
}

fn host_and_port(authority: &str) -> Result<(String, u16), AddressFault> {
    let no_host = || AddressFault::new("has no host", "write it as `http://host:port/path`");
    let (host, port) = match authority.strip_prefix('[') {
        Some(inside) => {
            let (host, port) = inside.split_once(']').ok_or_else(no_host)?;
            host.parse::<Ipv6Addr>().map_err(|_| {
                AddressFault::new(format!("has `{host}` in brackets, which is not an IPv6 address"), "correct it")
            })?;
            match port.strip_prefix(':') {
                None if port.is_empty() => (host, None),
                None => return Err(AddressFault::new(format!("has `{port}` behind its brackets"), "correct it")),
                port => (host, port),
            }
        }
        None => match authority.rsplit_once(':') {
            Some((host, _)) if host.contains(':') => {
                let one = AddressFault::new("has an address of IPv6 without brackets", "write it between `[` and `]`");
                return Err(one.meant(format!("{SCHEME}[{authority}]/")));
            }
            Some((host, port)) => (host, Some(port)),
            None => (authority, None),
        },
    };
    if host.is_empty() {
        return Err(no_host());
    }
    let is_named = |letter: char| letter.is_ascii_alphanumeric() || "-._:".contains(letter);
    if !host.chars().all(is_named) {
        return Err(AddressFault::new(format!("has the host `{host}`, which is not a host name"), "correct it"));
    }
    let port = match port {
        None => 80,
        // A sign is no digit.
        Some(port) => port.parse().ok().filter(|number| *number > 0 && !port.starts_with('+')).ok_or_else(|| {
            AddressFault::new(format!("has the port `{port}`, expected a number from 1 to 65535"), "correct it")
        })?,
    };
    Ok((host.to_owned(), port))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> String {
        match HttpAddress::parse(text, &AddressHelp::ALERTS) {
            Ok(one) => format!("{}|{}|{}|{}", one.host, one.port, one.authority, one.target),
            Err(one) => one.message + &one.meant.map(|meant| format!(" -> {meant}")).unwrap_or_default(),
        }
    }

    #[test]
    fn an_address_has_a_host_and_may_have_a_port_and_a_path() {
        for (text, expected) in [
            ("http://page.example/alerts", "page.example|80|page.example|/alerts"),
            ("HTTP://127.0.0.1:8080", "127.0.0.1|8080|127.0.0.1:8080|/"),
            ("http://[::1]:9/a?b=c&d", "::1|9|[::1]:9|/a?b=c&d"),
            ("http://[::1]", "::1|80|[::1]|/"),
            ("http://host?q", "host|80|host|/?q"),
        ] {
            assert_eq!(read(text), expected, "{text}");
        }
        let shown = HttpAddress::parse("http://page.example/a?key=secret", &AddressHelp::ALERTS).unwrap().to_string();
        assert_eq!(shown, "http://page.example/a", "what a query holds may be a secret");
    }

    #[test]
    fn what_is_no_address_says_why_and_what_is_meant() {
        for (text, expected) in [
            ("https://page.example/a", "is an address of HTTPS: SAOMS does not encrypt"),
            ("ftp://a", "has the scheme `ftp`, expected `http`"),
            ("page.example/a", "has no scheme -> http://page.example/a"),
            ("//page.example:1/a", "has no scheme -> http://page.example:1/a"),
            ("http://", "has no host"),
            ("http:///a", "has no host"),
            ("http://:80/a", "has no host"),
            ("http://[::1/a", "has no host"),
            ("http://[x]/a", "has `x` in brackets, which is not an IPv6 address"),
            ("http://::1/a", "has an address of IPv6 without brackets -> http://[::1]/"),
            ("http://a:0/", "has the port `0`, expected a number from 1 to 65535"),
            ("http://a:65536/", "has the port `65536`, expected a number from 1 to 65535"),
            ("http://a:+80/", "has the port `+80`, expected a number from 1 to 65535"),
            ("http://a:/", "has the port ``, expected a number from 1 to 65535"),
            ("http://[::1]80/", "has `80` behind its brackets"),
            ("http://me:secret@a/", "has an account before `@`"),
            ("http://a b/", "has the character ` `, which no address has"),
            ("http://a/\r\nX: y", "has the character `\\r`, which no address has"),
            ("http://a/grün", "has the character `ü`, which no address has"),
            ("http://a/b#c", "has a part after `#`, which is never sent -> http://a/b"),
            ("http://a*/b", "has the host `a*`, which is not a host name"),
        ] {
            assert_eq!(read(text), expected, "{text}");
        }
    }
}
