//! `saoms_author.h` writes messages as Rust does.

use std::path::Path;
use std::process::Command;

use saoms_api::Message;
use saoms_api::host::cdr;

#[derive(Clone, Debug, PartialEq, Message)]
struct Sample {
    small: u8,
    negative: i32,
    flag: bool,
    half: f64,
    text: String,
    two: u16,
    float: f32,
    least: i64,
}

#[test]
fn the_bytes_of_messages_are_those_of_rust() {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("author");
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let output = Command::new("cc")
        .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-I"])
        .arg(root.join("../saoms-abi/include"))
        .arg(root.join("tests/author.c"))
        .arg("-o")
        .arg(&program)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let sample = Sample {
        small: 7,
        negative: -2,
        flag: true,
        half: 0.5,
        text: "café".to_owned(),
        two: 513,
        float: -1.25,
        least: i64::MIN,
    };
    let bytes: String = cdr::encode(&sample).iter().map(|byte| format!("{byte:02x}")).collect();
    let written = Command::new(program).output().unwrap();
    assert_eq!(String::from_utf8(written.stdout).unwrap().trim(), bytes);
}
