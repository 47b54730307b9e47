//! Schemas of messages as JSON Schema (2020-12), which OpenAPI 3.1 takes.

use serde_json::{Map, Value, json};

use super::{Number, Schema, Type};

impl Schema {
    /// The JSON Schema of what [`decode`](Schema::decode) gives and [`encode`](Schema::encode) takes.
    ///
    /// ```
    /// use saoms_registry::schema::Schema;
    ///
    /// let schema = r#"{"name":"Lamp","fields":[{"name":"on","type":"bool"},
    ///     {"name":"note","type":{"optional":"string"}}]}"#;
    /// let schema = Schema::parse(schema)?.json_schema();
    /// assert_eq!(schema["properties"]["on"], serde_json::json!({"type": "boolean"}));
    /// assert_eq!(schema["required"], serde_json::json!(["on"]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn json_schema(&self) -> Value {
        let properties: Map<String, Value> =
            self.fields.iter().map(|field| (field.name.clone(), of_type(&field.kind))).collect();
        let is_required = |kind: &Type| !matches!(kind, Type::Optional(_));
        let required: Vec<&str> =
            self.fields.iter().filter(|field| is_required(&field.kind)).map(|field| field.name.as_str()).collect();
        json!({
            "type": "object",
            "title": self.name,
            "properties": properties,
            "required": required,
            "additionalProperties": false,
        })
    }

    /// The JSON Schema of a field.
    pub(crate) fn field_schema(&self, name: &str) -> Option<Value> {
        self.fields.iter().find(|field| field.name == name).map(|field| of_type(&field.kind))
    }
}

fn of_type(kind: &Type) -> Value {
    match kind {
        Type::Bool => json!({"type": "boolean"}),
        Type::Number(number) if number.is_float() => json!({
            "oneOf": [{"type": "number"}, {"type": "string", "enum": ["NaN", "inf", "-inf"]}],
        }),
        Type::Number(number) => integer(*number),
        Type::Time => {
            let mut time = integer(Number::Uint64);
            time["description"] = "nanoseconds since the start of the run".into();
            time
        }
        Type::String => json!({"type": "string"}),
        Type::Sequence(element) => json!({"type": "array", "items": of_type(element)}),
        Type::Array(element, count) => {
            json!({"type": "array", "items": of_type(element), "minItems": count, "maxItems": count})
        }
        Type::Bounded(content, most) => {
            let mut content = of_type(content);
            match content["type"] == "array" {
                true => content["maxItems"] = (*most).into(),
                false => {
                    content["maxLength"] = (*most).into();
                    content["description"] = format!("at most {most} bytes in UTF-8").into();
                }
            }
            content
        }
        Type::Optional(element) => json!({"anyOf": [of_type(element), {"type": "null"}]}),
        Type::Enumeration(_, values) => {
            json!({"type": "string", "enum": values.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>()})
        }
        Type::Message(schema) => schema.json_schema(),
    }
}

fn integer(number: Number) -> Value {
    let (least, greatest) = number.bounds();
    // All bounds are of 64 bits or less.
    let bound = |bound: i128| i64::try_from(bound).map_or_else(|_| (bound as u64).into(), Value::from);
    json!({"type": "integer", "minimum": bound(least), "maximum": bound(greatest)})
}
