//! Services that components offer over the web (`binding.rest`): `POST` to the path of a service and the name of an
//! operation, with the arguments as JSON.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use axum::body::{Bytes, to_bytes};
use axum::extract::{Request, State};
use axum::http::header::CONTENT_TYPE;
use axum::http::{HeaderMap, Method, StatusCode};
use axum::response::{IntoResponse, Response};
use saoms_api::host::format_duration;
use saoms_api::rule::nearest;
use saoms_core::schedule::{OfferedService, Order, OrderError, OrderWithdrawal};
use saoms_lang::OperationSchema;
use saoms_lang::assembly::CALL_DEADLINE;
use saoms_lang::model::WebPath;
use serde_json::{Map, Value, json};
use tokio::sync::Semaphore;

use super::answer::{Refusal, json_text, waiting};
use super::fleet::ControlledFleet;
use super::orders::commit;
use super::problem::{self, Problem, is_of_services};

/// Calls at a time: each has a thread that waits for its answer, and the server has others to serve.
const MOST: usize = 128;

/// The places for calls.
#[derive(Clone, Debug)]
pub(super) struct CallPlaces(Arc<Semaphore>);

impl CallPlaces {
    /// True while somebody waits for the answer to a call.
    pub(super) fn are_waiting(&self) -> bool {
        self.0.available_permits() < MOST
    }
}

impl Default for CallPlaces {
    fn default() -> CallPlaces {
        CallPlaces(Arc::new(Semaphore::new(MOST)))
    }
}

/// Answers a request for a path that is not one of the server.
pub(super) async fn serve(State(fleet): State<Arc<ControlledFleet>>, request: Request) -> Response {
    if !is_of_services(request.uri().path()) {
        return Refusal::not_found().into_response();
    }
    let services = match offered(&fleet).await {
        Ok(services) => services,
        Err(refusal) => return refusal.into_response(),
    };
    if services.is_empty() {
        return Refusal::not_found().into_response();
    }
    match answered(fleet, &services, request).await {
        Ok(response) => response,
        Err(problem) => problem.into_response(),
    }
}

/// The services that are offered now.
pub(super) async fn offered(fleet: &Arc<ControlledFleet>) -> Result<Arc<[OfferedService]>, Refusal> {
    let asked = Arc::clone(fleet);
    fleet.services.get(move || asked.handle.web_services()).await
}

async fn answered(
    fleet: Arc<ControlledFleet>,
    services: &[OfferedService],
    request: Request,
) -> Result<Response, Problem> {
    let path = WebPath::of_request(request.uri().path()).unwrap_or_default();
    let (service, operation) = found(services, &path)?;
    if request.method() != Method::POST {
        let detail = format!("an operation is called by `POST`, with its arguments as JSON: `{}`", operation.signature);
        return Err(Problem::new(StatusCode::METHOD_NOT_ALLOWED, detail));
    }
    is_json(request.headers())?;
    // It is here already.
    let body = to_bytes(request.into_body(), usize::MAX).await;
    let body = body.map_err(|error| Problem::new(StatusCode::BAD_REQUEST, error.to_string()))?;
    let arguments = read(&body)?;
    operation.encode_arguments(&arguments).map_err(|faults| Problem::of_arguments(&operation.signature, faults))?;
    let Value::Object(arguments) = arguments else {
        return Err(Problem::new(StatusCode::BAD_REQUEST, "the arguments are not an object"));
    };
    let order = Order::Call {
        component: format!("{}/{}", service.component, service.service.service),
        operation: operation.name.clone(),
        arguments: arguments.into_iter().collect(),
    };
    let deadline = service.service.deadline.unwrap_or(CALL_DEADLINE);
    let reply = call(fleet, order, deadline).await?;
    match operation.has_reply() {
        true => json_text(reply.to_string()).map_err(internal),
        false => Ok(StatusCode::NO_CONTENT.into_response()),
    }
}

