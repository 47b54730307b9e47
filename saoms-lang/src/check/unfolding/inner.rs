//! Composites inside composites: found by their names, neither in a circle nor too many.

use std::collections::HashMap;

use super::{Unfolding, names};
use crate::check::fleet::{Kind, Scope};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::limits::{COMPONENTS, COMPOSITE_DEPTH};
use crate::model::{Composite, Contribution, Link, Naming};

/// Composites of one circle that are named.
const SHOWN: usize = 8;

/// The number of components a composite comes to, known before they are made.
fn size(contribution: &Contribution, place: usize, deep: usize, known: &mut HashMap<usize, usize>) -> usize {
    if let Some(size) = known.get(&place) {
        return *size;
    }
    // What is in a circle, or too deep, is reported otherwise.
    known.insert(place, 0);
    let composite = &contribution.composites()[place];
    let mut size = composite.components.len();
    for naming in composite.namings() {
        if let Some(Link::To(inner)) = contribution.link(naming.origin)
            && deep <= COMPOSITE_DEPTH
        {
            size = size.saturating_add(self::size(contribution, *inner, deep + 1, known));
        }
    }
    known.insert(place, size);
    size
}

impl<'a> Unfolding<'a, '_, '_> {
    /// Opens the composite that implements a component.
    pub(super) fn inner(&mut self, member: usize, naming: Naming<'a>, is_absent: bool) {
        let Some((place, composite)) = self.find(naming) else {
            let is_given = self.options.assume_classes
                && !matches!(self.fleet.contribution.link(naming.origin), Some(Link::Faulty));
            if is_given {
                self.fleet.members[member].kind = Kind::Given;
            }
            return;
        };
        if self.is_circle(place, naming) || self.is_full(place, naming) {
            return;
        }
        let scope = self.fleet.scopes.len();
        self.fleet.scopes.push(Scope { owner: Some(member), ..Scope::default() });
        self.fleet.members[member].kind = Kind::Composite(scope);
        let unit = self.unit(scope);
        self.fleet.units[unit].is_absent = is_absent;
        self.open(place, composite, unit, Some(naming));
    }

    fn is_full(&mut self, place: usize, naming: Naming<'a>) -> bool {
        let is_too_deep = self.open.len() > COMPOSITE_DEPTH;
        let more = size(self.fleet.contribution, place, self.open.len(), &mut self.sizes);
        if !is_too_deep && self.fleet.members.len().saturating_add(more) <= COMPONENTS {
            return false;
        }
        let message = match is_too_deep {
            true => format!("composites are nested more than {COMPOSITE_DEPTH} deep"),
            false => format!("the inner composites have more than {COMPONENTS} components in all"),
        };
        let help = "use fewer: each use of a composite adds all of its components";
        self.too_large(naming.name.location, message, help);
        true
    }

    /// The composite that a name leads to. A name that leads nowhere is reported.
    pub(super) fn find(&mut self, naming: Naming<'a>) -> Option<(usize, &'a Composite)> {
        let contribution = self.fleet.contribution;
        let link = contribution.link(naming.origin)?;
        let around = self.open.last()?.composite;
        match link {
            Link::To(place) => {
                let composite = &contribution.composites()[*place];
                let prefix = naming.name.split_once(':').map_or("", |(prefix, _)| prefix);
                let is_bound = naming.origin.element(&around.document).resolve_prefix(prefix).is_some();
                // Of a prefix that is not declared the first name is told.
                let is_told = !prefix.is_empty() && !is_bound && !self.report.is_first_unbound(around.file(), prefix);
                if !is_told && !names::is_exact(naming, around, composite) {
                    self.report.push(names::loose(naming, around, composite));
                }
                Some((*place, composite))
            }
            Link::Faulty => None,
            Link::Missing(missing) => {
                // One prefix is one mistake, however many names have it.
                let of = naming.name.split_once(':').map(|(prefix, _)| prefix);
                // By which other names lead somewhere.
                let is_right = around.namings().any(|other| {
                    let is_same = other.name.split_once(':').map(|(prefix, _)| prefix) == of;
                    is_same && matches!(contribution.link(other.origin), Some(Link::To(_)))
                });
                let prefix = names::wrong_prefix(naming, missing, around).filter(|_| !is_right);
                if prefix.is_some_and(|(at, _)| !self.wrong_prefixes.insert(at)) {
                    return None;
                }
                // As one name is, which is corrected in all places together.
                if !self.wrong_names.insert((around.file(), naming.name.value.clone())) {
                    return None;
                }
                let assumes = self.options.assume_classes;
                self.report.push(names::not_found(naming, (missing, prefix), around, assumes));
                None
            }
        }
    }

    pub(super) fn is_circle(&mut self, place: usize, naming: Naming<'a>) -> bool {
        let Some(start) = self.open.iter().position(|open| open.place == place) else { return false };
        let circle = &self.open[start..];
        let mut names: Vec<String> = circle.iter().take(SHOWN).map(|open| quoted(&open.composite.name)).collect();
        if circle.len() > SHOWN {
            names.push(format!("{} more", circle.len() - SHOWN));
        }
        names.push(names[0].clone());
        let message = format!("composites contain each other in a cycle: {}", names.join(" -> "));
        let mut one = Diagnostic::new(&codes::COMPOSITE_CIRCLE, naming.name.location, message)
            .help("remove one of these: a composite cannot contain itself");
        for by in self.open[start + 1..].iter().filter_map(|open| open.by).take(8) {
            one = one.label(by.name.location, "it is contained here");
        }
        self.report.push(one);
        true
    }
}
