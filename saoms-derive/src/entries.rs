use proc_macro2::{Span, TokenStream};
use quote::{format_ident, quote, quote_spanned};
use syn::spanned::Spanned;
use syn::{Attribute, Data, DeriveInput, Error, Fields, Ident, LitStr, Result, Type};

use crate::case::lower_camel;
use crate::docs::docs;
use crate::field::struct_fields;
use crate::json::{self, Json};

/// A field with `#[entry]`.
struct Entry<'a> {
    field: &'a Ident,
    of: &'a Type,
    name: String,
    doc: String,
    unit: String,
    effector: bool,
    flatten: bool,
    /// Its changes are no effects in the journal.
    quiet: bool,
    /// The constant that holds its place.
    place: Ident,
}

/// `#[derive(Entries)]`.
pub(crate) fn entries(input: &DeriveInput) -> Result<TokenStream> {
    struct_fields(input, "a struct with entries")?;
    let entries = Entry::all(input)?;
    if entries.is_empty() {
        let message = "no field is marked `#[entry]`: mark those that others may reach by name";
        return Err(Error::new_spanned(&input.ident, message));
    }
    Ok(implementation(&input.ident, &entries))
}

/// `#[derive(Knowledge)]`.
pub(crate) fn knowledge(input: &DeriveInput) -> Result<TokenStream> {
    struct_fields(input, "a knowledge")?;
    let mut name: Option<LitStr> = None;
    for attribute in input.attrs.iter().filter(|attribute| attribute.path().is_ident("knowledge")) {
        attribute.parse_nested_meta(|meta| {
            if !meta.path.is_ident("name") {
                return Err(meta.error("expected `name = \"...\"`"));
            }
            name = Some(meta.value()?.parse()?);
            Ok(())
        })?;
    }
    let ident = &input.ident;
    let Some(name) = name else {
        let message = "expected `#[knowledge(name = \"...\")]`: the name by which loops refer to it";
        return Err(Error::new_spanned(ident, message));
    };
    let extras = extras(input)?;
    let entries = entries(input)?;
    let mut text = Json::default();
    text.plain("{\"name\":");
    text.string(&name.value());
    text.member("doc", &docs(&input.attrs));
    text.plain(",\"entries\":[");
    text.text(quote!(<#ident as ::saoms_api::Entries>::TEXT));
    text.plain("]}");
    let declaration = json::flat(&text.into_text());
    Ok(quote! {
        #entries

        #[automatically_derived]
        impl ::saoms_api::host::KnowledgeClass for #ident {
            const NAME: &'static str = #name;
            const DECLARATION: &'static str = #declaration;
        }

        #[automatically_derived]
        impl ::saoms_api::Knowledge for #ident {
            fn declaration(&self) -> &'static str {
                <#ident as ::saoms_api::host::KnowledgeClass>::DECLARATION
            }

            fn extras(&self) -> &::saoms_api::Extras {
                &self.#extras
            }

            fn extras_mut(&mut self) -> &mut ::saoms_api::Extras {
                &mut self.#extras
            }
        }
    })
}

/// The field with `#[extras]`.
fn extras(input: &DeriveInput) -> Result<&Ident> {
    let mut found = None;
    for field in named(input) {
        if field.attrs.iter().any(|attribute| attribute.path().is_ident("extras"))
            && let Some(ident) = &field.ident
            && found.replace(ident).is_some()
        {
            return Err(Error::new_spanned(ident, "another field is marked `#[extras]` already"));
        }
    }
    found.ok_or_else(|| {
        let message =
            "a knowledge has a field for what loops add: `#[extras] extras: Extras`, made with `Extras::default()`";
        Error::new_spanned(&input.ident, message)
    })
}

fn named(input: &DeriveInput) -> impl Iterator<Item = &syn::Field> {
    let fields = match &input.data {
        Data::Struct(data) => match &data.fields {
            Fields::Named(fields) => Some(&fields.named),
            _ => None,
        },
        _ => None,
    };
    fields.into_iter().flatten()
}

