//! A fleet that is reached over the network.

use std::fs;
use std::os::unix::fs::PermissionsExt;

use serde_json::Value;

use super::{Running, fleet};
use crate::support::{code, text};

#[test]
fn commands_reach_a_fleet_at_its_address_with_its_token() {
    let running = Running::start(&fleet(), &["--stay", "--serve", "127.0.0.1:0"]);
    let listed: Value = serde_json::from_str(&running.told(&["ps", "--format", "json"])).unwrap();
    let (url, file) = (listed[0]["url"].as_str().unwrap(), listed[0]["token_file"].as_str().unwrap());
    assert_eq!(format!("{}.token", listed[0]["socket"].as_str().unwrap()), file);
    assert_eq!(fs::metadata(file).unwrap().permissions().mode() & 0o777, 0o600);
    let token = fs::read_to_string(file).unwrap().trim().to_owned();
    let view = listed[0]["view_token_file"].as_str().unwrap();
    assert_eq!(fs::metadata(view).unwrap().permissions().mode() & 0o777, 0o600);
    let to_view = ["--fleet", url, "--token-file", view];
    assert!(running.told(&[&["status"][..], &to_view].concat()).contains("Robot1"));
    let forbidden = running.refused(&[&["send", "luggage (0,0) to (1,0)"][..], &to_view].concat());
    assert!(forbidden.contains("the right to view"), "{forbidden}");

    let refused = running.refused(&["status", "--fleet", url]);
    assert!(refused.contains("--token-file") && refused.contains("SAOMS_TOKEN_FILE"), "{refused}");
    let there = ["--fleet", url, "--token-file", file];
    let sent = running.told(&[&["send", "luggage (0,0) to (1,0)"][..], &there].concat());
    assert_eq!(sent, "1 event accepted\n");
    let output = crate::support::command(&["status", "--fleet", url])
        .current_dir(running.folder())
        .env("SAOMS_TOKEN_FILE", file)
        .output()
        .unwrap();
    assert!(text(&output).contains("Robot1"), "{}", text(&output));

    fs::write(running.folder().join("wrong"), "0123456789abcdef").unwrap();
    let wrong = ["status", "--fleet", url, "--token-file", "wrong"];
    fs::set_permissions(running.folder().join("wrong"), fs::Permissions::from_mode(0o644)).unwrap();
    assert!(running.refused(&wrong).contains("chmod 600"));
    fs::set_permissions(running.folder().join("wrong"), fs::Permissions::from_mode(0o600)).unwrap();
    assert!(running.refused(&wrong).contains("the token is missing or wrong"));

    // Neither the list of processes nor the log has it.
    let pid = listed[0]["pid"].as_u64().unwrap();
    let command = fs::read(format!("/proc/{pid}/cmdline")).unwrap();
    assert!(!String::from_utf8_lossy(&command).contains(&token));
    running.told(&[&["down"][..], &there].concat());
    let (file, view) = (file.to_owned(), view.to_owned());
    let mut running = running;
    let (code, printed) = running.wait();
    assert_eq!(code, Some(0), "{printed}");
    assert!(printed.contains(url) && printed.contains(&file) && !printed.contains(&token), "{printed}");
    for file in [file, view] {
        assert!(!std::path::Path::new(&file).exists(), "the tokens end with the fleet");
    }
}

#[test]
fn a_file_of_the_user_holds_the_token() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("secret");
    fs::write(&file, "correct-horse-battery-staple\n").unwrap();
    fs::set_permissions(&file, fs::Permissions::from_mode(0o600)).unwrap();
    let file = file.to_str().unwrap();
    let running = Running::start(&fleet(), &["--stay", "--serve", "localhost:0", "--token-file", file]);
    let listed: Value = serde_json::from_str(&running.told(&["ps", "--format", "json"])).unwrap();
    let url = listed[0]["url"].as_str().unwrap();
    running.told(&["down", "--fleet", url, "--token-file", file]);
    let (code, printed) = running.end();
    assert_eq!(code, Some(0), "{printed}");
    assert!(fs::exists(file).unwrap(), "it is the user's");
}

#[test]
fn an_address_or_token_that_cannot_be_used_starts_nothing() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("fleet.composite"), fleet()).unwrap();
    fs::write(folder.path().join("open"), "0123456789abcdef").unwrap();
    fs::set_permissions(folder.path().join("open"), fs::Permissions::from_mode(0o644)).unwrap();
    let refused = |arguments: &[&str]| {
        let all = [&["run", "fleet.composite"], arguments].concat();
        let mut run = crate::support::command(&all);
        let output = run.current_dir(folder.path()).env("XDG_RUNTIME_DIR", folder.path()).output().unwrap();
        assert_eq!(code(&output), 2, "{}", text(&output));
        text(&output)
    };
    let outer = refused(&["--serve", "0.0.0.0:0"]);
    assert!(outer.contains("nothing is encrypted") && outer.contains("--serve-unencrypted"), "{outer}");
    assert!(refused(&["--serve", "8080"]).contains("expected an address and a port"));
    assert!(refused(&["--serve", "127.0.0.1:0", "--token-file", "open"]).contains("chmod 600"));
    assert!(refused(&["--serve", "127.0.0.1:0", "--token-file", "none"]).contains("--token-file none"));
    assert!(refused(&["--serve", "127.0.0.1:0", "--view-token-file", "none"]).contains("--view-token-file none"));
    fs::set_permissions(folder.path().join("open"), fs::Permissions::from_mode(0o600)).unwrap();
    let same = refused(&["--serve", "127.0.0.1:0", "--token-file", "open", "--view-token-file", "open"]);
    assert!(same.contains("--view-token-file open") && same.contains("another token"), "{same}");
    let left: Vec<_> = fs::read_dir(folder.path().join("saoms")).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert!(left.is_empty(), "{left:?}");
}
