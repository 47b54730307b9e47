//! An assembly as a composite that comes to the same assembly.

use std::collections::{BTreeMap, HashSet};
use std::time::Duration;

use saoms_api::Properties;
use saoms_api::host::{PropertyValue, WriteProperties, format_duration};
use saoms_lang::assembly::{
    Assembly, ComponentSpec, OF_RESTART, Restart, RunPolicy, TaskProperties, WebService, Wire, WireTarget,
};
use saoms_lang::diagnostic::{Diagnostic, SetBy, Severity, SeverityLevel, codes};
use saoms_lang::model::{Composite, Hangup, SAOMS_NAMESPACE, SeverityRule, Version};
use saoms_lang::project::Compilation;
use smol_str::SmolStr;

use crate::element::NewElement;

/// The one composite that is left of a fleet when all is resolved: no includes, no inner composites, no sources of
/// properties, every wire with its service. `None` where there is an error. It has the name, the namespace and the
/// version of SCA of the first composite.
///
/// Components have the order and the paths that they have in the assembly, so a fleet that runs from it does what it
/// did before: where a path is more than a name, the attribute `path` in the namespace of SAOMS keeps it.
///
/// A reference without a target that needs one is a warning in SCA 1.0 and an error in 1.1: an assembly with such a
/// reference is written in 1.0.
///
/// Severities that are lowered in the source composites are lowered in it as well, with the same reason. Of the wiring
/// report, which the compilation may not have made, it keeps what the first composite says of the fleet.
pub fn expanded(compilation: &Compilation<Assembly>) -> Option<String> {
    let (assembly, like) = (compilation.output.as_ref()?, compilation.first()?);
    let paths: Vec<&str> = assembly.components.iter().map(|component| component.path.as_str()).collect();
    let names = names(&paths);
    let lacks_target = |component: &ComponentSpec| {
        let references = component.class.declaration().references.iter().zip(&component.references);
        references.into_iter().any(|(declared, wire)| !declared.optional && wire.ends() == 0)
    };
    let version = match assembly.components.iter().any(lacks_target) {
        true => Version::Osoa10,
        false => like.version,
    };
    let components = assembly.components.iter().zip(&names).map(|(one, name)| {
        let services = services(&one.web);
        let references = one.references.iter().filter(|wire| wire.ends() > 0).map(|wire| reference(wire, &names));
        component(one, name, services.into_iter().chain(references))
    });
    let mut root = run_settings(root(like), &assembly.run)
        .children(severities(like, &compilation.diagnostics))
        .children(components)
        .declare("", version.namespace());
    root.hoist();
    let mut text = String::new();
    root.write(0, &mut text);
    Some(text)
}

/// The services that a component offers over the web, each with its paths.
fn services(offered: &[WebService]) -> Vec<NewElement> {
    let mut names: Vec<&str> = Vec::new();
    for one in offered {
        if !names.contains(&one.service.as_str()) {
            names.push(&one.service);
        }
    }
    let service = |name: &&str| {
        let all: Vec<&WebService> = offered.iter().filter(|one| one.service == *name).collect();
        let binding = |(one, number): (&&WebService, usize)| {
            let name = (all.len() > 1).then(|| format!("{name}{number}"));
            NewElement::new("binding.rest").maybe("name", name).with("uri", one.path.to_string())
        };
        let node = NewElement::new("service").with("name", *name).children(all.iter().zip(1..).map(binding));
        with_deadline(node, all.first().and_then(|one| one.deadline))
    };
    names.iter().map(service).collect()
}

