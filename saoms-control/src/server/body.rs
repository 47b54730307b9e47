//! How long requests may be, and what each answer says to browsers.

use std::time::Duration;

use axum::body::{Body, to_bytes};
use axum::extract::Request;
use axum::http::HeaderValue;
use axum::http::header::{
    CACHE_CONTROL, CONTENT_LENGTH, CONTENT_SECURITY_POLICY, REFERRER_POLICY, X_CONTENT_TYPE_OPTIONS,
};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::answer::Refusal;

/// The most bytes of the body of a request.
const LONGEST_BODY: usize = 65_536;
/// Time for the body of a request.
const BODY: Duration = Duration::from_secs(10);

/// What a page of the server may load: only files of the server, no text in the page itself. No other page frames it.
const POLICY: &str =
    "default-src 'self'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'; object-src 'none'";

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

/// Has browsers keep no answer, guess no type of one, and run nothing that is not a file of this server.
pub(super) async fn sealed(request: Request, next: Next) -> Response {
    let mut response = next.run(request).await;
    let headers = response.headers_mut();
    headers.insert(CACHE_CONTROL, HeaderValue::from_static("no-store"));
    headers.insert(X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    // A picture has one of its own.
    headers.entry(CONTENT_SECURITY_POLICY).or_insert(HeaderValue::from_static(POLICY));
    // Without an origin of its own, the form of the page would not be taken.
    headers.insert(REFERRER_POLICY, HeaderValue::from_static("same-origin"));
    response
}
