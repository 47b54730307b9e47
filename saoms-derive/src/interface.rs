use proc_macro2::{Span, TokenStream};
use quote::{format_ident, quote};
use syn::ext::IdentExt;
use syn::parse::Parser;
use syn::punctuated::Punctuated;
use syn::{
    Attribute, Error, FnArg, GenericArgument, Ident, ImplItem, ItemImpl, ItemTrait, LitStr, Meta, Pat, PathArguments,
    ReceiverKind, Result, ReturnType, Signature, Token, TraitItem, TraitItemFn, Type,
};

use crate::case::lower_camel;
use crate::docs::docs;
use crate::json::{self, Json};

/// One operation.
struct Operation<'a> {
    attributes: Vec<&'a Attribute>,
    ident: &'a Ident,
    name: String,
    context: &'a Type,
    arguments: Vec<(&'a Ident, &'a Type)>,
    reply: &'a Type,
}

/// `#[interface(name = "...")]`.
pub(crate) fn interface(arguments: TokenStream, item: &ItemTrait) -> Result<TokenStream> {
    let name = name(arguments)?;
    if !item.generics.params.is_empty() {
        return Err(Error::new_spanned(
            &item.generics,
            "an interface cannot be generic: one declaration stands for one type",
        ));
    }
    let operations = item.items.iter().map(Operation::of).collect::<Result<Vec<_>>>()?;
    let mut text = Json::default();
    text.plain("{\"name\":");
    text.string(&name);
    text.plain(",\"operations\":");
    text.list(&operations, Operation::declare);
    text.plain("}");
    let declaration = json::flat(&text.into_text());
    let (ident, visibility) = (&item.ident, &item.vis);
    let arms = operations.iter().enumerate().map(|(number, operation)| operation.arm(number));
    let reference = reference(item, &name, &operations);
    Ok(quote! {
        // Its provider may be in another crate.
        #[allow(dead_code)]
        #item

        impl ::saoms_api::host::Interface for dyn #ident {
            const NAME: &'static str = #name;
            const DECLARATION: &'static str = #declaration;
        }

        impl dyn #ident {
            #[doc(hidden)]
            #visibility fn dispatch<C: ::saoms_api::Component + #ident>(
                component: &mut C,
                invocation: &mut ::saoms_api::host::Invocation<'_>,
                context: &mut ::saoms_api::Context<'_>,
            ) -> ::core::result::Result<(), ::saoms_api::CallError> {
                match invocation.call.operation() {
                    #(#arms)*
                    other => ::core::result::Result::Err(::saoms_api::generated::no_operation(#name, other)),
                }
            }
        }

        #reference
    })
}

