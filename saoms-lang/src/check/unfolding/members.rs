//! Components of a fleet in the making, each with its name in its scope.

use std::borrow::Cow;
use std::path::Path;

use smol_str::SmolStr;

use super::Unfolding;
use super::conditions::Presence;
use crate::check::fleet::{Kind, Member};
use crate::check::judged::Faulty;
use crate::check::values::replica::Instance;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::expression::{has_expression, render};
use crate::model::{ComponentElement, Naming};
use crate::source::{Location, Text};
use crate::syntax::{Element, is_local_name};

impl<'a> Unfolding<'a, '_, '_> {
    /// Adds a component as it is `written`, and what is inside it.
    pub(crate) fn member(
        &mut self,
        written: &'a ComponentElement,
        component: &'a ComponentElement,
        instance: Option<&'a Instance>,
        presence: Presence,
    ) {
        let Some(open) = self.open.last() else { return };
        let (composite, unit, autowire) = (open.composite, open.unit, open.autowire);
        let is_seen = presence != Presence::Absent && !open.is_absent;
        let scope = self.fleet.units[unit].scope;
        let index = self.fleet.members.len();
        let owner = self.fleet.scopes[scope].owner;
        let is_partial = presence == Presence::Unknown
            || instance.is_some_and(|instance| instance.partial.is_some())
            || owner.is_some_and(|owner| self.fleet.members[owner].is_partial);
        let site = self.site(component, unit, owner);
        let node = self.node(component, unit, owner);
        let own = component.path.as_deref();
        let path = match owner.map(|owner| self.fleet.members[owner].path()) {
            Some(around) => Some(format!("{around}/{}", own.unwrap_or(&component.name))),
            None => own.map(|own| own.to_string()),
        };
        self.fleet.members.push(Member {
            composite,
            unit,
            scope,
            component,
            autowire,
            kind: Kind::Nothing,
            instance,
            is_copy: instance.is_some() || owner.is_some_and(|owner| self.fleet.members[owner].is_copy),
            is_absent: !is_seen,
            is_partial,
            site,
            node,
            program: self.program(),
            repeated: None,
            path,
        });
        let name = component.name.as_str();
        if name.contains(char::is_whitespace) && !has_expression(name) {
            // It cannot be a name, which is reported: targets mean it without its blanks, or are read as several.
            let words = name.split_whitespace().map(str::to_owned).chain([name.split_whitespace().collect()]);
            words.for_each(|word| self.miss(unit, word));
        }
        if name.contains('/') && !has_expression(name) {
            // Reported in the same way.
            name.split('/').for_each(|part| self.miss(unit, part.to_owned()));
        }
        if is_seen {
            self.fleet.scopes[scope].members.push(index);
        }
        let first = self.fleet.scopes[scope].by_name.get(name).copied();
        match first {
            // Any name may be meant for it; that it has none is reported.
            _ if name.is_empty() => self.miss(unit, "*".to_owned()),
            _ if !is_seen => {
                let condition = written.condition.as_ref().map_or(component.name.location, |text| text.location);
                self.fleet.absent.insert((scope, name), condition);
            }
            Some(first) if is_partial || !self.fleet.members[first].is_partial => {
                if !is_partial {
                    self.fleet.members[index].repeated = Some(Faulty);
                    self.report.about(&self.fleet.members[index]);
                    self.repeated(component, first);
                    self.report.about_all();
                }
            }
            _ => _ = self.fleet.scopes[scope].by_name.insert(component.name.value.clone(), index),
        }
        if let Some(naming) = Naming::of_component(component) {
            self.inner(index, naming, !is_seen);
        }
    }

    /// The site of a component: its own inside that of its `owner`, the component around it. One that is no name is
    /// reported.
    fn site(&mut self, component: &ComponentElement, unit: usize, owner: Option<usize>) -> SmolStr {
        let around = owner.map(|owner| self.fleet.members[owner].site.clone()).unwrap_or_default();
        let Some((written, own)) = component.site.as_ref().and_then(|site| self.rendered(site, unit)) else {
            return around;
        };
        // A colon ends the site of an event from outside.
        let is_wrong = |sign: char| sign.is_whitespace() || matches!(sign, ':' | '$');
        if own.split('/').any(|name| name.is_empty() || name.contains(is_wrong)) {
            let message = format!("{} is not a site name", quoted(&own));
            let one = Diagnostic::new(&codes::ATTRIBUTE_VALUE, written.location, message);
            self.report.push(match own.strip_prefix('$').filter(|name| is_local_name(name)) {
                Some(name) => one.replace(&own, written.location, &format!("${{{name}}}")),
                None => one.help("write a name such as `North`, without blanks and `:`, or several with `/` between"),
            });
            return around;
        }
        if around.is_empty() { own.into() } else { format!("{around}/{own}").into() }
    }