/// A reference with its targets in the fleet and on the web.
fn reference(wire: &Wire, names: &[String]) -> NewElement {
    let uri = |target: &WireTarget| format!("{}/{}", names[target.component], target.service);
    let targets = wire.targets.iter().map(uri);
    let node = NewElement::new("reference").with("name", wire.reference.as_str());
    // In SCA 1.1, a reference with bindings has no `target`; several bindings have names.
    let node = match wire.web.is_empty() {
        true => node.with("target", targets.collect::<Vec<_>>().join(" ")),
        false => {
            let in_fleet = targets.map(|uri| ("binding.sca", uri));
            let on_web = wire.web.iter().map(|target| ("binding.rest", target.address.written()));
            let name = |number: usize| (wire.ends() > 1).then(|| format!("{}{number}", wire.reference));
            let bindings = in_fleet.chain(on_web).zip(1..);
            node.children(
                bindings
                    .map(|((kind, uri), number)| NewElement::new(kind).maybe("name", name(number)).with("uri", uri)),
            )
        }
    };
    // A token has one server, and all bindings of the reference lead to it.
    let token = wire.web.first().and_then(|target| target.token_env.as_deref());
    let node = token.into_iter().fold(node, |node, name| node.with("s:tokenEnv", name).declare("s", SAOMS_NAMESPACE));
    with_deadline(node, wire.deadline)
}

fn with_deadline(node: NewElement, deadline: Option<Duration>) -> NewElement {
    match deadline {
        None => node,
        Some(deadline) => node.with("s:deadline", format_duration(deadline)).declare("s", SAOMS_NAMESPACE),
    }
}

/// The severities that the composite sets.
fn severities<'d>(like: &Composite, found: impl IntoIterator<Item = &'d Diagnostic>) -> Vec<NewElement> {
    let is_of_wiring = |rule: &&SeverityRule| rule.within.is_none() && codes::is_of_wiring(&rule.code);
    let of_wiring = like.severities.iter().filter(is_of_wiring);
    let severity = |code: &str, level: SeverityLevel, reason: &str| {
        let node = NewElement::new("s:severity").with("code", code).with("level", level.name());
        node.with("reason", reason).declare("s", SAOMS_NAMESPACE)
    };
    let lowered = lowered(found)
        .into_iter()
        .map(|(code, set)| severity(code, set.level, set.reason.as_deref().unwrap_or("set on the command line")));
    lowered.chain(of_wiring.map(|rule| severity(&rule.code, rule.level.value, &rule.reason))).collect()
}

/// The root with the name and the namespace of a composite.
fn root(like: &Composite) -> NewElement {
    let namespace = like.target_namespace.as_ref();
    NewElement::new("composite")
        .with("name", like.name.as_str())
        .maybe("targetNamespace", namespace.map(|namespace| namespace.as_str()))
}

/// Adds what the outermost composites say of the run.
fn run_settings(root: NewElement, run: &RunPolicy) -> NewElement {
    let url = run.alert_url.as_ref();
    let hangup = (run.hangup != Hangup::default()).then_some(run.hangup.name());
    let settings = [
        ("s:alertUrl", url.map(|url| url.address.written())),
        ("s:alertTokenEnv", url.and_then(|url| url.token_env.clone())),
        ("s:alertCommand", run.alert_command.as_ref().map(|command| command.line.clone())),
        ("s:hangup", hangup.map(str::to_owned)),
        ("s:lostLink", run.lost_link.map(|effect| effect.name().to_owned())),
    ];
    let written = settings.into_iter().filter_map(|(name, value)| Some((name, value?)));
    written.fold(root, |root, (name, value)| root.with(name, value).declare("s", SAOMS_NAMESPACE))
}

/// The codes that are lowered although the composite that is left has what they are about; each with what hides least.
/// Codes with a diagnostic at its default severity keep that severity.
fn lowered<'d>(found: impl IntoIterator<Item = &'d Diagnostic>) -> BTreeMap<&'static str, &'d SetBy> {
    let mut all: BTreeMap<&'static str, &SetBy> = BTreeMap::new();
    let mut unlowered: HashSet<&'static str> = HashSet::new();
    for one in found.into_iter().filter(|one| codes::outlives_expansion(one.code)) {
        let Some(set) = one.set.as_ref().filter(|set| set.level != SeverityLevel::Set(Severity::Error)) else {
            unlowered.insert(one.code.id);
            continue;
        };
        let known = all.entry(one.code.id).or_insert(set);
        if set.level.hides() < known.level.hides() {
            *known = set;
        }
    }
    all.retain(|code, _| !unlowered.contains(code));
    all
}

