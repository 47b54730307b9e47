use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use saoms_api::host::SharedMessage;
use saoms_api::{Cause, Chance, Departed, Failure};
use saoms_lang::assembly::ComponentSpec;
use saoms_lang::schema::Schema;

use super::body::Job;
use super::collection::Collection;
use super::effects::Effects;
use super::estate::Estate;
use super::lasting::Lasting;
use super::remote::{RemoteHeartbeat, Remotes};
use super::spent::Spent;
use super::stored::{Stored, StoredChange};
use super::unheard::Unheard;
use crate::bus::{TopicId, TopicReader};
use crate::fault::TaskFault;
use crate::journal::Recorder;
use crate::schedule::engine::failing::Told;
use crate::schedule::engine::memory::AlertForm;
use crate::schedule::engine::votes::Ballot;
use crate::schedule::order::InCode;
use crate::schedule::stop::RegisteredStop;
use crate::status::Description;
use crate::tape::Tape;

/// The part of a body that the component's context works with.
pub(crate) struct Part {
    pub(crate) index: u32,
    pub(crate) name: Arc<str>,
    /// The functions of the instance that stop its hardware.
    pub(crate) stops: Vec<Arc<RegisteredStop>>,
    /// Components whose hardware hears of each of its executions.
    pub(crate) heartbeats: Vec<u32>,
    /// The same of other programs, and what it calls there.
    pub(crate) heartbeats_elsewhere: Option<Box<[RemoteHeartbeat]>>,
    pub(crate) remotes: Option<Box<Remotes>>,
    pub(crate) publishers: Vec<TopicId>,
    /// Schemas of the topics on which messages were sent as bytes.
    pub(crate) schemas: Vec<(TopicId, Arc<Schema>)>,
    pub(crate) subscriptions: Vec<TopicReader>,
    /// The last collection of all subscriptions.
    pub(crate) collection: Collection,
    /// Messages that left the regions of subscriptions, for the present execution or reaction.
    pub(crate) departed: Vec<Vec<Departed>>,
    pub(crate) has_departed: bool,
    /// Subscriptions of a failed instance, for the instance that replaces it.
    pub(crate) kept: Vec<TopicReader>,
    pub(crate) outbox: Vec<(TopicId, SharedMessage)>,
    /// True if there is an event in the outbox.
    pub(crate) has_raised: bool,
    /// What the present code keeps once it has finished, and what is kept.
    pub(crate) to_keep: Vec<StoredChange>,
    pub(crate) stored: Stored,
    /// What others kept that the change ended or replaced with which the instance began.
    pub(crate) estate: Estate,
    /// What a restart goes on from.
    pub(crate) lasting: Lasting,
    /// What it wants outside of the program, and has not begun.
    pub(crate) effects: Effects,
    /// The alerts that it has raised and that are not over.
    pub(crate) alerts: Vec<AlertForm>,
    /// Bytes in the outbox from code of libraries.
    pub(crate) sent_bytes: usize,
    /// What the present code has written.
    pub(crate) spent: Spent,
    pub(crate) unheard: Unheard,
    /// True once the report had no room for what it contributes.
    pub(crate) is_report_full: bool,
    /// Number of the code that runs, or ran last, where there is a memory.
    pub(crate) code: u64,
    /// Number of calls within which its code runs.
    pub(crate) call_depth: u32,
    pub(crate) chance: Chance,
    pub(crate) cancelled: Arc<AtomicBool>,
    /// True while it is stopped in an emergency: its hardware hears no heartbeat.
    pub(crate) emergency: Arc<AtomicBool>,
    pub(crate) vote: Option<Ballot>,
    /// Answer to the question what it waits for.
    pub(crate) waits_for: Option<String>,
    /// Answer to the question what an operator wants to know.
    pub(crate) described: Option<Arc<Description>>,
    /// Why it gave none for a sample.
    pub(crate) undescribed: Option<Failure>,
    /// The order, or the call of another program, that it carries out.
    pub(crate) order: Option<Box<InCode>>,
    /// In virtual time, the time at which the present code runs.
    pub(crate) now: u64,
    pub(crate) due: u64,
    pub(crate) execution: u64,
    pub(crate) period: u64,
    pub(crate) initializing: bool,
    /// True in the shutdown at the end of the run.
    pub(crate) is_ending: bool,
    /// True if a shutdown that finds another component busy is tried again.
    pub(crate) retries_shutdown: bool,
    /// The component whose code made the present execution fail, if that is another one.
    pub(crate) blamed: Option<u32>,
    /// What was told of the failure of the present code, before the instance was dropped.
    pub(crate) told: Option<Told>,
    /// The fault of the present execution.
    pub(crate) fault: Option<TaskFault>,
    /// The crash of the present execution, with the time to its restart.
    pub(crate) crash: Option<Option<Duration>>,
    /// Records for the journal.
    pub(crate) recorder: Recorder,
    /// What it gets and does, where an observer wants that.
    pub(crate) tape: Option<Box<Tape>>,
    /// Specification of the component; the targets of its wires are slot numbers.
    pub(crate) spec: Arc<ComponentSpec>,
    /// True if the instance is part of a change that is not committed: its messages are held back.
    pub(crate) held: bool,
    /// Its number while its code runs in a change that may leave it behind.
    pub(crate) apart: Option<u64>,
}

