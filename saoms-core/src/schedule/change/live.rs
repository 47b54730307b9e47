//! Properties that change while their component runs: it takes the new value between two executions, or refuses it.

use std::fmt;
use std::sync::Arc;
use std::time::{Duration, Instant};

use saoms_api::Failure;
use saoms_api::host::PropertyValue;
use saoms_api::host::contain::contained;
use saoms_api::rule::nearest;
use saoms_lang::assembly::ComponentSpec;
use smol_str::SmolStr;

use crate::schedule::engine::RunPhase;
use crate::schedule::inject::OUTSIDE_NAME;
use crate::schedule::shared::Shared;

/// Maximum time that a new value waits for running code.
const WAIT: Duration = Duration::from_millis(500);

/// Error of a property that was not set. The component goes on with the value that it has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SetError {
    /// The fleet has no such component.
    UnknownComponent(String),
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
    /// The run ends.
    Ending,
}

impl fmt::Display for SetError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let can_be_set = |formatter: &mut fmt::Formatter<'_>, live: &[String]| match live {
            [] => formatter.write_str("none of its properties can change while it runs"),
            live => write!(formatter, "it can set `{}`", live.join("`, `")),
        };
        match self {
            SetError::UnknownComponent(component) => write!(formatter, "the fleet has no component `{component}`"),
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
            SetError::Ending => formatter.write_str("the run ends"),
        }
    }
}

impl std::error::Error for SetError {}

/// Gives a component a new value of a property, as text. Restarts have it, too.
pub(crate) fn set(shared: &Arc<Shared>, component: &str, property: &str, text: &str) -> Result<(), SetError> {
    let _one_at_a_time = shared.lock_changes();
    let (number, spec) = {
        let engine = shared.lock();
        let number = engine.numbers.get(component).copied();
        let member = number.map(|number| (number, &engine.slots[number as usize])).filter(|(_, slot)| slot.is_member());
        let Some((number, slot)) = member else {
            return Err(SetError::UnknownComponent(component.to_owned()));
        };
        (number, Arc::clone(&slot.spec))
    };
    let changed = changed(&spec, property, text)?;
    let not_now = |why: &str| SetError::NotNow { component: component.to_owned(), why: why.to_owned() };
    let deadline = Instant::now() + WAIT;
    let mut engine = shared.lock();
    let mut body = loop {
        if matches!(engine.phase, RunPhase::Stopping | RunPhase::Ended) {
            return Err(SetError::Ending);
        }
        if engine.slots[number as usize].body.is_some() && !engine.slots[number as usize].is_alive() {
            return Err(not_now("it does not run"));
        }
        if let Some(body) = engine.take(number) {
            break body;
        }
        let left = deadline.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(not_now("its code has not returned yet"));
        }
        engine = shared.wait_for_return(engine, left);
    };
    shared.release(engine);
    let updated = match &mut body.instance {
        Some(instance) => contained(|| instance.update(&changed.values)).and_then(|updated| updated),
        None => Err(Failure::new("it has just ended")),
    };
    let mut engine = shared.lock();
    if updated.is_ok() {
        let changed = Arc::new(changed);
        body.part.spec = Arc::clone(&changed);
        engine.slots[number as usize].spec = changed;
        let now = shared.clock.now();
        engine.record_outside(now, OUTSIDE_NAME, format!("set {component} {property}={text}"));
    }
    engine.return_unchanged(number, body, shared.clock.now());
    shared.release(engine);
    updated.map_err(|failure| SetError::Refused { component: component.to_owned(), failure })
}

/// The specification with a new value.
fn changed(spec: &ComponentSpec, property: &str, text: &str) -> Result<ComponentSpec, SetError> {
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
