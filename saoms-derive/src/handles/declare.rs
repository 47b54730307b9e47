//! What fields add to the declaration of a class or a loop: own properties and entries, topics, references.

use proc_macro2::TokenStream;
use quote::{ToTokens, format_ident, quote, quote_spanned};
use syn::ext::IdentExt;
use syn::spanned::Spanned;
use syn::{Attribute, Error, Ident, LitStr, Meta, Path, Result, Type};

use super::{Handle, Handles, OwnEntry, Role};
use crate::json::Json;
use crate::parts::{self, Reference};

impl Handles<'_> {
    /// The type of the own properties, and the struct itself where it has fields.
    pub(crate) fn own_properties(&self) -> (TokenStream, TokenStream) {
        if !self.has_own_properties() {
            let of = match self.extends() {
                Some((_, base)) => quote!(<#base as ::saoms_api::Component>::Properties),
                None => quote!(()),
            };
            return (of, TokenStream::new());
        }
        let name = format_ident!("{}Own", self.ident.unraw());
        let fields = self.all.iter().filter_map(|Handle { field, ident, role }| {
            let of = &field.ty;
            match role {
                Role::Extends => Some(quote! {
                    #[property(flatten)]
                    #ident: <#of as ::saoms_api::Component>::Properties
                }),
                Role::Property => {
                    let told = |attribute: &&Attribute| {
                        attribute.path().is_ident("doc")
                            || attribute.path().is_ident("property") && !matches!(attribute.meta, Meta::Path(_))
                    };
                    let attributes = field.attrs.iter().filter(told);
                    Some(quote!(#(#attributes)* #ident: #of))
                }
                _ => None,
            }
        });
        let properties = quote! {
            /// The properties that the fields declare.
            #[derive(::saoms_api::Properties)]
            #[allow(missing_docs, unreachable_pub, missing_debug_implementations)]
            pub struct #name { #(#fields),* }
        };
        (quote!(#name), properties)
    }

    /// The entries that the loop adds: their struct, and its name.
    pub(crate) fn own_entries(&self) -> Option<(Ident, TokenStream)> {
        let own = |handle: &Handle<'_>| matches!(handle.role, Role::Entry(_));
        if !self.all.iter().any(own) {
            return None;
        }
        let name = format_ident!("{}Entries", self.ident.unraw());
        let mut fields = Vec::new();
        let mut defaults = Vec::new();
        for Handle { field, ident, role } in &self.all {
            let Role::Entry(entry) = role else { continue };
            let OwnEntry { name, of, default, rest } = &**entry;
            let docs = field.attrs.iter().filter(|attribute| attribute.path().is_ident("doc"));
            fields.push(quote!(#(#docs)* #[entry(name = #name, #(#rest),*)] #ident: #of));
            defaults.push(match default {
                Some(value) => quote!(#ident: #value),
                None => quote!(#ident: ::core::default::Default::default()),
            });
        }
        let entries = quote! {
            /// The entries that the fields declare.
            #[derive(::saoms_api::Entries)]
            #[allow(missing_docs, unreachable_pub, missing_debug_implementations)]
            pub struct #name { #(#fields),* }

            impl ::core::default::Default for #name {
                fn default() -> Self {
                    #name { #(#defaults),* }
                }
            }
        };
        Some((name, entries))
    }
}

/// The JSON object of a reference in a field.
fn declare_reference(text: &mut Json, (name, of, optional): &(&LitStr, &Type, bool)) {
    let field = quote_spanned!(of.span()=> <#of as ::saoms_api::host::ReferenceField>);
    text.plain("{\"name\":");
    text.string(&name.value());
    text.plain(",\"interface\":");
    text.json(quote!(#field::DECLARATION));
    text.plain(",\"optional\":");
    text.text(quote!(::saoms_api::host::declaration::ConstText::Plain(
        if #optional || #field::OPTIONAL { "true" } else { "false" }
    )));
    text.text(
        quote!(::saoms_api::host::declaration::ConstText::Plain(if #field::MANY { ",\"many\":true}" } else { "}" })),
    );
}

/// The topics of fields, after those that the attribute of the struct names.
pub(crate) fn take_topics<'a>(topics: &mut Vec<Path>, fields: impl Iterator<Item = &'a Path>) -> Result<()> {
    for topic in fields {
        let text = topic.to_token_stream().to_string();
        if topics.iter().any(|other| other.to_token_stream().to_string() == text) {
            return Err(Error::new_spanned(topic, "this topic is named already: name it at its field alone"));
        }
        topics.push(topic.clone());
    }
    Ok(())
}

/// The JSON array of references: those that the attribute of the struct names, then those of fields.
pub(crate) fn declare_references(text: &mut Json, named: &[Reference], handles: &Handles<'_>) -> Result<()> {
    let fields: Vec<_> = handles.references().collect();
    for (place, (name, ..)) in fields.iter().enumerate() {
        let is_same = |other: &LitStr| other.value() == name.value();
        if named.iter().any(|(other, ..)| is_same(other)) || fields[..place].iter().any(|(other, ..)| is_same(other)) {
            return Err(Error::new(name.span(), "another reference has this name, too: name it at its field alone"));
        }
    }
    enum One<'a> {
        Named(&'a Reference),
        Field(&'a (&'a LitStr, &'a Type, bool)),
    }
    let all = named.iter().map(One::Named).chain(fields.iter().map(One::Field));
    text.list(all, |text, one| match one {
        One::Named(reference) => parts::reference(text, reference),
        One::Field(reference) => declare_reference(text, reference),
    });
    Ok(())
}
