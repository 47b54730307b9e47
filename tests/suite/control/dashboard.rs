//! The dashboard in a real browser, of a real fleet.

use std::fs;

use serde_json::{Value, json};

use super::{Running, component, composite, fleet};
use crate::peers::browser::Browser;
use crate::support::root;

/// A fleet that is served to browsers.
pub(super) struct Shown {
    pub(super) running: Running,
    pub(super) url: String,
    /// The tokens: to control, and to view.
    pub(super) tokens: [String; 2],
}

pub(super) fn shown(composite: &str, arguments: &[&str]) -> Shown {
    let running = Running::start(composite, &[&["--stay", "--serve", "127.0.0.1:0"], arguments].concat());
    let listed: Value = serde_json::from_str(&running.told(&["ps", "--format", "json"])).unwrap();
    let token = |name: &str| fs::read_to_string(listed[0][name].as_str().unwrap()).unwrap().trim().to_owned();
    let tokens = [token("token_file"), token("view_token_file")];
    Shown { url: listed[0]["url"].as_str().unwrap().to_owned(), tokens, running }
}

impl Shown {
    /// Logs a browser in.
    pub(super) fn log_in(&self, browser: &mut Browser, token: &str) {
        browser.open(&self.url);
        browser.fill("#token", token);
        browser.click("form button");
    }

    /// The values of a robot in `saoms status`, and what its row in the page has to say of them.
    fn row(&self, name: &str) -> [String; 4] {
        let robot = self.running.component(name);
        let values = &robot["values"];
        let block = values["block"].as_array().unwrap();
        [
            values["state"].as_str().unwrap().to_owned(),
            format!("{} %", values["battery"].as_f64().unwrap().round()),
            format!("({},{})", block[0], block[1]),
            values["delivered"].to_string(),
        ]
    }
}

/// An expression: the cells of a robot's row in the page.
fn cells(robot: &str) -> String {
    format!(
        "JSON.stringify([...document.querySelector('tr[data-robot={robot}]').cells].slice(1).map((one) => one.textContent))"
    )
}

/// An expression: true while this text is in an element.
fn says(selector: &str, text: &str) -> String {
    format!("!!document.querySelector({})?.textContent.includes({})", json!(selector), json!(text))
}

