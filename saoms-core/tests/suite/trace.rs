use crate::fleet::{run, simulated};

const FLEET: &str = "A actor period=10 publishes=TALK restart=15/9 each=[say-random; 5: fail now and then]
     B actor period=7 publishes=TABLE subscribes=TALK each=[put 1 2; 3: put 2 2]
     C actor period=30 task=B each=[unschedule; schedule]";

/// The digest of a run.
fn hash(fleet: &str, seed: u64, milliseconds: u64) -> String {
    let settings = saoms_core::schedule::Settings { seed, ..simulated(milliseconds) };
    run(fleet, settings).0.trace_hash.unwrap()
}

#[test]
fn the_same_seed_gives_the_same_run() {
    let first = hash(FLEET, 1, 2000);
    assert_eq!(first.len(), 16);
    assert_eq!(hash(FLEET, 1, 2000), first);
    assert_eq!(hash(&FLEET.replace("say-random", "random; say-random"), 1, 2000).len(), 16);
}

#[test]
fn the_hash_is_the_same_on_every_machine() {
    assert_eq!(hash("A actor period=10 publishes=TALK each=[say hello; say-random]", 1, 100), "023a0c30061cfb20");
}

#[test]
fn whatever_differs_gives_another_hash() {
    let first = hash(FLEET, 1, 2000);
    let others = [
        hash(FLEET, 2, 2000),
        hash(FLEET, 1, 2020),
        hash(&FLEET.replace("put 2 2", "put 2 3"), 1, 2000),
        hash(&FLEET.replace("period=7", "period=8"), 1, 2000),
        hash(&FLEET.replace("publishes=TABLE", "publishes=TABLE rename=TABLE/OTHER"), 1, 2000),
    ];
    for other in others {
        assert_ne!(other, first);
    }
}

#[test]
fn chance_depends_on_the_seed_and_the_name_alone() {
    let numbers = |fleet: &str, seed| {
        let (_, diary) = run(fleet, saoms_core::schedule::Settings { seed, ..simulated(30) });
        let told = diary.lines();
        told.lines().filter(|line| line.contains("A: chance")).map(str::to_owned).collect::<Vec<_>>()
    };
    let alone = numbers("A actor period=10 each=[random]", 1);
    assert_eq!(alone.len(), 3);
    assert_eq!(numbers("B actor period=5 each=[random]\nA actor period=10 each=[random]", 1), alone);
    assert_ne!(numbers("A actor period=10 each=[random]", 2), alone);
}

#[test]
fn in_real_time_there_is_no_hash() {
    let (report, _) = run("A actor period=10", crate::fleet::real(20));
    assert_eq!(report.trace_hash, None);
}
