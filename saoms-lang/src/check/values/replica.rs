//! Components made of one that is replicated: its texts with the numbers of one index.

use std::borrow::Cow;
use std::rc::Rc;

use super::expression_scope::Names;
use crate::diagnostic::nearest;
use crate::expression::{ExpressionError, ExpressionFault, ExpressionValue, INDEX, has_expression, render};
use crate::model::{ComponentElement, LoopElement, Property, Table};
use crate::source::Text;
use crate::syntax::Document;

/// One of the replicas.
pub(crate) struct Instance {
    pub(crate) index: i64,
    pub(crate) names: Rc<Names>,
    /// The missing part, where it stands for replicas that cannot be made.
    pub(crate) partial: Option<Partial>,
}

/// The unknown parts of a component that stands for replicas with a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Partial {
    /// True if a table may give it more properties.
    pub(crate) has_table: bool,
    /// True if its index is not known.
    pub(crate) lacks_index: bool,
}

/// A component of a replica.
pub(crate) struct Replica {
    pub(crate) component: ComponentElement,
    pub(crate) instance: Instance,
}

/// Names that others give the index of replicas.
pub(crate) const COUNTERS: [&str; 8] = ["i", "n", "nr", "no", "num", "idx", "counter", "replica"];

impl Instance {
    /// The value of a name in an expression.
    pub(crate) fn value(&self, name: &str) -> Result<ExpressionValue, ExpressionError> {
        match name {
            INDEX if self.partial.is_some_and(|partial| partial.lacks_index) => {
                Err(ExpressionError::new("the first index is not known"))
            }
            INDEX => Ok(ExpressionValue::Integer(self.index)),
            name => self.names.value(name).map_err(|problem| match nearest(name, [INDEX]) {
                Some(_) => ExpressionError { help: None, ..problem.instead(INDEX) },
                None if COUNTERS.contains(&name) && problem.instead.is_none() => {
                    ExpressionError { help: None, ..problem.instead(INDEX) }
                }
                None => problem,
            }),
        }
    }

    /// A text of a complex value; as it is where it has a fault, which is reported.
    pub(crate) fn text<'t>(&self, text: Cow<'t, Text>) -> Cow<'t, Text> {
        if !has_expression(&text) {
            return text;
        }
        match render(&text, &mut |name| self.value(name)) {
            Ok(value) => Cow::Owned(Text::new(value.into(), text.location)),
            Err(_) => text,
        }
    }

    /// True if a value of a property cannot be known here for a fault in an expression, which is reported.
    pub(crate) fn hides(&self, property: &Property, document: &Document) -> bool {
        self.partial.is_some()
            && (texts(property).any(|text| has_expression(text))
                || complex_texts(property, document).any(|text| render(&text, &mut |name| self.value(name)).is_err()))
    }

    /// A component with the numbers of this index in all its texts, and the texts with faults.
    pub(crate) fn of(
        &self,
        template: &ComponentElement,
        table: Option<(&Table, usize)>,
    ) -> (ComponentElement, Vec<(Text, Vec<ExpressionFault>)>) {
        let mut component = template.clone();
        (component.replicas, component.condition) = (None, None);
        let mut faults = Vec::new();
        each_text(&mut component, &mut |text| {
            if !has_expression(text) {
                return;
            }
            match render(text, &mut |name| self.value(name)) {
                Ok(value) => text.value = value.into(),
                Err(found) => faults.push((text.clone(), found)),
            }
        });
        if self.partial.is_some() {
            // What is called something unknown cannot be looked at.
            component.services.retain(|service| !has_expression(&service.name));
            component.references.retain(|reference| !has_expression(&reference.name));
            let is_known = |one: &LoopElement| {
                let texts = [Some(&one.name), one.class.as_ref(), one.before.as_ref(), one.after.as_ref()];
                !texts.into_iter().flatten().any(|text| has_expression(text))
            };
            component.loops.retain(is_known);
        }
        if let Some((table, row)) = table {
            replace(&mut component, table, row);
        }
        (component, faults)
    }
}

