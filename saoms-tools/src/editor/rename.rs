//! Another name for a component, or for another part of a composite, everywhere.

use std::collections::{BTreeMap, BTreeSet};

use saoms_lang::expression::is_name;

use super::scene::Scene;
use super::scene::expressions::INDEX;
use super::scene::occurrences::Found;
use super::scene::symbol::{FileRange, Occurrence, Symbol, at, group, is_replica, places};

/// The name at a byte that can be changed.
///
/// # Errors
/// The reason why there is none.
pub fn prepare(scene: &Scene, byte: usize) -> Result<FileRange, String> {
    let found = at(scene, byte).ok_or("there is no name here")?;
    if let Some(why) = refusal(scene, &found.symbol) {
        return Err(why);
    }
    Ok(own(scene, &found))
}

/// The edits that give the thing that is named at a byte another name.
///
/// # Errors
/// The reason why it cannot have that name.
pub fn rename(scene: &Scene, byte: usize, name: &str) -> Result<Vec<(FileRange, String)>, String> {
    let found = at(scene, byte).ok_or("there is no name here")?;
    if let Some(why) = refusal(scene, &found.symbol) {
        return Err(why);
    }
    if name.is_empty() || name.contains(|c: char| c.is_whitespace() || "/<>&\"'".contains(c)) {
        return Err(format!(
            "`{name}` cannot be a name: a name is not empty, and has no blanks, `/`, quotes, `<`, `>` or `&`"
        ));
    }
    if matches!(found.symbol, Symbol::Topic { .. }) && (name.contains(',') || name.contains("::")) {
        return Err(format!("`{name}` cannot be the name of a topic: `,` and `::` separate topics"));
    }
    let all = places(scene, &found.symbol);
    // Nobody defines a topic that is read alone.
    let is_named = |one: &&Occurrence| one.is_definition || matches!(one.symbol, Symbol::Topic { .. });
    let old = all.iter().find(is_named).map(|one| text(scene, &own(scene, one)).to_owned());
    let Some(old) = old else {
        return Err("this name is not defined in any file near this one".to_owned());
    };
    if matches!(found.symbol, Symbol::Component { .. }) && group(&old).is_some() && group(name).is_none() {
        return Err(format!(
            "`{old}` names replicas: the new name must contain an expression too, or all replicas would have one name"
        ));
    }
    if all.iter().any(|one| one.is_in_expression) && (!is_name(name) || name == INDEX) {
        return Err(format!(
            "`{old}` is used in expressions, where `{name}` is not a name: letters, digits and `_`, and not `{INDEX}`"
        ));
    }
    if old != name {
        taken(scene, &found.symbol, name)?;
        named_among_others(scene, &found.symbol, &old)?;
        shared(scene, &all)?;
    }
    all.iter()
        .map(|one| {
            let place = own(scene, one);
            let written = text(scene, &place);
            if written == old {
                return Ok((place, name.to_owned()));
            }
            // One of several replicas keeps its index.
            let new = replica(&old, written, name);
            let new = new.ok_or_else(|| {
                format!("`{written}` is one of the replicas `{old}`: the new name must contain the same expression")
            })?;
            Ok((place, new))
        })
        .collect()
}

/// The reason why something cannot be given another name.
fn refusal(scene: &Scene, symbol: &Symbol) -> Option<String> {
    match symbol {
        // Who else there uses it is not known here.
        Symbol::Component { file, .. }
        | Symbol::Parameter { file, .. }
        | Symbol::Promoted { file, .. }
        | Symbol::Composite { file }
            if scene.is_imported(*file) =>
        {
            let path = scene.files[*file].path.display();
            Some(format!("this name is defined in another contribution, in `{path}`"))
        }
        Symbol::Class { name } => Some(format!("the name of the class `{name}` is defined in its code")),
        Symbol::Part { name, .. } => Some(format!("`{name}` is named in the code of the component's class")),
        Symbol::Loop { file, component, name } => {
            let of = scene.component(*file, component)?;
            let is_meant = |(short, class): &(&str, &str)| short == name || class == name;
            let is_added = scene.class(of.1).is_some() && !scene.default_loops(of).iter().any(is_meant);
            (!is_added).then(|| format!("the loop `{name}` is named in the code of the component's class"))
        }
        Symbol::Topic { name } => {
            let uses = scene.uses_of_topics();
            let own = uses.iter().find(|one| one.name == name && one.at.is_none())?;
            let component = &own.component.name.text;
            Some(format!("`{name}` is the topic's name in the class of `{component}`"))
        }
        Symbol::Index { .. } => Some(format!("`{INDEX}` is the number of a replica")),
        _ => None,
    }
}

/// The part of a name that is its own: without the prefix of a namespace.
fn own(scene: &Scene, one: &Occurrence) -> FileRange {
    let prefix = match one.symbol {
        Symbol::Composite { .. } => text(scene, &one.at).rfind(':').map_or(0, |at| at + 1),
        _ => 0,
    };
    FileRange { start: one.at.start + prefix, ..one.at.clone() }
}

