//! The name that was probably meant.

/// Names longer than this are not compared: the distance costs the product of the lengths.
const LONGEST: usize = 128;

/// The candidate that is most like `name`, if one is like enough: the same but for case, or a few typing errors away
/// (one for each three characters of the name, at least one).
///
/// ```
/// use saoms_api::nearest;
///
/// assert_eq!(nearest("peroid", ["delay", "period"]), Some("period"));
/// assert_eq!(nearest("PERIOD", ["periods", "period"]), Some("period"));
/// assert_eq!(nearest("colour", ["delay", "period"]), None);
/// ```
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    nearest_few(name, candidates, 1).first().copied()
}

/// Up to `limit` candidates that are like `name`, the most alike first; see [`nearest`].
pub fn nearest_few<'a>(
    name: &str,
    candidates: impl IntoIterator<Item = &'a str>,
    limit: usize,
) -> Vec<&'a str> {
    let wanted = Folded::new(name);
    let mut found: Vec<(usize, &str)> = Vec::new();
    for candidate in candidates {
        if let Some(distance) = wanted.distance(candidate)
            && !found.iter().any(|(_, known)| *known == candidate)
        {
            found.push((distance, candidate));
        }
    }
    found.sort_by_key(|(distance, _)| *distance);
    found.truncate(limit);
    found.into_iter().map(|(_, candidate)| candidate).collect()
}

/// A name without case, with what quickly rules out most candidates.
struct Folded {
    characters: Vec<char>,
    set: u64,
    cut: usize,
}

impl Folded {
    fn new(name: &str) -> Self {
        let characters: Vec<char> = name.chars().take(LONGEST + 1).flat_map(char::to_lowercase).collect();
        Self { set: letters(name), cut: (characters.len() / 3).max(1), characters }
    }

    /// How many typing errors lie between; 0 is the same but for case. `None` when it is too far.
    fn distance(&self, other: &str) -> Option<usize> {
        let len = self.characters.len();
        // Every error changes at most two letters of the set, and the length by one (four bytes at most).
        if len > LONGEST || other.len() > 4 * (len + self.cut) || len > other.len() + self.cut {
            return None;
        }
        if (self.set ^ letters(other)).count_ones() as usize > 2 * self.cut {
            return None;
        }
        let other: Vec<char> = other.chars().flat_map(char::to_lowercase).collect();
        if other.len().abs_diff(len) > self.cut {
            return None;
        }
        let distance = typing_errors(&self.characters, &other);
        // As many errors as letters would make any short name like any other.
        (distance <= self.cut && distance < len.max(other.len())).then_some(distance)
    }
}

/// Which letters occur, without case; other characters share bits.
fn letters(name: &str) -> u64 {
    name.chars().flat_map(char::to_lowercase).fold(0, |set, letter| set | 1 << (letter as u32 % 64))
}

/// The optimal string alignment distance: insertions, deletions, replacements and swaps of neighbours.
fn typing_errors(a: &[char], b: &[char]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let replaced = last[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            row[j] = replaced.min(last[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before[j - 2] + 1);
            }
        }
        before = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}