impl<'a> Entry<'a> {
    fn all(input: &'a DeriveInput) -> Result<Vec<Entry<'a>>> {
        let mut entries = Vec::new();
        for field in named(input) {
            let attributes: Vec<&Attribute> =
                field.attrs.iter().filter(|attribute| attribute.path().is_ident("entry")).collect();
            let Some(ident) = field.ident.as_ref().filter(|_| !attributes.is_empty()) else { continue };
            let mut entry = Entry {
                field: ident,
                of: &field.ty,
                name: lower_camel(ident),
                doc: docs(&field.attrs),
                unit: String::new(),
                effector: false,
                flatten: false,
                quiet: false,
                place: format_ident!("AT_{}", entries.len(), span = Span::call_site()),
            };
            attributes.into_iter().try_for_each(|attribute| entry.take(attribute))?;
            entries.push(entry);
        }
        Ok(entries)
    }

    fn take(&mut self, attribute: &Attribute) -> Result<()> {
        if matches!(attribute.meta, syn::Meta::Path(_)) {
            return Ok(());
        }
        attribute.parse_nested_meta(|meta| {
            let text = || meta.value()?.parse::<LitStr>().map(|text| text.value());
            if meta.path.is_ident("name") {
                self.name = text()?;
            } else if meta.path.is_ident("unit") {
                self.unit = text()?;
            } else if meta.path.is_ident("effector") {
                self.effector = true;
            } else if meta.path.is_ident("flatten") {
                self.flatten = true;
            } else if meta.path.is_ident("quiet") {
                self.quiet = true;
            } else {
                return Err(meta.error("expected one of `name`, `unit`, `effector`, `flatten`, `quiet`"));
            }
            Ok(())
        })
    }

    /// Number of entries that it declares.
    fn count(&self) -> TokenStream {
        let of = self.of;
        match self.flatten {
            true => quote!((<#of as ::saoms_api::Entries>::DECLARED.len() as u32)),
            false => quote!(1),
        }
    }

    /// An expression of type `&[EntryDeclaration]`.
    fn declared(&self) -> TokenStream {
        let (of, name, effector) = (self.of, &self.name, self.effector);
        if self.flatten {
            return quote_spanned!(of.span()=> <#of as ::saoms_api::Entries>::DECLARED);
        }
        let of = json::flat(&quote_spanned!(of.span()=> <#of as ::saoms_api::Field>::TYPE));
        quote!(&[::saoms_api::host::EntryDeclaration { name: #name, of: #of, effector: #effector }])
    }

    /// Its JSON object, or those of its own entries.
    fn declare(&self, text: &mut Json) {
        let of = self.of;
        if self.flatten {
            return text.text(quote!(<#of as ::saoms_api::Entries>::TEXT));
        }
        text.plain("{\"name\":");
        text.string(&self.name);
        text.plain(",\"type\":");
        text.text(quote!(<#of as ::saoms_api::Field>::TYPE));
        text.text(quote! {
            if <#of as ::saoms_api::Field>::VALUE.is_empty() {
                ::saoms_api::host::declaration::ConstText::EMPTY
            } else {
                ::saoms_api::host::declaration::ConstText::Joined(&[
                    ::saoms_api::host::declaration::ConstText::Plain(",\"value\":\""),
                    ::saoms_api::host::declaration::ConstText::Plain(<#of as ::saoms_api::Field>::VALUE),
                    ::saoms_api::host::declaration::ConstText::Plain("\""),
                ])
            }
        });
        text.member("doc", &self.doc);
        text.member("unit", &self.unit);
        text.plain(if self.effector { ",\"effector\":true" } else { "" });
        text.plain(if self.quiet { ",\"quiet\":true}" } else { "}" });
    }

    /// An arm of a `match` over the number of an entry: one expression for a plain field, another for a flattened one.
    fn arm(&self, (plain, flattened): (TokenStream, TokenStream)) -> TokenStream {
        let (place, count) = (&self.place, self.count());
        match self.flatten {
            true => quote!(#place.. if entry - #place < #count => #flattened),
            false => quote!(#place => #plain),
        }
    }
}

fn implementation(ident: &Ident, entries: &[Entry<'_>]) -> TokenStream {
    let mut text = Json::default();
    for (number, entry) in entries.iter().enumerate() {
        text.plain(if number > 0 { "," } else { "" });
        entry.declare(&mut text);
    }
    let text = text.into_text();
    let groups = entries.iter().map(Entry::declared);
    let mut places = Vec::new();
    let mut next = quote!(0);
    for entry in entries {
        let (place, count) = (&entry.place, entry.count());
        places.push(quote!(const #place: u32 = #next;));
        next = quote!(#place + #count);
    }
    let each = |arm: &dyn Fn(&Entry<'_>) -> (TokenStream, TokenStream)| -> Vec<TokenStream> {
        entries.iter().map(|entry| entry.arm(arm(entry))).collect()
    };
    let get = each(&|Entry { field, place, .. }| {
        (
            quote!(::saoms_api::Field::as_value(&self.#field)),
            quote!(::saoms_api::Entries::get(&self.#field, entry - #place)),
        )
    });
    let set = each(&|Entry { field, place, name, .. }| {
        (
            quote!(::saoms_api::generated::set_field(&mut self.#field, #name, value)),
            quote!(::saoms_api::Entries::set(&mut self.#field, entry - #place, value)),
        )
    });
    let get_bytes = each(&|Entry { field, place, .. }| {
        (
            quote!({
                ::saoms_api::host::cdr::encode_into(&self.#field, bytes);
                ::core::result::Result::Ok(())
            }),
            quote!(::saoms_api::Entries::get_bytes(&self.#field, entry - #place, bytes)),
        )
    });
    let set_bytes = each(&|Entry { field, place, name, .. }| {
        (
            quote!(::saoms_api::generated::decode_field(&mut self.#field, #name, bytes)),
            quote!(::saoms_api::Entries::set_bytes(&mut self.#field, entry - #place, bytes)),
        )
    });
    let read = entries.iter().map(|Entry { field, flatten, quiet, .. }| match (flatten, quiet) {
        (true, _) => quote!(::saoms_api::Entries::read(&self.#field, values);),
        (false, true) => quote!(values.push(::saoms_api::Value::Nothing);),
        (false, false) => quote! {
            values.push(::saoms_api::Field::as_value(&self.#field).unwrap_or(::saoms_api::Value::Nothing));
        },
    });
    let failure = quote!(::core::result::Result<(), ::saoms_api::Failure>);
    let none = quote!(::core::result::Result::Err(::saoms_api::generated::no_entry(entry)));
    let message = format!("two entries of `{ident}` have one name");
    quote! {
        const _: () = {
            #(#places)*
            const COUNT: usize = (#next) as usize;
            const GROUPS: &[&[::saoms_api::host::EntryDeclaration]] = &[#(#groups),*];
            const ALL: [::saoms_api::host::EntryDeclaration; COUNT] = ::saoms_api::generated::joined(GROUPS);
            ::core::assert!(::saoms_api::generated::are_unique(&ALL), #message);

            #[automatically_derived]
            impl ::saoms_api::Entries for #ident {
                const DECLARED: &'static [::saoms_api::host::EntryDeclaration] = &ALL;
                const TEXT: ::saoms_api::host::declaration::ConstText = #text;

                fn get(&self, entry: u32) -> ::core::option::Option<::saoms_api::Value> {
                    match entry {
                        #(#get,)*
                        _ => ::core::option::Option::None,
                    }
                }

                fn set(&mut self, entry: u32, value: ::saoms_api::Value) -> #failure {
                    match entry {
                        #(#set,)*
                        _ => #none,
                    }
                }

                fn get_bytes(&self, entry: u32, bytes: &mut ::std::vec::Vec<u8>) -> #failure {
                    match entry {
                        #(#get_bytes,)*
                        _ => #none,
                    }
                }

                fn set_bytes(&mut self, entry: u32, bytes: &[u8]) -> #failure {
                    match entry {
                        #(#set_bytes,)*
                        _ => #none,
                    }
                }

                #[inline]
                fn read(&self, values: &mut ::std::vec::Vec<::saoms_api::Value>) {
                    values.reserve(COUNT);
                    #(#read)*
                }
            }
        };
    }
}
