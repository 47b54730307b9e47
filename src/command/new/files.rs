//! The files that `saoms new` makes.

use std::path::{Path, PathBuf};

use super::PluginKind;

/// The names of a plugin, as package, library and class.
pub(super) struct Names {
    /// `my-robot`, the package.
    pub(super) package: String,
    /// `my_robot`, the library and the first part of the names of its classes.
    library: String,
    /// `MyRobot`, the type.
    class: String,
}

impl Names {
    pub(super) fn of(package: &str, kind: PluginKind) -> Result<Names, String> {
        let starts = package.starts_with(|first: char| first.is_ascii_lowercase());
        let fits =
            package.chars().all(|sign| sign.is_ascii_lowercase() || sign.is_ascii_digit() || "-_".contains(sign));
        let class: String = package
            .split(['-', '_'])
            .filter_map(|word| {
                let mut signs = word.chars();
                Some(signs.next()?.to_ascii_uppercase().to_string() + signs.as_str())
            })
            .collect();
        // Keywords of Rust cannot be names of libraries.
        const WORDS: &[&str] = &[
            "as", "box", "crate", "do", "dyn", "else", "enum", "fn", "for", "if", "impl", "in", "let", "loop", "match",
            "mod", "move", "mut", "pub", "ref", "self", "static", "struct", "super", "test", "trait", "type", "use",
            "where", "while", "async", "await", "break", "const", "continue", "core", "std", "alloc", "extern",
            "false", "true", "return", "unsafe", "abstract", "become", "final", "macro", "override", "priv", "try",
            "typeof", "unsized", "virtual", "yield", "gen",
        ];
        // A crate cannot depend on another one of its own name.
        const CRATES: &[&str] = &[
            "saoms", "saoms-abi", "saoms-api", "saoms-components", "saoms-core", "saoms-derive", "saoms-lang",
            "saoms-registry", "saoms-testkit", "saoms-tools",
        ];
        // Nor keywords of Python those of its modules.
        const PYTHON: &[&str] = &[
            "and", "assert", "class", "def", "del", "elif", "except", "finally", "from", "global", "import", "is",
            "lambda", "nonlocal", "not", "or", "pass", "raise", "with",
        ];
        if !starts || !fits {
            return Err(format!(
                "found the name `{package}`, expected one for a Rust package: a small letter, then small letters, \
                 digits, `-` and `_`, such as `my-robot`"
            ));
        }
        let taken = if WORDS.contains(&package) {
            "a name of Rust itself".to_owned()
        } else if CRATES.contains(&package.replace('_', "-").as_str()) {
            "a crate of SAOMS itself".to_owned()
        } else if kind == PluginKind::Python && PYTHON.contains(&package) {
            "a name of Python itself".to_owned()
        } else if let Some(name) = Template::of(kind).clash(&class) {
            format!("the name of its type, and `{name}` is used by the code that is made")
        } else {
            return Ok(Names { package: package.to_owned(), library: package.replace('-', "_"), class });
        };
        Err(format!("found the name `{package}`, which is {taken}: take another one, such as `my-{package}`"))
    }
}

/// The origin of the crates of SAOMS, as the end of a dependency: `path = "..."` and the like.
pub(super) enum Source {
    /// The checkout that this program was built in.
    Checkout(PathBuf),
    /// A git repository.
    Git(String),
    /// A version from the registry.
    Version(String),
}

pub(super) fn source(api: Option<&str>) -> Result<Source, String> {
    match api {
        None => {
            let checkout = Path::new(env!("CARGO_MANIFEST_DIR"));
            if checkout.join("saoms-api/Cargo.toml").exists() {
                return Ok(Source::Checkout(checkout.to_owned()));
            }
            Err(format!(
                "the sources of this program are no longer in `{}`: give the source of saoms-api with `--api \
                GIT-URL`, `--api FOLDER` or `--api {}`",
                checkout.display(),
                env!("CARGO_PKG_VERSION")
            ))
        }
        Some(url) if url.contains("://") || url.ends_with(".git") => Ok(Source::Git(url.to_owned())),
        Some(version) if version.starts_with(|first: char| first.is_ascii_digit()) => {
            Ok(Source::Version(version.to_owned()))
        }
        Some(folder) => match Path::new(folder).canonicalize() {
            Ok(folder) if folder.join("saoms-api/Cargo.toml").exists() => Ok(Source::Checkout(folder)),
            _ => Err(format!(
                "found `--api {folder}`, expected a folder with `saoms-api` in it, the URL of a git repository, or a \
                 version"
            )),
        },
    }
}

