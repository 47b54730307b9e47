//! The code that makes a component or a loop and binds the handles in its fields.

use proc_macro2::{Span, TokenStream};
use quote::{quote, quote_spanned};
use syn::Field;
use syn::ext::IdentExt;
use syn::spanned::Spanned;

use super::{Handle, Handles, Role};

impl Handles<'_> {
    /// The body of `made`, which takes `properties` of the type that the component says, and `ASKED`.
    pub(crate) fn made(&self, said: &TokenStream) -> TokenStream {
        let ident = self.ident;
        let mut checks = TokenStream::new();
        let (own, _) = self.own_properties();
        let all_in_one = self.with(&Role::Properties).next().is_some();
        if !all_in_one {
            let message = format!(
                "`{ident}` has no `new`, and its fields do not take its properties: write `type Properties = \
                 Own<Self>;` and mark each property's field `#[property]`, or mark the field that holds them all \
                 `#[properties]`, or write `fn new`",
            );
            checks.extend(quote! {
                const { ::core::assert!(!ASKED || ::saoms_api::generated::Same::<#said, #own>::IS, #message) };
                let own = ::saoms_api::generated::Same::<#said, #own>::cast(properties);
                let _ = &own;
            });
        }
        let default_of = |field: &Field, name: &str| {
            let of = &field.ty;
            let message = format!(
                "`{ident}` has no `new`, and its field `{name}` has no default: give its type one, or write `fn new`"
            );
            quote_spanned! {of.span().resolved_at(Span::call_site())=> {
                const { ::core::assert!(!ASKED || ::saoms_api::generated::DefaultOf::<#of>::EXISTS, #message) };
                ::saoms_api::generated::DefaultOf::<#of>::make()
            }}
        };
        let value = |Handle { field, ident, role }: &Handle<'_>| match role {
            Role::Properties => quote!(#ident: properties),
            Role::Property => quote!(#ident: own.#ident),
            Role::Extends if !all_in_one => {
                let (of, values) = (&field.ty, self.has_own_properties().then(|| quote!(.#ident)));
                quote!(#ident: <#of as ::saoms_api::Component>::new(own #values)?)
            }
            _ => {
                let default = default_of(field, &ident.unraw().to_string());
                quote!(#ident: #default)
            }
        };
        let made = match self.unnamed {
            Some(fields) => {
                let values = fields.iter().enumerate().map(|(place, field)| default_of(field, &place.to_string()));
                quote!(#ident(#(#values),*))
            }
            None => {
                let values = self.all.iter().map(value);
                quote!(#ident { #(#values),* })
            }
        };
        quote! {
            #[allow(unused_imports)]
            use ::saoms_api::generated::{Different as _, NoDefault as _};
            #checks
            ::core::result::Result::Ok(#made)
        }
    }

    /// The body of `renew`, which takes `properties` of the type that the component says.
    pub(crate) fn renewed(&self, said: &TokenStream) -> TokenStream {
        if let Some(Handle { ident, .. }) = self.with(&Role::Properties).next() {
            return quote! {
                self.#ident = properties;
                ::core::result::Result::Ok(())
            };
        }
        let (own, _) = self.own_properties();
        let nested = self.has_own_properties();
        let take = |Handle { field, ident, role }: &Handle<'_>| match role {
            Role::Property => Some(quote!(self.#ident = own.#ident;)),
            Role::Extends => {
                let (of, values) = (&field.ty, nested.then(|| quote!(.#ident)));
                Some(quote!(<#of as ::saoms_api::Component>::update(&mut self.#ident, own #values)?;))
            }
            _ => None,
        };
        let takes: Vec<_> = self.all.iter().filter_map(take).collect();
        if takes.is_empty() {
            return quote! {
                let _ = properties;
                ::core::result::Result::Err(::saoms_api::generated::no_update())
            };
        }
        quote! {
            #[allow(unused_imports)]
            use ::saoms_api::generated::Different as _;
            if !::saoms_api::generated::Same::<#said, #own>::IS {
                return ::core::result::Result::Err(::saoms_api::generated::no_update());
            }
            let own = ::saoms_api::generated::Same::<#said, #own>::cast(properties);
            #(#takes)*
            ::core::result::Result::Ok(())
        }
    }

    /// The statements that bind the handles of `self`, with `context` and, of a loop, `knowledge`.
    pub(crate) fn binds(&self) -> TokenStream {
        let effector = |field: &syn::Ident, name: &syn::LitStr| quote_spanned!(name.span()=> self.#field = ::saoms_api::Effector::of(knowledge, #name)?;);
        let bind = |Handle { field, ident, role }: &Handle<'_>| {
            let of = &field.ty;
            Some(match role {
                Role::Publishes(topic) => quote_spanned! {topic.span()=>
                    self.#ident = ::saoms_api::Context::publish(context, &#topic)?;
                },
                Role::Subscribes(topic) | Role::Takes { topic, .. } => quote_spanned! {topic.span()=>
                    self.#ident = ::saoms_api::Context::subscribe(context, &#topic)?;
                },
                Role::Reference { name, .. } => quote_spanned! {of.span()=>
                    self.#ident = <#of as ::saoms_api::host::ReferenceField>::bind(#name, context)?;
                },
                Role::Senses(name) => quote_spanned! {name.span()=>
                    self.#ident = ::saoms_api::Entry::of(knowledge, #name)?;
                },
                Role::Effects(name) => effector(ident, name),
                Role::Entry(entry) => effector(ident, &entry.name),
                Role::Extends => quote!(<#of as ::saoms_api::host::Derived>::bind(&mut self.#ident, context)?;),
                Role::Loops => quote!(self.#ident = ::saoms_api::Context::loops(context)?;),
                _ => return None,
            })
        };
        self.all.iter().filter_map(bind).collect()
    }

    /// The functions of `Derived` that lend parts of the component.
    pub(crate) fn lends(&self) -> TokenStream {
        if let Some((field, _)) = self.extends() {
            return quote! {
                fn base(&self) -> ::core::option::Option<&dyn ::saoms_api::host::DynComponent> {
                    ::core::option::Option::Some(&self.#field)
                }

                fn base_mut(&mut self) -> ::core::option::Option<&mut dyn ::saoms_api::host::DynComponent> {
                    ::core::option::Option::Some(&mut self.#field)
                }
            };
        }
        let (Some(loops), Some(knowledge)) = (self.with(&Role::Loops).next(), self.with(&Role::Knowledge).next())
        else {
            return TokenStream::new();
        };
        let (loops, knowledge) = (loops.ident, knowledge.ident);
        quote! {
            fn own_loops(
                &mut self,
            ) -> ::core::option::Option<(&mut ::saoms_api::Loops, &mut dyn ::saoms_api::Knowledge)> {
                ::saoms_api::generated::parts(&mut self.#loops, &mut self.#knowledge)
            }
        }
    }
}
