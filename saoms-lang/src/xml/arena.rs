//! Where elements are kept.
//!
//! Most elements of a large file are in a child of the root that is written as one before it, but for values and texts. Of such a child only
//! is kept how it is written, and where: each of its elements is that of the first of its form, moved as far as the value before it is.

use super::form::{Content, Hole};
use super::parse::Open;
use super::tree::ElementId;
use crate::source::Span;

/// 32 bytes: a file of nothing but `<a/>` costs eight times its size.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// At the `<` of the start tag.
    pub(super) start: u32,
    /// Behind the `>` of the end tag.
    pub(super) end: u32,
    /// Behind the `>` of the start tag.
    pub(super) tag_end: u32,
    /// How the start tag is written.
    pub(super) shape: u32,
    pub(super) parent: u32,
    /// The number of what comes behind it and everything inside.
    pub(super) after: u32,
    /// The first of its attributes' values; there are as many as its shape has attributes.
    pub(super) values: u32,
    /// Whether text other than white space is directly inside.
    pub(super) has_text: bool,
    /// Whether its end tag was read; only those around a fault are not.
    pub(super) is_closed: bool,
}

/// A child of the root that is written as others are, but for the values of attributes and for texts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Alike {
    pub(crate) element: ElementId,
    /// A number that it has in common with those.
    pub(crate) form: u32,
    /// A bit for each of its first 64 values of attributes, those of inner elements included, that is the same as in the last one before.
    pub(crate) same: u64,
    /// At the `<` of its start tag.
    pub(super) start: u32,
    /// The first of its values.
    pub(super) values: u32,
    /// How many elements before it are kept.
    pub(super) kept: u32,
    /// How many elements it has when it is a copy, of which none is kept; otherwise 0.
    pub(super) copied: u32,
}

/// The first child of the root of a form.
#[derive(Clone, Copy, Debug)]
pub(super) struct Model {
    /// Its number, and its place among those that are kept.
    pub(super) element: u32,
    pub(super) kept: u32,
    /// The first of its marks: there is one for each of its elements.
    mark: u32,
    /// From which to before which of what is kept of holes texts are.
    texts: (u16, u16),
}

/// Which values places of an element are behind: 0 for none, 1 for the first of the child of the root that the element is in, and so on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mark {
    pub(super) start: u16,
    pub(super) tag_end: u16,
    pub(super) end: u16,
}

/// The elements of a document in order.
#[derive(Debug, Default)]
pub(super) struct Arena {
    pub(super) kept: Vec<Node>,
    /// The values of all attributes, declarations of namespaces included, without their quotes; of children of the root with a form, also
    /// their texts, behind these, and comments.
    pub(super) values: Vec<Span>,
    /// The children of the root that have a form, in order.
    pub(super) alike: Vec<Alike>,
    pub(super) models: Vec<Model>,
    pub(super) marks: Vec<Mark>,
    /// How many elements are copies.
    pub(super) copied: u32,
    /// For each group of elements, how many of `alike` start before it.
    groups: Vec<u32>,
}

/// How many elements are in a group: some more than in most copies.
const GROUP: u32 = 16;

/// Where an element is found: its place among those that are kept, or, with [`COPIED`], the place of what it is in among those that are alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place(u32);

/// A text of 4 GiB has less than half as many elements.
const COPIED: u32 = 1 << 31;

impl Place {
    pub(super) const ROOT: Self = Self(0);

    /// That of an element so many behind one, in the same child of the root.
    #[inline]
    pub(super) fn moved(self, further: u32) -> Self {
        if self.0 & COPIED == 0 { Self(self.0.wrapping_add(further)) } else { self }
    }
}

impl Arena {
    /// With room for so many elements and values.
    pub(super) fn with_capacity(elements: usize, values: usize) -> Self {
        Self { kept: Vec::with_capacity(elements), values: Vec::with_capacity(values), ..Self::default() }
    }

    /// How many elements there are.
    #[inline]
    pub(super) fn len(&self) -> u32 {
        self.kept.len() as u32 + self.copied
    }

    /// Makes a child of the root, the last of all elements so far, the first of its form; what may be different in others are its holes.
    pub(super) fn add_model(&mut self, open: &Open, holes: &[Hole]) {
        let mark = self.marks.len() as u32;
        // The first hole of each kind among what is kept of them; a form has fewer than a `u16` counts.
        let mut next = [0_u16; Content::ALL.len()];
        for (place, content) in Content::ALL.iter().enumerate() {
            let before = holes.iter().filter(|hole| hole.content < *content).count();
            next[place] = before as u16;
        }
        let [_, text, comment] = next;
        self.models.push(Model {
            element: open.element,
            kept: open.kept as u32,
            mark,
            texts: (text, comment),
        });
        let mut at = vec![0];
        at.extend(holes.iter().map(|hole| {
            let place = &mut next[hole.content as usize];
            *place += 1;
            *place
        }));
        let behind = |place: u32| at[holes.partition_point(|hole| hole.span.start < place)];
        self.marks.extend(self.kept[open.kept..].iter().map(|one| Mark {
            start: behind(one.start),
            tag_end: behind(one.tag_end),
            end: behind(one.end),
        }));
    }

    /// Keeps where what stands in holes is.
    pub(super) fn keep(&mut self, holes: &[Hole], content: Content) {
        self.values.extend(holes.iter().filter(|hole| hole.content == content).map(|hole| hole.span));
    }

