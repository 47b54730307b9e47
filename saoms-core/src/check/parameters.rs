//! The properties of composites: what `source="$name"` and `source="$name/path"` stand for.

use std::collections::HashMap;
use std::ops::Range;

use super::Setting;
use super::raw::{Raw, raw};
use super::report::{Report, list};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::{Composite, Property};
use crate::source::Text;
use crate::xml::Element;

/// The properties of all composites, with their values.
pub(super) struct Parameters<'a> {
    scopes: Vec<Scope<'a>>,
}

/// The properties of one composite.
struct Scope<'a> {
    composite: &'a Composite,
    by_name: HashMap<&'a str, Parameter<'a>>,
    /// Whether a `source` leads to none of them: one of them is probably meant.
    has_wrong_source: bool,
}

struct Parameter<'a> {
    property: &'a Property,
    setting: Option<&'a Setting>,
    is_used: bool,
}

impl<'a> Scope<'a> {
    /// The names of its properties, sorted.
    fn names(&self) -> Vec<&'a str> {
        let mut names: Vec<&str> = self.by_name.keys().copied().collect();
        names.sort_unstable();
        names
    }
}

impl<'a> Parameters<'a> {
    /// Collects the properties and gives them their settings.
    pub(super) fn of(composites: &'a [Composite], settings: &'a [Setting], report: &mut Report<'_>) -> Self {
        let mut scopes: Vec<Scope<'a>> = Vec::with_capacity(composites.len());
        for composite in composites {
            let mut by_name: HashMap<&str, Parameter<'a>> = HashMap::new();
            for property in composite.properties.iter().filter(|property| !property.name.is_empty()) {
                if let Some(first) = by_name.get(property.name.as_str()) {
                    let message = format!("the composite has two properties {}", quoted(&property.name));
                    report.push(
                        Diagnostic::new(&codes::COMPOSITE_PART_REPEATED, property.name.location, message)
                            .rule("ASM60014")
                            .label(first.property.name.location, "the first")
                            .help("give each its own name"),
                    );
                    continue;
                }
                by_name.insert(&property.name, Parameter { property, setting: None, is_used: false });
            }
            scopes.push(Scope { composite, by_name, has_wrong_source: false });
        }
        let mut parameters = Self { scopes };
        parameters.set(settings, report);
        parameters
    }

    fn set(&mut self, settings: &'a [Setting], report: &mut Report<'_>) {
        let mut first: HashMap<&str, &Setting> = HashMap::new();
        for setting in settings {
            if let Some(earlier) = first.insert(&setting.name, setting) {
                let message = format!("{} is set twice", quoted(&setting.name));
                report.push(
                    Diagnostic::new(&codes::SETTING_REPEATED, setting.name.location, message)
                        .label(earlier.name.location, "first here")
                        .help("keep one of them"),
                );
                continue;
            }
            let mut is_known = false;
            for scope in &mut self.scopes {
                if let Some(parameter) = scope.by_name.get_mut(setting.name.as_str()) {
                    parameter.setting = Some(setting);
                    is_known = true;
                }
            }
            if !is_known {
                let names: Vec<&str> = self.names();
                let message = format!("no composite has a property {}", quoted(&setting.name));
                let at = setting.name.location;
                let known = ("the properties of the composite are", names.iter().copied());
                let one = report.unknown(&codes::UNKNOWN_SETTING, at, message, &setting.name, known);
                report.push(match names.is_empty() {
                    true => one.help("declare it: `<property name=\"...\">...</property>` in the composite"),
                    false => one,
                });
            }
        }
    }

