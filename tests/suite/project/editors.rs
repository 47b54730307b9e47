//! Files for editors: they are well-formed, and the commands that they start exist.

use std::fs;
use std::path::PathBuf;

use serde_json::Value;

use crate::support::{project, root, saoms, stdout};

fn extension() -> PathBuf {
    root().join("editors/vscode")
}

fn json(name: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(extension().join(name)).unwrap()).unwrap()
}

#[test]
fn every_file_that_the_extension_names_is_there() {
    let package = json("package.json");
    let contributed = &package["contributes"];
    assert!(extension().join(package["main"].as_str().unwrap()).exists());
    let language = &contributed["languages"][0];
    assert_eq!(language["extensions"][0], ".composite");
    let configuration = json(language["configuration"].as_str().unwrap());
    assert_eq!(configuration["comments"]["blockComment"][0], "<!--");
    let grammar = &contributed["grammars"][0];
    assert_eq!(grammar["language"], language["id"]);
    assert_eq!(json(grammar["path"].as_str().unwrap())["scopeName"], grammar["scopeName"]);
}

#[test]
fn what_the_extension_starts_and_offers_exists() {
    let package = json("package.json");
    let code = fs::read_to_string(extension().join("extension.js")).unwrap();
    let settings = package["contributes"]["configuration"]["properties"].as_object().unwrap();
    assert_eq!(settings["saoms.path"]["default"], env!("CARGO_PKG_NAME"));
    for name in settings.keys() {
        let short = name.strip_prefix("saoms.").unwrap();
        assert!(code.contains(&format!("get(\"{short}\"")), "the setting {name} is read");
    }
    for command in package["contributes"]["commands"].as_array().unwrap() {
        let name = command["command"].as_str().unwrap();
        assert!(code.contains(&format!("registerCommand(\"{name}\"")), "the command {name} is registered");
    }
    // The words in quotes that the program is started with.
    let line = code.split("return { command:").nth(1).unwrap().split("};").next().unwrap();
    assert!(line.contains("\"lsp\""), "{line}");
    let help = saoms(&["lsp", "--help"]);
    assert!(help.status.success());
    let help = stdout(&help);
    let options: Vec<&str> = code.split('"').filter(|part| part.starts_with("--")).collect();
    assert_eq!(options, ["--plugin", "--assume-classes", "--allow-outside"]);
    for option in options {
        assert!(help.contains(option), "`saoms lsp` knows {option}: {help}");
    }
}

#[test]
fn the_guide_starts_the_same_server() {
    let guide = project("docs/editors.md");
    for editor in ["cmd = { \"saoms\", \"lsp\" }", "command = \"saoms\"\nargs = [\"lsp\"]"] {
        assert!(guide.contains(editor), "{editor}");
    }
}