fn text<'s>(scene: &'s Scene, place: &FileRange) -> &'s str {
    &scene.files[place.file].text[place.start..place.end]
}

fn taken(scene: &Scene, symbol: &Symbol, name: &str) -> Result<(), String> {
    let named = |file: &usize| &scene.files[*file].outline;
    let is_taken = match symbol {
        Symbol::Component { file, .. } => {
            let is_meant = |known: &str| known == name || is_replica(known, name);
            let mut all = scene.unit_of(*file).iter().flat_map(|file| &named(file).components);
            all.any(|known| is_meant(&known.name.text))
        }
        Symbol::Parameter { file, .. } => {
            scene.unit_of(*file).iter().flat_map(|file| &named(file).properties).any(|known| known.text == name)
        }
        Symbol::Promoted { file, .. } => {
            let all = |file| named(file).services.iter().chain(&named(file).references);
            scene.unit_of(*file).iter().flat_map(all).any(|known| known.text == name)
        }
        Symbol::Composite { file } => {
            let namespace = &named(file).namespace;
            let mut others = scene.files.iter().map(|other| &other.outline);
            others.any(|other| {
                other.namespace == *namespace && other.name.as_ref().is_some_and(|known| known.text == name)
            })
        }
        Symbol::Topic { .. } => scene.uses_of_topics().iter().any(|one| one.name == name),
        Symbol::Loop { file, component, .. } => {
            let of = scene.component(*file, component).ok_or("there is no such component")?;
            let mut given = of.1.loops.iter().map(|one| &one.name.text);
            let is_meant = |(short, class): &(&str, &str)| *short == name || *class == name;
            given.any(|known| known == name) || scene.default_loops(of).iter().any(is_meant)
        }
        _ => false,
    };
    if is_taken { Err(format!("the name `{name}` is already used")) } else { Ok(()) }
}

/// Refuses where an expression names this one along with others, as `$start${index}` names `start1`.
fn named_among_others(scene: &Scene, symbol: &Symbol, old: &str) -> Result<(), String> {
    let (Symbol::Component { file, .. } | Symbol::Parameter { file, .. }) = symbol else { return Ok(()) };
    let is_component = matches!(symbol, Symbol::Component { .. });
    let written = scene.unit_of(*file).iter().flat_map(|of| {
        let outline = &scene.files[*of].outline;
        let ends = outline.ends.iter().filter(|_| is_component).map(|end| &end.component);
        ends.chain(outline.sources.iter().filter(|_| !is_component))
    });
    match written.map(|one| &one.text).find(|text| group(old).is_none() && is_replica(text, old)) {
        Some(other) => Err(format!("`{other}` names this replica together with others, and would lose it")),
        None => Ok(()),
    }
}

/// Refuses where a place names something else as well: what a composite targets stands around it, and it may be used in
/// several.
fn shared(scene: &Scene, all: &[Occurrence]) -> Result<(), String> {
    let files: BTreeSet<usize> = all.iter().map(|one| one.at.file).collect();
    for file in files {
        let ends = scene.files[file].outline.ends.iter();
        let outer: BTreeSet<FileRange> =
            ends.filter(|end| end.is_outer).map(|end| FileRange::new(file, &end.component.at)).collect();
        let here = all.iter().filter(|one| outer.contains(&one.at));
        let here: BTreeMap<&FileRange, &Symbol> = here.map(|one| (&one.at, &one.symbol)).collect();
        if here.is_empty() {
            continue;
        }
        for other in Found::of(scene, file, None) {
            if let Symbol::Component { file, name } = &other.symbol
                && here.get(&other.at).is_some_and(|meant| **meant != other.symbol)
            {
                let shown = scene.files[*file].path.file_name().unwrap_or_default().to_string_lossy();
                return Err(format!("`{}` is also the component `{name}` in `{shown}`", text(scene, &other.at)));
            }
        }
    }
    Ok(())
}

/// The name of a replica, or that of all, under another pattern. Under one with other expressions it is unknown.
fn replica(pattern: &str, written: &str, new: &str) -> Option<String> {
    if group(pattern).is_some_and(|group| group == written) {
        return group(new);
    }
    let split = |pattern: &str| -> Option<(usize, usize)> {
        let start = pattern.find("${")?;
        let end = start + pattern[start..].find('}')? + 1;
        (!pattern[end..].contains("${")).then_some((start, end))
    };
    let ((start, end), (from, to)) = (split(pattern)?, split(new)?);
    if pattern[start..end] != new[from..to] {
        return None;
    }
    let index = written.get(start..written.len().checked_sub(pattern.len() - end)?)?;
    Some(format!("{}{index}{}", &new[..from], &new[to..]))
}
