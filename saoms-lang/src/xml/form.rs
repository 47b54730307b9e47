//! Forms: how whole elements are written, but for the values of their attributes, their texts and comments.
//!
//! Most components of a large file are written as one before them, which differs in names and numbers. So such an element is not read tag by
//! tag: its bytes are compared with those of the last of its form, and the elements in it are told from the first of it (`arena.rs`).

use std::collections::HashMap;
use std::hash::RandomState;
use std::hash::{BuildHasher, Hash, Hasher};

use super::arena::{Alike, Arena, Node};
use super::eight::{blanks, first_of, same_start};
use super::fault::Input;
use super::parse::Open;
use super::shape::Shapes;
use super::tree::{ElementId, NONE};
use crate::source::Span;

/// How many elements one of a form has at most.
const MOST_NODES: usize = 256;
/// How many forms are kept of a document.
const MOST_FORMS: usize = 4096;
/// How many forms are at hand where another one stands than the one that came behind the last one before.
const AT_HAND: usize = 1024;
/// How many bytes inside an element are looked at to find what is at hand.
const MOST_OF_KEY: usize = 160;

/// An element as it is written, told by the last of the form.
#[derive(Clone, Copy, Debug)]
struct Form {
    /// Where that is.
    span: Span,
    /// How many elements it has.
    elements: u32,
    /// The first of its holes.
    hole: u32,
    holes: u32,
    /// The form that came behind the last of this one.
    next: u32,
    /// Whether all of its holes are values.
    has_values_alone: bool,
}

/// What differs from one element of a form to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hole {
    /// In the last of the form.
    pub(super) span: Span,
    pub(super) content: Content,
}

/// What stands in a hole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) enum Content {
    /// The value of an attribute.
    Value,
    /// The text of an element with nothing else in it.
    Text,
    /// A comment, without what starts and ends it.
    Comment,
}

impl Content {
    /// In the order in which what stands in them is kept.
    pub(super) const ALL: [Self; 3] = [Self::Value, Self::Text, Self::Comment];
}

/// Finds the forms of elements.
#[derive(Debug)]
pub(super) struct Forms {
    all: Vec<Form>,
    holes: Vec<Hole>,
    /// The form of the element before.
    last: u32,
    /// By some bytes at its start, the form of the last element that has them there.
    at_hand: Box<[u32; AT_HAND]>,
    /// By a hash of all that makes a form.
    numbers: HashMap<u64, u32>,
    hasher: RandomState,
    /// The holes of the element at hand.
    found: Vec<Span>,
}

impl Forms {
    pub(super) fn new() -> Self {
        Self {
            all: Vec::new(),
            holes: Vec::new(),
            last: NONE,
            at_hand: Box::new([NONE; AT_HAND]),
            numbers: HashMap::default(),
            hasher: RandomState::default(),
            found: Vec::new(),
        }
    }

    /// Reads the element whose `<` is at `start`, as a child of the root, when it is like one that was read; gives where it ends.
    #[inline]
    pub(super) fn read(&mut self, input: Input<'_>, start: u32, arena: &mut Arena) -> Option<u32> {
        let expected = self.all.get(self.last as usize)?.next;
        let mut form = expected;
        let mut found = self.matched(expected, input, start);
        if found.is_none() {
            form = self.at_hand[key(input, start)];
            found = if form == expected { None } else { self.matched(form, input, start) };
        }
        let (end, same) = found?;
        self.copy((form, same), Span::new(start, end), arena);
        self.follow(form, input, start);
        Some(end)
    }

    /// Remembers which form came behind the one before.
    fn follow(&mut self, form: u32, input: Input<'_>, start: u32) {
        if let Some(last) = self.all.get_mut(self.last as usize)
            && last.next != form
        {
            last.next = form;
            self.at_hand[key(input, start)] = form;
        }
        self.last = form;
    }

    /// Where the element ends whose `<` is at `start`, when it is of this form, and which of its values are as in the last one; what is found
    /// of it is kept.
    ///
    /// It is compared with the last one of the form up to where they differ, which is right in holes alone, and on behind that.
    fn matched(&mut self, form: u32, input: Input<'_>, start: u32) -> Option<(u32, u64)> {
        let form = self.all.get(form as usize)?;
        let bytes = input.bytes();
        let holes = &self.holes[form.hole as usize..(form.hole + form.holes) as usize];
        self.found.resize(holes.len(), Span::empty(0));
        let (mut same, mut first) = (0, 0);
        let (mut last, mut at) = (form.span.start, start);
        // Somewhat more is compared than the element, so that the last bytes of it are not compared one by one.
        let like = &bytes[..bytes.len().min(form.span.end as usize + 16)];
        loop {
            let moved = at.wrapping_sub(last);
            let length = same_start(&like[last as usize..], &bytes[at as usize..]) as u32;
            let differs = form.span.end.min(last + length);
            let mut next = first;
            while let Some(hole) = holes.get(next).filter(|hole| hole.span.end < differs) {
                let span = Span::new(hole.span.start.wrapping_add(moved), hole.span.end.wrapping_add(moved));
                self.found[next] = span;
                next += 1;
            }
            same |= up_to(next) & !up_to(first);
            if differs == form.span.end {
                return Some((
                    differs.wrapping_add(moved),
                    if form.has_values_alone { same } else { of_values(same, holes) },
                ));
            }
            let hole = holes.get(next).filter(|hole| hole.span.start <= differs)?;
            let start = hole.span.start.wrapping_add(moved);
            let bytes = &bytes[start as usize - 1..];
            let length = match hole.content {
                Content::Value => value_end(bytes)?,
                Content::Text => text_end(&bytes[1..])?,
                Content::Comment => comment_end(&bytes[1..])?,
            } as u32;
            self.found[next] = Span::new(start, start + length);
            (last, at, first) = (hole.span.end, start + length, next + 1);
        }
    }

