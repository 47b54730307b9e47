use axum::http::header::WWW_AUTHENTICATE;
use axum::http::{HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use serde_json::json;

/// An error as a client gets it: `{"error": "..."}`.
#[derive(Clone, Debug)]
pub(super) struct Refusal {
    status: StatusCode,
    message: String,
}

impl Refusal {
    /// The request cannot be understood, or asks for something that there is not.
    pub(super) fn unprocessable(message: impl ToString) -> Refusal {
        Refusal { status: StatusCode::UNPROCESSABLE_ENTITY, message: message.to_string() }
    }

    /// The server itself failed.
    pub(super) fn internal(message: impl ToString) -> Refusal {
        Refusal { status: StatusCode::INTERNAL_SERVER_ERROR, message: message.to_string() }
    }

    pub(super) fn forbidden(message: &str) -> Refusal {
        Refusal { status: StatusCode::FORBIDDEN, message: message.to_owned() }
    }

    pub(super) fn unauthorized() -> Refusal {
        let message =
            "the token is missing or wrong: `Authorization: Bearer` with the text of the token's file".to_owned();
        Refusal { status: StatusCode::UNAUTHORIZED, message }
    }

    pub(super) fn too_long(most: usize) -> Refusal {
        let message = format!("the body has more than {most} bytes, or is incomplete");
        Refusal { status: StatusCode::PAYLOAD_TOO_LARGE, message }
    }

    pub(super) fn too_slow() -> Refusal {
        Refusal { status: StatusCode::REQUEST_TIMEOUT, message: "the body came too slowly".to_owned() }
    }

    pub(super) fn not_found() -> Refusal {
        let message = "there is no such route: `GET /v1/openapi.json` describes all routes".to_owned();
        Refusal { status: StatusCode::NOT_FOUND, message }
    }
}

impl Refusal {
    /// What is wrong.
    pub(super) fn message(&self) -> &str {
        &self.message
    }
}

impl IntoResponse for Refusal {
    fn into_response(self) -> Response {
        let body = json!({"error": self.message}).to_string();
        let mut response = (self.status, [("content-type", "application/json")], body).into_response();
        if self.status == StatusCode::UNAUTHORIZED {
            response.headers_mut().insert(WWW_AUTHENTICATE, HeaderValue::from_static("Bearer"));
        }
        // Who asked for a service gets it in another form.
        response.extensions_mut().insert(self);
        response
    }
}

/// The result of a route.
pub(super) type Answer = Result<Response, Refusal>;

/// An answer in JSON.
pub(super) fn json_text(text: impl Into<axum::body::Body>) -> Answer {
    Ok(([("content-type", "application/json")], text.into()).into_response())
}

/// The answer to an order that was accepted.
pub(super) fn done() -> Answer {
    json_text("{}")
}

/// Runs code that may wait for components, beside the thread of the server.
pub(super) async fn waiting<T: Send + 'static>(code: impl FnOnce() -> T + Send + 'static) -> Result<T, Refusal> {
    tokio::task::spawn_blocking(code).await.map_err(Refusal::internal)
}
