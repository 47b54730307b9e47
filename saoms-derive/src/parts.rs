//! Parts that the declarations of classes and loops share: topics, references, lists of paths.

use proc_macro2::TokenStream;
use quote::{quote, quote_spanned};
use syn::parse::ParseStream;
use syn::punctuated::Punctuated;
use syn::spanned::Spanned;
use syn::{Error, Ident, LitStr, Path, Result, Token, parenthesized};

use crate::json::Json;

/// A reference: its name, its interface, how many targets it takes.
pub(crate) type Reference = (LitStr, Path, Multiplicity);

/// Number of targets of a reference: one by default.
#[derive(Clone, Copy, Default)]
pub(crate) struct Multiplicity {
    optional: bool,
    many: bool,
}

impl Multiplicity {
    /// `, optional` and `, many`.
    fn of(list: ParseStream<'_>) -> Result<Multiplicity> {
        let mut multiplicity = Multiplicity::default();
        while list.peek(Token![,]) && list.peek2(Ident) {
            list.parse::<Token![,]>()?;
            let word: Ident = list.parse()?;
            match word.to_string().as_str() {
                "optional" if !multiplicity.optional => multiplicity.optional = true,
                "many" if !multiplicity.many => multiplicity.many = true,
                _ => return Err(Error::new(word.span(), "expected `optional` or `many`, each once")),
            }
        }
        Ok(multiplicity)
    }
}

/// The JSON object of a topic.
pub(crate) fn topic(text: &mut Json, topic: &Path) {
    text.plain("{\"topic\":");
    text.quoted(quote_spanned!(topic.span()=> #topic.name()));
    text.plain(",\"kind\":");
    text.quoted(quote!(#topic.kind().name()));
    text.plain(",\"message\":");
    text.quoted(quote!(#topic.declaration().message));
    text.plain(",\"schema\":");
    text.json(quote!(#topic.schema()));
    text.text(quote!(::saoms_api::host::declaration::optional_topic(#topic.is_optional())));
    text.text(quote!(::saoms_api::host::declaration::speakers_of_topic(#topic.speakers())));
    text.json(quote!(#topic.speakers()));
    text.plain("}");
}

/// `{"name":name,"interface":interface`, without the end.
pub(crate) fn interface(text: &mut Json, name: &LitStr, interface: &Path) {
    text.plain("{\"name\":");
    text.string(&name.value());
    text.plain(",\"interface\":");
    text.json(quote_spanned!(interface.span()=> <dyn #interface as ::saoms_api::host::Interface>::DECLARATION));
}

/// The JSON object of a reference.
pub(crate) fn reference(text: &mut Json, (name, of, multiplicity): &Reference) {
    interface(text, name, of);
    text.plain(&format!(",\"optional\":{}", multiplicity.optional));
    text.plain(if multiplicity.many { ",\"many\":true}" } else { "}" });
}

/// The JSON of the properties that a component or a loop has.
pub(crate) fn properties(text: &mut Json, properties: &TokenStream) {
    text.plain(",\"properties\":");
    text.json(quote!(<#properties>::DECLARATION));
}

/// `(A, B)`.
pub(crate) fn paths(input: ParseStream<'_>) -> Result<Vec<Path>> {
    let list;
    parenthesized!(list in input);
    Ok(Punctuated::<Path, Token![,]>::parse_terminated(&list)?.into_iter().collect())
}

/// `("a", "b")`.
pub(crate) fn texts(input: ParseStream<'_>) -> Result<Vec<String>> {
    let list;
    parenthesized!(list in input);
    Ok(Punctuated::<LitStr, Token![,]>::parse_terminated(&list)?.iter().map(LitStr::value).collect())
}

/// `("name": Interface)`, with `, optional` and `, many` where it is.
pub(crate) fn parse_reference(input: ParseStream<'_>, known: &[Reference]) -> Result<Reference> {
    let list;
    parenthesized!(list in input);
    let (name, interface) = named(&list)?;
    let multiplicity = Multiplicity::of(&list)?;
    end(&list)?;
    if known.iter().any(|(other, ..)| other.value() == name.value()) {
        return Err(Error::new(name.span(), "another reference has this name, too"));
    }
    Ok((name, interface, multiplicity))
}

/// `"name": Interface`.
pub(crate) fn named(list: ParseStream<'_>) -> Result<(LitStr, Path)> {
    let name = list.parse()?;
    list.parse::<Token![:]>()?;
    Ok((name, list.parse()?))
}

pub(crate) fn end(list: ParseStream<'_>) -> Result<()> {
    list.parse::<Option<Token![,]>>()?;
    if list.is_empty() { Ok(()) } else { Err(list.error("expected the end")) }
}
