//! Sites whose robots, and whose luggage, have equal numbers: in `saoms status`, and in the dashboard.

use serde_json::{Value, json};

use super::composite;
use super::dashboard::{Shown, shown};
use crate::peers::browser::Browser;

/// Two sites with a robot 1 each, whose way takes an hour. The one in the north has luggage to bring.
fn sites() -> String {
    let at = |site: &str, id: &str, class: &str, more: &str| {
        format!(
            "<component name=\"{site}{id}\" s:site=\"{site}\"><implementation.java class=\"saoms.{class}\"/>\
             <property name=\"ID\">{id}</property><property name=\"period\">50</property>{more}</component>\n"
        )
    };
    let site = |site: &str, scenario: &str| {
        let robot = format!(
            "<property name=\"dischargePerBlock\">1</property><property name=\"chargePerSecond\">2</property>\
             <reference name=\"world\" target=\"{site}World\"/>"
        );
        let scenario = format!("<property name=\"scenario\">{scenario}</property>");
        [
            at(site, "World", "World", "<property name=\"moveTime\">1h</property>"),
            at(site, "Environment", "Environment", &scenario),
            at(site, "Master", "MasterEnvironment", ""),
            at(site, "Robot1", "Robot", &robot),
        ]
        .concat()
    };
    let components = site("North", "at 0s luggage (5,5) to (1,1)") + &site("South", "at 100h luggage (5,5) to (1,1)");
    composite(&components).replacen("name=\"fleet\"", "xmlns:s=\"urn:saoms:1\" name=\"fleet\"", 1)
}

/// An expression: the conflict that the view sees at each of two sites, whose robots and zones differ in nothing else.
const CONFLICTS: &str = "import('/assets/views/floor/state.js').then(({ Floor }) => {
    const component = (site, id, values) => [`${site}/${id}`, { name: `${site}/${id}`, site, state: 'running', values }];
    const ofSite = (site) => [
        component(site, 'Zone', { waits: [{ robot: 1, goes_first: 2, at: [1, 1], because: site }] }),
        component(site, 'Robot1', { robot: 1, block: [0, 1], waits_for_robot: 2, goes_first: 2, waits_at: [1, 1], waits_since_s: 1 }),
        component(site, 'Robot2', { robot: 2, block: [1, 1] }),
    ];
    const sites = ['North', 'South'];
    const fleet = {
        topicList: sites.map((site) => ({ name: `${site}/POSTOPIC`, message: 'Position' })),
        topics: new Map(), components: new Map(sites.flatMap(ofSite)), state: { time_s: 2 }, isStale: () => false,
    };
    const floor = new Floor(fleet);
    return sites.map((site) => {
        floor.show(`${site}/POSTOPIC`);
        floor.update();
        return [...floor.conflicts.values(), ...floor.past].map((one) => `${one.winner} ${one.reason}`).join();
    });
})";

#[test]
fn sites_whose_robots_have_equal_numbers_do_not_mix() {
    let Some(mut browser) = Browser::start("dashboard-sites") else { return };
    let shown = shown(&sites(), &[]);
    let Shown { running, tokens, .. } = &shown;
    running.until("NorthRobot1", |robot| robot["values"]["job"].is_string());
    let status: Value = serde_json::from_str(&running.told(&["status", "--format", "json"])).unwrap();
    let components = status["status"]["components"].as_array().unwrap();
    assert!(
        components.len() == 8
            && components.iter().all(|one| {
                let (name, site) = (one["name"].as_str().unwrap(), one["site"].as_str().unwrap());
                !site.is_empty() && name.starts_with(site)
            }),
        "{components:?}"
    );

    shown.log_in(&mut browser, &tokens[0]);
    let counts = |text: &str| format!("document.querySelector('.counts')?.textContent === {}", json!(text));
    browser.until(&counts("1 robot · 1 open piece"));
    let choose = "{ const site = document.querySelector('[aria-label=Site]'); site.value = 'South/POSTOPIC'; \
                  site.dispatchEvent(new Event('change')); }";
    browser.value(choose);
    browser.until("!!document.querySelector('tr[data-robot=SouthRobot1]')");
    browser.until(&counts("1 robot · 0 open pieces"));
    // What is ordered is ordered for that site.
    browser.fill("[aria-label='Block where the luggage is']", "(3,1)");
    browser.fill("[aria-label='Block where it has to go']", "(6,8)");
    browser.click("[data-order='Send luggage']");
    browser.until(&counts("1 robot · 1 open piece"));
    browser.value("window.confirm = () => true");
    browser.click("tr[data-robot=SouthRobot1] button");
    browser.click("[data-order='Break down']");
    running.until("SouthRobot1", |robot| robot["values"]["state"] == "broken");
    assert_ne!(running.component("NorthRobot1")["values"]["state"], "broken");
    assert_eq!(browser.value(CONFLICTS), json!(["North/Robot2 North", "South/Robot2 South"]));
    assert_eq!(browser.errors(), Vec::<String>::new());
}
