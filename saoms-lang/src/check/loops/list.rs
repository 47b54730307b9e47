//! The list of a component's loops: those of its class, some of them removed, replaced or moved, and those that are
//! added.

use std::collections::HashMap;

use super::{Planned, order};
use crate::check::classes::registered;
use crate::check::fleet::Member;
use crate::check::fleet::class_index::ClassIndex;
use crate::check::options::Options;
use crate::check::properties::given_values::PropertyValues;
use crate::check::report::{Report, replacing};
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::{LoopElement, Part};
use crate::registry::Registry;
use crate::source::Text;
use crate::syntax::escaped;

/// The loops of a component in their order, and whether nothing about them is wrong.
pub(super) fn plan<'a>(
    member: &Member<'a>,
    class: &ClassIndex<'a>,
    checked: &PropertyValues,
    (registry, options): (&'a Registry, &Options),
    report: &mut Report<'_>,
) -> (Vec<Planned<'a>>, bool) {
    let (mut loops, mut is_sound) = by_default(member, class, checked, registry, report);
    let elements = &member.component.loops;
    let Some(first) = elements.first() else { return (loops, is_sound) };
    if class.class.declaration().knowledge.is_none() {
        let message = format!("class {} has no loops", quoted(class.class.name()));
        let one = Diagnostic::new(&codes::LOOP_KNOWLEDGE, first.tag(), message);
        report.push(one.help("loops work on the knowledge of a component, but this component declares none"));
        return (loops, false);
    }
    let mut named: HashMap<&str, &LoopElement> = HashMap::new();
    let mut removed: HashMap<&str, &LoopElement> = HashMap::new();
    let mut taken: Vec<&LoopElement> = Vec::with_capacity(elements.len());
    for one in elements {
        if one.name.is_empty() {
            is_sound = false;
        } else if let Some(first) = named.get(one.name.as_str()) {
            let message = format!("the loop {} is given twice", quoted(&one.name));
            let one = Diagnostic::new(&codes::LOOP_REPEATED, one.name.location, message);
            let help = "write everything about a loop in one element; two loops of the same class need different names";
            report.push(one.label(first.name.location, "first given here").help(help));
            is_sound = false;
        } else {
            named.insert(&one.name, one);
            taken.push(one);
        }
    }
    // Those that come anew can be meant by others, wherever they stand.
    let added = taken.iter().filter(|one| one.class.is_some()).map(|one| one.name.as_str());
    let mut names: Vec<&str> = loops.iter().map(|one| one.name).collect();
    // Those that the class has; no two elements are about one loop.
    let mut usual = loops.len();
    names.extend(added.filter(|name| !loops.iter().any(|known| known.name == *name)));
    for one in &taken {
        is_sound &= fits_together(one, report);
        let known = loops[..usual].iter().position(|known| known.name == one.name.as_str());
        let class = one.class.as_ref().map(|class| {
            let found = registry.get_loop(class);
            if found.is_none() {
                is_sound = false;
                if !options.assume_classes && !report.skip(&codes::UNKNOWN_CLASS, Severity::Error, class.location) {
                    report.push(unknown_class(class, registry));
                }
            }
            found
        });
        match (known, class) {
            (Some(place), _) if one.is_removal() => {
                removed.insert(&one.name, one);
                loops.remove(place);
                usual -= 1;
            }
            (Some(place), class) => {
                if is_sound {
                    unchanged(one, report);
                }
                loops[place].element = Some(one);
                if let Some(class) = class {
                    let before = std::mem::replace(&mut loops[place].class, class);
                    loops[place].replaced = before;
                }
            }
            (None, Some(class)) if !one.is_removal() => {
                loops.push(Planned { name: &one.name, class, element: Some(one), replaced: None });
            }
            (None, _) => {
                report_unknown(&one.name, member, &names, one.is_removal(), report);
                is_sound = false;
            }
        }
    }
    is_sound &= order::sort(&mut loops, &taken, &removed, member, &names, report);
    (loops, is_sound)
}