impl Part {
    pub(super) fn new(
        index: u32,
        spec: Arc<ComponentSpec>,
        name: Arc<str>,
        period: u64,
        cancelled: Arc<AtomicBool>,
    ) -> Part {
        Part {
            index,
            name,
            stops: Vec::new(),
            heartbeats: Vec::new(),
            heartbeats_elsewhere: None,
            remotes: None,
            publishers: Vec::new(),
            schemas: Vec::new(),
            subscriptions: Vec::new(),
            collection: Collection::default(),
            departed: Vec::new(),
            has_departed: false,
            kept: Vec::new(),
            outbox: Vec::new(),
            has_raised: false,
            to_keep: Vec::new(),
            stored: Stored::default(),
            estate: Estate::default(),
            lasting: Lasting::default(),
            effects: Effects::default(),
            alerts: Vec::new(),
            sent_bytes: 0,
            spent: Spent::default(),
            unheard: Unheard::default(),
            is_report_full: false,
            code: 0,
            call_depth: 0,
            chance: Chance::new(0),
            cancelled,
            emergency: Arc::default(),
            vote: None,
            waits_for: None,
            described: None,
            undescribed: None,
            order: None,
            now: 0,
            due: 0,
            execution: 0,
            period,
            initializing: false,
            is_ending: false,
            retries_shutdown: false,
            blamed: None,
            told: None,
            fault: None,
            crash: None,
            recorder: Recorder::default(),
            tape: None,
            spec,
            held: true,
            apart: None,
        }
    }

    /// Begins an execution, or a call whose caller has this cause.
    #[inline]
    pub(super) fn begin(&mut self, because: Cause) {
        self.recorder.begin(because);
        self.spent = Spent::default();
        (self.blamed, self.told) = (None, None);
    }

    /// Holds a class that declares it to the registration of a function that stops hardware.
    pub(crate) fn has_registered_stop(&self) -> Result<(), Failure> {
        if self.stops.is_empty() && self.spec.class.declaration().stops {
            return Err(Failure::new(format!(
                "class `{}` declares that it `stops` its hardware, but `initialize` registered no function for that: \
                 call `Context::register_stop`",
                self.spec.class.name()
            )));
        }
        Ok(())
    }

    /// True if the instance tries again, with the same messages.
    #[cold]
    pub(super) fn keeps_instance(&self, job: Job, failure: &Failure) -> bool {
        let tries_again = matches!(job, Job::Execute | Job::React) || job == Job::Shutdown && self.retries_shutdown;
        tries_again && self.busy_provider(failure).is_some()
    }

    /// The other component whose code was running when this one called it, if that is why it failed. A component that
    /// finds itself busy is part of a cycle of calls, and never becomes free.
    #[cold]
    pub(crate) fn busy_provider<'a>(&self, failure: &'a Failure) -> Option<&'a str> {
        failure.busy_provider().filter(|provider| **provider != *self.name)
    }

    /// Names the loop whose code panicked, if it was one.
    #[cold]
    pub(super) fn of_loop(&self, panic: Failure) -> Failure {
        match self.recorder.present().and_then(|place| self.spec.loops.get(usize::from(place))) {
            Some(one) => Failure::new(format!("loop `{}`: {panic}", one.name)),
            None => panic,
        }
    }

    /// True if hardware hears that it has executed.
    pub(super) fn beats(&self) -> bool {
        (!self.heartbeats.is_empty() || self.heartbeats_elsewhere.is_some()) && !self.emergency.load(Ordering::Relaxed)
    }

    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}
