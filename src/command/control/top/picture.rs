use serde_json::Value;

use super::super::status::{headline, said, state};
use super::super::table::Table;
use saoms_api::host::one_line;

const HEAD: [&str; 11] = [
    "COMPONENT", "STATE", "EXECUTIONS", "LATE P50", "P99", "MAX", "MISSED", "DROPPED", "RESTARTS", "IN CODE", "DETAILS",
];

/// What a refresh shows.
pub(super) struct Picture {
    headline: String,
    /// Head and rows.
    table: String,
}

impl Picture {
    pub(super) fn of(answer: &Value) -> Picture {
        let mut table = Table::new(&HEAD).with_numbers(2..10);
        for component in answer["status"]["components"].as_array().into_iter().flatten() {
            let number = |field: &str| component[field].to_string();
            let late = |field: &str| microseconds(&component["late_us"][field]);
            let name = one_line(component["name"].as_str().unwrap_or_default()).into_owned();
            let in_code = component["in_code_s"].as_f64().map_or_else(String::new, |seconds| format!("{seconds:.1} s"));
            table.row([
                name,
                state(component),
                number("executions"),
                late("p50"),
                late("p99"),
                late("max"),
                number("missed"),
                number("dropped"),
                number("restarts"),
                in_code,
                said(component),
            ]);
        }
        Picture { headline: headline(answer), table: table.to_string() }
    }

    /// All of it.
    pub(super) fn whole(&self) -> String {
        format!("{}\n\n{}", self.headline, self.table)
    }

    /// The lines that fit a window.
    pub(super) fn within(&self, rows: usize, columns: usize) -> Vec<String> {
        let mut lines: Vec<&str> = vec![&self.headline, ""];
        lines.extend(self.table.lines());
        let more = lines.len().saturating_sub(rows);
        let last = format!("... {} more components", more + 1);
        if more > 0 {
            lines.truncate(rows.saturating_sub(1));
            lines.push(&last);
        }
        lines.truncate(rows);
        lines.iter().map(|line| line.chars().take(columns).collect()).collect()
    }
}

/// A time as a short number with its unit.
fn microseconds(value: &Value) -> String {
    match value.as_u64() {
        None => String::new(),
        Some(micros @ 0..1_000) => format!("{micros} us"),
        Some(micros @ 1_000..1_000_000) => format!("{:.1} ms", micros as f64 / 1e3),
        Some(micros) => format!("{:.1} s", micros as f64 / 1e6),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn answer(count: usize) -> Value {
        let component = |number: usize| {
            json!({
                "name": format!("Robot{number}\u{1b}[2J"), "state": "running", "executions": 7, "missed": 1,
                "dropped": 2, "restarts": 3, "in_code_s": null, "values": {"state": "free"},
                "late_us": {"p50": 71, "p99": 1_234, "max": 2_500_000},
            })
        };
        json!({
            "fleet": {"name": "hall", "pid": 7},
            "status": {
                "phase": "running", "time_s": 1.5, "summaries": [],
                "components": (0..count).map(component).collect::<Vec<_>>(),
            },
        })
    }

    #[test]
    fn a_picture_has_a_row_for_each_component_without_control_characters() {
        let text = Picture::of(&answer(1)).whole();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "hall (process 7): running, 1.500 s");
        let row =
            "Robot0\\u{1b}[2J  running           7     71 us  1.2 ms  2.5 s       1        2         3           free";
        assert_eq!(lines[3], row);
    }

    #[test]
    fn a_window_gets_what_fits_and_is_told_how_much_does_not() {
        let lines = Picture::of(&answer(20)).within(10, 12);
        assert_eq!(lines.len(), 10);
        assert!(lines.iter().all(|line| line.chars().count() <= 12), "{lines:?}");
        assert_eq!(Picture::of(&answer(20)).within(10, 80)[9], "... 14 more components");
        assert_eq!(Picture::of(&answer(7)).within(10, 80).len(), 10);
        assert!(Picture::of(&answer(7)).within(10, 80)[9].starts_with("Robot6"));
        assert!(Picture::of(&answer(7)).within(0, 0).is_empty());
    }
}
