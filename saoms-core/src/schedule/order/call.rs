//! A call of an operation by its declaration alone: arguments and reply are JSON.

use std::any::Any;

use saoms_api::CallError;
use saoms_api::host::ServiceCall;
use saoms_api::rule::nearest;
use saoms_lang::OperationSchema;
use saoms_lang::assembly::ComponentSpec;
use serde_json::{Map, Value};

use super::OrderError;

/// A call with its arguments, and its reply once it came back.
#[derive(Debug)]
pub(super) struct JsonCall {
    /// The service in the provider's declaration.
    pub(super) service: String,
    operation: OperationSchema,
    arguments: Vec<u8>,
    reply: Value,
}

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
        let form = OperationSchema::of(declared, number).map_err(|error| OrderError::Operation(error.to_string()))?;
        let arguments = encoded(&form, declared, arguments)
            .map_err(|error| OrderError::Arguments(format!("operation `{}`: {error}", form.signature)))?;
        Ok(JsonCall { service: service.to_owned(), operation: form, arguments, reply: Value::Null })
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
fn encoded(form: &OperationSchema, declared: &Value, arguments: &[(String, Value)]) -> Result<Vec<u8>, String> {
    let fields = declared["arguments"].as_array().map(Vec::as_slice).unwrap_or_default();
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
    if let (true, Some((name, _))) = (fields.is_empty(), arguments.first()) {
        return Err(format!("it takes no arguments, found `{name}`"));
    }
    form.encode_arguments(&Value::Object(given)).map_err(|error| error.to_string())
}

impl ServiceCall for JsonCall {
    fn operation(&self) -> u32 {
        self.operation.number
    }

    fn typed(&mut self) -> Option<(&mut dyn Any, &mut dyn Any)> {
        None
    }

    fn arguments(&mut self) -> Vec<u8> {
        self.arguments.clone()
    }

    fn reply(&mut self, bytes: &[u8]) -> Result<(), CallError> {
        let reply = self.operation.decode_reply(bytes);
        self.reply = reply.map_err(|error| CallError::Mismatch { message: error.to_string() })?;
        Ok(())
    }
}