/// A name for each path: the path, with dots for what a name cannot have. No two are the same.
fn names(paths: &[&str]) -> Vec<String> {
    // Paths that are names stay as they are, whatever others come to.
    let plain = paths.iter().filter(|path| !path.contains('/'));
    let mut taken: HashSet<String> = plain.map(|path| (*path).to_owned()).collect();
    let name = |path: &&str| {
        if !path.contains('/') {
            return (*path).to_owned();
        }
        let mut name = path.replace('/', ".");
        while !taken.insert(name.clone()) {
            name.push('_');
        }
        name
    };
    paths.iter().map(name).collect()
}

/// A component of a class, with these references.
fn component(component: &ComponentSpec, name: &str, parts: impl IntoIterator<Item = NewElement>) -> NewElement {
    let node = NewElement::new("component").with("name", name);
    let node = match component.path == name {
        true => node,
        false => node.with("s:path", component.path.as_str()).declare("s", SAOMS_NAMESPACE),
    };
    let node = match component.site.as_str() {
        "" => node,
        site => node.with("s:site", site).declare("s", SAOMS_NAMESPACE),
    };
    let node = match component.node.as_str() {
        "" => node,
        name => node.with("s:node", name).declare("s", SAOMS_NAMESPACE),
    };
    node.child(implementation(component)).children(valued(component)).children(parts).children(loops(component))
}

/// The attributes that name the class of a component.
fn implementation(component: &ComponentSpec) -> NewElement {
    let name = component.class.name();
    if let Some((module, class)) = component.class.language().and_then(|_| name.rsplit_once('.')) {
        return NewElement::new("implementation.python").with("module", module).with("class", class);
    }
    let node = NewElement::new("implementation.rust").with("class", name);
    node.maybe("library", component.library.as_deref())
}

/// The properties of a component of a class.
fn valued(component: &ComponentSpec) -> Vec<NewElement> {
    let (presets, declared) = (component.class.presets(), component.class.declaration());
    let own = component.values.iter().zip(component.written.as_deref().unwrap_or(&component.values));
    let own = own.filter(|(value, _)| !presets.contains(value)).map(|(_, (name, written))| property(name, written));
    let is_own = |name: &SmolStr| component.values.iter().any(|(own, _)| own == name);
    let task =
        component.task.iter().flat_map(|task| stated(task, declared.alternates)).filter(|(name, _)| !is_own(name));
    own.chain(task.map(|(name, value)| property(&name, &value))).collect()
}

/// The task properties that a composite has to give, in order: the required ones, and those that are not the default of
/// a class that alternates with others, or does not.
fn stated(task: &TaskProperties, alternates: bool) -> Vec<(SmolStr, PropertyValue)> {
    let declarations = TaskProperties::declarations();
    let is_required = |name: &str| declarations.iter().any(|one| one.required && one.name == name);
    let mut all = task.to_values();
    let required: Vec<_> = all.iter().filter(|(name, _)| is_required(name)).cloned().collect();
    let usual = TaskProperties::from_values(&required).map(|usual| {
        let delay = TaskProperties::usual_delay(usual.period, alternates);
        TaskProperties { delay, ..usual }.to_values()
    });
    let usual = usual.unwrap_or_default();
    all.retain(|one| {
        let (name, is_usual) = (one.0.as_str(), usual.contains(one));
        !is_usual || is_required(name) || OF_RESTART.contains(&name) && task.restart == Restart::OnFailure
    });
    all
}

fn property(name: &str, value: &PropertyValue) -> NewElement {
    let node = NewElement::new("property").with("name", name);
    match value {
        PropertyValue::Scalar(scalar) => text_of(node, &scalar.text()),
        PropertyValue::Many(values) => node.children(values.iter().flat_map(|one| part("value", one, false))),
        PropertyValue::Complex(parts) => node.children(inside(parts)),
    }
}

/// A property with a text. White space at the ends of a text inside an element does not count, and an empty one is
/// none.
fn text_of(property: NewElement, text: &str) -> NewElement {
    if text.is_empty() { property.child(NewElement::new("value")) } else { property.text(text) }
}

/// The named values of a complex property, in no namespace.
fn inside(parts: &[(SmolStr, PropertyValue)]) -> impl Iterator<Item = NewElement> {
    parts.iter().flat_map(|(name, value)| part(name, value, true))
}

