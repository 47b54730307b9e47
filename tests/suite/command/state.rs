//! `saoms run --state`: what outlives the program.

use std::ffi::CString;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::process::Stdio;
use std::thread::sleep;
use std::time::Duration;

use crate::support::{answer, command, empty_folder, saoms_in, text};

/// Four robots that cross each other's way all the time, fast, and a zone.
pub(super) fn crossing() -> String {
    let component = |id: &str, class: &str, more: &str| {
        format!(
            r#"<component name="{id}"><implementation.rust class="saoms.{class}"/>
        <property name="ID">{id}</property><property name="period">10</property>{more}</component>
"#
        )
    };
    let property = |name: &str, value: &str| format!(r#"<property name="{name}">{value}</property>"#);
    let world = r#"<reference name="world" target="World"/>"#;
    let fast = property("moveTime", "15ms") + &property("handlingTime", "20ms");
    let map = property("width", "6") + &property("height", "6");
    let mut components = component("World", "World", &(fast + &map));
    components += &component("Zone", "Zone", world);
    components += &component("Master", "MasterEnvironment", "");
    components += &component("MasterRobot", "MasterRobot", "");
    let scenario = property("scenario", "at 0.1s 80 times luggage random to random");
    components += &component("Environment", "Environment", &scenario);
    for (robot, x, y) in [("Robot1", "0", "0"), ("Robot2", "5", "0"), ("Robot3", "0", "5"), ("Robot4", "5", "5")] {
        let place = property("chargeX", x) + &property("chargeY", y) + &property("discharge", "0.01");
        components += &component(robot, "Robot", &(place + world));
    }
    format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="f" targetNamespace="urn:f">
{components}</composite>"#
    )
}

