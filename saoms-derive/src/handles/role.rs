//! What a field is, as its attribute says.

use proc_macro2::TokenStream;
use quote::quote;
use syn::{Attribute, Error, Field, GenericArgument, Ident, LitStr, Meta, Path, PathArguments, Result, Token, Type};

use crate::case::lower_camel;
use crate::docs::docs;

/// What a field is.
pub(crate) enum Role {
    /// `#[publishes(COUNT)]`
    Publishes(Path),
    /// `#[subscribes(COUNT)]`
    Subscribes(Path),
    /// `#[takes("fire", FIRE)]`: a subscription to the topic by which the event comes.
    Takes { event: LitStr, topic: Path, doc: String },
    /// `#[reference]`, `#[reference("gps", optional)]`
    Reference { name: LitStr, optional: bool },
    /// `#[senses]`, `#[senses("chargeAt")]`
    Senses(LitStr),
    /// `#[effects]`, `#[effects("chargeAt")]`
    Effects(LitStr),
    /// `#[entry(unit = "%", default = 1.0)]`: an effector for an entry that the loop adds.
    Entry(Box<OwnEntry>),
    /// `#[properties]`: all properties, in a struct.
    Properties,
    /// `#[property(...)]`: a property of its own.
    Property,
    /// `#[extends]`
    Extends,
    /// `#[knowledge]`
    Knowledge,
    /// `#[loops]`
    Loops,
    /// Nothing is said: its default value.
    Plain,
}

/// An entry that a loop adds to the knowledge.
pub(crate) struct OwnEntry {
    pub(super) name: LitStr,
    /// The type of its value: `f64` of `Effector<f64>`.
    pub(super) of: Type,
    pub(super) default: Option<syn::Expr>,
    /// What else is said, for the derive of entries.
    pub(super) rest: Vec<TokenStream>,
}

/// The attributes of fields, beside those of `#[derive(Class)]` and `#[derive(LoopClass)]` themselves.
const ROLES: &[&str] = &[
    "publishes", "subscribes", "takes", "reference", "senses", "effects", "entry", "properties", "property", "extends",
    "knowledge", "loops",
];

/// The name of an attribute that says what a field is.
pub(super) fn role_name(attribute: &Attribute) -> Option<&'static str> {
    ROLES.iter().copied().find(|name| attribute.path().is_ident(name))
}

impl Role {
    pub(super) fn of(attribute: &Attribute, field: &Field, ident: &Ident) -> Result<Role> {
        let of = &field.ty;
        let path_only = |role: Role| attribute.meta.require_path_only().map(|_| role);
        match role_name(attribute).unwrap_or_default() {
            "publishes" => Ok(Role::Publishes(attribute.parse_args()?)),
            "subscribes" => Ok(Role::Subscribes(attribute.parse_args()?)),
            "takes" => {
                let (event, topic) = attribute.parse_args_with(taken)?;
                Ok(Role::Takes { event, topic, doc: docs(&field.attrs) })
            }
            "reference" => {
                let (name, optional) = match attribute.meta {
                    Meta::Path(_) => (None, false),
                    _ => attribute.parse_args_with(reference)?,
                };
                Ok(Role::Reference { name: name.unwrap_or_else(|| named_as(ident)), optional })
            }
            "senses" => Ok(Role::Senses(entry_name(attribute, ident)?)),
            "effects" => Ok(Role::Effects(entry_name(attribute, ident)?)),
            "entry" => OwnEntry::of(attribute, ident, of).map(Box::new).map(Role::Entry),
            "properties" => path_only(Role::Properties),
            "property" => Ok(Role::Property),
            "extends" => path_only(Role::Extends),
            "knowledge" => path_only(Role::Knowledge),
            _ => path_only(Role::Loops),
        }
    }
}

impl OwnEntry {
    fn of(attribute: &Attribute, ident: &Ident, of: &Type) -> Result<OwnEntry> {
        let Some(of) = value_type(of) else {
            return Err(Error::new_spanned(of, "an entry of the loop's own is an `Effector<T>`"));
        };
        let mut entry = OwnEntry { name: named_as(ident), of, default: None, rest: Vec::new() };
        if matches!(attribute.meta, Meta::Path(_)) {
            return Ok(entry);
        }
        attribute.parse_nested_meta(|meta| {
            let path = &meta.path;
            if path.is_ident("name") {
                entry.name = meta.value()?.parse()?;
            } else if path.is_ident("default") {
                entry.default = Some(meta.value()?.parse()?);
            } else if meta.input.peek(Token![=]) {
                let value: syn::Expr = meta.value()?.parse()?;
                entry.rest.push(quote!(#path = #value));
            } else {
                entry.rest.push(quote!(#path));
            }
            Ok(())
        })?;
        Ok(entry)
    }
}

/// The `T` of `Effector<T>`.
fn value_type(of: &Type) -> Option<Type> {
    let Type::Path(path) = of else { return None };
    let last = path.path.segments.last()?;
    let PathArguments::AngleBracketed(arguments) = &last.arguments else { return None };
    match arguments.args.first()? {
        GenericArgument::Type(of) => Some(of.clone()),
        _ => None,
    }
}

/// The name that a field gives: itself in lowerCamelCase.
fn named_as(ident: &Ident) -> LitStr {
    LitStr::new(&lower_camel(ident), ident.span())
}

/// `("chargeAt")`, or nothing.
fn entry_name(attribute: &Attribute, ident: &Ident) -> Result<LitStr> {
    match attribute.meta {
        Meta::Path(_) => Ok(named_as(ident)),
        _ => attribute.parse_args(),
    }
}

/// `("fire", FIRE)`.
fn taken(input: syn::parse::ParseStream<'_>) -> Result<(LitStr, Path)> {
    let other = |error: Error| Error::new(error.span(), "expected an event and its topic: `#[takes(\"fire\", FIRE)]`");
    let event: LitStr = input.parse().map_err(other)?;
    let name = event.value();
    let is_sign = |sign: char| sign.is_ascii_alphanumeric() || matches!(sign, '_' | '-');
    if !name.starts_with(|sign: char| sign.is_ascii_alphabetic()) || !name.chars().all(is_sign) {
        let message = "the name of an event is a letter, then letters, digits, `_` and `-`";
        return Err(Error::new(event.span(), message));
    }
    input.parse::<Token![,]>().map_err(other)?;
    Ok((event, input.parse().map_err(other)?))
}

/// `("gps")`, `(optional)`, `("gps", optional)`.
fn reference(input: syn::parse::ParseStream<'_>) -> Result<(Option<LitStr>, bool)> {
    let name: Option<LitStr> = if input.peek(LitStr) { Some(input.parse()?) } else { None };
    if name.is_some() && !input.is_empty() {
        input.parse::<Token![,]>()?;
    }
    if input.is_empty() {
        return Ok((name, false));
    }
    let word: Ident = input.parse()?;
    if word == "optional" {
        return Ok((name, true));
    }
    Err(Error::new(word.span(), "expected `optional`; a field of type `Vec` takes many targets"))
}
