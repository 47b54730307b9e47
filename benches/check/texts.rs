//! The composites that are checked.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use crate::common::Outcome;

const HEAD_1_1: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"Large\" targetNamespace=\"urn:large\">\n";
const NAMESPACE_1_0: &str = "http://www.osoa.org/xmlns/sca/1.0";
const END: &str = "</composite>\n";

/// A world and robots, each with a charger of its own, up to `size` bytes or `most` robots. Each is wired by a `wire`,
/// or by the target of its reference.
pub(crate) fn robots(size: usize, most: usize, with_wires: bool) -> String {
    const BYTES: usize = 350;
    let count = most.min(size / BYTES);
    let columns = (count as f64).sqrt() as usize + 1;
    let mut text = format!(
        "{HEAD_1_1} <component name=\"World\">\n  <implementation.rust class=\"saoms.World\"/>\n  <property name=\"ID\" value=\"World\"/>\n  <property name=\"period\" value=\"100ms\"/>\n  <property name=\"width\" value=\"{0}\"/>\n  <property name=\"height\" value=\"{0}\"/>\n </component>\n",
        columns * 5
    );
    let mut wires = String::new();
    for number in 1..=count {
        let (x, y) = ((number % columns) * 5, (number / columns) * 5);
        let reference = if with_wires { "" } else { "  <reference name=\"world\" target=\"World\"/>\n" };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            " <component name=\"Robot{number:06}\">\n  <implementation.rust class=\"saoms.Robot\"/>\n  <property name=\"ID\" value=\"R{number}\"/>\n  <property name=\"period\" value=\"100ms\"/>\n  <property name=\"number\" value=\"{number}\"/>\n  <property name=\"chargeX\" value=\"{x}\"/>\n  <property name=\"chargeY\" value=\"{y}\"/>\n{reference} </component>"
        );
        if with_wires {
            let _ = writeln!(wires, " <wire source=\"Robot{number:06}/world\" target=\"World\"/>");
        }
    }
    text + &wires + END
}

/// Components of unknown classes, each with a property, a service and a target.
pub(crate) fn unknown(size: usize) -> String {
    const BYTES: usize = 225;
    let count = size / BYTES;
    let mut text = HEAD_1_1.to_owned();
    for number in 0..count {
        let (class, target) = (number % 50, number * 7919 % count);
        let _ = writeln!(
            text,
            " <component name=\"Part{number:06}\">\n  <implementation.java class=\"org.example.parts.Class{class}\"/>\n  <property name=\"serial\">{number}</property>\n  <service name=\"Service{class}\"/>\n  <reference name=\"next\" target=\"Part{target:06}\"/>\n </component>"
        );
    }
    text + END
}

/// The components of the composites of SCA 1.0 in a folder, with the comments before them, repeated with different
/// names. Composites are left out if they use more than components, or prefixes, which would need the rest of their
/// files, or if they have errors of their own.
pub(crate) fn real(folder: &Path, size: usize, mut is_right: impl FnMut(&str) -> Outcome<bool>) -> Outcome<String> {
    let mut bodies = Vec::new();
    for text in texts(folder)? {
        let components = components(&text);
        let names: Vec<&str> = components.iter().filter_map(|one| name(one)).collect();
        let body = components.concat();
        let needs_more = ["source=", "file=", "implementation.composite", "value=", "${", "*"];
        let is_whole = !names.is_empty() && names.len() == components.len();
        let needs_more = needs_more.iter().any(|part| body.contains(part)) || has_prefix(&body);
        if is_whole && !needs_more && is_right(&format!("{}{body}{END}", head_1_0()))? {
            bodies.push((body.clone(), names.into_iter().map(str::to_owned).collect::<Vec<_>>()));
        }
    }
    if bodies.is_empty() {
        return Err(format!("{}: no composites of SCA 1.0 that can be used", folder.display()).into());
    }
    let mut text = head_1_0();
    for (round, (body, names)) in bodies.iter().cycle().enumerate() {
        if text.len() >= size {
            break;
        }
        let mut body = body.clone();
        for name in names {
            // As the name of a component, as a target, and as the component of a target.
            for (before, after) in [("\"", "\""), ("\"", "/"), (" ", "/"), (" ", " "), (">", "<")] {
                body = body.replace(&format!("{before}{name}{after}"), &format!("{before}{name}_{round}{after}"));
            }
        }
        text += &body;
    }
    Ok(text + END)
}

fn head_1_0() -> String {
    format!("<composite xmlns=\"{NAMESPACE_1_0}\" name=\"Large\" targetNamespace=\"urn:large\">\n")
}

/// The different texts of all composites in a folder.
fn texts(folder: &Path) -> Outcome<BTreeSet<String>> {
    let mut texts = BTreeSet::new();
    let mut folders: Vec<PathBuf> = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "composite") {
                texts.extend(
                    fs::read_to_string(path)
                        .ok()
                        .filter(|text| text.contains(&format!("<composite xmlns=\"{NAMESPACE_1_0}\""))),
                );
            }
        }
    }
    Ok(texts)
}

/// The components of a composite, as they are written, each with the white space and comments before it.
fn components(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut rest = text.split_once('>').map_or("", |(_, inside)| inside);
    while let Some(end) = rest.find("</component>") {
        let (one, behind) = rest.split_at(end + "</component>".len());
        let start = one.rfind("<component ").unwrap_or(one.len());
        // Elements before the component are left out.
        let from = one[..start].rfind("/>").map_or(0, |at| at + 2);
        found.push(one[from.max(one[..start].rfind("</").map_or(0, |at| at))..].to_owned());
        rest = behind;
    }
    found
}

fn name(component: &str) -> Option<&str> {
    let tag = &component[component.find("<component ")?..];
    tag.split_once("name=\"")?.1.split('"').next()
}

/// True if names in it have a prefix, whose namespace may be declared elsewhere.
fn has_prefix(body: &str) -> bool {
    body.split('<').skip(1).any(|tag| {
        let name = tag.trim_start_matches('/').split([' ', '>', '/', '\n', '\t']).next().unwrap_or_default();
        name.contains(':') || tag.contains("=\"xsd:") || tag.contains("xmlns")
    })
}