#[test]
fn a_fleet_that_is_killed_goes_on_with_its_grants() {
    let folder = empty_folder("state-killed");
    fs::write(folder.join("f.composite"), crossing()).unwrap();
    let arguments = ["run", "f.composite", "--state", "state", "--invariants", "--control", "none"];
    for milliseconds in [150, 320, 610, 470, 240, 700] {
        let mut run = command(&arguments);
        let mut run = run.current_dir(&folder).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        sleep(Duration::from_millis(milliseconds));
        assert_eq!(run.try_wait().unwrap(), None, "it still runs");
        run.kill().unwrap();
        run.wait().unwrap();
    }
    let output = saoms_in(&folder, &arguments);
    let told = text(&output);
    assert_eq!(output.status.code(), Some(0), "{told}");
    assert!(told.contains("80 of 80 pieces of luggage delivered, no collision"), "{told}");
    assert!(!told.contains("warning: robot") && !told.contains("grants nothing"), "{told}");
    // The zone knows its grants, and nobody else has kept anything.
    let fleet = crossing().replace(r#"name="Zone""#, r#"name="Other""#);
    fs::write(folder.join("f.composite"), fleet).unwrap();
    let told = text(&saoms_in(&folder, &[&arguments[..], &["--for", "50ms"]].concat()));
    let unused = "the state folder has what `Zone` kept, and the fleet has no such component: it stays there";
    assert!(told.contains(unused), "{told}");
}

#[test]
fn a_folder_that_is_removed_while_the_fleet_runs_is_noticed() {
    let folder = empty_folder("state-removed");
    fs::write(folder.join("f.composite"), crossing()).unwrap();
    let mut run = command(&["run", "f.composite", "--state", "state", "--control", "none", "--for", "3s"]);
    let run = run.current_dir(&folder).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    while fs::metadata(folder.join("state/store.log")).map_or(0, |about| about.len()) < 500 {
        sleep(Duration::from_millis(5));
    }
    fs::rename(folder.join("state"), folder.join("away")).unwrap();
    let output = run.wait_with_output().unwrap();
    let told = text(&output);
    assert_eq!(output.status.code(), Some(1), "{told}");
    let why = "the state folder cannot be written: `state/store.log` is not there any more, or is another file";
    assert!(told.contains(why), "{told}");
}

#[test]
fn a_state_that_cannot_be_used_is_refused_before_the_start() {
    let folder = empty_folder("state-refused");
    fs::write(folder.join("f.composite"), crossing()).unwrap();
    fs::create_dir(folder.join("other")).unwrap();
    fs::write(folder.join("other/notes.txt"), "x").unwrap();
    let refused = |arguments: &[&str]| {
        let (code, out, err) = answer(&saoms_in(&folder, &[&["run", "f.composite"], arguments].concat()));
        assert_eq!((code, out.as_str()), (2, ""), "{err}");
        assert!(err.ends_with("\n\n1 error: nothing was started\n"), "{err}");
        err.lines().next().unwrap().to_owned()
    };
    let mut told = vec![
        refused(&["--state", "state", "--virtual"]),
        refused(&["--state", "other"]),
        refused(&["--state", "other/notes.txt"]),
        refused(&["--state", "state", "--log", "state/store.log"]),
        refused(&["--state", "one", "--report", "./one"]),
        refused(&["--state", "one/", "--control", "one"]),
    ];
    assert!(!folder.join("one").exists());
    fs::create_dir(folder.join("pipe")).unwrap();
    for name in ["store.log", "store.new", "lock"] {
        let pipe = folder.join("pipe").join(name);
        let path = CString::new(pipe.as_os_str().as_bytes()).unwrap();
        // SAFETY: the path is a C text that lives as long as the call.
        assert_eq!(unsafe { libc::mkfifo(path.as_ptr(), 0o600) }, 0);
        told.push(refused(&["--state", "pipe"]));
        fs::remove_file(pipe).unwrap();
    }
    let log = folder.join("state/store.log");
    let groups = |bytes: &[u8]| bytes.windows(4).filter(|window| window == b"grp\n").count();
    let mut bytes = Vec::new();
    // The last group may be torn: something is damaged where another one follows. A slow machine writes few in a run.
    for _ in 0..20 {
        saoms_in(&folder, &["run", "f.composite", "--state", "state", "--for", "200ms"]);
        bytes = fs::read(&log).unwrap();
        if groups(&bytes) > 1 {
            break;
        }
    }
    // Behind the first line, the header of the first group, and the length of the first name.
    bytes[14 + 24 + 4] ^= 1;
    fs::write(&log, &bytes).unwrap();
    let damaged = refused(&["--state", "state"]);
    let (before, after) = damaged.split_once("byte ").unwrap();
    told.push(format!("{before}byte N{}", after.trim_start_matches(|character: char| character.is_ascii_digit())));
    bytes[12] = b'7';
    fs::write(&log, &bytes).unwrap();
    told.push(refused(&["--state", "state"]));
    expect_test::expect![[r#"
        error: `--state` keeps what a fleet does in real time, and `--virtual` begins anew each time: leave one of them out
        error: the state of `--state` cannot be used: the folder `other` has files, but no state of a fleet: name an empty folder, or one that does not exist
        error: the state of `--state` cannot be used: `other/notes.txt` cannot be made: File exists (os error 17)
        error: the log cannot be written to `state/store.log`, which is an input
        error: `--report` and `--state` both name `one`, which `--state` makes a folder: give `--report` another path
        error: `--control` and `--state` both name `one/`, which `--state` makes a folder: give `--control` another path
        error: the state of `--state` cannot be used: `pipe/store.log` is no regular file: remove it, or name another folder
        error: the state of `--state` cannot be used: the folder `pipe` has files, but no state of a fleet: name an empty folder, or one that does not exist
        error: the state of `--state` cannot be used: `pipe/lock` is no regular file: remove it, or name another folder
        error: the state of `--state` cannot be used: `state/store.log` is damaged: what stands at byte N is not what was written there, and more follows it; restore the folder from a backup, or name another one: the fleet begins without its state then
        error: the state of `--state` cannot be used: `state/store.log` is of another version (`saoms-store 7`): run the version of SAOMS that wrote it, or name another folder"#]]
    .assert_eq(&told.join("\n"));
}
