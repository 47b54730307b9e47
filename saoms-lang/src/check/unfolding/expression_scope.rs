//! The scope of the names in expressions: the properties of a composite.

use std::cell::{Cell, RefCell};
use std::collections::{BTreeSet, HashMap, HashSet};

use crate::check::report::{Report, list};
use crate::check::values::parameters::is_misspelt;
use crate::check::values::simple_type::SimpleType;
use crate::check::values::{type_name, value_type};
use crate::diagnostic::{codes, nearest, quoted};
use crate::expression::{ExpressionError, ExpressionValue, INDEX};
use crate::model::{ComponentElement, Composite, Property};
use crate::source::{Location, Text};

/// The properties of a composite and of what it includes, as far as they are simple.
#[derive(Default)]
pub(crate) struct Names {
    all: HashMap<String, Name>,
    used: RefCell<BTreeSet<String>>,
    /// Those that the component gives values to and the composite does not have, which is reported.
    undeclared: HashSet<String>,
}

struct Name {
    /// The property, where its value is not of its type.
    mistyped: Option<Property>,
    /// True if it has no value, and that is told.
    is_told: Cell<bool>,
    /// True if what gives it its value has a fault, which whoever collects the values of sources reports.
    is_faulty: bool,
    /// The text of the value and where it stands.
    text: Option<Text>,
    value: Result<ExpressionValue, ExpressionError>,
}

/// The value of a property as an expression takes it.
#[derive(Clone)]
pub(crate) enum Supplied {
    /// One text.
    Text(Text),
    /// No single text: parts of a complex value, or several values.
    Other,
    /// Nobody knows for a fault, which whoever collects the values of sources reports.
    Faulty,
    /// Nobody gives a value.
    Nothing,
}

impl Names {
    /// The names that the expressions in a composite and in what it includes can use, the first of each, with what is
    /// taken of each. `owner` is the component that it implements.
    pub(crate) fn of(
        composites: &[&Composite],
        owner: Option<&ComponentElement>,
        supply: &dyn Fn(&str) -> Supplied,
    ) -> Self {
        let mut names = Self::default();
        let declared = composites.iter().flat_map(|composite| &composite.properties);
        let declared: HashSet<&str> = declared.map(|one| one.name.as_str()).collect();
        let is_declared = |name: &str| declared.contains(name);
        for composite in composites {
            for property in composite.properties.iter().filter(|property| !property.name.is_empty()) {
                names.all.entry(property.name.to_string()).or_insert_with(|| {
                    let supplied = supply(&property.name);
                    let is_faulty = matches!(supplied, Supplied::Faulty);
                    let is_unset = matches!(supplied, Supplied::Nothing);
                    let value = value(property, &supplied);
                    let text = if let Supplied::Text(text) = supplied { Some(text) } else { None };
                    let mistyped = (value.is_err() && text.is_some()).then(|| property.clone());
                    // What has to be supplied and is not is told where it should be.
                    let must = property.must_supply().is_some_and(|must| must.value);
                    let is_misspelt = |owner: &ComponentElement| is_misspelt(&property.name, owner, is_declared);
                    let is_told = is_faulty || is_unset && (must || owner.is_some_and(is_misspelt));
                    Name { mistyped, is_told: Cell::new(is_told), is_faulty, text, value }
                });
            }
        }
        let given = owner.into_iter().flat_map(|owner| &owner.properties);
        let undeclared = given.filter(|given| !is_declared(&given.name));
        names.undeclared = undeclared.map(|given| given.name.to_string()).collect();
        names
    }

    /// The value of a name.
    pub(crate) fn value(&self, name: &str) -> Result<ExpressionValue, ExpressionError> {
        let Some(found) = self.all.get(name) else { return Err(self.unknown(name)) };
        self.ask(name);
        found.value.clone()
    }

