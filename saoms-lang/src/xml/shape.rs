//! Shapes: how start tags are written, but for their values.
//!
//! Even a large file has few of them. So a tag is not read name by name where one is expected that was read before: its bytes are compared with
//! those of the first of its shape, from value to value, and all that was found of that one, names and namespaces included, holds for it too.

use std::collections::HashMap;
use std::hash::RandomState;
use std::hash::{BuildHasher, Hasher};

use super::eight::{first_of, same};
use super::fault::Input;
use super::tag::{RawAttribute, StartTag};
use super::tree::{NONE, XMLNS};
use crate::source::Span;

/// A start tag without its values.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    /// Bytes of the name, its prefix included.
    pub(super) name_len: u32,
    pub(super) namespace: u32,
    /// The first of its attributes among [`Shapes::parts`].
    parts: u32,
    /// How many attributes there are, declarations of namespaces included.
    count: u32,
    /// What stands behind the last value, in the first tag of this shape.
    tail: Span,
    /// The declarations of namespaces that were in scope where it was met last; others may give its prefixes another meaning.
    scope: u32,
    /// The shape of the tag that came behind the last of this shape.
    next: u32,
    /// Whether the name has a prefix.
    pub(super) has_prefix: bool,
    /// `<a/>`
    pub(super) is_empty: bool,
    /// Whether it declares namespaces: such a tag is always read.
    pub(super) declares: bool,
}

/// An attribute of a shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// From behind the value before, or the `<`, to behind the opening quote, in the first tag of the shape.
    before: Span,
    /// How far before the value the name starts.
    pub(super) name_back: u32,
    pub(super) name_len: u32,
    pub(super) namespace: u32,
}

/// The shapes of a document; each is told by its number.
#[derive(Debug, Default)]
pub(super) struct Shapes {
    all: Vec<Shape>,
    parts: Vec<Part>,
}

impl Shapes {
    pub(super) fn get(&self, shape: u32) -> &Shape {
        &self.all[shape as usize]
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.all.len()
    }

    /// The attributes in order.
    pub(super) fn parts(&self, shape: u32) -> &[Part] {
        let Shape { parts, count, .. } = *self.get(shape);
        &self.parts[parts as usize..(parts + count) as usize]
    }
}

/// How many groups of shapes are kept at hand by what their tags begin with.
const GROUPS: usize = 64;
/// How many shapes are in each: elements of one name have other attributes now and then.
const GROUP: usize = 6;

/// Finds the shapes of tags.
#[derive(Debug)]
pub(super) struct Known {
    pub(super) shapes: Shapes,
    /// The shape of the tag before.
    last: u32,
    /// By the first bytes of tags, the last shapes that began so, the latest first.
    at_hand: Box<[[u32; GROUP]; GROUPS]>,
    /// By a hash of all that makes a shape.
    numbers: HashMap<u64, u32>,
    hasher: RandomState,
    /// The attributes of the tag that is read.
    parts: Vec<Part>,
}

impl Known {
    pub(super) fn new() -> Self {
        Self {
            shapes: Shapes::default(),
            last: NONE,
            at_hand: Box::new([[NONE; GROUP]; GROUPS]),
            numbers: HashMap::default(),
            hasher: RandomState::default(),
            parts: Vec::new(),
        }
    }

    /// The shape of the tag whose `<` is at `start`, and where the tag ends, when it is like one that was met in this scope; its values are
    /// appended to `values` then.
    #[inline]
    pub(super) fn find(
        &mut self,
        input: Input<'_>,
        start: u32,
        scope: u32,
        values: &mut Vec<Span>,
    ) -> Option<(u32, u32)> {
        let expected = self.shapes.all.get(self.last as usize).map_or(NONE, |last| last.next);
        let mut found = self.shapes.matched(expected, input, start, scope, values).map(|end| (expected, end));
        if found.is_none() {
            let group = &mut self.at_hand[group(input, start)];
            for place in 0..GROUP {
                let other = group[place];
                if other == NONE {
                    break;
                }
                if other != expected
                    && let Some(end) = self.shapes.matched(other, input, start, scope, values)
                {
                    found = Some((other, end));
                    group[..=place].rotate_right(1);
                    self.follow(other);
                    break;
                }
            }
        }
        if let Some((shape, _)) = found {
            self.last = shape;
        }
        found
    }

    /// Remembers which shape came behind the one before.
    fn follow(&mut self, shape: u32) {
        if let Some(last) = self.shapes.all.get_mut(self.last as usize) {
            last.next = shape;
        }
    }

