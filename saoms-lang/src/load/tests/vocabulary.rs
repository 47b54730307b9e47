//! The tables beside what the loader does.

use super::super::vocabulary::{self, COMPOSITE, Kind, children};
use super::*;

/// The elements of kinds that can stand in `kind`, at any depth, each with those around it.
fn all(kind: &'static Kind, around: &[&'static Kind], found: &mut Vec<Vec<&'static Kind>>) {
    let path = [around, &[kind]].concat();
    for name in children(kind) {
        match kind.child(name) {
            Some(inner) => all(inner, &path, found),
            None => assert!(vocabulary::other(name).is_some(), "nobody says what `{name}` is for"),
        }
    }
    found.push(path);
}

/// Each element inside the ones around it, with all attributes that these need but one of the last.
fn lacking(path: &[&'static Kind], lacks: &str) -> String {
    path.iter().enumerate().rev().fold(String::new(), |inside, (depth, kind)| {
        let attributes = kind.attributes.iter().filter(|known| known.required);
        let attributes = attributes.filter(|known| depth + 1 < path.len() || known.name != lacks);
        let attributes: String = attributes.map(|known| format!(" {}='x'", known.name)).collect();
        let more = if depth == 0 { format!(" xmlns='{OSOA}' targetNamespace='u'") } else { String::new() };
        format!("<{0}{more}{attributes}>{inside}</{0}>", kind.name)
    })
}

#[test]
fn what_the_tables_call_required_is_required() {
    let mut found = Vec::new();
    all(&COMPOSITE, &[], &mut found);
    assert!(found.len() > 30, "{}", found.len());
    for path in found {
        let kind = path[path.len() - 1];
        for known in kind.attributes {
            let text = lacking(&path, if known.required { known.name } else { "" });
            let needs = format!("`{}` needs the attribute `{}`", kind.name, known.name);
            assert_eq!(loaded(&text).1.contains(&needs), known.required, "{needs}: {text}\n{}", loaded(&text).1);
        }
    }
}
