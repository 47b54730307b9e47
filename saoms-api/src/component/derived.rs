//! What the derives of components and loops write beside their declarations: how to make one, and its handles.

use std::marker::PhantomData;

use crate::host::{DynComponent, KnowledgeClass};
use crate::{Component, Context, Failure, Knowledge, Loop, Loops, Properties};

/// The properties that the fields of a component or a loop declare with `#[property]`, as one struct: what its `type
/// Properties` says.
pub type Own<T> = <T as Fields>::Own;

/// The properties that fields declare. `#[derive(Class)]` and `#[derive(LoopClass)]` write it.
#[diagnostic::on_unimplemented(
    message = "`{Self}` declares neither a class nor a loop",
    label = "no `#[derive(Class)]` and no `#[derive(LoopClass)]`"
)]
pub trait Fields: Sized {
    /// See [`Own`](crate::Own).
    type Own: Properties;
}

/// What `#[derive(Class)]` writes for the fields of a component. See [`Class`](crate::Class).
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no class",
    label = "no `#[derive(Class)]`",
    note = "write `#[derive(Class)]` and `#[class(name = \"...\", periodic)]` above `struct {Self}`"
)]
pub trait Derived: Fields {
    /// Makes the component from its properties. What its fields lack for that is a compile error where `ASKED` is true.
    ///
    /// # Errors
    /// The component that it extends refuses the values.
    #[doc(hidden)]
    fn made<const ASKED: bool>(properties: <Self as Component>::Properties) -> Result<Self, Failure>
    where
        Self: Component;

    /// Puts new values of its properties into its fields. See [`Component::update`].
    ///
    /// # Errors
    /// Its fields do not hold its properties, or the component that it extends refuses the values.
    #[doc(hidden)]
    fn renew(&mut self, properties: <Self as Component>::Properties) -> Result<(), Failure>
    where
        Self: Component;

    /// Asks for what the handles stand for, those of the component that this one extends included.
    ///
    /// # Errors
    /// As [`Context::publish`], [`Context::subscribe`], [`Context::reference`] and [`Context::loops`].
    fn bind(&mut self, context: &mut Context<'_>) -> Result<(), Failure>;

    /// The component in the field with `#[extends]`.
    fn base(&self) -> Option<&dyn DynComponent> {
        None
    }

    /// The component in the field with `#[extends]`.
    fn base_mut(&mut self) -> Option<&mut dyn DynComponent> {
        None
    }

    /// The fields with `#[loops]` and `#[knowledge]`.
    fn own_loops(&mut self) -> Option<(&mut Loops, &mut dyn Knowledge)> {
        None
    }
}

/// What `#[derive(LoopClass)]` writes for the fields of a loop. See [`LoopClass`](crate::LoopClass).
#[diagnostic::on_unimplemented(
    message = "`{Self}` declares no loop",
    label = "no `#[derive(LoopClass)]`",
    note = "write `#[derive(LoopClass)]` and `#[looping(name = \"...\")]` above `struct {Self}`"
)]
pub trait DerivedLoop: Fields {
    /// Makes the loop from its properties. What its fields lack for that is a compile error where `ASKED` is true.
    ///
    /// # Errors
    /// None by itself.
    #[doc(hidden)]
    fn made<const ASKED: bool>(properties: <Self as Loop>::Properties) -> Result<Self, Failure>
    where
        Self: Loop;

    /// Asks for what the handles stand for.
    ///
    /// # Errors
    /// As [`Entry::of`](crate::Entry::of), [`Effector::of`](crate::Effector::of), [`Context::publish`],
    /// [`Context::subscribe`] and [`Context::reference`].
    fn bind(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure>;
}

/// For generated code: the fields with `#[loops]` and `#[knowledge]`.
pub fn parts<'a, K: KnowledgeClass>(
    loops: &'a mut Loops,
    knowledge: &'a mut K,
) -> Option<(&'a mut Loops, &'a mut dyn Knowledge)> {
    Some((loops, knowledge))
}

/// For generated code: the default value of a type, and whether it has one. Where `T` is known, the inherent items come
/// before those of [`NoDefault`].
pub struct DefaultOf<T>(PhantomData<T>);

