use std::fs;
use std::path::Path;

use super::shown;
use crate::diagnostic::Diagnostics;
use crate::load::{MAX_SIZE, read};
use crate::source::Sources;

/// The diagnostics of `read` for a file of these bytes.
fn reading(bytes: &[u8], max_size: u64) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("f.composite");
    fs::write(&path, bytes).unwrap();
    read_shown(&path, max_size).replace(&*folder.path().to_string_lossy(), "DIR")
}

fn read_shown(path: &Path, max_size: u64) -> String {
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let file = read(path, max_size, &mut sources, &mut diagnostics);
    assert_eq!(file.is_none(), diagnostics.has_errors());
    assert_eq!(sources.iter().count(), 1);
    let help: Vec<String> = diagnostics.iter().flat_map(|one| one.help.clone()).collect();
    format!("{}{}", shown(&sources, diagnostics), help.join("\n"))
}

#[test]
fn a_file_that_is_no_text_is_told_what_it_is() {
    let says = |bytes: &[u8], expected: &str| assert_eq!(reading(bytes, MAX_SIZE), expected);
    says(b"<a/>", "");
    says(b"\xef\xbb\xbf<a/>", "");
    says(b"<?xml version='1.0' encoding='ISO-8859-1'?><a/>", "");
    let empty = "1:1 [] error S0005 the file is empty\n\
        write at least `<composite xmlns=\"...\" name=\"...\" targetNamespace=\"...\"/>`";
    says(b"", empty);
    assert!(reading(b" \r\n\t", MAX_SIZE).contains("the file is empty"));
    assert!(reading(b"\xef\xbb\xbf", MAX_SIZE).contains("the file is empty"));
    says(b"<a>\0</a>", "1:1 [] error S0006 the file is binary: byte 3 is zero\na composite is an XML text in UTF-8");
    says(
        b"PK\x03\x04....",
        "1:1 [] error S0006 the file is a ZIP or JAR archive, not XML text\na composite is an XML text in UTF-8",
    );
    let utf16: Vec<u8> = "\u{feff}<a/>".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let converted = "convert it: `iconv -f UTF-16LE -t UTF-8 DIR/f.composite`";
    says(&utf16, &format!("1:1 [] error S0007 the file is in UTF-16LE, expected UTF-8\n{converted}"));
    says(&utf16[2..], &format!("1:1 [] error S0007 the file is in UTF-16LE, expected UTF-8\n{converted}"));
    assert!(reading(b"\xfe\xff\0<\0a", MAX_SIZE).contains("UTF-16BE"));
    assert!(reading(b"\0\0\0<\0\0\0a", MAX_SIZE).contains("UTF-32BE"));
    says(
        b"<?xml version='1.0' encoding = \"ISO-8859-1\"?>\n<a>caf\xe9</a>",
        "2:7 [\u{fffd}] error S0007 the XML declaration says `ISO-8859-1`, expected UTF-8\n\
         convert it: `iconv -f ISO-8859-1 -t UTF-8 DIR/f.composite`; until then the file cannot be checked",
    );
    says(
        b"<a>caf\xe9</a>",
        "1:7 [\u{fffd}] error S0007 the byte 0xE9 is not valid UTF-8\n\
         if the file is in Windows-1252 or Latin-1, convert it: `iconv -f WINDOWS-1252 -t UTF-8 DIR/f.composite`; until then the file cannot be checked",
    );
}

#[test]
fn a_file_past_the_limit_is_not_read() {
    let expected =
        "1:1 [] error S0004 the file has 5 bytes, and the limit is 4 bytes\nthe limit is set with `--max-size`";
    assert_eq!(reading(b"<aa/>", 4), expected);
    assert_eq!(reading(b"<aa/>", 5), "");
    assert!(read_shown(Path::new("/dev/zero"), 1000).contains("S0004"), "a device has no length");
}

#[test]
fn a_file_that_is_not_there_has_neighbours() {
    let folder = tempfile::tempdir().unwrap();
    let shown = |name: &str| {
        let said = read_shown(&folder.path().join(name), MAX_SIZE);
        said.replace(&*folder.path().to_string_lossy(), "DIR")
    };
    assert_eq!(shown("airport.composite"), "1:1 [] error S0001 there is no such file\n");
    for name in ["airport.composite", "airport2.composite", "notes.txt"] {
        fs::write(folder.path().join(name), "x").unwrap();
    }
    fs::create_dir(folder.path().join("sub")).unwrap();
    let missing = "1:1 [] error S0001 there is no such file\n";
    assert_eq!(
        shown("airprot.composite"),
        format!("{missing}there is `DIR/airport.composite`, `DIR/airport2.composite`")
    );
    assert_eq!(shown("notes"), format!("{missing}there is `DIR/notes.txt`"));
    assert_eq!(shown("airport.xml"), format!("{missing}there is `DIR/airport.composite`"));
    assert_eq!(shown("xyz"), format!("{missing}the folder contains `DIR/airport.composite`, `DIR/airport2.composite`"));
    assert_eq!(shown("sup/a"), format!("{missing}there is no folder `DIR/sup`"));
    assert_eq!(shown("notes.txt/a"), format!("{missing}a part of its path is a file, not a folder"));
    let directory = "1:1 [] error S0002 found a folder, expected a file\n";
    assert_eq!(shown("sub"), directory);
    assert_eq!(shown(""), format!("{directory}the folder contains `DIR/airport.composite`, `DIR/airport2.composite`"));
}

#[test]
fn a_file_that_may_not_be_read_says_so() {
    // Root may read everything; a file whose name is too long cannot be read at all.
    let said = read_shown(Path::new(&"x".repeat(5000)), MAX_SIZE);
    assert!(said.contains("S0003 the file cannot be read: "), "{said}");
}