impl Source {
    /// `more` is what else is said of it, as `, default-features = false`.
    fn dependency(&self, package: &str, more: &str) -> String {
        match self {
            Source::Checkout(folder) => format!("{package} = {{ path = {:?}{more} }}", folder.join(package)),
            Source::Git(url) => format!("{package} = {{ git = {url:?}{more} }}"),
            Source::Version(version) if more.is_empty() => format!("{package} = {version:?}"),
            Source::Version(version) => format!("{package} = {{ version = {version:?}{more} }}"),
        }
    }
}

/// What a plugin of a kind is made from.
struct Template {
    code: &'static str,
    /// Its test of a fleet; empty for one in C.
    fleet: &'static str,
    composite: &'static str,
    about: &'static str,
    /// True if it needs the components that ship.
    components: bool,
}

macro_rules! template {
    ($folder:literal, $components:literal, $about:literal) => {
        Template {
            code: include_str!(concat!("templates/", $folder, "/lib.rs")),
            fleet: include_str!(concat!("templates/", $folder, "/fleet.rs")),
            composite: include_str!(concat!("templates/", $folder, "/fleet.composite")),
            about: $about,
            components: $components,
        }
    };
}

impl Template {
    fn of(kind: PluginKind) -> Template {
        match kind {
            PluginKind::Component => template!("component", false, "counts, and publishes the count on its own topic"),
            PluginKind::Robot => template!("robot", true, "drives a robot: its wheels and its arm"),
            PluginKind::Loop => template!("loop", false, "lets a robot watch its battery"),
            PluginKind::Extension => template!("extension", true, "brings a robot that tells how far it has driven"),
            PluginKind::Master => template!("master", true, "brings a master that requests luggage by itself"),
            PluginKind::C => Template {
                code: include_str!("templates/c/plugin.c"),
                fleet: "",
                composite: include_str!("templates/component/fleet.composite"),
                about: "",
                components: false,
            },
            PluginKind::Python => Template {
                code: include_str!("templates/python/plugin.py"),
                fleet: "",
                composite: include_str!("templates/python/fleet.composite"),
                about: "",
                components: false,
            },
        }
    }

    /// The name in its code that is also one that a plugin with this class would bring.
    fn clash(&self, class: &str) -> Option<&'static str> {
        let own = [class.to_owned(), format!("{class}Own")];
        let is_part = |sign: char| sign.is_ascii_alphanumeric() || sign == '_';
        let mut words = [self.code, self.fleet].into_iter().flat_map(|text| text.split(move |sign| !is_part(sign)));
        words.find(|word| own.iter().any(|own| own == word))
    }
}

impl Names {
    fn fill(&self, text: &str) -> String {
        text.replace("my-plugin", &self.package).replace("my_plugin", &self.library).replace("MyPlugin", &self.class)
    }
}