/// The loops that a component has unless the composite says otherwise.
fn by_default<'a>(
    member: &Member<'a>,
    class: &ClassIndex<'a>,
    checked: &PropertyValues,
    registry: &'a Registry,
    report: &mut Report<'_>,
) -> (Vec<Planned<'a>>, bool) {
    let mut is_sound = true;
    let mut loops = Vec::new();
    for name in class.class.declaration().loops_of(checked.own()) {
        match registry.get_loop(name) {
            Some(class) => {
                let name = class.declaration().short_name();
                loops.push(Planned { name, class: Some(class), element: None, replaced: None });
            }
            None => {
                let (class, name) = (quoted(class.class.name()), quoted(name));
                let message = format!("class {class} has the loop {name}, but no such loop is registered");
                let at = member.component.name.location;
                report.push(Diagnostic::new(&codes::UNKNOWN_CLASS, at, message));
                is_sound = false;
            }
        }
    }
    (loops, is_sound)
}

/// True if what an element says makes sense: what is removed is nothing else, and nothing stands at two places.
fn fits_together(one: &LoopElement, report: &mut Report<'_>) -> bool {
    let code = &codes::LOOP_CONTRADICTION;
    if let Some(remove) = one.remove.filter(|remove| remove.value) {
        let attributes = [("`class`", &one.class), ("`before`", &one.before), ("`after`", &one.after)];
        let given = attributes.into_iter().filter_map(|(name, value)| Some((name, value.as_ref()?.location)));
        let properties = one.properties.first().map(|property| ("properties", property.tag()));
        let Some((what, at)) = given.chain(properties).next() else { return true };
        let message = format!("the loop {} is removed, but has {what}", quoted(&one.name));
        let one = Diagnostic::new(code, at, message).label(remove.location, "removed here");
        report.push(one.help("remove this, or keep the loop: a removed loop has no class, place or properties"));
        return false;
    }
    if let (Some(before), Some(after)) = (&one.before, &one.after) {
        let message = format!("the loop {} has both `before` and `after`", quoted(&one.name));
        let one = Diagnostic::new(code, after.location, message).label(before.location, "the `before`");
        report.push(one.help("keep either `before` or `after`"));
        return false;
    }
    true
}

/// Reports an element that names a loop that the component has, and leaves all of it as it is.
fn unchanged(one: &LoopElement, report: &mut Report<'_>) {
    let says_something = [&one.class, &one.before, &one.after].into_iter().any(Option::is_some);
    if says_something || !one.properties.is_empty() || one.is_misread {
        return;
    }
    let message =
        format!("this element has no effect: the component's class has the loop {} already", quoted(&one.name));
    let one = Diagnostic::new(&codes::LOOP_UNCHANGED, one.tag(), message);
    report.push(one.help("remove it, or write what to change: `class`, `before`, `after`, `remove` or properties"));
}

/// Reports a name that is none of a component's loops.
pub(super) fn report_unknown(
    name: &Text,
    member: &Member<'_>,
    names: &[&str],
    is_removal: bool,
    report: &mut Report<'_>,
) {
    let component = quoted(&member.component.name);
    let message = format!("component {component} has no loop {}", quoted(name));
    let known = ("its loops are", names.iter().copied());
    let one = match name.rsplit_once('.').filter(|(_, meant)| names.contains(meant)) {
        Some((_, meant)) => {
            Diagnostic::new(&codes::UNKNOWN_LOOP, name.location, message).replace(name, name.location, meant)
        }
        None => report.unknown(&codes::UNKNOWN_LOOP, name.location, message, name, known),
    };
    let one = if names.is_empty() { one.help("it has none") } else { one };
    report.push(if is_removal { one } else { one.help("to add a loop, name its class: `class=\"...\"`") });
}

fn unknown_class(class: &Text, registry: &Registry) -> Diagnostic {
    let message = format!("there is no loop class {}", quoted(class));
    let mut one = Diagnostic::new(&codes::UNKNOWN_CLASS, class.location, message).at("not registered");
    if registry.get(class).is_some() {
        let component = format!("`<implementation.rust class=\"{class}\"/>`");
        return one.help(format!("it is a component class: a component uses it with {component}"));
    }
    for meant in registry.nearest_loops(class) {
        one = one.suggest(replacing(class, meant), class.location, escaped(meant));
    }
    one.help(registered(("loop", "loops"), registry.loops().map(|one| one.name())))
}