impl<T: Default> DefaultOf<T> {
    /// There is one.
    pub const EXISTS: bool = true;

    /// It.
    pub fn make() -> T {
        T::default()
    }
}

/// For generated code: see [`DefaultOf`].
pub trait NoDefault<T> {
    /// There is none.
    const EXISTS: bool = false;

    /// Never called: a compile error comes before.
    fn make() -> T {
        unreachable!("a type without a default")
    }
}

impl<T> NoDefault<T> for DefaultOf<T> {}

/// For generated code: a value of type `A` as one of type `B`, where both are one. See [`DefaultOf`].
pub struct Same<A, B>(PhantomData<(A, B)>);

impl<T> Same<T, T> {
    /// They are one.
    pub const IS: bool = true;

    /// The same value.
    pub fn cast(value: T) -> T {
        value
    }
}

/// For generated code: see [`Same`].
pub trait Different<A, B> {
    /// They are two.
    const IS: bool = false;

    /// Never called: a compile error comes before.
    fn cast(_: A) -> B {
        unreachable!("two types")
    }
}

impl<A, B> Different<A, B> for Same<A, B> {}

/// For generated code: no field takes the properties.
#[cold]
pub fn no_update() -> Failure {
    Failure::new(
        "the component takes no new values while it runs: mark the fields that hold them, or write `fn update`",
    )
}

/// What a component without code of its own does at its start: what it extends starts, or its loops.
pub(crate) fn initialize<C: Derived>(component: &mut C, context: &mut Context<'_>) -> Result<(), Failure> {
    if let Some(base) = component.base_mut() {
        return base.initialize_bound(context);
    }
    component.own_loops().map_or(Ok(()), |(loops, knowledge)| loops.initialize(knowledge, context))
}

/// The same in an execution.
pub(crate) fn execute<C: Derived>(component: &mut C, context: &mut Context<'_>) -> Result<(), Failure> {
    if let Some(base) = component.base_mut() {
        return base.execute(context);
    }
    let Some((loops, knowledge)) = component.own_loops() else { return Ok(()) };
    loops.monitor(knowledge, context)?;
    loops.adapt(knowledge, context)
}

/// The same at its end.
pub(crate) fn shutdown<C: Derived>(component: &mut C, context: &mut Context<'_>) -> Result<(), Failure> {
    if let Some(base) = component.base_mut() {
        return base.shutdown(context);
    }
    component.own_loops().map_or(Ok(()), |(loops, knowledge)| loops.shutdown(knowledge, context))
}

/// What is missing is a compile error where nobody writes `new`, and none where somebody does.
///
/// ```
/// # use saoms_api::{Class, Component, Failure, host::Registration};
/// struct NoDefault(u32);
///
/// #[derive(Class)]
/// #[class(name = "example.Written", periodic)]
/// struct Written {
///     field: NoDefault,
/// }
///
/// impl Component for Written {
///     type Properties = ();
///
///     fn new((): ()) -> Result<Self, Failure> {
///         Ok(Written { field: NoDefault(1) })
///     }
/// }
///
/// Registration::of::<Written>();
/// ```
///
/// ```compile_fail
/// # use saoms_api::{Class, Component, Failure, host::Registration};
/// struct NoDefault(u32);
///
/// #[derive(Class)]
/// #[class(name = "example.Written", periodic)]
/// struct Written {
///     field: NoDefault,
/// }
///
/// impl Component for Written {
///     type Properties = ();
/// }
///
/// Registration::of::<Written>();
/// ```
///
/// ```compile_fail
/// # use saoms_api::{Class, Component, Failure, Properties, host::Registration};
/// #[derive(Properties)]
/// struct Dropped {
///     #[property(default = 1)]
///     number: u32,
/// }
///
/// #[derive(Class)]
/// #[class(name = "example.Written", periodic)]
/// struct Written;
///
/// impl Component for Written {
///     type Properties = Dropped;
/// }
///
/// Registration::of::<Written>();
/// ```
#[cfg(doctest)]
struct Missing;
