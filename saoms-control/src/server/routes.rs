//! The routes of the server: one table, from which the router and the OpenAPI document are made.

use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::extract::{Query, Request, State};
use axum::http::Method;
use axum::middleware::{Next, from_fn, from_fn_with_state};
use axum::response::IntoResponse;
use axum::response::Response;
use axum::routing::{MethodRouter, get, post, put};
use saoms_api::host::parse_duration;
use saoms_api::{Cause, Time};
use serde::Deserialize;
use serde_json::{Value, json};

use super::answer::{Answer, Refusal, done, json_text, waiting};
use super::body::with_body;
use super::fleet::ControlledFleet;
use super::{alerts, change, logs, orders, page, services, stream, time, topics};

type Fleet = State<Arc<ControlledFleet>>;

/// The lines of the log that a client gets unless it says how many.
const LINES: usize = 100;

/// What a picture may load where it is looked at alone: nothing; it brings its style along.
const PICTURE: &str = "default-src 'none'; style-src 'unsafe-inline'; frame-ancestors 'none'; sandbox";

/// What describes a wanted fleet.
const CHANGE: &str = "an object in JSON: the `folder` from which paths go, `files`, and where they are needed `set`, `severities`, `plugins`, `allow_outside`, `max_size`, `coloured`, `allow_loss`, `wait_ms` and `by`";

/// Time between the order to end and the end.
const BEFORE_END: Duration = Duration::from_millis(20);

/// A route.
struct Route {
    method: &'static str,
    path: &'static str,
    /// What it does.
    doc: &'static str,
    /// The parameters of its query, with what they are.
    query: &'static [(&'static str, &'static str)],
    /// What its body is.
    body: Option<&'static str>,
    serve: fn() -> MethodRouter<Arc<ControlledFleet>>,
}

