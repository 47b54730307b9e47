use std::fmt;
use std::ops::Range;

use crate::rule::Severity;

/// A place in a composite: a component, a property of it, or a part of the property's text.
///
/// A text is the value as the component gets it; the host knows where each of its bytes is written, entity references,
/// CDATA sections and files included.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    pub(crate) component: Option<usize>,
    pub(crate) property: Option<String>,
    pub(crate) part: Option<(usize, Range<usize>)>,
    pub(crate) own: Option<String>,
}

impl Place {
    /// A component of a [`FleetView`](crate::rule::FleetView), by its index: its name in the composite.
    pub fn component(index: usize) -> Place {
        Place { component: Some(index), ..Place::default() }
    }

    /// A property of the component that reports the finding.
    pub fn property(name: impl Into<String>) -> Place {
        Place { property: Some(name.into()), ..Place::default() }
    }

    /// What gives a topic of the component another name: the new name in its `topicRename`, or else its site.
    pub fn topic(name: &str) -> Place {
        Place::property(format!("topicRename,{name}"))
    }

    /// The same place in a component of a fleet.
    #[must_use]
    pub fn in_component(self, index: usize) -> Place {
        Place { component: Some(index), ..self }
    }

    /// These bytes of a value of the property: of the first value 0, or of a further one where it takes many.
    #[must_use]
    pub fn part(self, value: usize, bytes: Range<usize>) -> Place {
        Place { part: Some((value, bytes)), ..self }
    }

    /// The same place, or that of another property whose value comes from a row of a table for this component alone,
    /// where that of the first one does not. What a library finds has the first place alone.
    #[must_use]
    pub fn or_own(self, name: impl Into<String>) -> Place {
        Place { own: Some(name.into()), ..self }
    }

    /// The name of the other property, see [`or_own`](Place::or_own).
    pub fn own_property_name(&self) -> Option<&str> {
        self.own.as_deref()
    }

    /// The index of the component; `None` for the one that reports the finding.
    pub fn component_index(&self) -> Option<usize> {
        self.component
    }

    /// The name of the property; `None` for the component itself.
    pub fn property_name(&self) -> Option<&str> {
        self.property.as_deref()
    }

    /// The index of the value, and the bytes of it; `None` for all of the property.
    pub fn value_part(&self) -> Option<(usize, Range<usize>)> {
        self.part.clone()
    }
}

/// A fault of a composite, with its exact place.
///
/// ```
/// use saoms_api::{Failure, Finding, Place};
///
/// let plan = "go (3,1)\ngo nowhere";
/// let place = Place::property("plan").part(0, 12..19);
/// let finding = Finding::new(place, "found `nowhere`, expected a block such as (3,10)");
/// assert_eq!(&plan[12..19], "nowhere");
/// assert_eq!(
///     Failure::from(finding).message(),
///     "property `plan`: found `nowhere`, expected a block such as (3,10)"
/// );
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    place: Place,
    message: String,
    help: Vec<String>,
    instead: Option<String>,
    others: Vec<(Place, String)>,
    severity: Option<Severity>,
}

impl Finding {
    /// A finding at a place; the message names the found and the expected value.
    pub fn new(place: Place, message: impl Into<String>) -> Finding {
        Finding { place, message: message.into(), help: Vec::new(), instead: None, others: Vec::new(), severity: None }
    }

    /// Adds a line of help.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Finding {
        // Most have one, and a fleet may have as many findings as components.
        self.help.reserve_exact(1);
        self.help.push(text.into());
        self
    }

    /// Says what probably is meant: a text that can stand in place of the part.
    #[must_use]
    pub fn instead(mut self, text: impl Into<String>) -> Finding {
        self.instead = Some(text.into());
        self
    }

    /// Adds a further place that explains it, with a note.
    #[must_use]
    pub fn label(mut self, place: Place, text: impl Into<String>) -> Finding {
        self.others.reserve_exact(1);
        self.others.push((place, text.into()));
        self
    }

    /// Sets another severity than that of the rule's code. What a constructor refuses is always an error.
    #[must_use]
    pub fn severity(mut self, severity: Severity) -> Finding {
        self.severity = Some(severity);
        self
    }

    /// The same finding about a component of a fleet, and its further places too.
    #[must_use]
    pub fn in_component(mut self, index: usize) -> Finding {
        self.place.component.get_or_insert(index);
        for (place, _) in &mut self.others {
            place.component.get_or_insert(index);
        }
        self
    }

    /// The same finding with another place.
    #[must_use]
    pub fn at(self, place: Place) -> Finding {
        Finding { place, ..self }
    }

    /// The place.
    pub fn place(&self) -> &Place {
        &self.place
    }

    /// The message: found and expected value.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// Lines of help.
    pub fn helps(&self) -> &[String] {
        &self.help
    }

    /// Suggested replacement of the part.
    pub fn replacement(&self) -> Option<&str> {
        self.instead.as_deref()
    }

    /// Further places, each with a note.
    pub fn labels(&self) -> &[(Place, String)] {
        &self.others
    }

    /// Severity, if it differs from that of the rule's code.
    pub fn own_severity(&self) -> Option<Severity> {
        self.severity
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place.property {
            Some(property) => write!(formatter, "property `{property}`: {}", self.message),
            None => formatter.write_str(&self.message),
        }
    }
}

impl std::error::Error for Finding {}
