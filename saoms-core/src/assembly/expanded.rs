//! An assembly as a composite that comes to the same assembly.

use std::collections::BTreeMap;
use std::collections::HashSet;
use std::fmt::Write as _;

use saoms_api::{PropertyValue, format_duration};

use super::{Assembly, ComponentSpec, Loss, Overrun, Restart, TaskSettings};
use crate::diagnostic::{Diagnostic, Level, SetBy, Severity, codes};
use crate::model::{Composite, SAOMS_NAMESPACE, SeverityRule, Version};

/// Writes an assembly as one composite in which nothing is left to resolve: no includes, no inner composites, no sources of properties,
/// every wire with its service. It has the name, the namespace and the version of SCA of `like`.
///
/// Components have the order and the paths that they have in the assembly, so a fleet that runs from it does what it did before: where
/// a path is more than a name, the attribute `path` in the namespace of SAOMS keeps it.
///
/// A reference that leads nowhere although it should is a warning in SCA 1.0 and an error in 1.1: an assembly with such a one is
/// written in 1.0.
///
/// What would be told again of that composite and is lowered in those that it comes from is lowered in it as well, for the same reason: `found` are the
/// diagnostics of the check that made the assembly. Of the wiring report, which that check may not have made, it keeps what `like` says of the fleet.
pub fn expanded<'d>(
    assembly: &Assembly,
    like: &Composite,
    found: impl IntoIterator<Item = &'d Diagnostic>,
) -> String {
    let names = names(assembly);
    let lacks_target = |component: &ComponentSpec| {
        let references = component.class.declaration().references.iter().zip(&component.references);
        references.into_iter().any(|(declared, wire)| !declared.optional && wire.targets.is_empty())
    };
    let version = match assembly.components.iter().any(lacks_target) {
        true => Version::Osoa10,
        false => like.version,
    };
    let mut out = Writer { text: String::new(), depth: 0 };
    let mut attributes = vec![("xmlns", version.namespace())];
    let is_own = |(component, name): (&ComponentSpec, &String)| {
        component.path != *name || !loops(component).is_empty()
    };
    let lowered = lowered(found);
    let is_of_wiring = |rule: &&SeverityRule| rule.within.is_none() && codes::is_of_wiring(&rule.code);
    let of_wiring: Vec<_> = like.severities.iter().filter(is_of_wiring).collect();
    if !lowered.is_empty() || !of_wiring.is_empty() || assembly.components.iter().zip(&names).any(is_own) {
        attributes.push(("xmlns:s", SAOMS_NAMESPACE));
    }
    attributes.push(("name", like.name.as_str()));
    attributes
        .extend(like.target_namespace.as_ref().map(|namespace| ("targetNamespace", namespace.as_str())));
    out.open("composite", &attributes);
    for (code, set) in lowered {
        let reason = set.reason.as_deref().unwrap_or("set on the command line");
        out.empty("s:severity", &[("code", code), ("level", set.level.name()), ("reason", reason)]);
    }
    for rule in of_wiring {
        let level = rule.level.value.name();
        out.empty("s:severity", &[("code", &rule.code), ("level", level), ("reason", &rule.reason)]);
    }
    for (component, name) in assembly.components.iter().zip(&names) {
        out.component(component, name, &names);
    }
    out.close("composite");
    out.text
}

/// The codes that are lowered although the composite that is left has what they are about; each with what hides least. Codes of which something
/// is told as it is are told so again.
fn lowered<'d>(found: impl IntoIterator<Item = &'d Diagnostic>) -> BTreeMap<&'static str, &'d SetBy> {
    let mut all: BTreeMap<&'static str, &SetBy> = BTreeMap::new();
    let mut told: HashSet<&'static str> = HashSet::new();
    for one in found.into_iter().filter(|one| codes::outlives_expansion(one.code)) {
        let Some(set) = one.set.as_ref().filter(|set| set.level != Level::Set(Severity::Error)) else {
            told.insert(one.code.id);
            continue;
        };
        let known = all.entry(one.code.id).or_insert(set);
        if set.level.hides() < known.level.hides() {
            *known = set;
        }
    }
    all.retain(|code, _| !told.contains(code));
    all
}

/// A name for each component: its path, with dots for what a name cannot have. No two are the same.
fn names(assembly: &Assembly) -> Vec<String> {
    // Paths that are names stay as they are, whatever others come to.
    let plain = assembly.components.iter().map(|component| component.path.as_str());
    let mut taken: HashSet<String> = plain.filter(|path| !path.contains('/')).map(str::to_owned).collect();
    let name = |component: &ComponentSpec| {
        if !component.path.contains('/') {
            return component.path.clone();
        }
        let mut name = component.path.replace('/', ".");
        while !taken.insert(name.clone()) {
            name.push('_');
        }
        name
    };
    assembly.components.iter().map(name).collect()
}

