use std::any::Any;

use crate::host::Arguments;
use crate::host::cdr::{Reader, Writer};
use crate::{CallError, Component, Context, Failure, Field};

/// A service interface: `#[interface(name = "...")]` on a trait makes `dyn Trait` one.
///
/// Each method is an operation, named like the method in lowerCamelCase. It takes `&mut self`, the context, and up to
/// six arguments that are [`Field`]s, and returns a [`Field`] or a [`Failure`]. A component offers the interface by
/// implementing the trait and saying `service("name": Trait)` in `#[class(...)]`; another one has a field `#[reference]
/// name: TraitReference` and calls through it. Its methods return [`CallError`] instead of [`Failure`]. The composite
/// wires the two. An operation with a body is one that a component in Rust need not implement.
///
/// ```
/// use saoms_api::{Class, Component, Context, Failure, info, interface};
///
/// /// Lends its numbers.
/// #[interface(name = "example.Counter")]
/// pub trait Counter {
///     /// The next number, in steps.
///     fn next_number(&mut self, context: &mut Context<'_>, step: u32) -> Result<u32, Failure>;
/// }
///
/// /// Counts.
/// #[derive(Class)]
/// #[class(name = "example.CounterImpl", passive, service("numbers": Counter))]
/// struct CounterImpl {
///     number: u32,
/// }
///
/// impl Component for CounterImpl {
///     type Properties = ();
/// }
///
/// impl Counter for CounterImpl {
///     fn next_number(&mut self, _: &mut Context<'_>, step: u32) -> Result<u32, Failure> {
///         self.number = self.number.checked_add(step).ok_or("no numbers left")?;
///         Ok(self.number)
///     }
/// }
///
/// /// Shows a number in each period.
/// #[derive(Class)]
/// #[class(name = "example.Display", periodic)]
/// struct Display {
///     #[reference]
///     source: CounterReference,
/// }
///
/// impl Component for Display {
///     type Properties = ();
///
///     fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
///         let number = self.source.next_number(context, 1)?;
///         info!(context, "{number}");
///         Ok(())
///     }
/// }
/// ```
///
/// Of an interface that one component alone offers, trait and implementation are one: `#[interface(name =
/// "example.Counter")] impl Counter for CounterImpl { ... }` makes the trait, too.
pub trait Interface {
    /// The name that composite files use in `interface.java` and `interface.rust`.
    const NAME: &'static str;
    /// The operations with their argument and reply types, as text: two ends agree when these are equal.
    const DECLARATION: &'static str;
}

/// A typed handle to call a service through; `#[interface]` on trait `Gps` generates `GpsReference`.
pub trait Reference: Default {
    /// The interface's name.
    const INTERFACE: &'static str;
    /// The interface's operations, as [`Interface::DECLARATION`].
    const DECLARATION: &'static str;
    /// For hosts and generated code.
    fn from_index(index: u32) -> Self;
    /// For hosts and generated code.
    fn index(&self) -> u32;
}

/// A field with `#[reference]`: a handle, `Option` of one for a reference that needs no target (it is `None` without
/// one), or `Vec` of them for one that takes many.
pub trait ReferenceField: Sized {
    /// The operations of the interface, as [`Interface::DECLARATION`].
    const DECLARATION: &'static str;
    /// True if it needs no target.
    const OPTIONAL: bool;
    /// True if it takes several targets.
    const MANY: bool;

    /// Asks for the reference of this name.
    ///
    /// # Errors
    /// As [`Context::reference`].
    fn bind(name: &str, context: &mut Context<'_>) -> Result<Self, Failure>;
}

impl<R: Reference> ReferenceField for R {
    const DECLARATION: &'static str = <R as Reference>::DECLARATION;
    const OPTIONAL: bool = false;
    const MANY: bool = false;

    fn bind(name: &str, context: &mut Context<'_>) -> Result<Self, Failure> {
        context.reference(name)
    }
}

impl<R: Reference> ReferenceField for Option<R> {
    const DECLARATION: &'static str = <R as Reference>::DECLARATION;
    const OPTIONAL: bool = true;
    const MANY: bool = false;

    fn bind(name: &str, context: &mut Context<'_>) -> Result<Self, Failure> {
        let reference = context.reference(name)?;
        Ok(context.is_wired(&reference).then_some(reference))
    }
}

impl<R: Reference> ReferenceField for Vec<R> {
    const DECLARATION: &'static str = <R as Reference>::DECLARATION;
    const OPTIONAL: bool = false;
    const MANY: bool = true;