#[test]
fn a_person_sees_the_fleet_and_steers_it() {
    let Some(mut browser) = Browser::start("dashboard") else { return };
    let shown = shown(&fleet(), &["--report", "report.json"]);
    let Shown { running, tokens, .. } = &shown;
    shown.log_in(&mut browser, "0123456789abcdef");
    browser.until(&says(".wrong", "not a token"));
    shown.log_in(&mut browser, &tokens[0]);

    browser.until("document.querySelectorAll('tr[data-robot]').length === 1");
    browser.until(&says("#phase", "running"));

    // It stops the fleet, and sends luggage that no robot moves for.
    browser.click("header [data-order='Emergency stop']");
    browser.until(&says("#phase", "stopped"));
    browser.until("!document.querySelector('[aria-busy=true]')");
    assert_eq!(running.component("Robot1")["emergency_stop"], true);
    let log = running.told(&["logs"]);
    assert!(log.contains("emergency stop by dashboard"), "{log}");
    browser.fill("[aria-label='Block where the luggage is']", "(3,1)");
    browser.fill("[aria-label='Block where it has to go']", "6 8");
    browser.click("[data-order='Send luggage']");
    browser.until(&says(".counts", "1 open piece"));
    let before = browser.value(&cells("Robot1"));

    // It releases the robots, and sees that they move.
    browser.value(&format!(
        "window.seen = new Set(); window.looks = setInterval(() => seen.add({}), 20)",
        cells("Robot1")
    ));
    browser.click("header [data-order='Release all']");
    browser.until(&says("#phase", "running"));
    assert_eq!(running.component("Robot1")["emergency_stop"], false);
    browser.until(&format!("{} !== {before}", cells("Robot1")));
    browser.until("seen.size > 4");
    browser.value("clearInterval(looks)");
    browser.click("header [data-order='Pause']");
    browser.until(&says("#phase", "paused"));
    assert!(running.told(&["status"]).contains("paused"));
    browser.click("header [data-order='Resume']");
    browser.until(&says("#phase", "running"));

    // What it shows is what the fleet says.
    browser.until(&says("#summary", "1 of 1 pieces of luggage delivered"));
    running.until("Robot1", |robot| robot["values"]["state"] == "free" || robot["values"]["state"] == "asleep");
    browser.until(&says("tr[data-robot=Robot1] .state", &shown.row("Robot1")[0]));
    let expected = json!(shown.row("Robot1")).to_string();
    browser.until(&format!("{} === {}", cells("Robot1"), json!(expected)));

    // Robot2 is woken, breaks down, and is what an alert is about.
    browser.open(&format!("{}/#/component/Robot2", shown.url));
    browser.click("main [data-order='Start']");
    browser.until(&says("main .state", "running"));
    assert_eq!(running.component("Robot2")["state"], "running");
    browser.open(&format!("{}/#/floor", shown.url));
    browser.value("window.confirm = () => true");
    browser.click("tr[data-robot=Robot2] button");
    browser.click("[data-order='Break down']");
    browser.until(&says("tr[data-robot=Robot2] .state", "broken"));
    browser.until(&says(".badge", "1"));
    browser.open(&format!("{}/#/alerts", shown.url));
    browser.until(&says("ol.alerts", "needs assistance"));
    browser.click("[data-order='Acknowledge']");
    browser.until(&says("ol.alerts", "acknowledged by dashboard"));
    assert_eq!(running.told(&["alerts"]), "no alerts\n");

    // Why a robot did what it did.
    browser.open(&format!("{}/#/component/Robot1", shown.url));
    browser.until("document.querySelectorAll('ol.records li').length > 10");
    browser.click(".choices button:last-child");
    browser.until("document.querySelectorAll('.timeline .mark').length > 10");
    // It does nothing more meanwhile.
    running.told(&["pause"]);
    browser.click(".columns .bar button");
    browser.until("document.querySelectorAll('.why ol.chain li').length > 0");
    let why: Value = serde_json::from_str(&running.told(&["why", "Robot1", "--format", "json"])).unwrap();
    let first = why["chains"][0]["acts"][0]["text"].as_str().unwrap();
    assert_eq!(browser.text(".why ol.chain li .what"), first);
    let records = running.told(&["journal", "Robot1", "-n", "100000"]);
    assert!(records.contains("GripperMS decision: deposits luggage"), "{records}");
    running.told(&["resume"]);

    // The other parts.
    for (part, seen) in [
        ("components", "document.querySelectorAll('table.components tbody tr').length === 4"),
        ("topics", "document.body.textContent.includes('POSTOPIC')"),
        ("log", "document.querySelectorAll('ol.log li').length > 3"),
        ("plots", "[...document.querySelectorAll('.plot .line')].filter((one) => one.getAttribute('d')).length > 5"),
        // They begin with the run, not with the page.
        ("plots", "[...document.querySelectorAll('.plot .grid text')].some((one) => one.textContent === '0.0 s')"),
        ("assembly", "document.querySelector('.picture img').naturalWidth > 100"),
    ] {
        browser.open(&format!("{}/#/{part}", shown.url));
        browser.until(seen);
    }
    assert_eq!(browser.errors(), Vec::<String>::new());

    running.told(&["down"]);
    browser.until(&says("#connection", "The connection is lost"));
    browser.until("document.body.classList.contains('lost')");
    let summary = browser.text("#summary");
    let mut running = shown.running;
    let (code, printed) = running.wait();
    // The robot that broke down is reported as an error, and fails no run.
    assert_eq!(code, Some(0), "{printed}");
    let report: Value =
        serde_json::from_str(&fs::read_to_string(running.folder().join("report.json")).unwrap()).unwrap();
    let luggage = &report["luggage"];
    assert_eq!(summary, format!("{} of {} pieces of luggage delivered", luggage["delivered"], luggage["requested"]));
}

