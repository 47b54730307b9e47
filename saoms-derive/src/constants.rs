//! The constants of a message, as ROS 2 interfaces have them.

use proc_macro2::TokenStream;
use quote::quote;
use syn::parse::ParseStream;
use syn::punctuated::Punctuated;
use syn::{Attribute, Error, Expr, Ident, Result, Token, Type, Visibility, parenthesized};

use crate::json::{Json, quoted};
use crate::literal::Literal;

/// `NAME: i8 = -1`, with a doc comment or without.
pub(crate) struct Constant {
    docs: Vec<Attribute>,
    name: Ident,
    of: Type,
    value: Expr,
    literal: Literal,
}

impl Constant {
    /// `(A: u8 = 0, B: &str = "b")`.
    pub(crate) fn list(input: ParseStream<'_>) -> Result<Vec<Constant>> {
        let list;
        parenthesized!(list in input);
        Ok(Punctuated::<Constant, Token![,]>::parse_terminated_with(&list, Constant::of)?.into_iter().collect())
    }

    fn of(input: ParseStream<'_>) -> Result<Constant> {
        let docs = input.call(Attribute::parse_outer)?;
        let name = input.parse()?;
        input.parse::<Token![:]>()?;
        let of: Type = input.parse()?;
        if let Type::Reference(reference) = &of
            && !matches!(&*reference.elem, Type::Path(path) if path.path.is_ident("str"))
        {
            return Err(Error::new_spanned(of, "a constant is a number, a bool or a `&str`"));
        }
        input.parse::<Token![=]>()?;
        let value: Expr = input.parse()?;
        let literal = Literal::of(&value)?;
        Ok(Constant { docs, name, of, value, literal })
    }

    /// Its JSON object.
    fn declare(&self, text: &mut Json) {
        text.plain("{\"name\":");
        text.string(&self.name.to_string());
        text.plain(",\"type\":");
        match &self.of {
            Type::Reference(_) => text.plain("\"string\""),
            of => text.text(quote!(<#of as ::saoms_api::Field>::TYPE)),
        }
        let value = match &self.literal {
            Literal::Text(text) => quoted(text),
            other => other.text(),
        };
        text.plain(&format!(",\"value\":{value}}}"));
    }
}

/// `,"constants":[...]`, or nothing where there are none.
pub(crate) fn declare(constants: &[Constant], text: &mut Json) {
    if !constants.is_empty() {
        text.plain(",\"constants\":");
        text.list(constants, |text, constant| constant.declare(text));
    }
}

/// The constants as those of the struct.
pub(crate) fn associated(ident: &Ident, visibility: &Visibility, constants: &[Constant]) -> TokenStream {
    if constants.is_empty() {
        return TokenStream::new();
    }
    let constants = constants.iter().map(|Constant { docs, name, of, value, .. }| match of {
        Type::Reference(_) => quote!(#(#docs)* #visibility const #name: &'static str = #value;),
        of => quote!(#(#docs)* #visibility const #name: #of = #value;),
    });
    quote! {
        #[automatically_derived]
        #[allow(dead_code, missing_docs, reason = "they are those of an interface, which other programs have, too")]
        impl #ident {
            #(#constants)*
        }
    }
}
