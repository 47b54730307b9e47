//! The dashboard: its page, and the files that the page loads. What it knows of the domain comes from views that crates
//! of components register.

use std::borrow::Cow;

use axum::Router;
use axum::extract::{Extension, Path};
use axum::response::{Html, IntoResponse, Response};
use axum::routing::get;
use saoms_api::extension::DashboardView;
use serde_json::{Value, json};

use super::access::Right;
use super::answer::{Answer, Refusal, json_text};

const INDEX: &str = include_str!("../../page/index.html");
const FINISHED: &str = include_str!("../../page/view.html");
const FORM: &str = include_str!("../../page/login.html");
/// What the form says after a wrong token; its place in the form.
const WRONG: &str = "<p class=\"wrong\" role=\"alert\">This is not a token of this fleet.</p>";
const PLACE_OF_WRONG: &str = "<!-- wrong -->";

/// The types of files by the endings of their names.
const TYPES: &[(&str, &str)] =
    &[("css", "text/css; charset=utf-8"), ("js", "text/javascript; charset=utf-8"), ("svg", "image/svg+xml")];

/// The files of the page.
const FILES: &[(&str, &str)] = &[
    ("icon.svg", include_str!("../../page/icon.svg")),
    ("style.css", include_str!("../../page/style.css")),
    ("app.js", include_str!("../../page/app.js")),
    ("page.js", include_str!("../../page/page.js")),
    ("player.js", include_str!("../../page/player.js")),
    ("recorded.js", include_str!("../../page/recorded.js")),
    ("fleet.js", include_str!("../../page/fleet.js")),
    ("orders.js", include_str!("../../page/orders.js")),
    ("dom.js", include_str!("../../page/dom.js")),
    ("plot.js", include_str!("../../page/plot.js")),
    ("components.js", include_str!("../../page/components.js")),
    ("component.js", include_str!("../../page/component.js")),
    ("panels.js", include_str!("../../page/panels.js")),
];

/// The page.
pub(super) async fn index() -> Response {
    html(INDEX)
}

/// The page of a run that has ended.
pub(super) async fn finished() -> Response {
    html(FINISHED)
}

/// The form for a token.
pub(super) async fn login() -> Response {
    html(FORM)
}

/// The form, after a wrong token.
pub(super) fn login_again() -> Response {
    html(FORM.replace(PLACE_OF_WRONG, WRONG))
}

fn html(text: impl Into<Cow<'static, str>>) -> Response {
    Html(text.into()).into_response()
}

/// The routes of the files, which tell nothing of a fleet.
pub(super) fn assets() -> Router {
    Router::new().route("/assets/{file}", get(asset)).route("/assets/views/{view}/{file}", get(of_view))
}

async fn asset(Path(file): Path<String>) -> Result<Response, Refusal> {
    let found = FILES.iter().find(|(name, _)| *name == file);
    found.and_then(|(_, text)| served(&file, text)).ok_or_else(Refusal::not_found)
}

async fn of_view(Path((view, file)): Path<(String, String)>) -> Result<Response, Refusal> {
    let view = DashboardView::linked().into_iter().find(|one| one.name == view);
    let found = view.and_then(|view| view.files.iter().find(|(name, _)| *name == file));
    found.and_then(|(_, text)| served(&file, text)).ok_or_else(Refusal::not_found)
}

/// A file with the type that the ending of its name says.
fn served(name: &str, text: &'static str) -> Option<Response> {
    let (_, ending) = name.rsplit_once('.')?;
    let (_, kind) = TYPES.iter().find(|(one, _)| *one == ending)?;
    Some(([("content-type", *kind)], text).into_response())
}

/// What the page has to know of who looks at it, and of what there is to see.
pub(super) async fn session(Extension(right): Extension<Right>) -> Answer {
    json_text(json!({"right": right.name(), "views": views()}).to_string())
}

/// The names and titles of the views.
pub(super) fn views() -> Vec<Value> {
    DashboardView::linked().iter().map(|view| json!({"name": view.name, "title": view.title})).collect()
}