/// The service at a path, and its operation.
fn found<'s>(services: &'s [OfferedService], path: &str) -> Result<(&'s OfferedService, &'s OperationSchema), Problem> {
    let not_found = |detail: String| Problem::new(StatusCode::NOT_FOUND, detail);
    // Of two paths one of which continues the other, the longer one is meant where it has the operation.
    let mut of_path: Vec<(&OfferedService, &str)> = services
        .iter()
        .filter_map(|one| match path == one.service.path.as_str() {
            true => Some((one, "")),
            false => Some((one, one.service.path.rest(path)?)),
        })
        .collect();
    of_path.sort_by_key(|(one, _)| std::cmp::Reverse(one.service.path.as_str().len()));
    for (service, name) in &of_path {
        if let Some(operation) = service.service.operations.iter().find(|one| one.name == *name) {
            return Ok((service, operation));
        }
    }
    let Some((service, name)) = of_path.first() else {
        let paths = || services.iter().map(|one| one.service.path.as_str());
        let parent = path.rsplit_once('/').map_or("", |(parent, _)| parent);
        let near = nearest(path, paths()).or_else(|| nearest(parent, paths()));
        let hint = near.map_or_else(
            || "`GET /v1/openapi.json` describes all services".to_owned(),
            |near| format!("did you mean `{near}`?"),
        );
        return Err(not_found(format!("there is no service at `{path}`; {hint}")));
    };
    let known = || service.service.operations.iter().map(|one| one.name.as_str());
    let all = known().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    let base = &service.service.path;
    Err(not_found(match nearest(name, known()) {
        _ if name.is_empty() => format!("`{base}` names no operation; the service has the operations {all}"),
        Some(near) => format!("the service at `{base}` has no operation `{name}`; did you mean `{near}`?"),
        None => format!("the service at `{base}` has no operation `{name}`; it has {all}"),
    }))
}

/// Refuses a body that says that it is something else than JSON.
fn is_json(headers: &HeaderMap) -> Result<(), Problem> {
    let Some(kind) = headers.get(CONTENT_TYPE) else { return Ok(()) };
    let kind = kind.to_str().unwrap_or_default();
    let essence = kind.split(';').next().unwrap_or_default().trim().to_ascii_lowercase();
    if essence == "application/json" || essence.ends_with("+json") {
        return Ok(());
    }
    let detail = format!("found the type `{kind}`, expected JSON: `Content-Type: application/json`");
    Err(Problem::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, detail))
}

/// The arguments in a body; none in an empty one.
fn read(body: &Bytes) -> Result<Value, Problem> {
    if body.trim_ascii().is_empty() {
        return Ok(Value::Object(Map::new()));
    }
    serde_json::from_slice(body)
        .map_err(|error| Problem::new(StatusCode::BAD_REQUEST, format!("the body is not JSON: {error}")))
}

fn internal(refusal: Refusal) -> Problem {
    Problem::new(StatusCode::INTERNAL_SERVER_ERROR, refusal.message())
}

/// Calls an operation, and waits for its reply until it is committed.
async fn call(fleet: Arc<ControlledFleet>, order: Order, deadline: Duration) -> Result<Value, Problem> {
    let Ok(place) = Arc::clone(&fleet.call_places.0).try_acquire_owned() else {
        return Err(Problem::busy(format!("{MOST} calls wait for their answers already: try again")));
    };
    // It is taken until the thread has its answer, and until that is on its way to the client.
    let place = Arc::new(place);
    let (handle, held) = (fleet.handle.clone(), Arc::clone(&place));
    let client = Client::default();
    let of_client = Arc::clone(&client.0);
    let answer = waiting(move || {
        let answer = handle.order(order, None).and_then(|ticket| {
            of_client.ordered(ticket.withdrawal());
            ticket.wait(deadline)
        });
        drop(held);
        answer
    });
    let reply = answer.await.map_err(internal)?.map_err(|error| refused(&error, deadline))?;
    // No status says that the same call may be made again: it has taken effect.
    commit(fleet).await.map_err(|refusal| {
        let why = refusal.message();
        let detail = format!("the call has taken effect, and whether that outlives the program is not known: {why}");
        Problem::new(StatusCode::GATEWAY_TIMEOUT, detail)
    })?;
    Ok(reply)
}

/// A client that waits for the answer to a call. Once it has hung up, which drops this, the call is withdrawn.
#[derive(Default)]
struct Client(Arc<ClientCall>);

