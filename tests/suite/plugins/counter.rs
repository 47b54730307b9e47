//! `plugins/counter`, the component that stands for how much there is to write.

use std::path::Path;

use saoms_api::{Class, Component, Context, Failure, info};
use saoms_counter::{COUNT, Count, Counter, NumbersReference};
use saoms_testkit::{Bench, comply};

use super::library;
use crate::support::{project, saoms, text};

/// Tells what a counter has counted.
#[derive(Class)]
#[class(name = "test.Reader", periodic)]
struct Reader {
    #[reference]
    counter: NumbersReference,
}

impl Component for Reader {
    type Properties = ();

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let number = self.counter.number(context)?;
        info!(context, "reads {number}");
        Ok(())
    }
}

#[test]
fn it_counts_is_checked_and_serves_linked_and_loaded() -> Result<(), Failure> {
    let library = library("saoms_counter");
    let loaded = |values: &[(&str, &str)]| Bench::of_library(&library, "counter.Counter", values);
    for make in [&Bench::of::<Counter> as &dyn Fn(&[(&str, &str)]) -> Result<Bench, Failure>, &loaded] {
        let mut counter = make(&[("step", "5")])?;
        counter.start()?;
        counter.execute()?;
        counter.execute()?;
        assert_eq!(counter.sent_json("COUNT")[0]["number"], 10);
        let refused = make(&[("step", "500")]).err().unwrap();
        assert!(refused.message().contains("step"), "{refused}");
        let mut reader = Bench::of::<Reader>(&[])?.wire("counter", counter, "numbers");
        reader.start()?;
        reader.execute()?;
        assert_eq!(reader.log(), ["reads 10"]);
    }
    let mut counter = Bench::of::<Counter>(&[])?;
    counter.start()?;
    counter.execute()?;
    assert_eq!(counter.sent(&COUNT), [Count { number: 1 }]);
    comply::<Counter>(&[]);
    Ok(())
}

/// Lines that say something: no comment, and not empty.
fn lines(file: &str) -> usize {
    let is_comment =
        |line: &str| ["//", "#", "<!--"].iter().any(|mark| line.starts_with(mark) && !line.starts_with("#["));
    let text = project(Path::new("plugins/counter").join(file).to_str().unwrap());
    text.lines().map(str::trim).filter(|line| !line.is_empty() && !is_comment(line)).count()
}

#[test]
fn it_takes_forty_lines_with_its_build_and_its_composite() {
    let [code, build, composite] = ["src/lib.rs", "Cargo.toml", "fleet.composite"].map(lines);
    assert!(code + build + composite <= 40, "{code} + {build} + {composite}");
    let run = saoms(&[
        "run",
        "plugins/counter/fleet.composite",
        "--virtual",
        "--for",
        "1s",
        "--plugin",
        library("saoms_counter").to_str().unwrap(),
    ]);
    assert!(run.status.success() && text(&run).contains("counter.Counter"), "{}", text(&run));
}