struct Writer {
    text: String,
    depth: usize,
}

impl Writer {
    fn component(&mut self, component: &ComponentSpec, name: &str, names: &[String]) {
        let mut attributes = vec![("name", name)];
        if component.path != name {
            attributes.push(("s:path", &component.path));
        }
        self.open("component", &attributes);
        let class = ("class", component.class.name());
        match &component.library {
            None => self.empty("implementation.rust", &[class]),
            Some(library) => self.empty("implementation.rust", &[class, ("library", library)]),
        }
        let presets = component.class.presets();
        for (name, value) in component.values.iter().filter(|value| !presets.contains(value)) {
            self.property(name, value);
        }
        for (name, value) in component.task.iter().flat_map(task) {
            let value = PropertyValue::Text(value);
            let is_known = component.values.iter().any(|(known, _)| known == name);
            if !is_known && !presets.iter().any(|(preset, given)| preset == name && *given == value) {
                self.property(name, &value);
            }
        }
        for wire in component.references.iter().filter(|wire| !wire.targets.is_empty()) {
            let uri = |target: &super::Target| format!("{}/{}", names[target.component], target.service);
            let targets: Vec<String> = wire.targets.iter().map(uri).collect();
            self.empty("reference", &[("name", &wire.reference), ("target", &targets.join(" "))]);
        }
        for said in loops(component) {
            let given =
                [("class", said.class), ("after", said.after), ("remove", said.is_removed.then_some("true"))];
            let mut attributes = vec![("name", said.name)];
            attributes.extend(given.into_iter().filter_map(|(name, value)| Some((name, value?))));
            if said.values.is_empty() {
                self.empty("s:loop", &attributes);
                continue;
            }
            self.open("s:loop", &attributes);
            said.values.iter().for_each(|(name, value)| self.property(name, value));
            self.close("s:loop");
        }
        self.close("component");
    }

    fn property(&mut self, name: &str, value: &PropertyValue) {
        match value {
            // White space at the ends of a text inside an element does not count, and an empty one is none.
            PropertyValue::Text(text) if text.is_empty() => {
                self.open("property", &[("name", name)]);
                self.empty("value", &[]);
                self.close("property");
            }
            PropertyValue::Text(text) => self.with_text("property", &[("name", name)], text),
            PropertyValue::Many(values) => {
                self.open("property", &[("name", name)]);
                for value in values {
                    self.value("value", &[], value);
                }
                self.close("property");
            }
            PropertyValue::Complex(parts) => {
                self.open("property", &[("name", name)]);
                self.parts(parts);
                self.close("property");
            }
        }
    }

    /// The named values of a complex property, in no namespace.
    fn parts(&mut self, parts: &[(String, PropertyValue)]) {
        for (name, value) in parts {
            match value {
                PropertyValue::Many(values) => {
                    values.iter().for_each(|value| self.value(name, &[("xmlns", "")], value));
                }
                one => self.value(name, &[("xmlns", "")], one),
            }
        }
    }

    fn value(&mut self, name: &str, attributes: &[(&str, &str)], value: &PropertyValue) {
        match value {
            PropertyValue::Text(text) => self.with_text(name, attributes, text),
            PropertyValue::Complex(parts) => {
                self.open(name, attributes);
                self.parts(parts);
                self.close(name);
            }
            // No declaration has lists of lists.
            PropertyValue::Many(values) => {
                values.iter().for_each(|value| self.value(name, attributes, value))
            }
        }
    }

    fn tag(&mut self, name: &str, attributes: &[(&str, &str)]) {
        let _ = write!(self.text, "{:1$}<{name}", "", 2 * self.depth);
        for (name, value) in attributes {
            let _ = write!(self.text, " {name}=\"{}\"", escaped(value));
        }
    }

    fn open(&mut self, name: &str, attributes: &[(&str, &str)]) {
        self.tag(name, attributes);
        self.text.push_str(">\n");
        self.depth += 1;
    }

    fn close(&mut self, name: &str) {
        self.depth -= 1;
        let _ = writeln!(self.text, "{:1$}</{name}>", "", 2 * self.depth);
    }

    fn empty(&mut self, name: &str, attributes: &[(&str, &str)]) {
        self.tag(name, attributes);
        self.text.push_str("/>\n");
    }

