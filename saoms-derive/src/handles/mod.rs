//! The fields of components and loops that say what they are: handles, properties, parts.

mod after_error;
mod declare;
mod generate;
mod role;

use syn::{Attribute, Data, DeriveInput, Error, Field, Fields, Ident, LitStr, Path, Result, Type};

pub(crate) use after_error::after_error;
pub(crate) use declare::{declare_references, take_topics};
pub(crate) use role::Role;
use role::{OwnEntry, role_name};

/// A field with its role.
pub(crate) struct Handle<'a> {
    field: &'a Field,
    ident: &'a Ident,
    pub(crate) role: Role,
}

/// All fields of a component or a loop.
pub(crate) struct Handles<'a> {
    ident: &'a Ident,
    pub(crate) all: Vec<Handle<'a>>,
    /// A struct without names has no roles either.
    unnamed: Option<&'a Fields>,
}

impl<'a> Handles<'a> {
    pub(crate) fn of(input: &'a DeriveInput) -> Result<Handles<'a>> {
        let Data::Struct(data) = &input.data else {
            return Err(Error::new_spanned(&input.ident, "expected a struct"));
        };
        let mut handles = Handles { ident: &input.ident, all: Vec::new(), unnamed: None };
        for field in &data.fields {
            let mut roles = field.attrs.iter().filter(|attribute| role_name(attribute).is_some());
            let role = roles.next();
            if let Some(second) = roles.next() {
                return Err(Error::new_spanned(second, "a field is one of these: this one is marked already"));
            }
            match (&field.ident, role) {
                (Some(ident), role) => {
                    let role = role.map_or(Ok(Role::Plain), |role| Role::of(role, field, ident))?;
                    handles.all.push(Handle { field, ident, role });
                }
                (None, Some(role)) => {
                    let name = role_name(role).unwrap_or_default();
                    return Err(Error::new_spanned(role, format!("`{name}` needs a field with a name")));
                }
                (None, None) => handles.unnamed = Some(&data.fields),
            }
        }
        handles.check()?;
        Ok(handles)
    }

    fn check(&self) -> Result<()> {
        for (role, message) in [
            (Role::Properties, "the properties are in another field already"),
            (Role::Extends, "a component extends one other"),
            (Role::Knowledge, "the knowledge is in another field already"),
            (Role::Loops, "the loops are in another field already"),
        ] {
            if let Some(second) = self.with(&role).nth(1) {
                return Err(Error::new_spanned(second.mark(), message));
            }
        }
        if let (Some(_), Some(all)) = (self.with(&Role::Property).next(), self.with(&Role::Properties).next()) {
            let message = "properties are in fields of their own or in one struct: put all into the same place";
            return Err(Error::new_spanned(all.ident, message));
        }
        for (one, other, message) in [
            (Role::Loops, Role::Knowledge, "loops need their knowledge: mark its field `#[knowledge]`"),
            (Role::Knowledge, Role::Loops, "a knowledge needs a field for its loops: `#[loops] loops: Loops`"),
        ] {
            if let (Some(one), None) = (self.with(&one).next(), self.with(&other).next()) {
                return Err(Error::new_spanned(one.ident, message));
            }
        }
        Ok(())
    }

    /// The fields with a role that has no content.
    fn with(&self, role: &Role) -> impl Iterator<Item = &Handle<'a>> {
        let wanted = std::mem::discriminant(role);
        self.all.iter().filter(move |handle| std::mem::discriminant(&handle.role) == wanted)
    }

    /// Refuses what only a component, or only a loop, can have.
    pub(crate) fn refuse(&self, what: &str, wrong: impl Fn(&Role) -> bool) -> Result<()> {
        match self.all.iter().find(|handle| wrong(&handle.role)) {
            Some(handle) => {
                let mark = handle.mark();
                let name = mark.and_then(role_name).unwrap_or_default();
                Err(Error::new_spanned(mark, format!("{what} has no `{name}`")))
            }
            None => Ok(()),
        }
    }

    pub(crate) fn publishes(&self) -> impl Iterator<Item = &Path> {
        self.all.iter().filter_map(|handle| match &handle.role {
            Role::Publishes(topic) => Some(topic),
            _ => None,
        })
    }

    pub(crate) fn subscribes(&self) -> impl Iterator<Item = &Path> {
        self.all.iter().filter_map(|handle| match &handle.role {
            Role::Subscribes(topic) | Role::Takes { topic, .. } => Some(topic),
            _ => None,
        })
    }

    /// The events that fields take: name, topic and meaning of each.
    pub(crate) fn takes(&self) -> impl Iterator<Item = (&LitStr, &Path, &str)> {
        self.all.iter().filter_map(|handle| match &handle.role {
            Role::Takes { event, topic, doc } => Some((event, topic, doc.as_str())),
            _ => None,
        })
    }

    pub(crate) fn references(&self) -> impl Iterator<Item = (&LitStr, &Type, bool)> {
        self.all.iter().filter_map(|handle| match &handle.role {
            Role::Reference { name, optional } => Some((name, &handle.field.ty, *optional)),
            _ => None,
        })
    }

    pub(crate) fn senses(&self) -> impl Iterator<Item = &LitStr> {
        self.all.iter().filter_map(|handle| match &handle.role {
            Role::Senses(name) => Some(name),
            _ => None,
        })
    }

    pub(crate) fn effects(&self) -> impl Iterator<Item = &LitStr> {
        self.all.iter().filter_map(|handle| match &handle.role {
            Role::Effects(name) => Some(name),
            _ => None,
        })
    }

    /// The field with `#[extends]`, and its type.
    pub(crate) fn extends(&self) -> Option<(&Ident, &Type)> {
        self.with(&Role::Extends).next().map(|handle| (handle.ident, &handle.field.ty))
    }

    /// The type of the field with `#[knowledge]`.
    pub(crate) fn knowledge(&self) -> Option<&Type> {
        self.with(&Role::Knowledge).next().map(|handle| &handle.field.ty)
    }

    fn has_own_properties(&self) -> bool {
        self.with(&Role::Property).next().is_some()
    }
}

impl Handle<'_> {
    /// The attribute that says what the field is.
    fn mark(&self) -> Option<&Attribute> {
        self.field.attrs.iter().find(|attribute| role_name(attribute).is_some())
    }
}
