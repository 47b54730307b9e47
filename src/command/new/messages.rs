//! Declarations in Rust of interfaces of ROS 2.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use saoms_lang::ros::{RosBase, RosDefinition, RosField, RosList, read_ros_file};

/// The types that the contract has.
const BUILTIN: &str = "builtin_interfaces";
/// Names of fields that Rust has a use for.
const WORDS: &[&str] = &[
    "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "do", "dyn", "else", "enum",
    "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let", "loop", "macro", "match", "mod", "move",
    "mut", "override", "priv", "pub", "ref", "return", "static", "struct", "trait", "true", "try", "type", "typeof",
    "unsafe", "unsized", "use", "virtual", "where", "while", "yield",
];
/// Those that cannot be names at all.
const TAKEN: &[&str] = &["crate", "self", "super"];
/// Elements of an array that has a usual value, at most.
const MOST_USUAL: u64 = 32;

/// A message of a package.
struct Declared {
    path: PathBuf,
    /// Its name as ROS 2 has it.
    name: String,
    definition: RosDefinition,
}

/// The messages by package and name in Rust, and the services of each package, with their comments.
#[derive(Default)]
struct Interfaces {
    messages: BTreeMap<(String, String), Declared>,
    services: BTreeMap<(String, String), Vec<String>>,
    faults: Vec<String>,
}

/// The declarations of files, as a text in Rust.
///
/// # Errors
/// All faults of all files, a line each.
pub(super) fn declarations(files: &[PathBuf], package: Option<&str>) -> Result<String, String> {
    let mut all = Interfaces::default();
    for path in files {
        all.read(path, package);
    }
    let known: BTreeSet<(String, String)> = all.messages.keys().cloned().collect();
    let mut faults = std::mem::take(&mut all.faults);
    for ((package, own), declared) in &all.messages {
        for field in &declared.definition.fields {
            let RosBase::Message(of, name) = &field.base else { continue };
            let of = of.as_ref().unwrap_or(package);
            let is_known = known.contains(&(of.clone(), name.clone())) || is_builtin(of, name);
            let place = format!("{}:{}:{}", declared.path.display(), field.place.0, field.place.1);
            if !is_known {
                faults.push(format!("{place}: `{of}/{name}` is in none of the files: give its file, too"));
            } else if all.contains_itself((of, name), (package, own)) {
                faults.push(format!("{place}: `{of}/{name}` contains a message that contains it"));
            }
        }
    }
    if !faults.is_empty() {
        return Err(faults.join("\nerror: "));
    }
    Ok(all.text())
}

fn is_builtin(package: &str, name: &str) -> bool {
    package == BUILTIN && matches!(name, "Time" | "Duration")
}

