//! URIs that lead to no component, or are written in another way than SCA's, and their probable meaning.

use crate::check::contracts::offer::parts;
use crate::check::fleet::{Fleet, Side};
use crate::check::report::{Report, list};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::expression::pattern;
use crate::source::{Location, Text};

/// The meaning of a URI, as far as it is known, and the reason why the URI does not say it.
pub(crate) struct Misread {
    meant: Option<String>,
    help: String,
}

impl Misread {
    /// A diagnostic about the URI with what to write.
    pub(crate) fn add_to(self, one: Diagnostic, text: &Text) -> Diagnostic {
        let one = one.help(self.help);
        match self.meant {
            Some(meant) => one.replace(text, text.location, &meant),
            None => one,
        }
    }
}

/// The meaning of a URI that is written in another way: with the index of a replica where there is none, or as other
/// languages write it, with commas between several, or something else than `/` before the name of a service.
pub(crate) fn misread(text: &str, scope: usize, side: Side, fleet: &Fleet<'_>) -> Option<Misread> {
    const LISTED: [char; 3] = [',', ';', '|'];
    const BEHIND: [char; 6] = ['#', '.', ':', '\\', '>', '-'];
    if text.contains("${") {
        let group = pattern(text);
        let is_known = fleet.group(scope, parts(&group).0).is_some();
        let help = "`${index}` works only inside replicas; use `*` to name all replicas";
        return is_known.then(|| Misread { meant: Some(group), help: help.to_owned() });
    }
    if text.contains(LISTED) {
        let named: Vec<&str> = text.split(LISTED).filter(|name| !name.is_empty()).collect();
        let is_known = |name: &&str| fleet.find(scope, parts(name).0).is_some();
        let help = "separate several names with blanks".to_owned();
        return named.iter().any(is_known).then(|| Misread { meant: Some(named.join(" ")), help });
    }
    if let Some((around, inner)) = text.split_once('/')
        && fleet.find(scope, around).is_none()
        && fleet.group(scope, around).is_none()
        && fleet.find(scope, parts(inner).0).is_some()
    {
        let help = "write the name of a component in this composite without what is around it".to_owned();
        return Some(Misread { meant: Some(inner.to_owned()), help });
    }
    let places = text.char_indices().filter(|(_, character)| BEHIND.contains(character));
    let mut split = places.map(|(at, _)| (&text[..at], text[at..].trim_start_matches(BEHIND)));
    let is_known = |name: &str| fleet.find(scope, name).is_some() || fleet.group(scope, name).is_some();
    let (component, behind) = split.find(|(component, behind)| !behind.is_empty() && is_known(component))?;
    let parts: Vec<&str> = behind.split(['/', '.']).collect();
    let promoted = fleet.find(scope, component).and_then(|member| inside(member, &parts, side, fleet));
    let plain = || {
        let help = format!("write the name of a {} after `/`", side.name());
        Misread { meant: Some(format!("{component}/{behind}")), help }
    };
    Some(promoted.unwrap_or_else(plain))
}

/// The target of a URI that leads into the composite of a component, by the name of a component there and perhaps of
/// its service or reference: what of it the composite promotes.
pub(crate) fn inside(member: usize, behind: &[&str], side: Side, fleet: &Fleet<'_>) -> Option<Misread> {
    let inner = fleet.inner(member)?;
    let (first, rest) = behind.split_first()?;
    fleet.find(inner.scope, first)?;
    let name = &fleet.members[member].component.name;
    let leads_there = |promote: &Text| {
        let (component, part) = parts(promote);
        component == *first && rest.first().is_none_or(|named| part.is_none_or(|part| part == *named))
    };
    let promoted: Vec<&str> = match side {
        Side::Service => {
            let all = inner.services().filter(|one| one.promote.as_ref().is_some_and(leads_there));
            all.map(|one| one.name.as_str()).collect()
        }
        Side::Reference => {
            let all = inner.references().filter(|one| one.promote.iter().any(leads_there));
            all.map(|one| one.name.as_str()).collect()
        }
    };
    let (inner_name, outer) = (quoted(first), quoted(name));
    let why = format!("{inner_name} is inside {outer}: use what the composite of {outer} promotes");
    Some(match promoted[..] {
        [only] => Misread { meant: Some(format!("{name}/{only}")), help: why },
        [] => Misread { meant: None, help: format!("{why}; it promotes no {} of {inner_name}", side.name()) },
        _ => Misread { meant: None, help: format!("{why}: {}", list(promoted)) },
    })
}

