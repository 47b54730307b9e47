use std::fmt;
use std::ops::{Deref, DerefMut};
#[cfg(feature = "fleets")]
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use saoms_api::host::contain::{contained, install_hook};
use saoms_api::host::{DynComponent, Invocation, KnowledgeClass, PropertyValue, SmolStr};
use saoms_api::{CallError, Chance, Context, Failure, Knowledge, LoopClass, Loops, ReportValue, Saved, Value};
#[cfg(feature = "fleets")]
use saoms_core::plugin::Plugin;
use saoms_registry::registry::RegisteredLoop;
use saoms_registry::schema::Schema;

use crate::Bench;
use crate::bench::{given, loop_class};

/// One loop on knowledge that a test provides: the test changes what the loop senses, and sees its decisions and
/// changes.
///
/// It is a [`Bench`] otherwise: [`start`](Bench::start), [`execute`](Bench::execute), messages, log, journal. In each
/// execution the loop monitors, analyzes, plans and executes, with the same checks as in a fleet: a loop that changes
/// what it does not declare has failed.
///
/// ```
/// use saoms_api::{
///     Adaptation, Context, Effector, Entry, Extras, Failure, Knowledge, LoopClass, SimpleLoop, Value, record,
/// };
/// use saoms_testkit::LoopBench;
///
/// /// What the loop works on.
/// #[derive(Default, Knowledge)]
/// #[knowledge(name = "test.Lamp")]
/// struct Lamp {
///     #[entry(unit = "lx")]
///     brightness: f64,
///     #[entry(effector)]
///     is_on: bool,
///     #[extras]
///     extras: Extras,
/// }
///
/// /// Switches a lamp on when it is dark.
/// #[derive(LoopClass)]
/// #[looping(name = "test.Dusk")]
/// struct Dusk {
///     #[senses]
///     brightness: Entry<f64>,
///     #[effects]
///     is_on: Effector<bool>,
/// }
///
/// impl SimpleLoop for Dusk {
///     type Properties = ();
///
///     fn adapt(&mut self, lamp: &dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Adaptation>, Failure> {
///         if self.brightness.get(lamp)? >= 10.0 || self.is_on.get(lamp)? {
///             return Ok(None);
///         }
///         let dark = Adaptation::of(record!(is_dark: "is dark"));
///         Ok(Some(dark.decides(record!(switches_on: "switches it on")).sets(&self.is_on, true)))
///     }
/// }
///
/// let mut bench = LoopBench::of::<Dusk>(Lamp { brightness: 50.0, ..Lamp::default() }, &[])?;
/// bench.start()?;
/// bench.execute()?;
/// assert_eq!(bench.journal(), [""; 0]);
/// bench.knowledge().brightness = 3.0;
/// bench.execute()?;
/// assert_eq!(bench.journal(), ["Dusk symptom: is dark", "Dusk decision: switches it on", "Dusk isOn: no -> yes"]);
/// assert!(bench.knowledge().is_on);
/// assert_eq!(bench.value("isOn"), Some(Value::Bool(true)));
/// # Ok::<(), Failure>(())
/// ```
pub struct LoopBench<K> {
    bench: Bench,
    knowledge: Arc<Mutex<K>>,
    class: Arc<RegisteredLoop>,
}

impl<K: KnowledgeClass + Send> LoopBench<K> {
    /// A loop that the test links, with these values of its properties.
    ///
    /// # Errors
    /// The loop refuses the values.
    pub fn of<L: LoopClass>(knowledge: K, values: &[(&str, &str)]) -> Result<LoopBench<K>, Failure> {
        LoopBench::of_class(&loop_class::<L>()?, knowledge, values)
    }

    /// A loop in a library, across the boundary to plugins. With the feature `fleets`.
    ///
    /// # Errors
    /// The library cannot be used, has no such loop, or the loop refuses the values.
    #[cfg(feature = "fleets")]
    pub fn of_library(
        library: &Path,
        name: &str,
        knowledge: K,
        values: &[(&str, &str)],
    ) -> Result<LoopBench<K>, Failure> {
        let mut registry = saoms_registry::registry::Registry::new();
        let plugin = Plugin::open(library).map_err(|error| Failure::new(error.to_string()))?;
        plugin.register(&mut registry).map_err(|error| Failure::new(error.to_string()))?;
        let class = registry.get_loop(name).ok_or_else(|| Failure::new(format!("there is no loop `{name}`")))?;
        LoopBench::of_class(class, knowledge, values)
    }

