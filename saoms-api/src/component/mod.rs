pub(crate) mod derived;
pub(crate) mod dyn_component;
pub(crate) mod registration;
mod saved;
mod stop;
mod task;

use crate::host::{Derived, Invocation, LoopRegistration};
use crate::{CallError, Context, Failure, Properties, ReportValue};

pub use derived::Own;
pub use saved::Saved;
pub use stop::StopFunction;
pub use task::{TaskInterface, TaskInterfaceReference};

/// A component of a fleet, written by an author.
///
/// The host calls, always from one thread at a time and never twice at once:
///
/// 1. [`new`](Component::new) with the properties of the composite. It may refuse values that do not fit together; it
///    does no work, opens nothing and sends nothing, because the checker constructs components that will never run.
/// 2. [`initialize`](Component::initialize) once, when the component is scheduled: it requests its topics and
///    references.
/// 3. [`execute`](Component::execute) once in each period. Messages that it sends leave when it returns.
/// 4. [`shutdown`](Component::shutdown) once, when the component is unscheduled or the run ends.
///
/// A component that is scheduled again, or restarted after a failure, is a new one from [`new`](Component::new) on.
///
/// # Failures
/// An `Err` and a panic from `initialize`, `execute` or `shutdown` are the same to the host: the component has failed,
/// the report counts it, and its `restart` policy decides. Other components continue.
///
/// # Blocking
/// `execute` must not wait for anything. An execution beyond the watchdog's budget is reported, and from then on the
/// component runs on a worker thread, where it is less punctual:
///
/// ```
/// # use std::time::Duration;
/// # use saoms_api::{Class, Component, Context, Failure, Message, Publisher};
/// # #[derive(Clone, Debug, Message)]
/// # struct Arrived;
/// # #[derive(Class)]
/// # #[class(name = "example.Wheels", periodic)]
/// # struct Wheels { arrived: Publisher<Arrived>, drive_time: Duration }
/// # impl Component for Wheels {
/// # type Properties = ();
/// fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
///     std::thread::sleep(self.drive_time); // wrong: no other component can run, or this one becomes late
///     context.send(&self.arrived, Arrived)
/// }
/// # }
/// ```
///
/// Remember the state instead, and look again in the next period:
///
/// ```
/// # use saoms_api::{Class, Component, Context, Failure, Message, Publisher, Time};
/// # #[derive(Clone, Debug, Message)]
/// # struct Arrived;
/// # #[derive(Class)]
/// # #[class(name = "example.Wheels", periodic)]
/// # struct Wheels { arrived: Publisher<Arrived>, arrival: Time }
/// # impl Component for Wheels {
/// # type Properties = ();
/// fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
///     if context.now() < self.arrival {
///         return Ok(());
///     }
///     context.send(&self.arrived, Arrived)
/// }
/// # }
/// ```
pub trait Component: Derived + Send + Sized + 'static {
    /// Properties that the composite sets: [`Own<Self>`](crate::Own) where fields declare them with `#[property]`, a
    /// struct that derives [`Properties`], or `()`.
    type Properties: Properties;

    /// Makes the component. By itself it has the values of the composite in the fields with `#[property]` and
    /// `#[properties]`, and everything else is its `Default`: a component with other fields writes this function.
    ///
    /// # Errors
    /// The values do not fit together; the message names the values and the reason. [`Finding`](crate::Finding)s are
    /// shown in the composite at the very values, or parts of values, that they are about, all of them at once.
    fn new(properties: Self::Properties) -> Result<Self, Failure> {
        <Self as Derived>::made::<true>(properties)
    }

    /// The component that [`new`](Component::new) makes by itself: for a `new` that checks values.
    ///
    /// ```
    /// use saoms_api::{Class, Component, Failure, Own};
    ///
    /// /// Heats between two temperatures.
    /// #[derive(Class)]
    /// #[class(name = "example.Heater", periodic)]
    /// struct Heater {
    ///     /// Where it begins to heat.
    ///     #[property(default = 18.0, unit = "degrees Celsius")]
    ///     lowest: f64,
    ///     /// Where it stops.
    ///     #[property(default = 22.0, unit = "degrees Celsius")]
    ///     highest: f64,
    ///     is_on: bool,
    /// }
    ///
    /// impl Component for Heater {
    ///     type Properties = Own<Self>;
    ///
    ///     fn new(properties: Own<Self>) -> Result<Self, Failure> {
    ///         let heater = Self::made(properties)?;
    ///         if heater.lowest > heater.highest {
    ///             return Err("`lowest` is above `highest`".into());
    ///         }
    ///         Ok(heater)
    ///     }
    /// }
    /// ```
    ///
    /// # Errors
    /// The component that it extends refuses the values.
    fn made(properties: Self::Properties) -> Result<Self, Failure> {
        <Self as Derived>::made::<true>(properties)
    }

    /// Begins the work. The handles in fields (`#[publishes]` and the like) are bound before; others are asked for
    /// here. By itself it starts what it extends, or its loops.
    ///
    /// # Errors
    /// The component cannot start; at the start of a fleet nothing starts then.
    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        derived::initialize(self, context)
    }

    /// Does the work of one period. Never called for a passive component. By itself it does that of what it extends, or
    /// of its loops.
    ///
    /// # Errors
    /// The component has failed.
    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        derived::execute(self, context)
    }

    /// Handles messages of the topics that the composite names in `trigger`, at once and not in the next execution. The
    /// class declares `reacts`.
    ///
    /// Each such message comes here alone, and those of all other topics to [`execute`](Component::execute). Without a
    /// `trigger` in the composite all come to `execute`, so a component handles them in both. A reaction is no
    /// execution: its [number](Context::execution) and the due times of executions do not change. It is due when the
    /// message arrives, or when `minimum` has passed since the last reaction; the `deadline` counts from the message.
    /// By itself it does what the component that it extends does.
    ///
    /// ```
    /// use saoms_api::{Class, Component, Context, Failure, Message, Subscription, Topic};
    ///
    /// /// An obstacle in front of a robot.
    /// #[derive(Clone, Debug, Message)]
    /// struct Obstacle {
    ///     metres: f64,
    /// }
    ///
    /// const OBSTACLE: Topic<Obstacle> = Topic::event("OBSTACLE");
    ///
    /// /// Brakes for obstacles, with `<property name="trigger" value="OBSTACLE"/>` at once.
    /// #[derive(Class)]
    /// #[class(name = "example.Brake", periodic, reacts)]
    /// struct Brake {
    ///     #[subscribes(OBSTACLE)]
    ///     obstacles: Subscription<Obstacle>,
    /// }
    ///
    /// impl Brake {
    ///     fn look(&mut self, context: &mut Context<'_>) {
    ///         if context.receive(&self.obstacles).any(|obstacle| obstacle.metres < 1.0) {
    ///             context.info("brakes");
    ///         }
    ///     }
    /// }
    ///
    /// impl Component for Brake {
    ///     type Properties = ();
    ///
    ///     fn react(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
    ///         self.look(context);
    ///         Ok(())
    ///     }
    ///
    ///     fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
    ///         self.look(context);
    ///         Ok(())
    ///     }
    /// }
    /// ```
    ///
    /// # Errors
    /// The component has failed.
    fn react(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.base_mut().map_or(Ok(()), |base| base.react(context))
    }

    /// Takes new values of properties that are declared `#[property(live)]`, between two executions: `properties` are
    /// all of them, those that did not change with the values that they have. By itself it puts them into the fields
    /// with `#[property]` and `#[properties]`.
    ///
    /// ```
    /// use saoms_api::{Class, Component, Context, Failure, Own};
    ///
    /// /// Heats up to a temperature, which can be changed while it runs.
    /// #[derive(Class)]
    /// #[class(name = "example.Heater", periodic)]
    /// struct Heater {
    ///     #[property(default = 20.0, live)]
    ///     target: f64,
    ///     is_locked: bool,
    /// }
    ///
    /// impl Component for Heater {
    ///     type Properties = Own<Self>;
    ///
    ///     fn update(&mut self, properties: Own<Self>) -> Result<(), Failure> {
    ///         if self.is_locked {
    ///             return Err("it is locked".into());
    ///         }
    ///         self.target = properties.target;
    ///         Ok(())
    ///     }
    /// }
    /// ```
    ///
    /// # Errors
    /// It refuses the values, and goes on with those that it has.
    fn update(&mut self, properties: Self::Properties) -> Result<(), Failure> {
        Derived::renew(self, properties)
    }

    /// Ends the work; messages sent here are still delivered. By itself it ends what it extends, or its loops.
    ///
    /// # Errors
    /// The component could not end properly.
    fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        derived::shutdown(self, context)
    }

    /// Saves the state for a successor. If the class declares `saves`, the host calls it after each execution of a
    /// component whose `restart` can start it anew, and the new one continues from the state of the last execution that
    /// did not fail: then it has to succeed between any two executions, also in the middle of a job.
    ///
    /// Of any class it is called when the library was rebuilt while the fleet runs (`saoms run --reload`):
    /// between two executions, this is called of the one that runs, then [`initialize`](Component::initialize) and
    /// [`restore`](Component::restore) of the new one, which takes its place. [`shutdown`](Component::shutdown) is not
    /// called. By default nothing is saved, and the new one starts without state.
    ///
    /// ```
    /// # use saoms_api::{Class, Component, Context, Failure, Message, Saved};
    /// #[derive(Clone, Debug, Message)]
    /// struct State {
    ///     blocks: u64,
    /// }
    ///
    /// # #[derive(Class)]
    /// # #[class(name = "example.Odometer", periodic)]
    /// # struct Odometer { blocks: u64, drives: bool }
    /// # impl Component for Odometer {
    /// # type Properties = ();
    /// fn save(&mut self) -> Result<Saved, Failure> {
    ///     if self.drives {
    ///         return Err("it drives".into());
    ///     }
    ///     Ok(Saved::of(&State { blocks: self.blocks }))
    /// }
    ///
    /// fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
    ///     if let Some(State { blocks }) = saved.read()? {
    ///         self.blocks = blocks;
    ///     }
    ///     Ok(())
    /// }
    /// # }
    /// ```
    ///
    /// # Errors
    /// It cannot be replaced now: it stays, and is asked again a second later.
    fn save(&mut self) -> Result<Saved, Failure> {
        self.base_mut().map_or_else(|| Ok(Saved::default()), |base| base.save())
    }

    /// Goes on where an earlier build was. Not called where that saved nothing.
    ///
    /// # Errors
    /// It cannot continue from that state: the earlier one stays.
    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        if let Some(base) = self.base_mut() {
            return base.restore(saved);
        }
        Err("the earlier build saved its state, and this one does not implement `restore`".into())
    }

    /// Says what the component waits for, so that a run in which nothing can happen any more names it: asked when
    /// nothing has happened in the fleet for a while.
    ///
    /// `Some` promises that the component does none of the work that is left until a message or a call reaches it,
    /// however long that takes. The text completes "it waits for". `None`, which is the default, promises nothing. In
    /// virtual time a run without a limit ends when all promise.
    fn waits_for(&self) -> Option<String> {
        self.base()?.waits_for().ok()?
    }

    /// What an operator wants to know of the component now, as named values: asked between two executions when somebody
    /// looks at the running fleet (`saoms status`), once a second for its plots, and while a run is recorded
    /// (`saoms run --report`). What the program counts itself (executions, failures, messages) is
    /// not among them. It is quick, and changes nothing. Two values of the same name are a failure.
    ///
    /// ```
    /// use saoms_api::{Class, Component, Own, ReportValue};
    ///
    /// /// Heats up to a temperature.
    /// #[derive(Class)]
    /// #[class(name = "example.Heater", periodic)]
    /// struct Heater {
    ///     #[property(default = 20.0)]
    ///     target: f64,
    ///     measured: f64,
    /// }
    ///
    /// impl Component for Heater {
    ///     type Properties = Own<Self>;
    ///
    ///     fn status(&self) -> Vec<(String, ReportValue)> {
    ///         ReportValue::named([("target", self.target.into()), ("measured", self.measured.into())])
    ///     }
    /// }
    /// ```
    fn status(&self) -> Vec<(String, ReportValue)> {
        self.base().and_then(|base| base.status().ok()).unwrap_or_default()
    }
}