    /// Appends the element that was found to be of a form, which is the last of it now.
    fn copy(&mut self, (form, same): (u32, u64), span: Span, arena: &mut Arena) {
        let last = &mut self.all[form as usize];
        last.span = span;
        let holes = &mut self.holes[last.hole as usize..(last.hole + last.holes) as usize];
        holes.iter_mut().zip(&self.found).for_each(|(hole, found)| hole.span = *found);
        arena.alike.push(Alike {
            element: ElementId(arena.len()),
            form,
            same,
            start: span.start,
            values: arena.values.len() as u32,
            kept: arena.kept.len() as u32,
            copied: last.elements,
        });
        arena.copied += last.elements;
        if last.has_values_alone {
            arena.values.extend_from_slice(&self.found);
        } else {
            Content::ALL.iter().for_each(|content| arena.keep(holes, *content));
        }
    }

    /// Takes an element that was read tag by tag, the last of all so far, for the last of its form; unless those like it are to be read so as
    /// well.
    pub(super) fn take(&mut self, input: Input<'_>, open: &Open, shapes: &Shapes, arena: &mut Arena) {
        let all = &arena.kept[open.kept..];
        if all.len() < 2 || all.len() > MOST_NODES || all.iter().any(|one| shapes.get(one.shape).declares) {
            return;
        }
        let span = Span::new(all[0].start, all[0].end);
        let hole = self.holes.len();
        for one in all {
            let count = shapes.parts(one.shape).len();
            let values = &arena.values[one.values as usize..one.values as usize + count];
            self.holes.extend(values.iter().map(|span| Hole { span: *span, content: Content::Value }));
            self.holes.extend(text(input, one).map(|span| Hole { span, content: Content::Text }));
        }
        if add_comments(input, span, &mut self.holes) {
            self.holes[hole..].sort_unstable_by_key(|hole| hole.span.start);
        }
        let holes = &self.holes[hole..];
        let made = Form {
            span,
            elements: all.len() as u32,
            hole: hole as u32,
            holes: holes.len() as u32,
            next: NONE,
            has_values_alone: holes.iter().all(|hole| hole.content == Content::Value),
        };
        let is_small = holes.len() < usize::from(u16::MAX);
        let hash = self.hash(input, &made);
        let known = self.numbers.get(&hash).copied().filter(|form| self.is_same(*form, input, &made));
        let form = match known {
            None if is_small && self.all.len() < MOST_FORMS => {
                let form = self.all.len() as u32;
                arena.add_model(open, &self.holes[hole..]);
                self.all.push(made);
                self.numbers.insert(hash, form);
                form
            }
            None => {
                self.holes.truncate(hole);
                return;
            }
            Some(number) => {
                // It is the last of the form now.
                let form = &mut self.all[number as usize];
                self.holes.copy_within(hole.., form.hole as usize);
                form.span = made.span;
                self.holes.truncate(hole);
                number
            }
        };
        let Form { hole, holes, .. } = self.all[form as usize];
        let holes = &self.holes[hole as usize..(hole + holes) as usize];
        Content::ALL[1..].iter().for_each(|content| arena.keep(holes, *content));
        self.follow(form, input, span.start);
        arena.alike.push(Alike {
            element: ElementId(open.element),
            form,
            same: 0,
            start: span.start,
            values: arena.kept[open.kept].values,
            kept: open.kept as u32,
            copied: 0,
        });
    }

    /// What stands around the holes of a form, in its first, each with what is in the hole behind it.
    fn around<'a>(&self, input: Input<'a>, form: &Form) -> impl Iterator<Item = (&'a [u8], Content)> {
        let holes = &self.holes[form.hole as usize..(form.hole + form.holes) as usize];
        let ends = holes.iter().map(|hole| (hole.span.start, hole.content));
        let ends = ends.chain([(form.span.end, Content::Value)]);
        let starts = std::iter::once(form.span.start).chain(holes.iter().map(|hole| hole.span.end));
        starts
            .zip(ends)
            .map(move |(start, (end, content))| (&input.bytes()[start as usize..end as usize], content))
    }

    fn hash(&self, input: Input<'_>, form: &Form) -> u64 {
        let mut hasher = self.hasher.build_hasher();
        for (bytes, content) in self.around(input, form) {
            hasher.write(bytes);
            content.hash(&mut hasher);
        }
        hasher.finish()
    }

    fn is_same(&self, form: u32, input: Input<'_>, other: &Form) -> bool {
        let form = &self.all[form as usize];
        form.holes == other.holes && self.around(input, form).eq(self.around(input, other))
    }
}

