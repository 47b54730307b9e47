//! The command over composites with components of plugins.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

use crate::support::PROGRAM;

/// The result of a command.
pub(crate) struct Run {
    pub(crate) code: Option<i32>,
    /// Standard output and standard error.
    pub(crate) text: String,
    pub(crate) report: Value,
}

impl Run {
    fn of(output: &Output, report: Value) -> Run {
        let text = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        Run { code: output.status.code(), text, report }
    }

    /// The part of the report about a component.
    pub(crate) fn component(&self, name: &str) -> &Value {
        let all = self.report["components"].as_array();
        let found = all.and_then(|all| all.iter().find(|one| one["name"] == name));
        assert!(found.is_some(), "the report has no component {name}:\n{}", self.text);
        found.unwrap()
    }

    /// The reasons of its failure.
    pub(crate) fn reasons(&self) -> String {
        self.report["outcome"]["reasons"].to_string()
    }
}

/// A component with the task properties and others.
pub(crate) fn component(name: &str, class: &str, inside: &str) -> String {
    format!(
        "<component name=\"{name}\"><implementation.rust class=\"{class}\"/><property name=\"ID\">{name}</property>\
         <property name=\"period\">100</property>{inside}</component>\n"
    )
}

/// A property.
pub(crate) fn property(name: &str, value: &str) -> String {
    format!("<property name=\"{name}\">{value}</property>")
}

/// A composite of these components, from line 2 on.
pub(crate) fn composite(components: &str) -> String {
    format!(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:saoms=\"urn:saoms:1\" name=\"t\" targetNamespace=\"urn:t\">\n{components}</composite>\n"
    )
}

/// Runs the command in a folder.
pub(crate) fn saoms(folder: &Path, arguments: &[&str]) -> Run {
    // A component that is waited for in vain is a failure, not a test that never ends.
    let output = Command::new("timeout")
        .args(["60", PROGRAM])
        .args(arguments)
        .env_remove("SAOMS_PLUGIN_PATH")
        .current_dir(folder)
        .output()
        .unwrap();
    Run::of(&output, Value::Null)
}

/// Runs a fleet of these components, with these arguments more.
pub(crate) fn fleet(components: &str, libraries: &[PathBuf], more: &[&str]) -> Run {
    let folder = in_folder(components);
    let report = folder.path().join("report.json");
    let mut arguments = vec!["run", "t.composite", "--report", "report.json"];
    for library in libraries {
        arguments.extend(["--plugin", library.to_str().unwrap()]);
    }
    arguments.extend(more);
    let mut run = saoms(folder.path(), &arguments);
    if let Ok(text) = fs::read_to_string(report) {
        run.report = serde_json::from_str(&text).unwrap_or_default();
    }
    run
}

/// The same for a second of virtual time: ten executions of each component.
pub(crate) fn second(components: &str, libraries: &[PathBuf]) -> Run {
    fleet(components, libraries, &["--virtual", "--for", "950ms"])
}

/// A folder with the composite `t.composite`.
pub(crate) fn in_folder(components: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("t.composite"), composite(components)).unwrap();
    folder
}
