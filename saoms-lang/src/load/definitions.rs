//! `definitions.xml`: intents and policy sets, accepted and checked for the names in them alone.

use std::path::Path;

use super::children::Family;
use super::root::{meant, of_another_kind};
use super::vocabulary::{self, DEFINITIONS, Kind};
use super::{Loader, ReadContext, push_faults, read};
use crate::diagnostic::Diagnostics;
use crate::model::Version;
use crate::syntax::{self, Element, Parse};

/// Checks the file `path`. One of another kind, which may have the same name, is skipped unless it was asked for. True
/// if it is one of definitions, or something is wrong with it.
pub(crate) fn check(path: &Path, is_asked_for: bool, context: &mut ReadContext<'_>) -> bool {
    let ReadContext { max_size, sources, diagnostics } = context;
    let known = diagnostics.len();
    let mut ignored = Diagnostics::new();
    let file = read(path, *max_size, sources, if is_asked_for { diagnostics } else { &mut ignored });
    let Some(file) = file else { return diagnostics.len() > known };
    let Parse { document, faults } = syntax::parse(file, sources.get(file).text());
    let root = document.root();
    let is_named_so = root.local_name() == DEFINITIONS.name;
    match Version::from_namespace(root.namespace()).filter(|_| is_named_so) {
        Some(version) => {
            Loader::new(version, root.namespace(), diagnostics).definitions(root);
            // The rule for composites is another one (SCA Assembly 1.1, 13).
            diagnostics.adjust(known, |one| one.rule = Some("ASM10003"));
            push_faults(faults, sources, diagnostics);
            return true;
        }
        None if is_asked_for || is_named_so && meant(root.namespace()).is_some() => {
            let help = "a file of this name holds intents and policy sets";
            of_another_kind(root, DEFINITIONS.name, help, faults, diagnostics);
        }
        None => {}
    }
    diagnostics.len() > known
}

impl Loader<'_> {
    fn definitions(&mut self, root: Element<'_>) {
        let mut open: Vec<(Element<'_>, &'static Kind)> = vec![(root, &DEFINITIONS)];
        while let Some((element, kind)) = open.pop() {
            self.check_attributes(element, kind);
            for known in kind.of(self.version).filter(|known| known.required) {
                self.required(element, known.name);
            }
            for child in element.children() {
                let family = self.family(child);
                let name = child.local_name();
                match vocabulary::children(kind).any(|known| family == Family::Sca && known == name) {
                    true => open.extend(vocabulary::definition(name).map(|kind| (child, kind))),
                    false if matches!(family, Family::Sca | Family::Own) => _ = self.unexpected(child, kind, family),
                    false => {}
                }
            }
        }
    }
}
