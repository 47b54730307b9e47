//! Who may send requests over the network, and what each may do.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use axum::extract::{Request, State};
use axum::http::header::{AUTHORIZATION, HOST, ORIGIN};
use axum::http::{HeaderMap, Method, Uri};
use axum::middleware::Next;
use axum::response::{IntoResponse, Redirect, Response};

use super::answer::Refusal;
use super::session::{LOGIN, Sessions};
use crate::counts::ClientCounts;
use crate::network::HostNames;
use crate::token::Tokens;

/// What a client may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Right {
    /// See everything, and order nothing.
    View,
    /// Everything.
    Control,
}

/// The mark of a request that came at the socket of the user.
#[derive(Clone, Copy, Debug)]
pub(super) struct AtSocket;

impl Right {
    /// The right as a word.
    pub(super) fn name(self) -> &'static str {
        match self {
            Right::View => "view",
            Right::Control => "control",
        }
    }

    /// True if it covers a request: nothing is changed by `GET`.
    fn covers(self, method: &Method) -> bool {
        self == Right::Control || matches!(*method, Method::GET | Method::HEAD)
    }
}

/// What a request over the network has to show.
#[derive(Debug)]
pub(super) struct Access {
    pub(super) names: HostNames,
    pub(super) tokens: Tokens,
    pub(super) sessions: Sessions,
    pub(super) counts: Arc<ClientCounts>,
}

impl Access {
    /// The right of the token in a request, or of the session of its browser.
    fn right(&self, headers: &HeaderMap) -> Result<Right, Refusal> {
        let mut authorizations = headers.get_all(AUTHORIZATION).iter();
        let (first, second) = (authorizations.next(), authorizations.next());
        match first.filter(|_| second.is_none()) {
            Some(shown) if self.tokens.control.token.is_in(shown.as_bytes()) => Ok(Right::Control),
            Some(shown) if self.tokens.view.token.is_in(shown.as_bytes()) => Ok(Right::View),
            // A wrong token is an error, whatever else the request has.
            None if second.is_none() => self.sessions.right(headers).ok_or_else(Refusal::unauthorized),
            _ => Err(Refusal::unauthorized()),
        }
    }

    /// The right of a token as it is typed into the form.
    pub(super) fn right_of(&self, token: &str) -> Option<Right> {
        let is = |one: &crate::token::TokenFile| one.token.is(token.as_bytes());
        if is(&self.tokens.control) {
            return Some(Right::Control);
        }
        is(&self.tokens.view).then_some(Right::View)
    }

    fn denied(&self, refusal: impl IntoResponse) -> Response {
        self.counts.denied.fetch_add(1, Ordering::Relaxed);
        refusal.into_response()
    }
}

/// Why a request does not come from this server's own page, or from a program; `None` if it may.
fn foreign(names: &HostNames, headers: &HeaderMap, uri: &Uri) -> Option<Refusal> {
    let Some(host) = only(headers, HOST.as_str()).filter(|host| names.include(host)) else {
        return Some(Refusal::forbidden("`Host` is not a name of this server"));
    };
    // A target may name its host again.
    if uri.authority().is_some_and(|authority| !names.include(authority.as_str())) {
        return Some(Refusal::forbidden("the target is not on this server"));
    }
    if headers.contains_key(ORIGIN) && !only(headers, ORIGIN.as_str()).is_some_and(|origin| is_same(origin, host)) {
        return Some(Refusal::forbidden("the request comes from a page of another server"));
    }
    None
}

/// The value of a header that is there once, if it is text.
fn only<'a>(headers: &'a HeaderMap, name: &str) -> Option<&'a str> {
    let mut values = headers.get_all(name).iter();
    let first = values.next()?;
    values.next().is_none().then(|| first.to_str().ok()).flatten()
}

/// True if a page of this origin was served by this host: by this server, or by one before it that encrypts.
fn is_same(origin: &str, host: &str) -> bool {
    let served = origin.strip_prefix("http://").or_else(|| origin.strip_prefix("https://"));
    served.is_some_and(|served| served.eq_ignore_ascii_case(host))
}

/// Lets a request over the network pass that does not come from a page of another site.
pub(super) async fn from_here(State(access): State<Arc<Access>>, request: Request, next: Next) -> Response {
    match foreign(&access.names, request.headers(), request.uri()) {
        Some(refusal) => access.denied(refusal),
        None => next.run(request).await,
    }
}

/// Lets a request over the network pass that has a token, or the session of a browser, with the right to it.
pub(super) async fn guarded(State(access): State<Arc<Access>>, mut request: Request, next: Next) -> Response {
    let right = match access.right(request.headers()) {
        Ok(right) => right,
        // A person, who is not to read JSON.
        Err(_) if request.uri().path() == "/" && request.method() == Method::GET => {
            return Redirect::to(LOGIN).into_response();
        }
        Err(refusal) => return access.denied(refusal),
    };
    if !right.covers(request.method()) {
        return access.denied(Refusal::forbidden(
            "this token has the right to view: an order needs the token with the right to control",
        ));
    }
    request.extensions_mut().insert(right);
    next.run(request).await
}

/// Lets a request on this machine pass that does not come from a page of another site.
pub(super) async fn on_machine(State(names): State<HostNames>, request: Request, next: Next) -> Response {
    match foreign(&names, request.headers(), request.uri()) {
        Some(refusal) => refusal.into_response(),
        None => next.run(request).await,
    }
}

/// Lets a request at the socket pass, whose clients may do everything: no page of another site, which reaches it where
/// the user forwards a port to the socket.
pub(super) async fn at_socket(State(names): State<HostNames>, mut request: Request, next: Next) -> Response {
    if request.headers().contains_key(ORIGIN)
        && let Some(refusal) = foreign(&names, request.headers(), request.uri())
    {
        return refusal.into_response();
    }
    request.extensions_mut().insert(Right::Control);
    request.extensions_mut().insert(AtSocket);
    next.run(request).await
}