    fn with_text(&mut self, name: &str, attributes: &[(&str, &str)], text: &str) {
        self.tag(name, attributes);
        let _ =
            writeln!(self.text, ">{}</{name}>", escaped(text).replace("&#10;", "\n").replace("&#9;", "\t"));
    }
}

/// What has to be said about a loop of a component.
struct Said<'a> {
    name: &'a str,
    class: Option<&'a str>,
    after: Option<&'a str>,
    is_removed: bool,
    values: &'a [(String, PropertyValue)],
}

/// How the loops of a component differ from those that its class gives it.
fn loops(component: &ComponentSpec) -> Vec<Said<'_>> {
    let declaration = component.class.declaration();
    let value = declaration.loops.property.as_ref().and_then(|property| {
        match component.values.iter().find(|(name, _)| name == property) {
            Some((_, PropertyValue::Text(text))) => Some(text.trim()),
            _ => declaration.property(property)?.default.as_deref(),
        }
    });
    let usual: Vec<(&str, &str)> =
        declaration.loops.of(value).iter().map(|class| (simple(class), class.as_str())).collect();
    let is_there = |name: &str| component.loops.iter().any(|one| one.name == name);
    let is_usual = |name: &str| usual.iter().any(|(known, _)| *known == name);
    let kept = usual.iter().map(|(name, _)| *name).filter(|name| is_there(name));
    let added = component.loops.iter().map(|one| one.name.as_str()).filter(|name| !is_usual(name));
    let is_in_order = component.loops.iter().map(|one| one.name.as_str()).eq(kept.chain(added));
    let removed = usual.iter().filter(|(name, _)| !is_there(name));
    let mut all: Vec<Said<'_>> = removed
        .map(|(name, _)| Said { name, class: None, after: None, is_removed: true, values: &[] })
        .collect();
    for (place, one) in component.loops.iter().enumerate() {
        let class = one.class.name();
        let is_same = usual.iter().any(|(name, usual)| *name == one.name && *usual == class);
        let before = place.checked_sub(1).map(|before| component.loops[before].name.as_str());
        let said = Said {
            name: &one.name,
            class: (!is_same).then_some(class),
            after: before.filter(|_| !is_in_order),
            is_removed: false,
            values: &one.values,
        };
        if said.class.is_some() || said.after.is_some() || !said.values.is_empty() {
            all.push(said);
        }
    }
    all
}

/// What a loop is called unless it is given a name: what follows the last dot of its class.
fn simple(class: &str) -> &str {
    class.rsplit('.').next().unwrap_or(class)
}

/// A text as it can stand in an attribute: also what reading would make a blank of.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' | '\r' => _ = write!(out, "&#{};", character as u32),
            _ => out.push(character),
        }
    }
    out
}

/// The task properties that are not as they are by themselves.
fn task(task: &TaskSettings) -> Vec<(&'static str, String)> {
    let mut all = vec![("ID", task.id.clone()), ("period", format_duration(task.period))];
    let mut add = |name, is_usual: bool, value: String| {
        if !is_usual {
            all.push((name, value));
        }
    };
    add("delay", task.delay.is_zero(), format_duration(task.delay));
    add("runOnStartup", task.run_on_startup, task.run_on_startup.to_string());
    add("mayInterruptIfRunning", task.may_interrupt_if_running, task.may_interrupt_if_running.to_string());
    add("useJMS", task.use_jms, task.use_jms.to_string());
    for (name, text) in [("url", &task.url), ("user", &task.user), ("password", &task.password)] {
        add(name, text.is_none(), text.clone().unwrap_or_default());
    }
    let renames: Vec<String> = task.topic_rename.iter().map(|(old, new)| format!("{old},{new}")).collect();
    add("topicRename", renames.is_empty(), renames.join("::"));
    match task.overrun {
        Overrun::Skip => {}
        Overrun::CatchUp => add("overrun", false, "catchUp".to_owned()),
        Overrun::Stop => add("overrun", false, "stop".to_owned()),
    }
    if let Restart::OnFailure { backoff, limit } = task.restart {
        add("restart", false, "onFailure".to_owned());
        add("restartBackoff", false, format_duration(backoff));
        add("restartLimit", false, limit.to_string());
    }
    if let Some(deadline) = task.deadline {
        add("deadline", false, format_duration(deadline));
    }
    add("queue", task.queue == 1024, task.queue.to_string());
    add("loss", task.loss == Loss::Fail, "accept".to_owned());
    all
}
