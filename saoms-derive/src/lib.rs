//! Derive macros of the SAOMS contract. `saoms-api` exports and documents them.

mod case;
mod class;
mod constants;
mod docs;
mod entries;
mod enumeration;
mod field;
mod handles;
mod interface;
mod json;
mod literal;
mod looping;
mod loops;
mod parts;
mod properties;
mod range;
mod speaker;

use proc_macro::TokenStream;
use syn::{DeriveInput, ItemTrait, parse_macro_input};

fn finish(result: syn::Result<proc_macro2::TokenStream>) -> TokenStream {
    result.unwrap_or_else(syn::Error::into_compile_error).into()
}

/// See `saoms_api::Message`.
#[proc_macro_derive(Message, attributes(message))]
pub fn message(input: TokenStream) -> TokenStream {
    finish(field::message(&parse_macro_input!(input as DeriveInput)))
}

/// See `saoms_api::Field`.
#[proc_macro_derive(Field, attributes(field))]
pub fn field(input: TokenStream) -> TokenStream {
    finish(field::field(&parse_macro_input!(input as DeriveInput)))
}

/// See `saoms_api::Properties`.
#[proc_macro_derive(Properties, attributes(property))]
pub fn properties(input: TokenStream) -> TokenStream {
    finish(properties::properties(&parse_macro_input!(input as DeriveInput)))
}

/// See `saoms_api::host::WriteProperties`.
#[proc_macro_derive(WriteProperties, attributes(property))]
pub fn write_properties(input: TokenStream) -> TokenStream {
    finish(properties::write_properties(&parse_macro_input!(input as DeriveInput)))
}

/// See `saoms_api::PropertyField`.
#[proc_macro_derive(PropertyField, attributes(property))]
pub fn property_field(input: TokenStream) -> TokenStream {
    finish(enumeration::property_field(&parse_macro_input!(input as DeriveInput)))
}

/// See `saoms_api::Class`.
#[proc_macro_derive(
    Class,
    attributes(
        class, extends, publishes, subscribes, takes, reference, properties, property, knowledge, loops, senses,
        effects, entry
    )
)]
pub fn class(input: TokenStream) -> TokenStream {
    let input = parse_macro_input!(input as DeriveInput);
    finish(class::class(&input).or_else(|error| Ok(handles::after_error(&input, &error, true))))
}

/// See `saoms_api::Entries`.
#[proc_macro_derive(Entries, attributes(entry))]
pub fn entries(input: TokenStream) -> TokenStream {
    finish(entries::entries(&parse_macro_input!(input as DeriveInput)))
}

/// See `saoms_api::Knowledge`.
#[proc_macro_derive(Knowledge, attributes(knowledge, entry, extras))]
pub fn knowledge(input: TokenStream) -> TokenStream {
    finish(entries::knowledge(&parse_macro_input!(input as DeriveInput)))
}

/// See `saoms_api::LoopClass`.
#[proc_macro_derive(
    LoopClass,
    attributes(
        looping, extends, publishes, subscribes, takes, reference, properties, property, knowledge, loops, senses,
        effects, entry
    )
)]
pub fn loop_class(input: TokenStream) -> TokenStream {
    let input = parse_macro_input!(input as DeriveInput);
    finish(looping::loop_class(&input).or_else(|error| Ok(handles::after_error(&input, &error, false))))
}

/// See `saoms_api::host::Interface`.
#[proc_macro_attribute]
pub fn interface(arguments: TokenStream, item: TokenStream) -> TokenStream {
    let item = match interface::of_implementation(item.clone().into()) {
        Some(Ok(implementation)) => {
            let kept = item.into();
            return finish(interface::with_implementation(arguments.into(), &implementation, kept));
        }
        Some(Err(error)) => return finish(Err(error)),
        None => parse_macro_input!(item as ItemTrait),
    };
    let result = interface::interface(arguments.into(), &item);
    // The trait is kept, so that its users do not fail as well.
    finish(result.or_else(|error| {
        let error = error.into_compile_error();
        Ok(quote::quote!(#item #error))
    }))
}