    /// True if an expression has no value because a name has none, or one that is not of its type: that is told, and
    /// once.
    pub(crate) fn report_value(&self, name: &str, report: &mut Report<'_>) -> bool {
        match self.all.get(name) {
            Some(Name { mistyped: Some(property), text: Some(text), .. }) => {
                let is_told = report.has_diagnostic(&codes::COMPOSITE_VALUE_TYPE, text.location);
                is_told || report.of_all(|report| !value_type::holds_by_name(property, text, report))
            }
            Some(Name { is_told, text: None, .. }) => is_told.replace(true),
            Some(_) => false,
            None => self.undeclared.contains(name),
        }
    }

    /// The place of the value of a name.
    pub(crate) fn place(&self, name: &str) -> Option<Location> {
        Some(self.all.get(name)?.text.as_ref()?.location)
    }

    /// Notes that a name is asked for.
    pub(crate) fn ask(&self, name: &str) {
        self.used.borrow_mut().insert(name.to_owned());
    }

    /// True if what gives a name its value has a fault.
    pub(crate) fn is_faulty(&self, name: &str) -> bool {
        self.all.get(name).is_some_and(|found| found.is_faulty)
    }

    /// The names that were asked for.
    pub(crate) fn used(&self) -> Vec<String> {
        self.used.borrow().iter().cloned().collect()
    }

    fn unknown(&self, name: &str) -> ExpressionError {
        let mut known: Vec<&str> = self.all.keys().map(String::as_str).collect();
        known.sort_unstable();
        let problem = ExpressionError::new(format!("the composite has no property {}", quoted(name)));
        let truth = match name.to_ascii_lowercase().as_str() {
            "true" | "yes" | "on" => Some("true"),
            "false" | "no" | "off" => Some("false"),
            _ => None,
        };
        if let Some(truth) = truth {
            return problem.instead(truth);
        }
        if name == INDEX {
            return problem.help("`index` is what replicas are counted by: give the component a `saoms:count`");
        }
        match nearest(name, known.iter().copied()) {
            Some(meant) => problem.instead(meant),
            None if known.is_empty() => {
                problem.help("declare it: `<property name=\"...\">...</property>` in the composite")
            }
            None => problem.help(format!("its properties are {}", list(known))),
        }
    }
}

/// The value of a property as its type has it; without a type, as what it looks like.
fn value(property: &Property, supplied: &Supplied) -> Result<ExpressionValue, ExpressionError> {
    let name = quoted(&property.name);
    let text = match supplied {
        Supplied::Text(text) => text,
        Supplied::Nothing => {
            let help =
                "write it in the file, or give it with `--set`, or in the component that the composite implements";
            return Err(ExpressionError::new(format!("the property {name} has no value")).help(help));
        }
        Supplied::Other | Supplied::Faulty => {
            let help =
                "an expression takes one text: give it one, or a part of the value, as with `source=\"$name/part\"`";
            return Err(ExpressionError::new(format!("the property {name} has no simple value")).help(help));
        }
    };
    let of = property.r#type().filter(|of| !type_name::is_misspelt(of));
    let of = of.map_or("", |of| type_name::local(of));
    let boolean = match text.as_str() {
        "true" => Some(true),
        "false" => Some(false),
        "1" if of == "boolean" => Some(true),
        "0" if of == "boolean" => Some(false),
        _ => None,
    };
    let wrong = |expected: &str| {
        Err(ExpressionError::new(format!("the property {name} is {}, and its type asks for {expected}", quoted(text))))
    };
    match of {
        "boolean" => boolean.map_or_else(|| wrong("`true` or `false`"), |value| Ok(ExpressionValue::Boolean(value))),
        _ if SimpleType::find(of).is_some_and(SimpleType::is_whole) => text
            .parse()
            .map_or_else(|_| wrong("a whole number of at most 64 bits"), |value| Ok(ExpressionValue::Integer(value))),
        "" => Ok(match (boolean, text.parse()) {
            (Some(value), _) => ExpressionValue::Boolean(value),
            (None, Ok(number)) => ExpressionValue::Integer(number),
            _ => ExpressionValue::Text(text.value.clone()),
        }),
        _ => Ok(ExpressionValue::Text(text.value.clone())),
    }
}
