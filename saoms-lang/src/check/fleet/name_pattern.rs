//! Names with `*` for unknown parts.

/// True if a name is like a pattern, in which `*` stands for anything.
pub(crate) fn is_like(name: &str, pattern: &str) -> bool {
    let (Some((first, rest)), mut left) = (pattern.split_once('*'), name) else { return name == pattern };
    let Some(behind) = left.strip_prefix(first) else { return false };
    left = behind;
    let mut parts = rest.split('*').peekable();
    while let Some(part) = parts.next() {
        if parts.peek().is_none() {
            return left.ends_with(part);
        }
        let Some(place) = left.find(part) else { return false };
        left = &left[place + part.len()..];
    }
    true
}