    /// The shape of a tag that was read, a new one if there is none like it.
    pub(super) fn take(
        &mut self,
        input: Input<'_>,
        start: u32,
        tag: &StartTag,
        namespace: u32,
        attributes: &[RawAttribute],
        scope: u32,
    ) -> u32 {
        let mut parts = std::mem::take(&mut self.parts);
        parts.clear();
        let mut at = start;
        for one in attributes {
            let before = Span::new(at, one.value.start);
            at = one.value.end;
            let name_back = one.value.start - one.start;
            parts.push(Part { before, name_back, name_len: one.name_len, namespace: one.namespace });
        }
        let name = input.slice(start + 1, start + 1 + tag.name_len);
        let made = Shape {
            name_len: tag.name_len,
            namespace,
            parts: self.shapes.parts.len() as u32,
            count: parts.len() as u32,
            tail: Span::new(at, tag.end),
            scope,
            next: NONE,
            has_prefix: !tag.is_plain && name.contains(':'),
            is_empty: tag.is_empty,
            declares: attributes.iter().any(|one| one.namespace == XMLNS),
        };
        let hash = self.hash(input, &made, &parts);
        let shape = match self.numbers.get(&hash) {
            Some(&number) if self.shapes.is_same(number, input, &made, &parts) => number,
            _ => {
                let number = self.shapes.all.len() as u32;
                self.shapes.parts.append(&mut parts);
                self.shapes.all.push(made);
                self.numbers.insert(hash, number);
                number
            }
        };
        self.shapes.all[shape as usize].scope = scope;
        self.follow(shape);
        self.last = shape;
        self.parts = parts;
        let group = &mut self.at_hand[group(input, start)];
        let place = group.iter().position(|known| *known == shape).unwrap_or(GROUP - 1);
        group[..=place].rotate_right(1);
        group[0] = shape;
        shape
    }

    fn hash(&self, input: Input<'_>, shape: &Shape, parts: &[Part]) -> u64 {
        let mut hasher = self.hasher.build_hasher();
        hasher.write_u32(shape.namespace);
        let mut write = |span: Span, namespace: u32| {
            hasher.write(input.slice(span.start, span.end).as_bytes());
            hasher.write_u32(namespace);
        };
        parts.iter().for_each(|part| write(part.before, part.namespace));
        write(shape.tail, 0);
        hasher.finish()
    }
}

impl Shapes {
    /// Where the tag ends whose `<` is at `start`, when it is of this shape.
    fn matched(
        &self,
        shape: u32,
        input: Input<'_>,
        start: u32,
        scope: u32,
        values: &mut Vec<Span>,
    ) -> Option<u32> {
        let shape = self.all.get(shape as usize)?;
        if shape.scope != scope || shape.declares {
            return None;
        }
        let bytes = input.bytes();
        let first = values.len();
        let mut at = start as usize;
        for part in &self.parts[shape.parts as usize..(shape.parts + shape.count) as usize] {
            let value = behind(bytes, at, part.before);
            let end = value.and_then(|value| plain_value_end(bytes, value));
            let (Some(value), Some(end)) = (value, end) else {
                values.truncate(first);
                return None;
            };
            values.push(Span::new(value as u32, end as u32));
            at = end;
        }
        let end = behind(bytes, at, shape.tail);
        if end.is_none() {
            values.truncate(first);
        }
        end.map(|end| end as u32)
    }

    fn is_same(&self, number: u32, input: Input<'_>, other: &Shape, parts: &[Part]) -> bool {
        let one = self.get(number);
        let same =
            |one: Span, other: Span| input.slice(one.start, one.end) == input.slice(other.start, other.end);
        let mine = self.parts(number);
        one.namespace == other.namespace
            && mine.len() == parts.len()
            && same(one.tail, other.tail)
            && mine
                .iter()
                .zip(parts)
                .all(|(one, other)| one.namespace == other.namespace && same(one.before, other.before))
    }
}

/// Behind the bytes at `at`, when they are those of `like`.
fn behind(bytes: &[u8], at: usize, like: Span) -> Option<usize> {
    let like = &bytes[like.start as usize..like.end as usize];
    let end = at + like.len();
    same(bytes.get(at..end)?, like).then_some(end)
}

/// Where a value ends that starts at `start`, behind its quote, when nothing in it has to be looked at more closely.
fn plain_value_end(bytes: &[u8], start: usize) -> Option<usize> {
    let quote = bytes[start - 1];
    let end = start + first_of(&bytes[start..], [quote, b'<', b'&'])?;
    (bytes[end] == quote).then_some(end)
}

/// The group of the shapes that begin like the tag at `start`.
fn group(input: Input<'_>, start: u32) -> usize {
    let begin = input.bytes()[start as usize..].first_chunk::<9>();
    let [_, first @ ..] = begin.copied().unwrap_or_default();
    // Fibonacci hashing (Knuth, The Art of Computer Programming, 6.4).
    (u64::from_le_bytes(first).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 58) as usize
}
