//! The view of a fleet of robots in the dashboard: the map with robots, luggage, grants and conflicts, and orders. It
//! runs in a browser, and knows no more than the topics and the status of the fleet say.

use saoms_api::extension::{DashboardLine, DashboardPlot, DashboardState, DashboardView, Summary, submit};

const fn state(message: &'static str, fields: &'static [&'static str]) -> DashboardState {
    DashboardState { message, fields }
}

/// Robots say their numbers.
const ROBOTS: &[&str] = &["robot"];

const fn plot(title: &'static str, unit: &'static str, lines: &'static [DashboardLine]) -> DashboardPlot {
    DashboardPlot { title, unit, lines }
}

const fn line(title: &'static str, field: &'static str, by: Summary, of: &'static [&'static str]) -> DashboardLine {
    DashboardLine { title, field, by, of }
}

const PLOTS: &[DashboardPlot] = &[
    // Worlds count what was delivered; without one, the robots do.
    plot(
        "Pieces delivered in a minute",
        "",
        &[line("over the last minute", "delivered", Summary::PerMinute, &["collisions", "robot"])],
    ),
    plot(
        "Open luggage",
        "",
        &[
            // Worlds count it; without one, the masters do.
            line("open", "open", Summary::Sum, &["collisions", "luggage"]),
            // Masters list their luggage.
            line("no robot has it yet", "waiting", Summary::Sum, &["luggage"]),
        ],
    ),
    plot("Robots that wait for others", "", &[line("robots", "waits_for_robot", Summary::Count, ROBOTS)]),
    plot(
        "Battery",
        "%",
        &[line("mean", "battery", Summary::Mean, ROBOTS), line("least", "battery", Summary::Least, ROBOTS)],
    ),
];

submit! {
    DashboardView {
        name: "floor",
        title: "Floor",
        files: &[
            ("view.js", include_str!("view.js")),
            ("state.js", include_str!("state.js")),
            ("draw.js", include_str!("draw.js")),
            ("panel.js", include_str!("panel.js")),
            ("view.css", include_str!("view.css")),
        ],
        states: &[
            state("Position", &["block", "next", "wanted"]),
            state("Area", &["width", "height", "blocked"]),
            state("Territory", &["zone", "corner", "width", "height"]),
            state("Grant", &["robot", "steps"]),
            state("RobotList", &["charger"]),
        ],
        plots: PLOTS,
    }
}

#[cfg(test)]
mod tests {
    use saoms_api::extension::DashboardView;

    #[test]
    fn the_view_loads_only_files_that_it_brings_or_that_the_page_has() {
        let view = DashboardView::linked().into_iter().find(|view| view.name == "floor").unwrap();
        let has = |name: &str| view.files.iter().any(|(file, _)| *file == name);
        assert!(has("view.js") && has("view.css"));
        let mut imports = 0;
        for (file, text) in view.files.iter().filter(|(file, _)| file.ends_with(".js")) {
            for line in text.lines().filter(|line| line.starts_with("import ")) {
                let from = line.split('"').nth(1).unwrap();
                let own = from.strip_prefix("./");
                assert!(own.is_some_and(has) || from.starts_with("/assets/"), "{file}: {from}");
                imports += 1;
            }
            assert!(!text.contains("innerHTML") && !text.contains("document.write"), "{file}");
        }
        assert!(imports > 3, "{imports}");
    }
}