#[test]
fn who_may_view_can_press_no_button() {
    let Some(mut browser) = Browser::start("dashboard-view") else { return };
    let shown = shown(&fleet(), &[]);
    shown.log_in(&mut browser, &shown.tokens[1]);
    browser.until("document.querySelectorAll('tr[data-robot]').length === 1");
    browser.click("tr[data-robot=Robot1] button");
    browser.until("document.querySelectorAll('[data-order]').length > 6");
    assert_eq!(browser.value("[...document.querySelectorAll('[data-order]')].every((one) => one.disabled)"), true);
    // The page is not what hinders it.
    let asked = "fetch('/v1/estop', {method: 'POST'}).then((answer) => answer.status)";
    assert_eq!(browser.value(asked), 403);
    assert_eq!(shown.running.component("Robot1")["emergency_stop"], false);
    browser.click("form[action='/logout'] button");
    browser.until("location.pathname === '/login'");
    assert_eq!(browser.value("fetch('/v1/status').then((answer) => answer.status)"), 401);
    assert_eq!(browser.errors(), Vec::<String>::new());
}

#[test]
fn a_robot_is_steered_by_keyboard() {
    let Some(mut browser) = Browser::start("dashboard-keyboard") else { return };
    let shown = shown(&fleet(), &[]);
    let running = &shown.running;
    browser.open(&shown.url);
    browser.until("!!document.querySelector('#token')");
    browser.tab_to("focus.id === 'token'");
    shown.tokens[0].chars().for_each(|letter| browser.press(&letter.to_string()));
    browser.press("Enter");
    browser.until("document.querySelectorAll('tr[data-robot]').length === 1");
    browser.tab_to("focus.className === 'skip'");
    browser.tab_to("focus.tagName === 'CANVAS'");
    browser.press("n");
    browser.until("document.querySelector('.side h2')?.textContent === 'Robot1'");
    let stopped = || running.component("Robot1")["emergency_stop"] == true;
    let state = || running.component("Robot1")["state"].clone();
    browser.tab_to("focus.dataset.order === 'Stop'");
    browser.press("Enter");
    browser.until(&says("tr[data-robot=Robot1] .state", "stopped"));
    assert!(stopped());
    browser.tab_to("focus.dataset.order === 'Release' && !!focus.closest('.side')");
    browser.press("Enter");
    browser.until("!document.querySelector('.side [data-order=Stop]').hidden");
    assert!(!stopped());
    browser.tab_to("focus.dataset.order === 'Sleep'");
    browser.press("Enter");
    browser.until("!document.querySelector('.side [data-order=Wake]').hidden");
    assert_eq!(state(), "idle");
    browser.tab_to("focus.dataset.order === 'Wake'");
    browser.press("Enter");
    browser.until("!document.querySelector('.side [data-order=Sleep]').hidden");
    assert_eq!(state(), "running");
    // Why it acted, at a moment in the list of its records.
    running.told(&["send", "luggage (3,1) to (6,8)"]);
    running.until("World", |world| world["values"]["delivered"] == 1);
    browser.open(&format!("{}/#/component/Robot1", shown.url));
    browser.until("document.querySelectorAll('ol.records li').length > 10");
    running.told(&["pause"]);
    browser.tab_to("!!focus.closest('ol.records') && !!focus.nextElementSibling.classList.contains('effect')");
    let at = browser.text(":focus time");
    browser.press("Enter");
    browser.until("document.querySelectorAll('.why ol.chain li').length > 0");
    assert_eq!(browser.text(".why ol.chain li time"), at);
    assert_eq!(browser.errors(), Vec::<String>::new());
}

#[test]
fn it_fits_a_phone_and_follows_the_colours_of_the_system() {
    let Some(mut browser) = Browser::start("dashboard-phone") else { return };
    let shown = shown(&fleet(), &[]);
    browser.be_screen(390, 844);
    shown.log_in(&mut browser, &shown.tokens[0]);
    browser.until("document.querySelectorAll('tr[data-robot]').length === 1");
    for part in ["floor", "component/Robot1", "components", "plots", "topics", "alerts", "log", "assembly"] {
        browser.open(&format!("{}/#/{part}", shown.url));
        browser.until("document.querySelector('main').textContent.length > 20");
        // Nothing has to be moved sideways.
        let widths = browser.value("[document.documentElement.scrollWidth, innerWidth].join()");
        assert_eq!(widths, "390,390", "{part}");
    }
    let light = "getComputedStyle(document.body).backgroundColor.match(/[\\d.]+/g).slice(0, 3).reduce((sum, one) => sum + +one, 0)";
    browser.prefer("dark");
    browser.until(&format!("{light} < 200"));
    browser.prefer("light");
    browser.until(&format!("{light} > 550"));
    assert_eq!(browser.errors(), Vec::<String>::new());
}

