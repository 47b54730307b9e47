use std::fmt;

use saoms_api::{Chance, Class, Failure};

use crate::Bench;

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

/// The same for a component that is constructed in another way, such as [`Bench::of_library`], or with wires.
///
/// # Panics
/// As [`comply`].
#[expect(clippy::panic, reason = "this is an assertion of tests")]
pub fn comply_as(mut make: impl FnMut() -> Result<Bench, Failure>) {
    let transcripts: Vec<String> = (0..2)
        .map(|_| match play(&mut make) {
            Ok(transcript) => transcript,
            Err((rule, failure)) => panic!("the component does not keep the rule that {rule}: {failure}"),
        })
        .collect();
    let different = transcripts[0].lines().zip(transcripts[1].lines()).find(|(one, other)| one != other);
    if transcripts[0] != transcripts[1] {
        let rule = Rule::IsDeterministic;
        let (one, other) = different.unwrap_or(("one line more", "one line less"));
        panic!("the component does not keep the rule that {rule}:\n  first {one}\n  then  {other}");
    }
}

fn play(make: &mut impl FnMut() -> Result<Bench, Failure>) -> Result<String, (Rule, Failure)> {
    let keeps = |rule: Rule| move |failure: Failure| (rule, failure);
    // The checker constructs components that never run.
    for _ in 0..20 {
        make().map(drop).map_err(keeps(Rule::Constructs))?;
    }
    let mut bench = make().map_err(keeps(Rule::Constructs))?.seed(7);
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
    let mut again = make().map_err(keeps(Rule::Restarts))?.seed(7);
    again.start().and_then(|()| again.execute()).map_err(keeps(Rule::Restarts))?;
    again.shutdown().map_err(keeps(Rule::Ends))?;
    Ok(bench.transcript() + &again.transcript())
}