    fn of_class(class: &Arc<RegisteredLoop>, knowledge: K, values: &[(&str, &str)]) -> Result<LoopBench<K>, Failure> {
        install_hook();
        let values = given(values);
        let instance = contained(|| class.construct(&values))??;
        let short = class.declaration().short_name().to_owned();
        let knowledge = Arc::new(Mutex::new(knowledge));
        let component = Subject { knowledge: Arc::clone(&knowledge), loops: Loops::of([(short, instance)]) };
        Ok(LoopBench { bench: Bench::of_loop(class, Box::new(component)), knowledge, class: Arc::clone(class) })
    }

    /// Knowledge of the loop, to read it and to change it between executions.
    pub fn knowledge(&self) -> MutexGuard<'_, K> {
        self.knowledge.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Value of an entry by its name, including entries that the loop added; `None` if there is no such entry, or if it
    /// is no single value.
    pub fn value(&self, entry: &str) -> Option<Value> {
        let knowledge = self.knowledge();
        let knowledge: &dyn Knowledge = &*knowledge;
        let place = knowledge.all_declared().position(|declared| declared.name == entry)?;
        knowledge.value(u32::try_from(place).ok()?)
    }

    /// Sets each entry that the loop declares to sense to any value of its type; those that no loop can set stay.
    pub(crate) fn change_what_it_senses(&mut self, chance: &mut Chance) {
        let mut knowledge = self.knowledge();
        let knowledge: &mut dyn Knowledge = &mut *knowledge;
        let declared: Vec<_> = knowledge.all_declared().copied().collect();
        for (place, entry) in (0..).zip(&declared) {
            let senses = &self.class.declaration().senses;
            let text = format!(r#"{{"name":"Entry","fields":[{{"name":"value","type":{}}}]}}"#, entry.of);
            if let Ok(schema) = Schema::parse(&text)
                && senses.iter().any(|name| name == entry.name)
            {
                // An entry that the component alone keeps refuses it.
                let _ = knowledge.set_to_bytes(place, &schema.sample(chance));
            }
        }
    }

    /// Wires one of the loop's references, as [`Bench::wire`].
    #[must_use]
    pub fn wire(mut self, reference: &str, provider: Bench, service: &str) -> LoopBench<K> {
        self.bench = self.bench.wire(reference, provider, service);
        self
    }

    /// Sets the period, which is 100 ms by default.
    #[must_use]
    pub fn period(mut self, period: Duration) -> LoopBench<K> {
        self.bench = self.bench.period(period);
        self
    }

    /// Sets the seed of its random numbers, which is 0 by default.
    #[must_use]
    pub fn seed(mut self, seed: u64) -> LoopBench<K> {
        self.bench = self.bench.seed(seed);
        self
    }
}

impl<K> Deref for LoopBench<K> {
    type Target = Bench;

    fn deref(&self) -> &Bench {
        &self.bench
    }
}

impl<K> DerefMut for LoopBench<K> {
    fn deref_mut(&mut self) -> &mut Bench {
        &mut self.bench
    }
}

impl<K> fmt::Debug for LoopBench<K> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.bench.fmt(formatter)
    }
}

/// A component that only runs its loop.
struct Subject<K> {
    knowledge: Arc<Mutex<K>>,
    loops: Loops,
}

impl<K: Knowledge> Subject<K> {
    fn with<T>(&mut self, code: impl FnOnce(&mut Loops, &mut dyn Knowledge) -> T) -> T {
        let mut knowledge = self.knowledge.lock().unwrap_or_else(PoisonError::into_inner);
        code(&mut self.loops, &mut *knowledge)
    }
}

impl<K: Knowledge + Send> DynComponent for Subject<K> {
    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.with(|loops, knowledge| loops.initialize(knowledge, context))
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.with(|loops, knowledge| {
            loops.monitor(knowledge, context)?;
            loops.adapt(knowledge, context)
        })
    }

    fn update(&mut self, _: &[(SmolStr, PropertyValue)]) -> Result<(), Failure> {
        Err("a loop alone takes no new values".into())
    }

    fn react(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        Err("a loop alone reacts to no message".into())
    }

    fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.with(|loops, knowledge| loops.shutdown(knowledge, context))
    }

    fn serve(&mut self, invocation: &mut Invocation<'_>, _: &mut Context<'_>) -> Result<(), CallError> {
        Err(CallError::Mismatch { message: format!("a loop has no service `{}`", invocation.service) })
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(Saved::default())
    }

    fn restore(&mut self, _: &Saved) -> Result<(), Failure> {
        Err("a loop alone restores nothing".into())
    }

    fn waits_for(&self) -> Result<Option<String>, Failure> {
        Ok(None)
    }

    fn status(&self) -> Result<Vec<(String, ReportValue)>, Failure> {
        Ok(Vec::new())
    }
}
