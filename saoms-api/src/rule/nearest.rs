//! The name that was probably meant.

/// Names longer than this are not compared: the distance costs the product of the lengths.
const LONGEST: usize = 128;

/// The candidate that is most like `name`, if one is like enough: the same but for case, or a few typing errors away
/// (one for each three characters of the name, at least one).
///
/// ```
/// use saoms_api::rule::nearest;
///
/// assert_eq!(nearest("peroid", ["delay", "period"]), Some("period"));
/// assert_eq!(nearest("PERIOD", ["periods", "period"]), Some("period"));
/// assert_eq!(nearest("colour", ["delay", "period"]), None);
/// ```
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    few(name, &mut candidates.into_iter(), 1).first().copied()
}

/// The candidates that are most like `name`: one, or up to three that are equally alike. Where more are, none of them
/// is meant rather than the others; see [`nearest`].
///
/// ```
/// use saoms_api::host::nearest_equal;
///
/// assert_eq!(nearest_equal("charge", ["chargeX", "chargeY", "colour"]), ["chargeX", "chargeY"]);
/// assert!(nearest_equal("Robot9", ["Robot1", "Robot2", "Robot3", "Robot4"]).is_empty());
/// ```
pub fn nearest_equal<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    equal(name, &mut candidates.into_iter())
}

// The work is not generic: it is compiled once, and not for each kind of iterator.
fn equal<'a>(name: &str, candidates: &mut dyn Iterator<Item = &'a str>) -> Vec<&'a str> {
    const MOST: usize = 3;
    let wanted = Folded::new(name);
    let mut least = wanted.cut;
    let mut found: Vec<&str> = Vec::new();
    for candidate in candidates {
        let Some(distance) = wanted.distance(candidate, least) else { continue };
        if distance < least {
            found.clear();
            least = distance;
        }
        // One more than are wanted shows that there are too many.
        if found.len() <= MOST && !found.contains(&candidate) {
            found.push(candidate);
        }
    }
    if found.len() > MOST {
        found.clear();
    }
    found
}

/// Up to `limit` candidates that are like `name`, the most alike first; see [`nearest`].
pub fn nearest_few<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>, limit: usize) -> Vec<&'a str> {
    few(name, &mut candidates.into_iter(), limit)
}

fn few<'a>(name: &str, candidates: &mut dyn Iterator<Item = &'a str>, limit: usize) -> Vec<&'a str> {
    let wanted = Folded::new(name);
    // The most alike so far, in order; of equal ones the first stands first.
    let mut found: Vec<(usize, &str)> = Vec::new();
    for candidate in candidates {
        // Only a name that is more similar than the last of them can replace it.
        let most = match found.last() {
            Some((0, _)) if found.len() >= limit => break,
            Some((last, _)) if found.len() >= limit => last - 1,
            _ => wanted.cut,
        };
        let Some(distance) = wanted.distance(candidate, most) else { continue };
        if found.iter().any(|(_, known)| *known == candidate) {
            continue;
        }
        let place = found.partition_point(|(known, _)| *known <= distance);
        found.insert(place, (distance, candidate));
        found.truncate(limit);
    }
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

    /// Number of typing errors between two names; 0 is equal but for case, `None` is more than `most`.
    fn distance(&self, other: &str, most: usize) -> Option<usize> {
        let len = self.characters.len();
        // Every error changes at most two letters of the set, and the length by one (four bytes at most).
        if len > LONGEST || other.len() > 4 * (len + most) || len > other.len() + most {
            return None;
        }
        if (self.set ^ letters(other)).count_ones() as usize > 2 * most {
            return None;
        }
        let other: Vec<char> = other.chars().flat_map(char::to_lowercase).collect();
        if other.len().abs_diff(len) > most {
            return None;
        }
        let distance = typing_errors(&self.characters, &other, most)?;
        // As many errors as letters would make any short name like any other.
        (distance < len.max(other.len())).then_some(distance)
    }
}

/// The set of letters that occur, without case; other characters share bits.
fn letters(name: &str) -> u64 {
    let bit = |letter: u32| 1 << (letter % 64);
    if name.is_ascii() {
        return name.bytes().fold(0, |set, letter| set | bit(u32::from(letter.to_ascii_lowercase())));
    }
    name.chars().flat_map(char::to_lowercase).fold(0, |set, letter| set | bit(letter as u32))
}

/// The optimal string alignment distance (insertions, deletions, replacements and swaps of neighbours), as far as it is
/// at most `most`.
///
/// Only what lies within `most` of the diagonal can be part of it (Ukkonen, Algorithms for approximate string matching,
/// 1985).
fn typing_errors(a: &[char], b: &[char], most: usize) -> Option<usize> {
    let far = most + 1;
    let (mut before, mut row) = (vec![far; b.len() + 1], vec![far; b.len() + 1]);
    let mut last: Vec<usize> = (0..=b.len()).map(|errors| errors.min(far)).collect();
    for i in 1..=a.len() {
        let (from, to) = (i.saturating_sub(most).max(1), (i + most).min(b.len()));
        row.fill(far);
        row[0] = i.min(far);
        for j in from..=to {
            let replaced = last[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            row[j] = replaced.min(last[j] + 1).min(row[j - 1] + 1).min(far);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before[j - 2] + 1);
            }
        }
        (before, last, row) = (last, row, before);
        if last.iter().chain(&before).all(|errors| *errors == far) {
            return None;
        }
    }
    Some(last[b.len()]).filter(|errors| *errors <= most)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The distance by its definition.
    fn all_of_it(a: &[char], b: &[char]) -> usize {
        let mut rows = vec![(0..=b.len()).collect::<Vec<usize>>()];
        for i in 1..=a.len() {
            let mut row = vec![i; b.len() + 1];
            for j in 1..=b.len() {
                let replaced = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
                row[j] = replaced.min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
                if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                    row[j] = row[j].min(rows[i - 2][j - 2] + 1);
                }
            }
            rows.push(row);
        }
        rows[a.len()][b.len()]
    }

    #[test]
    fn a_distance_is_found_whole_or_not_at_all() {
        // All words of up to four letters out of three.
        let mut words: Vec<Vec<char>> = vec![Vec::new()];
        for length in 0..4 {
            let longer: Vec<Vec<char>> = words
                .iter()
                .filter(|word| word.len() == length)
                .flat_map(|word| ['a', 'b', 'c'].map(|letter| [&word[..], &[letter]].concat()))
                .collect();
            words.extend(longer);
        }
        for a in &words {
            for b in &words {
                let whole = all_of_it(a, b);
                for most in 0..5 {
                    let expected = Some(whole).filter(|errors| *errors <= most);
                    assert_eq!(typing_errors(a, b, most), expected, "{a:?} {b:?} {most}");
                }
            }
        }
    }

    #[test]
    fn of_names_that_are_equally_like_the_first_ones_are_given_each_once() {
        let names = ["robot3", "robot1", "robot1", "robots", "Robot", "robot2", "Robot"];
        assert_eq!(nearest_few("robot", names, 3), ["Robot", "robot3", "robot1"]);
        assert_eq!(nearest_few("robot", names, 1), ["Robot"]);
        assert_eq!(nearest_few("robot", names, 9), ["Robot", "robot3", "robot1", "robots", "robot2"]);
        assert_eq!(nearest_few("robot", names, 0), [""; 0]);
    }
}
