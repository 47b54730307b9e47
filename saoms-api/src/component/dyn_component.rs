use crate::host::{Invocation, PropertyValue, SmolStr};
use crate::{CallError, Class, Component, Context, Failure, Properties, ReportValue, Saved};

/// A component of any class, as hosts hold it.
pub trait DynComponent: Send {
    /// Binds the handles in its fields, then [`Component::initialize`].
    ///
    /// # Errors
    /// As there.
    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure>;
    /// [`Component::initialize`] alone, for a component that extends this one and has bound its handles.
    ///
    /// # Errors
    /// As there.
    fn initialize_bound(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.initialize(context)
    }
    /// See [`Component::execute`].
    ///
    /// # Errors
    /// As there.
    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure>;
    /// See [`Component::react`].
    ///
    /// # Errors
    /// As there.
    fn react(&mut self, context: &mut Context<'_>) -> Result<(), Failure>;
    /// See [`Component::update`]: all values, those of absent properties are their defaults.
    ///
    /// # Errors
    /// As there, or the values are wrong.
    fn update(&mut self, values: &[(SmolStr, PropertyValue)]) -> Result<(), Failure>;
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
    /// See [`Component::status`].
    ///
    /// # Errors
    /// A component of a library failed to say it.
    fn status(&self) -> Result<Vec<(String, ReportValue)>, Failure>;
}

impl<C: Class> DynComponent for C {
    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.bind(context)?;
        Component::initialize(self, context)
    }

    fn initialize_bound(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        Component::initialize(self, context)
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        Component::execute(self, context)
    }

    fn react(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        Component::react(self, context)
    }

    fn update(&mut self, values: &[(SmolStr, PropertyValue)]) -> Result<(), Failure> {
        Component::update(self, C::Properties::from_values(values)?)
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

    fn status(&self) -> Result<Vec<(String, ReportValue)>, Failure> {
        Ok(Component::status(self))
    }
}
