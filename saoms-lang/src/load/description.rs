//! Descriptions of contributions: `sca-contribution.xml`, and beside it `sca-contribution-generated.xml`.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::children::Family;
use super::root::of_another_kind;
use super::vocabulary::CONTRIBUTION;
use super::{Loader, ReadContext, push_faults, read};
use crate::diagnostic::{Diagnostic, Diagnostics, Severity, codes, nearest, quoted};
use crate::model::Version;
use crate::source::{FileId, Location, Sources, Text, identity};
use crate::syntax::{self, Element, Parse};

/// The places of the description of a contribution in its folder: the author's, or else a tool's.
pub(crate) const DESCRIPTIONS: [&str; 3] = ["META-INF/sca-contribution.xml", "sca-contribution.xml", GENERATED];
/// The description of a contribution by a tool, beside the author's (SCA Assembly 1.1, 10.2.2).
pub(crate) const GENERATED: &str = "META-INF/sca-contribution-generated.xml";
/// The kinds of imports and exports that are known beside those of namespaces.
const ENDINGS: [&str; 4] = ["java", "resource", "c", "cpp"];

/// Imports and exports.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Kind {
    /// Definitions of a namespace, as composites.
    Namespace,
    /// Elements about classes of a package.
    Java,
}

/// One `import` or `export`.
pub(crate) struct Entry {
    kind: Kind,
    what: String,
    /// The place.
    pub(crate) at: Location,
    /// The folder of the other contribution as it is written, and the place of that, where it is given.
    pub(crate) location: Option<(PathBuf, Location)>,
    /// True if nothing else is said of it.
    is_bare: bool,
}

/// A composite that runs by itself.
pub(crate) struct Deployable {
    pub(crate) name: Text,
    /// The namespace that it is in; `None` where the name does not say it.
    pub(crate) namespace: Option<String>,
    /// The namespace of its prefix, at its declaration.
    pub(crate) declared: Option<Text>,
}

/// The description of a contribution.
#[derive(Default)]
pub(crate) struct Description {
    pub(crate) path: PathBuf,
    pub(crate) imports: Vec<Entry>,
    pub(crate) exports: Vec<Entry>,
    pub(crate) deployables: Vec<Deployable>,
    /// True if something that it says could not be read, which is reported.
    pub(crate) is_faulty: bool,
}

/// The file that describes the contribution in a folder.
pub(crate) fn path_in(root: &Path) -> Option<PathBuf> {
    DESCRIPTIONS.iter().map(|name| root.join(name)).find(|path| path.is_file())
}

/// True if a file has the name of a description.
pub(super) fn is_name(path: &Path) -> bool {
    DESCRIPTIONS.iter().any(|name| path.ends_with(name))
}

impl Entry {
    pub(crate) fn is(&self, kind: Kind, what: &str) -> bool {
        self.kind == kind && self.what == what
    }

    /// The namespace that it is about.
    pub(crate) fn namespace(&self) -> Option<&str> {
        (self.kind == Kind::Namespace).then_some(&self.what)
    }
}

impl Deployable {
    /// Its name without a prefix.
    pub(crate) fn local(&self) -> &str {
        self.name.split_once(':').map_or(self.name.as_str(), |(_, local)| local)
    }
}

impl Description {
    /// The descriptions of the contribution in a folder: by its author, and by the tools that made it. `None` where
    /// there is none; faults are reported.
    pub(crate) fn of(root: &Path, context: &mut ReadContext<'_>) -> Option<Self> {
        let mut made = Self::read(path_in(root)?, context);
        let generated = root.join(GENERATED);
        if made.path != generated && generated.is_file() {
            let more = Self::read(generated, context);
            made.imports.extend(more.imports);
            made.exports.extend(more.exports);
            let is_new = |one: &Deployable| {
                let mut known = made.deployables.iter();
                known.all(|known| known.local() != one.local() || known.namespace != one.namespace)
            };
            let new: Vec<Deployable> = more.deployables.into_iter().filter(is_new).collect();
            made.deployables.extend(new);
            made.is_faulty |= more.is_faulty;
        }
        Some(made)
    }

    /// True if composites of a namespace are given to other contributions.
    pub(crate) fn exports(&self, namespace: &str) -> bool {
        self.exports.iter().any(|entry| entry.is(Kind::Namespace, namespace))
    }