/// Robots that meet, with a zone and without one: who waits for whom, and why, is what robots and the zone say.
#[test]
fn conflicts_and_zones_of_an_airport_are_shown() {
    let Some(mut browser) = Browser::start("dashboard-conflicts") else { return };
    let airport = fs::read_to_string(root().join("composites/airport.composite")).unwrap();
    let (before, after) = airport.split_once("<property name=\"scenario\">").unwrap();
    let work = "from 1s every 200ms 5000 times luggage (0,0)..(10,10) to (0,0)..(10,10)";
    let busy =
        [before, "<property name=\"scenario\">", work, "</property>", after.split_once("</property>").unwrap().1];
    let busy = busy.concat();
    let (before, zone) = busy.split_once("<component name=\"Zone\">").unwrap();
    let without_zone = format!("{before}{}", zone.split_once("</component>").unwrap().1);
    for (fleet, has_zone) in [(busy.as_str(), true), (without_zone.as_str(), false)] {
        let shown = shown(fleet, &[]);
        shown.log_in(&mut browser, &shown.tokens[0]);
        browser.until("document.querySelectorAll('ol.conflicts li').length > 0");
        // The page and the fleet agree while time stands: who waits, and why.
        let mut conflicts = Vec::new();
        while conflicts.iter().all(|(_, by_zone)| *by_zone != has_zone) {
            shown.running.told(&["resume"]);
            shown.running.told(&["pause"]);
            let status: Value = serde_json::from_str(&shown.running.told(&["status", "--format", "json"])).unwrap();
            conflicts = told(status["status"]["components"].as_array().unwrap());
        }
        let count = conflicts.len();
        browser.until(&format!("document.querySelectorAll('ol.conflicts li:not(.past)').length === {count}"));
        for (line, _) in &conflicts {
            let items = "[...document.querySelectorAll('ol.conflicts li:not(.past)')].map((one) => one.textContent)";
            browser.until(&format!("{items}.some((one) => one.startsWith({}))", json!(line)));
        }
    }
    assert_eq!(browser.errors(), Vec::<String>::new());
}

/// The conflicts that robots tell, as the page shows them, with the words of the zone where it has some; and whether
/// they are its words.
fn told(components: &[Value]) -> Vec<(String, bool)> {
    let zones = || components.iter().filter_map(|one| one["values"]["waits"].as_array()).flatten();
    let conflict = |robot: &Value| {
        let values = &robot["values"];
        let (other, first) = (values["waits_for_robot"].as_u64()?, values["goes_first"].as_u64().unwrap());
        let is_it = |wait: &&Value| {
            wait["robot"] == values["robot"] && wait["goes_first"] == first && wait["at"] == values["waits_at"]
        };
        let by_zone = zones().find(is_it);
        let because = by_zone.unwrap_or(values)["because"].as_str().unwrap();
        let (name, at) = (robot["name"].as_str().unwrap(), &values["waits_at"]);
        let other = format!("Robot{other:03}");
        let who = match values["robot"] == first {
            true => format!("{name} goes first, and waits for {other} to give way"),
            false => format!("{other} goes first, {name} waits"),
        };
        Some((format!("{who} at ({},{}){because}", at[0], at[1]), by_zone.is_some()))
    };
    components.iter().filter_map(conflict).collect()
}