    fn bind(name: &str, context: &mut Context<'_>) -> Result<Self, Failure> {
        context.references(name)
    }
}

/// The number of an operation: its place in the interface's declaration.
pub type Operation = u32;

/// A call as it travels from caller to provider: typed values within one build of the program, bytes across a boundary.
pub trait ServiceCall {
    /// The operation that is called.
    fn operation(&self) -> Operation;
    /// The arguments (an `Option` of a tuple) and the reply (an `Option`), for a provider that shares the Rust types.
    fn typed(&mut self) -> Option<(&mut dyn Any, &mut dyn Any)>;
    /// The arguments in CDR, for a provider that does not.
    fn arguments(&mut self) -> Vec<u8>;
    /// Takes the reply of such a provider.
    ///
    /// # Errors
    /// The bytes are no such reply.
    fn reply(&mut self, bytes: &[u8]) -> Result<(), CallError>;
}

/// A call by code that knows the types.
#[derive(Debug)]
pub struct TypedCall<A, R> {
    operation: Operation,
    arguments: Option<A>,
    reply: Option<R>,
}

impl<A: Arguments, R: Field> TypedCall<A, R> {
    /// A call of this operation with these arguments.
    pub fn new(operation: Operation, arguments: A) -> TypedCall<A, R> {
        TypedCall { operation, arguments: Some(arguments), reply: None }
    }

    /// The reply, once the call came back.
    ///
    /// # Errors
    /// The provider gave none.
    pub fn into_reply(self) -> Result<R, CallError> {
        self.reply.ok_or_else(|| CallError::Mismatch { message: "the provider gave no reply".to_owned() })
    }
}

impl<A: Arguments, R: Field> ServiceCall for TypedCall<A, R> {
    fn operation(&self) -> Operation {
        self.operation
    }

    fn typed(&mut self) -> Option<(&mut dyn Any, &mut dyn Any)> {
        Some((&mut self.arguments, &mut self.reply))
    }

    fn arguments(&mut self) -> Vec<u8> {
        let mut writer = Writer::new();
        if let Some(arguments) = &self.arguments {
            arguments.write(&mut writer);
        }
        writer.into_bytes()
    }

    fn reply(&mut self, bytes: &[u8]) -> Result<(), CallError> {
        let mut reader = Reader::new(bytes).map_err(mismatch)?;
        let reply = R::read(&mut reader).map_err(mismatch)?;
        reader.finish().map_err(mismatch)?;
        self.reply = Some(reply);
        Ok(())
    }
}

fn mismatch(error: impl std::fmt::Display) -> CallError {
    CallError::Mismatch { message: error.to_string() }
}

/// For generated code: the class has no service of this name.
pub fn no_service(class: &str, service: &str) -> CallError {
    CallError::Mismatch { message: format!("class `{class}` offers no service `{service}`") }
}

/// For generated code: the interface has no operation of this number.
pub fn no_operation(interface: &str, operation: Operation) -> CallError {
    CallError::Mismatch { message: format!("interface `{interface}` has no operation with the number {operation}") }
}

/// A call as the provider sees it: which of its services, and the call itself.
pub struct Invocation<'a> {
    /// The name of the service in the provider's declaration.
    pub service: &'a str,
    /// The call.
    pub call: &'a mut dyn ServiceCall,
}

impl Invocation<'_> {
    /// For generated code: takes the arguments, serves the call, gives the reply.
    ///
    /// # Errors
    /// The arguments are of other types, or the provider failed.
    pub fn serve<C: Component, A: Arguments, R: Field>(
        &mut self,
        component: &mut C,
        context: &mut Context<'_>,
        operation: impl FnOnce(&mut C, &mut Context<'_>, A) -> Result<R, Failure>,
    ) -> Result<(), CallError> {
        if let Some((arguments, reply)) = self.call.typed()
            && let Some(reply) = reply.downcast_mut::<Option<R>>()
            && let Some(arguments) = arguments.downcast_mut::<Option<A>>().and_then(Option::take)
        {
            *reply = Some(operation(component, context, arguments)?);
            return Ok(());
        }
        let bytes = self.call.arguments();
        let mut reader = Reader::new(&bytes).map_err(mismatch)?;
        let arguments = A::read(&mut reader).map_err(mismatch)?;
        reader.finish().map_err(mismatch)?;
        let reply = operation(component, context, arguments)?;
        let mut writer = Writer::new();
        reply.write(&mut writer);
        self.call.reply(writer.bytes())
    }
}
