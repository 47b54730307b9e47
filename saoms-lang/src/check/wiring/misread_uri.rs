//! URIs that are written in another way than SCA's, and their probable meaning.

use super::offer::Side;
use super::uri::parts;
use crate::check::fleet::Fleet;
use crate::check::report::{list, replacing};
use crate::diagnostic::{Diagnostic, quoted};
use crate::expression::pattern;
use crate::source::Text;
use crate::syntax::escaped;

/// The meaning of a URI, as far as it is known, and the reason why the URI does not say it.
pub(crate) struct Misread {
    meant: Option<String>,
    help: String,
}

impl Misread {
    fn new(meant: String, help: &str) -> Self {
        Self { meant: Some(meant), help: help.to_owned() }
    }

    /// A diagnostic about the URI with what to write.
    pub(crate) fn add_to(self, one: Diagnostic, text: &Text) -> Diagnostic {
        let one = one.help(self.help);
        match self.meant {
            Some(meant) => one.suggest(replacing(text, &meant), text.location, escaped(&meant)),
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
        let help = "outside of replicas there is no index; `*` names all replicas";
        return is_known.then(|| Misread::new(group, help));
    }
    if text.contains(LISTED) {
        let named: Vec<&str> = text.split(LISTED).filter(|name| !name.is_empty()).collect();
        let is_known = |name: &&str| fleet.find(scope, parts(name).0).is_some();
        return named.iter().any(is_known).then(|| Misread::new(named.join(" "), "several stand between blanks"));
    }
    let places = text.char_indices().filter(|(_, character)| BEHIND.contains(character));
    let mut split = places.map(|(at, _)| (&text[..at], text[at..].trim_start_matches(BEHIND)));
    let (component, behind) =
        split.find(|(component, behind)| !behind.is_empty() && fleet.find(scope, component).is_some())?;
    let parts: Vec<&str> = behind.split(['/', '.']).collect();
    let promoted = fleet.find(scope, component).and_then(|member| inside(member, &parts, side, fleet));
    let plain = || {
        let help = format!("the name of a {} stands behind `/`", side.name());
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
            let all = inner.services().filter(|one| one.promote.as_deref().is_some_and(leads_there));
            all.map(|one| one.name.as_str()).collect()
        }
        Side::Reference => {
            let all = inner.references().filter(|one| one.promote().iter().any(leads_there));
            all.map(|one| one.name.as_str()).collect()
        }
    };
    let (inner_name, outer) = (quoted(first), quoted(name));
    let why = format!("{inner_name} is inside of {outer}, and reached by what the composite of {outer} promotes");
    Some(match promoted[..] {
        [only] => Misread { meant: Some(format!("{name}/{only}")), help: why },
        [] => Misread { meant: None, help: format!("{why}: of {inner_name} it promotes no {}", side.name()) },
        _ => Misread { meant: None, help: format!("{why}: {}", list(promoted)) },
    })
}