    /// The node of a component: its own, or that of its `owner`, the component around it, or that of the outermost
    /// composite. One that is no name is reported.
    fn node(&mut self, component: &ComponentElement, unit: usize, owner: Option<usize>) -> SmolStr {
        let around = match owner {
            Some(owner) => self.fleet.members[owner].node.clone(),
            None => self.default_node(),
        };
        let Some((written, own)) = component.node.as_ref().and_then(|node| self.rendered(node, unit)) else {
            return around;
        };
        if is_local_name(&own) {
            return own.into();
        }
        let one = not_a_node(&own, written.location);
        self.report.push(match own.strip_prefix('$').filter(|name| is_local_name(name)) {
            Some(name) => one.replace(&own, written.location, &format!("${{{name}}}")),
            None => one,
        });
        around
    }

    /// The name of the program that would run the outermost composite alone, where others were asked for, too: that of
    /// its file.
    fn program(&self) -> SmolStr {
        let is_one_of_several = self.fleet.contribution.asked_for().len() > 1;
        let outermost = self.open.first().filter(|_| is_one_of_several).map(|open| open.composite.origin.file());
        let name = outermost.and_then(|file| Path::new(self.report.path(file)).file_stem()?.to_str());
        name.filter(|name| is_local_name(name)).map(SmolStr::from).unwrap_or_default()
    }

    /// The default node of the composites that were asked for.
    fn default_node(&self) -> SmolStr {
        let mut named = self.fleet.contribution.asked_for().iter().filter_map(|one| one.run.default_node.as_ref());
        named.find(|name| is_local_name(name)).map(|name| name.value.clone()).unwrap_or_default()
    }

    /// The text of an attribute of a component with what its expressions come to; `None` where one is faulty, which is
    /// reported.
    fn rendered<'t>(&mut self, written: &'t Text, unit: usize) -> Option<(&'t Text, Cow<'t, str>)> {
        // Replicas have their texts without expressions; a component that stands for faulty ones may keep some.
        if !has_expression(written) {
            return Some((written, Cow::Borrowed(written.as_str())));
        }
        let names = self.names(unit);
        match render(written, &mut |name| names.value(name)) {
            Ok(value) => Some((written, value.into())),
            Err(faults) => {
                self.faults(&names, &[(written.clone(), faults)]);
                None
            }
        }
    }

    fn repeated(&mut self, component: &ComponentElement, first: usize) {
        let first = &self.fleet.members[first];
        let message = format!("there are two components {}", quoted(&component.name));
        let mut one = Diagnostic::new(&codes::COMPONENT_REPEATED, component.name.location, message)
            .label(first.component.name.location, "the first");
        let by = self.open.last().and_then(|open| open.by.filter(|_| self.open.len() > 1));
        if let Some(by) = by.filter(|_| first.composite.file() != component.origin.file()) {
            one = one.label(by.name.location, "included here");
        }
        let here = self.open.last().map(|open| component.origin.element(&open.composite.document));
        let there = first.component.origin.element(&first.composite.document);
        if by.is_none() && self.open.len() == 1 && first.composite.file() != component.origin.file() {
            one = one.help("files given together form one fleet: for two fleets, run the command once for each file");
        }
        self.report.push(match here {
            Some(here) if !first.is_copy && is_same(here, there) => {
                let at = here.span().in_file(component.origin.file());
                one.suggest("remove the second: both are the same, word for word", at, "")
            }
            _ => one.help("give each its own name"),
        });
    }
}

/// The fault of a text that cannot be the name of a node.
pub(crate) fn not_a_node(text: &str, at: Location) -> Diagnostic {
    let message = format!("{} is not the name of a node", quoted(text));
    Diagnostic::new(&codes::ATTRIBUTE_VALUE, at, message)
        .help("write a name such as `gate-a`: letters, digits, `-`, `_` and `.`, a letter or `_` first")
}

/// True if two elements say the same in the same words, however they are laid out.
fn is_same(one: Element<'_>, other: Element<'_>) -> bool {
    let says = |element: Element<'_>| {
        let attributes: Vec<_> =
            element.written_attributes().map(|one| (one.name().to_owned(), one.value().into_owned())).collect();
        let text = element.trimmed_text().map(|text| text.value);
        (element.name().to_owned(), attributes, text, element.children().count())
    };
    let (mut mine, mut others) = (one.descendants(), other.descendants());
    loop {
        match (mine.next(), others.next()) {
            (None, None) => return true,
            (Some(one), Some(other)) if says(one) == says(other) => {}
            _ => return false,
        }
    }
}
