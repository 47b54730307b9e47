//! Why a connection fails: Zenoh says in its log alone, and for all causes that it timed out.

use std::fmt::{self, Write as _};
use std::sync::{LazyLock, Mutex, Once, PoisonError, Weak};

use saoms_transport::{Failure, tls};
use tracing::field::{Field, Visit};
use tracing::span::{Attributes, Id, Record};
use tracing::{Event, Level, Metadata, Subscriber};

use super::session::Program;
use super::settings::Settings;

/// Where Zenoh writes it. No other lines are taken: some have the configuration, passwords among it.
const TARGET: &str = "zenoh::net::runtime::orchestrator";
/// How such a line begins, and what stands between endpoint, cause and rest.
const BEGIN: &str = "Unable to connect to configured peer ";

/// Those who are told: by their endpoints.
static WAITING: LazyLock<Mutex<Vec<Waiting>>> = LazyLock::new(Mutex::default);

struct Waiting {
    endpoint: String,
    /// The last cause.
    cause: Option<String>,
    /// The program of an open session.
    program: Weak<Program>,
}

/// Hears of causes for an endpoint, until a session is open or failed.
pub(super) fn listen(endpoint: &str) {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // Where somebody else listens already, causes are not known.
        let _ = tracing::subscriber::set_global_default(Causes);
    });
    let mut waiting = WAITING.lock().unwrap_or_else(PoisonError::into_inner);
    waiting.retain(|one| one.endpoint != endpoint || one.program.strong_count() > 0);
    waiting.push(Waiting { endpoint: endpoint.to_owned(), cause: None, program: Weak::new() });
}

/// The last cause for an endpoint.
pub(super) fn last(endpoint: &str) -> Option<String> {
    let mut waiting = WAITING.lock().unwrap_or_else(PoisonError::into_inner);
    waiting.iter_mut().filter(|one| one.endpoint == endpoint).find_map(|one| one.cause.take())
}

/// Tells a program why its session does not connect again.
pub(super) fn tell(endpoint: &str, program: Weak<Program>) {
    let mut waiting = WAITING.lock().unwrap_or_else(PoisonError::into_inner);
    waiting.retain(|one| one.endpoint != endpoint || one.program.strong_count() > 0);
    waiting.push(Waiting { endpoint: endpoint.to_owned(), cause: None, program });
}

/// The failure of an attempt to connect, in words for people.
pub(super) fn failure(settings: &Settings, cause: &str) -> Failure {
    let has = |text: &str| cause.contains(text);
    let failed = |text: String| Failure::failed(text);
    let host = settings.address().rsplit_once(':').map_or(settings.address(), |(host, _)| host);
    if has("in response to an OpenSyn") || has("in response to an InitSyn") {
        return failed(match &settings.user {
            Some(_) if has("InitSyn") => {
                "the broker refuses this program, since it speaks another version of Zenoh: build both from one version"
                    .to_owned()
            }
            Some(user) => format!("the broker refuses user `{user}`: the password is wrong, or it has no such user"),
            // Zenoh says the same of both.
            None if has("InitSyn") => {
                "the broker asks for a user, or speaks another version of Zenoh: give `user`, and `password` or \
                 `passwordFile`, or build both programs from one version"
                    .to_owned()
            }
            None => "the broker asks for a user: give `user`, and `password` or `passwordFile`".to_owned(),
        });
    }
    if has("UsrPwd extension") {
        return failed(
            "the broker asks for no password, so it is not the one that is meant: give it `user` and `password`"
                .to_owned(),
        );
    }
    if has("UnknownIssuer") || has("BadSignature") {
        return failed(tls::UNKNOWN_ISSUER.to_owned());
    }
    if has("not valid for name") || has("NotValidForName") {
        return failed(tls::not_for(host));
    }
    if has("certificate expired") || has("not valid yet") {
        return failed(tls::NOT_VALID.to_owned());
    }
    if has("CertificateRequired") {
        return failed(tls::ASKS.to_owned());
    }
    if ["UnknownCA", "BadCertificate", "CertificateUnknown", "DecryptError", "AccessDenied"].into_iter().any(has) {
        return failed(tls::NOT_ACCEPTED.to_owned());
    }
    if has("InvalidContentType") || has("corrupt message") {
        return failed(
            "who listens there does not speak TLS: leave `tls://` out, or give the broker `transport` tls".to_owned(),
        );
    }
    let text = match () {
        () if has("eof") || has("Connection reset") || has("Broken pipe") => {
            "who listens there ends the connection: another program, or a broker with TLS for a `url` without, or one that starts"
                .to_owned()
        }
        () if cause.is_empty() => "it does not answer as a broker does: another program may have this port".to_owned(),
        () => cause.to_owned(),
    };
    Failure::unreachable(text)
}

struct Causes;

impl Subscriber for Causes {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.is_event() && metadata.target() == TARGET && *metadata.level() <= Level::DEBUG
    }

    fn event(&self, event: &Event<'_>) {
        let mut message = Words::default();
        event.record(&mut message);
        let Some((endpoint, cause)) = message.0.strip_prefix(BEGIN).and_then(|rest| rest.split_once("! ")) else {
            return;
        };
        // Behind its words, Zenoh names lines of its source.
        let cause = cause.split(" at /").next().unwrap_or_default();
        let cause = cause.split(". Retry in").next().unwrap_or_default();
        // Nor does the number of a port help, which is another one each time.
        let cause = cause.split(" on: ").next().unwrap_or_default().trim_end_matches('.');
        let mut told = Vec::new();
        for one in WAITING.lock().unwrap_or_else(PoisonError::into_inner).iter_mut() {
            if one.endpoint == endpoint {
                one.cause = Some(cause.to_owned());
                told.extend(one.program.upgrade());
            }
        }
        told.iter().for_each(|program| program.cannot_connect(cause));
    }

    fn new_span(&self, _: &Attributes<'_>) -> Id {
        Id::from_u64(1)
    }

    fn record(&self, _: &Id, _: &Record<'_>) {}

    fn record_follows_from(&self, _: &Id, _: &Id) {}

    fn enter(&self, _: &Id) {}

    fn exit(&self, _: &Id) {}
}

/// The message of a line.
#[derive(Default)]
struct Words(String);

impl Visit for Words {
    fn record_debug(&mut self, field: &Field, value: &dyn fmt::Debug) {
        if field.name() == "message" {
            let _ = write!(self.0, "{value:?}");
        }
    }
}
