//! Robots that are replaced while their fleet runs, as `saoms run --reload` does when a library with one of their loops
//! is built anew.

use std::time::Duration;

use saoms_api::Time;
use saoms_components as _;
use saoms_core::schedule::{ChangeError, RunningFleet, Settings, Takeover};
use saoms_lang::assembly::Assembly;
use saoms_lang::project::Project;
use saoms_lang::registry::Registry;

use crate::support::root;

fn assembly(composite: &str) -> Assembly {
    let path = root().join("composites").join(composite);
    let compilation = Project::new().file(path).compile(&Registry::linked().unwrap());
    compilation.output.unwrap()
}

#[test]
fn robots_go_on_in_their_successors_in_the_middle_of_their_jobs_and_no_luggage_is_lost() {
    let assembly = assembly("scenario4.composite");
    let robots: Vec<_> =
        assembly.components.iter().filter(|one| one.class.name().contains("Robot0")).cloned().collect();
    assert_eq!(robots.len(), 10);
    for seed in 0..3 {
        let settings = Settings { limit: Some(Duration::from_secs(3600)), ..Settings::simulated(seed) };
        let fleet = RunningFleet::start(assembly.clone(), settings, Vec::new()).unwrap();
        let mut replaced = 0;
        for step in 1..40_u64 {
            fleet.run_until(Time::from_nanos(step * 7_300_000_000));
            for robot in &robots {
                match fleet.handle().replace(robot.clone(), None) {
                    Ok(done) => {
                        assert_eq!(done, Takeover::Continued);
                        replaced += 1;
                    }
                    // The last steps are after the end of the run.
                    Err(error) => assert_eq!(error, ChangeError::Ending),
                }
            }
        }
        let report = fleet.run_to_end();
        assert_eq!(report.sections["luggage"]["delivered"], 100, "seed {seed}: {:?}", report.sections);
        assert_eq!(report.sections["luggage"]["open"], 0, "seed {seed}");
        assert_eq!(report.sections["collisions"]["vertex"], 0, "seed {seed}");
        assert!(replaced > 40, "seed {seed}: {replaced} replaced");
        let counted: u32 = report.components.iter().map(|one| one.replaced).sum();
        assert_eq!(counted, replaced, "seed {seed}");
    }
}
