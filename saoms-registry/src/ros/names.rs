//! Names as ROS 2 may have them.

use super::PACKAGE;

/// The name of a topic or service: what it may not have is a `_` in its place, and so are blanks. It has no `/` in
/// front.
///
/// ```
/// assert_eq!(saoms_registry::ros::ros_topic("Event luggage MS"), "Event_luggage_MS");
/// assert_eq!(saoms_registry::ros::ros_topic("/hall//2nd/POSTOPIC"), "hall/_2nd/POSTOPIC");
/// ```
pub fn ros_topic(name: &str) -> String {
    let parts = name.split('/').filter(|part| !part.is_empty()).map(|part| {
        let is_digit = part.starts_with(|first: char| first.is_ascii_digit());
        let letters = part.chars().map(|one| if one.is_ascii_alphanumeric() { one } else { '_' });
        is_digit.then_some('_').into_iter().chain(letters).collect::<String>()
    });
    parts.collect::<Vec<_>>().join("/")
}

/// True for a name that a package of ROS 2 may have.
pub fn is_package(name: &str) -> bool {
    name.starts_with(|first: char| first.is_ascii_lowercase())
        && name.chars().all(|one| one.is_ascii_lowercase() || one.is_ascii_digit() || one == '_')
}

/// Package and type of a name: `nav_msgs/msg/Odometry` is `nav_msgs/Odometry`.
pub(super) fn type_name(name: &str) -> String {
    let (package, own) = name.rsplit_once('/').unwrap_or((PACKAGE, name));
    let package = words(package.split('/').next().unwrap_or_default()).to_ascii_lowercase();
    let is_name = package.starts_with(|first: char| first.is_ascii_alphabetic());
    let own = camel(own);
    let own = if own.starts_with(|first: char| first.is_ascii_alphabetic()) { own } else { format!("Message{own}") };
    format!("{}/{own}", if is_name { &package } else { PACKAGE })
}

/// A name as words with single underscores between: `startX` is `start_X`.
pub(super) fn words(name: &str) -> String {
    let mut text = String::new();
    let mut before = '_';
    for letter in name.chars() {
        let letter = if letter.is_ascii_alphanumeric() { letter } else { '_' };
        if before != '_' && (letter == '_' || before.is_ascii_lowercase() && letter.is_ascii_uppercase()) {
            text.push('_');
        }
        if letter != '_' {
            text.push(letter);
        }
        before = letter;
    }
    text.trim_end_matches('_').to_owned()
}

/// A name as one word, whose parts begin with capital letters.
pub(super) fn camel(name: &str) -> String {
    let mut text = String::new();
    for part in name.split(|one: char| !one.is_ascii_alphanumeric()) {
        let mut letters = part.chars();
        text.extend(letters.next().map(|first| first.to_ascii_uppercase()));
        text.push_str(letters.as_str());
    }
    text
}