/// The files of a plugin, by their places in its folder. `program` is the command for its tests, where they would find
/// none.
pub(super) fn plugin(
    names: &Names,
    kind: PluginKind,
    source: &Source,
    program: Option<&Path>,
) -> Vec<(PathBuf, String)> {
    let Template { code, fleet, composite, about, components } = Template::of(kind);
    let mut dependencies = source.dependency("saoms-api", "");
    if components {
        dependencies = format!("{dependencies}\n{}", source.dependency("saoms-components", ""));
    }
    let testkit = source.dependency("saoms-testkit", ", default-features = false");
    let cargo = names
        .fill(include_str!("templates/Cargo.toml"))
        .replace("# DEPENDENCIES", &dependencies)
        .replace("# TESTKIT", &testkit);
    let mut files = vec![
        ("Cargo.toml".into(), cargo),
        ("README.md".into(), names.fill(include_str!("templates/README.md")).replace("ABOUT", about)),
        (".gitignore".into(), "/target\n/.cargo\n".to_owned()),
        ("src/lib.rs".into(), names.fill(code)),
        ("tests/fleet.rs".into(), names.fill(fleet)),
        ("fleet.composite".into(), names.fill(composite)),
    ];
    if let Some(program) = program {
        let text = format!(
            "# The command for the tests of fleets, on this machine alone: `saoms` was not in PATH.\n[env]\nSAOMS = {:?}\n",
            program.display().to_string()
        );
        files.push((".cargo/config.toml".into(), text));
    }
    files
}

/// The files of a plugin in C.
pub(super) fn plugin_in_c(names: &Names) -> Vec<(PathBuf, String)> {
    let Template { code, composite, .. } = Template::of(PluginKind::C);
    let code = names.fill(code).replace("ABI_NUMBER", &saoms_abi::VERSION.to_string());
    vec![
        ("README.md".into(), names.fill(include_str!("templates/c/README.md"))),
        ("Makefile".into(), names.fill(include_str!("templates/c/Makefile"))),
        (".gitignore".into(), "/build\n".to_owned()),
        ("src/plugin.c".into(), code),
        ("include/saoms.h".into(), include_str!("../../../saoms-abi/include/saoms.h").to_owned()),
        ("include/saoms_author.h".into(), include_str!("../../../saoms-abi/include/saoms_author.h").to_owned()),
        ("fleet.composite".into(), names.fill(composite)),
    ]
}

/// The files of components in Python. The package that they import is there for editors; the plugin brings it itself.
pub(super) fn plugin_in_python(names: &Names) -> Vec<(PathBuf, String)> {
    let Template { code, composite, .. } = Template::of(PluginKind::Python);
    vec![
        ("README.md".into(), names.fill(include_str!("templates/python/README.md"))),
        (".gitignore".into(), "__pycache__\n".to_owned()),
        (format!("{}.py", names.library).into(), names.fill(code)),
        ("test_fleet.py".into(), include_str!("templates/python/test_fleet.py").to_owned()),
        ("fleet.composite".into(), names.fill(composite)),
        ("typings/saoms/__init__.py".into(), include_str!("../../../plugins/python/saoms/__init__.py").to_owned()),
    ]
}

/// A composite that runs.
pub(super) fn composite(name: &str) -> String {
    include_str!("templates/new.composite").replace("my-fleet", name)
}

/// A folder with a fleet: its composite and the files that this names.
pub(super) fn site(name: &str) -> Vec<(PathBuf, String)> {
    [
        ("site.composite", include_str!("templates/site/site.composite")),
        ("map.txt", include_str!("templates/site/map.txt")),
        ("scenario.txt", include_str!("templates/site/scenario.txt")),
        ("robots.csv", include_str!("templates/site/robots.csv")),
        ("README.md", include_str!("templates/site/README.md")),
    ]
    .map(|(file, text)| (file.into(), text.replace("my-site", name)))
    .into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_follow_from_the_package() {
        let names = Names::of("my-robot2", PluginKind::Component).unwrap();
        assert_eq!((names.library.as_str(), names.class.as_str()), ("my_robot2", "MyRobot2"));
        for wrong in ["", "MyRobot", "2robots", "mein-röbot", "a/b", "-a"] {
            assert!(
                Names::of(wrong, PluginKind::Component).err().unwrap().contains("expected one for a Rust package"),
                "{wrong}"
            );
        }
    }

    #[test]
    fn names_that_are_taken_are_refused() {
        for (name, taken) in [
            ("loop", "a name of Rust itself"),
            ("saoms-api", "a crate of SAOMS itself"),
            ("saoms_core", "a crate of SAOMS itself"),
        ] {
            assert!(Names::of(name, PluginKind::Component).err().unwrap().contains(taken), "{name}");
        }
    }
}