/// The trait of an interface that its one component implements at once: the operations without their bodies. `None` for
/// what is no `impl`.
pub(crate) fn of_implementation(item: TokenStream) -> Option<Result<ItemTrait>> {
    let item: ItemImpl = syn::parse2(item).ok()?;
    let Some((path, _)) = &item.trait_ else {
        let message = "expected `impl NAME for COMPONENT`, which makes the interface NAME, or a `trait`";
        return Some(Err(Error::new_spanned(&item.self_ty, message)));
    };
    let Some(ident) = path.get_ident() else {
        return Some(Err(Error::new_spanned(path, "expected a new name: the interface is made here")));
    };
    let operations = item.items.iter().map(|item| match item {
        ImplItem::Fn(function) => {
            let (attributes, signature) = (&function.attrs, without_patterns(&function.sig));
            let documented = attributes.iter().filter(|attribute| attribute.path().is_ident("doc"));
            Ok(quote!(#(#documented)* #signature;))
        }
        other => Err(Error::new_spanned(other, "an interface has operations only: expected `fn`")),
    });
    let operations = match operations.collect::<Result<Vec<_>>>() {
        Ok(operations) => operations,
        Err(error) => return Some(Err(error)),
    };
    let documented = item.attrs.iter().filter(|attribute| attribute.path().is_ident("doc"));
    Some(syn::parse2(quote!(#(#documented)* pub trait #ident { #(#operations)* })))
}

/// The same signature for a trait: its context may be `_`, and no argument is `mut`.
fn without_patterns(signature: &Signature) -> Signature {
    let mut signature = signature.clone();
    for input in &mut signature.inputs {
        if let FnArg::Typed(argument) = input {
            match &mut *argument.pat {
                Pat::Ident(name) => name.mutability = None,
                Pat::Wild(_) => argument.pat = syn::parse_quote!(_context),
                _ => {}
            }
        }
    }
    signature
}

/// `#[interface(name = "...")]` above `impl NAME for COMPONENT`.
pub(crate) fn with_implementation(arguments: TokenStream, item: &ItemTrait, kept: TokenStream) -> Result<TokenStream> {
    let interface = interface(arguments, item)?;
    Ok(quote!(#interface #kept))
}

fn reference(item: &ItemTrait, name: &str, operations: &[Operation<'_>]) -> TokenStream {
    let (ident, visibility) = (&item.ident, &item.vis);
    let reference = format_ident!("{}Reference", ident.unraw());
    let doc = format!(
        "A handle to call a service with the interface [`{ident}`] through, from \
         [`Context::reference`](::saoms_api::Context::reference)."
    );
    let methods = operations.iter().enumerate().map(|(number, operation)| operation.method(visibility, number));
    quote! {
        #[doc = #doc]
        #[derive(Clone, Copy, Debug)]
        #visibility struct #reference {
            index: u32,
        }

        impl ::core::default::Default for #reference {
            fn default() -> Self {
                #reference { index: u32::MAX }
            }
        }

        impl ::saoms_api::host::Reference for #reference {
            const INTERFACE: &'static str = #name;
            const DECLARATION: &'static str = <dyn #ident as ::saoms_api::host::Interface>::DECLARATION;

            fn from_index(index: u32) -> Self {
                #reference { index }
            }

            fn index(&self) -> u32 {
                self.index
            }
        }

        impl #reference {
            #(#methods)*
        }
    }
}

impl<'a> Operation<'a> {
    fn of(item: &'a TraitItem) -> Result<Operation<'a>> {
        let TraitItem::Fn(function) = item else {
            return Err(Error::new_spanned(item, "an interface has operations only: expected `fn`"));
        };
        if !function.sig.generics.params.is_empty() {
            return Err(Error::new_spanned(&function.sig.generics, "an operation cannot be generic"));
        }
        if let Some(asyncness) = &function.sig.asyncness {
            return Err(Error::new_spanned(asyncness, "an operation runs at once: expected no `async`"));
        }
        let mut inputs = function.sig.inputs.iter();
        receiver(function, inputs.next())?;
        let context = match inputs.next() {
            Some(FnArg::Typed(context)) if is_context(&context.ty) => &*context.ty,
            other => {
                let found = other.map_or_else(|| quote!(), |argument| quote!(#argument));
                let place = if found.is_empty() {
                    let ident = &function.sig.ident;
                    quote!(#ident)
                } else {
                    found
                };
                return Err(Error::new_spanned(
                    place,
                    "an operation takes `context: &mut Context<'_>` after `&mut self`",
                ));
            }
        };
        let arguments = inputs.map(argument).collect::<Result<Vec<_>>>()?;
        if arguments.len() > 6 {
            return Err(Error::new_spanned(
                &function.sig.inputs,
                "an operation takes up to six arguments: put them into a struct with `#[derive(Field)]`",
            ));
        }
        Ok(Operation {
            attributes: function.attrs.iter().filter(|attribute| attribute.path().is_ident("doc")).collect(),
            ident: &function.sig.ident,
            name: lower_camel(&function.sig.ident),
            context,
            arguments,
            reply: reply(function)?,
        })
    }

    fn tuple(&self) -> (TokenStream, TokenStream) {
        let (names, types): (Vec<_>, Vec<_>) = self.arguments.iter().copied().unzip();
        (quote!((#(#names,)*)), quote!((#(#types,)*)))
    }

    fn declare(text: &mut Json, operation: &Operation<'_>) {
        text.plain("{\"name\":");
        text.string(&operation.name);
        text.plain(",\"arguments\":");
        text.list(&operation.arguments, |text, (name, of)| {
            text.plain("{\"name\":");
            text.string(&lower_camel(name));
            text.plain(",\"type\":");
            text.text(quote!(<#of as ::saoms_api::Field>::TYPE));
            text.plain("}");
        });
        let reply = operation.reply;
        text.plain(",\"reply\":");
        text.text(quote!(<#reply as ::saoms_api::Field>::TYPE));
        text.plain("}");
    }

    /// The provider's side.
    fn arm(&self, number: usize) -> TokenStream {
        let (number, ident, reply) = (number as u32, self.ident, self.reply);
        let (names, types) = self.tuple();
        let arguments = self.arguments.iter().map(|(name, _)| name);
        // An argument may be called `component` or `context`, too.
        let (provider, own) = (hidden("component"), hidden("context"));
        quote! {
            #number => invocation.serve::<C, #types, #reply>(component, context, |#provider, #own, #names| {
                #provider.#ident(#own, #(#arguments),*)
            }),
        }
    }

    /// The caller's side.
    fn method(&self, visibility: &syn::Visibility, number: usize) -> TokenStream {
        let (number, ident, reply, context) = (number as u32, self.ident, self.reply, self.context);
        let (names, types) = self.tuple();
        let arguments = self.arguments.iter().map(|(name, of)| quote!(#name: #of));
        let documented = docs(&self.attributes.iter().copied().cloned().collect::<Vec<_>>());
        let attributes = &self.attributes;
        let (own, call) = (hidden("context"), hidden("call"));
        let fallback = documented.is_empty().then(|| {
            let doc = format!("Calls `{}`.", self.name);
            quote!(#[doc = #doc])
        });
        quote! {
            #(#attributes)*
            #fallback
            ///
            /// # Errors
            /// The reference is not wired, or the provider cannot be called, or failed.
            #[allow(clippy::too_many_arguments)]
            #visibility fn #ident(
                &self,
                #own: #context,
                #(#arguments),*
            ) -> ::core::result::Result<#reply, ::saoms_api::CallError> {
                let mut #call = ::saoms_api::host::TypedCall::<#types, #reply>::new(#number, #names);
                #own.call(self.index, &mut #call)?;
                #call.into_reply()
            }
        }
    }
}

/// A local name that no name of the author can be mixed up with.
fn hidden(name: &str) -> Ident {
    Ident::new(name, Span::mixed_site())
}

fn name(arguments: TokenStream) -> Result<String> {
    const EXPECTED: &str = "expected `#[interface(name = \"...\")]`, the name that composite files use";
    let span = arguments.clone();
    let metas = Punctuated::<Meta, Token![,]>::parse_terminated.parse2(arguments)?;
    match metas.first() {
        Some(Meta::NameValue(meta)) if meta.path.is_ident("name") && metas.len() == 1 => {
            let value = &meta.value;
            Ok(syn::parse2::<LitStr>(quote!(#value))?.value())
        }
        Some(meta) => Err(Error::new_spanned(meta, EXPECTED)),
        None => Err(Error::new_spanned(span, EXPECTED)),
    }
}

fn receiver(function: &TraitItemFn, input: Option<&FnArg>) -> Result<()> {
    match input {
        Some(FnArg::Receiver(receiver)) if matches!(receiver.kind, ReceiverKind::Reference(_, None, Some(_))) => Ok(()),
        Some(other) => Err(Error::new_spanned(other, "an operation takes `&mut self` first")),
        None => Err(Error::new_spanned(&function.sig.ident, "an operation takes `&mut self` first")),
    }
}

/// True if the type is `&mut Context<'_>`, under any path.
fn is_context(of: &Type) -> bool {
    let Type::Reference(reference) = of else { return false };
    let Type::Path(path) = &*reference.elem else { return false };
    path.path.segments.last().is_some_and(|last| last.ident == "Context")
}

fn argument(input: &FnArg) -> Result<(&Ident, &Type)> {
    let FnArg::Typed(argument) = input else {
        return Err(Error::new_spanned(input, "expected an argument"));
    };
    let Pat::Ident(name) = &*argument.pat else {
        return Err(Error::new_spanned(&argument.pat, "an argument needs a name, which its declaration lists"));
    };
    if let Type::Reference(reference) = &*argument.ty {
        return Err(Error::new_spanned(
            reference,
            "arguments travel as values, perhaps to another process: expected an owned type such as `String` or \
             `Vec<T>`",
        ));
    }
    Ok((&name.ident, &argument.ty))
}

/// The `R` of `-> Result<R, Failure>`.
fn reply(function: &TraitItemFn) -> Result<&Type> {
    const EXPECTED: &str = "an operation returns `Result<R, Failure>`";
    let ReturnType::Type(_, of) = &function.sig.output else {
        return Err(Error::new_spanned(&function.sig, EXPECTED));
    };
    if let Type::Path(path) = &**of
        && let Some(last) = path.path.segments.last()
        && last.ident == "Result"
        && let PathArguments::AngleBracketed(generics) = &last.arguments
        && let Some(GenericArgument::Type(reply)) = generics.args.first()
    {
        return Ok(reply);
    }
    Err(Error::new_spanned(of, EXPECTED))
}
