use proc_macro2::TokenStream;
use quote::{format_ident, quote, quote_spanned};
use syn::ext::IdentExt;
use syn::{Data, DeriveInput, Error, Fields, Generics, Ident, LitStr, Result, Type};

use crate::constants::{self, Constant};
use crate::enumeration;
use crate::json::{self, Json};
use crate::speaker::{self, Speaker};

/// `#[derive(Message)]`.
pub(crate) fn message(input: &DeriveInput) -> Result<TokenStream> {
    let fields = struct_fields(input, "a message")?;
    let mut name = input.ident.unraw().to_string();
    let mut key: Option<LitStr> = None;
    let mut place: Option<LitStr> = None;
    let mut speakers: Vec<Speaker> = Vec::new();
    let mut constants = Vec::new();
    for attribute in input.attrs.iter().filter(|attribute| attribute.path().is_ident("message")) {
        attribute.parse_nested_meta(|meta| {
            if meta.path.is_ident("name") {
                name = meta.value()?.parse::<LitStr>()?.value();
            } else if meta.path.is_ident("key") {
                key = Some(meta.value()?.parse()?);
            } else if meta.path.is_ident("place") {
                place = Some(meta.value()?.parse()?);
            } else if meta.path.is_ident("speaker") {
                speakers.push(Speaker::of(meta.input)?);
            } else if meta.path.is_ident("constants") {
                constants.extend(Constant::list(meta.input)?);
            } else {
                return Err(meta.error(
                    "expected `name = \"...\"`, `key = \"field\"`, `place = \"field\"`, `speaker(\"field\")` or \
                     `constants(NAME: u8 = 1)`",
                ));
            }
            Ok(())
        })?;
    }
    speakers.iter().flat_map(Speaker::fields).try_for_each(|field| key_field(field, &fields).map(drop))?;
    let speakers = (!speakers.is_empty()).then(|| {
        let text = speaker::list(&speakers);
        quote!(const SPEAKERS: &'static str = #text;)
    });
    let place_field = place.as_ref().map(|place| key_field(place, &fields)).transpose()?;
    let place_name = place_field.as_ref().map(|field| field.unraw().to_string()).unwrap_or_default();
    let place = place.as_ref().zip(place_field).map(|(text, field)| place_of(text, field, &fields));
    let key_field = key.as_ref().map(|key| key_field(key, &fields)).transpose()?;
    // A constant of a trait is evaluated where it is used.
    let evaluated = place.as_ref().map(|_| {
        let ident = &input.ident;
        quote!(const _: bool = <#ident as ::saoms_api::Message>::HAS_PLACE;)
    });
    let key_name = key_field.as_ref().map(|field| field.unraw().to_string()).unwrap_or_default();
    let key = key_field.map(|field| {
        quote! {
            fn key(&self) -> ::core::option::Option<u64> {
                ::core::option::Option::Some(::saoms_api::generated::Key::key(self.#field))
            }
        }
    });
    let ident = &input.ident;
    let field = structure(ident, (&name, &key_name, &place_name), &fields, &constants, &TokenStream::new());
    let constants = constants::associated(ident, &input.vis, &constants);
    let schema = json::flat(&quote!(<#ident as ::saoms_api::Field>::TYPE));
    Ok(quote! {
        #field
        #constants

        #[automatically_derived]
        impl ::saoms_api::Message for #ident {
            const NAME: &'static str = #name;
            const SCHEMA: &'static str = #schema;
            #speakers

            #key
            #place
        }

        #evaluated
    })
}

/// `#[derive(Field)]`.
pub(crate) fn field(input: &DeriveInput) -> Result<TokenStream> {
    if let Data::Enum(data) = &input.data {
        return enumeration::field(input, data);
    }
    let fields = struct_fields(input, "a field")?;
    let mut name = input.ident.unraw().to_string();
    let mut value = TokenStream::new();
    let mut constants = Vec::new();
    for attribute in input.attrs.iter().filter(|attribute| attribute.path().is_ident("field")) {
        attribute.parse_nested_meta(|meta| {
            if meta.path.is_ident("pair") {
                value = pair(&fields).map_err(|message| meta.error(message))?;
            } else if meta.path.is_ident("name") {
                name = meta.value()?.parse::<LitStr>()?.value();
            } else if meta.path.is_ident("constants") {
                constants.extend(Constant::list(meta.input)?);
            } else {
                return Err(meta.error("expected `name = \"...\"`, `pair` or `constants(NAME: u8 = 1)`"));
            }
            Ok(())
        })?;
    }
    let field = structure(&input.ident, (&name, "", ""), &fields, &constants, &value);
    let constants = constants::associated(&input.ident, &input.vis, &constants);
    Ok(quote!(#field #constants))
}

fn key_field<'a>(key: &LitStr, fields: &[(&'a Ident, &Type)]) -> Result<&'a Ident> {
    let names = || fields.iter().map(|(name, _)| format!("`{}`", name.unraw())).collect::<Vec<_>>().join(", ");
    match fields.iter().find(|(name, _)| name.unraw() == key.value().as_str()) {
        Some((name, _)) => Ok(name),
        None => {
            Err(Error::new(key.span(), format!("there is no field `{}`: expected one of {}", key.value(), names())))
        }
    }
}

/// The members of `Message` for a type whose field is the block of a message.
fn place_of(text: &LitStr, field: &Ident, fields: &[(&Ident, &Type)]) -> TokenStream {
    let of = fields.iter().find(|(name, _)| *name == field).map(|(_, of)| of);
    let message = format!(
        "`{}` is not a block: expected a struct with two fields of type `i32` and `#[field(pair)]`",
        text.value()
    );
    quote_spanned! {text.span()=>
        const HAS_PLACE: bool = {
            ::core::assert!(::saoms_api::generated::is_pair(<#of as ::saoms_api::Field>::VALUE), #message);
            true
        };

        #[inline]
        fn place(&self) -> ::core::option::Option<(i32, i32)> {
            ::saoms_api::generated::pair_of(::saoms_api::Field::as_value(&self.#field))
        }
    }
}

/// The named fields of a struct; none for `struct X;`.
pub(crate) fn struct_fields<'a>(input: &'a DeriveInput, what: &str) -> Result<Vec<(&'a Ident, &'a Type)>> {
    no_generics(&input.generics, what)?;
    match &input.data {
        Data::Struct(data) => match &data.fields {
            Fields::Named(fields) => {
                Ok(fields.named.iter().filter_map(|field| Some((field.ident.as_ref()?, &field.ty))).collect())
            }
            Fields::Unit => Ok(Vec::new()),
            Fields::Unnamed(fields) => {
                Err(Error::new_spanned(fields, format!("{what} has named fields, which its declaration lists")))
            }
        },
        _ => Err(Error::new_spanned(&input.ident, format!("{what} has to be a struct with named fields"))),
    }
}

pub(crate) fn no_generics(generics: &Generics, what: &str) -> Result<()> {
    if generics.params.is_empty() {
        return Ok(());
    }
    Err(Error::new_spanned(generics, format!("{what} cannot be generic: one declaration stands for one type")))
}

/// Code that makes a single value of two numbers.
fn pair(fields: &[(&Ident, &Type)]) -> std::result::Result<TokenStream, &'static str> {
    let is_number = |of: &Type| matches!(of, Type::Path(path) if path.path.is_ident("i32"));
    match fields {
        [(x, one), (y, other)] if is_number(one) && is_number(other) => Ok(quote! {
            const VALUE: &'static str = "pair";

            #[inline]
            fn as_value(&self) -> ::core::option::Option<::saoms_api::Value> {
                ::core::option::Option::Some(::saoms_api::Value::Pair(self.#x, self.#y))
            }

            fn of_value(value: ::saoms_api::Value) -> ::core::option::Option<Self> {
                match value {
                    ::saoms_api::Value::Pair(#x, #y) => ::core::option::Option::Some(Self { #x, #y }),
                    _ => ::core::option::Option::None,
                }
            }
        }),
        _ => Err("a pair has two fields of type `i32`"),
    }
}

fn structure(
    ident: &Ident,
    (name, key, place): (&str, &str, &str),
    fields: &[(&Ident, &Type)],
    constants: &[Constant],
    value: &TokenStream,
) -> TokenStream {
    let mut text = Json::default();
    text.plain("{\"name\":");
    text.string(name);
    text.plain(",\"fields\":");
    text.list(fields, |text, (name, of)| {
        text.plain("{\"name\":");
        text.string(&name.unraw().to_string());
        text.plain(",\"type\":");
        text.text(quote!(<#of as ::saoms_api::Field>::TYPE));
        text.plain("}");
    });
    text.member("key", key);
    text.member("place", place);
    constants::declare(constants, &mut text);
    text.plain("}");
    let text = text.into_text();
    let names: Vec<_> = fields.iter().map(|(name, _)| name).collect();
    let locals: Vec<_> = names.iter().map(|name| format_ident!("field_{}", name.unraw())).collect();
    let types: Vec<_> = fields.iter().map(|(_, of)| of).collect();
    // A structure without fields is one byte, as in ROS 2.
    let (least, write, read) = if fields.is_empty() {
        (quote!(1), quote!(::saoms_api::Field::write(&(), writer)), quote!(<() as ::saoms_api::Field>::read(reader)?;))
    } else {
        (
            quote!(#(<#types as ::saoms_api::Field>::LEAST_SIZE)+*),
            quote!(#(::saoms_api::Field::write(&self.#names, writer);)*),
            quote!(#(let #locals = <#types as ::saoms_api::Field>::read(reader)?;)*),
        )
    };
    quote! {
        #[automatically_derived]
        impl ::saoms_api::Field for #ident {
            const TYPE: ::saoms_api::host::declaration::ConstText = #text;
            const LEAST_SIZE: usize = #least;
            #value

            fn write(&self, writer: &mut ::saoms_api::host::cdr::Writer) {
                #write
            }

            fn read(
                reader: &mut ::saoms_api::host::cdr::Reader<'_>,
            ) -> ::core::result::Result<Self, ::saoms_api::host::cdr::DecodeError> {
                #read
                ::core::result::Result::Ok(#ident { #(#names: #locals),* })
            }
        }
    }
}