/// A fleet whose names all have markup: its own, that of a site, of a zone, of a topic and of a robot.
fn marked() -> String {
    let at_site = |name: &str, class: &str, more: &str| {
        component(name, class, more).replacen("<component ", "<component s:site=\"&lt;marquee&gt;North\" ", 1)
    };
    let world = "<reference name=\"world\" target=\"World\"/>";
    let topic = "<property name=\"topicRename\">POSTOPIC,&lt;marquee&gt;places</property>";
    let components = [
        component("Master", "saoms.MasterEnvironment", ""),
        component("&lt;img&gt;&lt;script&gt;7", "saoms.Robot", topic),
        at_site("World", "saoms.World", ""),
        at_site("&lt;marquee&gt;Zone", "saoms.Zone", world),
        at_site("MasterNorth", "saoms.MasterEnvironment", ""),
        at_site("Robot1", "saoms.Robot", world),
    ];
    let names = "xmlns:s=\"urn:saoms:1\" name=\"&lt;marquee&gt;hall\"";
    composite(&components.concat()).replacen("name=\"fleet\"", names, 1)
}

/// True of a page in which no name has become an element; the picture of the assembly is the only image.
const IS_TEXT: &str = "document.querySelectorAll('marquee, main :not(.picture) > img, body script').length === 0";

#[test]
fn names_and_lines_of_a_fleet_are_text() {
    let Some(mut browser) = Browser::start("dashboard-text") else { return };
    let shown = shown(&marked(), &[]);
    let Shown { running, tokens, url } = &shown;
    let (robot, operator) = ("<img><script>7", "<script>document.title='owned'</script>");
    shown.log_in(&mut browser, &tokens[0]);
    let named = "document.querySelector('tr[data-robot] button').textContent";
    browser.until(&format!("!!document.querySelector('tr[data-robot]') && {named} === {}", json!(robot)));
    // The name of the operator is in the log and in an alert.
    running.told(&["send", &format!("estop by {operator}")]);
    let seen: [(&str, &str, &[&str]); 7] = [
        ("floor", "main", &[robot, "<marquee>North"]),
        ("components", "table.components", &[robot, "<marquee>Zone"]),
        ("plots", ".plots", &["robots"]),
        ("topics", "main", &["<marquee>places", "<marquee>North/"]),
        ("log", "ol.log", &[robot, operator]),
        ("alerts", "ol.alerts", &[robot, operator]),
        ("component/%3Cmarquee%3EZone", "main", &["<marquee>Zone"]),
    ];
    for (part, place, texts) in seen {
        browser.open(&format!("{url}/#/{part}"));
        texts.iter().for_each(|text| browser.until(&says(place, text)));
        assert_eq!(browser.value(IS_TEXT), true, "{part}");
    }
    browser.open(&format!("{url}/#/topics"));
    let topic = "[...document.querySelectorAll('main button')].find((one) => one.textContent.endsWith('places'))";
    browser.until(&format!("!!{topic}"));
    browser.value(&format!("{topic}.click()"));
    browser.until(&says("main h3", "<marquee>places"));
    assert_eq!(browser.value(IS_TEXT), true, "the messages of a topic");
    browser.open(&format!("{url}/#/assembly"));
    browser.until("document.querySelector('.picture img').naturalWidth > 100");
    assert_eq!(browser.value(IS_TEXT), true);
    // In the picture, too.
    let picture = browser.value("fetch('/v1/picture.svg').then((answer) => answer.text())");
    let picture = picture.as_str().unwrap();
    assert!(picture.contains("&lt;marquee&gt;Zone") && picture.contains("&lt;marquee&gt;hall"), "{picture}");
    assert!(!picture.contains("<marquee") && !picture.contains("<script"), "{picture}");
    browser.open(&format!("{url}/#/component/{}", "%3Cimg%3E%3Cscript%3E7"));
    browser.until(&says("main h2", robot));
    browser.until("document.querySelectorAll('ol.records li').length > 0");
    assert_eq!(browser.value(IS_TEXT), true);
    assert!(!browser.value("document.title").to_string().contains("owned"));
    assert_eq!(browser.errors(), Vec::<String>::new());
    // What a test that fails keeps is a picture.
    assert!(fs::read(browser.keep()).unwrap().starts_with(b"\x89PNG\r\n\x1a\n"));
}