#[derive(Default)]
struct ClientCall(Mutex<(bool, Option<OrderWithdrawal>)>);

impl ClientCall {
    fn lock(&self) -> MutexGuard<'_, (bool, Option<OrderWithdrawal>)> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes the way to withdraw its order.
    fn ordered(&self, withdrawal: OrderWithdrawal) {
        let mut call = self.lock();
        if call.0 {
            // It has hung up before that.
            withdrawal.withdraw();
        }
        call.1 = Some(withdrawal);
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        let mut call = self.0.lock();
        call.0 = true;
        if let Some(withdrawal) = call.1.take() {
            // One that has been answered has begun.
            withdrawal.withdraw();
        }
    }
}

/// The problem that an error of an order is.
fn refused(error: &OrderError, deadline: Duration) -> Problem {
    let within = || format!("no answer came within {}", format_duration(deadline));
    let (status, detail) = match error {
        OrderError::Busy(why) => return Problem::busy(why.as_str()),
        OrderError::NotYet => (
            StatusCode::GATEWAY_TIMEOUT,
            format!(
                "{}: the call has not begun, since the fleet still starts or is paused, or the code of the component \
                 has not returned; it is withdrawn",
                within()
            ),
        ),
        OrderError::Begun => (
            StatusCode::GATEWAY_TIMEOUT,
            format!("{}: the call has begun, and whether it takes effect is not known", within()),
        ),
        OrderError::Arguments(why) => (StatusCode::BAD_REQUEST, why.clone()),
        // It has just gone.
        OrderError::Component(_) | OrderError::Operation(_) => (StatusCode::NOT_FOUND, error.to_string()),
        OrderError::NotRunning(_) | OrderError::Ending => (StatusCode::SERVICE_UNAVAILABLE, error.to_string()),
        _ => (StatusCode::INTERNAL_SERVER_ERROR, error.to_string()),
    };
    Problem::new(status, detail)
}

/// Adds services to an OpenAPI document.
pub(super) fn describe(document: &mut Value, services: &[OfferedService]) {
    if services.is_empty() {
        return;
    }
    document["components"] = json!({"schemas": {"Problem": problem::schema()}});
    for one in services {
        for operation in one.service.operations.iter() {
            let path = one.service.path.of_operation(&operation.name);
            document["paths"][path] = json!({"post": described(one, operation)});
        }
    }
}

fn described(one: &OfferedService, operation: &OperationSchema) -> Value {
    let problem = |doc: &str| {
        let schema = json!({"$ref": "#/components/schemas/Problem"});
        json!({"description": doc, "content": {"application/problem+json": {"schema": schema}}})
    };
    let mut responses = json!({
        "400": problem("the arguments do not fit: `errors` has all faults"),
        "401": problem("the token is missing or wrong"),
        "403": problem("the token may only view"),
        "404": problem("the component is gone"),
        "405": problem("the method is not `POST`"),
        "408": problem("the body came too slowly"),
        "413": problem("the body is too long"),
        "415": problem("the body is not JSON"),
        "500": problem("the component failed in the call"),
        "503": problem("the component does not run, or is busy: with `Retry-After`, try again"),
        "504": problem(
            "no answer came within the deadline, or what the call did is not committed: `detail` says whether it has begun"
        ),
    });
    match operation.reply_schema() {
        Some(schema) => {
            responses["200"] = json!({"description": "the reply", "content": {"application/json": {"schema": schema}}});
        }
        None => responses["204"] = json!({"description": "done"}),
    }
    let arguments = operation.arguments_schema();
    let is_required = arguments["required"].as_array().is_some_and(|names| !names.is_empty());
    json!({
        "summary": operation.signature,
        "description": format!(
            "An operation of service `{}` of component `{}`, with the interface `{}`.",
            one.service.service, one.component, one.service.interface
        ),
        "tags": [format!("{}/{}", one.component, one.service.service)],
        "requestBody": {
            "description": "the arguments by their names",
            "required": is_required,
            "content": {"application/json": {"schema": arguments}},
        },
        "responses": responses,
    })
}
