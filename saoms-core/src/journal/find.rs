use saoms_lang::diagnostic::nearest_few;

use super::ComponentName;

/// The component of a journal with this path, ID, or unambiguous ending of its path.
///
/// # Errors
/// There is none, or there are several; the text says what there is.
pub fn find<'a>(components: &'a [ComponentName], component: &str) -> Result<&'a ComponentName, String> {
    let is_id = |one: &ComponentName| one.id.as_deref() == Some(component);
    if let Some(found) = components.iter().find(|one| one.name == component) {
        return Ok(found);
    }
    let ids: Vec<&ComponentName> = components.iter().filter(|one| is_id(one)).collect();
    let found = if ids.is_empty() && !component.is_empty() {
        components.iter().filter(|one| one.name.ends_with(component)).collect()
    } else {
        ids
    };
    match found[..] {
        [one] => Ok(one),
        [] => Err(unknown(components, component)),
        ref several => {
            let names: Vec<String> = several.iter().map(|one| format!("`{}`", one.name)).collect();
            Err(format!("`{component}` is ambiguous: it can be {}; write more of its path", names.join(", ")))
        }
    }
}

fn unknown(components: &[ComponentName], component: &str) -> String {
    let names = components.iter().map(|one| one.name.as_str());
    let ids = components.iter().filter_map(|one| one.id.as_deref());
    let endings = components.iter().filter_map(|one| one.name.rsplit('/').next());
    let like = nearest_few(component, names.clone().chain(ids).chain(endings), 3);
    let quoted = |names: Vec<&str>| names.into_iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    let help = match like[..] {
        [] if components.is_empty() => "it had no components".to_owned(),
        [] if components.len() > 12 => {
            format!("its {} components begin with {}", components.len(), quoted(names.take(12).collect()))
        }
        [] => format!("its components are {}", quoted(names.collect())),
        _ => format!("did you mean {}?", quoted(like)),
    };
    format!("the fleet of this run had no component `{component}`: {help}")
}
