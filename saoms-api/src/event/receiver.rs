use super::Word;
use crate::extension::LineFault;
use crate::rule::nearest;

/// The place of the one component, among the paths of those that take an event, that `to` names: by its path, or by the
/// end of it.
///
/// ```
/// use saoms_api::event::{EventCall, receiver};
///
/// let call = EventCall::read("fire to Hall1").unwrap();
/// let to = call.to.as_ref().unwrap();
/// assert_eq!(receiver(&["north/Hall1", "north/Hall2"], to, "fire"), Ok(0));
/// let fault = receiver(&["north/Hall1", "south/Hall1"], to, "fire").unwrap_err();
/// assert_eq!(fault.message, "several components are called `Hall1`: `north/Hall1`, `south/Hall1`");
/// ```
///
/// # Errors
/// None of them is called so, or several are.
pub fn receiver(paths: &[&str], to: &Word, event: &str) -> Result<usize, LineFault> {
    let name = to.text.as_str();
    if let Some(place) = paths.iter().position(|path| *path == name) {
        return Ok(place);
    }
    let is_end = |path: &str| path.strip_suffix(name).is_some_and(|rest| rest.ends_with('/'));
    let mut named = (0..paths.len()).filter(|place| is_end(paths[*place]));
    match (named.next(), named.next()) {
        (Some(place), None) => return Ok(place),
        (Some(one), Some(other)) => {
            let message = format!("several components are called `{name}`: `{}`, `{}`", paths[one], paths[other]);
            return Err(LineFault::new(to.bytes.clone(), message).help("write the path of one of them"));
        }
        (None, _) => {}
    }
    let fault = LineFault::new(to.bytes.clone(), format!("no component `{name}` takes the event `{event}`"));
    let ends = paths.iter().filter_map(|path| path.rsplit('/').next());
    Err(match nearest(name, paths.iter().copied().chain(ends)) {
        Some(meant) => fault.instead(meant),
        None => match paths.first() {
            Some(first) => fault.help(format!("remove `to`, or name a component that takes it, such as `{first}`")),
            None => fault,
        },
    })
}