/// Gives a component the values of a line of a table.
fn replace(component: &mut ComponentElement, table: &Table, row: usize) {
    for (name, value) in table.properties.iter().zip(&table.rows[row].values) {
        let Some(value) = value else { continue };
        component.properties.retain(|property| property.name != *name.as_str());
        component.properties.push(Property {
            origin: component.origin,
            name: name.clone(),
            value: Some(value.clone()),
            text: None,
            details: None,
        });
    }
}

/// Every text of a component but those that lead to other files.
fn each_text(component: &mut ComponentElement, each: &mut dyn FnMut(&mut Text)) {
    each(&mut component.name);
    [&mut component.path, &mut component.site, &mut component.node].into_iter().flatten().for_each(|text| each(text));
    if let Some(implementation) = &mut component.implementation {
        use crate::model::ImplementationKind::{Java, Python, Rust};
        use crate::model::PythonClass;
        if let Java { class } | Rust { class, .. } = &mut implementation.kind {
            class.iter_mut().for_each(&mut *each);
        }
        if let Python(python) = &mut implementation.kind {
            let PythonClass { module, class, name } = &mut **python;
            [module, class, name].into_iter().flatten().for_each(&mut *each);
        }
    }
    component.properties.iter_mut().for_each(|property| of_property(property, each));
    for service in &mut component.services {
        each(&mut service.name);
        let bindings = service.contract.iter_mut().flat_map(|contract| &mut contract.bindings);
        bindings.filter_map(|binding| binding.uri.as_mut()).for_each(&mut *each);
    }
    for reference in &mut component.references {
        each(&mut reference.name);
        reference.targets.iter_mut().for_each(&mut *each);
        let bindings = reference.contract.iter_mut().flat_map(|contract| &mut contract.bindings);
        bindings.filter_map(|binding| binding.uri.as_mut()).for_each(&mut *each);
    }
    for one in &mut component.loops {
        each(&mut one.name);
        [&mut one.class, &mut one.before, &mut one.after].into_iter().flatten().for_each(&mut *each);
        one.properties.iter_mut().for_each(|property| of_property(property, each));
    }
}

fn of_property(property: &mut Property, each: &mut dyn FnMut(&mut Text)) {
    each(&mut property.name);
    property.value.iter_mut().chain(&mut property.text).for_each(&mut *each);
    if let Some(details) = &mut property.details {
        [&mut details.source, &mut details.from_file].into_iter().flatten().for_each(&mut *each);
        details.values.iter_mut().for_each(|value| each(&mut value.text));
    }
}

/// The texts of a property that are not inside complex values.
fn texts(property: &Property) -> impl Iterator<Item = &Text> {
    let own = [Some(&property.name), property.value.as_ref(), property.text.as_ref()];
    let others = [property.source(), property.from_file()];
    let listed = property.values().iter().map(|value| &value.text);
    own.into_iter().chain(others).flatten().chain(listed)
}

/// The texts in complex values of a property, which stay in the document and are rendered when they are asked for.
fn complex_texts<'d>(property: &'d Property, document: &'d Document) -> impl Iterator<Item = Text> + use<'d> {
    let listed = property.values().iter().flat_map(|value| &value.content);
    let elements = property.content().iter().chain(listed).flat_map(|id| document.element(*id).descendants());
    elements.filter_map(|element| element.trimmed_text()).filter(|text| has_expression(text))
}

/// Those of a component and its loops.
pub(crate) fn all_complex_texts(component: &ComponentElement, document: &Document) -> Vec<Text> {
    let of_loops = component.loops.iter().flat_map(|one| &one.properties);
    let properties = component.properties.iter().chain(of_loops);
    properties.flat_map(|property| complex_texts(property, document)).collect()
}