/// The declaration of a component, which `#[derive(Class)]` writes.
///
/// The doc of the struct becomes that of the class. `#[class(...)]` takes, in any order and in one or several
/// attributes:
///
/// | attribute | meaning |
/// | --- | --- |
/// | `name = "saoms.Robot"` | the name that composite files use |
/// | `periodic` or `passive` | whether it is executed in each period; a passive one cannot subscribe |
/// | `service("move": Robot)` | a service with this [interface](crate::host::Interface), which the component implements |
/// | `apart` | it never runs on the thread of the timer, as code that may wait; nor do those that are wired to it |
/// | `alternates` | without a `delay`, it begins half a period later: between those that begin at once, whose messages it answers |
/// | `saves` | it [saves](Component::save) its state after each execution, for the one that a restart puts in its place, and for the next program with the same state folder |
/// | `reacts` | it has a function [`react`](Component::react) for messages that trigger it |
/// | `stops` | it registers a function that [stops its hardware](crate::StopFunction) |
/// | `loops(A, B, C)` | the [loops](crate::LoopClass) that it has unless a composite changes them, in their order |
/// | `loops(property = "policy", safe(A, B), classic(A, C))` | the same, one list for each value of a property |
/// | `also("robot.Robot001", number = 1)` | a further name, with properties preset to literals |
///
/// The fields say the rest, each in one attribute:
///
/// | field | what it is |
/// | --- | --- |
/// | `#[publishes(COUNT)] count: Publisher<Count>` | a publisher of this [`Topic`](crate::Topic) |
/// | `#[subscribes(COUNT)] count: Subscription<Count>` | a subscription of it |
/// | `#[reference] gps: GpsReference` | a service of another component that this one calls, with the name of the field |
/// | `#[reference("gps")] gps: Option<GpsReference>` | one that needs no target, under another name; it is `None` without a target |
/// | `#[reference] lights: Vec<LightReference>` | one that takes several targets; with `optional`, as in `#[reference(optional)]`, also none |
/// | `#[property(default = 1, range = 1..=100)] step: u32` | a property, with all that [`Properties`] allows |
/// | `#[properties] properties: CounterProperties` | all properties, as a struct, in the place of single ones |
/// | `#[knowledge] knowledge: LampKnowledge`, `#[loops] loops: Loops` | the [knowledge](crate::host::KnowledgeClass), and the loops that work on it |
/// | `#[extends] robot: Robot` | what it extends, see below |
///
/// Handles are bound before [`initialize`](Component::initialize), and a component whose other fields have a default
/// needs no [`new`](Component::new). With `#[property]` fields, `type Properties` is [`Own<Self>`](crate::Own).
///
/// What is not kept in a field is declared in `#[class(...)]`, too, and requested in `initialize`: `publishes(A, B)`,
/// `subscribes(A, B)`, `reference("gps": Gps)` with `optional` and `many` behind it, `knowledge = RobotKnowledge`.
///
/// Linked classes register themselves: [`Registration::linked`](crate::host::Registration::linked) lists them.
///
/// # Extending a class
/// A component that is a robot and something more wraps the robot, in a field with `#[extends]`. Its class has the
/// properties, topics, services, references, knowledge and loops of the other one and those that it declares itself;
/// composites change its loops as those of the other, and rules over fleets take it for one. What it does not write
/// goes to the other: start, execution, reaction, end, save, restore, `waits_for` and `status`. What it writes calls
/// that of the other where its work belongs:
///
/// ```
/// use saoms_api::{Class, Component, Context, Failure, Message, Own, Publisher, Topic};
/// # #[derive(Class)]
/// # #[class(name = "example.Robot", periodic)]
/// # struct Robot { #[property(default = 1)] number: u32 }
/// # impl Component for Robot { type Properties = Own<Self>; }
///
/// /// What a horn did.
/// #[derive(Clone, Debug, Message)]
/// struct Honk {
///     execution: u64,
/// }
///
/// const HONK: Topic<Honk> = Topic::event("HONK");
///
/// /// A robot that honks.
/// #[derive(Class)]
/// #[class(name = "example.LoudRobot", periodic)]
/// struct LoudRobot {
///     #[extends]
///     robot: Robot,
///     /// It honks each so many executions.
///     #[property(default = 10, range = 1..)]
///     every: u64,
///     #[publishes(HONK)]
///     horn: Publisher<Honk>,
/// }
///
/// impl Component for LoudRobot {
///     type Properties = Own<Self>;
///
///     fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
///         self.robot.execute(context)?;
///         if context.execution() % self.every == 0 {
///             context.send(&self.horn, Honk { execution: context.execution() })?;
///         }
///         Ok(())
///     }
/// }
/// ```
///
/// A class with a property struct of its own gives it those of the other with `#[property(flatten)]`, and writes `new`.
pub trait Class: Component {
    /// Name, properties, topics, services and references as one JSON text; its shape is described in
    /// [`crate::host::declaration`].
    const DECLARATION: &'static str;
    /// The loops that the declaration names.
    const LOOPS: &'static [LoopRegistration] = &[];

    /// Serves a call to one of the declared services.
    ///
    /// # Errors
    /// See [`CallError`].
    fn serve(&mut self, invocation: &mut Invocation<'_>, context: &mut Context<'_>) -> Result<(), CallError>;
}