/// A value as elements of a name: several where it is a list. No declaration has lists of lists.
fn part(name: &str, value: &PropertyValue, is_in_none: bool) -> Vec<NewElement> {
    let node = || match is_in_none {
        true => NewElement::new(name.to_owned()).with("xmlns", ""),
        false => NewElement::new(name.to_owned()),
    };
    match value {
        PropertyValue::Scalar(scalar) => vec![node().text(&scalar.text())],
        PropertyValue::Complex(parts) => vec![node().children(inside(parts))],
        PropertyValue::Many(values) => values.iter().flat_map(|value| part(name, value, is_in_none)).collect(),
    }
}

/// Differences of the loops of a component from those of its class.
fn loops(component: &ComponentSpec) -> Vec<NewElement> {
    let declaration = component.class.declaration();
    let usual = declaration.loops_of(&component.values).iter();
    let usual: Vec<(&str, &str)> = usual.map(|class| (simple(class), class.as_str())).collect();
    let is_there = |name: &str| component.loops.iter().any(|one| one.name == name);
    let is_usual = |name: &str| usual.iter().any(|(known, _)| *known == name);
    let kept = usual.iter().map(|(name, _)| *name).filter(|name| is_there(name));
    let added = component.loops.iter().map(|one| one.name.as_str()).filter(|name| !is_usual(name));
    let is_in_order = component.loops.iter().map(|one| one.name.as_str()).eq(kept.chain(added));
    let removed = usual.iter().filter(|(name, _)| !is_there(name));
    let element = |name: &str| NewElement::new("s:loop").declare("s", SAOMS_NAMESPACE).with("name", name);
    let mut all: Vec<_> = removed.map(|(name, _)| element(name).with("remove", "true")).collect();
    for (place, one) in component.loops.iter().enumerate() {
        let class = one.class.name();
        let is_same = usual.iter().any(|(name, usual)| *name == one.name && *usual == class);
        let before = place.checked_sub(1).map(|before| component.loops[before].name.as_str());
        let after = before.filter(|_| !is_in_order);
        if !is_same || after.is_some() || !one.values.is_empty() {
            let node = element(&one.name).maybe("class", (!is_same).then_some(class)).maybe("after", after);
            all.push(node.children(
                one.written.as_deref().unwrap_or(&one.values).iter().map(|(name, value)| property(name, value)),
            ));
        }
    }
    all
}

/// The name of a loop unless it is given one: the text behind the last dot of its class.
fn simple(class: &str) -> &str {
    class.rsplit('.').next().unwrap_or(class)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(values: &[(&str, &str)], alternates: bool) -> String {
        let values: Vec<(SmolStr, PropertyValue)> =
            values.iter().map(|(name, value)| ((*name).into(), (*value).into())).collect();
        let stated = stated(&TaskProperties::from_values(&values).unwrap(), alternates);
        let shown = stated.iter().map(|(name, value)| match value {
            PropertyValue::Scalar(value) => format!("{name}={value}"),
            other => panic!("{other:?}"),
        });
        shown.collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn a_composite_states_what_is_required_and_what_is_not_the_default() {
        let of =
            |more: &[(&str, &str)], alternates| shown(&[&[("ID", "a"), ("period", "1000")], more].concat(), alternates);
        let task = |more: &[(&str, &str)]| of(more, false);
        assert_eq!(task(&[]), "ID=a period=1s");
        assert_eq!(of(&[("delay", "500")], true), "ID=a period=1s");
        assert_eq!(of(&[("delay", "0")], true), "ID=a period=1s delay=0s");
        assert_eq!(task(&[("delay", "0"), ("useJMS", "true")]), "ID=a period=1s");
        // Without it, a queue is as large as its topic needs.
        assert_eq!(task(&[("queue", "01024")]), "ID=a period=1s queue=1024");
        let given = [("loss", "accept"), ("topicRename", " A , b ::C,d"), ("overrun", "catchUp"), ("deadline", "0.5s")];
        assert_eq!(task(&given), "ID=a period=1s topicRename=A,b::C,d overrun=catchUp deadline=500ms loss=accept");
        let restart = task(&[("restartLimit", "7"), ("restart", "onFailure")]);
        assert_eq!(restart, "ID=a period=1s restart=onFailure restartBackoff=100ms restartLimit=7");
    }
}
