//! The files of contributions that declare what composites name: schemas, WSDL and definitions.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::shelf::{Shelf, describes, is_of_definitions};

impl Shelf {
    /// The files that may declare what a composite in `folder` names: those beside it, and those of a contribution that is described as such.
    pub(super) fn declaring(&mut self, folder: &Path) -> Rc<[PathBuf]> {
        let root = self.root(folder);
        let own = self.listing(folder);
        let of_root = self.declaring_of(&root);
        // As a rule a folder is one of its contribution.
        if own.declaring.iter().all(|path| of_root.binary_search(path).is_ok()) {
            return of_root;
        }
        let mut all = [&own.declaring[..], &of_root].concat();
        all.sort_unstable();
        all.dedup();
        all.into()
    }

    /// Those of the contribution in `root`.
    fn declaring_of(&mut self, root: &Path) -> Rc<[PathBuf]> {
        if let Some(known) = self.declaring.get(root) {
            return Rc::clone(known);
        }
        let definitions = root.join("META-INF/definitions.xml");
        let mut all: Vec<PathBuf> = Some(definitions).filter(|path| path.is_file()).into_iter().collect();
        let mut waiting = if describes(root) { vec![root.to_owned()] } else { Vec::new() };
        while let Some(next) = waiting.pop() {
            let listing = self.listing(&next);
            all.extend_from_slice(&listing.declaring);
            waiting.extend_from_slice(&listing.folders);
        }
        all.sort_unstable();
        all.dedup();
        let all: Rc<[PathBuf]> = all.into();
        self.declaring.insert(root.to_owned(), Rc::clone(&all));
        all
    }

    /// The schemas, WSDL and definitions in a contribution, sorted.
    pub(super) fn declaring_in(&mut self, root: &Path) -> Vec<PathBuf> {
        let (mut all, mut waiting) = (Vec::new(), vec![root.to_owned()]);
        while let Some(next) = waiting.pop() {
            if next == root || !describes(&next) {
                let listing = self.listing(&next);
                all.extend_from_slice(&listing.declaring);
                waiting.extend_from_slice(&listing.folders);
            }
        }
        all.sort_unstable();
        all
    }

    /// The files of definitions among them.
    pub(super) fn definitions(&mut self, root: &Path) -> Vec<PathBuf> {
        let mut all = self.declaring_in(root);
        all.retain(|path| is_of_definitions(path));
        all
    }

    /// The namespaces of the composites in a contribution.
    pub(super) fn namespaces(&mut self, root: &Path) -> BTreeSet<String> {
        let composites = self.contribution(root).0.into_iter();
        composites.filter_map(|path| Some(self.head(&path).as_ref()?.namespace.clone())).collect()
    }
}
