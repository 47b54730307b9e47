//! The interpreter that is there: `SAOMS_PYTHON`, that of a virtual environment, or `python3`.

use std::env;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde::Deserialize;

/// The variable that names an interpreter.
const VARIABLE: &str = "SAOMS_PYTHON";

/// What an interpreter says of itself.
#[derive(Debug, Deserialize)]
pub(crate) struct Installation {
    pub(crate) version: (u32, u32),
    /// The files that may be its library, the likeliest first.
    pub(crate) libraries: Vec<PathBuf>,
    pub(crate) home: String,
    pub(crate) prefix: String,
    pub(crate) path: Vec<String>,
    pub(crate) executable: String,
}

const PROBE: &str = r#"
import json, os, sys, sysconfig
of = sysconfig.get_config_var
names = [name for name in (of("INSTSONAME"), of("LDLIBRARY")) if name and ".so" in name]
folders = [of("LIBDIR"), os.path.join(sys.base_prefix, "lib"), of("LIBPL")]
folders += [os.path.join(of("LIBDIR") or "", of("MULTIARCH") or "")]
names += ["libpython%d.%d.so.1.0" % sys.version_info[:2]]
print(json.dumps({"version": sys.version_info[:2], "home": sys.base_prefix + ":" + sys.base_exec_prefix,
    "libraries": [os.path.join(folder, name) for folder in folders if folder for name in names],
    "prefix": sys.prefix, "path": [one for one in sys.path if one], "executable": sys.executable}))
"#;

/// The installation, and the file of its library.
pub(crate) fn installation() -> Result<(Installation, PathBuf), String> {
    let (program, named) = program();
    let shown = program.display();
    let with_variable = format!("install Python 3.9 or later, or name its interpreter with `{VARIABLE}`");
    let output = Command::new(&program).args(["-c", PROBE]).stdin(Stdio::null()).output();
    let output = output.map_err(|error| format!("`{shown}`, {named}, does not start ({error}): {with_variable}"))?;
    let said: Result<Installation, _> = serde_json::from_slice(&output.stdout);
    let Ok(found) = said else {
        let words = String::from_utf8_lossy(&output.stderr);
        let last = words.lines().last().unwrap_or_default();
        return Err(format!("`{shown}`, {named}, does not say what it is ({last}): {with_variable}"));
    };
    let (major, minor) = found.version;
    if found.version < (3, 9) {
        return Err(format!("`{shown}`, {named}, is Python {major}.{minor}, expected 3.9 or later: {with_variable}"));
    }
    match found.libraries.iter().find(|path| path.exists()) {
        Some(library) => {
            let library = library.clone();
            Ok((found, library))
        }
        None => Err(format!(
            "`{shown}`, {named}, is Python {major}.{minor} without a shared library: install that (`libpython{major}.{minor}` \
            of Debian; `PYTHON_CONFIGURE_OPTS=--enable-shared pyenv install`), or name another interpreter with \
            `{VARIABLE}`"
        )),
    }
}

/// The interpreter, and by what it is named.
fn program() -> (PathBuf, &'static str) {
    let given = |name: &str| env::var_os(name).filter(|text| !text.is_empty());
    if let Some(named) = given(VARIABLE) {
        return (named.into(), "which `SAOMS_PYTHON` names");
    }
    match given("VIRTUAL_ENV") {
        Some(environment) => (Path::new(&environment).join("bin/python"), "of the virtual environment"),
        None => ("python3".into(), "of `PATH`"),
    }
}