const ROUTES: &[Route] = &[
    Route {
        method: "get",
        path: "/v1/fleet",
        doc: "Name, process and composites of the fleet.",
        query: &[],
        body: None,
        serve: || get(describe),
    },
    Route {
        method: "get",
        path: "/v1/status",
        doc: "A snapshot of the fleet and of each component, at most 100 ms old.",
        query: &[],
        body: None,
        serve: || get(status),
    },
    Route {
        method: "get",
        path: "/v1/logs",
        doc: "The newest lines of the log as a list, or with `follow=true` as server-sent events.",
        query: &[("lines", "the number of lines"), ("follow", "`true` to also receive new lines")],
        body: None,
        serve: || get(log_lines),
    },
    Route {
        method: "get",
        path: "/v1/why",
        doc: "The records of the journal that explain what a component did, in the form of a report, as `saoms why` reads it; `answer` is what follows from them.",
        query: &[
            ("component", "its path, its ID, or an ending of its path"),
            ("at", "explain the last action before this time of the run, such as `10s`; without it, before now"),
        ],
        body: None,
        serve: || get(why),
    },
    Route {
        method: "get",
        path: "/v1/journal",
        doc: "The newest records of the journal that a component wrote, oldest first.",
        query: &[
            ("component", "its path, its ID, or an ending of its path"),
            ("after", "the number of a record: only those after it"),
            ("lines", "the most records; 100 without it"),
        ],
        body: None,
        serve: || get(journal),
    },
    Route {
        method: "get",
        path: "/v1/stream",
        doc: "What changes in the fleet as server-sent events, for a page that shows it: `status` with what differs, `alerts`, `log`, `topic` and `records`.",
        query: &[
            ("topics", "the topics whose messages to send, separated by blanks"),
            ("component", "the component whose records of the journal to send"),
            ("lines", "the number of lines of the log from before; 100 without it"),
        ],
        body: None,
        serve: || get(stream::stream),
    },
    Route {
        method: "get",
        path: "/v1/figures",
        doc: "Figures of the fleet over time, from the start of the run: `plots` are their titles, units and lines, `rows` the times in seconds with the values of all lines.",
        query: &[("after", "a time of the run in seconds: only the rows after it")],
        body: None,
        serve: || get(figures),
    },
    Route {
        method: "get",
        path: "/v1/picture.svg",
        doc: "The picture of the composites, as `saoms graph` draws it.",
        query: &[],
        body: None,
        serve: || get(picture),
    },
    Route {
        method: "get",
        path: "/v1/session",
        doc: "The `right` of the client, `view` or `control`, and the `views` of the dashboard.",
        query: &[],
        body: None,
        serve: || get(page::session),
    },
    Route {
        method: "get",
        path: "/v1/alerts",
        doc: "The alerts as a list, or with `follow=true` as server-sent events: the list, then each change.",
        query: &[("follow", "`true` to also receive changes")],
        body: None,
        serve: || get(alerts::list),
    },
    Route {
        method: "post",
        path: "/v1/alerts/ack",
        doc: "Acknowledges alerts; `acknowledged` has their numbers.",
        query: &[("by", "who acknowledges them, for the log")],
        body: Some("the numbers of the alerts, separated by blanks; without any, all alerts that are not acknowledged"),
        serve: || post(alerts::acknowledge),
    },
    Route {
        method: "post",
        path: "/v1/events",
        doc: "Sends a line of events, or an order, in the language of `saoms run --events`.",
        query: &[],
        body: Some("a line of events, or an order"),
        serve: || post(orders::send),
    },
    Route {
        method: "post",
        path: "/v1/components/{component}/start",
        doc: "Schedules a periodic component.",
        query: &[("for", "the time after which it is stopped again, such as `10s`")],
        body: None,
        serve: || post(orders::start),
    },
    Route {
        method: "post",
        path: "/v1/components/{component}/stop",
        doc: "Unschedules a periodic component.",
        query: &[],
        body: None,
        serve: || post(orders::stop),
    },
    Route {
        method: "put",
        path: "/v1/components/{component}/properties/{property}",
        doc: "Changes a property that is declared `live`.",
        query: &[],
        body: Some("the value, as a composite writes it"),
        serve: || put(orders::set),
    },
    Route {
        method: "post",
        path: "/v1/components/{component}/operations/{operation}",
        doc: "Calls an operation of a service that the component offers; `reply` is its reply.",
        query: &[],
        body: Some("the arguments in JSON, by their names"),
        serve: || post(orders::call),
    },
    Route {
        method: "post",
        path: "/v1/plan",
        doc: "Says what would change if the fleet became that of other files, which the program of the fleet reads: `diagnostics` and `text` are what was found in them, `plan` is `null` where they describe no fleet. At the socket of the user alone.",
        query: &[],
        body: Some(CHANGE),
        serve: || post(change::plan),
    },
    Route {
        method: "post",
        path: "/v1/apply",
        doc: "The same, and changes the fleet: `applied` says whether, and `failure` has the `error` if not; the fleet is as it was then. At the socket of the user alone.",
        query: &[],
        body: Some(CHANGE),
        serve: || post(change::apply),
    },
    Route {
        method: "get",
        path: "/v1/topics",
        doc: "The topics with their publishers, their readers, and the number of events that wait for each reader.",
        query: &[],
        body: None,
        serve: || get(topics::list),
    },
    Route {
        method: "get",
        path: "/v1/topics/{topic}/messages",
        doc: "The messages of a topic as server-sent events; the retained messages of a state topic come first, as events `retained`.",
        query: &[],
        body: None,
        serve: || get(topics::echo),
    },
    Route {
        method: "post",
        path: "/v1/topics/{topic}/messages",
        doc: "Publishes a message on a topic at the next instant.",
        query: &[],
        body: Some("the message in JSON"),
        serve: || post(topics::publish),
    },
    Route {
        method: "post",
        path: "/v1/pause",
        doc: "Pauses the fleet; `time_s` is the time of the pause.",
        query: &[],
        body: None,
        serve: || post(time::pause),
    },
    Route {
        method: "post",
        path: "/v1/resume",
        doc: "Resumes a paused fleet.",
        query: &[],
        body: None,
        serve: || post(time::resume),
    },
    Route {
        method: "post",
        path: "/v1/step",
        doc: "Lets virtual time advance, then pauses; `time_s` is the time of that pause.",
        query: &[("for", "the time, such as `10s`; without it, through the next instant at which something is due")],
        body: None,
        serve: || post(time::step),
    },
    Route {
        method: "put",
        path: "/v1/speed",
        doc: "Sets how fast virtual time passes.",
        query: &[],
        body: Some("seconds of virtual time in a second, or `max`"),
        serve: || put(time::speed),
    },
    Route {
        method: "post",
        path: "/v1/estop",
        doc: "Stops components and their hardware at once, until they are released; `reply` has their names.",
        query: &[("by", "the name of the operator, for the journal")],
        body: Some(
            "the paths of the components, separated by blanks; without any, all components that an emergency stop affects",
        ),
        serve: || post(orders::stop_at_once),
    },
    Route {
        method: "post",
        path: "/v1/release",
        doc: "Releases components that were stopped; `reply` has their names.",
        query: &[("by", "the name of the operator, for the journal")],
        body: Some("the paths of the components, separated by blanks; without any, all stopped components"),
        serve: || post(orders::release),
    },
    Route {
        method: "post",
        path: "/v1/down",
        doc: "Ends the fleet: its components shut down. The answer comes before the end.",
        query: &[],
        body: None,
        serve: || post(down),
    },
    Route {
        method: "get",
        path: "/metrics",
        doc: "The metrics of the fleet in the text format of Prometheus, at most 100 ms old.",
        query: &[],
        body: None,
        serve: || get(metrics),
    },
    Route {
        method: "get",
        path: "/v1/openapi.json",
        doc: "This document, with the services that components offer over the web (`binding.rest`).",
        query: &[],
        body: None,
        serve: || get(document),
    },
];

