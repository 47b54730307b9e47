//! A list that only grows, so that what is in it can be borrowed while more is added.

use std::cell::OnceCell;

pub(crate) struct AppendList<T> {
    first: Link<T>,
}

type Link<T> = OnceCell<Box<Node<T>>>;

struct Node<T> {
    value: T,
    next: Link<T>,
}

/// The end of a list, where values are added.
pub(crate) struct Appender<'a, T> {
    next: &'a Link<T>,
}

impl<T> AppendList<T> {
    pub(crate) const fn new() -> Self {
        Self { first: OnceCell::new() }
    }

    /// The end of the list, where values are added.
    pub(crate) const fn end(&self) -> Appender<'_, T> {
        Appender { next: &self.first }
    }
}

impl<'a, T> Appender<'a, T> {
    /// Adds a value, which stays as long as the list.
    pub(crate) fn add(&mut self, value: T) -> &'a T {
        while let Some(node) = self.next.get() {
            self.next = &node.next;
        }
        let node = self.next.get_or_init(|| Box::new(Node { value, next: OnceCell::new() }));
        self.next = &node.next;
        &node.value
    }
}

impl<T> Drop for AppendList<T> {
    /// One by one: the nodes hold each other, and would otherwise be dropped by recursion.
    fn drop(&mut self) {
        let mut next = self.first.take();
        while let Some(mut node) = next {
            next = node.next.take();
        }
    }
}
