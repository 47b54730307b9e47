//! The properties of each component: known, given once, right, and all that have to be there.

mod class_properties;
mod composite_properties;
pub(crate) mod conversion;
pub(crate) mod findings;
pub(crate) mod foreign;
pub(crate) mod given_values;
pub(crate) mod missing;
pub(crate) mod unread;
mod wrong_text;

use crate::check::fleet::class_index::ClassIndex;
use crate::check::fleet::{Fleet, Kind, Member};
use crate::check::parameters::Parameters;
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::{ComponentType, LoopElement, Origin, Property};
use crate::source::Text;
use crate::syntax::Document;

use given_values::PropertyValues;

pub(crate) use class_properties::check;
pub(crate) use composite_properties::one_value;

/// A giver of property values: a component, or one of its loops.
pub(crate) struct Giver<'m, 'a> {
    pub(crate) what: &'static str,
    pub(crate) name: &'a Text,
    pub(crate) origin: Origin,
    pub(crate) properties: &'a [Property],
    /// The component.
    pub(crate) member: &'m Member<'a>,
    /// The component type beside the class, whose values hold where the component gives none.
    described: Option<&'a ComponentType>,
    /// The classes of the fleet, whose properties may be meant.
    classes: &'m [ClassIndex<'a>],
}

impl<'m, 'a> Giver<'m, 'a> {
    pub(crate) fn component(
        member: &'m Member<'a>,
        described: Option<&'a ComponentType>,
        classes: &'m [ClassIndex<'a>],
    ) -> Self {
        let component = member.component;
        let (name, properties) = (&component.name, &component.properties);
        Self { what: "component", name, origin: component.origin, properties, member, described, classes }
    }

    pub(crate) fn looping(one: &'a LoopElement, member: &'m Member<'a>) -> Self {
        let properties = &one.properties;
        Self { what: "loop", name: &one.name, origin: one.origin, properties, member, described: None, classes: &[] }
    }

    /// The properties that a file beside the class gives values to, with its document.
    pub(crate) fn defaults(&self) -> impl Iterator<Item = (&'a Property, &'a Document)> + use<'a> {
        let described = self.described.into_iter();
        described.flat_map(|one| {
            let with_values = one.properties.iter().filter(|property| property.has_value());
            with_values.map(|property| (property, &*one.document))
        })
    }
}

/// Checks the properties of all components: the values of each, none without a class.
pub(crate) fn check_all<'a>(
    fleet: &Fleet<'a>,
    parameters: &mut Parameters<'a>,
    report: &mut Report<'_>,
) -> Vec<PropertyValues> {
    let mut all = Vec::with_capacity(fleet.members.len());
    for (place, member) in fleet.members.iter().enumerate() {
        report.about(member);
        parameters.types(member, report);
        let mut given = PropertyValues::default();
        if let Kind::Class(index) = member.kind {
            let giver = Giver::component(member, fleet.component_type(place), &fleet.classes);
            given = check(&giver, &fleet.classes[index].table, parameters, report);
        } else {
            composite_properties::repeated(member.component, report);
            match fleet.inner(place) {
                Some(inner) => composite_properties::check(member, inner, report),
                None => foreign::properties(member, fleet.known(place), parameters, report),
            }
        }
        all.push(given);
    }
    report.about_all();
    all
}

fn given_twice(property: &Property, first: &Property) -> Diagnostic {
    let message = format!("the property {} is given twice", quoted(&property.name));
    Diagnostic::new(&codes::PROPERTY_REPEATED, property.name.location, message)
        .label(first.name.location, "first given here")
        .help("keep one of them")
}
