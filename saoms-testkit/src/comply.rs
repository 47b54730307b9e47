use std::fmt;

use saoms_api::host::KnowledgeClass;
use saoms_api::{Chance, Class, Failure, LoopClass};

use crate::{Bench, LoopBench};

/// Number of messages of each topic that a component has to handle.
const MESSAGES: u32 = 60;

/// Rules for every component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rule {
    Constructs,
    DeclaresWhatItUses,
    StandsSilence,
    StandsAnyMessage,
    StandsBadBytes,
    StandsAnyKnowledge,
    Ends,
    Restarts,
    IsDeterministic,
}

impl fmt::Display for Rule {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Rule::Constructs => "it can be constructed with these values",
            Rule::DeclaresWhatItUses => "it starts, with the topics and references that it declares",
            Rule::StandsSilence => "it stands executions in which nothing arrives",
            Rule::StandsAnyMessage => "it stands any message of its topics",
            Rule::StandsBadBytes => "it stands bytes that are no message",
            Rule::StandsAnyKnowledge => "it stands any values of the entries that it senses",
            Rule::Ends => "it ends without a failure",
            Rule::Restarts => "it can start again after it ended",
            Rule::IsDeterministic => "it does the same when it hears the same, with the same seed and time",
        })
    }
}

/// Checks a component against the rules for every component: it can be constructed repeatedly, starts with the topics
/// and references that it declares, handles silence, any values in the messages of its topics and invalid bytes, shuts
/// down, restarts, and does the same for the same messages.
///
/// # Panics
/// With what it does not keep, and its own words.
///
/// ```
/// use saoms_components::master::MasterEnvironment;
///
/// saoms_testkit::comply::<MasterEnvironment>(&[]);
/// ```
pub fn comply<C: Class>(values: &[(&str, &str)]) {
    comply_as(|| Bench::of::<C>(values));
}

/// The same for a component that is constructed in another way, such as [`Bench::of_library`], with wires, or with
/// [loops](Bench::with_loop) of the test.
///
/// # Panics
/// As [`comply`].
pub fn comply_as(mut make: impl FnMut() -> Result<Bench, Failure>) {
    hold("component", || play(&mut make));
}

/// Checks a loop against the rules for every component, and with any values of the entries that it senses: it can be
/// constructed repeatedly, starts with what it declares, changes only that, and does the same for the same values and
/// messages. `knowledge` makes what it works on, with the entries that it names.
///
/// # Panics
/// With what it does not keep, and its own words.
///
/// ```
/// use saoms_components::robot::{Battery, Consumption, RobotKnowledge};
/// use saoms_components::robot::safe::SafeRobotList;
/// use saoms_components::grid::Block;
///
/// let battery = || Battery::new(100.0, Consumption::per_execution(2.0));
/// saoms_testkit::comply_loop::<SafeRobotList, RobotKnowledge>(
///     || RobotKnowledge::new("Robot1".to_owned(), 1, Block::new(0, 1), battery()),
///     &[],
/// );
/// ```
pub fn comply_loop<L: LoopClass, K: KnowledgeClass + Send>(knowledge: impl Fn() -> K, values: &[(&str, &str)]) {
    comply_loop_as(|| LoopBench::of::<L>(knowledge(), values));
}

/// The same for a loop that is constructed in another way, such as [`LoopBench::of_library`], or with wires.
///
/// # Panics
/// As [`comply_loop`].
pub fn comply_loop_as<K: KnowledgeClass + Send>(mut make: impl FnMut() -> Result<LoopBench<K>, Failure>) {
    hold("loop", || play(&mut make));
    hold("loop", || any_knowledge(&mut make));
}

/// Plays twice, and compares.
#[expect(clippy::panic, reason = "this is an assertion of tests")]
fn hold(what: &str, mut play: impl FnMut() -> Result<String, (Rule, Failure)>) {
    let transcripts: Vec<String> = (0..2)
        .map(|_| match play() {
            Ok(transcript) => transcript,
            Err((rule, failure)) => panic!("the {what} does not keep the rule that {rule}: {failure}"),
        })
        .collect();
    let different = transcripts[0].lines().zip(transcripts[1].lines()).find(|(one, other)| one != other);
    if transcripts[0] != transcripts[1] {
        let rule = Rule::IsDeterministic;
        let (one, other) = different.unwrap_or(("one line more", "one line less"));
        panic!("the {what} does not keep the rule that {rule}:\n  first {one}\n  then  {other}");
    }
}

fn any_knowledge<K: KnowledgeClass + Send>(
    make: &mut impl FnMut() -> Result<LoopBench<K>, Failure>,
) -> Result<String, (Rule, Failure)> {
    let keeps = |rule: Rule| move |failure: Failure| (rule, failure);
    let mut bench = make().map_err(keeps(Rule::Constructs))?.seed(7);
    bench.start().map_err(keeps(Rule::DeclaresWhatItUses))?;
    let mut chance = Chance::new(7);
    for _ in 0..MESSAGES {
        bench.change_what_it_senses(&mut chance);
        bench.execute().map_err(keeps(Rule::StandsAnyKnowledge))?;
    }
    bench.shutdown().map_err(keeps(Rule::Ends))?;
    Ok(bench.transcript())
}

/// What runs a component or a loop.
trait AsBench {
    fn seeded(self, seed: u64) -> Self;
    fn bench(&mut self) -> &mut Bench;
}

impl AsBench for Bench {
    fn seeded(self, seed: u64) -> Bench {
        self.seed(seed)
    }

    fn bench(&mut self) -> &mut Bench {
        self
    }
}

impl<K: KnowledgeClass + Send> AsBench for LoopBench<K> {
    fn seeded(self, seed: u64) -> LoopBench<K> {
        self.seed(seed)
    }

    fn bench(&mut self) -> &mut Bench {
        self
    }
}

fn play<B: AsBench>(make: &mut impl FnMut() -> Result<B, Failure>) -> Result<String, (Rule, Failure)> {
    let keeps = |rule: Rule| move |failure: Failure| (rule, failure);
    // The checker constructs components that never run.
    for _ in 0..20 {
        make().map(drop).map_err(keeps(Rule::Constructs))?;
    }
    let mut made = make().map_err(keeps(Rule::Constructs))?.seeded(7);
    let bench = made.bench();
    bench.start().map_err(keeps(Rule::DeclaresWhatItUses))?;
    for _ in 0..20 {
        bench.execute().map_err(keeps(Rule::StandsSilence))?;
    }
    let mut chance = Chance::new(7);
    let topics = bench.hears();
    for _ in 0..MESSAGES {
        for (topic, schema) in &topics {
            bench.deliver_bytes(topic, schema.sample(&mut chance));
        }
        bench.execute().map_err(keeps(Rule::StandsAnyMessage))?;
    }
    for length in [0, 1, 4, 5, 64] {
        for (topic, _) in &topics {
            bench.deliver_bytes(topic, (0..length).map(|_| chance.next_u64() as u8).collect());
        }
        bench.execute().map_err(keeps(Rule::StandsBadBytes))?;
    }
    bench.shutdown().map_err(keeps(Rule::Ends))?;
    let mut made_again = make().map_err(keeps(Rule::Restarts))?.seeded(7);
    let again = made_again.bench();
    again.start().and_then(|()| again.execute()).map_err(keeps(Rule::Restarts))?;
    again.shutdown().map_err(keeps(Rule::Ends))?;
    Ok(bench.transcript() + &again.transcript())
}