    /// Reads a description.
    pub(crate) fn read(path: PathBuf, context: &mut ReadContext<'_>) -> Self {
        let ReadContext { max_size, sources, diagnostics } = context;
        let mut made = Self { path, ..Self::default() };
        // Its faults are reported once, however often it is read.
        let shown = made.path.display().to_string();
        let is_it = |file: FileId| sources.get(file).path() == shown;
        let (mut unreported, is_reported) =
            (Diagnostics::new(), diagnostics.iter().any(|one| is_it(one.location.file)));
        let diagnostics = if is_reported { &mut unreported } else { &mut **diagnostics };
        let Some(file) = read(&made.path, *max_size, sources, diagnostics) else {
            made.is_faulty = true;
            return made;
        };
        let Parse { document, faults } = syntax::parse(file, sources.get(file).text());
        made.is_faulty = !faults.is_empty();
        let document = Arc::new(document);
        let root = document.root();
        let version = Version::from_namespace(root.namespace());
        let Some(version) = version.filter(|_| root.local_name() == CONTRIBUTION.name) else {
            let help = "a file of this name describes what a contribution runs, imports and exports";
            of_another_kind(root, CONTRIBUTION.name, help, faults, diagnostics);
            return made;
        };
        let known = diagnostics.len();
        let mut loader = Loader::new(version, root.namespace(), diagnostics);
        loader.check_attributes(root, &CONTRIBUTION);
        loader.no_text(root);
        let mut extensions: Option<Location> = None;
        for child in root.children() {
            made.add(child, &mut loader);
            if child.local_name() != "extensions" || child.namespace() != root.namespace() {
                continue;
            }
            match extensions {
                Some(first) => loader.repeated(child, first, &CONTRIBUTION, "`extensions`"),
                None => extensions = Some(child.name_location()),
            }
        }
        // What composites have to conform to they have by another rule (SCA Assembly 1.1, 13).
        diagnostics.adjust(known, |one| one.rule = Some("ASM12027"));
        push_faults(faults, sources, diagnostics);
        made.locations(root, file, sources, diagnostics);
        made
    }

    fn add(&mut self, child: Element<'_>, loader: &mut Loader<'_>) {
        let name = child.local_name();
        let family = loader.family(child);
        if family != Family::Sca {
            return;
        }
        let Some(part) = CONTRIBUTION.child(name) else {
            // Imports of other kinds are extensions, whichever namespace they are in.
            let ending = name.strip_prefix("import.").or_else(|| name.strip_prefix("export."));
            let is_extension = ending.is_some_and(|ending| nearest(ending, ENDINGS).is_none());
            if CONTRIBUTION.children.contains(&name) {
                loader.check_not_kept(child);
            } else if loader.is_wrapper(child, &CONTRIBUTION) {
                // What is in it is no wrapper: it goes no deeper.
                child.children().for_each(|inner| self.add(inner, loader));
            } else if !is_extension {
                _ = loader.unexpected(child, &CONTRIBUTION, family);
            }
            return;
        };
        loader.parts_of(child, part);
        let (import, export) = (name.strip_prefix("import"), name.strip_prefix("export"));
        if let Some("") = import.or(export)
            && let Some(none) = child.attribute("namespace").filter(|one| one.trimmed().is_empty())
        {
            // What is in no namespace.
            return self.exchange(Kind::Namespace, none.location(), "", child, loader);
        }
        let needed = part.attributes.iter().filter(|known| known.required);
        let mut needed: Vec<Option<Text>> = needed.map(|one| loader.required(child, one.name)).collect();
        let Some(what) = (!needed.is_empty()).then(|| needed.swap_remove(0)).flatten() else { return };
        if part.name == "deployable" {
            let namespace = namespace(&what, child);
            self.judge(&what, namespace.as_deref(), child, loader);
            let declared = declaration(&what, child);
            return self.deployables.push(Deployable { name: what, namespace, declared });
        }
        match import.or(export) {
            Some("") => self.exchange(Kind::Namespace, what.location, &what, child, loader),
            Some(".java") => self.exchange(Kind::Java, what.location, &what, child, loader),
            // Files are named by their paths, wherever they are.
            _ => {}
        }
    }

