use proc_macro2::{Span, TokenStream};
use quote::{quote, quote_spanned};
use syn::ext::IdentExt;
use syn::meta::ParseNestedMeta;
use syn::parse::ParseStream;
use syn::spanned::Spanned;
use syn::{DeriveInput, Error, Expr, Ident, LitStr, Path, Result, Token, Type, parenthesized};

use crate::docs::docs;
use crate::field::no_generics;
use crate::handles::{self, Handles, Role};
use crate::json::{self, Json};
use crate::literal::Literal;
use crate::loops::DefaultLoops;
use crate::parts::{self, Reference, end, paths};

/// Everything that `#[class(...)]` says.
#[derive(Default)]
struct Declared {
    name: Option<LitStr>,
    periodic: Option<(bool, Span)>,
    publishes: Vec<Path>,
    subscribes: Vec<Path>,
    services: Vec<(LitStr, Path)>,
    references: Vec<Reference>,
    stops: bool,
    reacts: bool,
    apart: bool,
    alternates: bool,
    saves: bool,
    knowledge: Option<Path>,
    loops: Option<DefaultLoops>,
    also: Vec<Also>,
}

/// A further name of the class, with preset properties.
struct Also {
    name: LitStr,
    presets: Vec<(String, String, Span)>,
}

/// `#[derive(Class)]`.
pub(crate) fn class(input: &DeriveInput) -> Result<TokenStream> {
    no_generics(&input.generics, "a component")?;
    let handles = Handles::of(input)?;
    handles.refuse("a component", |role| matches!(role, Role::Senses(_) | Role::Effects(_) | Role::Entry(_)))?;
    let declared = Declared::of(input, &handles)?;
    let ident = &input.ident;
    let properties = quote!(<#ident as ::saoms_api::Component>::Properties as ::saoms_api::Properties);
    let declaration = json::flat(&declared.declaration(&docs(&input.attrs), &properties, &handles)?.into_text());
    let class = declared.name()?.value();
    let arms = declared.services.iter().map(|(service, interface)| {
        // Faults are shown at the interface; `self` is that of this macro.
        let span = Span::call_site().located_at(interface.span());
        quote_spanned! {span=>
            #service => <dyn #interface>::dispatch(self, invocation, context),
        }
    });
    let presets = declared.also.iter().flat_map(|also| &also.presets).map(|(name, _, span)| {
        let message = format!("`also` presets `{name}`, which is not a property of the component");
        quote_spanned! {*span=>
            const _: () = ::core::assert!(::saoms_api::generated::contains(<#properties>::NAMES, #name), #message);
        }
    });
    let reserved = declared.periodic.filter(|(periodic, _)| *periodic).map(|(_, span)| {
        // Shown where the class says that it has a task.
        quote_spanned!(span=> const _: () = ::saoms_api::generated::refuse_reserved(<#properties>::NAMES);)
    });
    let no_such_service = match handles.extends() {
        Some((field, of)) => quote! {
            _ => <#of as ::saoms_api::Class>::serve(&mut self.#field, invocation, context),
        },
        None => quote! {
            other => ::core::result::Result::Err(::saoms_api::generated::no_service(#class, other)),
        },
    };
    let takes = handles.takes().map(|(event, topic, _)| {
        let message =
            format!("the event `{}` needs an event topic: a state topic keeps its newest message", event.value());
        quote_spanned! {topic.span()=>
            const _: () = ::core::assert!(
                ::core::matches!(#topic.kind(), ::saoms_api::host::TopicKind::Event),
                #message,
            );
        }
    });
    let loops = match (&declared.loops, &declared.knowledge) {
        (None, _) => handles.extends().iter().map(|(_, base)| loops_of(base)).collect(),
        (Some(loops), Some(knowledge)) => loops.registrations(&properties, knowledge),
        (Some(_), None) => {
            let message =
                "a class with loops needs a knowledge: `#[knowledge]` at its field, or `knowledge = RobotKnowledge`";
            return Err(Error::new_spanned(&declared.name, message));
        }
    };
    let (own, own_properties) = handles.own_properties();
    let said = quote!(<#ident as ::saoms_api::Component>::Properties);
    let (made, binds, lends) = (handles.made(&said), handles.binds(), handles.lends());
    let renewed = handles.renewed(&said);
    Ok(quote! {
        const _: () = {
            const DECLARATION: &str = #declaration;

            #own_properties

            #[automatically_derived]
            impl ::saoms_api::host::Fields for #ident {
                type Own = #own;
            }

            #[automatically_derived]
            impl ::saoms_api::host::Derived for #ident {
                fn made<const ASKED: bool>(
                    properties: #said,
                ) -> ::core::result::Result<Self, ::saoms_api::Failure> {
                    #made
                }

                fn renew(
                    &mut self,
                    properties: #said,
                ) -> ::core::result::Result<(), ::saoms_api::Failure> {
                    #renewed
                }

                fn bind(
                    &mut self,
                    context: &mut ::saoms_api::Context<'_>,
                ) -> ::core::result::Result<(), ::saoms_api::Failure> {
                    let _ = &context;
                    #binds
                    ::core::result::Result::Ok(())
                }

                #lends
            }

            #[automatically_derived]
            impl ::saoms_api::Class for #ident {
                const DECLARATION: &'static str = DECLARATION;
                #loops

                fn serve(
                    &mut self,
                    invocation: &mut ::saoms_api::host::Invocation<'_>,
                    context: &mut ::saoms_api::Context<'_>,
                ) -> ::core::result::Result<(), ::saoms_api::CallError> {
                    let _ = &context;
                    match invocation.service {
                        #(#arms)*
                        #no_such_service
                    }
                }
            }

            #(#presets)*
            #(#takes)*
            #reserved

            ::saoms_api::generated::inventory::submit! { ::saoms_api::host::Registration::of::<#ident>() }
        };
    })
}

impl Declared {
    fn of(input: &DeriveInput, handles: &Handles<'_>) -> Result<Declared> {
        let mut declared = Declared::default();
        let attributes: Vec<_> = input.attrs.iter().filter(|attribute| attribute.path().is_ident("class")).collect();
        for attribute in &attributes {
            attribute.parse_nested_meta(|meta| declared.take(&meta))?;
        }
        if let Some(of) = handles.knowledge() {
            let Type::Path(path) = of else { return Err(Error::new_spanned(of, "expected the name of a knowledge")) };
            if declared.knowledge.replace(path.path.clone()).is_some() {
                return Err(Error::new_spanned(of, "the class names its knowledge already"));
            }
        }
        handles::take_topics(&mut declared.publishes, handles.publishes())?;
        handles::take_topics(&mut declared.subscribes, handles.subscribes())?;
        if let (Some(_), Some(knowledge)) = (handles.extends(), &declared.knowledge) {
            let message = "the class has the knowledge and the loops of what it extends";
            return Err(Error::new_spanned(knowledge, message));
        }
        let events: Vec<_> = handles.takes().map(|(event, ..)| event).collect();
        for (place, event) in events.iter().enumerate() {
            if events[..place].iter().any(|other| other.value() == event.value()) {
                return Err(Error::new(event.span(), "the class takes this event already"));
            }
        }
        let place = attributes.first().map_or(input.ident.span(), |attribute| attribute.span());
        if declared.name.is_none() {
            let message = "expected `#[class(name = \"...\", periodic)]`: the name that composite files use";
            return Err(Error::new(place, message));
        }
        let mut names: Vec<_> = declared.name.iter().map(LitStr::value).collect();
        for also in &declared.also {
            if names.contains(&also.name.value()) {
                return Err(Error::new(also.name.span(), "the class has this name already"));
            }
            names.push(also.name.value());
        }
        match declared.periodic {
            None => Err(Error::new(
                place,
                "expected `periodic` or `passive`: whether the component is executed in each period",
            )),
            Some((false, span)) if declared.reacts => Err(Error::new(
                span,
                "a passive component receives no messages that it could react to: make it `periodic`",
            )),
            Some((false, _)) => match declared.subscribes.first() {
                Some(topic) => Err(Error::new_spanned(
                    topic,
                    "a passive component is never executed and so receives nothing: make it `periodic`, or drop \
                     `subscribes`",
                )),
                None => Ok(declared),
            },
            Some((true, _)) => Ok(declared),
        }
    }

    fn take(&mut self, meta: &ParseNestedMeta<'_>) -> Result<()> {
        let word = meta.path.get_ident().map(|ident| ident.unraw().to_string()).unwrap_or_default();
        match word.as_str() {
            "name" if self.name.is_none() => self.name = Some(meta.value()?.parse()?),
            "name" => {
                return Err(meta.error("the class has a name already: use `also(\"...\")` for further ones"));
            }
            "periodic" | "passive" if self.periodic.is_none() => {
                self.periodic = Some((word == "periodic", meta.path.span()));
            }
            "periodic" | "passive" => {
                return Err(meta.error("a component is either `periodic` or `passive`: write one of them once"));
            }
            "publishes" => self.publishes.extend(paths(meta.input)?),
            "subscribes" => self.subscribes.extend(paths(meta.input)?),
            "service" => {
                let list;
                parenthesized!(list in meta.input);
                let (name, interface) = parts::named(&list)?;
                end(&list)?;
                if self.services.iter().any(|(other, _)| other.value() == name.value()) {
                    return Err(Error::new(name.span(), "another service has this name, too"));
                }
                self.services.push((name, interface));
            }
            "reference" => self.references.push(parts::parse_reference(meta.input, &self.references)?),
            "stops" if !self.stops => self.stops = true,
            "reacts" if !self.reacts => self.reacts = true,
            "apart" if !self.apart => self.apart = true,
            "alternates" if !self.alternates => self.alternates = true,
            "saves" if !self.saves => self.saves = true,
            "knowledge" if self.knowledge.is_none() => self.knowledge = Some(meta.value()?.parse()?),
            "loops" if self.loops.is_none() => self.loops = Some(DefaultLoops::of(meta.input)?),
            "stops" | "reacts" | "apart" | "alternates" | "saves" | "knowledge" | "loops" => {
                return Err(meta.error("this is given already"));
            }
            "also" => {
                let list;
                parenthesized!(list in meta.input);
                self.also.push(Also::of(&list)?);
            }
            _ => {
                return Err(meta.error(
                    "expected one of `name`, `periodic`, `passive`, `publishes`, `subscribes`, `service`, \
                     `reference`, `stops`, `reacts`, `apart`, `alternates`, `saves`, `knowledge`, `loops`, `also`",
                ));
            }
        }
        Ok(())
    }

    fn name(&self) -> Result<&LitStr> {
        self.name.as_ref().ok_or_else(|| Error::new(Span::call_site(), "expected a name"))
    }

    fn declaration(&self, doc: &str, properties: &TokenStream, handles: &Handles<'_>) -> Result<Json> {
        let mut text = Json::default();
        text.plain("{\"contract\":1,\"class\":");
        text.string(&self.name()?.value());
        text.member("doc", doc);
        text.member("kind", if matches!(self.periodic, Some((true, _))) { "periodic" } else { "passive" });
        text.plain(",\"also\":");
        text.list(&self.also, |text, also| also.declare(text));
        parts::properties(&mut text, properties);
        for (member, topics) in [("publishes", &self.publishes), ("subscribes", &self.subscribes)] {
            text.plain(&format!(",\"{member}\":"));
            text.list(topics, parts::topic);
        }
        if handles.takes().next().is_some() {
            text.plain(",\"takes\":");
            text.list(handles.takes(), |text, (event, topic, doc)| {
                text.plain("{\"event\":");
                text.string(&event.value());
                text.plain(",\"topic\":");
                text.quoted(quote_spanned!(topic.span()=> #topic.name()));
                text.member("doc", doc);
                text.plain("}");
            });
        }
        text.plain(",\"services\":");
        text.list(&self.services, |text, (name, of)| {
            parts::interface(text, name, of);
            text.plain("}");
        });
        text.plain(",\"references\":");
        handles::declare_references(&mut text, &self.references, handles)?;
        let abilities = [
            (self.stops, "stops"),
            (self.reacts, "reacts"),
            (self.apart, "apart"),
            (self.alternates, "alternates"),
            (self.saves, "saves"),
        ];
        for (_, ability) in abilities.iter().filter(|(has, _)| *has) {
            text.plain(&format!(",\"{ability}\":true"));
        }
        if let Some(knowledge) = &self.knowledge {
            text.plain(",\"knowledge\":");
            text.json(
                quote_spanned!(knowledge.span()=> <#knowledge as ::saoms_api::host::KnowledgeClass>::DECLARATION),
            );
        }
        if let Some(loops) = &self.loops {
            loops.declare(&mut text);
        }
        if let Some((_, of)) = handles.extends() {
            text.plain(",\"extends\":");
            text.json(quote_spanned!(of.span()=> <#of as ::saoms_api::Class>::DECLARATION));
        }
        text.plain("}");
        Ok(text)
    }
}

/// The constant of a class that has the loops of the class that it extends.
fn loops_of(base: &Type) -> TokenStream {
    quote! {
        const LOOPS: &'static [::saoms_api::host::LoopRegistration] = <#base as ::saoms_api::Class>::LOOPS;
    }
}

impl Also {
    fn of(list: ParseStream<'_>) -> Result<Also> {
        let name = list.parse()?;
        let mut presets: Vec<(String, String, Span)> = Vec::new();
        while list.parse::<Option<Token![,]>>()?.is_some() && !list.is_empty() {
            let property = Ident::parse_any(list)?;
            list.parse::<Token![=]>()?;
            let value = Literal::of(&list.parse::<Expr>()?)?.text();
            let name = property.unraw().to_string();
            if presets.iter().any(|(other, ..)| *other == name) {
                return Err(Error::new(property.span(), "this property is preset already"));
            }
            presets.push((name, value, property.span()));
        }
        end(list)?;
        Ok(Also { name, presets })
    }

    fn declare(&self, text: &mut Json) {
        text.plain("{\"class\":");
        text.string(&self.name.value());
        text.plain(",\"preset\":{");
        for (place, (name, value, _)) in self.presets.iter().enumerate() {
            text.plain(if place > 0 { "," } else { "" });
            text.string(name);
            text.plain(":");
            text.string(value);
        }
        text.plain("}}");
    }
}
