//! The scope of the names in expressions: the properties of a composite.

use std::cell::Cell;
use std::collections::{BTreeMap, HashSet};
use std::rc::Rc;

use crate::check::judged::{Faulty, Judged};
use crate::check::report::{Report, list};
use crate::check::values::faulty_values::FaultyValues;
use crate::check::values::raw::Piece;
use crate::check::values::shared_values::Answer;
use crate::check::values::value_type::SimpleType;
use crate::check::values::{type_name, value_type};
use crate::diagnostic::{codes, nearest, quoted};
use crate::expression::{ExpressionError, ExpressionValue, INDEX};
use crate::limits::MISSPELT_NAMES;
use crate::model::{ComponentElement, Composite, Property};
use crate::source::{Location, Text};

/// The properties of a composite and of what it includes, as far as they are simple.
#[derive(Default)]
pub(crate) struct Names {
    all: BTreeMap<String, Name>,
    /// Those that the component gives values to and the composite does not have, which is reported.
    undeclared: HashSet<String>,
    faulty: Rc<FaultyValues>,
}

struct Name {
    /// True if an expression asks for it.
    is_used: Cell<bool>,
    /// The property, where its value is not of its type.
    mistyped: Option<Property>,
    /// The fault that it has no value, once it is reported.
    lack: Cell<Option<Faulty>>,
    /// The text of the value and where it stands; `None` where it has no simple one. A fault of what gives it its value
    /// is reported with the values of sources.
    text: Judged<Option<Text>>,
    value: Result<ExpressionValue, ExpressionError>,
}

impl Names {
    /// The names that expressions in a composite and in what it includes can use, the first of each. `owner` is the
    /// component that it implements.
    pub(crate) fn of<'a>(
        composites: &[&'a Composite],
        owner: Option<&ComponentElement>,
        faulty: &Rc<FaultyValues>,
        values: &mut dyn FnMut(&str) -> Answer<'a>,
    ) -> Self {
        let mut names = Self { faulty: Rc::clone(faulty), ..Self::default() };
        let declared = composites.iter().flat_map(|composite| &composite.properties);
        let declared: HashSet<&str> = declared.map(|one| one.name.as_str()).collect();
        let is_declared = |name: &str| declared.contains(name);
        for composite in composites {
            for property in composite.properties.iter().filter(|property| !property.name.is_empty()) {
                names.all.entry(property.name.to_string()).or_insert_with(|| {
                    let values = values(&property.name);
                    let text = values.as_ref().map_err(|fault| *fault).map(|values| match &values.raw.0[..] {
                        [Piece::Text(text)] => Some(text.clone().into_owned()),
                        [Piece::Whole(text, ..)] => Some((*text).clone()),
                        _ => None,
                    });
                    let is_unset = values.is_ok_and(|values| values.raw.0.is_empty());
                    let known = text.as_ref().ok().and_then(Option::as_ref);
                    let value = value(property, known, is_unset);
                    let mistyped = (value.is_err() && known.is_some()).then(|| property.clone());
                    let is_misspelt = |owner: &ComponentElement| is_misspelt(&property.name, owner, is_declared);
                    let lack = (is_unset && owner.is_some_and(is_misspelt)).then_some(Faulty);
                    Name { is_used: Cell::new(false), mistyped, lack: Cell::new(lack), text, value }
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
        self.ask(name);
        self.all.get(name).map_or_else(|| Err(self.unknown(name)), |found| found.value.clone())
    }

    /// True if it is reported that a name has no value, or one that is not of its type; that is reported once.
    pub(crate) fn report_value(&self, name: &str, report: &mut Report<'_>) -> bool {
        match self.all.get(name) {
            Some(Name { mistyped: Some(property), text: Ok(Some(text)), .. }) => {
                let faulty = &self.faulty;
                faulty.has(&codes::COMPOSITE_VALUE_TYPE, text.location, false)
                    || report.about_fleet(|report| !value_type::holds_by_name(property, text, faulty, report))
            }
            Some(Name { text: Err(Faulty), .. }) => true,
            Some(Name { lack, text: Ok(None), .. }) => lack.replace(Some(Faulty)).is_some(),
            Some(_) => false,
            None => self.undeclared.contains(name),
        }
    }

    /// The place of the value of a name.
    pub(crate) fn place(&self, name: &str) -> Option<Location> {
        Some(self.all.get(name)?.text.as_ref().ok()?.as_ref()?.location)
    }

    /// Notes that a name is asked for.
    pub(crate) fn ask(&self, name: &str) {
        self.all.get(name).into_iter().for_each(|found| found.is_used.set(true));
    }

    /// True if what gives a name its value has a fault.
    pub(crate) fn is_faulty(&self, name: &str) -> bool {
        self.all.get(name).is_some_and(|found| found.text.is_err())
    }

    /// The names that were asked for.
    pub(crate) fn used(&self) -> impl Iterator<Item = &str> {
        self.all.iter().filter(|(_, found)| found.is_used.get()).map(|(name, _)| name.as_str())
    }

    fn unknown(&self, name: &str) -> ExpressionError {
        let known = || self.all.keys().map(String::as_str);
        let problem = ExpressionError::new(format!("the composite has no property {}", quoted(name)));
        match name.to_ascii_lowercase().as_str() {
            "true" | "yes" | "on" => return problem.instead("true"),
            "false" | "no" | "off" => return problem.instead("false"),
            _ if name == INDEX => {
                return problem.help("give the component a `saoms:count`: `index` is the number of a replica");
            }
            _ => {}
        }
        match nearest(name, known()) {
            Some(meant) => problem.instead(meant),
            None if self.all.is_empty() => {
                problem.help("declare it: `<property name=\"...\">...</property>` in the composite")
            }
            None => problem.help(format!("its properties are {}", list(known()))),
        }
    }
}

/// The value of a property as its type has it; without a type, as what it looks like.
fn value(property: &Property, text: Option<&Text>, is_unset: bool) -> Result<ExpressionValue, ExpressionError> {
    let name = quoted(&property.name);
    let Some(text) = text else {
        let (what, help) = match is_unset {
            true => (
                "value",
                "write it in the file, or give it with `--set`, or in the component that the composite implements",
            ),
            false if property.many().is_some_and(|many| many.value) => {
                ("single value: it has `many`", "remove `many` where it is declared, and give it one value")
            }
            false => (
                "simple value",
                "give the property one simple value, or use a part of the value, as with `source=\"$name/part\"`",
            ),
        };
        return Err(ExpressionError::new(format!("the property {name} has no {what}")).help(help));
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
        Err(ExpressionError::new(format!("the property {name} is {}, but its type requires {expected}", quoted(text))))
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

/// True if the component that a composite implements gives this property under a misspelt name, which is reported.
pub(crate) fn is_misspelt(name: &str, owner: &ComponentElement, is_declared: impl Fn(&str) -> bool) -> bool {
    let unknown = owner.properties.iter().filter(|given| !is_declared(&given.name));
    unknown.take(MISSPELT_NAMES).any(|given| nearest(&given.name, [name]).is_some())
}
