use proc_macro2::TokenStream;
use quote::{ToTokens, quote, quote_spanned};
use syn::ext::IdentExt;
use syn::parse::ParseStream;
use syn::punctuated::Punctuated;
use syn::spanned::Spanned;
use syn::{Error, Ident, LitStr, Path, Result, Token, parenthesized};

use crate::json::Json;
use crate::parts;

/// The loops that a class has by default: `loops(A, B)`, or `loops(property = "policy", safe(A, B), classic(C))`.
pub(crate) struct DefaultLoops {
    /// The property whose value chooses a list.
    property: Option<LitStr>,
    /// The lists with the values that choose them; without a property one list of no name.
    lists: Vec<(String, Vec<Path>)>,
}

impl DefaultLoops {
    pub(crate) fn of(input: ParseStream<'_>) -> Result<DefaultLoops> {
        let list;
        parenthesized!(list in input);
        if !(list.peek(Ident::peek_any) && list.peek2(Token![=])) {
            let loops = Punctuated::<Path, Token![,]>::parse_terminated(&list)?.into_iter().collect();
            return Ok(DefaultLoops { property: None, lists: vec![(String::new(), loops)] });
        }
        let word = Ident::parse_any(&list)?;
        if word != "property" {
            return Err(Error::new(word.span(), "expected `property = \"...\"`, or a list of loops"));
        }
        list.parse::<Token![=]>()?;
        let property = Some(list.parse()?);
        let mut lists: Vec<(String, Vec<Path>)> = Vec::new();
        while list.parse::<Option<Token![,]>>()?.is_some() && !list.is_empty() {
            let value = Ident::parse_any(&list)?;
            let name = value.unraw().to_string();
            if lists.iter().any(|(other, _)| *other == name) {
                return Err(Error::new(value.span(), "this value has its loops already"));
            }
            lists.push((name, parts::paths(&list)?));
        }
        parts::end(&list)?;
        Ok(DefaultLoops { property, lists })
    }

    /// `,"loops":...`
    pub(crate) fn declare(&self, text: &mut Json) {
        let names = |text: &mut Json, loops: &[Path]| {
            text.list(loops, |text, of| {
                text.quoted(quote_spanned!(of.span()=> <#of as ::saoms_api::LoopClass>::NAME));
            });
        };
        text.plain(",\"loops\":{");
        match &self.property {
            None => {
                text.plain("\"default\":");
                names(text, self.lists.first().map_or(&[], |(_, loops)| loops));
            }
            Some(property) => {
                text.plain("\"property\":");
                text.string(&property.value());
                text.plain(",\"lists\":{");
                for (place, (value, loops)) in self.lists.iter().enumerate() {
                    text.plain(if place > 0 { "," } else { "" });
                    text.string(value);
                    text.plain(":");
                    names(text, loops);
                }
                text.plain("}");
            }
        }
        text.plain("}");
    }

    /// The constant of the class that registers the loops, with compile-time checks.
    pub(crate) fn registrations(&self, properties: &TokenStream, knowledge: &Path) -> TokenStream {
        let mut loops: Vec<&Path> = Vec::new();
        for path in self.lists.iter().flat_map(|(_, loops)| loops) {
            // Two lists may contain the same loop; a duplicate under another path does no harm.
            let text = |path: &Path| path.to_token_stream().to_string();
            if loops.iter().all(|known| text(known) != text(path)) {
                loops.push(path);
            }
        }
        let property = self.property.iter().map(|property| {
            let message =
                format!("`loops` are chosen by `{}`, which is not a property of the component", property.value());
            quote_spanned! {property.span()=>
                ::core::assert!(::saoms_api::generated::contains(<#properties>::NAMES, #property), #message);
            }
        });
        let fits = loops.iter().map(|of| {
            let message = "this loop works on another knowledge than that of the class";
            quote_spanned! {of.span()=>
                ::core::assert!(
                    ::saoms_api::generated::fits(
                        <#of as ::saoms_api::LoopClass>::KNOWLEDGE,
                        <#knowledge as ::saoms_api::host::KnowledgeClass>::NAME,
                    ),
                    #message,
                );
            }
        });
        quote! {
            const LOOPS: &'static [::saoms_api::host::LoopRegistration] = {
                #(#property)*
                #(#fits)*
                &[#(::saoms_api::host::LoopRegistration::of::<#loops>()),*]
            };
        }
    }
}
