//! `saoms fmt` as a user meets it: real files, standard input, exit codes.

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;

use tempfile::{TempDir, tempdir};

use crate::support::{answer, root, saoms_with};

const WRONG_LAYOUT: &str = "<a><!-- why -->\n<b  c='1' d='' ></b></a>";
const RIGHT_LAYOUT: &str = "<a> <!-- why -->\n  <b c=\"1\" d=\"\"/>\n</a>\n";

/// Runs `saoms fmt` in a folder.
fn fmt(folder: &Path, arguments: &[&str], input: &[u8]) -> (i32, String, String) {
    answer(&saoms_with(folder, &[&["fmt"], arguments].concat(), input))
}

fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempdir().unwrap();
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

#[test]
fn a_folder_stands_for_all_composites_in_it_and_below() {
    let folder = folder(&[("b.composite", WRONG_LAYOUT), ("a.composite", WRONG_LAYOUT), ("c.xml", WRONG_LAYOUT)]);
    let at = |name: &str| folder.path().join(name);
    for name in ["z/inner", "own", ".hidden", "target", "none"] {
        fs::create_dir_all(at(name)).unwrap();
    }
    for name in [
        "z/inner/one.composite", "own/sca-contribution.xml", "own/two.composite", ".hidden/x.composite",
        "target/x.composite",
    ] {
        fs::write(at(name), WRONG_LAYOUT).unwrap();
    }
    let listed = "./a.composite\n./b.composite\n./own/two.composite\n./z/inner/one.composite\n";
    assert_eq!(fmt(folder.path(), &["--check", "."], b""), (1, listed.to_owned(), String::new()));
    let twice = fmt(folder.path(), &["--check", "z", "z/inner/one.composite"], b"");
    assert_eq!((twice.0, twice.1.as_str()), (1, "z/inner/one.composite\n"), "each file once");
    let (code, _, told) = fmt(folder.path(), &["none", "z"], b"");
    assert_eq!(code, 2);
    assert!(told.starts_with("error[S0002]: the folder contains no composites\n--> none\n"), "{told}");
    assert_eq!(
        fs::read_to_string(at("z/inner/one.composite")).unwrap(),
        RIGHT_LAYOUT,
        "the others are formatted all the same"
    );
    assert_eq!(fmt(folder.path(), &["."], b""), (0, String::new(), String::new()));
    assert_eq!(fmt(folder.path(), &["--check", "."], b""), (0, String::new(), String::new()));
    assert_eq!(fs::read_to_string(at("own/two.composite")).unwrap(), RIGHT_LAYOUT);
    for passed_over in ["c.xml", ".hidden/x.composite", "target/x.composite", "own/sca-contribution.xml"] {
        assert_eq!(fs::read_to_string(at(passed_over)).unwrap(), WRONG_LAYOUT, "{passed_over}");
    }
}

#[test]
fn files_are_replaced_whole_with_their_permissions_and_links() {
    let folder = folder(&[("a", WRONG_LAYOUT)]);
    let path = folder.path().join("a");
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
    symlink("a", folder.path().join("link")).unwrap();
    assert_eq!(fmt(folder.path(), &["link"], b""), (0, String::new(), String::new()));
    assert_eq!(fs::read_to_string(&path).unwrap(), RIGHT_LAYOUT);
    assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
    assert!(fs::symlink_metadata(folder.path().join("link")).unwrap().is_symlink());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2, "nothing else is left");
    let before = fs::metadata(&path).unwrap().modified().unwrap();
    assert_eq!(fmt(folder.path(), &["a"], b"").0, 0);
    assert_eq!(fs::metadata(&path).unwrap().modified().unwrap(), before, "what is formatted is not written");
}

#[test]
fn check_lists_what_is_not_formatted_and_writes_nothing() {
    let folder = folder(&[("a", RIGHT_LAYOUT), ("b", WRONG_LAYOUT), ("c", WRONG_LAYOUT)]);
    let checked = fmt(folder.path(), &["--check", "a", "b", "c", "-"], WRONG_LAYOUT.as_bytes());
    assert_eq!(checked, (1, "b\nc\n-\n".to_owned(), String::new()));
    assert_eq!(fs::read_to_string(folder.path().join("b")).unwrap(), WRONG_LAYOUT);
    assert_eq!(fmt(folder.path(), &["--check", "a"], b""), (0, String::new(), String::new()));
    assert_eq!(fmt(folder.path(), &["--check", "a", "--width", "8"], b"").1, "a\n");
}

#[test]
fn standard_input_is_formatted_to_standard_output() {
    let folder = folder(&[]);
    let formatted = (0, RIGHT_LAYOUT.to_owned(), String::new());
    assert_eq!(fmt(folder.path(), &["-"], WRONG_LAYOUT.as_bytes()), formatted);
    let (code, out, error) = fmt(folder.path(), &["-"], b"<a>\n<b></a>");
    assert_eq!((code, out.as_str()), (2, ""));
    assert!(error.contains("error[S0102]") && error.contains("<stdin>:2:4"), "{error}");
}

#[test]
fn what_is_no_xml_stays_and_the_others_are_formatted() {
    let folder = folder(&[("wrong", "<a></b>"), ("right", WRONG_LAYOUT)]);
    fs::write(folder.path().join("latin"), b"<a>\xe9</a>").unwrap();
    let (code, out, error) = fmt(folder.path(), &["wrong", "latin", "missing", "right"], b"");
    assert_eq!((code, out.as_str()), (2, ""));
    for expected in ["error[S0102]", "wrong:1:4", "error[S0007]", "error[S0001]"] {
        assert!(error.contains(expected), "{expected}: {error}");
    }
    assert_eq!(fs::read_to_string(folder.path().join("wrong")).unwrap(), "<a></b>");
    assert_eq!(fs::read(folder.path().join("latin")).unwrap(), b"<a>\xe9</a>");
    assert_eq!(fs::read_to_string(folder.path().join("right")).unwrap(), RIGHT_LAYOUT);
}

/// The composites of the manual stand as they are printed there, some in a layout of their own.
#[test]
fn shipped_composites_are_formatted() {
    let root = root();
    let paths = fs::read_dir(root.join("composites")).unwrap().map(|entry| entry.unwrap().path());
    let composites = paths.filter(|path| path.extension().is_some_and(|ending| ending == "composite"));
    let paths: Vec<_> = composites.map(|path| path.display().to_string()).collect();
    let arguments: Vec<&str> = ["--check"].into_iter().chain(paths.iter().map(String::as_str)).collect();
    assert!(arguments.len() > 2);
    assert_eq!(fmt(root, &arguments, b""), (0, String::new(), String::new()));
}
