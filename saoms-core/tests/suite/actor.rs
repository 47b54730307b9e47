//! A component that does what its properties say.
//!
//! A script is a list of commands, separated by `;`. A command may have a condition before it: `3:` is only in
//! execution 3 (from 0), `3+:` is from then on.

use std::time::{Duration, Instant};

use saoms_api::{
    CallError, Class, Component, Context, Failure, Level, Message, Properties, Publisher, ReportValue, Subscription,
    TaskInterfaceReference, Topic, Work, interface, record,
};

/// Something said aloud.
#[derive(Clone, Debug, PartialEq, Message)]
pub(crate) struct Words {
    pub text: String,
}

/// A value under a key.
#[derive(Clone, Debug, PartialEq, Message)]
#[message(key = "key")]
pub(crate) struct Entry {
    pub key: u32,
    pub value: i64,
}

/// A value of each publisher.
#[derive(Clone, Debug, PartialEq, Message)]
pub(crate) struct Own {
    pub value: i64,
}

pub(crate) const TALK: Topic<Words> = Topic::event("TALK");
pub(crate) const TABLE: Topic<Entry> = Topic::state("TABLE");
pub(crate) const OWN: Topic<Own> = Topic::state("OWN");
/// Not the same messages as `TALK`, for those who rename it so.
pub(crate) const NUMBERS: Topic<Own> = Topic::event("NUMBERS");

/// Answers.
#[interface(name = "test.Echo")]
pub(crate) trait Echo {
    /// Says the text again.
    fn echo(&mut self, context: &mut Context<'_>, text: String) -> Result<String, Failure>;
}

/// Actions of an actor with their times.
#[derive(Clone, Properties)]
pub(crate) struct Script {
    /// In `new`.
    #[property(default = "")]
    made: String,
    /// In `initialize`.
    #[property(default = "")]
    first: String,
    /// In each execution.
    #[property(default = "")]
    each: String,
    /// In each reaction.
    #[property(default = "")]
    reacts: String,
    /// In `shutdown`.
    #[property(default = "")]
    last: String,
    /// In each call.
    #[property(default = "")]
    called: String,
    /// What it waits for.
    #[property(default = "")]
    waits: String,
    /// What `status` does instead of an answer: `twice` gives a name to two values, and any other text is a panic.
    #[property(default = "")]
    says: String,
    /// The milliseconds that `status` takes.
    #[property(default = 0)]
    status: u32,
    /// The topics that it publishes.
    #[property(default = "")]
    publishes: String,
    /// The topics that it subscribes to.
    #[property(default = "")]
    subscribes: String,
}

#[derive(Default)]
struct Ends {
    say: Publisher<Words>,
    put: Publisher<Entry>,
    own: Publisher<Own>,
    number: Publisher<Own>,
    hear: Subscription<Words>,
    read: Subscription<Entry>,
    owns: Subscription<Own>,
    numbers: Subscription<Own>,
    peer: EchoReference,
    task: TaskInterfaceReference,
}

macro_rules! actor {
    ($(#[$meta:meta])* $name:ident, $($class:tt)*) => {
        $(#[$meta])*
        #[derive(Class)]
        #[class($($class)*)]
        pub(crate) struct $name {
            script: Script,
            ends: Ends,
        }

        impl Component for $name {
            type Properties = Script;

            fn new(script: Script) -> Result<Self, Failure> {
                if !script.made.is_empty() {
                    return Err(Failure::new(script.made));
                }
                Ok($name { script, ends: Ends::default() })
            }

            fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
                self.ends.connect(&self.script, context)?;
                self.ends.run(&self.script.first, context)
            }

            fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
                self.ends.run(&self.script.each, context)
            }

            fn react(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
                self.ends.run(&self.script.reacts, context)
            }

            fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
                self.ends.run(&self.script.last, context)
            }

            fn waits_for(&self) -> Option<String> {
                Some(self.script.waits.clone()).filter(|what| !what.is_empty())
            }

            fn status(&self) -> Vec<(String, ReportValue)> {
                std::thread::sleep(Duration::from_millis(self.script.status.into()));
                match self.script.says.as_str() {
                    "" => {}
                    "twice" => return ReportValue::named([("waits", 1.into()), ("waits", 2.into())]),
                    other => panic!("{other}"),
                }
                ReportValue::named([("waits", self.script.waits.as_str().into())])
            }
        }

        impl Echo for $name {
            fn echo(&mut self, context: &mut Context<'_>, text: String) -> Result<String, Failure> {
                self.ends.run(&self.script.called, context)?;
                Ok(format!("{text} from {}", context.name()))
            }
        }
    };
}

