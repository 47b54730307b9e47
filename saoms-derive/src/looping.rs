use proc_macro2::TokenStream;
use quote::{quote, quote_spanned};
use syn::ext::IdentExt;
use syn::meta::ParseNestedMeta;
use syn::punctuated::Punctuated;
use syn::spanned::Spanned;
use syn::{DeriveInput, Error, LitStr, Path, Result, Token, parenthesized};

use crate::docs::docs;
use crate::field::no_generics;
use crate::handles::{self, Handles, Role};
use crate::json::{self, Json};
use crate::parts::{self, Reference};

/// Content of `#[looping(...)]`.
#[derive(Default)]
struct Declared {
    name: Option<LitStr>,
    /// An expression of type `&'static str`.
    knowledge: Option<TokenStream>,
    senses: Vec<LitStr>,
    effects: Vec<LitStr>,
    entries: Option<Path>,
    publishes: Vec<Path>,
    subscribes: Vec<Path>,
    references: Vec<Reference>,
}

/// `#[derive(LoopClass)]`.
pub(crate) fn loop_class(input: &DeriveInput) -> Result<TokenStream> {
    no_generics(&input.generics, "a loop")?;
    let handles = Handles::of(input)?;
    handles
        .refuse("a loop", |role| matches!(role, Role::Extends | Role::Takes { .. } | Role::Knowledge | Role::Loops))?;
    let declared = Declared::of(input, &handles)?;
    let ident = &input.ident;
    let name = declared.name(input)?;
    let properties = quote!(<#ident as ::saoms_api::Loop>::Properties as ::saoms_api::Properties);
    let declaration = declared.declaration(name, ident, &docs(&input.attrs), &properties, &handles)?;
    let declaration = json::flat(&declaration.into_text());
    let knowledge = match &declared.knowledge {
        Some(name) => quote!(::core::option::Option::Some(#name)),
        None => quote!(<<#ident as ::saoms_api::Loop>::Knowledge as ::saoms_api::host::Subject>::NAME),
    };
    let effects = &declared.effects;
    let entries = declared.entries.iter().map(|entries| {
        quote_spanned! {entries.span()=>
            fn entries() -> ::core::option::Option<::std::boxed::Box<dyn ::saoms_api::host::DynEntries>> {
                ::core::option::Option::Some(::std::boxed::Box::new(
                    <#entries as ::core::default::Default>::default(),
                ))
            }
        }
    });
    let (own, own_properties) = handles.own_properties();
    let own_entries = handles.own_entries().map(|(_, entries)| entries);
    let said = quote!(<#ident as ::saoms_api::Loop>::Properties);
    let (made, binds) = (handles.made(&said), handles.binds());
    Ok(quote! {
        const _: () = {
            #own_properties
            #own_entries

            const DECLARATION: &str = #declaration;

            #[automatically_derived]
            impl ::saoms_api::host::Fields for #ident {
                type Own = #own;
            }

            #[automatically_derived]
            impl ::saoms_api::host::DerivedLoop for #ident {
                fn made<const ASKED: bool>(
                    properties: #said,
                ) -> ::core::result::Result<Self, ::saoms_api::Failure> {
                    #made
                }

                fn bind(
                    &mut self,
                    knowledge: &mut dyn ::saoms_api::Knowledge,
                    context: &mut ::saoms_api::Context<'_>,
                ) -> ::core::result::Result<(), ::saoms_api::Failure> {
                    let _ = (&knowledge, &context);
                    #binds
                    ::core::result::Result::Ok(())
                }
            }

            #[automatically_derived]
            impl ::saoms_api::LoopClass for #ident {
                const NAME: &'static str = #name;
                const DECLARATION: &'static str = DECLARATION;
                const KNOWLEDGE: ::core::option::Option<&'static str> = #knowledge;
                const EFFECTS: &'static [&'static str] = &[#(#effects),*];

                #(#entries)*
            }

            ::saoms_api::generated::inventory::submit! { ::saoms_api::host::LoopRegistration::of::<#ident>() }
        };
    })
}

impl Declared {
    fn of(input: &DeriveInput, handles: &Handles<'_>) -> Result<Declared> {
        let mut declared = Declared::default();
        for attribute in input.attrs.iter().filter(|attribute| attribute.path().is_ident("looping")) {
            attribute.parse_nested_meta(|meta| declared.take(&meta))?;
        }
        handles::take_topics(&mut declared.publishes, handles.publishes())?;
        handles::take_topics(&mut declared.subscribes, handles.subscribes())?;
        handles.senses().try_for_each(|name| add(&mut declared.senses, name.clone()))?;
        handles.effects().try_for_each(|name| add(&mut declared.effects, name.clone()))?;
        if let Some((name, _)) = handles.own_entries()
            && let Some(other) = declared.entries.replace(name.into())
        {
            return Err(Error::new_spanned(
                other,
                "the loop has entries in fields already: put all into the same place",
            ));
        }
        Ok(declared)
    }

    fn take(&mut self, meta: &ParseNestedMeta<'_>) -> Result<()> {
        let word = meta.path.get_ident().map(|ident| ident.unraw().to_string()).unwrap_or_default();
        match word.as_str() {
            "name" if self.name.is_none() => self.name = Some(meta.value()?.parse()?),
            "name" => return Err(meta.error("the loop has a name already")),
            "knowledge" => {
                let value = meta.value()?;
                self.knowledge = Some(if value.peek(LitStr) {
                    let name: LitStr = value.parse()?;
                    quote!(#name)
                } else {
                    let path: Path = value.parse()?;
                    quote_spanned!(path.span()=> <#path as ::saoms_api::host::KnowledgeClass>::NAME)
                });
            }
            "senses" => names(meta, &mut self.senses)?,
            "effects" => names(meta, &mut self.effects)?,
            "entries" if self.entries.is_none() => {
                let list;
                parenthesized!(list in meta.input);
                self.entries = Some(list.parse()?);
                parts::end(&list)?;
            }
            "entries" => return Err(meta.error("the loop has entries already: put all into one struct")),
            "publishes" => self.publishes.extend(parts::paths(meta.input)?),
            "subscribes" => self.subscribes.extend(parts::paths(meta.input)?),
            "reference" => self.references.push(parts::parse_reference(meta.input, &self.references)?),
            _ => {
                return Err(meta.error(
                    "expected one of `name`, `knowledge`, `senses`, `effects`, `entries`, `publishes`, `subscribes`, \
                     `reference`",
                ));
            }
        }
        Ok(())
    }

    fn name<'a>(&'a self, input: &'a DeriveInput) -> Result<&'a LitStr> {
        match &self.name {
            Some(name) if name.value().rsplit('.').next().is_some_and(|last| !last.trim().is_empty()) => Ok(name),
            Some(name) => Err(Error::new(name.span(), "expected a name, as in `example.BatterySaver`")),
            None => Err(Error::new_spanned(
                &input.ident,
                "expected `#[looping(name = \"...\")]`: the name that composite files use",
            )),
        }
    }

    fn declaration(
        &self,
        name: &LitStr,
        ident: &syn::Ident,
        doc: &str,
        properties: &TokenStream,
        handles: &Handles<'_>,
    ) -> Result<Json> {
        let mut text = Json::default();
        text.plain("{\"contract\":1,\"loop\":");
        text.string(&name.value());
        text.member("doc", doc);
        text.text(quote! {{
            const PARTS: &[::saoms_api::host::declaration::ConstText] = &::saoms_api::generated::member(
                ",\"knowledge\":",
                <#ident as ::saoms_api::LoopClass>::KNOWLEDGE,
            );
            ::saoms_api::host::declaration::ConstText::Joined(PARTS)
        }});
        text.text(quote! {
            if <<#ident as ::saoms_api::Loop>::Knowledge as ::saoms_api::host::Subject>::NAME.is_some() {
                ::saoms_api::host::declaration::ConstText::Plain(",\"direct\":true")
            } else {
                ::saoms_api::host::declaration::ConstText::EMPTY
            }
        });
        parts::properties(&mut text, properties);
        for (member, names) in [("senses", &self.senses), ("effects", &self.effects)] {
            text.plain(&format!(",\"{member}\":"));
            text.list(names, |text, name| text.string(&name.value()));
        }
        text.plain(",\"entries\":[");
        if let Some(entries) = &self.entries {
            text.text(quote_spanned!(entries.span()=> <#entries as ::saoms_api::Entries>::TEXT));
        }
        text.plain("]");
        for (member, topics) in [("publishes", &self.publishes), ("subscribes", &self.subscribes)] {
            text.plain(&format!(",\"{member}\":"));
            text.list(topics, parts::topic);
        }
        text.plain(",\"references\":");
        handles::declare_references(&mut text, &self.references, handles)?;
        text.plain("}");
        Ok(text)
    }
}

/// `("battery", "block")`.
fn names(meta: &ParseNestedMeta<'_>, names: &mut Vec<LitStr>) -> Result<()> {
    let list;
    parenthesized!(list in meta.input);
    Punctuated::<LitStr, Token![,]>::parse_terminated(&list)?.into_iter().try_for_each(|name| add(names, name))
}

fn add(names: &mut Vec<LitStr>, name: LitStr) -> Result<()> {
    if names.iter().any(|other| other.value() == name.value()) {
        return Err(Error::new(name.span(), "this entry is named already"));
    }
    names.push(name);
    Ok(())
}
