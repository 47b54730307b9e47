//! Symbols: the meaning of a name in a composite, and every place with the same meaning.

use std::collections::BTreeSet;
use std::ops::Range;

use super::Scene;
use super::occurrences::Found;
use super::outline::Side;

/// The most digits of the number of a replica, zeros in front included.
const MOST_DIGITS: usize = 64;

/// A range of bytes of a file of a scene.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FileRange {
    /// The place of the file among those of the scene.
    pub file: usize,
    /// The first byte.
    pub start: usize,
    /// The byte behind the last one.
    pub end: usize,
}

impl FileRange {
    pub(crate) fn new(file: usize, at: &Range<usize>) -> Self {
        Self { file, start: at.start, end: at.end }
    }

    /// The bytes.
    pub fn range(&self) -> Range<usize> {
        self.start..self.end
    }
}

/// A symbol. The file is the one that defines it; where none does, the one that names it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Symbol {
    /// A component.
    Component { file: usize, name: String },
    /// A property of a composite.
    Parameter { file: usize, name: String },
    /// A service or a reference of a composite.
    Promoted { file: usize, side: Side, name: String },
    /// A service or a reference of a component of a class.
    Part { file: usize, component: String, side: Side, name: String },
    /// The composite in a file.
    Composite { file: usize },
    /// A loop of a component.
    Loop { file: usize, component: String, name: String },
    /// A class of components or of loops.
    Class { name: String },
    /// A topic of the fleet.
    Topic { name: String },
    /// The name of the number of a replica.
    Index { file: usize, component: String },
}

/// A place that names something.
#[derive(Clone, Debug)]
pub(crate) struct Occurrence {
    pub(crate) symbol: Symbol,
    pub(crate) at: FileRange,
    pub(crate) is_definition: bool,
    /// True if it is a name in an expression.
    pub(crate) is_in_expression: bool,
}

/// The symbol whose name a byte of the first file touches, and where the name is.
pub(crate) fn at(scene: &Scene, at: usize) -> Option<Occurrence> {
    if scene.file().is_beside {
        // What its names mean, composites say.
        let all = scene.owners().iter().flat_map(|file| Found::of(scene, *file, None));
        return all.into_iter().find(|one| one.at.file == 0 && one.at.start <= at && at <= one.at.end);
    }
    Found::of(scene, 0, Some(at)).into_iter().next()
}

/// Every place where a symbol is named, those that define it first.
pub(crate) fn places(scene: &Scene, symbol: &Symbol) -> Vec<Occurrence> {
    let mut found: Vec<Occurrence> = match symbol {
        Symbol::Topic { name } => scene.places_of_topic(name),
        _ => {
            let all = (0..scene.files.len()).flat_map(|file| Found::of(scene, file, None));
            all.filter(|one| one.symbol == *symbol).collect()
        }
    };
    found.sort_by_key(|one| (!one.is_definition, one.at.clone()));
    found.dedup_by(|one, other| one.at == other.at);
    found
}

impl Scene {
    /// The file and the name under which a component is written that a file names: that of its replicas, where it is
    /// one of them.
    pub(crate) fn named(&self, file: usize, name: &str) -> (usize, String) {
        if let Some((of, _)) = self.component(file, name) {
            return (of, name.to_owned());
        }
        let of_replicas = self.pattern(file, name);
        of_replicas.map_or_else(|| (file, name.to_owned()), |(of, one)| (of, one.name.text.clone()))
    }

    /// The property of a composite that a file is part of.
    pub(crate) fn parameter(&self, file: usize, name: &str) -> Symbol {
        let file = self.declaring(file, name).unwrap_or(file);
        Symbol::Parameter { file, name: name.to_owned() }
    }

    /// The symbol of a part of a component: for a composite inside, the part that it promotes.
    pub(crate) fn part(&self, file: usize, component: &str, side: Side, name: &str) -> Symbol {
        let inside = self.component(file, component).map(|(of, known)| self.inside(of, known));
        let Some(inside) = inside.filter(|inside| !inside.is_empty()) else {
            return Symbol::Part { file, component: component.to_owned(), side, name: name.to_owned() };
        };
        let has = |of: &&usize| self.files[**of].names().promoted(side, name).is_some();
        let file = inside.iter().find(has).copied().unwrap_or(inside[0]);
        Symbol::Promoted { file, side, name: name.to_owned() }
    }
}

/// True if a name with expressions, as `Robot${index:03}`, can produce this name; also for `Robot*`, which means all of
/// them, and for a name with another expression.
pub(crate) fn is_replica(pattern: &str, name: &str) -> bool {
    match pieces(pattern).split_first() {
        Some((first, rest)) if !rest.is_empty() => {
            let group = group(pattern);
            group.as_deref() == Some(name)
                || (name.contains("${") && self::group(name) == group)
                || name.strip_prefix(first).is_some_and(|name| has_numbers(name, rest))
        }
        _ => false,
    }
}

/// The pattern of a name with expressions: `*` in their places. `None` for a name without expressions.
pub(crate) fn group(pattern: &str) -> Option<String> {
    let pieces = pieces(pattern);
    (pieces.len() > 1).then(|| pieces.join("*"))
}

/// The texts around the expressions of a name.
pub(super) fn pieces(pattern: &str) -> Vec<&str> {
    let (mut all, mut rest) = (Vec::new(), pattern);
    while let Some((before, (_, after))) =
        rest.split_once("${").and_then(|(before, inside)| Some((before, inside.split_once('}')?)))
    {
        all.push(before);
        rest = after;
    }
    all.push(rest);
    all
}

/// True if a name is a number before each of these pieces, and nothing else.
fn has_numbers(name: &str, pieces: &[&str]) -> bool {
    // The bytes behind which the pieces so far can end: one may begin with digits, too.
    let mut ends = BTreeSet::from([0]);
    for piece in pieces {
        let numbers = ends.iter().flat_map(|&from| {
            let digits = name[from..].bytes().take_while(u8::is_ascii_digit).take(MOST_DIGITS).count();
            from + 1..=from + digits
        });
        let numbers: BTreeSet<usize> = numbers.collect();
        let behind = numbers.into_iter().filter(|end| name[*end..].starts_with(piece)).map(|end| end + piece.len());
        ends = behind.collect();
    }
    ends.contains(&name.len())
}
