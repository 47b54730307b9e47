//! The components of a fleet that take events, and the messages by which an event reaches them.

use std::fmt;
use std::sync::Arc;

use saoms_api::event::{Event, EventCall, Events, receiver};
use saoms_api::extension::LineFault;
use saoms_lang::assembly::{Assembly, ComponentSpec};
use saoms_lang::schema::Schema;

/// The components of a fleet that take events, as [`Handle::takers`](crate::schedule::Handle::takers) gives them.
///
/// An event reaches all components of a site that take it, or one of them: `to Hall1`.
#[derive(Debug, Default)]
pub struct Takers {
    events: Arc<Events>,
    all: Vec<Taker>,
}

/// A component that takes an event.
#[derive(Debug)]
struct Taker {
    /// The number of the component.
    number: u32,
    spec: Arc<ComponentSpec>,
    event: String,
    /// The topic of the messages, by the name that it has after renaming.
    topic: String,
    schema: Arc<Schema>,
}

/// A message by which an event reaches components.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EventMessage {
    /// The topic, by the name that it has after renaming.
    pub topic: String,
    /// The number of the only component that receives it; `None` where all readers of the topic do.
    pub to: Option<u32>,
    /// Its CDR form, which fits the schema of the topic.
    pub bytes: Vec<u8>,
    /// Its key and its block.
    pub(in crate::schedule) marks: (Option<u64>, Option<(i32, i32)>),
}

/// Error of an event that does not happen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RaiseError {
    /// What is wrong with it, at its place.
    Wrong(LineFault),
    /// The run ends.
    Ending,
}

impl fmt::Display for RaiseError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RaiseError::Wrong(fault) => fault.fmt(formatter),
            RaiseError::Ending => formatter.write_str("the run ends"),
        }
    }
}

impl std::error::Error for RaiseError {}

impl Takers {
    /// The takers of a fleet that does not run yet.
    pub fn of_assembly(assembly: &Assembly) -> Takers {
        Takers::of((0..).zip(assembly.all().map(|spec| Arc::new(spec.clone()))))
    }

    /// The takers among these components, given with their numbers.
    pub(in crate::schedule) fn of(specs: impl Iterator<Item = (u32, Arc<ComponentSpec>)>) -> Takers {
        let mut all: Vec<Taker> = Vec::new();
        let mut events: Vec<Event> = Vec::new();
        for (number, spec) in specs.filter(|(_, spec)| !spec.class.declaration().takes.is_empty()) {
            let class = Arc::clone(&spec.class);
            let declaration = class.declaration();
            if events.iter().all(|known| !known.classes.contains(&declaration.name)) {
                events.extend(declaration.events());
            }
            for (taken, declared) in declaration.taken() {
                let same = |one: &&Taker| one.event == taken.event && Arc::ptr_eq(&one.spec.class, &class);
                let known = all.iter().rev().find(same).map(|one| Arc::clone(&one.schema));
                // The registry refuses a class with another schema.
                let Some(schema) = known.or_else(|| Schema::of(&declared.schema).ok().map(Arc::new)) else { continue };
                let topic = spec.topic(&declared.name).into_owned();
                all.push(Taker { number, spec: Arc::clone(&spec), event: taken.event.clone(), topic, schema });
            }
        }
        Takers { events: Arc::new(Events::of(events)), all }
    }

    /// The events that they take.
    pub fn events(&self) -> &Arc<Events> {
        &self.events
    }

    /// True if a component of the site takes the event.
    pub fn take(&self, site: &str, event: &str) -> bool {
        self.of_site(site, event).next().is_some()
    }

    fn of_site<'t>(&'t self, site: &'t str, event: &'t str) -> impl Iterator<Item = &'t Taker> {
        self.all.iter().filter(move |one| one.event == event && one.spec.site == *site)
    }

    /// The messages of an event for a site, one on each topic by which components take it. Its fields have single
    /// values: see [`EventCall::drawn`].
    ///
    /// # Errors
    /// The event is unknown, a field is wrong, or the component behind `to` does not take it: the words that say so.
    pub fn messages(&self, site: &str, call: &EventCall) -> Result<Vec<EventMessage>, LineFault> {
        let event = self.events.find(call)?;
        event.check(call)?;
        let mut takers: Vec<&Taker> = self.of_site(site, &event.name).collect();
        if takers.is_empty() {
            return Err(self.nobody(site, call));
        }
        if let Some(to) = &call.to {
            let paths: Vec<&str> = takers.iter().map(|one| one.spec.path.as_str()).collect();
            takers = vec![takers[receiver(&paths, to, &event.name)?]];
        }
        let mut messages: Vec<EventMessage> = Vec::new();
        for taker in takers {
            if messages.iter().any(|known| known.topic == taker.topic) {
                continue;
            }
            let bytes = saoms_lang::event::message(event, call, &taker.schema);
            let bytes = bytes.map_err(|error| LineFault::new(call.bytes(), error.to_string()))?;
            let marks = (taker.schema.key(&bytes), taker.schema.place(&bytes));
            let to = call.to.as_ref().map(|_| taker.number);
            messages.push(EventMessage { topic: taker.topic.clone(), to, bytes, marks });
        }
        Ok(messages)
    }

    /// The fault of an event that no component of its site takes.
    fn nobody(&self, site: &str, call: &EventCall) -> LineFault {
        let name = &call.name.text;
        let place = if site.is_empty() { "outside of sites".to_owned() } else { format!("in the site `{site}`") };
        let fault = LineFault::new(call.name.bytes.clone(), format!("no component {place} takes the event `{name}`"));
        let mut sites: Vec<&str> =
            self.all.iter().filter(|one| one.event == *name).map(|one| one.spec.site.as_str()).collect();
        sites.sort_unstable();
        sites.dedup();
        match sites.iter().find(|site| !site.is_empty()) {
            Some(first) => {
                let all = sites.iter().filter(|site| !site.is_empty()).map(|site| format!("`{site}`"));
                let all = all.collect::<Vec<_>>().join(", ");
                fault.help(format!("it is taken in {all}: write the site first, as in `{first}: {name} ...`"))
            }
            None => fault.help("it is taken outside of sites: write it without a site"),
        }
    }
}
