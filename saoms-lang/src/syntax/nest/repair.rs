//! Tags that do not fit: what was meant, as far as the numbers of tags and the vocabulary of composites tell it.

use super::Nest;
use super::tags::{self, Named, holders, local};
use crate::diagnostic::{nearest, quoted};
use crate::limits::{OPEN_ELEMENTS_SEARCHED, SIBLINGS_SEARCHED};
use crate::syntax::document::{Node, TokenKind};

impl<'a> Nest<'_, 'a> {
    /// Closes elements that lack end tags, and that the next element, `named`, cannot stand in. Gives whether its start
    /// tag was meant as an end tag, so that there is no such element.
    pub(super) fn makes_room(&mut self, at: u32, named: Named<'a>, is_bare: bool) -> bool {
        if self.counts.is_empty() {
            return false;
        }
        let Some(holders) = holders(local(named.name)) else { return false };
        let is_holder = |one: &&u32| tags::is_one_of(local(self.name(self.node(**one))), holders);
        let Some(above) = self.open.iter().rev().take(OPEN_ELEMENTS_SEARCHED).position(|one| is_holder(&one)) else {
            return false;
        };
        let above: Vec<u32> = self.open.iter().rev().take(above).copied().collect();
        let missing = |name: &str| self.count_of(name).missing_ends();
        let is_missing = |one: &u32| missing(self.name(self.node(*one))) > 0;
        if above.is_empty() || !above.iter().all(is_missing) {
            return false;
        }
        let open = self.named(self.node(above[0]));
        if is_bare && open.name == named.name && missing(named.name) > 1 && above.len() == 1 {
            self.lexer.faults.add(|| {
                tags::replaced(tags::mismatch(self.input, &format!("<{}>", named.name), named.start_tag, open), open)
            });
            self.lexer.tokens[at as usize].kind = TokenKind::Error;
            self.close(at, false);
            return true;
        }
        for one in above {
            let outer = self.named(self.node(one));
            if !self.token(self.node(one).token).is_broken_off {
                self.lexer.faults.add(|| tags::not_closed(self.input, outer, named));
            }
            self.close(at, false);
        }
        false
    }

    /// Reports an element beside the root. What is not called as the root stands in it, which is closed too early then.
    pub(super) fn second_root(&mut self, named: Named<'a>) {
        let root = *self.node(0);
        let first = self.named(&root);
        self.has_other_root |= first.name == named.name;
        let end = (self.token(root.end).kind == TokenKind::EndTag).then(|| self.span(root.end));
        let is_too_early = !self.has_other_root && self.count_of(first.name).ends > 0;
        if !self.has_second_root {
            self.lexer.faults.add(|| match end {
                Some(end) if is_too_early => tags::too_early(self.input, end, named, first),
                _ => tags::second_root(self.input, named, first, end.is_some() && !self.has_other_root),
            });
            self.has_second_root = true;
        }
        if !self.has_other_root {
            self.reopen(0);
            // Nothing is missing before or behind an end tag that is at the wrong place.
            self.node_mut(0).is_content_damaged = root.is_content_damaged || end.is_none();
            self.open_element(0);
        }
    }

    /// Takes the end of an element back.
    fn reopen(&mut self, element: u32) {
        let node = self.node_mut(element);
        (node.is_closed, node.is_content_damaged) = (false, true);
        let Node { token, end, .. } = *node;
        self.lexer.tokens[token as usize].kind = TokenKind::StartTag;
        if end != token && self.token(end).kind == TokenKind::EndTag {
            self.lexer.tokens[end as usize].kind = TokenKind::Error;
        }
    }

    /// An end tag with another name than the element has that is open.
    pub(super) fn mismatch(&mut self, at: u32, found: &'a str, top: u32) {
        let (input, tag) = (self.input, self.span(at));
        let open = self.named(self.node(top));
        let is_near = nearest(found, [open.name]).is_some();
        let lacks_end = self.count_of(open.name).missing_ends() > 0;
        let same = self.count_of(found);
        let fault = || tags::mismatch(input, &format!("</{found}>"), tag, open);
        let has_surplus_end = same.ends + 1 > same.open + same.starts;
        let is_for_outer = same.open > 0 && !(is_near && lacks_end && has_surplus_end);
        let is_broken_off = self.token(self.node(top).token).is_broken_off;
        if is_for_outer {
            let is_bare = top + 1 == self.count && !self.node(top).has_text;
            if !is_broken_off {
                self.lexer.faults.add(|| tags::closed_first(input, fault(), tag.start, open, is_bare));
            }
            while let Some(&top) = self.open.last() {
                let is_it = self.name(self.node(top)) == found;
                self.close(at, is_it);
                if is_it {
                    break;
                }
            }
            return;
        }
        if !is_near && let Some(same) = self.sibling(found, top) {
            let sibling = self.named(self.node(same));
            let is_empty = self.token(self.node(same).token).kind == TokenKind::EmptyTag;
            let is_early = is_empty && !input.slice(sibling.start_tag.end, tag.start).trim().is_empty();
            let place = sibling.at.in_file(input.file);
            self.lexer.faults.add(|| {
                if is_early {
                    let end = sibling.start_tag.end;
                    let slash = input.at(end - 2, end - 1);
                    let one = fault().label(place, format!("this {} is closed by `/>`", quoted(found)));
                    return one.suggest("remove its `/`", slash, "");
                }
                let one = fault().label(place, format!("this {} is closed", quoted(found)));
                one.mend("remove it", "")
            });
            let node = *self.node(same);
            // An element that was broken off while it was typed may end at this very tag.
            let is_twice = node.end < at
                && node.after == self.count
                && input.slice(self.span(node.end).end, tag.start).trim().is_empty();
            if is_early {
                self.close_late(same, top, at);
            } else if is_twice {
                // Without it nothing is missing: a start tag that was lost leaves what was behind it.
                self.lexer.tokens[at as usize].kind = TokenKind::Error;
            } else {
                self.ignore(at, top);
            }
            return;
        }
        self.lexer.faults.add(|| tags::replaced(fault(), open));
        if is_near || lacks_end {
            self.close(at, true);
        } else {
            self.ignore(at, top);
        }
    }

    /// The last element of this name that is directly inside `parent`.
    fn sibling(&self, name: &str, parent: u32) -> Option<u32> {
        let inside = (parent + 1..self.count).rev().take(SIBLINGS_SEARCHED);
        inside.filter(|one| self.node(*one).parent == parent).find(|one| self.name(self.node(*one)) == name)
    }

    /// Lets an element that ends in its start tag end at a later end tag: what is between is inside of it.
    fn close_late(&mut self, element: u32, parent: u32, at: u32) {
        self.reopen(element);
        self.node_mut(parent).is_content_damaged = true;
        for one in element + 1..self.count {
            let node = self.node_mut(one);
            if node.parent == parent {
                node.parent = element;
            }
        }
        let token = self.node(element).token;
        let has_text = (token..at).any(|one| self.token(one).kind == TokenKind::Text);
        let count = self.count;
        let node = self.node_mut(element);
        node.is_closed = true;
        node.has_text |= has_text;
        (node.end, node.after) = (at, count);
    }
}
