use crate::host::{Invocation, LoopRegistration};
use crate::{CallError, Context, Failure, Properties, Saved};

/// A component of a fleet, written by an author.
///
/// The host calls, always from one thread at a time and never twice at once:
///
/// 1. [`new`](Component::new) with the properties of the composite. It may refuse values that do not fit together; it
///    does no work, opens nothing and sends nothing, because the checker constructs components that will never run.
/// 2. [`initialize`](Component::initialize) once, when the component is scheduled: it asks for its topics and
///    references.
/// 3. [`execute`](Component::execute) once in each period. Messages that it sends leave when it returns.
/// 4. [`shutdown`](Component::shutdown) once, when the component is unscheduled or the run ends.
///
/// A component that is scheduled again, or restarted after a failure, is a new one from [`new`](Component::new) on.
///
/// # Failures
/// An `Err` and a panic from `initialize`, `execute` or `shutdown` are the same to the host: the component has failed,
/// the report says so, and its `restart` policy decides. Other components continue.
///
/// # Blocking
/// `execute` must not wait for anything. An execution beyond the watchdog's budget is reported, and from then on the
/// component runs on a worker thread, where it is less punctual:
///
/// ```
/// # use std::time::Duration;
/// # use saoms_api::{Component, Context, Failure, Message, Publisher};
/// # #[derive(Clone, Debug, Message)]
/// # struct Arrived;
/// # struct Wheels { arrived: Publisher<Arrived>, drive_time: Duration }
/// # impl Component for Wheels {
/// # type Properties = ();
/// # fn new((): ()) -> Result<Self, Failure> { Err("only an example".into()) }
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
/// # use saoms_api::{Component, Context, Failure, Message, Publisher, Time};
/// # #[derive(Clone, Debug, Message)]
/// # struct Arrived;
/// # struct Wheels { arrived: Publisher<Arrived>, arrival: Time }
/// # impl Component for Wheels {
/// # type Properties = ();
/// # fn new((): ()) -> Result<Self, Failure> { Err("only an example".into()) }
/// fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
///     if context.now() < self.arrival {
///         return Ok(());
///     }
///     context.send(&self.arrived, Arrived)
/// }
/// # }
/// ```
pub trait Component: Send + Sized + 'static {
    /// Properties that the composite sets.
    type Properties: Properties;

    /// Makes the component.
    ///
    /// # Errors
    /// The values do not fit together; the message says which and why. [`Finding`](crate::Finding)s are shown in the
    /// composite at the very values, or parts of values, that they are about, all of them at once.
    fn new(properties: Self::Properties) -> Result<Self, Failure>;

    /// Asks for topics and references.
    ///
    /// # Errors
    /// The component cannot start; at the start of a fleet nothing starts then.
    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let _ = context;
        Ok(())
    }

    /// Does the work of one period. Never called for a passive component.
    ///
    /// # Errors
    /// The component has failed.
    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let _ = context;
        Ok(())
    }

    /// Ends the work; messages sent here are still delivered.
    ///
    /// # Errors
    /// The component could not end properly.
    fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let _ = context;
        Ok(())
    }

    /// Saves the state for a successor, when the library was rebuilt while the fleet runs (`saoms run --reload`):
    /// between two executions, this is called of the one that runs, then [`initialize`](Component::initialize) and
    /// [`restore`](Component::restore) of the new one, which takes its place. [`shutdown`](Component::shutdown) is not
    /// called. By default nothing is saved, and the new one starts without state.
    ///
    /// ```
    /// # use saoms_api::{Component, Context, Failure, Message, Saved};
    /// #[derive(Clone, Debug, Message)]
    /// struct State {
    ///     blocks: u64,
    /// }
    ///
    /// # struct Odometer { blocks: u64, drives: bool }
    /// # impl Component for Odometer {
    /// # type Properties = ();
    /// # fn new((): ()) -> Result<Self, Failure> { Err("only an example".into()) }
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
        Ok(Saved::default())
    }

    /// Goes on where an earlier build was. Not called where that saved nothing.
    ///
    /// # Errors
    /// It cannot continue from that state: the earlier one stays.
    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        let _ = saved;
        Err("the earlier build saved its state, and this one does not implement `restore`".into())
    }

    /// Says what the component waits for, so that a run in which nothing can happen any more names it: asked when
    /// nothing has happened in the fleet for a while.
    ///
    /// `Some` promises that the component does none of the work that is left until a message or a call reaches it,
    /// however long that takes. The text completes "it waits for". `None`, which is the default, promises nothing. In
    /// virtual time a run without a limit ends when all promise.
    fn waits_for(&self) -> Option<String> {
        None
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
/// | `publishes(A, B)`, `subscribes(A, B)` | paths to constants of type [`Topic`](crate::Topic) |
/// | `service("move": Robot)` | a service with this [interface](crate::host::Interface), which the component implements |
/// | `reference("gps": Gps)`, `reference("gps": Gps, optional)`, `reference("gps": Gps, many)` | a service of another component that this one calls |
/// | `stops` | it registers a function that [stops its hardware](crate::StopFunction) |
/// | `knowledge = RobotKnowledge` | the [knowledge](crate::host::KnowledgeClass) that its loops work on |
/// | `loops(A, B, C)` | the [loops](crate::LoopClass) that it has unless a composite says otherwise, in their order |
/// | `loops(property = "policy", safe(A, B), classic(A, C))` | the same, one list for each value of a property |
/// | `also("robot.Robot001", number = 1)` | a further name, with properties preset to literals |
///
/// Linked classes register themselves: [`Registration::linked`](crate::host::Registration::linked) lists them.
///
/// # Extending a class
/// A component that is a robot and something more wraps the robot, in a field with `#[extends]`. Its class has the
/// topics, services, references, knowledge and loops of the other one and those that it declares itself; composites
/// change its loops as those of the other, and rules over fleets take it for one. It calls the functions of the other
/// where the work of the other belongs, shutdown, save, restore and `waits_for` included, and `flatten` gives it the
/// same properties:
///
/// ```
/// use saoms_api::{Class, Component, Context, Failure, Message, Properties, Publisher, Topic};
/// # #[derive(Properties)]
/// # struct RobotProperties { #[property(default = 1)] number: u32 }
/// # #[derive(Class)]
/// # #[class(name = "example.Robot", periodic)]
/// # struct Robot { number: u32 }
/// # impl Component for Robot {
/// #     type Properties = RobotProperties;
/// #     fn new(properties: RobotProperties) -> Result<Self, Failure> { Ok(Robot { number: properties.number }) }
/// # }
///
/// /// What a horn did.
/// #[derive(Clone, Debug, Message)]
/// struct Honk {
///     execution: u64,
/// }
///
/// const HONK: Topic<Honk> = Topic::event("HONK");
///
/// #[derive(Properties)]
/// struct LoudRobotProperties {
///     #[property(flatten)]
///     robot: RobotProperties,
///     /// It honks each so many executions.
///     #[property(default = 10, range = 1..)]
///     every: u64,
/// }
///
/// /// A robot with a horn.
/// #[derive(Class)]
/// #[class(name = "example.LoudRobot", periodic, publishes(HONK))]
/// struct LoudRobot {
///     #[extends]
///     robot: Robot,
///     every: u64,
///     horn: Publisher<Honk>,
/// }
///
/// impl Component for LoudRobot {
///     type Properties = LoudRobotProperties;
///
///     fn new(properties: LoudRobotProperties) -> Result<Self, Failure> {
///         let robot = Robot::new(properties.robot)?;
///         Ok(LoudRobot { robot, every: properties.every, horn: Publisher::default() })
///     }
///
///     fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
///         self.horn = context.publish(&HONK)?;
///         self.robot.initialize(context)
///     }
///
///     fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
///         self.robot.execute(context)?;
///         if context.execution() % self.every == 0 {
///             context.send(&self.horn, Honk { execution: context.execution() })?;
///         }
///         Ok(())
///     }
///
///     fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
///         self.robot.shutdown(context)
///     }
/// }
/// ```
pub trait Class: Component {
    /// Name, properties, topics, services and references as one JSON text; its shape is described in
    /// [`crate::host::declaration`].
    const DECLARATION: &'static str;
    /// The loops that the declaration names.
    const LOOPS: &'static [LoopRegistration] = &[];

    /// Serves a call to one of the declared services.
    ///
    /// # Errors
    /// As [`CallError`] says.
    fn serve(&mut self, invocation: &mut Invocation<'_>, context: &mut Context<'_>) -> Result<(), CallError>;
}

/// A component of any class, as hosts hold it.
pub trait DynComponent: Send {
    /// See [`Component::initialize`].
    ///
    /// # Errors
    /// As there.
    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure>;
    /// See [`Component::execute`].
    ///
    /// # Errors
    /// As there.
    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure>;
    /// See [`Component::shutdown`].
    ///
    /// # Errors
    /// As there.
    fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure>;
    /// See [`Class::serve`].
    ///
    /// # Errors
    /// As there.
    fn serve(&mut self, invocation: &mut Invocation<'_>, context: &mut Context<'_>) -> Result<(), CallError>;
    /// See [`Component::save`].
    ///
    /// # Errors
    /// As there.
    fn save(&mut self) -> Result<Saved, Failure>;
    /// See [`Component::restore`].
    ///
    /// # Errors
    /// As there.
    fn restore(&mut self, saved: &Saved) -> Result<(), Failure>;
    /// See [`Component::waits_for`].
    ///
    /// # Errors
    /// A component of a library failed to say it.
    fn waits_for(&self) -> Result<Option<String>, Failure>;
}

impl<C: Class> DynComponent for C {
    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        Component::initialize(self, context)
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        Component::execute(self, context)
    }

    fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        Component::shutdown(self, context)
    }

    fn serve(&mut self, invocation: &mut Invocation<'_>, context: &mut Context<'_>) -> Result<(), CallError> {
        Class::serve(self, invocation, context)
    }
    fn save(&mut self) -> Result<Saved, Failure> {
        Component::save(self)
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        Component::restore(self, saved)
    }

    fn waits_for(&self) -> Result<Option<String>, Failure> {
        Ok(Component::waits_for(self))
    }
}