/// The diagnostic about the name of a component that does not exist, which `own` writes and means another one by. Such
/// as `R03` and `R2` are held against the replicas of a group, `R02`; of them that with the nearest number is meant.
pub(crate) fn unknown_component(
    name: &str,
    (scope, own): (usize, Option<usize>),
    (side, is_promoted): (Side, bool),
    at: Location,
    message: String,
    fleet: &Fleet<'_>,
    report: &mut Report<'_>,
) -> Diagnostic {
    let own = own.map(|own| fleet.members[own].component.name.as_str());
    let group = format!("{name}*");
    if let Some(replicas) = fleet.group(scope, &group) {
        let one = Diagnostic::new(&codes::UNKNOWN_COMPONENT, at, message);
        // A reference usually takes one target.
        return match replicas.first().filter(|_| side == Side::Service && !is_promoted) {
            Some(first) => {
                let first = fleet.members[*first].component.name.as_str();
                one.replace(name, at, first).help(format!("{} names all replicas", quoted(&group)))
            }
            None => one.replace(name, at, &group),
        };
    }
    if let Some((meant, help)) = nearest_replica(name, scope, fleet) {
        let one = Diagnostic::new(&codes::UNKNOWN_COMPONENT, at, message).help(help);
        // Where the composite is used again, its replicas may have other numbers.
        let pattern = pattern_of(name, scope, fleet).filter(|_| is_promoted);
        return match (pattern, Some(meant) == own) {
            (Some(pattern), _) => one.replace(name, at, pattern),
            (None, true) => one,
            (None, false) => one.replace(name, at, meant),
        };
    }
    if let Some(meant) = of_part(name, (scope, is_promoted), fleet) {
        let what = if is_promoted { "reference" } else { "service" };
        let help = format!("{} is a {what}: write the name of its component before it", quoted(name));
        return Diagnostic::new(&codes::UNKNOWN_COMPONENT, at, message).help(help).replace(name, at, &meant);
    }
    if let Some(user) = beside_user(name, scope, fleet).filter(|_| side == Side::Service && !is_promoted) {
        let (target, user) = (quoted(name), quoted(&fleet.members[user].component.name));
        let help = format!(
            "{target} is outside of this composite, beside {user}: promote the reference in this composite, \
             `<reference name=\"...\" promote=\"COMPONENT/reference\"/>`, and give {user} the target {target}"
        );
        return Diagnostic::new(&codes::UNKNOWN_COMPONENT, at, message).help(help);
    }
    let mut of_class = fleet.scopes[scope].members.iter().map(|member| fleet.members[*member].component);
    let mut of_class = of_class.by_ref().filter(|one| one.class().is_some_and(|class| *class == *name));
    if let (Some(only), None) = (of_class.next(), of_class.next()) {
        let one = Diagnostic::new(&codes::UNKNOWN_COMPONENT, at, message).replace(name, at, &only.name);
        return one.help("write the name of the component, not that of its class");
    }
    // A reference of a composite can stand for those of all replicas.
    let (first, last): (Vec<&str>, Vec<&str>) = fleet.group_names(scope).partition(|_| is_promoted);
    // A name with a blank in it is reported, and can be no target.
    let names = fleet.names(scope).filter(|name| Some(*name) != own && !name.contains(char::is_whitespace));
    let known = ("the components are", first.iter().copied().chain(names).chain(last.iter().copied()));
    report.unknown(&codes::UNKNOWN_COMPONENT, at, message, name, known)
}

/// The component around a scope that has a component of this name beside it; the innermost counts.
pub(crate) fn beside_user(name: &str, scope: usize, fleet: &Fleet<'_>) -> Option<usize> {
    let owner = |scope: usize| fleet.scopes[scope].owner;
    let mut users = std::iter::successors(owner(scope), |user| owner(fleet.members[*user].scope));
    users.find(|user| fleet.find(fleet.members[*user].scope, name).is_some())
}

/// The name of the group of replicas of which one with another number is named.
fn pattern_of<'f>(name: &str, scope: usize, fleet: &'f Fleet<'_>) -> Option<&'f str> {
    let without = |name: &str| name.replace(|letter: char| letter.is_ascii_digit() || letter == '*', "");
    fleet.group_names(scope).find(|group| without(group) == without(name))
}

/// What is meant by the name of a service, or of a reference that is promoted, without its component: the only one of
/// that name in the scope.
fn of_part(name: &str, (scope, is_promoted): (usize, bool), fleet: &Fleet<'_>) -> Option<String> {
    let names = |member: usize| match is_promoted {
        true => fleet.reference_names(member),
        false => fleet.service_names(member),
    };
    let has_it = |member: usize| names(member).is_some_and(|names| names.contains(&name));
    let mut groups = fleet.group_names(scope).filter(|_| is_promoted).filter_map(|group| {
        let first = *fleet.group(scope, group)?.first()?;
        has_it(first).then_some((group, fleet.group(scope, group)?.len()))
    });
    let members = fleet.scopes[scope].members.iter().copied();
    let all: Vec<usize> = members.filter(|member| has_it(*member)).take(1000).collect();
    match (groups.next(), &all[..]) {
        (Some((group, count)), all) if all.len() == count => Some(format!("{group}/{name}")),
        (_, [only]) => Some(format!("{}/{name}", fleet.members[*only].component.name)),
        _ => None,
    }
}

/// The replica of a scope with the number that is the nearest to that of a name which is like those of a group, and
/// which replicas there are.
fn nearest_replica<'f>(name: &str, scope: usize, fleet: &'f Fleet<'_>) -> Option<(&'f str, String)> {
    let bytes = name.as_bytes();
    let mut end = 0;
    while let Some(start) = (end..bytes.len()).find(|at| bytes[*at].is_ascii_digit()) {
        end = (start..bytes.len()).find(|at| !bytes[*at].is_ascii_digit()).unwrap_or(bytes.len());
        let (before, behind) = (&name[..start], &name[end..]);
        let Some(group) = fleet.group(scope, &format!("{before}*{behind}")) else { continue };
        let replica = |place: usize| fleet.members[group[place]].component.name.as_str();
        let number = |name: &str| name.strip_prefix(before)?.strip_suffix(behind)?.parse::<u64>().ok();
        let last = group.len().checked_sub(1)?;
        let (from, to) = (number(replica(0))?, number(replica(last))?);
        // As a rule they are numbered one by one. A number of too many digits is larger than all.
        let wanted = number(name).unwrap_or(u64::MAX).clamp(from.min(to), from.max(to));
        let place = usize::try_from(wanted.abs_diff(from)).ok().filter(|place| *place <= last)?;
        let help = match last {
            0 => format!("the only replica is {}", quoted(replica(0))),
            _ => format!("the replicas are {} to {}", quoted(replica(0)), quoted(replica(last))),
        };
        return Some((replica(place), help));
    }
    None
}