    /// Adds what is imported or exported; warns of what is said twice.
    fn exchange(&mut self, kind: Kind, at: Location, what: &str, child: Element<'_>, loader: &mut Loader<'_>) {
        let location = child.attribute("location").map(|one| one.trimmed());
        // The addresses of contributions elsewhere are no folders.
        let location = location.filter(|location| !location.contains(':'));
        let location = location.map(|location| (PathBuf::from(location.as_str()), location.location));
        let is_import = child.local_name().starts_with("import");
        let list = if is_import { &mut self.imports } else { &mut self.exports };
        let is_bare = ["location", "version"].iter().all(|one| child.attribute(one).is_none());
        let is_same = |one: &&Entry| is_bare && one.is_bare && one.is(kind, what) && one.at.file == at.file;
        if let Some(first) = list.iter().find(is_same) {
            let how = if is_import { "imported" } else { "exported" };
            let one = format!("{} is {how} twice", quoted(what));
            let one = Diagnostic::new(&codes::ATTRIBUTE_VALUE, at, one).severity(Severity::Warning);
            loader.report(one.label(first.at, "the first").help("keep one of them"));
        }
        list.push(Entry { kind, what: what.to_owned(), at, location, is_bare });
    }

    /// Warns of imports from folders that do not exist. Of those that must not be read this is not revealed.
    fn locations(&self, root: Element<'_>, file: FileId, sources: &Sources, diagnostics: &mut Diagnostics) {
        let own = Path::new(sources.get(file).path()).parent().unwrap_or(Path::new(""));
        let folder = if own.ends_with("META-INF") { own.parent().unwrap_or(Path::new("")) } else { own };
        let imports = root.children().filter(|child| child.local_name().starts_with("import"));
        for location in imports.filter_map(|child| Some(child.attribute("location")?.trimmed())) {
            let path = folder.join(location.as_str());
            let is_beside = || identity(&path).parent() == identity(folder).parent();
            let is_folder = || sources.open().outside(&path).is_some() && !is_beside() || path.exists();
            if location.is_empty() || location.contains(':') || is_folder() {
                continue;
            }
            let message = format!("there is no folder {}", quoted(&location));
            let one = Diagnostic::new(&codes::FILE_NOT_FOUND, location.location, message);
            let path = std::path::absolute(&path).unwrap_or(path);
            let help = format!("the full path is {}", quoted(&path.display().to_string()));
            diagnostics.push(one.severity(Severity::Warning).help(help));
        }
    }

    /// Warns of a deployable that is named twice, or without the namespace that it is in: what is found by its name
    /// alone is run.
    fn judge(&self, what: &Text, namespace: Option<&str>, child: Element<'_>, loader: &mut Loader<'_>) {
        let local = what.split_once(':').map_or(what.as_str(), |(_, local)| local);
        let is_same = |one: &&Deployable| one.local() == local && one.namespace.as_deref() == namespace;
        let message = if let Some(first) = self.deployables.iter().find(is_same) {
            let one = format!("{} is listed as deployable twice", quoted(what));
            let one = Diagnostic::new(&codes::ATTRIBUTE_VALUE, what.location, one);
            one.label(first.name.location, "the first").help("keep one of them")
        } else if namespace.is_none() && !what.ends_with(".composite") {
            // The name of a file leads nowhere, which is reported.
            let why = match what.split_once(':') {
                Some((prefix, _)) if child.resolve_prefix(prefix).is_none() => {
                    format!("the prefix {} is not declared", quoted(prefix))
                }
                _ => format!("{} has no namespace", quoted(what)),
            };
            let one = Diagnostic::new(&codes::ATTRIBUTE_VALUE, what.location, why);
            one.help("write it with a prefix of the composite's target namespace")
        } else {
            return;
        };
        loader.report(message.severity(Severity::Warning).rule("ASM12027"));
    }
}

/// The namespace of a name. One without a prefix is of the default namespace; where that is one of SCA, which holds no
/// user's composites, any may be meant. The same goes for an unbound prefix.
fn namespace(name: &str, at: Element<'_>) -> Option<String> {
    let prefix = name.split_once(':').map_or("", |(prefix, _)| prefix);
    let namespace = at.resolve_prefix(prefix)?;
    (Version::from_namespace(namespace).is_none() && !namespace.is_empty()).then(|| namespace.to_owned())
}

/// The namespace of the prefix of a name, where it is declared.
fn declaration(name: &str, at: Element<'_>) -> Option<Text> {
    let (prefix, _) = name.split_once(':')?;
    let around = std::iter::successors(Some(at), |one| one.parent());
    let mut declared = around.flat_map(|one| one.namespace_declarations());
    Some(declared.find(|one| one.name().strip_prefix("xmlns:") == Some(prefix))?.trimmed())
}
