//! Errors of calls from the web, as problem details (RFC 9457).

use std::borrow::Cow;

use axum::extract::Request;
use axum::http::header::{ALLOW, CONTENT_LENGTH, CONTENT_TYPE, RETRY_AFTER};
use axum::http::{HeaderValue, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use saoms_lang::model::RESERVED;
use saoms_lang::schema::JsonFaults;
use serde_json::{Value, json};

use super::answer::Refusal;

/// Seconds after which who found a component busy is to try again.
const AGAIN: u32 = 1;

/// An error of a call.
#[derive(Debug)]
pub(super) struct Problem {
    status: StatusCode,
    detail: String,
    /// The faults of the body, each with its place.
    faults: Option<JsonFaults>,
    /// True if the same request may succeed soon.
    is_busy: bool,
}

impl Problem {
    pub(super) fn new(status: StatusCode, detail: impl Into<String>) -> Problem {
        Problem { status, detail: detail.into(), faults: None, is_busy: false }
    }

    /// The arguments do not fit the interface.
    pub(super) fn of_arguments(signature: &str, faults: JsonFaults) -> Problem {
        let detail = format!("the arguments do not fit the operation `{signature}`: {faults}");
        Problem { faults: Some(faults), ..Problem::new(StatusCode::BAD_REQUEST, detail) }
    }

    /// Somebody is busy, and is to be asked again.
    pub(super) fn busy(detail: impl Into<String>) -> Problem {
        Problem { is_busy: true, ..Problem::new(StatusCode::SERVICE_UNAVAILABLE, detail) }
    }

    fn text(&self) -> String {
        let mut body = body(self.status, &self.detail);
        if let Some(faults) = &self.faults {
            let faults = faults.iter().map(|one| json!({"pointer": one.pointer, "detail": one.message}));
            body["errors"] = faults.collect::<Value>();
        }
        body.to_string()
    }
}

/// The members that each has; `error` is what all answers of this server have.
fn body(status: StatusCode, detail: &str) -> Value {
    let title = status.canonical_reason().unwrap_or("Error");
    json!({"type": "about:blank", "title": title, "status": status.as_u16(), "detail": detail, "error": detail})
}

const PROBLEM: HeaderValue = HeaderValue::from_static("application/problem+json");

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        let mut response = (self.status, self.text()).into_response();
        let headers = response.headers_mut();
        headers.insert(CONTENT_TYPE, PROBLEM);
        if self.is_busy {
            headers.insert(RETRY_AFTER, AGAIN.into());
        }
        if self.status == StatusCode::METHOD_NOT_ALLOWED {
            headers.insert(ALLOW, HeaderValue::from_static("POST"));
        }
        response
    }
}

/// True for a path that a service can have: the others are those of the server.
pub(super) fn is_of_services(path: &str) -> bool {
    let first = path.trim_start_matches('/').split('/').next().unwrap_or_default();
    !first.is_empty() && !RESERVED.contains(&first)
}

/// Gives refusals of the server the form of problem details where a service was asked for.
pub(super) async fn as_problems(request: Request, next: Next) -> Response {
    let is_of_services = is_of_services(request.uri().path());
    let mut response = next.run(request).await;
    let Some(refusal) = response.extensions_mut().remove::<Refusal>().filter(|_| is_of_services) else {
        return response;
    };
    let text: Cow<'_, str> = refusal.message().into();
    let (mut parts, _) = response.into_parts();
    parts.headers.insert(CONTENT_TYPE, PROBLEM);
    parts.headers.remove(CONTENT_LENGTH);
    let text = body(parts.status, &text).to_string();
    Response::from_parts(parts, text.into())
}

/// The JSON Schema of a problem.
pub(super) fn schema() -> Value {
    let text = json!({"type": "string"});
    let fault = json!({"type": "object", "properties": {"pointer": text, "detail": text}});
    json!({
        "type": "object",
        "description": "Problem details (RFC 9457).",
        "properties": {
            "type": text,
            "title": text,
            "status": {"type": "integer"},
            "detail": {"type": "string", "description": "what is wrong"},
            "error": {"type": "string", "description": "the same"},
            "errors": {
                "type": "array",
                "description": "the faults of the arguments: each with its place, a JSON pointer (RFC 6901)",
                "items": fault,
            },
        },
        "required": ["status", "detail"],
    })
}
