//! The dashboard of a thousand robots in a real browser.

use super::dashboard::shown;
use crate::peers::browser::Browser;

const ROBOTS: usize = 1000;

/// A thousand robots on a square map, with more luggage than they can bring at once. They act once a second, so that a
/// build for debugging keeps up.
fn crowd() -> String {
    let component = |name: &str, class: &str, more: &str, attributes: &str| {
        format!(
            "<component name=\"{name}\"{attributes}><implementation.java class=\"saoms.{class}\"/>\
             <property name=\"ID\">{name}</property><property name=\"period\">1s</property>{more}</component>\n"
        )
    };
    let property = |name: &str, value: &str| format!("<property name=\"{name}\">{value}</property>");
    let map = property("width", "160") + &property("height", "160") + &property("moveTime", "900ms");
    let work = property("scenario", "from 1s every 20ms 100000 times luggage random to random");
    let place = property("chargeX", "${index % 32 * 5}") + &property("chargeY", "${index / 32 * 5}");
    let robot = format!("{place}<reference name=\"world\" target=\"World\"/>");
    let components = [
        component("World", "World", &map, ""),
        component("Master", "MasterEnvironment", &property("assignment", "oldest"), ""),
        component("Environment", "Environment", &(work + &property("mostOpen", "1500")), ""),
        component("Robot${index:04}", "Robot", &robot, &format!(" s:count=\"{ROBOTS}\"")),
    ];
    format!(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:s=\"urn:saoms:1\" \
         targetNamespace=\"urn:crowd\" name=\"crowd\">\n{}</composite>\n",
        components.concat()
    )
}

/// Frames of the page in five seconds: their number, the median, the 95th percentile and the greatest time between two
/// in milliseconds, and the part of the time in tasks of more than 50 ms, in percent.
const FRAMES: &str = "new Promise((done) => {
    const gaps = []; let last = null, busy = 0;
    const tasks = new PerformanceObserver((list) => list.getEntries().forEach((one) => (busy += one.duration)));
    tasks.observe({ entryTypes: ['longtask'] });
    const begin = performance.now();
    const frame = (now) => {
        if (last !== null) gaps.push(now - last);
        last = now;
        if (performance.now() - begin < 5000) return requestAnimationFrame(frame);
        tasks.disconnect();
        gaps.sort((a, b) => a - b);
        const at = (part) => Math.round(gaps[Math.floor((gaps.length - 1) * part)] * 10) / 10;
        done([gaps.length, at(0.5), at(0.95), at(1), Math.round(busy / 50)]);
    };
    requestAnimationFrame(frame);
})";

#[test]
fn a_thousand_robots_are_shown_and_move() {
    let Some(mut browser) = Browser::start("dashboard-crowd") else { return };
    let shown = shown(&crowd(), &["--quiet"]);
    shown.log_in(&mut browser, &shown.tokens[0]);
    browser.until(&format!("document.querySelectorAll('tr[data-robot]').length === {ROBOTS}"));
    browser.until("document.querySelector('.counts').textContent.includes('1000 robots')");
    let blocks = "[...document.querySelectorAll('tr[data-robot]')].map((row) => row.cells[3].textContent)";
    browser.value(&format!("window.before = {blocks}, 0"));
    browser.until(&format!("{blocks}.filter((block, row) => block !== before[row]).length > 100"));
    // What the map paints differs, too.
    let paints = "document.querySelector('canvas.floor-map').toDataURL()";
    browser.value(&format!("window.painted = {paints}, 0"));
    browser.until(&format!("{paints} !== painted"));
    let frames = browser.value(FRAMES);
    let frames: Vec<f64> = frames.as_array().unwrap().iter().map(|one| one.as_f64().unwrap()).collect();
    let [count, median, most, greatest, busy] = frames[..] else { panic!("{frames:?}") };
    assert!(count > 0.0);
    println!(
        "{ROBOTS} robots: {count} frames in 5 s, {median} ms between two (median), {most} ms (95 %), {greatest} ms at \
         most; {busy} % of the time in tasks of more than 50 ms"
    );
    // A person still gets what she asks for.
    browser.click("tr[data-robot=Robot0500] button");
    browser.until("document.querySelector('.side h2')?.textContent === 'Robot0500'");
    assert_eq!(browser.errors(), Vec::<String>::new());
}
