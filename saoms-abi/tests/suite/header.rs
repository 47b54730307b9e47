//! `include/saoms.h` is what `src` says, and compiles wherever a C compiler is strict.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The header as the sources have it.
fn generated() -> String {
    let config = cbindgen::Config::from_file(root().join("cbindgen.toml")).unwrap();
    let mut sources: Vec<PathBuf> =
        fs::read_dir(root().join("src")).unwrap().map(|entry| entry.unwrap().path()).collect();
    sources.sort();
    let builder = cbindgen::Builder::new().with_config(config);
    let bindings = sources.iter().fold(builder, |builder, source| builder.with_src(source)).generate().unwrap();
    let mut text = Vec::new();
    bindings.write(&mut text);
    // The prefix is for types; names of constants are written in full.
    String::from_utf8(text).unwrap().replace("SaomsSAOMS_", "SAOMS_")
}

#[test]
fn the_header_is_that_of_the_sources() {
    let path = root().join("include/saoms.h");
    let generated = generated();
    if env::var_os("UPDATE_EXPECT").is_some() {
        fs::write(&path, &generated).unwrap();
    }
    let found = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        found == generated,
        "{} is not what `src` says any more; `UPDATE_EXPECT=1 cargo test -p saoms-abi --test suite header` writes it anew",
        path.display()
    );
}

/// A C or C++ compiler of the system, with all warnings as errors.
fn compiler(name: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(name);
    command.args(arguments).args(["-Wall", "-Wextra", "-Werror", "-pedantic", "-I"]).arg(root().join("include"));
    command
}

fn run(mut command: Command) -> String {
    let what = format!("{command:?}");
    match command.output() {
        Ok(output) => {
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{what}: {said}");
            String::from_utf8(output.stdout).unwrap()
        }
        Err(error) => {
            panic!("{what}: {error}; this test needs the C and C++ compilers of the system, `cc` and `c++`")
        }
    }
}

#[test]
fn the_headers_compile_alone_in_c_and_in_cpp() {
    let folder = tempfile::tempdir().unwrap();
    for header in ["saoms.h", "saoms_author.h"] {
        let source = folder.path().join("alone.c");
        // What a header leaves out is missed where it stands alone.
        fs::write(&source, format!("#include \"{header}\"\nSaomsStatus status = SaomsStatus_OK;\n")).unwrap();
        for (name, arguments) in [
            ("cc", &["-std=c99"] as &[&str]),
            ("cc", &["-std=c17"]),
            ("c++", &["-x", "c++", "-std=c++11"]),
            ("c++", &["-x", "c++", "-std=c++20"]),
        ] {
            let mut command = compiler(name, arguments);
            command.arg("-c").arg(&source).arg("-o").arg(folder.path().join("alone.o"));
            run(command);
        }
    }
}

#[test]
fn the_header_says_what_the_boundary_is() {
    let header = fs::read_to_string(root().join("include/saoms.h")).unwrap();
    for expected in
        [format!("section(\"{}\")", saoms_abi::SECTION), format!("#define SAOMS_ABI_VERSION {}\n", saoms_abi::VERSION)]
    {
        assert!(header.contains(&expected), "{expected}");
    }
    // Everything in it has a comment: no line begins a member, a type or a function without one above.
    let lines: Vec<&str> = header.lines().collect();
    let is_bare = |place: usize| {
        let line = lines[place];
        let is_member = line.starts_with("    ") && !line.starts_with("     ") && !line.trim_start().starts_with("//");
        (line.starts_with("typedef ") || is_member) && !lines[place - 1].trim_start().starts_with("//")
    };
    let bare: Vec<&str> = (1..lines.len()).filter(|place| is_bare(*place)).map(|place| lines[place]).collect();
    assert!(bare.is_empty(), "without a comment: {bare:#?}");
}