actor!(
    /// Does what its script says.
    Actor,
    name = "actor",
    periodic,
    reacts,
    publishes(TALK, TABLE, OWN, NUMBERS),
    subscribes(TALK, TABLE, OWN, NUMBERS),
    service("echo": Echo),
    reference("peer": Echo, optional),
    reference("task": saoms_api::TaskInterface, optional)
);

actor!(
    /// The same when called.
    Callee,
    name = "callee",
    passive,
    publishes(TALK),
    service("echo": Echo),
    reference("peer": Echo, optional),
    reference("task": saoms_api::TaskInterface, optional)
);

impl Ends {
    fn connect(&mut self, script: &Script, context: &mut Context<'_>) -> Result<(), Failure> {
        for topic in script.publishes.split_whitespace() {
            match topic {
                "TALK" => self.say = context.publish(&TALK)?,
                "TABLE" => self.put = context.publish(&TABLE)?,
                "OWN" => self.own = context.publish(&OWN)?,
                _ => self.number = context.publish(&NUMBERS)?,
            }
        }
        for topic in script.subscribes.split_whitespace() {
            match topic {
                "TALK" => self.hear = context.subscribe(&TALK)?,
                "TABLE" => self.read = context.subscribe(&TABLE)?,
                "OWN" => self.owns = context.subscribe(&OWN)?,
                _ => self.numbers = context.subscribe(&NUMBERS)?,
            }
        }
        self.peer = context.reference("peer")?;
        self.task = context.reference("task")?;
        Ok(())
    }

    fn run(&mut self, script: &str, context: &mut Context<'_>) -> Result<(), Failure> {
        for command in script.split(';').map(str::trim).filter(|command| !command.is_empty()) {
            let now = context.execution();
            let command = match command.split_once(':') {
                Some((condition, command)) => {
                    let applies = match condition.strip_suffix('+') {
                        Some(from) => from.parse::<u64>().is_ok_and(|from| now >= from),
                        None => condition.parse::<u64>().is_ok_and(|only| now == only),
                    };
                    if !applies {
                        continue;
                    }
                    command.trim()
                }
                None => command,
            };
            let (verb, rest) = command.split_once(' ').unwrap_or((command, ""));
            self.obey(verb, rest.trim(), context)?;
        }
        Ok(())
    }