    /// Where the text of an element is that has no others inside, among the values of the child of the root that it is in, in all of a form.
    pub(super) fn text(&self, form: u32, element: u32) -> Option<u32> {
        let Model { mark, texts: (first, end), .. } = self.models[form as usize];
        let Mark { tag_end, end: last, .. } = self.marks[(mark + element) as usize];
        (last != tag_end && (first + 1..=end).contains(&last)).then(|| u32::from(last) - 1)
    }

    /// Makes ready to find elements: there come no more.
    pub(super) fn finish(&mut self) {
        if self.copied == 0 {
            return;
        }
        // Room was made for elements that are copies.
        self.kept.shrink_to_fit();
        self.groups = Vec::with_capacity((self.len() / GROUP + 1) as usize);
        let mut count = 0;
        for start in (0..=self.len()).step_by(GROUP as usize) {
            let before = self.alike[count..].iter().take_while(|one| one.element.0 < start).count();
            count += before;
            self.groups.push(count as u32);
        }
    }

    /// Where an element is found.
    #[inline]
    pub(super) fn place(&self, element: u32) -> Place {
        let Some(before) = self.groups.get((element / GROUP) as usize) else { return Place(element) };
        let here = &self.alike[*before as usize..];
        let here = here.iter().take_while(|one| one.element.0 <= element).count();
        let Some(at) = (*before as usize + here).checked_sub(1) else { return Place(element) };
        let Alike { element: first, kept, copied, .. } = self.alike[at];
        let further = element - first.0;
        if further < copied { Place(at as u32 | COPIED) } else { Place(kept + further - copied) }
    }

    /// Where the child of the root is found that comes behind one.
    #[inline]
    pub(super) fn place_behind(&self, element: u32, before: Place) -> Place {
        let at = (before.0 & !COPIED) as usize + 1;
        match self.alike.get(at) {
            // Behind a copy mostly stands another.
            Some(next) if before.0 & COPIED != 0 && next.element.0 == element && next.copied > 0 => {
                Place(at as u32 | COPIED)
            }
            _ => self.place(element),
        }
    }

    /// An element.
    #[inline]
    pub(super) fn get(&self, element: u32, place: Place) -> Seen<'_> {
        if place.0 & COPIED == 0 {
            return Seen { arena: self, node: &self.kept[place.0 as usize], copy: None };
        }
        let alike = &self.alike[(place.0 & !COPIED) as usize];
        let model = &self.models[alike.form as usize];
        let further = element - alike.element.0;
        let node = &self.kept[(model.kept + further) as usize];
        Seen { arena: self, node, copy: Some((alike, model, further)) }
    }
}

/// An element that is looked at.
#[derive(Clone, Copy)]
pub(super) struct Seen<'a> {
    arena: &'a Arena,
    /// The element, or the one that it is a copy of.
    node: &'a Node,
    /// For a copy what it is in, and which one of that it is.
    copy: Option<(&'a Alike, &'a Model, u32)>,
}

impl Seen<'_> {
    #[inline]
    pub(super) fn shape(self) -> u32 {
        self.node.shape
    }

    #[inline]
    pub(super) fn has_text(self) -> bool {
        self.node.has_text
    }

    #[inline]
    pub(super) fn is_closed(self) -> bool {
        self.node.is_closed
    }

    #[inline]
    pub(super) fn start(self) -> u32 {
        self.node.start.wrapping_add(self.shift(|mark| mark.start))
    }

    #[inline]
    pub(super) fn tag_end(self) -> u32 {
        self.node.tag_end.wrapping_add(self.shift(|mark| mark.tag_end))
    }

    #[inline]
    pub(super) fn end(self) -> u32 {
        self.node.end.wrapping_add(self.shift(|mark| mark.end))
    }

    /// How much further behind a place of it is than in what it is a copy of.
    #[inline(always)]
    fn shift(self, of: impl Fn(&Mark) -> u16) -> u32 {
        let Some((alike, model, further)) = self.copy else { return 0 };
        let first = &self.arena.kept[model.kept as usize];
        match of(&self.arena.marks[(model.mark + further) as usize]) {
            0 => alike.start.wrapping_sub(first.start),
            count => {
                let end = |values: u32| self.arena.values[(values + u32::from(count)) as usize - 1].end;
                end(alike.values).wrapping_sub(end(first.values))
            }
        }
    }

    /// The first of its values.
    #[inline]
    pub(super) fn values(self) -> u32 {
        match self.copy {
            None => self.node.values,
            Some((alike, model, _)) => {
                alike.values + (self.node.values - self.arena.kept[model.kept as usize].values)
            }
        }
    }

    /// What it is in; `NONE` for the root.
    #[inline]
    pub(super) fn parent(self) -> u32 {
        match self.copy {
            None => self.node.parent,
            Some((_, _, 0)) => ElementId::ROOT.0,
            Some((alike, model, _)) => alike.element.0 + (self.node.parent - model.element),
        }
    }

    /// What comes behind it and everything inside.
    #[inline]
    pub(super) fn after(self) -> u32 {
        match self.copy {
            None => self.node.after,
            Some((alike, model, _)) => alike.element.0 + (self.node.after - model.element),
        }
    }
}