/// The router of a fleet.
pub(super) fn router(fleet: Arc<ControlledFleet>) -> Router {
    let mut router = Router::new();
    for route in ROUTES {
        router = router.route(route.path, (route.serve)());
    }
    let router = router.route("/", get(page::index));
    let router = router.fallback(services::serve);
    let router = router.layer(from_fn_with_state(Arc::clone(&fleet), seen_at_once));
    router.layer(from_fn(with_body)).with_state(fleet)
}

/// Lets the next snapshot show what an order did.
async fn seen_at_once(State(fleet): Fleet, request: Request, next: Next) -> Response {
    let is_order = request.method() != Method::GET;
    let response = next.run(request).await;
    if is_order {
        fleet.snapshot.forget().await;
        fleet.status.forget().await;
    }
    response
}

/// The OpenAPI document of the server, without the services that a fleet offers over the web.
pub fn openapi() -> Value {
    let mut paths = serde_json::Map::new();
    for route in ROUTES {
        let text = json!({"type": "string"});
        let in_path = route.path.split('/').filter_map(|part| part.strip_prefix('{')?.strip_suffix('}'));
        let in_path = in_path.map(|name| json!({"name": name, "in": "path", "required": true, "schema": text}));
        let in_query = route.query.iter();
        let in_query =
            in_query.map(|(name, doc)| json!({"name": name, "in": "query", "description": doc, "schema": text}));
        let mut operation = json!({
            "summary": route.doc,
            "parameters": in_path.chain(in_query).collect::<Vec<_>>(),
            "responses": {
                "200": {"description": "done"},
                "422": {"description": "refused: `error` says why"},
            },
        });
        if let Some(body) = route.body {
            let content = json!({"text/plain": {"schema": text}});
            operation["requestBody"] = json!({"description": body, "required": true, "content": content});
        }
        let path = paths.entry(route.path).or_insert_with(|| json!({}));
        path[route.method] = operation;
    }
    let info = json!({"title": "Control of a SAOMS fleet", "version": env!("CARGO_PKG_VERSION")});
    json!({"openapi": "3.1.0", "info": info, "paths": paths})
}

