//! Paths at which services are offered over the web.

use std::fmt;

use super::AddressFault;

/// The first parts of paths that the server of the control uses itself.
pub const RESERVED: &[&str] = &["v1", "assets", "login", "logout", "metrics"];

/// The first part of the paths of services that have none of their own.
const SERVICES: &str = "services";

/// A path on a server: `/stock/orders`.
///
/// ```
/// use saoms_lang::model::WebPath;
///
/// let path = WebPath::parse("stock/a%20b/")?;
/// assert_eq!((path.as_str(), path.to_string().as_str()), ("/stock/a b", "/stock/a%20b"));
/// assert_eq!(path.rest("/stock/a b/count"), Some("count"));
/// assert!(WebPath::parse("/v1/status").is_err());
/// # Ok::<(), saoms_lang::model::AddressFault>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct WebPath(String);

impl WebPath {
    /// The path that a composite writes; a `/` may be missing before it, and one more may follow it.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn parse(text: &str) -> Result<WebPath, AddressFault> {
        let fault = |message: String, help: &str| Err(AddressFault { message, help: help.to_owned(), meant: None });
        let inner = text.strip_prefix('/').unwrap_or(text);
        let inner = inner.strip_suffix('/').unwrap_or(inner);
        if let Some(sign) = text.chars().find(|letter| matches!(letter, '?' | '#')) {
            return fault(format!("has a part after `{sign}`, which no path of a service has"), "leave that part out");
        }
        if inner.is_empty() {
            return fault("names no path of a service".to_owned(), "write a path such as `/stock`, or leave `uri` out");
        }
        let mut path = String::new();
        for part in inner.split('/') {
            let Some(decoded) = decoded(part) else {
                return fault(
                    format!("has a `%` without two hexadecimal digits of UTF-8 in `{part}`"),
                    "write `%25` for a `%`",
                );
            };
            if decoded.is_empty() || decoded == "." || decoded == ".." {
                return fault(format!("has the part `{part}`, which no path of a service has"), "leave that part out");
            }
            if let Some(wrong) = decoded.chars().find(|letter| letter.is_control() || matches!(letter, '/' | '\\')) {
                let shown = wrong.escape_debug();
                return fault(format!("has the character `{shown}` in `{part}`"), "leave it out");
            }
            path.push('/');
            path.push_str(&decoded);
        }
        let first = path[1..].split('/').next().unwrap_or_default();
        if RESERVED.contains(&first) {
            return Err(AddressFault {
                message: format!("begins with `/{first}`, where the server of the run has its own pages"),
                help: "use another path".to_owned(),
                meant: Some(format!("/{SERVICES}{}", encoded(&path))),
            });
        }
        Ok(WebPath(path))
    }

    /// The path of a service without one of its own.
    pub fn of_service(component: &str, service: &str) -> WebPath {
        let component = if component.is_empty() { String::new() } else { format!("/{component}") };
        WebPath(format!("/{SERVICES}{component}/{service}"))
    }

    /// The path without `%`.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// What follows this path in another one, which has no `%` either.
    pub fn rest<'p>(&self, path: &'p str) -> Option<&'p str> {
        path.strip_prefix(self.as_str())?.strip_prefix('/')
    }

    /// The path of an operation of the service at this path, as a request has it.
    pub fn of_operation(&self, operation: &str) -> String {
        format!("{self}/{}", WebPath::part(operation))
    }

    /// A name as a part of the path of a request: with `%` for what no part has.
    pub fn part(name: &str) -> String {
        encoded(name).replace('/', "%2F")
    }

    /// A path of a request, without `%`; `None` for one that no service can have.
    pub fn of_request(path: &str) -> Option<String> {
        let parts = path.strip_prefix('/')?.split('/');
        parts.map(|part| Some(format!("/{}", decoded(part).filter(|part| !part.contains('/'))?))).collect()
    }
}

impl fmt::Display for WebPath {
    /// The path as a request has it.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&encoded(&self.0))
    }
}

/// A part of a path without `%`.
fn decoded(part: &str) -> Option<String> {
    let mut bytes = part.bytes();
    let mut plain = Vec::with_capacity(part.len());
    while let Some(byte) = bytes.next() {
        plain.push(match byte {
            b'%' => {
                let digit = |byte: u8| char::from(byte).to_digit(16);
                (digit(bytes.next()?)? << 4 | digit(bytes.next()?)?) as u8
            }
            other => other,
        });
    }
    String::from_utf8(plain).ok()
}

/// A path with `%` for what no path has.
fn encoded(path: &str) -> String {
    let mut text = String::with_capacity(path.len());
    for byte in path.bytes() {
        match byte {
            b'/' | b'-' | b'.' | b'_' | b'~' | b'0'..=b'9' | b'A'..=b'Z' | b'a'..=b'z' => text.push(byte.into()),
            other => text.push_str(&format!("%{other:02X}")),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use proptest::prelude::*;

    use super::*;

    #[test]
    fn what_is_no_path_says_why() {
        for (text, expected) in [
            ("/", "names no path of a service"),
            ("", "names no path of a service"),
            ("//a", "has the part ``, which no path of a service has"),
            ("/a//b", "has the part ``, which no path of a service has"),
            ("/a/../b", "has the part `..`, which no path of a service has"),
            ("/a/%2e%2E", "has the part `%2e%2E`, which no path of a service has"),
            ("/a?b=c", "has a part after `?`, which no path of a service has"),
            ("a#b", "has a part after `#`, which no path of a service has"),
            ("/a/%2", "has a `%` without two hexadecimal digits of UTF-8 in `%2`"),
            ("/a/%ff", "has a `%` without two hexadecimal digits of UTF-8 in `%ff`"),
            ("/a%2Fb", "has the character `/` in `a%2Fb`"),
            ("/a%00", "has the character `\\0` in `a%00`"),
            ("/v1/x", "begins with `/v1`, where the server of the run has its own pages"),
            ("metrics", "begins with `/metrics`, where the server of the run has its own pages"),
        ] {
            assert_eq!(WebPath::parse(text).unwrap_err().message, expected, "{text}");
        }
        assert_eq!(WebPath::parse("/v1/x").unwrap_err().meant.as_deref(), Some("/services/v1/x"));
    }

    #[test]
    fn a_service_without_a_path_has_that_of_its_component() {
        assert_eq!(WebPath::of_service("hall/Robot1", "move").as_str(), "/services/hall/Robot1/move");
        assert_eq!(WebPath::of_service("", "stock").as_str(), "/services/stock");
    }

    proptest! {
        #[test]
        fn a_path_is_found_again_in_requests(text in "\\PC{0,20}(/\\PC{1,9}){0,3}") {
            if let Ok(path) = WebPath::parse(&text) {
                prop_assert_eq!(WebPath::parse(&path.to_string()).unwrap(), path.clone());
                let request = WebPath::of_request(&format!("{path}/operation")).unwrap();
                prop_assert_eq!(path.rest(&request), Some("operation"));
                prop_assert!(path.to_string().is_ascii());
            }
        }
    }
}
