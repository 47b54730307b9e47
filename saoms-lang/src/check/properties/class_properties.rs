//! The properties that a component of a class, or a loop, is given.

use saoms_api::Secret;
use saoms_api::host::PropertyValue;

use super::conversion::{Converted, Source, Target, convert};
use super::given_values::{PropertyValues, ValuePlace};
use super::{Giver, given_twice, missing, unread};
use crate::check::fleet::property_table::{PropertyTable, TableEntry};
use crate::check::judged::{Faulty, Judged};
use crate::check::parameters::Parameters;
use crate::check::report::Report;
use crate::check::values::raw::{Piece, Raw, raw};
use crate::diagnostic::{Diagnostic, codes, nearest_equal, quoted};
use crate::expression::has_expression;
use crate::model::{Part, Property};
use crate::registry::PropertyDeclaration;
use crate::source::Location;
use crate::syntax::Document;

/// Checks the properties that a component of a class, or a loop, is given: their values.
pub(crate) fn check<'a>(
    giver: &Giver<'_, 'a>,
    table: &PropertyTable<'a>,
    parameters: &mut Parameters<'a>,
    report: &mut Report<'_>,
) -> PropertyValues {
    let mut slots = Vec::new();
    slots.resize_with(table.all.len(), Slot::default);
    let (found, unsure, unknown) = Default::default();
    let mut check = PropertyCheck { giver, table, parameters, report, slots, found, unsure, unknown };
    for property in giver.properties {
        check.given(property);
    }
    for (default, document) in giver.defaults() {
        check.described(default, document);
    }
    for &place in &table.required {
        check.required(place);
    }
    check.finish()
}

struct PropertyCheck<'c, 'm, 'r, 'a> {
    giver: &'c Giver<'m, 'a>,
    table: &'c PropertyTable<'a>,
    parameters: &'c mut Parameters<'a>,
    report: &'c mut Report<'r>,
    /// The state of each property of the table.
    slots: Vec<Slot<'a>>,
    found: Vec<(PropertyValue, ValuePlace)>,
    /// The places of properties whose values are not known, since a fault of theirs is reported.
    unsure: Vec<usize>,
    /// Names that no property has.
    unknown: Vec<&'a str>,
}

/// The state of a property.
#[derive(Default)]
struct Slot<'a> {
    /// The first element that gives it.
    element: Option<&'a Property>,
    /// True if it has a value.
    is_found: bool,
    /// True if its `source` is right, and has no value.
    is_unset: bool,
}

