//! Groups of replicas by the names of their members: `Robot*` for `Robot07`.

use std::collections::{BTreeSet, HashMap};

/// The groups of a composite. What one name is looked up in does not grow with their number.
#[derive(Default)]
pub(super) struct Groups {
    /// The first is in front of all names.
    nodes: Vec<Node>,
}

/// A trie of the texts before, between and behind the numbers of names, one step further with each number.
#[derive(Default)]
struct Node {
    /// By the text that comes next.
    next: HashMap<String, usize>,
    /// The lengths of these texts.
    lengths: BTreeSet<usize>,
    /// The group whose name ends here.
    group: Option<usize>,
}

impl Groups {
    /// The groups among names, which have a `*` for each number. Of two of one name the first counts.
    pub(super) fn of<'n>(names: impl IntoIterator<Item = &'n str>) -> Self {
        let mut all = Self { nodes: vec![Node::default()] };
        let names = names.into_iter().enumerate().filter(|(_, name)| name.contains('*'));
        for (group, name) in names {
            let mut at = 0;
            for part in name.split('*') {
                let fresh = all.nodes.len();
                let node = &mut all.nodes[at];
                at = *node.next.entry(part.to_owned()).or_insert(fresh);
                if at == fresh {
                    node.lengths.insert(part.len());
                    all.nodes.push(Node::default());
                }
            }
            all.nodes[at].group.get_or_insert(group);
        }
        all
    }

    /// The first group that has a replica of this name.
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        let mut found: Option<usize> = None;
        let mut waiting = vec![(0, name)];
        while let Some((at, rest)) = waiting.pop() {
            let Some(node) = self.nodes.get(at) else { continue };
            for length in node.lengths.iter().take_while(|length| **length <= rest.len()) {
                let Some((part, behind)) = rest.split_at_checked(*length) else { continue };
                let Some(next) = node.next.get(part).copied() else { continue };
                if behind.is_empty() {
                    let group = self.nodes[next].group;
                    found = found.into_iter().chain(group).min();
                }
                let digits = behind.trim_start_matches('-').trim_start_matches(|c: char| c.is_ascii_digit());
                if digits.len() < behind.len() {
                    waiting.push((next, digits));
                }
            }
        }
        found
    }
}

#[test]
fn a_name_belongs_to_the_first_group_that_has_a_number_for_each_star() {
    let names = ["Robot", "Robot*", "Robot1*", "H*R*", "H*R*", "*", "a*b", "H*"];
    let groups = Groups::of(names);
    for (name, group) in [
        ("Robot07", Some("Robot*")),
        ("Robot17", Some("Robot*")),
        ("Robot-1", Some("Robot*")),
        ("Robot", None),
        ("Robotx", None),
        ("H1R2", Some("H*R*")),
        ("H1", Some("H*")),
        ("H1R", None),
        ("12", Some("*")),
        ("a5b", Some("a*b")),
        ("a5bc", None),
        ("ä5", None),
        ("", None),
    ] {
        assert_eq!(groups.find(name).map(|place| names[place]), group, "{name}");
    }
    assert_eq!(Groups::default().find("a"), None);
}
