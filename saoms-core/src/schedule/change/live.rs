//! Properties that change while their component runs: it takes the new value between two executions, or refuses it.

use std::fmt;

use saoms_api::Failure;
use saoms_api::host::PropertyValue;
use saoms_api::rule::nearest;
use saoms_lang::assembly::ComponentSpec;
use smol_str::SmolStr;

/// Error of a property that was not set. The component goes on with the value that it has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SetError {
    /// The class of the component has no such property.
    UnknownProperty {
        /// Its class.
        class: String,
        /// The name that was found.
        property: String,
        /// The properties that can be set.
        live: Vec<String>,
    },
    /// The property cannot change while the component runs.
    NotLive {
        /// Its class.
        class: String,
        /// The property.
        property: String,
        /// The properties that can be set.
        live: Vec<String>,
    },
    /// The value is none of the property.
    Wrong {
        /// The property.
        property: String,
        /// What was found and what was expected.
        message: String,
    },
    /// The component does not run, or its code does not return: a later try may succeed.
    NotNow {
        /// Its path.
        component: String,
        /// The reason.
        why: String,
    },
    /// The component refuses the value.
    Refused {
        /// Its path.
        component: String,
        /// The reason.
        failure: Failure,
    },
}

impl fmt::Display for SetError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let can_be_set = |formatter: &mut fmt::Formatter<'_>, live: &[String]| match live {
            [] => formatter.write_str("none of its properties can change while it runs"),
            live => write!(formatter, "it can set `{}`", live.join("`, `")),
        };
        match self {
            SetError::UnknownProperty { class, property, live } => {
                write!(formatter, "class `{class}` has no property `{property}`: ")?;
                match nearest(property, live.iter().map(String::as_str)) {
                    Some(meant) => write!(formatter, "did you mean `{meant}`?"),
                    None => can_be_set(formatter, live),
                }
            }
            SetError::NotLive { class, property, live } => {
                write!(formatter, "property `{property}` of class `{class}` cannot change while the component runs: ")?;
                can_be_set(formatter, live)
            }
            SetError::Wrong { property, message } => write!(formatter, "property `{property}`: {message}"),
            SetError::NotNow { component, why } => write!(formatter, "component `{component}`: {why}"),
            SetError::Refused { component, failure } => {
                write!(formatter, "component `{component}` refuses the value: {failure}")
            }
        }
    }
}

impl std::error::Error for SetError {}

/// The specification with a new value.
pub(crate) fn changed(spec: &ComponentSpec, property: &str, text: &str) -> Result<ComponentSpec, SetError> {
    let class = spec.class.declaration();
    let live: Vec<String> = class.properties.iter().filter(|one| one.live).map(|one| one.name.clone()).collect();
    let (name, property) = (class.name.clone(), property.to_owned());
    let Some(declared) = class.property(&property) else {
        return Err(SetError::UnknownProperty { class: name, property, live });
    };
    if !declared.live {
        return Err(SetError::NotLive { class: name, property, live });
    }
    let value = declared.check(text).map_err(|message| SetError::Wrong { property: property.clone(), message })?;
    let mut spec = spec.clone();
    let value = PropertyValue::from(value);
    match spec.values.iter_mut().find(|(known, _)| *known == property.as_str()) {
        Some((_, known)) => *known = value,
        None => spec.values.push((SmolStr::from(property.as_str()), value)),
    }
    spec.written = Default::default();
    Ok(spec)
}