    /// The names of all properties, sorted.
    fn names(&self) -> Vec<&'a str> {
        let mut names: Vec<&str> = self.scopes.iter().flat_map(Scope::names).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// What `source` stands for in the composite of this place. Faults are reported.
    pub(super) fn resolve(
        &mut self,
        scope: usize,
        source: &Text,
        report: &mut Report<'_>,
    ) -> Result<Raw<'a>, ()> {
        let scope = &mut self.scopes[scope];
        let Some((name, path)) = expression(source) else {
            scope.has_wrong_source = true;
            let message = format!("{} names no property of the composite", quoted(source));
            let mut one = Diagnostic::new(&codes::SOURCE_MALFORMED, source.location, message)
                .help("write `$name`, or `$name/part` for a part of a complex property");
            if scope.by_name.contains_key(source.as_str()) {
                one = one.suggest("insert `$`", source.location, format!("${source}"));
            }
            report.push(one);
            return Err(());
        };
        let Some(parameter) = scope.by_name.get_mut(name) else {
            scope.has_wrong_source = true;
            let names = scope.names();
            let at = report.part(source, 1..1 + name.len());
            let message = format!("the composite has no property {}", quoted(name));
            let known = ("its properties are", names.iter().copied());
            let one = report.unknown(&codes::UNKNOWN_SOURCE, at, message, name, known);
            report.push(match names.is_empty() {
                true => one.help("declare it: `<property name=\"...\">...</property>` in the composite"),
                false => one,
            });
            return Err(());
        };
        parameter.is_used = true;
        let whole = match parameter.setting {
            Some(setting) => Raw::one(&setting.value),
            None => raw(parameter.property, &scope.composite.document, report)?,
        };
        let Some(path) = path else { return Ok(whole) };
        let start = source.len() - path.len();
        walk(whole, path).map_err(|(step, message)| {
            let at = report.part(source, start + step.start..start + step.end);
            report.push(Diagnostic::new(&codes::SOURCE_MALFORMED, at, message));
        })
    }

    /// Reports the properties that have to have a value and have none, and those that nothing uses.
    pub(super) fn finish(self, report: &mut Report<'_>) {
        for scope in &self.scopes {
            for property in &scope.composite.properties {
                let Some(parameter) = scope.by_name.get(property.name.as_str()) else { continue };
                if !std::ptr::eq(parameter.property, property) {
                    continue;
                }
                let name = &property.name;
                let must = property.must_supply().is_some_and(|must| must.value);
                if must && !property.has_value() && parameter.setting.is_none() {
                    let message =
                        format!("the property {} of the composite has to be given a value", quoted(name));
                    report.push(
                        Diagnostic::new(&codes::COMPOSITE_PROPERTY_MISSING, name.location, message)
                            .help(format!("write it in the file, or give `--set {name}=...`")),
                    );
                }
                if !parameter.is_used && !scope.has_wrong_source {
                    let message =
                        format!("the property {} of the composite is used by no component", quoted(name));
                    let one = Diagnostic::new(&codes::UNUSED_PROPERTY, name.location, message);
                    report.push(one.help(format!("a component takes its value with `source=\"${name}\"`")));
                }
            }
        }
    }
}

/// `$name` or `$name/path`.
fn expression(source: &str) -> Option<(&str, Option<&str>)> {
    let rest = source.strip_prefix('$')?;
    let (name, path) = rest.split_once('/').map_or((rest, None), |(name, path)| (name, Some(path)));
    (!name.is_empty()).then_some((name, path))
}

/// The part of a complex value that a path of element names leads to; prefixes do not count.
fn walk<'a>(whole: Raw<'a>, path: &str) -> Result<Raw<'a>, (Range<usize>, String)> {
    let Some(mut here) = whole.elements() else {
        return Err((0..path.len(), "the property has a simple value: there are no parts in it".to_owned()));
    };
    // `$order/total` also means the `total` of a value that is written as one element.
    if let [only] = here[..] {
        let first = local(path.split('/').next().unwrap_or_default());
        if only.local_name() != first && only.children().any(|child| child.local_name() == first) {
            here = only.children().collect();
        }
    }
    let mut start = 0;
    let mut steps = path.split('/').peekable();
    while let Some(step) = steps.next() {
        let at = start..start + step.len();
        start = at.end + 1;
        let found: Vec<Element<'_>> =
            here.iter().copied().filter(|one| one.local_name() == local(step)).collect();
        match found[..] {
            [] if local(step).contains(|c| "[](){}*@.'\"".contains(c)) => {
                return Err((
                    at,
                    format!("{} is no element name, and others are not understood", quoted(step)),
                ));
            }
            [] => {
                let known = list(here.iter().map(|one| one.local_name()));
                return Err((at, format!("there is no part {}; the parts are {known}", quoted(step))));
            }
            _ if steps.peek().is_none() => return Ok(Raw::of_elements(&found)),
            [one] => here = one.children().collect(),
            _ => return Err((at, format!("there are {} parts {}", found.len(), quoted(step)))),
        }
    }
    Err((0..path.len(), "the path is empty".to_owned()))
}

/// The name that a step asks for, without its prefix: `b` in `a:b` and in `*[local-name()='b']`.
fn local(step: &str) -> &str {
    let by_predicate = step.strip_prefix("*[local-name()='").and_then(|rest| rest.strip_suffix("']"));
    by_predicate.unwrap_or_else(|| step.rsplit(':').next().unwrap_or(step))
}
