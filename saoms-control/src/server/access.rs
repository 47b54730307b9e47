//! Who may send requests, and how long these may be.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use axum::body::{Body, to_bytes};
use axum::extract::{Request, State};
use axum::http::header::{AUTHORIZATION, CACHE_CONTROL, CONTENT_LENGTH, HOST, ORIGIN, X_CONTENT_TYPE_OPTIONS};
use axum::http::{HeaderMap, HeaderValue, Uri};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::answer::Refusal;
use crate::counts::ClientCounts;
use crate::network::HostNames;
use crate::token::TokenFile;

/// The most bytes of the body of a request.
const LONGEST_BODY: usize = 65_536;
/// Time for the body of a request.
const BODY: Duration = Duration::from_secs(10);

/// What a request over the network has to show.
#[derive(Debug)]
pub(super) struct Access {
    pub(super) names: HostNames,
    pub(super) token: TokenFile,
    pub(super) counts: Arc<ClientCounts>,
}

impl Access {
    fn refusal(&self, headers: &HeaderMap, uri: &Uri) -> Option<Refusal> {
        let Some(host) = only(headers, HOST.as_str()).filter(|host| self.names.include(host)) else {
            return Some(Refusal::forbidden("`Host` is not a name of this server"));
        };
        // A target may name its host again.
        if uri.authority().is_some_and(|authority| !self.names.include(authority.as_str())) {
            return Some(Refusal::forbidden("the target is not on this server"));
        }
        if headers.contains_key(ORIGIN) && !only(headers, ORIGIN.as_str()).is_some_and(|origin| is_same(origin, host)) {
            return Some(Refusal::forbidden("the request comes from a page of another server"));
        }
        let mut authorizations = headers.get_all(AUTHORIZATION).iter();
        let (first, second) = (authorizations.next(), authorizations.next());
        let shown = first.filter(|_| second.is_none());
        let has_token = shown.is_some_and(|shown| self.token.token.is_in(shown.as_bytes()));
        (!has_token).then(Refusal::unauthorized)
    }
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

/// Lets a request over the network pass that has the token, and does not come from a page of another site.
pub(super) async fn guarded(State(access): State<Arc<Access>>, request: Request, next: Next) -> Response {
    let mut response = match access.refusal(request.headers(), request.uri()) {
        Some(refusal) => {
            access.counts.denied.fetch_add(1, Ordering::Relaxed);
            refusal.into_response()
        }
        None => next.run(request).await,
    };
    let headers = response.headers_mut();
    headers.insert(CACHE_CONTROL, HeaderValue::from_static("no-store"));
    headers.insert(X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    response
}

/// Reads the whole body of a request, which is short and comes soon.
pub(super) async fn with_body(request: Request, next: Next) -> Response {
    let (parts, body) = request.into_parts();
    let length = parts.headers.get(CONTENT_LENGTH).and_then(|length| length.to_str().ok()?.parse::<u64>().ok());
    if length.is_some_and(|length| length > LONGEST_BODY as u64) {
        return Refusal::too_long(LONGEST_BODY).into_response();
    }
    match tokio::time::timeout(BODY, to_bytes(body, LONGEST_BODY)).await {
        Ok(Ok(bytes)) => next.run(Request::from_parts(parts, Body::from(bytes))).await,
        Ok(Err(_)) => Refusal::too_long(LONGEST_BODY).into_response(),
        Err(_) => Refusal::too_slow().into_response(),
    }
}