impl Interfaces {
    /// Reads a file.
    fn read(&mut self, path: &Path, package: Option<&str>) {
        let shown = path.display();
        let is_service = path.extension().is_some_and(|extension| extension == "srv");
        if !is_service && path.extension().is_none_or(|extension| extension != "msg") {
            return self.faults.push(format!("{shown}: the name of the file ends neither with `.msg` nor with `.srv`"));
        }
        let name = path.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let is_name = name.starts_with(|first: char| first.is_ascii_uppercase())
            && name.chars().all(|one| one.is_ascii_alphanumeric());
        if !is_name {
            let text = format!("{shown}: `{name}` is no name of a type: letters and digits, a capital letter first");
            return self.faults.push(text);
        }
        let folder = path.parent().filter(|folder| folder.ends_with("msg") || folder.ends_with("srv"));
        let found =
            folder.and_then(Path::parent).and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
        let Some(package) = found.or_else(|| package.map(str::to_owned)) else {
            let text =
                format!("{shown}: the file lies in no folder `PACKAGE/msg` or `PACKAGE/srv`: give its `--package`");
            return self.faults.push(text);
        };
        if !saoms_lang::ros::is_package(&package) {
            let text =
                format!("{shown}: `{package}` is no name of a package: small letters, digits and `_`, a letter first");
            return self.faults.push(text);
        }
        let text = match fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) => return self.faults.push(format!("{shown}: it cannot be read: {error}")),
        };
        let parts = match read_ros_file(&text, is_service) {
            Ok(parts) => parts,
            Err(faults) => return self.faults.extend(faults.iter().map(|fault| format!("{shown}:{fault}"))),
        };
        let ends: &[(&str, &str)] =
            if is_service { &[("Request", "_Request"), ("Response", "_Response")] } else { &[("", "")] };
        let kind = if is_service { "srv" } else { "msg" };
        for ((own, of_ros), mut definition) in ends.iter().zip(parts) {
            for field in definition.fields.iter().filter(|field| TAKEN.contains(&&*field.name)) {
                let (line, column) = field.place;
                let text = format!("`{}` cannot be the name of a field in Rust", field.name);
                self.faults.push(format!("{shown}:{line}:{column}: {text}"));
            }
            if is_service && *own == "Request" {
                let docs = std::mem::take(&mut definition.docs);
                self.services.insert((package.clone(), name.clone()), docs);
            }
            let declared =
                Declared { path: path.to_owned(), name: format!("{package}/{kind}/{name}{of_ros}"), definition };
            if let Some(other) = self.messages.insert((package.clone(), format!("{name}{own}")), declared) {
                self.faults
                    .push(format!("{shown}: `{package}/{name}{own}` is declared in {}, too", other.path.display()));
            }
        }
    }

    /// True if a message leads to another one.
    fn contains_itself(&self, from: (&str, &str), to: (&str, &str)) -> bool {
        let (mut open, mut seen) = (vec![(from.0.to_owned(), from.1.to_owned())], BTreeSet::new());
        while let Some(one) = open.pop() {
            if (one.0.as_str(), one.1.as_str()) == to {
                return true;
            }
            if let Some(declared) = self.messages.get(&one).filter(|_| seen.insert(one.clone())) {
                let fields = declared.definition.fields.iter();
                open.extend(fields.filter_map(|field| match &field.base {
                    RosBase::Message(of, name) => Some((of.clone().unwrap_or_else(|| one.0.clone()), name.clone())),
                    _ => None,
                }));
            }
        }
        false
    }

    /// True if a message has a usual value: arrays have one up to a length.
    fn has_default(&self, package: &str, name: &str) -> bool {
        let Some(declared) = self.messages.get(&(package.to_owned(), name.to_owned())) else { return true };
        declared.definition.fields.iter().all(|field| {
            let of_element = match (&field.base, field.list) {
                // An empty list has one whatever it is a list of.
                (_, RosList::Unbounded | RosList::Most(_)) => true,
                (RosBase::Message(of, name), _) => self.has_default(of.as_deref().unwrap_or(package), name),
                _ => true,
            };
            of_element && !matches!(field.list, RosList::Length(length) if length > MOST_USUAL)
        })
    }

    /// All declarations, a module for each package.
    fn text(&self) -> String {
        let mut text = "//! Interfaces of ROS 2, made of their definitions by `saoms new messages`.\n".to_owned();
        let packages: BTreeSet<&String> = self.messages.keys().map(|(package, _)| package).collect();
        for package in packages {
            let messages = || self.messages.iter().filter(|((of, _), _)| of == package);
            let services = || self.services.iter().filter(|((of, _), _)| of == package);
            let fields = || messages().flat_map(|(_, declared)| &declared.definition.fields);
            let has_bounds = fields()
                .any(|field| matches!(field.list, RosList::Most(_)) || matches!(field.base, RosBase::String(Some(_))));
            let mut used = vec!["Message"];
            used.extend(has_bounds.then_some("Bounded"));
            if services().next().is_some() {
                used.extend(["Context", "Failure", "interface"]);
            }
            used.sort_by_key(|name| (name.starts_with(char::is_lowercase), *name));
            let used = if used.len() == 1 { used[0].to_owned() } else { format!("{{{}}}", used.join(", ")) };
            // Writing to a text does not fail.
            let _ = write!(text, "\n/// The package `{package}`.\npub mod {package} {{\n    use saoms_api::{used};\n");
            for ((_, name), declared) in messages() {
                self.message(package, name, declared, &mut text);
            }
            for ((_, name), docs) in services() {
                let docs =
                    if docs.is_empty() { vec![format!("The service `{package}/srv/{name}`.")] } else { docs.clone() };
                text.push('\n');
                comment(&mut text, "    ", &docs);
                let _ = write!(
                    text,
                    "    #[interface(name = \"{package}/srv/{name}\")]\n    pub trait {name} {{\n        /// Answers a request.\n        \
                     fn call(&mut self, context: &mut Context<'_>, request: {name}Request) -> Result<{name}Response, \
                     Failure>;\n    }}\n"
                );
            }
            text.push_str("}\n");
        }
        text
    }

    fn message(&self, package: &str, name: &str, declared: &Declared, text: &mut String) {
        let Declared { name: of_ros, definition, .. } = declared;
        let docs = if definition.docs.is_empty() { vec![format!("`{of_ros}`.")] } else { definition.docs.clone() };
        text.push('\n');
        comment(text, "    ", &docs);
        let default = if self.has_default(package, name) { "Default, " } else { "" };
        let _ =
            write!(text, "    #[derive(Clone, Debug, {default}PartialEq, Message)]\n    #[message(name = \"{of_ros}\"");
        if !definition.constants.is_empty() {
            text.push_str(", constants(\n");
            for constant in &definition.constants {
                comment(text, "        ", &constant.docs);
                let _ = writeln!(text, "        {}: {} = {},", constant.name, constant.kind, constant.value);
            }
            text.push_str("    )");
        }
        text.push_str(")]\n");
        if definition.fields.is_empty() {
            let _ = writeln!(text, "    pub struct {name} {{}}");
            return;
        }
        let _ = writeln!(text, "    pub struct {name} {{");
        for field in &definition.fields {
            comment(text, "        ", &field.docs);
            let raw = if WORDS.contains(&&*field.name) { "r#" } else { "" };
            let _ = writeln!(text, "        pub {raw}{}: {},", field.name, kind(package, field));
        }
        text.push_str("    }\n");
    }
}

/// Comments as those of an item.
fn comment(text: &mut String, indent: &str, docs: &[String]) {
    for line in docs {
        let _ = writeln!(text, "{}", format!("{indent}/// {line}").trim_end());
    }
}

/// The type of a field in Rust.
fn kind(package: &str, field: &RosField) -> String {
    let base = match &field.base {
        RosBase::Plain(name) => (*name).to_owned(),
        RosBase::String(None) => "String".to_owned(),
        RosBase::String(Some(most)) => format!("Bounded<String, {most}>"),
        RosBase::Message(of, name) => match of.as_deref().unwrap_or(package) {
            of if is_builtin(of, name) => format!("saoms_api::builtin_interfaces::{name}"),
            of if of == package => name.clone(),
            of => format!("super::{of}::{name}"),
        },
    };
    match field.list {
        RosList::None => base,
        RosList::Length(length) => format!("[{base}; {length}]"),
        RosList::Most(most) => format!("Bounded<Vec<{base}>, {most}>"),
        RosList::Unbounded => format!("Vec<{base}>"),
    }
}