/// The text of an element with nothing else in it, from its first character that is no white space on; `None` where it has references.
fn text(input: Input<'_>, node: &Node) -> Option<Span> {
    if !node.has_text {
        return None;
    }
    let start = node.tag_end as usize;
    let content = &input.bytes()[start..node.end as usize];
    let start = start + blanks(content);
    let end = start + text_end(&input.bytes()[start..])?;
    // The first tag behind the text is that which ends the element.
    let closes = memchr::memchr(b'>', &input.bytes()[end..node.end as usize])?;
    let is_end = end + closes + 1 == node.end as usize && input.bytes().get(end + 1) == Some(&b'/');
    is_end.then(|| Span::new(start as u32, end as u32))
}

/// Adds the comments in an element; says whether there are any. With instructions or CDATA in it, which can hold what looks like some, it has to
/// be written as another one everywhere but in values and texts.
fn add_comments(input: Input<'_>, span: Span, holes: &mut Vec<Hole>) -> bool {
    let bytes = &input.bytes()[..span.end as usize];
    let mut markup = memchr::memmem::find_iter(&bytes[span.start as usize..], b"<!").peekable();
    if markup.peek().is_none() || memchr::memmem::find(&bytes[span.start as usize..], b"<?").is_some() {
        return false;
    }
    let count = holes.len();
    let mut end = 0;
    for start in markup.map(|at| span.start as usize + at).collect::<Vec<_>>() {
        if start < end {
            // `<!` in a comment.
            continue;
        }
        let inside =
            bytes[start..].strip_prefix(b"<!--").and_then(|rest| Some((start + 4, comment_end(rest)?)));
        let Some((start, length)) = inside else {
            holes.truncate(count);
            return false;
        };
        end = start + length;
        holes.push(Hole { span: Span::new(start as u32, end as u32), content: Content::Comment });
    }
    true
}

/// A bit for each of the first 64 that come before the one at this place.
fn up_to(place: usize) -> u64 {
    1_u64.checked_shl(place as u32).map_or(u64::MAX, |bit| bit - 1)
}

/// The bits of the values among those of holes.
fn of_values(same: u64, holes: &[Hole]) -> u64 {
    let values = holes.iter().enumerate().take(64).filter(|(_, hole)| hole.content == Content::Value);
    values.enumerate().fold(0, |all, (value, (hole, _))| all | (same >> hole & 1) << value)
}

/// A place among the forms at hand for what stands at `start`: found by its name, and by what is behind its start tag, where components
/// name their implementation.
fn key(input: Input<'_>, start: u32) -> usize {
    let rest = &input.bytes()[start as usize..];
    let end_of = |tag: &[u8]| memchr::memchr(b'>', tag).map_or(tag.len(), |end| end + 1);
    let (outer, inside) = rest.split_at(end_of(rest));
    let inside = &inside[..inside.len().min(end_of(inside) + 24).min(MOST_OF_KEY)];
    let words = outer.as_chunks::<8>().0.iter().take(1).chain(inside.as_chunks::<8>().0);
    // Fibonacci hashing (Knuth, The Art of Computer Programming, 6.4).
    let fold = |key: u64, word: &[u8; 8]| {
        (key.rotate_left(5) ^ u64::from_le_bytes(*word)).wrapping_mul(0x9E37_79B9_7F4A_7C15)
    };
    (words.fold(0, fold) >> 48) as usize % AT_HAND
}

/// How long a value is whose quote is the first of these bytes, without its quotes, when nothing in it has to be looked at more closely.
fn value_end(bytes: &[u8]) -> Option<usize> {
    let (quote, value) = bytes.split_first()?;
    let end = first_of(value, [*quote, b'<', b'&'])?;
    (value[end] == *quote).then_some(end)
}

/// How long a text is that starts with no white space, when nothing in it has to be looked at more closely.
fn text_end(bytes: &[u8]) -> Option<usize> {
    let end = first_of(bytes, [b'<', b'&', b']'])?;
    (bytes[0] > b' ' && end > 0 && bytes[end] == b'<').then_some(end)
}

/// How long what is in a comment is, when that is ended as it has to be.
fn comment_end(bytes: &[u8]) -> Option<usize> {
    let end = memchr::memchr_iter(b'-', bytes).find(|at| bytes.get(at + 1) == Some(&b'-'))?;
    (bytes.get(end + 2) == Some(&b'>')).then_some(end)
}
