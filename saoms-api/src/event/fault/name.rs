/// True if a path is named: by all of it or by its end, with `*` for any letters.
///
/// ```
/// use saoms_api::event::fault::is_named;
///
/// assert!(is_named("Robot*", "hall/Robot2") && is_named("hall/*", "hall/Robot2"));
/// assert!(!is_named("Robot", "hall/Robot2") && !is_named("bot2", "hall/Robot2"));
/// ```
pub fn is_named(pattern: &str, path: &str) -> bool {
    let ends = path.match_indices('/').map(|(at, _)| at + 1);
    std::iter::once(0).chain(ends).any(|start| fits(pattern.as_bytes(), &path.as_bytes()[start..]))
}

/// Begins the name of a node.
pub const NODE_SIGN: char = '@';

/// True if a component is named: by its path, as [`is_named`] says, or by its node behind `@`.
///
/// ```
/// use saoms_api::event::fault::names_component;
///
/// assert!(names_component("Robot*", "hall/Robot2", "floor") && names_component("@floor", "hall/Robot2", "floor"));
/// assert!(!names_component("@floor", "floor", "traffic") && !names_component("@*", "Robot2", ""));
/// ```
pub fn names_component(pattern: &str, path: &str, node: &str) -> bool {
    match pattern.strip_prefix(NODE_SIGN) {
        Some(pattern) => !node.is_empty() && fits(pattern.as_bytes(), node.as_bytes()),
        None => is_named(pattern, path),
    }
}

/// In linear memory and without recursion: a star that fits takes one letter more each time the rest does not.
fn fits(pattern: &[u8], text: &[u8]) -> bool {
    let (mut at, mut letter, mut star) = (0, 0, None);
    while letter < text.len() {
        match pattern.get(at) {
            Some(b'*') => {
                star = Some((at, letter));
                at += 1;
            }
            Some(byte) if *byte == text[letter] => (at, letter) = (at + 1, letter + 1),
            _ => {
                let Some((place, taken)) = star else { return false };
                star = Some((place, taken + 1));
                (at, letter) = (place + 1, taken + 1);
            }
        }
    }
    pattern[at..].iter().all(|byte| *byte == b'*')
}