impl<'a> PropertyCheck<'_, '_, '_, 'a> {
    /// Checks a property that the composite gives.
    fn given(&mut self, property: &'a Property) {
        let (name, member) = (property.name.as_str(), self.giver.member);
        let has_open_names = member.instance.is_some_and(|one| one.partial.is_some());
        if name.is_empty() || has_open_names && has_expression(name) {
            self.unknown.push("");
            return;
        }
        let Some(place) = self.table.place(name) else {
            missing::unknown(property, self.giver, self.table, self.report);
            if let Some(source) = property.source() {
                let _ = self.parameters.resolve(member.unit, source, self.report);
            }
            self.unknown.push(name);
            return;
        };
        if let Some(first) = self.slots[place].element {
            self.report.push(given_twice(property, first));
            self.unsure.push(place);
            return;
        }
        self.slots[place].element = Some(property);
        many_of_one(property, &self.table.all[place], self.report);
        if self.value(place, property).is_err() {
            if property.only_text().is_some_and(|text| has_expression(text)) {
                self.parameters.leave_open(member.unit);
            }
            self.unsure.push(place);
        } else if member.is_partial
            && property.simple_value().is_some_and(|text| text.value == member.component.name.value)
        {
            // What lacks the index as the name does, which is reported, can be anything.
            self.unsure.push(place);
        }
    }

    /// Finds the value of a property, and converts it. None is left where its `source` has none.
    fn value(&mut self, place: usize, property: &'a Property) -> Judged<()> {
        let (raw, source) = self.parameters.taken(self.giver.member, property, self.report)?;
        if source.is_none() && property.source().is_some() && raw.0.is_empty() {
            self.slots[place].is_unset = true;
            return Ok(());
        }
        self.convert(place, &raw, source.unwrap_or(property.tag()), source)
    }

    /// Checks a property that the file beside the class gives, where the composite does not.
    fn described(&mut self, default: &'a Property, document: &'a Document) {
        let place = self.table.place(&default.name);
        let Some(place) = place.filter(|place| self.slots[*place].element.is_none()) else { return };
        self.slots[place].element = Some(default);
        let found = raw(default, document, None, self.report);
        let found = found.map(|found| found.inside_elements_of(default));
        let by = Some(self.giver.name.location);
        if found.and_then(|found| self.convert(place, &found, default.tag(), by)).is_err() {
            self.unsure.push(place);
        }
    }

    /// Converts what was found for a property to what the class takes.
    fn convert(&mut self, place: usize, found: &Raw<'_>, at: Location, source: Option<Location>) -> Judged<()> {
        let mut places: Vec<Location> = found.0.iter().map(Piece::location).collect();
        let entry = &self.table.all[place];
        if entry.main.secret || entry.task.is_some_and(|task| task.secret) {
            let tells = |place: &&Location| !Secret::new(self.report.written(**place)).is_variable();
            places.iter().filter(tells).for_each(|place| self.report.hide(*place));
        }
        if places.is_empty() {
            places.push(at);
        }
        let (faulty, is_copy) = (&*self.parameters.faulty, self.giver.member.is_copy);
        let from = source.map(|at| Source { at, faulty, is_copy });
        let target = Target { outer: None, declaration: entry.main, at, source: from };
        let Converted { value, written } = convert(found, target, self.report).ok_or(Faulty)?;
        // One value serves both, unless they are of two types.
        let as_task = entry.also().map(|declaration| convert(found, Target { declaration, ..target }, self.report));
        let as_task = as_task.map(|converted| converted.ok_or(Faulty)).transpose()?.map(|converted| converted.value);
        let as_task = as_task.filter(|as_task| *as_task != value).map(Box::new);
        let at = ValuePlace { property: place, places: places.into(), source, written: written.map(Box::new), as_task };
        self.found.push((value, at));
        self.slots[place].is_found = true;
        if source.is_none() && unread::check(found, self.giver, self.report) {
            self.parameters.leave_open(self.giver.member.unit);
        }
        Ok(())
    }

    /// Checks that a property that has to be given is. What is given wrongly is reported already.
    fn required(&mut self, place: usize) {
        let (slot, declaration) = (&self.slots[place], self.table.all[place].main);
        if slot.is_found || self.table.preset(&declaration.name).is_some() {
            return;
        }
        self.unsure.push(place);
        let Some(property) = slot.element else {
            return missing::missing(self.giver, declaration, self.table, self.report);
        };
        let unit = self.giver.member.unit;
        if let (true, Some(source)) = (slot.is_unset, property.source())
            && !self.parameters.is_lack_reported(unit, source)
        {
            let message = format!("the property {} has no value: its source has no value", quoted(&declaration.name));
            let one = Diagnostic::new(&codes::PROPERTY_MISSING, source.location, message);
            let one = self.parameters.supply(unit, source, one);
            self.parameters.tell_lack(unit, source);
            self.report.push(one);
        }
    }

    /// The values, with the properties that an unknown name may stand for among those that are not known.
    fn finish(mut self) -> PropertyValues {
        let is_sound = self.unsure.is_empty() && self.unknown.is_empty() && !self.giver.member.is_partial;
        for name in std::mem::take(&mut self.unknown) {
            let meant = self.meant(name);
            self.unsure.extend(meant);
        }
        self.unsure.sort_unstable();
        self.unsure.dedup();
        PropertyValues::of(self.table, self.found, self.unsure, is_sound)
    }

    /// The places of the properties that an unknown name may stand for: those most alike, or else any number not given.
    fn meant(&self, name: &str) -> Vec<usize> {
        let near = nearest_equal(name, self.table.names());
        if !near.is_empty() {
            return near.into_iter().filter_map(|near| self.table.place(near)).collect();
        }
        let all = self.table.all.iter().zip(&self.slots).enumerate();
        let open =
            all.filter(|(_, (entry, slot))| !slot.is_found && entry.own().is_some_and(PropertyDeclaration::is_number));
        open.map(|(place, _)| place).collect()
    }
}

/// Reports a property that says that it takes several values, where the class takes one.
fn many_of_one(property: &Property, entry: &TableEntry<'_>, report: &mut Report<'_>) {
    let Some(many) = property.many().filter(|many| many.value && !entry.main.many) else { return };
    let name = quoted(&property.name);
    let message = format!("the property {name} allows one value, but is declared here to allow several");
    let one = Diagnostic::new(&codes::MANY_VALUES, many.location, message);
    report.push(one.help("remove `many`"));
}
