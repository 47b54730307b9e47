//! What composites say of the run: where alerts are delivered, and what a lost terminal leads to.

use saoms_lang::assembly::{AlertCommand, RunPolicy};
use saoms_lang::model::Hangup;
use saoms_lang::project::Project;
use saoms_tools::expand::expanded;

use super::classes::registry;
use super::support::{compiled, nested, part, run, told};

const OWN: &str = "xmlns:s=\"urn:saoms:1\"";
const SETTINGS: &str = "s:alertUrl=\"http://page.example:8080/hall?a=1&amp;b\" s:alertTokenEnv=\"HALL_TOKEN\" \
                        s:alertCommand=\"./page.sh &quot;two  words&quot; &lt; x\" s:hangup=\"hold\" s:lostLink=\"end\"";
const GPS: &str = "<component name=\"Gps\"><implementation.java class=\"example.Gps\"/></component>";

fn with(name: &str, settings: &str, inside: &str) -> String {
    part(name, &format!("{OWN} {settings}"), inside)
}

#[test]
fn the_outermost_composite_decides() {
    let (assembly, diagnostics, sources) = run(&[&with("fleet", SETTINGS, GPS)], &[]);
    assert_eq!(told(&diagnostics, &sources), "");
    let RunPolicy { alert_url, alert_command, hangup, lost_link } = assembly.unwrap().run;
    let url = alert_url.unwrap();
    assert_eq!(url.address.written(), "http://page.example:8080/hall?a=1&b");
    assert_eq!(url.token_env.as_deref(), Some("HALL_TOKEN"));
    assert_eq!(alert_command.unwrap().line, "./page.sh \"two  words\" < x");
    assert_eq!((hangup, lost_link), (Hangup::Hold, Some(Hangup::End)));
}

#[test]
fn a_composite_inside_another_one_neither_sends_nor_runs_nor_decides() {
    let inner = with("hall", SETTINGS, GPS);
    let implemented = "<component name=\"Hall\"><implementation.composite name=\"t:hall\"/></component>";
    for inside in [implemented, "<include name=\"t:hall\"/>"] {
        let (assembly, diagnostics, sources) = nested(&[&with("fleet", "", inside), &inner], &[], false);
        assert_eq!(assembly.unwrap().run, RunPolicy::default(), "{inside}");
        let all = told(&diagnostics, &sources);
        assert_eq!(all.matches("S2061").count(), 1, "{all}");
        assert_eq!(diagnostics.len(), 1, "{all}");
    }
}

#[test]
fn composites_that_run_together_have_one_decision() {
    let fleets = |one: &str, other: &str| {
        let other = with("south", other, "");
        let (assembly, diagnostics, sources) = run(&[&with("north", one, GPS), &other], &[]);
        (assembly.map(|assembly| assembly.run), told(&diagnostics, &sources))
    };
    let (policy, faults) = fleets("", "s:hangup=\"goOn\" s:alertCommand=\"page\"");
    assert_eq!(faults, "");
    assert_eq!(policy.unwrap().hangup, Hangup::GoOn);
    let (policy, faults) = fleets(SETTINGS, SETTINGS);
    assert_eq!((policy.unwrap().hangup, faults.as_str()), (Hangup::Hold, ""));
    for (other, what) in [
        ("s:hangup=\"end\"", "the effect of a lost terminal"),
        ("s:alertUrl=\"http://page.example/\"", "the address of alerts, or its token"),
        ("s:alertUrl=\"http://page.example:8080/hall?a=1&amp;b\"", "the address of alerts, or its token"),
        ("s:alertCommand=\"./page.sh\"", "the command for alerts"),
    ] {
        let (policy, faults) = fleets(SETTINGS, other);
        assert!(policy.is_none(), "{other}");
        assert!(faults.contains(&format!("error S2062: `south` and `north` disagree on {what}\n")), "{faults}");
    }
}

#[test]
fn a_command_runs_in_the_folder_of_its_composite() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hall.composite");
    std::fs::write(&path, with("hall", "s:alertCommand=\"./page.sh\"", GPS)).unwrap();
    let (assembly, ..) = compiled(&Project::new().file(&path));
    let expected = AlertCommand { line: "./page.sh".to_owned(), folder: folder.path().to_owned() };
    assert_eq!(assembly.unwrap().run.alert_command, Some(expected));
}

#[test]
fn expansion_keeps_what_is_said_of_the_run() {
    let expand = |text: &str| {
        let compilation = Project::new().in_memory().text("t", text).compile(&registry());
        (expanded(&compilation).unwrap(), compilation.output.unwrap().run)
    };
    let (text, policy) = expand(&with("fleet", SETTINGS, GPS));
    let (again, same) = expand(&text);
    assert_eq!((&again, &same), (&text, &policy), "{text}");
    assert!(text.contains("s:hangup=\"hold\""), "{text}");
    let (plain, _) = expand(&with("fleet", "", GPS));
    assert!(!plain.contains("urn:saoms:1"), "{plain}");
}
