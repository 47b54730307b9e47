//! A call of an operation by its declaration alone: arguments and reply are JSON.

use std::any::Any;

use saoms_api::CallError;
use saoms_api::host::{ServiceCall, cdr};
use saoms_api::rule::nearest;
use saoms_lang::assembly::ComponentSpec;
use saoms_lang::schema::Schema;
use serde_json::{Map, Value, json};

use super::OrderError;

/// A call with its arguments, and its reply once it came back.
#[derive(Debug)]
pub(super) struct JsonCall {
    /// The service in the provider's declaration.
    pub(super) service: String,
    operation: u32,
    arguments: Vec<u8>,
    /// The schema of a message with the reply as its only field; `None` for an operation without one.
    reply_schema: Option<Schema>,
    reply: Value,
}

/// The name of the field of that message.
const REPLY: &str = "reply";

impl JsonCall {
    /// The call of an operation that a component offers, in this of its services if one is named.
    ///
    /// # Errors
    /// It offers none of this name, or the arguments do not fit.
    pub(super) fn new(
        spec: &ComponentSpec,
        service: Option<&str>,
        operation: &str,
        arguments: &[(String, Value)],
    ) -> Result<JsonCall, OrderError> {
        let declaration = spec.class.declaration();
        let own = declaration.offers().filter(|offered| !offered.is_of_host());
        let services: Vec<_> = own.filter(|offered| service.is_none_or(|service| offered.name == service)).collect();
        let operations = services.iter().flat_map(|offered| {
            let all = offered.interface.operations.as_array().map(Vec::as_slice).unwrap_or_default();
            all.iter().zip(0_u32..).map(|(one, number)| (offered.name.as_str(), one, number))
        });
        let operations: Vec<(&str, &Value, u32)> = operations.collect();
        let name = |one: &Value| one["name"].as_str().unwrap_or_default().to_owned();
        let mut meant = operations.iter().filter(|(_, one, _)| name(one) == operation);
        let (service, declared, number) = match (meant.next(), meant.next()) {
            (Some(one), None) => *one,
            (Some((first, ..)), Some((second, ..))) => {
                let message = format!(
                    "component `{}` offers `{operation}` in the services `{first}` and `{second}`: write \
                     `{}/{first}.{operation}`",
                    spec.path, spec.path
                );
                return Err(OrderError::Operation(message));
            }
            (None, _) => {
                return Err(unknown(spec, operation, operations.iter().map(|(_, one, _)| name(one)).collect()));
            }
        };
        let reply = &declared["reply"];
        let reply_schema = (!reply.is_null())
            .then(|| Schema::of(&json!({"name": REPLY, "fields": [{"name": REPLY, "type": reply}]})))
            .transpose()
            .map_err(|error| OrderError::Operation(error.to_string()))?;
        let arguments = encoded(declared, arguments).map_err(|error| {
            let signature = saoms_lang::registry::signature(declared);
            OrderError::Arguments(format!("operation `{signature}`: {error}"))
        })?;
        Ok(JsonCall { service: service.to_owned(), operation: number, arguments, reply_schema, reply: Value::Null })
    }

    /// The reply; `null` where there is none.
    pub(super) fn into_reply(self) -> Value {
        self.reply
    }
}

fn unknown(spec: &ComponentSpec, operation: &str, known: Vec<String>) -> OrderError {
    let path = &spec.path;
    let near = nearest(operation, known.iter().map(String::as_str));
    OrderError::Operation(match (near, &known[..]) {
        (Some(near), _) => format!("component `{path}` offers no operation `{operation}`; did you mean `{near}`?"),
        (None, []) => format!("component `{path}` offers no operations"),
        (None, all) => {
            format!("component `{path}` offers no operation `{operation}`; it offers `{}`", all.join("`, `"))
        }
    })
}

/// The arguments in CDR.
fn encoded(declared: &Value, arguments: &[(String, Value)]) -> Result<Vec<u8>, String> {
    let fields = declared["arguments"].as_array().cloned().unwrap_or_default();
    let mut given = Map::new();
    for (name, value) in arguments {
        let field = fields.iter().find(|field| field["name"] == name.as_str());
        // A word that is also a number or a truth value is a text where one is expected.
        let is_text = field.is_some_and(|field| field["type"] == "string" || field["type"]["bounded"] == "string");
        let value = if is_text && !value.is_string() { Value::from(value.to_string()) } else { value.clone() };
        if given.insert(name.clone(), value).is_some() {
            return Err(format!("argument `{name}` is given twice"));
        }
    }
    if fields.is_empty() {
        return match arguments.first() {
            Some((name, _)) => Err(format!("it takes no arguments, found `{name}`")),
            None => Ok(cdr::encode(&())),
        };
    }
    let schema = Schema::of(&json!({"name": declared["name"], "fields": fields})).map_err(|error| error.to_string())?;
    schema.encode(&Value::Object(given)).map_err(|error| error.to_string())
}

impl ServiceCall for JsonCall {
    fn operation(&self) -> u32 {
        self.operation
    }

    fn typed(&mut self) -> Option<(&mut dyn Any, &mut dyn Any)> {
        None
    }

    fn arguments(&mut self) -> Vec<u8> {
        self.arguments.clone()
    }

    fn reply(&mut self, bytes: &[u8]) -> Result<(), CallError> {
        let Some(schema) = &self.reply_schema else { return Ok(()) };
        let message = schema.decode(bytes).map_err(|error| CallError::Mismatch { message: error.to_string() })?;
        self.reply = message[REPLY].clone();
        Ok(())
    }
}