async fn describe(State(fleet): Fleet) -> Answer {
    json_text(json!(fleet.description()).to_string())
}

async fn status(State(fleet): Fleet) -> Answer {
    let asked = Arc::clone(&fleet);
    json_text(fleet.snapshot.get(move || asked.snapshot_text()).await?)
}

#[derive(Deserialize)]
struct LogQuery {
    lines: Option<usize>,
    #[serde(default)]
    follow: bool,
}

async fn log_lines(State(fleet): Fleet, Query(query): Query<LogQuery>) -> Answer {
    let most = query.lines.unwrap_or(LINES);
    match query.follow {
        true => logs::followed(&fleet, most),
        false => logs::newest(&fleet.log, most),
    }
}

#[derive(Deserialize)]
struct WhyQuery {
    component: String,
    at: Option<String>,
}

async fn why(State(fleet): Fleet, Query(query): Query<WhyQuery>) -> Answer {
    let at = query.at.as_deref().map(parse_duration).transpose().map_err(Refusal::unprocessable)?;
    let at = at.map(|at| Time::START + at);
    let answer = waiting(move || -> Result<String, String> {
        let found = fleet.handle.why(&query.component, at)?;
        let component = found.components.first().map(|one| one.name.as_str()).unwrap_or_default();
        let mut answer = json!(found);
        // What was overwritten is missing from the records, too.
        answer["answer"] = json!(found.journal.why(component, at).ok());
        Ok(answer.to_string())
    });
    json_text(answer.await?.map_err(Refusal::unprocessable)?)
}

#[derive(Deserialize)]
struct JournalQuery {
    component: String,
    #[serde(default)]
    after: u64,
    lines: Option<usize>,
}

async fn journal(State(fleet): Fleet, Query(query): Query<JournalQuery>) -> Answer {
    let JournalQuery { component, after, lines } = query;
    let most = lines.unwrap_or(LINES);
    let records = waiting(move || fleet.handle.records(&component, Cause(after), most)).await?;
    json_text(json!(records.map_err(Refusal::unprocessable)?).to_string())
}

#[derive(Deserialize)]
struct FiguresQuery {
    after: Option<f64>,
}

async fn figures(State(fleet): Fleet, Query(query): Query<FiguresQuery>) -> Answer {
    json_text(fleet.figures.json(query.after).to_string())
}

async fn picture(State(fleet): Fleet) -> Answer {
    let svg = waiting(move || (fleet.picture)()).await?.map_err(Refusal::unprocessable)?;
    Ok(([("content-type", "image/svg+xml"), ("content-security-policy", PICTURE)], svg).into_response())
}

async fn metrics(State(fleet): Fleet) -> Answer {
    let asked = Arc::clone(&fleet);
    let text = fleet.metrics.get(move || asked.metrics_text()).await?;
    Ok(([("content-type", "text/plain; version=0.0.4; charset=utf-8")], text).into_response())
}

async fn down(State(fleet): Fleet) -> Answer {
    tokio::spawn(async move {
        // The answer leaves before.
        tokio::time::sleep(BEFORE_END).await;
        (fleet.down)();
    });
    done()
}

async fn document(State(fleet): Fleet) -> Answer {
    let mut document = openapi();
    services::describe(&mut document, &services::offered(&fleet).await?);
    json_text(document.to_string())
}

#[cfg(test)]
mod tests {
    use saoms_lang::model::RESERVED;

    use super::ROUTES;

    #[test]
    fn no_service_can_have_a_path_of_the_server() {
        for route in ROUTES {
            let first = route.path.trim_start_matches('/').split('/').next().unwrap_or_default();
            assert!(RESERVED.contains(&first), "{} is not among the reserved paths", route.path);
        }
        for path in [super::super::session::LOGIN, "/logout", "/assets/app.js"] {
            assert!(RESERVED.iter().any(|first| path[1..].starts_with(first)), "{path}");
        }
    }
}
