//! `definitions.xml`: intents, policy sets, and the types of bindings and implementations (SCA Assembly 1.1, 10; SCA Policy 1.1, 3).
//!
//! Each file is held to the schema of its version, and those of a contribution to each other. What is in another contribution, or comes with the
//! program that runs the composites, is not known: so a name that is not found is a warning, and told only where it is likely to be wrong.

mod elements;
mod judge;

use std::path::{Path, PathBuf};

use super::root::{meant, of_another_kind};
use super::vocabulary::DEFINITIONS;
use super::{Loader, read};
use crate::diagnostic::Diagnostics;
use crate::model::{OutsideKind, Version};
use crate::source::{Sources, Text};
use crate::xml::{self, Element};

/// A name in a namespace.
type Name = (String, String);

/// What one file declares, and what it names.
struct Definitions {
    version: Version,
    target: String,
    declared: Vec<Declared>,
    named: Vec<Named>,
}

/// What is declared under a name of its own.
struct Declared {
    name: Name,
    written: Text,
    what: What,
}

enum What {
    Intent { qualifiers: Vec<Qualifier>, requires: Vec<Named>, excludes: Vec<Named> },
    PolicySet { provides: Vec<Named>, references: Vec<Named>, maps: Vec<Map> },
    BindingType,
    ImplementationType,
}

/// A qualifier of an intent.
struct Qualifier {
    name: Text,
    is_default: bool,
}

/// An `intentMap` in a policy set.
struct Map {
    provides: Option<Named>,
    default: Option<Text>,
    qualifiers: Vec<Text>,
}

/// A QName that is written somewhere.
#[derive(Clone)]
struct Named {
    /// `None` where its prefix is bound to nothing.
    name: Option<Name>,
    written: Text,
    kind: OutsideKind,
}

impl What {
    /// What it is, in words.
    fn name(&self) -> &'static str {
        match self {
            Self::Intent { .. } => "intent",
            Self::PolicySet { .. } => "policy set",
            Self::BindingType => "type of binding",
            Self::ImplementationType => "type of implementation",
        }
    }
}

/// Whether a root is that of definitions of SCA.
pub(super) fn is_of_policies(root: Element<'_>) -> bool {
    Version::from_namespace(root.namespace()).is_some() && root.local_name() == DEFINITIONS.name
}

/// Checks files of definitions that belong together; those of other kinds, which may have the same name, are passed over. Whether there was one.
pub(super) fn check(
    paths: &[PathBuf],
    max_size: u64,
    sources: &mut Sources,
    diagnostics: &mut Diagnostics,
) -> bool {
    let known = diagnostics.len();
    let all: Vec<Definitions> =
        paths.iter().filter_map(|path| one(path, false, max_size, sources, diagnostics)).collect();
    judge::check(&all, diagnostics);
    !all.is_empty() || diagnostics.len() > known
}

/// Checks the file `path`, which is to be one of definitions, together with the `others` of its contribution, of which nothing is told.
pub(super) fn check_one(
    path: &Path,
    others: &[PathBuf],
    max_size: u64,
    sources: &mut Sources,
    diagnostics: &mut Diagnostics,
) {
    let mut untold = Diagnostics::new();
    let others = others.iter().filter_map(|path| one(path, false, max_size, sources, &mut untold));
    let mut all: Vec<Definitions> = others.collect();
    let own = sources.iter().count();
    all.extend(one(path, true, max_size, sources, diagnostics));
    let mut found = Diagnostics::new();
    judge::check(&all, &mut found);
    let is_here = |file| sources.iter().skip(own).any(|(here, _)| here == file);
    found
        .into_all()
        .into_iter()
        .filter(|one| is_here(one.location.file))
        .for_each(|one| diagnostics.push(one));
}

fn one(
    path: &Path,
    is_asked_for: bool,
    max_size: u64,
    sources: &mut Sources,
    diagnostics: &mut Diagnostics,
) -> Option<Definitions> {
    let mut untold = Diagnostics::new();
    let read = read(path, max_size, sources, if is_asked_for { &mut *diagnostics } else { &mut untold });
    let file = read?;
    let xml::Parsed { document, fault, .. } = xml::parse(file, sources.get(file).text());
    let document = document?;
    let root = document.root();
    if !is_of_policies(root) {
        let is_slip = root.local_name() == DEFINITIONS.name && meant(root.namespace()).is_some();
        if is_asked_for || is_slip {
            let fault = fault.unwrap_or_else(|| {
                of_another_kind(root, DEFINITIONS.name, "a file of this name holds intents and policy sets")
            });
            diagnostics.push(fault);
        }
        return None;
    }
    if let Some(fault) = fault {
        diagnostics.push(fault);
        return None;
    }
    let version = Version::from_namespace(root.namespace())?;
    let known = diagnostics.len();
    let mut loader = Loader::new(version, root.namespace(), diagnostics);
    let made = loader.definitions(root);
    // What composites have to conform to they have by another rule (SCA Assembly 1.1, 13).
    diagnostics.adjust(known, |one| one.rule = Some("ASM10003"));
    Some(made)
}
