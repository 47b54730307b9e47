//! The names of classes that an unknown one was probably meant to be.

use saoms_api::host::{nearest_equal, nearest_few};
use saoms_api::rule::nearest;

/// The number of names that are offered.
const OFFERED: usize = 3;
/// A part of a name is looked for in others if it has at least so many letters.
const TELLING: usize = 4;

/// Up to three of the names, the likeliest first: what is the same but for case; what ends alike behind the last dot;
/// what is spelt alike, with its package or without; what begins or ends with it. Among equals those come first that
/// say what a class is called rather than what else it is called, and the shorter ones.
pub(super) fn near<'n>(name: &str, names: impl Iterator<Item = (&'n str, bool)>) -> Vec<&'n str> {
    // As the compiled file, or the file of the source, is called.
    let name = [".class", ".java", ".rs"].into_iter().find_map(|end| name.strip_suffix(end)).unwrap_or(name);
    let last = simple(name);
    let stem = last.trim_end_matches(|sign: char| sign.is_ascii_digit());
    if last.is_empty() {
        return Vec::new();
    }
    // What differs in its number alone is not meant, but another one of them.
    let number = |name: &str| {
        let digits = name.strip_prefix(stem).filter(|digits| digits.starts_with(|sign: char| sign.is_ascii_digit()))?;
        digits.parse::<u64>().ok()
    };
    let own = number(last);
    let is_other = |known: &str| own.is_some() && number(known).is_some_and(|known| Some(known) != own);
    let mut names: Vec<(&str, bool)> = names.filter(|(known, _)| !is_other(simple(known))).collect();
    names.sort_by_key(|(name, is_alias)| (*is_alias, name.split('.').count(), name.len()));
    let names = || names.iter().map(|(name, _)| *name);
    if let Some(same) = names().find(|known| known.eq_ignore_ascii_case(name)) {
        return vec![same];
    }
    let ending = names().filter(|known| simple(known).eq_ignore_ascii_case(last));
    let first = nearest_few(name, ending.clone(), OFFERED).into_iter();
    let mut all: Vec<&str> = first.collect();
    all.extend(ending);
    if all.is_empty() {
        // One that is nearer than all others is meant.
        let alike = nearest_equal(name, names());
        all = if alike.is_empty() { nearest_few(name, names(), OFFERED) } else { alike };
        // A package that names share makes all of them alike: of those in one what follows it counts.
        let package = name.strip_suffix(last).unwrap_or_default();
        let is_like = |known: &&str| {
            known.strip_prefix(package).is_none_or(|simple| package.is_empty() || nearest(last, [simple]).is_some())
        };
        all.retain(is_like);
    }
    if all.is_empty() {
        let spelt = nearest_few(last, names().map(simple), OFFERED).into_iter();
        all = spelt.flat_map(|spelt| names().filter(move |known| simple(known) == spelt)).collect();
    }
    if all.is_empty() {
        // The same words in another order, as `EnvironmentMaster`.
        let own = words(last);
        all = names().filter(|known| own.len() > 1 && words(simple(known)) == own).collect();
    }
    if all.is_empty() && stem.len() >= TELLING {
        let part = stem.to_lowercase();
        let has_part = |known: &&str| {
            let known = simple(known).to_lowercase();
            known.starts_with(&part) || stem == last && known.ends_with(&part)
        };
        all = names().filter(has_part).collect();
    }
    let mut kept: Vec<&str> = Vec::with_capacity(OFFERED);
    for one in all {
        if kept.len() < OFFERED && !kept.contains(&one) {
            kept.push(one);
        }
    }
    kept
}

/// The words of a name such as `MasterRobot`, sorted.
fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    for letter in name.chars() {
        match words.last_mut().filter(|_| !letter.is_uppercase()) {
            Some(word) => word.push(letter),
            None => words.push(letter.to_string()),
        }
    }
    words.sort_unstable();
    words
}

/// The class without its package: the text behind the last dot.
pub(super) fn simple(name: &str) -> &str {
    name.rsplit('.').next().unwrap_or(name)
}
