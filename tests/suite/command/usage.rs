//! The command as a user meets it: real processes, real files, exit codes.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::Stdio;

use serde_json::Value;

use crate::support::{code, command, empty_folder, saoms, stderr, stdout};

fn file(folder: &Path, name: &str, text: impl AsRef<[u8]>) -> String {
    let path = folder.join(name);
    fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn whoever_names_a_composite_alone_is_told_how_to_run_it() {
    let output = saoms(&["composites/hall.composite"]);
    assert_eq!(code(&output), 2);
    assert!(stderr(&output).contains("write `saoms run composites/hall.composite`"), "{}", stderr(&output));
    assert!(!stderr(&saoms(&["runn"])).contains("write `saoms run"));
}

#[test]
fn an_option_or_a_command_in_another_form_is_told_the_right_one() {
    let hall = "composites/hall.composite";
    for (arguments, tip) in [
        (&["--check", hall][..], "did you mean the command `saoms check`?"),
        (&["run", hall, "virtual"], "write `--virtual` for the option"),
        (&["run", hall, "—virtual"], "write `--virtual` for the option"),
        (&["run", hall, "–-virtual"], "write `--virtual` for the option"),
        (&["check", hall, "—wiring"], "write `--wiring` for the option"),
        (&["help", "chek"], "'check'"),
        (&["validate", hall], "'check'"),
        (&["launch", hall], "'run'"),
        (&["sim", hall], "'simulate'"),
        (&["init"], "'new'"),
        (&["version"], "`saoms --version` prints the version"),
        (&["nowhere.composite"], "to run a composite, write `saoms run nowhere.composite`"),
        (&["check", hall, "--json"], "'--format'"),
        (&["run", hall, "--verbose"], "'--log-level'"),
        (&["run", hall, "--param", "robots=3"], "'--set'"),
        (&["check", hall, "robots=3"], "there is no such file; write `--set robots=3`"),
        (&["graph", hall, "hall.svg"], "there is no such file; write `--output hall.svg`"),
        (
            &["run", "--virtual", "--report", hall],
            "tip: `composites/hall.composite` was taken as the value of `--report`: write that value, and the composite",
        ),
        (&["run", "--journal", "nowhere.composite"], "`nowhere.composite` was taken as the value of `--journal`"),
        (&["run", hall, "--for", "1m30s"], "units ns, us, ms, s, min, h; write `90s`"),
        (&["run", hall, "--for", "00:01:00"], "; write `60s`"),
        (&["new", "."], "tip: say what to make: `saoms new site my-site` is a small fleet"),
        (&["new", "x.composite"], "`saoms new composite x.composite` a single composite"),
        (&["new", "fleet"], "`saoms new site my-site`"),
        (&["new", "loop"], "a loop is made in a plugin: write `saoms new plugin my-loop`"),
        (&["new", "sit"], "'site'"),
        (&["new", "site", "."], "found `.`, expected the folder to make"),
        (&["new", "site", "Cargo.toml"], "`Cargo.toml` is a file, expected the folder to make"),
        (&["new", "composite", "."], "found `.`, expected the file to make, such as `hall.composite`"),
        (&["explain", "error[S2011]"], "did you mean `S2011`?"),
    ] {
        let output = saoms(arguments);
        assert_eq!(code(&output), 2, "{arguments:?}");
        assert!(stderr(&output).contains(tip), "{arguments:?}: {}", stderr(&output));
    }
    let output = saoms(&["check", hall, "lost.composite"]);
    assert!(stderr(&output).contains("S0001") && !stderr(&output).contains("option"), "{}", stderr(&output));
}

#[test]
fn what_happens_stands_in_one_column_however_long_the_names() {
    let shown = stdout(&saoms(&["run", "composites/airport.composite", "--virtual"]));
    // When, who, what: where what begins.
    let start = |line: &str| {
        let who = line.trim_start().split_once(" s  ").unwrap().1;
        let what = who.split_once(' ').unwrap().1.trim_start();
        line.len() - what.len()
    };
    let starts: std::collections::BTreeSet<usize> =
        shown.lines().take_while(|line| !line.is_empty()).map(start).collect();
    assert_eq!(starts.len(), 1, "{shown}");
}

/// A fleet of one robot that runs until it is stopped.
const ONE_ROBOT: &str = r#"<composite xmlns="http://www.osoa.org/xmlns/sca/1.0" name="one" targetNamespace="urn:one">
  <component name="Robot001">
    <implementation.java class="robot.Robot001"/>
    <property name="ID">Robot001</property>
    <property name="period">20</property>
  </component>
</composite>
"#;

#[test]
fn the_airport_delivers_everything_and_ends_by_itself() {
    let folder = empty_folder("airport");
    let report = folder.join("report.json");
    let arguments =
        ["run", "composites/airport.composite", "--virtual", "--seed", "7", "--report", report.to_str().unwrap()];
    let output = saoms(&arguments);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert!(stdout(&output).contains("14 of 14 pieces of luggage delivered, no collision, 0 stranded"));
    let first: Value = serde_json::from_slice(&fs::read(&report).unwrap()).unwrap();
    assert_eq!(first["seed"], 7);
    assert_eq!(
        first["luggage"],
        serde_json::json!({"delivered": 14, "requested": 14, "open": 0, "given_up": 0, "ignored": 0})
    );
    assert_eq!(first["collisions"], serde_json::json!({"swap": 0, "vertex": 0}));
    assert_eq!(first["stranded"], 0);
    assert!(first["time_s"].as_f64().unwrap() > 0.0 && first["periods"].as_u64().unwrap() > 0);
    for component in first["components"].as_array().unwrap() {
        for field in ["name", "executions", "missed", "late_us", "restarts", "dropped"] {
            assert!(!component[field].is_null(), "{field} of {component}");
        }
    }
    assert_eq!(code(&saoms(&arguments)), 0);
    let second: Value = serde_json::from_slice(&fs::read(&report).unwrap()).unwrap();
    assert_eq!(first["trace_hash"], second["trace_hash"]);
    assert_eq!(first["trace_hash"].as_str().unwrap().len(), 16);
}

#[test]
fn two_robots_deliver_in_real_time_too() {
    let output = saoms(&["run", "tests/fleets/pair.composite", "--set", "period=20", "--quiet", "--report", "-"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let report: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(report["luggage"]["delivered"], 4);
    assert_eq!(report["trace_hash"], Value::Null);
}

#[test]
fn the_time_given_ends_a_run_with_work_left() {
    let output =
        saoms(&["run", "composites/airport.composite", "--virtual", "--for", "1s", "--report", "-", "--quiet"]);
    assert_eq!(code(&output), 0);
    let report: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(report["outcome"]["status"], "elapsed");
    assert_eq!(report["time_s"], 1.0);
}

#[test]
fn ctrl_c_ends_through_shutdown_and_still_reports() {
    let folder = empty_folder("interrupt");
    let fleet = file(&folder, "one.composite", ONE_ROBOT);
    let (report, picture) = (folder.join("report.json"), folder.join("paths.svg"));
    let mut child = command(&["run", &fleet, "--console", "classic"])
        .arg("--report")
        .arg(&report)
        .arg("--paths")
        .arg(&picture)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    assert!(lines.any(|line| line.unwrap().contains("Execution 1 of Robot001")), "the robot never ran");
    let rest = std::thread::spawn(move || lines.for_each(drop));
    let pid = i32::try_from(child.id()).unwrap();
    // SAFETY: `kill` takes no pointers; the process is our own child, not yet waited for.
    assert_eq!(unsafe { libc::kill(pid, libc::SIGINT) }, 0);
    assert_eq!(child.wait().unwrap().code(), Some(130));
    rest.join().unwrap();
    let report: Value = serde_json::from_slice(&fs::read(&report).unwrap()).unwrap();
    assert_eq!(report["outcome"]["status"], "interrupted");
    assert!(report["components"][0]["executions"].as_u64().unwrap() >= 2);
    assert!(fs::read_to_string(picture).unwrap().contains(">interrupted after "));
}

/// Five hours west of Greenwich, or as the manual's figures have it.
#[test]
fn the_classic_console_shows_local_time_or_that_of_the_figures() {
    let fleet = file(&empty_folder("date"), "one.composite", ONE_ROBOT);
    let first = |arguments: &[&str]| {
        let arguments = [&["run", &fleet, "--for", "50ms", "--console", "classic"], arguments].concat();
        let shown = stdout(&command(&arguments).env("TZ", "EST5").output().unwrap());
        shown.lines().find(|line| line.starts_with("Execution 0 of")).unwrap().to_owned()
    };
    assert_eq!(first(&["--virtual"]), "Execution 0 of Robot001 starts at 2015-01-23 14:32:35.0");
    let zone_now = || {
        let utc = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap();
        saoms_components::console::Timestamp(utc - std::time::Duration::from_secs(5 * 3600)).to_string()
    };
    // What sorts as text: dates to the second.
    let second = |date: &str| date.split('.').next().unwrap().to_owned();
    let (before, shown, after) = (zone_now(), first(&[]), zone_now());
    let shown = second(shown.strip_prefix("Execution 0 of Robot001 starts at ").unwrap());
    assert!(second(&before) <= shown && shown <= second(&after), "{before} {shown} {after}");
}

/// Nobody reads what the fleet says, so that it cannot end by itself once it was asked to.
#[test]
fn a_second_ctrl_c_ends_at_once() {
    let fleet = file(&empty_folder("twice"), "one.composite", ONE_ROBOT);
    let mut child = command(&["run", &fleet, "--virtual", "--console", "classic"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut unread = child.stdout.take().unwrap();
    unread.read_exact(&mut [0; 1000]).unwrap();
    let pid = i32::try_from(child.id()).unwrap();
    let deadline = std::time::Instant::now() + std::time::Duration::from_secs(30);
    let status = loop {
        // SAFETY: `kill` takes no pointers; the process is our own child, not yet waited for.
        assert_eq!(unsafe { libc::kill(pid, libc::SIGINT) }, 0);
        std::thread::sleep(std::time::Duration::from_millis(200));
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        assert!(std::time::Instant::now() < deadline, "it is still there");
    };
    assert_eq!(status.code(), Some(130));
    drop(unread);
}

#[test]
fn virtual_time_that_nothing_ends_says_so() {
    let fleet = file(&empty_folder("endless"), "one.composite", ONE_ROBOT);
    let mut child = command(&["run", &fleet, "--virtual"]).stdout(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let told = lines.any(|line| line.unwrap().contains("virtual time continues until Ctrl-C"));
    let pid = i32::try_from(child.id()).unwrap();
    // SAFETY: `kill` takes no pointers; the process is our own child, not yet waited for.
    assert_eq!(unsafe { libc::kill(pid, libc::SIGINT) }, 0);
    lines.for_each(drop);
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(told, "it ended without a word");
}

/// Each text is wrong in one way; the diagnostic has to name the place and the thing.
#[test]
fn wrong_input_is_told_at_its_place_and_starts_nothing() {
    let folder = empty_folder("wrong");
    let change = |from: &str, to: &str| {
        assert!(ONE_ROBOT.contains(from));
        ONE_ROBOT.replacen(from, to, 1)
    };
    let second = |name: &str, id: &str| {
        let start = ONE_ROBOT.find("  <component").unwrap();
        let end = ONE_ROBOT.find("</composite>").unwrap();
        let copy = ONE_ROBOT[start..end].replace("name=\"Robot001\"", &format!("name=\"{name}\""));
        let copy = copy.replace(">Robot001<", &format!(">{id}<")).replace("robot.Robot001", "robot.Robot002");
        format!("{}{copy}</composite>\n", &ONE_ROBOT[..end])
    };
    let property = |line: &str| change("</component>", &format!("  {line}\n  </component>"));
    let cases: &[(&str, String, u64, &str)] = &[
        ("ill-formed", change("</component>", ""), 7, "component"),
        ("root", change("<composite", "<composit").replace("</composite>", "</composit>"), 1, "composit"),
        ("namespace", change("http://www.osoa.org/xmlns/sca/1.0", "urn:other"), 1, "urn:other"),
        ("class", change("robot.Robot001", "robot.Robot0001"), 3, "robot.Robot0001"),
        ("unknown property", change("name=\"period\"", "name=\"perod\""), 5, "perod"),
        ("repeated property", property("<property name=\"period\">30</property>"), 6, "period"),
        ("wrong type", change(">20<", ">soon<"), 5, "soon"),
        ("period 0", change(">20<", ">0<"), 5, "0"),
        ("period negative", change(">20<", ">-20<"), 5, "-20"),
        ("period absurd", change(">20<", ">99999999999999<"), 5, "99999999999999"),
        ("empty", change(">20<", "><"), 5, "period"),
        ("out of range", property("<property name=\"battery\">101</property>"), 6, "101"),
        ("missing", change("    <property name=\"period\">20</property>\n", ""), 2, "period"),
        ("same name", second("Robot001", "Robot002"), 7, "Robot001"),
        ("same ID", second("Robot002", "Robot001"), 9, "Robot001"),
        ("rename", property("<property name=\"topicRename\">POSTOPIC,a::POSTOPIC,b</property>"), 6, "POSTOPIC"),
    ];
    for (name, text, line, mentions) in cases {
        let path = file(&folder, &format!("{}.composite", name.replace(' ', "-")), text);
        let output = saoms(&["run", &path, "--virtual", "--for", "1s", "--format", "json"]);
        assert_eq!(code(&output), 2, "{name}: {}{}", stdout(&output), stderr(&output));
        let found: Value = serde_json::from_str(&stdout(&output)).unwrap();
        let diagnostics = found["diagnostics"].as_array().unwrap();
        let error = diagnostics.iter().find(|one| one["severity"] == "error").unwrap();
        assert_eq!(error["line"].as_u64().unwrap(), *line, "{name}: {error}");
        assert!(error["message"].as_str().unwrap().contains(mentions), "{name}: {error}");
        assert_eq!(error["file"], path.as_str());
    }
}

#[test]
fn wrong_files_are_told_apart() {
    let folder = empty_folder("files");
    file(&folder, "airport.composite", ONE_ROBOT);
    let cases = [
        (folder.join("airpot.composite").to_str().unwrap().to_owned(), "airport.composite"),
        (folder.to_str().unwrap().to_owned(), "folder"),
        (file(&folder, "empty.composite", ""), "empty"),
        (file(&folder, "binary.composite", [0x7f, b'E', b'L', b'F', 0, 0, 1]), "text"),
    ];
    for (path, mentions) in &cases {
        let output = saoms(&["run", path]);
        assert_eq!(code(&output), 2, "{path}");
        assert!(stderr(&output).contains(mentions), "{path}: {}", stderr(&output));
    }
    let small = file(&folder, "large.composite", ONE_ROBOT);
    let output = saoms(&["check", "--max-size", "100", &small]);
    assert_eq!(code(&output), 2);
    assert!(stderr(&output).contains("100"), "{}", stderr(&output));
}

#[test]
fn a_mistake_on_the_command_line_is_wrong_input() {
    for (option, value) in [("--for", "-5s"), ("--seed", "-1"), ("--grace", "-2s")] {
        let output = saoms(&["run", "composites/airport.composite", option, value]);
        assert_eq!(code(&output), 2, "{option}");
        let expected = format!("invalid value '{value}' for '{option}");
        assert!(stderr(&output).contains(&expected), "{}", stderr(&output));
    }
    for arguments in [&["run"][..], &["fly"], &["run", "x", "--for", "soon"], &["components", "robot.Robo"]] {
        assert_eq!(code(&saoms(arguments)), 2, "{arguments:?}");
    }
    let output = saoms(&["run", "composites/airport.composite", "--set", "perod=10", "--virtual"]);
    assert_eq!(code(&output), 2);
    assert!(stderr(&output).contains("period"), "{}", stderr(&output));
}

#[test]
fn a_report_that_cannot_be_written_is_told_before_the_run_and_fails_it_after() {
    let output = saoms(&["run", "composites/airport.composite", "--virtual", "--report", "no/such/folder/report.json"]);
    assert_eq!(code(&output), 2);
    assert!(stderr(&output).contains("no/such/folder/report.json"));
    assert_eq!(stdout(&output), "", "nothing was started");
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let run = ["run", "composites/hall.composite", "--virtual", "--quiet", "--report", "-"];
    let output = command(&run).stdout(full).output().unwrap();
    assert_eq!(code(&output), 1);
    let told = "error: standard output cannot be written: No space left on device (os error 28)\n";
    assert!(stderr(&output).starts_with(told), "{}", stderr(&output));
}

#[test]
fn an_output_that_has_standard_output_is_alone_there() {
    for place in ["-", "/dev/stdout"] {
        for console in [&[][..], &["--console", "classic"], &["--log-format", "json"]] {
            let run = ["run", "composites/hall.composite", "--virtual", "--report", place];
            let output = saoms(&[&run[..], console].concat());
            let report: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
            assert_eq!(report["luggage"]["delivered"], 1);
            assert!(stderr(&output).contains("Environment"), "{}", stderr(&output));
        }
    }
}

#[test]
fn a_refused_run_leaves_no_files_and_keeps_those_that_are_there() {
    let folder = empty_folder("refused");
    let (report, kept, link) = (folder.join("report.json"), folder.join("kept.svg"), folder.join("link.json"));
    fs::write(&kept, "of an earlier run").unwrap();
    std::os::unix::fs::symlink("behind.json", &link).unwrap();
    let wrong: [&[&str]; 2] = [&["--set", "perod=10"], &["--journal", "no/such/folder/journal"]];
    for (wrong, report) in [(wrong[0], &report), (wrong[1], &report), (wrong[1], &link)] {
        let output = command(&["run", "composites/airport.composite", "--virtual", "--for", "1s"])
            .args(wrong)
            .arg("--report")
            .arg(report)
            .arg("--paths")
            .arg(&kept)
            .output()
            .unwrap();
        assert_eq!(code(&output), 2);
    }
    assert!(!report.exists() && !folder.join("behind.json").exists());
    assert_eq!(fs::read_to_string(&kept).unwrap(), "of an earlier run");
    let arguments = ["run", "composites/airport.composite", "--virtual", "--for", "1s", "--quiet"];
    assert_eq!(code(&command(&arguments).arg("--report").arg(&link).output().unwrap()), 0);
    assert!(fs::metadata(folder.join("behind.json")).unwrap().len() > 0, "the link is followed");
}

#[test]
fn components_says_what_can_be_named() {
    let list = stdout(&saoms(&["components"]));
    for name in ["saoms.Robot", "saoms.World", "robot.Robot010", "unibg.robotics.tca.MessageBrokerImpl"] {
        assert!(list.contains(name), "{name} is missing in:\n{list}");
    }
    let one = stdout(&saoms(&["components", "robot.Robot003"]));
    for fact in
        ["another name of saoms.Robot", "period: ", "100us", "TaskInterface", "scheduleFor(milliseconds: uint64)"]
    {
        assert!(one.contains(fact), "`{fact}` is missing in:\n{one}");
    }
    let json: Value = serde_json::from_str(&stdout(&saoms(&["components", "--format", "json"]))).unwrap();
    let robot = json["components"].as_array().unwrap().iter().find(|class| class["class"] == "saoms.Robot").unwrap();
    assert!(robot["taskProperties"].as_array().unwrap().iter().any(|property| property["name"] == "period"));
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let mut child = command(&["components", "--format", "json"]).stdout(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn two_robots_with_one_number_do_not_start() {
    let robot = |id: &str| {
        format!(
            r#"<component name="{id}"><implementation.rust class="saoms.Robot"/><property name="ID" value="{id}"/>
               <property name="period" value="20"/><reference name="world" target="World"/></component>"#
        )
    };
    let fleet = format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="twins" targetNamespace="urn:twins">
             <component name="World"><implementation.rust class="saoms.World"/><property name="ID" value="World"/>
               <property name="period" value="20"/></component>
             {}{}
           </composite>"#,
        robot("A7"),
        robot("B7")
    );
    let path = file(&empty_folder("twins"), "twins.composite", fleet);
    let output = saoms(&["run", &path, "--virtual", "--for", "1s"]);
    assert_eq!(code(&output), 2, "{}", stdout(&output));
    assert!(stderr(&output).contains("robots `A7` and `B7` both have the number 7"), "{}", stderr(&output));
}

#[test]
fn check_gives_code_scanning_a_log() {
    let text = ONE_ROBOT.replacen("name=\"period\"", "name=\"perod\"", 1);
    let path = file(&empty_folder("sarif"), "one.composite", text);
    let output = saoms(&["check", &path, "--format", "sarif"]);
    assert_eq!((code(&output), stderr(&output)), (2, String::new()));
    let log: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let results = log["runs"][0]["results"].as_array().unwrap();
    let unknown = results.iter().find(|one| one["ruleId"] == "S3004").unwrap();
    let place = &unknown["locations"][0]["physicalLocation"];
    assert_eq!(place["artifactLocation"]["uri"], format!("file://{path}"));
    assert_eq!(place["region"]["startLine"], 5);
    let replacement = &unknown["fixes"][0]["artifactChanges"][0]["replacements"][0];
    assert_eq!(replacement["insertedContent"]["text"], "period");
    let output = saoms(&["check", "composites/airport.composite", "--format", "sarif"]);
    let log: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!((code(&output), log["runs"][0]["results"].as_array().unwrap().len()), (0, 0));
}

#[test]
fn loops_and_knowledge_are_described() {
    let class = stdout(&saoms(&["components", "robot.Robot001"]));
    assert!(class.contains("Loops, in order, where policy is safe\n  RobotMS              saoms.RobotMS\n"), "{class}");
    assert!(class.contains("Knowledge saoms.Robot\n") && class.contains("  battery: float64, in %\n"), "{class}");
    let one = stdout(&saoms(&["components", "saoms.CollisionMS"]));
    assert!(one.contains("works on the knowledge saoms.Robot") && one.contains("Effects\n  stopAPeriod\n"), "{one}");
    let all: Value = serde_json::from_str(&stdout(&saoms(&["components", "--format", "json"]))).unwrap();
    assert!(all["loops"].as_array().unwrap().iter().any(|one| one["loop"] == "saoms.classic.CollisionMS"));
    let unknown = saoms(&["components", "CollisionMS"]);
    assert_eq!(code(&unknown), 2);
    assert!(stderr(&unknown).contains("did you mean `saoms.CollisionMS`"), "{}", stderr(&unknown));
}

#[test]
fn the_classic_console_shows_what_robots_of_the_default_policy_do() {
    let shown = stdout(&saoms(&["run", "composites/airport.composite", "--virtual", "--console", "classic"]));
    for line in [
        "is a new healer for Robot",
        "now is awake",
        "says: I've arrived to charge position.",
        "is now fully charged and ready",
        "RISK OF COLLISION DETECTED AND AVOIDED!",
    ] {
        assert!(shown.contains(line), "no `{line}`: {shown}");
    }
}

#[test]
fn the_report_has_a_row_for_each_robot_and_its_fields_are_documented() {
    let run = ["run", "composites/airport.composite", "--virtual", "--quiet", "--report", "-"];
    let long: Value = serde_json::from_str(&stdout(&saoms(&run))).unwrap();
    let rows = long["robots"]["by_path"].as_object().unwrap();
    assert_eq!(rows.len(), 10);
    let sum = |field: &str| rows.values().map(|row| row[field].as_u64().unwrap()).sum::<u64>();
    assert_eq!(Value::from(sum("delivered")), long["luggage"]["delivered"]);
    assert!(sum("blocks") > 100 && sum("waited_ms") > 0);
    assert_eq!((&rows["Robot001"]["number"], &rows["Robot001"]["state"]), (&Value::from(1), &Value::from("broken")));
    let documented = crate::support::project("docs/report.md");
    let nested = ["luggage", "collisions", "robots", "messages"];
    let fields = long.as_object().unwrap().iter().flat_map(|(name, value)| match value.as_object() {
        Some(inner) if nested.contains(&name.as_str()) => inner.keys().map(|key| format!("{name}.{key}")).collect(),
        _ => vec![name.clone()],
    });
    let of_rows = rows["Robot001"].as_object().unwrap().keys().chain(long["components"][0].as_object().unwrap().keys());
    for field in fields.chain(of_rows.cloned()) {
        assert!(documented.contains(&format!("`{field}")), "docs/report.md lacks `{field}`");
    }
    let short = stdout(&saoms(&[&run[..], &["--short-report"]].concat()));
    assert!(short.len() < 30_000, "{} bytes", short.len());
    let short: Value = serde_json::from_str(&short).unwrap();
    assert_eq!(short["journal"]["entries"], serde_json::json!([]));
    assert_eq!(short["journal"]["records"], long["journal"]["records"]);
    assert_eq!(short["robots"], long["robots"]);
}