    fn obey(&mut self, verb: &str, rest: &str, context: &mut Context<'_>) -> Result<(), Failure> {
        let number = || rest.rsplit(' ').next().unwrap_or("").parse::<i64>().unwrap_or(0);
        match verb {
            "log" => context.info(format_args!("{rest}")),
            "debug" => context.log(Level::Debug, format_args!("{rest}")),
            "console" => context.console(format_args!("{rest}")),
            "time" => context.info(format_args!("now {} due {}", context.now(), context.due())),
            "number" => {
                let (number, name, period) = (context.execution(), context.name().to_owned(), context.period());
                context.info(format_args!("{name} {number} every {period:?}"));
            }
            "random" => {
                let number = context.chance().below(1_000_000);
                context.info(format_args!("chance {number}"));
            }
            "say" => context.send(&self.say, Words { text: rest.to_owned() })?,
            "say-random" => {
                let text = context.chance().next_u64().to_string();
                context.send(&self.say, Words { text })?;
            }
            "flood" => {
                for word in 0..number() {
                    context.send(&self.say, Words { text: word.to_string() })?;
                }
            }
            "record" => {
                (0..number()).for_each(|piece| context.symptom(record!(piece_waits: "piece {piece} waits", piece)))
            }
            "decide" => (0..number()).for_each(|_| context.decision(record!(stays: "stays"))),
            "write" => (0..number()).for_each(|line| context.log(Level::Debug, line)),
            "show" => (0..number()).for_each(|line| context.console(line)),
            "hear" => {
                let heard: Vec<_> = context.receive(&self.hear).map(|words| words.text.as_str()).collect();
                context.info(format_args!("hears [{}]", heard.join(", ")));
            }
            "hear-last" => {
                let heard = context.receive_last(&self.hear).map(|words| words.text.clone());
                context.info(format_args!("hears {heard:?}"));
            }
            "hear-from" => {
                let headers = context.receive(&self.hear).with_headers();
                let heard: Vec<_> = headers
                    .map(|(header, words)| format!("{} by {} at {}", words.text, header.sender, header.sent))
                    .collect();
                context.info(format_args!("hears [{}]", heard.join(", ")));
            }
            "put" => {
                let key = rest.split(' ').next().unwrap_or("").parse().unwrap_or(0);
                context.send(&self.put, Entry { key, value: number() })?;
            }
            "read" => {
                let read: Vec<_> =
                    context.receive(&self.read).map(|entry| format!("{}={}", entry.key, entry.value)).collect();
                context.info(format_args!("reads [{}]", read.join(", ")));
            }
            "own" => context.send(&self.own, Own { value: number() })?,
            "owns" => {
                let read: Vec<_> = context.receive(&self.owns).map(|own| own.value.to_string()).collect();
                context.info(format_args!("reads [{}]", read.join(", ")));
            }
            "fail" => return Err(Failure::new(rest)),
            "panic" => panic!("{rest}"),
            "sleep" => std::thread::sleep(Duration::from_millis(number().unsigned_abs())),
            "spin" => {
                let end = Instant::now() + Duration::from_millis(number().unsigned_abs());
                while Instant::now() < end {
                    std::hint::spin_loop();
                }
            }
            "until-cancelled" => {
                while !context.cancelled() {
                    std::thread::sleep(Duration::from_millis(1));
                }
            }
            "cancelled" => context.info(format_args!("cancelled {}", context.cancelled())),
            "done" => context.vote(Work::Done),
            "open" => context.vote(Work::Open),
            "gave-up" => context.vote(Work::GivenUp),
            "count" => context.count(rest.split(' ').next().unwrap_or(""), number()),
            "report" => context.report(rest.split(' ').next().unwrap_or(""), number()),
            "ask" => match self.peer.echo(context, rest.to_owned()) {
                Ok(answer) => context.info(format_args!("is told {answer:?}")),
                Err(error) => context.info(format_args!("is told nothing: {error}")),
            },
            "must-ask" => {
                self.peer.echo(context, rest.to_owned())?;
            }
            "wired" => context.info(format_args!("wired {}", context.is_wired(&self.peer))),
            "schedule" => answer(self.task.schedule(context), context),
            "schedule-for" => answer(self.task.schedule_for(context, number().unsigned_abs()), context),
            "unschedule" => answer(self.task.unschedule(context), context),
            "running" => match self.task.is_running(context) {
                Ok(running) => context.info(format_args!("running {running}")),
                error => answer(error.map(drop), context),
            },
            "publish-late" => {
                context.publish(&TALK)?;
            }
            other => panic!("no such command: {other}"),
        }
        Ok(())
    }
}

fn answer(result: Result<(), CallError>, context: &mut Context<'_>) {
    if let Err(error) = result {
        context.info(format_args!("cannot: {error}"));
    }
}
